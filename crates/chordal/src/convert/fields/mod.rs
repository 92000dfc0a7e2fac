//! How a field becomes triangles: adaptive cells, the boundary of a CSG tree in them, its improvement, and
//! the proof.
mod arrangement;
mod ask;
mod cells;
mod cells_at_vertices;
mod corner_slopes;
mod extract;
mod fan;
mod grid;
mod growth;
mod improve;
mod mesher;
mod search;
mod tetrahedra;
mod vertex_values;

#[cfg(test)]
mod tests;

pub(super) use ask::Ask;
pub(super) use mesher::Wanted;
pub(super) use search::search;
