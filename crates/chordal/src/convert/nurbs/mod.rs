//! NURBS surfaces as bicubic patches within a proved distance, and their trimmed parts as triangles.
mod face_cells;
mod face_lattice;
pub(super) mod fit;
mod fit_error;
mod prepared_face;
mod sew;
mod sewn_faces;
mod trim_cells;
mod trim_loops;
pub(super) mod trimmed_mesh;
mod uncovered;
