//! `Distance`: what the value of a field is worth as a distance.

use crate::math::lesser;

/// What the absolute value of a field says about the distance to its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DistanceQuality {
    /// Nothing: only the sign has a meaning.
    Sign,
    /// Its Lipschitz constant is at most 1, and it is 0 on the surface. So it is never more than the
    /// distance: a step of that length hits nothing.
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

/// What a field's value is worth outside and inside the shape.
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

    /// That of `min(a, b)`. Outside both shapes the nearer surface is the nearest of the union. Inside, the
    /// other shape may cover that surface, so only a bound is left.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        let inside = lesser(self.inside, other.inside);
        Self { outside: lesser(self.outside, other.outside), inside: lesser(inside, DistanceQuality::Bound) }
    }

    /// That of `max(a, b)`: [`Distance::union`] with both sides exchanged.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        self.complement().union(other.complement()).complement()
    }

    /// That of `−a`.
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
