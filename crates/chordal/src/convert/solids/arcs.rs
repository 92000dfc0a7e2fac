//! Circles as polygons: the number of sides for a length, and the corners.
use crate::math::elementary::{acos, asin, sin, sin_cos};
use crate::math::{add_up, greater, mul_up};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_8};

/// The most sides of a quarter turn. Chosen: 65,536 a turn.
const MOST: u32 = 1 << 14;

/// The circle of radius 1 as a polygon that is the same in each quarter.
///
/// Its corners on both axes lie on the circle, so that flat sides that touch the circle there stay flush. All other corners
/// lie outside of the circle by as much as the sides cut into it. If all corners were on the circle, half as many sides
/// again would be needed.
pub(super) struct UnitCircle {
    /// The corners of the first quarter, both ends included.
    pub quarter: Vec<[f64; 2]>,
    /// Its distance from the circle, rounded up: it holds along every ray from the middle, and also for a scaled copy of
    /// the polygon that lies on one side of the circle ([`super::PROOF_MARGIN`]).
    pub distance: f64,
}

impl UnitCircle {
    /// The polygon with the fewest sides that is within a length of the circle with this radius; `None` if there
    /// are too many.
    pub fn new(radius: f64, length: f64) -> Option<Self> {
        if radius <= 0.0 {
            return Some(Self::of(1));
        }
        // `n` from the closed form is right up to rounding, so that at most one more side is needed.
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
            let circle = Self::of(n);
            if mul_up(circle.distance, radius) <= length {
                return Some(circle);
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
            let radius = 1.0 + spread.distance;
            if 2 * k == n {
                return [radius * FRAC_1_SQRT_2; 2];
            }
            let (sin, cos) = sin_cos(spread.end + f64::from(2 * k - 1) * spread.half_side);
            [radius * cos, radius * sin]
        };
        let quarter: Vec<[f64; 2]> = (0..=n)
            .map(|k| {
                // The second half mirrors the first, so that the polygon is symmetric to the last bit.
                let [x, y] = at(k.min(n - k));
                if 2 * k <= n { [x, y] } else { [y, x] }
            })
            .collect();
        let distance =
            quarter.windows(2).fold(0.0, |most, side| greater(side_distance(side[0], side[1]), most));
        Self { quarter, distance }
    }

    /// The corners of the whole circle, counter-clockwise from (1, 0), the same in each quarter to the last bit.
    pub fn turn(&self) -> Vec<[f64; 2]> {
        let turned: [fn([f64; 2]) -> [f64; 2]; 4] =
            [|p| p, |[x, y]| [-y, x], |[x, y]| [-x, -y], |[x, y]| [y, -x]];
        // Adding zero turns −0 into 0, so that equal points have equal bits.
        let plain = |p: [f64; 2]| p.map(|x| x + 0.0);
        let open = &self.quarter[..self.quarter.len() - 1];
        turned.iter().flat_map(|turn| open.iter().map(|p| plain(turn(*p)))).collect()
    }
}

/// The angles of a quarter's sides, if corners are as far outside of the circle as sides are inside.
struct Spread {
    distance: f64,
    /// Half of the angle of a side with both corners outside.
    half_side: f64,
    /// The angle of a side with one corner on the circle, less `half_side`.
    end: f64,
}

impl Spread {
    fn new(distance: f64) -> Self {
        Self { distance, half_side: acos((1.0 - distance) / (1.0 + distance)), end: acos(1.0 - distance) }
    }

    /// For `n` sides a quarter. A side with one corner on the circle takes the angle `end + half_side`, others twice
    /// `half_side`; the sum grows with the distance, which is found by bisection.
    fn of_sides(n: u32) -> Self {
        let angle = |distance: f64| {
            let spread = Self::new(distance);
            2.0 * spread.end + f64::from(2 * (n - 1)) * spread.half_side
        };
        let (mut low, mut high) = (0.0, 0.5);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * low + 0.5 * high;
            if angle(middle) < FRAC_PI_2 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Self::new(high)
    }
}

/// Bisections of the distance. Derived: for 65,536 sides it is above 2⁻³², so that 24 of its bits are found. The error that
/// remains is in the bound, which is computed from the corners.
const BISECTIONS: usize = 56;

/// The largest distance between a side and the circle of radius 1 along a ray, rounded up. It also covers the distance by
/// which corners have to move along their rays until the side's nearest point is on the circle.
fn side_distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    let reach = |[x, y]: [f64; 2]| (x * x + y * y).sqrt();
    let along = reach([q[0] - p[0], q[1] - p[1]]);
    let nearest = (p[0] * q[1] - p[1] * q[0]) / along;
    let farthest = greater(reach(p), reach(q));
    // Derived: sums and products of numbers below 2 have errors of a few units, divided by the length of a side, which
    // is above 2⁻¹⁵; if a corner moves along its side, the height of the side's line changes by the square of that only.
    let rounding = 64.0 * f64::EPSILON;
    add_up(greater(farthest - 1.0, 1.0 - nearest) * farthest / nearest, rounding)
}

/// The least number of sides of a quarter of a circle whose sagitta is within a length, if all corners are on the circle;
/// `None` if there are too many.
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
    // The guess is rounded; its own sagitta shows whether it is enough.
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
    // Derived: the errors are 2 u of the angle, 2 u of the sine, and so 8 u of its square, and 3 u of the products.
    mul_up(mul_up(2.0 * radius, mul_up(s, s)), add_up(1.0, 16.0 * f64::EPSILON))
}

/// The corners of the first quarter of the unit circle with `n` sides a quarter, all on the circle. Both ends are included
/// and exact; the corners are symmetric about the diagonal.
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
