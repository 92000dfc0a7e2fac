//! Circles as polygons: how many sides they take for a length, and their corners.
use crate::math::elementary::{asin, sin, sin_cos};
use crate::math::{add_up, mul_up};

/// The most sides of a quarter turn. Chosen: 65,536 a turn.
const MOST: u32 = 1 << 14;

/// The least number of sides of a quarter of a circle whose sagitta is within a length. None where there are too many.
///
/// The sagitta of a side over the angle a is r (1 − cos(a/2)) = 2 r sin²(a/4), and a = π / (2 n).
pub(super) fn quarter_sides(radius: f64, length: f64) -> Option<u32> {
    if radius <= 0.0 {
        return Some(1);
    }
    let half = (0.5 * length / radius).sqrt();
    let guess = if half < 1.0 { std::f64::consts::FRAC_PI_8 / asin(half) } else { 1.0 };
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
pub(super) fn sagitta(radius: f64, n: u32) -> f64 {
    let s = sin(std::f64::consts::FRAC_PI_8 / f64::from(n));
    // Derived: the angle is off by 2 u, the sine by 2 u, and the square of both by 8 u, the products by 3 u.
    mul_up(mul_up(2.0 * radius, mul_up(s, s)), add_up(1.0, 16.0 * f64::EPSILON))
}

/// The points of the unit circle at the corners of its first quarter, both ends included, exact there, and mirror images of
/// each other about the diagonal.
pub(super) fn quarter(n: u32) -> Vec<[f64; 2]> {
    let step = std::f64::consts::FRAC_PI_2 / f64::from(n);
    let at = |k: u32| {
        if k == 0 {
            return [1.0, 0.0];
        }
        if 2 * k == n {
            return [std::f64::consts::FRAC_1_SQRT_2; 2];
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

/// The corners of the whole unit circle, counter-clockwise from (1, 0), the same in each quarter to the last bit.
pub(super) fn turn(n: u32) -> Vec<[f64; 2]> {
    let quarter = quarter(n);
    let turned: [fn([f64; 2]) -> [f64; 2]; 4] =
        [|p| p, |[x, y]| [-y, x], |[x, y]| [-x, -y], |[x, y]| [y, -x]];
    // Adding zero makes −0 one with 0.
    let plain = |p: [f64; 2]| p.map(|x| x + 0.0);
    turned.iter().flat_map(|turn| quarter[..n as usize].iter().map(|p| plain(turn(*p)))).collect()
}
