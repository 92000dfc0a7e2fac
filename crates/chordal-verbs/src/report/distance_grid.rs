//! The distance grid of `bake` in the report.
use chordal::convert::{DistanceGrid, SolidReport};
use serde::Serialize;

/// A distance grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DistanceGridFacts {
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
    /// No such value is further than this from the distance to the triangles.
    pub off_at_most: f64,
    /// The evidence: "proved", each of them by two bounds that rounding cannot break.
    pub evidence: &'static str,
    /// What the signs of samples rest on.
    pub solid: SolidFacts,
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

impl DistanceGridFacts {
    /// The facts of a lattice whose distances are proved to be off by no more than `off_at_most`.
    #[must_use]
    pub fn new(baked: &DistanceGrid, off_at_most: f64) -> Self {
        let affine = baked.grid.affine();
        Self {
            size: baked.grid.size().map(|n| n as u64),
            origin: affine.at([0.0; 3]),
            spacing: affine.rows()[0][0],
            band: baked.band.is_finite().then_some(baked.band),
            distances: baked.n_within,
            off_at_most,
            evidence: "proved",
            solid: SolidFacts::new(&baked.solid),
        }
    }
}
