//! The distance grid of `bake` in the report.
use chordal::convert::SolidReport;
use serde::Serialize;

/// A distance grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DistanceGridFacts {
    /// What the samples are distances to: "triangles" of the input, "field" for a field whose own values are
    /// distances, "tessellation" for triangles that were made of the shape.
    pub route: &'static str,
    /// Samples along each index, the first of which runs fastest.
    pub size: [u64; 3],
    /// The position of the first sample.
    pub origin: [f64; 3],
    /// The increment of x, y or z per index.
    pub spacing: f64,
    /// The largest distance that samples hold; `None` where every sample is a distance.
    pub band: Option<f64>,
    /// Samples whose value is a distance; all others say only that they are beyond the band, and on which
    /// side.
    pub distances: u64,
    /// The size of no such value is further than this from the distance to the shape; `None` where nothing bounds
    /// how far the triangles of the shape are off.
    pub off_at_most: Option<f64>,
    /// The evidence: that of the triangles of the shape, else "proved", each value by two bounds that rounding
    /// cannot break.
    pub evidence: &'static str,
    /// How far the interpolant is off between samples; `None` where sides change without a triangle.
    pub interpolant: Option<InterpolantFacts>,
    /// Bricks that are stored, and all of the lattice; only of sparse samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bricks: Option<[u64; 2]>,
    /// What the signs of samples rest on; `None` for a field, whose values have them.
    pub solid: Option<SolidFacts>,
}

/// How far the trilinear interpolant of samples is from the distance to the shape, in every cell all of whose samples
/// are distances.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InterpolantFacts {
    /// It is off by no more than this.
    pub at_most: f64,
    /// The evidence, as for the samples.
    pub evidence: &'static str,
    /// "signed distance", or "distance" where only its size is compared.
    pub of: &'static str,
}

/// Whether a mesh bounds a solid, and why not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SolidFacts {
    /// Whether it bounds a solid.
    pub is_solid: bool,
    /// Whether equally many triangles run in either direction along every edge; only then is every sign
    /// certain.
    pub closed: bool,
    /// Its front faces inward, so that nothing is inside of it.
    pub inside_out: bool,
    /// Pairs of triangles that intersect.
    pub self_intersections: u64,
    /// "whole winding numbers" for closed meshes, else "winding numbers above a half".
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
