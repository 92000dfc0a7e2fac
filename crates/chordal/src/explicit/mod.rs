//! Explicit shapes: points that can be listed and drawn. All operations here are exact.
mod affine_map;
mod arc;
mod bezier;
mod bvh;
pub(crate) mod cage;
mod closest_point;
mod clusters;
mod continuity;
mod corner_block;
mod curve;
mod curve_frame;
mod curve_segment;
mod disjoint_sets;
pub(crate) mod fill;
mod half_edges;
pub mod laws;
mod mesh;
mod normals;
pub mod nurbs;
mod order;
mod outline;
mod patch;
mod patch_grid;
mod polygon;
mod polyline;
mod polynomial;
mod quad;
mod segment_pair;
pub mod spline;
mod svg_arc;
mod tangents;
mod topology;
mod triangle;
pub mod triangulate;
mod twins;

pub(crate) use affine_map::AffineMap;
pub use arc::Arc;
pub(crate) use arc::ArcPart;
pub use bezier::Bezier;
pub(crate) use bezier::bernstein;
pub(crate) use bvh::is_closed;
pub(crate) use bvh::{Bvh, Enclosure, HitSides, PointLocation, Ray};
pub(crate) use bvh::{
    OpenEdge, PackedBoxes, WindingMoments, closest_on_triangle, distance_sq_to_triangle,
    distance_to_triangle_down, nearest_on_triangle, open_edges,
};
pub(crate) use cage::limit::{LimitSheet, LimitSurface};
pub use cage::{Cage, InvalidCage};
pub(crate) use cage::{Chart, Scheme};
pub(crate) use closest_point::SurfaceTree;
pub(crate) use closest_point::box_tree::{BoxTree, BoxTreeNode};
pub(crate) use corner_block::{BLOCK, CornerBlock, Lanes};
pub use curve::{Curve, CurveEnds, InvalidCurve};
pub use curve_segment::CurveSegment;
pub(crate) use disjoint_sets::DisjointSets;
#[allow(unused_imports, reason = "used by what is not called yet")]
pub(crate) use half_edges::HalfEdges;
pub use mesh::{Attribute, Domain, InvalidMesh, Mesh, Semantic};
pub(crate) use normals::with_vertex_normals;
pub use normals::{NormalWeight, Shading, face_normal, smooth_normals, vertex_normals, with_normals};
pub use order::{acmr, cache_misses, cache_order, fetch_order};
pub use outline::{FillRule, Outline};
pub use patch::Patch;
pub(crate) use patch::{PatchEdgeUse, PatchSide, shared_sides};
pub use polyline::Polyline;
pub(crate) use quad::{Diagonal, Quad};
pub(crate) use segment_pair::closest_on_segments;
pub use tangents::with_tangents;
pub use topology::{Topology, position_id_by_bits};
pub use triangle::{Triangle, corner_rows, interpolate};
pub(crate) use twins::{Twin, Twins, next_in_face, previous_in_face};

/// The half-edge structure of a mesh.
pub mod adjacency {
    pub use super::twins::{Twin, Twins, next_in_face, previous_in_face};
}

/// The mathematics of curve pieces and patches.
pub mod parametric {
    pub use super::affine_map::AffineMap;
    pub use super::arc::InvalidArc;
    pub use super::bezier::{DeCasteljau, bernstein};
    pub use super::continuity::Continuity;

    pub use super::patch::PatchSide;
    pub use super::patch_grid::PatchGrid;
    pub use super::polynomial::Polynomial;
    pub use super::svg_arc::SvgArcShape;
}

/// Planar polygons and quads.
pub mod polygons {
    pub use super::polygon::{fan, is_convex, polygon_contains, winding_number};
    pub use super::quad::{Diagonal, Quad};
}

/// Rays, closest points and winding numbers by bounding volume trees.
pub mod query {
    pub use super::bvh::{
        Bvh, Containment, Enclosure, Hit, HitSides, MeshClosestPoint, PointLocation, Ray, WindingNumber,
    };
    pub use super::closest_point::{CurveClosestPoint, SurfaceClosestPoint, SurfaceTree};
    pub use super::clusters::{Cluster, FacingCounts, clusters, facing};
}

/// The rules of subdivision, its stencils, and limit surfaces.
pub mod subdivision {
    pub use super::cage::limit::{Jet, LimitSheet, LimitSurface};
    pub use super::cage::{
        Boundary, Chart, CornerTexcoords, CreasingMethod, INFINITELY_SHARP, LinearTexcoords, Real,
        Refinement, Scheme,
    };
}
