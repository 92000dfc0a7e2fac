//! `Box3`: an axis-aligned box.
use super::{add_up, div_up, mul_up, sqrt_up, sub_up};

/// An axis-aligned box; it is empty if a coordinate of `min` exceeds that of `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box3 {
    /// The lowest coordinates.
    pub min: [f64; 3],
    /// The highest coordinates.
    pub max: [f64; 3],
}

impl Box3 {
    /// The empty box.
    pub const EMPTY: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    /// The smallest box around `points`.
    #[must_use]
    pub fn from_points<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| b.with(*p))
    }

    /// The smallest box around this one and `point`.
    #[inline]
    #[must_use]
    pub fn with(self, point: [f64; 3]) -> Self {
        self.union(Self { min: point, max: point })
    }

    /// The smallest box around both boxes.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        // Without `from_fn`, which is not inlined here: readers call this for every point.
        let low = |k: usize| if self.min[k] < other.min[k] { self.min[k] } else { other.min[k] };
        let high = |k: usize| if self.max[k] > other.max[k] { self.max[k] } else { other.max[k] };
        Self { min: [low(0), low(1), low(2)], max: [high(0), high(1), high(2)] }
    }

    /// Whether it contains no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|k| self.min[k] > self.max[k])
    }

    /// Whether it contains `point`, faces included.
    #[must_use]
    pub fn contains(&self, point: [f64; 3]) -> bool {
        (0..3).all(|k| self.min[k] <= point[k] && point[k] <= self.max[k])
    }

    /// The centre, rounded.
    #[must_use]
    pub fn centre(&self) -> [f64; 3] {
        std::array::from_fn(|k| 0.5 * self.min[k] + 0.5 * self.max[k])
    }

    /// The length of the diagonal, bounded from above; 0 for the empty box, ∞ if a side is longer than the
    /// largest number.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let [x, y, z]: [f64; 3] = std::array::from_fn(|k| sub_up(self.max[k], self.min[k]));
        let longest = [y, z].into_iter().fold(x, |longest, side| if side > longest { side } else { longest });
        // Scaling would divide ∞ by ∞.
        if longest == f64::INFINITY {
            return longest;
        }
        // Scaled by the longest side, so that squares neither overflow nor underflow.
        let scaled = |side: f64| mul_up(div_up(side, longest), div_up(side, longest));
        mul_up(longest, sqrt_up(add_up(add_up(scaled(x), scaled(y)), scaled(z))))
    }
}
