//! Grids into triangles: closed and manifold whatever the samples are, and within their bound.
mod blocks;
mod exhaustive;

mod random;
mod shapes;
mod solid;
