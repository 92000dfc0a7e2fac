//! Common growth directions: directions along which functions grow together throughout a cell, from ranges of
//! their gradients.
use crate::math::{Interval, dot, greater, length, lesser};

/// A range of gradients, scaled so that its middle has length 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct GradientBox {
    pub middle: [f64; 3],
    pub half: [f64; 3],
}

/// Steps of Gilbert's method. Measured on the models of the tests: more than 24 find no further directions.
const STEPS: usize = 24;
/// Functions have to grow along a direction by at least this fraction of their gradient. Defined: three roundings of a
/// double are far below, the angle of a wedge of 10⁻⁵ degrees is far above.
const LEAST: f64 = 1e-7;

impl GradientBox {
    /// `None` if the middle of the range has no direction.
    pub fn from_range(gradient: &[Interval; 3]) -> Option<Self> {
        let middle = gradient.each_ref().map(|d| 0.5 * (d.lo() + d.hi()));
        let size = length(middle);
        if size.is_nan() || size <= 0.0 || size.is_infinite() {
            return None;
        }
        Some(Self {
            middle: middle.map(|x| x / size),
            half: gradient.each_ref().map(|d| 0.5 * (d.hi() - d.lo()) / size),
        })
    }

    /// The gradients of the negated function.
    pub fn negated(&self) -> Self {
        Self { middle: self.middle.map(|x| -x), ..*self }
    }

    /// The least growth along the best direction, relative to the middle gradient.
    pub fn growth(&self) -> f64 {
        length::<3>(std::array::from_fn(|k| {
            let near = self.middle[k].abs() - self.half[k];
            greater(near, 0.0)
        }))
    }

    /// The gradient that grows least along `n`.
    fn lowest(&self, n: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| {
            if n[k] > 0.0 { self.middle[k] - self.half[k] } else { self.middle[k] + self.half[k] }
        })
    }
}

/// Whether there is a direction along which all functions grow throughout: whether 0 is outside of the convex hull
/// of all boxes. Then the direction is the hull's point nearest to 0.
///
/// Source: E. Gilbert, *An Iterative Procedure for Computing the Minimum of a Quadratic Form on a Convex
/// Set*, 1966.
pub(super) fn grow_together(boxes: &[GradientBox]) -> bool {
    let mut x = [0.0; 3];
    for part in boxes {
        (0..3).for_each(|k| x[k] += part.middle[k] / boxes.len() as f64);
    }
    for _ in 0..STEPS {
        let size_sq = dot(x, x);
        if size_sq < LEAST * LEAST {
            return false;
        }
        // The point of the hull that is lowest along x.
        let mut lowest = boxes[0].lowest(x);
        for part in &boxes[1..] {
            let p = part.lowest(x);
            if dot(x, p) < dot(x, lowest) {
                lowest = p;
            }
        }
        let growth = dot(x, lowest);
        // All boxes are beyond the plane across x through `lowest`, so x is such a direction already, nearest
        // point or not.
        if growth > LEAST * size_sq.sqrt() {
            return true;
        }
        // Moves x to the point nearest to 0 on the segment from x to `lowest`.
        // The step is not 0, since otherwise the growth would have been |x|².
        let step: [f64; 3] = std::array::from_fn(|k| lowest[k] - x[k]);
        let share = -dot(x, step) / dot(step, step);
        let share = lesser(1.0, share);
        x = std::array::from_fn(|k| x[k] + share * step[k]);
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(middle: [f64; 3], half: f64) -> GradientBox {
        let size = length(middle);
        GradientBox { middle: middle.map(|x| x / size), half: [half; 3] }
    }

    #[test]
    fn independent_gradients_grow_together_and_opposite_ones_do_not() {
        let (x, y, z) = (at([1.0, 0.0, 0.0], 0.1), at([0.0, 1.0, 0.0], 0.1), at([0.0, 0.0, 1.0], 0.1));
        assert!(grow_together(&[x, y, z]) && grow_together(&[x.negated(), y, z.negated()]));
        assert!(!grow_together(&[x, x.negated()]));
        assert!(!grow_together(&[at([1.0, 1.0, 0.0], 0.8)]));
        // A wedge of half a degree.
        assert!(grow_together(&[at([1.0, 0.004, 0.0], 0.0), at([-1.0, 0.004, 0.0], 0.0)]));
        // All three around an axis, with 0 within the hull.
        let around = [0.0, 2.0, 4.0].map(|a: f64| at([libm::cos(a), libm::sin(a), 0.0], 0.05));
        assert!(!grow_together(&around));
        assert!(grow_together(&around[..2]));
        assert!((x.growth() - 0.9).abs() < 1e-12);
    }
}
