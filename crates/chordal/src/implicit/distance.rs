//! `Distance`: what the value of a field is worth as a distance.

/// What the absolute value of a field says of the distance to its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// Nothing: only the sign means something.
    Sign,
    /// It changes by no more than one moves, and is 0 on the surface. So it is never more than the distance: a step of
    /// that length hits nothing.
    Bound,
    /// It is the distance.
    Exact,
}

impl Quality {
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

/// What a field's value is worth outside of the shape and inside of it.
///
/// ```
/// use chordal::implicit::{Distance, Quality};
/// let both = Distance::EXACT.union(Distance::EXACT);
/// assert_eq!((both.outside, both.inside), (Quality::Exact, Quality::Bound));
/// assert_eq!(Distance::EXACT.intersection(Distance::EXACT).outside, Quality::Bound);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Distance {
    /// Where the value is not negative.
    pub outside: Quality,
    /// Where it is negative.
    pub inside: Quality,
}

impl Distance {
    /// The distance to the surface, everywhere.
    pub const EXACT: Self = Self { outside: Quality::Exact, inside: Quality::Exact };
    /// Never more than the distance, everywhere.
    pub const BOUND: Self = Self { outside: Quality::Bound, inside: Quality::Bound };
    /// A sign.
    pub const SIGN: Self = Self { outside: Quality::Sign, inside: Quality::Sign };

    /// That of `min(a, b)`. Outside of both the nearer surface is the nearest of the union. Inside, the other shape may
    /// cover that surface, so only a bound is left.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        let inside = if self.inside < other.inside { self.inside } else { other.inside };
        Self {
            outside: if self.outside < other.outside { self.outside } else { other.outside },
            inside: if inside < Quality::Bound { inside } else { Quality::Bound },
        }
    }

    /// That of `max(a, b)`: as [`Distance::union`], the other way round.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        self.complement().union(other.complement()).complement()
    }

    /// That of `−a`.
    #[must_use]
    pub fn complement(self) -> Self {
        Self { outside: self.inside, inside: self.outside }
    }

    /// The weaker of both sides.
    #[must_use]
    pub fn weakest(self) -> Quality {
        if self.outside < self.inside { self.outside } else { self.inside }
    }
}
