//! What smoothing a mask cost, in the report.
use chordal::Bound;
use serde::Serialize;

/// A Gaussian over a mask.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SmoothingFacts {
    /// Its standard deviation along each index, in samples.
    pub sigma: [f64; 3],
    /// The samples that are inside the unsmoothed shape.
    pub inside: u64,
    /// The samples that are on another side of the smoothed surface.
    pub changed: u64,
    /// The unsmoothed surface and the smoothed one, before it is simplified, are at least so far apart.
    pub at_least: f64,
    /// They are at most so far apart, in both directions; `None` without an upper bound.
    pub at_most: Option<f64>,
    /// "proved", or what else is known of that.
    pub evidence: &'static str,
    /// Where that is more than the budget: a narrower Gaussian that is within it, as it is written.
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
