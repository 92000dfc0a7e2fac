//! How a field becomes triangles: a lattice, its bricks that matter, marching cubes on them, and the size of cells.
mod bricks;
mod lattice;
mod polygonize;
mod search;

pub(super) use search::{Wanted, search};
