//! The explicit shore: shapes as points that can be listed and drawn. What happens here is exact.
mod arc;
mod bezier;
mod bvh;
mod curve;
pub mod laws;
mod mesh;
mod normals;
mod patch;
mod patch_grid;
mod piece;
mod polyline;
mod topology;
pub mod triangulate;
mod twins;

pub use arc::{Arc, InvalidArc, Through};
pub use bezier::{Bezier, Levels, bernstein};
pub use bvh::{Bvh, Closest, Hit, Ray};
pub use curve::{Curve, InvalidCurve};
pub use mesh::{Attribute, Domain, InvalidMesh, Mesh, Semantic};
pub use normals::{face_normal, vertex_normals};
pub use patch::{Patch, Side};
pub use patch_grid::PatchGrid;
pub use piece::{Affine, Piece};
pub use polyline::Polyline;
pub use topology::{Topology, position_id_by_bits};
pub use twins::{Twin, Twins, next_in_face, previous_in_face};
