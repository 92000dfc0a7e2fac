//! Grids into triangles: closed and manifold whatever the samples are, and within their bound.
mod blocks;
mod contours;
mod exhaustive;
mod hostile;
mod leaves;
mod lines;

mod random;
mod shapes;
mod solid;
mod sparse;
