//! The explicit shore: shapes as points that can be listed and drawn. What happens here is exact.
mod arc;
mod bezier;
mod bvh;
pub(crate) mod cage;
mod clusters;
mod continuation;
mod curve;
pub(crate) mod fill;
mod foot;
mod half_edges;
pub mod laws;
mod mesh;
mod normals;
mod order;
mod outline;
mod patch;
mod patch_grid;
mod piece;
mod polygon;
mod polyline;
mod polynomial;
mod quad;
mod sets;
pub mod spline;
mod tangents;
mod topology;
mod triangle;
pub mod triangulate;
mod twins;

pub use arc::{Arc, InvalidArc, Through};
pub use bezier::{Bezier, Levels, bernstein};
pub use bvh::{Bvh, Closest, Containment, Enclosure, Hit, Ray, Sides, Whereabouts, Winding};
pub(crate) use bvh::{Soundings, nearest_on_triangle, nearest_with_distance};
pub use cage::limit::{Jet, LimitSurface, Sheet};
pub use cage::{
    Boundary, Cage, Chart, CornerTexcoords, Creasing, INFINITELY_SHARP, InvalidCage, LinearTexcoords, Real,
    Refinement, Scheme,
};
pub use clusters::{Cluster, FacingCounts, clusters, facing};
pub use continuation::Smoothness;
pub use curve::{Curve, InvalidCurve};
pub use foot::{Foot, SurfaceTree};
#[allow(unused_imports, reason = "used by what is not called yet")]
pub(crate) use half_edges::HalfEdges;
pub use mesh::{Attribute, Domain, InvalidMesh, Mesh, Semantic};
pub(crate) use normals::with_vertex_normals;
pub use normals::{Shading, Weight, face_normal, smooth_normals, vertex_normals, with_normals};
pub use order::{acmr, cache_misses, cache_order, fetch_order};
pub use outline::{FillRule, Outline};
pub use patch::{Patch, Side};
pub use patch_grid::PatchGrid;
pub use piece::{Affine, Piece};
pub use polygon::{fan, is_convex, polygon_contains, winding_number};
pub use polyline::Polyline;
pub use polynomial::Polynomial;
pub use quad::{Diagonal, Quad};
pub(crate) use sets::Sets;
pub use tangents::with_tangents;
pub use topology::{Topology, position_id_by_bits};
pub use triangle::{Triangle, corner_rows, interpolate};
pub use twins::{Twin, Twins, next_in_face, previous_in_face};
