//! The explicit shore: shapes as points that can be listed and drawn. What happens here is exact.
mod bezier;
mod mesh;
mod normals;
mod patch;
mod patch_grid;

pub use bezier::{Bezier, Levels, bernstein};
pub use mesh::{Attribute, Domain, InvalidMesh, Mesh, Semantic};
pub use normals::{face_normal, vertex_normals};
pub use patch::{Patch, Side};
pub use patch_grid::PatchGrid;
