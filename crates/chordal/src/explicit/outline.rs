//! `Outline`: closed paths in the plane that bound a region together, by a fill rule.
use super::Curve;

/// Which points of the plane a set of closed paths encloses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FillRule {
    /// Those that the paths wind around, counted with their directions.
    #[default]
    NonZero,
    /// Those that a ray leaves through an odd number of crossings.
    EvenOdd,
}

impl FillRule {
    /// Whether a point of this winding number is inside.
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

/// A region of the plane: what its contours enclose by its rule. A contour that is open is closed by a straight line.
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
    /// What of the plane they enclose.
    pub rule: FillRule,
}
