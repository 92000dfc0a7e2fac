//! Explicit shapes: points that can be listed and drawn. Everything here is exact.
mod arc;
mod bezier;
mod bvh;
pub(crate) mod cage;
mod closest_point;
mod clusters;
mod continuity;
mod curve;
mod curve_segment;
mod disjoint_sets;
pub(crate) mod fill;
mod half_edges;
pub mod laws;
mod mesh;
mod normals;
mod order;
mod outline;
mod patch;
mod patch_grid;
mod polygon;
mod polyline;
mod polynomial;
mod quad;
pub mod spline;
mod tangents;
mod topology;
mod triangle;
pub mod triangulate;
mod twins;

pub use arc::{Arc, InvalidArc, SvgArcShape};
pub use bezier::{Bezier, DeCasteljau, bernstein};
pub use bvh::{
    Bvh, Containment, Enclosure, Hit, HitSides, MeshClosestPoint, PointLocation, Ray, WindingNumber,
};
pub(crate) use bvh::{WindingMoments, closest_on_triangle, distance_sq_to_triangle};
pub use cage::limit::{Jet, LimitSheet, LimitSurface};
pub use cage::{
    Boundary, Cage, Chart, CornerTexcoords, CreasingMethod, INFINITELY_SHARP, InvalidCage, LinearTexcoords,
    Real, Refinement, Scheme,
};
pub use closest_point::{SurfaceClosestPoint, SurfaceTree};
pub use clusters::{Cluster, FacingCounts, clusters, facing};
pub use continuity::Continuity;
pub use curve::{Curve, CurveEnds, InvalidCurve};
pub use curve_segment::{AffineMap, CurveSegment};
pub(crate) use disjoint_sets::DisjointSets;
#[allow(unused_imports, reason = "used by what is not called yet")]
pub(crate) use half_edges::HalfEdges;
pub use mesh::{Attribute, Domain, InvalidMesh, Mesh, Semantic};
pub(crate) use normals::with_vertex_normals;
pub use normals::{NormalWeight, Shading, face_normal, smooth_normals, vertex_normals, with_normals};
pub use order::{acmr, cache_misses, cache_order, fetch_order};
pub use outline::{FillRule, Outline};
pub use patch::{Patch, PatchSide};
pub use patch_grid::PatchGrid;
pub use polygon::{fan, is_convex, polygon_contains, winding_number};
pub use polyline::Polyline;
pub use polynomial::Polynomial;
pub use quad::{Diagonal, Quad};
pub use tangents::with_tangents;
pub use topology::{Topology, position_id_by_bits};
pub use triangle::{Triangle, corner_rows, interpolate};
pub use twins::{Twin, Twins, next_in_face, previous_in_face};
