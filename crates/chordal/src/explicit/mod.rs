//! The explicit shore: shapes as points that can be listed and drawn. What happens here is exact.
mod bezier;
mod bvh;
mod mesh;
mod normals;
mod patch;

pub use bezier::{Bezier, Levels, bernstein};
pub use bvh::{Bvh, Closest, Hit, Ray};
pub use mesh::{Attribute, Domain, InvalidMesh, Mesh, Semantic};
pub use normals::{face_normal, vertex_normals};
pub use patch::{Patch, Side};
