//! How a field becomes triangles: a lattice, its bricks that matter, marching cubes on them, and the size of cells.
mod ask;
mod bricks;
mod lattice;
mod planes;
mod polygonize;
mod refine;
mod search;
mod sharpen;

pub(super) use ask::Ask;
pub(super) use search::{Wanted, search};
