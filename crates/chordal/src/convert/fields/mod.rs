//! How a field becomes triangles: a lattice, its bricks that matter, marching cubes on them, and the size of cells.
mod ask;
mod bricks;
#[allow(dead_code, reason = "the extraction that gives its input comes next")]
pub(crate) mod improve;
mod lattice;
mod planes;
mod polygonize;
mod refine;
mod search;
mod sharpen;

// Adaptive cells and the arrangement of primitives in them; so far only their tests run them.
#[cfg_attr(not(test), allow(dead_code))]
mod arrangement;
#[cfg_attr(not(test), allow(dead_code))]
mod cells;
#[cfg_attr(not(test), allow(dead_code))]
pub(super) mod extract;
#[cfg_attr(not(test), allow(dead_code))]
mod fan;
#[cfg_attr(not(test), allow(dead_code))]
pub(super) mod grid;
#[cfg_attr(not(test), allow(dead_code))]
mod growth;
#[cfg_attr(not(test), allow(dead_code))]
mod tetrahedra;
#[cfg_attr(not(test), allow(dead_code))]
mod vertex_values;

#[cfg(test)]
mod tests;

pub(super) use ask::Ask;
pub(super) use search::{Wanted, search};
