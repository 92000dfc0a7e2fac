//! How far two shapes are apart, as a report says it.
use super::InputFacts;
use chordal::Bound;
use chordal::budget::Tolerance;
use chordal::check::OneSidedDistance;
use serde::Serialize;

/// What `deviation` found beside the bound, which stands in the certificate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviationFacts {
    /// The second shape.
    pub against: InputFacts,
    /// From the points of the first shape to the second.
    pub forward: OneSidedFacts,
    /// From the points of the second shape to the first.
    pub backward: OneSidedFacts,
    /// The diagonal of the second shape's box, from below.
    pub diagonal: f64,
    /// Whether the ends came as close together as was asked for.
    pub reached: bool,
    /// The limit, in the units of the second shape; none where none was given.
    pub max: Option<f64>,
    /// On which side of the limit the distance is; none without a limit.
    pub verdict: Option<Verdict>,
}

/// The distance from the points of one shape to the other, at most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OneSidedFacts {
    /// Some point is at least this far.
    pub at_least: f64,
    /// No point is farther than this.
    pub at_most: f64,
    /// The farthest point that was found.
    pub from: [f64; 3],
    /// The nearest point of the other shape to it.
    pub to: [f64; 3],
}

impl From<OneSidedDistance> for OneSidedFacts {
    fn from(side: OneSidedDistance) -> Self {
        Self { at_least: side.at_least, at_most: side.at_most, from: side.from, to: side.to }
    }
}

/// On which side of a limit a distance is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// At most the limit, proved.
    Within,
    /// More than the limit, proved.
    Exceeds,
    /// So close to it that neither is proved.
    Undecided,
}

impl Verdict {
    /// What a bound says about a limit.
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
