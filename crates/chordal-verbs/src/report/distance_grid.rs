//! The distance grid of `bake` in the report.
use chordal::convert::SolidReport;
use serde::Serialize;

/// A distance grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DistanceGridFacts {
    /// The shape to which the samples are distances: "triangles" of the input, "field" for a field whose own values are
    /// distances, "tessellation" for triangles that were built for the shape.
    pub route: &'static str,
    /// Samples along each index, the first of which runs fastest.
    pub size: [u64; 3],
    /// The position of the first sample.
    pub origin: [f64; 3],
    /// The increment of x, y or z per index.
    pub spacing: f64,
    /// The largest distance that samples hold; `None` if every sample is a distance.
    pub band: Option<f64>,
    /// Samples whose value is a distance; the others state only that they are beyond the band, and on which side.
    pub distances: u64,
    /// A bound for the error of these values without their signs; `None` if there is no bound for the triangles of the
    /// shape.
    pub off_at_most: Option<f64>,
    /// The evidence: that of the triangles of the shape, or else "proved", from two bounds of each value, rounding included.
    pub evidence: &'static str,
    /// The error of the interpolant between samples; `None` if sides may change without a triangle between them.
    pub interpolant: Option<InterpolantFacts>,
    /// The numbers of stored bricks and of all bricks of the lattice; only for sparse samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bricks: Option<[u64; 2]>,
    /// The evidence for the signs of samples; `None` for a field, whose values have signs.
    pub solid: Option<SolidFacts>,
}

/// The error of the trilinear interpolant of samples against the distance to the shape, in every cell whose samples are all
/// distances.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InterpolantFacts {
    /// The largest error.
    pub at_most: f64,
    /// The evidence, as for the samples.
    pub evidence: &'static str,
    /// "signed distance", or "distance" if only absolute values are compared.
    pub of: &'static str,
}

/// Whether a mesh bounds a solid, or the reasons why not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SolidFacts {
    /// Whether it bounds a solid.
    pub is_solid: bool,
    /// Whether equally many triangles run in either direction along every edge; only then all signs are certain.
    pub closed: bool,
    /// Whether its front faces inward, so that it has no inside.
    pub inside_out: bool,
    /// Pairs of triangles that intersect.
    pub self_intersections: u64,
    /// "whole winding numbers" for closed meshes, otherwise "winding numbers above a half".
    pub side: &'static str,
    /// A summary in one sentence.
    pub sentence: String,
}

impl SolidFacts {
    /// The facts of a mesh.
    #[must_use]
    pub fn new(solid: &SolidReport) -> Self {
        Self {
            is_solid: solid.is_solid(),
            closed: solid.closed,
            inside_out: solid.inside_out,
            self_intersections: solid.self_intersections,
            side: if solid.closed { "whole winding numbers" } else { "winding numbers above a half" },
            sentence: solid.to_string(),
        }
    }
}
