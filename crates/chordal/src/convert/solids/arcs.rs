//! Circles as polygons: how many sides they take for a length, and their corners.
use crate::math::elementary::{acos, asin, sin, sin_cos};
use crate::math::{add_up, greater, mul_up};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_8};

/// The most sides of a quarter turn. Chosen: 65,536 a turn.
const MOST: u32 = 1 << 14;

/// The circle of radius 1 as a polygon that is the same in each quarter.
///
/// Its corners on both axes lie on the circle, so that flat sides that touch it there stay flush. All others lie outside of
/// it, and its sides cut it as deep: with them half as many sides again would be needed if all corners lay on the circle.
pub(super) struct UnitCircle {
    /// The corners of the first quarter, both ends included.
    pub quarter: Vec<[f64; 2]>,
    /// What it is off the circle by, rounded up: along every ray from the middle its side is so near to the circle, and so is
    /// a copy of it that lies on one side of the circle ([`super::CLAIM_ROOM`]).
    pub off: f64,
}

impl UnitCircle {
    /// The polygon with the fewest sides of those that are within a length of a circle with this radius. None where there
    /// are too many.
    pub fn new(radius: f64, length: f64) -> Option<Self> {
        if radius <= 0.0 {
            return Some(Self::of(1));
        }
        // Rounding is a share of what is allowed, so that a circle of many sides needs one more at most.
        let most = length / radius;
        let mut n = 1;
        if most < 1.0 {
            let spread = Spread::new(most);
            let more = (FRAC_PI_2 - 2.0 * spread.end) / (2.0 * spread.half_side);
            if more.is_nan() || more > f64::from(MOST) {
                return None;
            }
            n = if more > 0.0 { 1 + more.ceil() as u32 } else { 1 };
        }
        loop {
            let made = Self::of(n);
            if mul_up(made.off, radius) <= length {
                return Some(made);
            }
            n += 1;
            if n > MOST {
                return None;
            }
        }
    }

    /// The polygon with `n` sides a quarter that is nearest to the circle.
    fn of(n: u32) -> Self {
        let spread = Spread::of_sides(n);
        let at = |k: u32| {
            if k == 0 {
                return [1.0, 0.0];
            }
            let far = 1.0 + spread.off;
            if 2 * k == n {
                return [far * FRAC_1_SQRT_2; 2];
            }
            let (sin, cos) = sin_cos(spread.end + f64::from(2 * k - 1) * spread.half_side);
            [far * cos, far * sin]
        };
        let quarter: Vec<[f64; 2]> = (0..=n)
            .map(|k| {
                let [x, y] = at(k.min(n - k));
                if 2 * k <= n { [x, y] } else { [y, x] }
            })
            .collect();
        let off = quarter.windows(2).fold(0.0, |most, side| greater(off_of_side(side[0], side[1]), most));
        Self { quarter, off }
    }

    /// The corners of the whole turn, counter-clockwise from (1, 0), the same in each quarter to the last bit.
    pub fn turn(&self) -> Vec<[f64; 2]> {
        let turned: [fn([f64; 2]) -> [f64; 2]; 4] =
            [|p| p, |[x, y]| [-y, x], |[x, y]| [-x, -y], |[x, y]| [y, -x]];
        // Adding zero makes −0 one with 0.
        let plain = |p: [f64; 2]| p.map(|x| x + 0.0);
        let open = &self.quarter[..self.quarter.len() - 1];
        turned.iter().flat_map(|turn| open.iter().map(|p| plain(turn(*p)))).collect()
    }
}

/// How the sides of a quarter share its angle, if corners are as far outside of the circle as sides are inside.
struct Spread {
    off: f64,
    /// Half of the angle of a side with both corners outside.
    half_side: f64,
    /// The angle of a side with one corner on the circle, less that.
    end: f64,
}

impl Spread {
    fn new(off: f64) -> Self {
        Self { off, half_side: acos((1.0 - off) / (1.0 + off)), end: acos(1.0 - off) }
    }

    /// For `n` sides a quarter. A side from the circle takes `end + half_side`, others twice that half, and the whole grows
    /// with what it is off by.
    fn of_sides(n: u32) -> Self {
        let turns = |off: f64| {
            let own = Self::new(off);
            2.0 * own.end + f64::from(2 * (n - 1)) * own.half_side
        };
        let (mut low, mut high) = (0.0, 0.5);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * low + 0.5 * high;
            if turns(middle) < FRAC_PI_2 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Self::new(high)
    }
}

/// Derived: for 65,536 sides a turn it is above 2⁻³², and 24 more bits of it are known. What they leave is in the bound, which
/// is that of the corners.
const BISECTIONS: usize = 56;

/// How far the points of a side are from the circle of radius 1 along their rays, rounded up; and how far corners have to move
/// along theirs until the middle is there, by what the side is nearer to the middle than they are.
fn off_of_side(p: [f64; 2], q: [f64; 2]) -> f64 {
    let reach = |[x, y]: [f64; 2]| (x * x + y * y).sqrt();
    let along = reach([q[0] - p[0], q[1] - p[1]]);
    let nearest = (p[0] * q[1] - p[1] * q[0]) / along;
    let farthest = greater(reach(p), reach(q));
    // Derived: sums and products of numbers below 2 are off by a few units, over the length of a side, which is above
    // 2⁻¹⁵; and the height of a side's line changes by its square alone where a corner moves along it.
    let rounding = 64.0 * f64::EPSILON;
    add_up(greater(farthest - 1.0, 1.0 - nearest) * farthest / nearest, rounding)
}

/// The least number of sides of a quarter of a circle whose sagitta is within a length, if all corners are on it. None where
/// there are too many.
///
/// The sagitta of a side over the angle a is r (1 − cos(a/2)) = 2 r sin²(a/4), and a = π / (2 n).
pub(super) fn quarter_sides(radius: f64, length: f64) -> Option<u32> {
    if radius <= 0.0 {
        return Some(1);
    }
    let half = (0.5 * length / radius).sqrt();
    let guess = if half < 1.0 { FRAC_PI_8 / asin(half) } else { 1.0 };
    if guess.is_nan() || guess > f64::from(MOST) {
        return None;
    }
    // The guess is rounded, and whether it is enough is known from its own sagitta.
    let mut n = if guess > 1.0 { guess.ceil() as u32 } else { 1 };
    while sagitta(radius, n) > length {
        n += 1;
        if n > MOST {
            return None;
        }
    }
    Some(n)
}

/// The sagitta of a circle whose quarters have `n` sides, rounded up.
fn sagitta(radius: f64, n: u32) -> f64 {
    let s = sin(FRAC_PI_8 / f64::from(n));
    // Derived: the angle is off by 2 u, the sine by 2 u, and the square of both by 8 u, the products by 3 u.
    mul_up(mul_up(2.0 * radius, mul_up(s, s)), add_up(1.0, 16.0 * f64::EPSILON))
}

/// The points of the unit circle at the corners of its first quarter, both ends included, exact there, and mirror images of
/// each other about the diagonal.
pub(super) fn quarter(n: u32) -> Vec<[f64; 2]> {
    let step = FRAC_PI_2 / f64::from(n);
    let at = |k: u32| {
        if k == 0 {
            return [1.0, 0.0];
        }
        if 2 * k == n {
            return [FRAC_1_SQRT_2; 2];
        }
        let (sin, cos) = sin_cos(f64::from(k) * step);
        [cos, sin]
    };
    (0..=n)
        .map(|k| {
            let [x, y] = at(k.min(n - k));
            if 2 * k <= n { [x, y] } else { [y, x] }
        })
        .collect()
}
