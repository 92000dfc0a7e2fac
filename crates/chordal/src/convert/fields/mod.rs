//! How a field becomes triangles: adaptive cells, the boundary of a CSG tree in them, its improvement, and the proof. Fields whose slopes are not
//! known are meshed on a lattice (`by_lattice`).
mod arrangement;
mod ask;
mod bricks;
mod by_lattice;
mod cells;
mod extract;
mod fan;
mod grid;
mod growth;
mod improve;
mod lattice;
mod mesher;
mod planes;
mod polygonize;
mod refine;
mod search;
mod sharpen;
mod tetrahedra;
mod vertex_values;

#[cfg(test)]
mod tests;

pub(super) use ask::Ask;
pub(super) use mesher::Wanted;
pub(super) use search::search;
