//! The distance between two shapes in the report.
use super::InputFacts;
use chordal::Bound;
use chordal::budget::Tolerance;
use chordal::check::OneSidedDistance;
use serde::Serialize;

/// The result of `deviation` beside the bound, which is in the certificate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviationFacts {
    /// The second shape.
    pub against: InputFacts,
    /// The one-sided distance from the first shape to the second.
    pub forward: OneSidedFacts,
    /// The one-sided distance from the second shape to the first.
    pub backward: OneSidedFacts,
    /// The diagonal of the second shape's box, rounded down.
    pub diagonal: f64,
    /// Whether the requested precision was reached.
    pub reached: bool,
    /// The limit, in the units of the second shape; `None` without one.
    pub max: Option<f64>,
    /// The verdict on the limit; `None` without one.
    pub verdict: Option<Verdict>,
}

/// The largest distance from the points of one shape to the other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OneSidedFacts {
    /// Some point is at least this far.
    pub at_least: f64,
    /// No point is farther than this.
    pub at_most: f64,
    /// The farthest point that was evaluated.
    pub from: [f64; 3],
    /// The nearest point of the other shape to it.
    pub to: [f64; 3],
}

impl From<OneSidedDistance> for OneSidedFacts {
    fn from(side: OneSidedDistance) -> Self {
        Self { at_least: side.at_least, at_most: side.at_most, from: side.from, to: side.to }
    }
}

/// The comparison of a distance with a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// At most the limit, proved.
    Within,
    /// More than the limit, proved.
    Exceeds,
    /// Neither is proved.
    Undecided,
}

impl Verdict {
    /// The verdict of a bound on a limit.
    #[must_use]
    pub fn from_bound(bound: &Bound, max: Tolerance) -> Self {
        if bound.at_most().is_some_and(|most| most <= max.get()) {
            Self::Within
        } else if bound.at_least() > max.get() {
            Self::Exceeds
        } else {
            Self::Undecided
        }
    }
}
