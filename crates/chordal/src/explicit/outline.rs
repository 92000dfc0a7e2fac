//! `Outline`: closed paths in the plane that together bound a region, by a fill rule.
use super::Curve;

/// The rule that decides which points a set of closed paths encloses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FillRule {
    /// Points with a nonzero winding number.
    #[default]
    NonZero,
    /// Points from which a ray crosses the paths an odd number of times.
    EvenOdd,
}

impl FillRule {
    /// Whether a point with this winding number is inside.
    #[must_use]
    pub fn holds(self, winding: i32) -> bool {
        match self {
            Self::NonZero => winding != 0,
            Self::EvenOdd => winding % 2 != 0,
        }
    }

    /// The name in files.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::NonZero => "nonzero",
            Self::EvenOdd => "evenodd",
        }
    }
}

/// A region of the plane: the points that its contours enclose by its rule. A straight line closes an open
/// contour.
///
/// ```
/// use chordal::explicit::{FillRule, Outline};
/// let nothing = Outline { contours: Vec::new(), rule: FillRule::NonZero };
/// assert!(nothing.rule.holds(-2) && !FillRule::EvenOdd.holds(-2));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// The paths.
    pub contours: Vec<Curve<2>>,
    /// The fill rule.
    pub rule: FillRule,
}
