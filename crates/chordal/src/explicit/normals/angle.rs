//! The angle of a direction without a call of `atan2`: as precise as a weight needs, and without a branch.
use crate::math::{greater, lesser};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The minimax polynomial in r² for atan(r)/r with 0 ≤ r ≤ 1, derived by the Remez exchange, with a relative
/// error of at most 3.4e-10.
const ATAN: [f64; 11] = [
    0.999_999_999_667_198_7,
    -0.333_333_247_188_107_9,
    0.199_996_306_024_442_07,
    -0.142_794_931_258_347_33,
    0.110_566_749_963_586_8,
    -0.088_069_066_659_326_39,
    0.067_346_325_159_135_6,
    -0.044_618_518_068_870_63,
    0.022_496_557_967_333_71,
    -0.007_304_087_810_824_867,
    0.001_112_075_934_014_951_2, // the last and smallest
];

/// The angles between the x axis and (x, y) for several x and one y ≥ 0, in [0, π], to 3.4e-10; π/2 for (0,
/// 0).
///
/// Each step is done for all x together, so that the compiler can vectorize it.
#[inline(always)]
pub(super) fn angles_of<const N: usize>(x: [f64; N], y: f64) -> [f64; N] {
    let lanes = |f: &dyn Fn(usize) -> f64| -> [f64; N] { std::array::from_fn(f) };
    let width = x.map(f64::abs);
    let long = lanes(&|k| greater(y, width[k]));
    let short = lanes(&|k| lesser(width[k], y));
    // Avoids 0/0: adding the smallest normal number changes no number whose square does not underflow.
    let r = lanes(&|k| short[k] / (long[k] + f64::MIN_POSITIVE));
    let q = lanes(&|k| r[k] * r[k]);
    let q2 = lanes(&|k| q[k] * q[k]);
    let q4 = lanes(&|k| q2[k] * q2[k]);
    let pair = |k: usize, i: usize| ATAN[i] + q[k] * ATAN[i + 1];
    let low = lanes(&|k| (pair(k, 0) + q2[k] * pair(k, 2)) + q4[k] * (pair(k, 4) + q2[k] * pair(k, 6)));
    let steep = lanes(&|k| r[k] * (low[k] + (q4[k] * q4[k]) * (pair(k, 8) + q2[k] * ATAN[10])));
    // Past 45° and past 90° the angle is mirrored; written with signs, since branches would be unpredictable.
    let upright = lanes(&|k| FRAC_PI_4 + (FRAC_PI_4 - steep[k]).copysign(y - width[k]));
    lanes(&|k| FRAC_PI_2 - (FRAC_PI_2 - upright[k]).copysign(x[k]))
}

/// The same angle by the same operations, as straight code without closures, so that a loop over many angles
/// is vectorized.
#[inline(always)]
pub(super) fn angle_in_lane(x: f64, y: f64) -> f64 {
    let width = x.abs();
    let long = greater(y, width);
    let short = lesser(width, y);
    let r = short / (long + f64::MIN_POSITIVE);
    let q = r * r;
    let q2 = q * q;
    let q4 = q2 * q2;
    let low = ((ATAN[0] + q * ATAN[1]) + q2 * (ATAN[2] + q * ATAN[3]))
        + q4 * ((ATAN[4] + q * ATAN[5]) + q2 * (ATAN[6] + q * ATAN[7]));
    let steep = r * (low + (q4 * q4) * ((ATAN[8] + q * ATAN[9]) + q2 * ATAN[10]));
    let upright = FRAC_PI_4 + (FRAC_PI_4 - steep).copysign(y - width);
    FRAC_PI_2 - (FRAC_PI_2 - upright).copysign(x)
}

/// The same for one angle.
#[inline]
pub(super) fn angle_of(x: f64, y: f64) -> f64 {
    let [angle] = angles_of([x], y);
    angle
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn angles_are_right_all_around() {
        let mut worst = 0.0_f64;
        for i in 0..=100_000 {
            let angle = f64::from(i) * 1e-5 * PI;
            let (x, y) = (3e5 * libm::cos(angle), 3e5 * libm::sin(angle).abs());
            worst = worst.max((angle_of(x, y) - libm::atan2(y, x)).abs());
            assert_eq!(angle_in_lane(x, y).to_bits(), angle_of(x, y).to_bits());
        }
        assert!(worst < 3.4e-10, "{worst:e}");
        for tiny in [1e-3, 1e-9, 1e-15] {
            // Mirroring forth and back costs roundings of a quarter turn.
            let error = (angle_of(1.0, tiny) - libm::atan2(tiny, 1.0)).abs();
            assert!(error < 3.4e-10 * tiny + 4.0 * f64::EPSILON, "{tiny:e}");
        }
        let expected =
            [((0.0, 0.0), FRAC_PI_2), ((1.0, 0.0), 0.0), ((-1.0, 0.0), PI), ((0.0, 1.0), FRAC_PI_2)];
        for ((x, y), angle) in expected {
            assert_eq!((angle_of(x, y), angle_in_lane(x, y)), (angle, angle));
        }
    }
}
