//! From a field to triangles: adaptive cells, the boundary of a CSG tree in them, its improvement, and its proof.
mod arrangement;
mod border_functions;
mod cells;
mod contacts;
mod corner_gradients;
mod draft;
mod extract;
mod face_materials;
mod field_sampler;
mod grid;
mod growth;
mod improve;
mod material_borders;
mod mesher;
mod open_places;
mod paint;
mod polygon_triangulation;
mod sampled_signs;
mod search;
mod sizing;
mod tetrahedra;
mod vertex_values;

#[cfg(test)]
mod tests;

pub(super) use draft::{draft, measured_draft};
pub(super) use face_materials::FaceMaterials;
pub(super) use field_sampler::FieldSampler;
pub(super) use mesher::{FieldMeshGoal, leaf_failure};
pub(super) use open_places::open_places;
pub(super) use search::search;
