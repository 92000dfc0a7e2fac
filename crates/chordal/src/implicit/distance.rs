//! `Distance`: how well the value of a field approximates the distance to its surface.

use crate::math::lesser;

/// What the absolute value of a field says about the distance to its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DistanceQuality {
    /// Nothing: only the sign means something.
    Sign,
    /// Its Lipschitz constant is at most 1, and it is 0 on the surface. So it never exceeds the distance: a
    /// step of that length cannot cross the surface.
    Bound,
    /// It is the distance.
    Exact,
}

impl DistanceQuality {
    /// The name in a report.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Sign => "sign",
            Self::Bound => "lower bound",
            Self::Exact => "exact distance",
        }
    }
}

/// The distance quality of a field's value outside and inside the shape.
///
/// ```
/// use chordal::implicit::{Distance, DistanceQuality};
/// let both = Distance::EXACT.union(Distance::EXACT);
/// assert_eq!((both.outside, both.inside), (DistanceQuality::Exact, DistanceQuality::Bound));
/// assert_eq!(Distance::EXACT.intersection(Distance::EXACT).outside, DistanceQuality::Bound);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Distance {
    /// Where the value is not negative.
    pub outside: DistanceQuality,
    /// Where it is negative.
    pub inside: DistanceQuality,
}

impl Distance {
    /// The distance to the surface, everywhere.
    pub const EXACT: Self = Self { outside: DistanceQuality::Exact, inside: DistanceQuality::Exact };
    /// Never more than the distance, everywhere.
    pub const BOUND: Self = Self { outside: DistanceQuality::Bound, inside: DistanceQuality::Bound };
    /// Only a sign, everywhere.
    pub const SIGN: Self = Self { outside: DistanceQuality::Sign, inside: DistanceQuality::Sign };

    /// The quality of `min(a, b)`. Outside both shapes the nearer of the two surfaces is nearest. Inside, the
    /// other shape may cover that surface, so the value is only a bound.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        let inside = lesser(self.inside, other.inside);
        Self { outside: lesser(self.outside, other.outside), inside: lesser(inside, DistanceQuality::Bound) }
    }

    /// The quality of `max(a, b)`: [`Distance::union`] with both sides exchanged.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        self.complement().union(other.complement()).complement()
    }

    /// The quality of `−a`.
    #[must_use]
    pub fn complement(self) -> Self {
        Self { outside: self.inside, inside: self.outside }
    }

    /// The weaker of the two sides.
    #[must_use]
    pub fn weakest(self) -> DistanceQuality {
        lesser(self.outside, self.inside)
    }
}
