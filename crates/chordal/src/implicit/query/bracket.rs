//! `RootBracket`: a bracket around a sign change on a beam, narrowed by regula falsi.

use crate::math::{greater, lesser};

/// A position outside and one inside, with their values. Outside, `f` is 0 or more, or NaN.
#[derive(Clone, Copy, Debug)]
pub(super) struct RootBracket {
    outside: [f64; 2],
    inside: [f64; 2],
    /// The end that moved last: 1 inside, −1 outside, 0 none.
    last: i8,
    steps_left: u8,
    /// The width three steps ago: if secants have not halved it in three steps, a bisection follows.
    before: f64,
}

/// The most values for one root. Derived: 53 halvings of a bracket exhaust the digits of a position, and a
/// third of the steps halve.
const MOST: u8 = 160;

impl RootBracket {
    pub fn new(outside: [f64; 2], inside: [f64; 2]) -> Self {
        Self { outside, inside, last: 0, steps_left: MOST, before: f64::INFINITY }
    }

    /// The end inside, if the bracket is at most `width` wide or no steps are left.
    pub fn root_within(&self, width: f64) -> Option<f64> {
        (self.inside[0] - self.outside[0] <= width || self.steps_left == 0).then_some(self.inside[0])
    }

    /// The next position to evaluate.
    pub fn next_guess(&mut self, width: f64) -> f64 {
        let ([a, fa], [b, fb]) = (self.outside, self.inside);
        let span = b - a;
        let halve = if self.steps_left.is_multiple_of(3) {
            // A bisection every third step alone would be slow: the two secant steps before it must
            // contribute.
            let slow = span > 0.4 * self.before;
            self.before = span;
            slow
        } else {
            false
        };
        self.steps_left -= 1;
        let share = fa / (fa - fb);
        // Also if the value outside is NaN or infinite.
        if halve || !(share.is_finite() && (0.0..=1.0).contains(&share)) {
            return a + 0.5 * span;
        }
        // Keep half of the desired width from either end, so that the other end comes near too.
        let x = a + share * span;
        let (low, high) = (a + 0.5 * width, b - 0.5 * width);
        let x = greater(low, x);
        lesser(high, x)
    }

    /// Takes the value at a position. When one end moves twice in a row, the value of the other end is scaled
    /// down.
    ///
    /// Source: N. Anderson, Å. Björck, *A new high order method of regula falsi type*, 1973.
    pub fn update(&mut self, x: f64, value: f64) {
        let factor = |moved: f64| {
            let m = 1.0 - value / moved;
            if m > 0.0 { m } else { 0.5 }
        };
        if value < 0.0 {
            if self.last == 1 {
                self.outside[1] *= factor(self.inside[1]);
            }
            self.inside = [x, value];
            self.last = 1;
        } else {
            if self.last == -1 {
                self.inside[1] *= factor(self.outside[1]);
            }
            self.outside = [x, value];
            self.last = -1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solve(f: &dyn Fn(f64) -> f64, width: f64) -> (f64, usize) {
        let mut root = RootBracket::new([0.0, f(0.0)], [1.0, f(1.0)]);
        for n in 0.. {
            if let Some(x) = root.root_within(width) {
                return (x, n);
            }
            let x = root.next_guess(width);
            root.update(x, f(x));
        }
        unreachable!()
    }

    #[test]
    fn finds_smooth_roots_fast_and_hard_ones_at_last() {
        // The fourth function loses digits to cancellation only where it is flat.
        let smooth: [(&dyn Fn(f64) -> f64, f64); 2] =
            [(&|x| 0.3 - x * x, 0.3_f64.sqrt()), (&|x| 1e-300 * (0.7 - x), 0.7)];
        for (f, truth) in smooth {
            let (x, n) = solve(f, 1e-13); // half of it derived from the assertion below
            assert!((x - truth).abs() <= 2e-13 && n <= 12, "{x} after {n}"); // measured: 8
        }
        let step = |x: f64| if x < 0.123 { 1e9 } else { -1e-9 }; // a step of very different heights, exact
        let undefined_outside = |x: f64| if x < 0.9 { f64::NAN } else { -1.0 };
        assert!((solve(&step, 1e-13).0 - 0.123).abs() <= 2e-13); // derived from the width
        assert!((solve(&undefined_outside, 1e-13).0 - 0.9).abs() <= 2e-13); // derived from the width
    }
}
