//! `SnapGrid`: integer coordinates for the plane, fine enough that rounding to them is far below any budget.
use crate::math::{greater, mul_up};
use std::cmp::Ordering;

/// A point of the grid, relative to its origin.
pub(crate) type GridPoint = [i64; 2];

/// Bits of a coordinate relative to the origin. Chosen: with 36, products of three differences and a half
/// stay below 2^127.
const BITS: i32 = 36;

/// A square grid whose points are exact in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SnapGrid {
    /// A power of two.
    step: f64,
    /// The origin, in steps.
    origin: GridPoint,
}

impl SnapGrid {
    /// The finest grid for a box of finite numbers below 1e150.
    pub fn new([low, high]: [[f64; 2]; 2]) -> Self {
        let extent = greater(high[0] - low[0], high[1] - low[1]);
        let reach = low.iter().chain(&high).fold(0.0, |largest, x| greater(largest, x.abs()));
        // Coordinates are below 2^53 steps, so that they are exact in f64, and the box is at most 2^BITS
        // wide.
        let exponent = (exponent(extent) + 1 - BITS).max(exponent(reach) + 1 - 52).max(-1022);
        let step = f64::from_bits(((exponent + 1023) as u64) << 52);
        let middle = |k: usize| (low[k] / 2.0 + high[k] / 2.0) / step;
        Self { step, origin: [middle(0).round() as i64, middle(1).round() as i64] }
    }

    /// The nearest grid point.
    pub fn snap(&self, p: [f64; 2]) -> GridPoint {
        // The quotient by a power of two is exact, and so is its nearest integer.
        [0, 1].map(|k| (p[k] / self.step).round() as i64 - self.origin[k])
    }

    /// The exact coordinates of a grid point.
    pub fn restore(&self, p: GridPoint) -> [f64; 2] {
        [0, 1].map(|k| (p[k] + self.origin[k]) as f64 * self.step)
    }

    /// The largest distance that a contour moves: half a diagonal of a cell when its corners are snapped, and
    /// again when it is rerouted through the hot cells.
    pub fn moved_at_most(&self) -> f64 {
        mul_up(std::f64::consts::SQRT_2.next_up(), self.step)
    }
}

/// The exponent of the largest power of two that is at most a number, and at least that of the smallest
/// normal one.
fn exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// Twice the area of the triangle, positive for a left turn.
pub(crate) fn turn(a: GridPoint, b: GridPoint, c: GridPoint) -> i128 {
    let d = |p: GridPoint, k: usize| i128::from(p[k] - a[k]);
    d(b, 0) * d(c, 1) - d(b, 1) * d(c, 0)
}

/// The side of the line from `a` to `b` on which `c` lies: left is greater.
#[inline]
pub(crate) fn side(a: GridPoint, b: GridPoint, c: GridPoint) -> Ordering {
    // Differences are exact in f64 up to 2^53; the products and their difference lose three units of 2⁻⁵³ of
    // the sizes.
    let d = |p: GridPoint, k: usize| (p[k] - a[k]) as f64;
    let (left, right) = (d(b, 0) * d(c, 1), d(b, 1) * d(c, 0));
    let side = left - right;
    if side.abs() > 2.0 * f64::EPSILON * (left.abs() + right.abs()) {
        return if side > 0.0 { Ordering::Greater } else { Ordering::Less };
    }
    turn(a, b, c).cmp(&0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_the_grid_are_numbers_exactly_at_every_scale() {
        for (low, high) in [
            ([0.0, 0.0], [1.0, 1.0]),
            ([1e6, -3e6], [1e6 + 0.5, -3e6 + 2.0]),
            ([-1e-300, 0.0], [1e-300, 3e-300]),
            ([-1e149, 0.0], [1e149, 5.0]),
            ([7.0, 7.0], [7.0, 7.0]),
        ] {
            let grid = SnapGrid::new([low, high]);
            for p in [low, high, [low[0] + (high[0] - low[0]) / 3.0, low[1] + (high[1] - low[1]) / 3.0]] {
                let snapped = grid.snap(p);
                assert!(snapped.iter().all(|x| x.abs() <= 1 << BITS), "{snapped:?}");
                let back = grid.restore(snapped);
                assert_eq!(grid.snap(back), snapped);
                assert!((0..2).all(|k| (back[k] - p[k]).abs() <= grid.step / 2.0), "{p:?} {back:?}");
            }
        }
    }
}
