//! Checks: measures shapes and proves properties and error bounds; builds nothing.
mod attributes;
mod comb;
mod component;
mod components;
mod connectivity;
mod curve_length;
mod defect;
mod degenerate;
mod deviation;
mod duplicates;
mod edge_join;
mod edge_topology;
mod exact_point;
mod fans;
mod field_deviation;
mod finding;
mod gap;
mod joins;
mod limit_deviation;
mod loop_deviation;
mod measure;
mod nesting;
mod nurbs_edges;
mod nurbs_line;
mod offset_deviation;
mod open_seams;
mod overshade;
mod point_tree;
mod self_intersections;
mod smooth_deviation;
mod surface_at_least;
mod surface_edges;
mod t_junctions;
mod thin;
mod triangle_intersection;
mod validity;
mod winding;
mod zero_set;

pub(crate) use attributes::attribute_deviation_within;
pub use component::{Component, Facing};
pub use components::{components, inside_out, outward};
pub(crate) use connectivity::MeshConnectivity;
pub use defect::Defect;
pub use degenerate::{has_zero_area, is_collinear};
#[cfg(test)]
pub(crate) use deviation::ToleranceViolation;
pub(crate) use deviation::distance::distance_up;
pub use deviation::{Deviation, Goal, OneSidedDistance, deviation, vertex_deviation};
pub(crate) use deviation::{
    MappedPair, NearFaces, NearestFaces, ProximityChecker, RegionTolerance, ToleranceField, ViolationReport,
    tolerance_violations,
};
pub use duplicates::duplicate_vertices;
pub(crate) use fans::boundary_path;
pub use field_deviation::{FieldDeviation, field_deviation, field_deviation_at};
pub(crate) use field_deviation::{
    MeasuredDeviation, SandwichGoal, SandwichProver, SandwichVerdict, is_hopeless, measured_field_deviation,
    sandwich_bound,
};
pub(crate) use finding::{Finding, MeshLocation, Witness};
pub(crate) use gap::distance_to_polyline;
pub use limit_deviation::limit_deviation;
pub(crate) use measure::measure;
pub use offset_deviation::offset_deviation;
pub(crate) use offset_deviation::{OffsetSource, OffsetVerdict, offset_deviation_from};
pub(crate) use overshade::{Overshade, overshade};
pub(crate) use point_tree::PointTree;
pub use self_intersections::{intersections_between, self_intersections};
pub use smooth_deviation::{cage_deviation, cage_deviation_at, patch_deviation, patch_deviation_at};
pub use surface_at_least::surface_at_least;
pub(crate) use surface_at_least::triangle_at_least;
pub use t_junctions::t_junctions;
pub(crate) use t_junctions::vertices_in_edges;
pub use thin::{SLIVER_ASPECT, is_sliver};
pub(crate) use triangle_intersection::triangles_intersect;
pub use validity::{Validity, validity};
#[cfg(feature = "booleans")]
pub(crate) use winding::{RayCrossing, crossing};
pub use zero_set::zero_set_deviation;

/// Joins, gaps and curvature of paths.
pub mod curves {
    pub use super::comb::{Tooth, curvature_comb};
    pub use super::curve_length::CurveLength;
    pub use super::gap::{Gap, distance_to_polyline, largest_gap};
    pub use super::joins::{Join, join, joins};
}

/// Defects with their places, counts and attributes.
pub mod findings {
    pub use super::attributes::{AttributeDeviation, attribute_deviation};
    pub use super::connectivity::MeshConnectivity;
    pub use super::defect::Severity;
    pub use super::duplicates::ConnectivityPair;
    pub use super::finding::{Finding, MAX_WITNESSES, MeshLocation, Witness};
    pub use super::measure::{Measure, measure};
    pub use super::open_seams::OpenSeams;
}

/// The costs of triangles for a graphics processor beyond their pixels.
pub mod shading {
    pub use super::overshade::{
        Flicker, MicroTriangles, Overshade, ShadingCounts, flicker, micro_triangles, overshade,
    };
}

/// Continuity of patches across their edges.
pub mod surfaces {
    pub use super::edge_join::{EdgeJoin, EdgeMaximum, PatchSideId, edge_join};
    pub use super::nurbs_edges::{NurbsEdges, NurbsJoin, nurbs_edges};
    pub use super::nurbs_line::NurbsLine;
    pub use super::surface_edges::{SurfaceEdges, surface_edges};
}
