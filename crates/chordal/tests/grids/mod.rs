//! Grids into triangles: closed and manifold whatever the samples are, and within their bound.
mod blocks;
mod contours;
mod exhaustive;
mod fragments;
mod hostile;
mod labels;
mod leaves;
mod lines;
mod local_refinement;
mod parts;
mod random;
mod shapes;
mod smooth;
pub mod solid;
mod sparse;
