//! NURBS surfaces as bicubic patches within a proved distance, and their trimmed parts as triangles.
mod face_lattice;
pub(super) mod fit;
mod fit_error;
mod sew;
mod trim_cells;
mod trim_loops;
pub(super) mod trimmed_mesh;
mod uncovered;
