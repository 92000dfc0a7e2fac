//! The effect of smoothing a mask, in the report.
use chordal::Bound;
use serde::Serialize;

/// A Gaussian over a mask.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SmoothingFacts {
    /// Its standard deviation along each index, in samples.
    pub sigma: [f64; 3],
    /// The samples that are inside the unsmoothed shape.
    pub inside: u64,
    /// The samples that are on the other side of the smoothed surface.
    pub changed: u64,
    /// The distance of the unsmoothed surface and the smoothed one, before it is simplified, is at least this.
    pub at_least: f64,
    /// Their distance is at most this, in both directions; `None` without an upper bound.
    pub at_most: Option<f64>,
    /// The evidence of that: "proved", or another.
    pub evidence: &'static str,
    /// If that is more than the budget: a narrower Gaussian that is within it, in the syntax of the option.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fits: Option<String>,
}

impl SmoothingFacts {
    /// The facts of a smoothed surface, the samples inside and those that changed.
    pub(crate) fn new(sigma: [f64; 3], (inside, changed): (u64, u64), bound: &Bound) -> Self {
        Self {
            sigma,
            inside,
            changed,
            at_least: bound.at_least(),
            at_most: bound.at_most(),
            evidence: bound.evidence().as_str(),
            fits: None,
        }
    }
}
