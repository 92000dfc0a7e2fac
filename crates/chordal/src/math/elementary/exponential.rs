//! The exponential and the natural logarithm.
//!
//! Source of both reductions: W. J. Cody and W. M. Waite, *Software Manual for the Elementary
//! Functions*, 1980.
use super::trigonometric::TO_WHOLE;

/// ln 2 as a sum: 42 bits, so that the product with an exponent is exact, and the next 53. Derived with 300
/// bits.
const LN_2: [f64; 2] = [f64::from_bits(0x3fe6_2e42_fefa_3800), f64::from_bits(0x3d2e_f357_93c7_6730)];

/// 2ⁿ for an integer |n| below 1000, by its bits.
#[inline(always)]
fn power_of_two(n: f64) -> f64 {
    f64::from_bits((n + TO_WHOLE).to_bits().wrapping_add(1023) << 52)
}

/// `eˣ`, within 2 u of itself and 2⁻¹⁰⁷⁴: ∞ from 709.79 on, 0 from −745.2 down.
///
/// x = k ln 2 + r + rest with |r| ≤ 0.3466. k·LN_2\[0\] and the difference from x are exact; `rest` keeps the
/// rounding error of the second difference, so r + rest is off by less than 2⁻⁸⁵. eʳ = 1 + (r + (r² P + rest
/// (1 + r))): r² P is at most 0.068 (0.054 below 0) and rounds by 4 u of that; adding r rounds by 0.42 u at
/// most (0.3 u below 0); the last sum by u, which is 1.72 u of the smallest and 1.7 u of the largest eʳ. The
/// first omitted term is r¹⁴/14!, below 2⁻⁵⁷. The power of two is multiplied in halves: exact, or one
/// rounding of a number that is too small for its last place.
///
/// ```
/// use chordal::math::elementary::exp;
/// assert_eq!(exp(1.0), std::f64::consts::E);
/// assert_eq!((exp(-800.0), exp(800.0)), (0.0, f64::INFINITY));
/// ```
#[must_use]
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    // Beyond these ends the result is ∞ or 0 in any case, and each half of k has to stay an
    // exponent of a normal number. NaN fails both comparisons, and stays.
    let x = if x > 710.0 { 710.0 } else { x };
    let x = if x < -746.0 { -746.0 } else { x };
    let k = (x * std::f64::consts::LOG2_E + TO_WHOLE) - TO_WHOLE;
    let a = x - k * LN_2[0];
    let b = k * LN_2[1];
    let r = a - b;
    let rest = (a - r) - b;
    let mut p = 1.0 / 6_227_020_800.0;
    p = 1.0 / 479_001_600.0 + r * p;
    p = 1.0 / 39_916_800.0 + r * p;
    p = 1.0 / 3_628_800.0 + r * p;
    p = 1.0 / 362_880.0 + r * p;
    p = 1.0 / 40_320.0 + r * p;
    p = 1.0 / 5040.0 + r * p;
    p = 1.0 / 720.0 + r * p;
    p = 1.0 / 120.0 + r * p;
    p = 1.0 / 24.0 + r * p;
    p = 1.0 / 6.0 + r * p;
    p = 1.0 / 2.0 + r * p;
    let y = 1.0 + (r + (r * r * p + rest * (1.0 + r)));
    let half = (0.5 * k + TO_WHOLE) - TO_WHOLE;
    y * power_of_two(half) * power_of_two(k - half)
}

/// The natural logarithm, within 3 u of itself: −∞ at 0, NaN below.
///
/// x = 2ᵏ (1 + f) with 1 + f in [√½, √2], exactly; with s = f/(2 + f), ln(1 + f) = f − (f²/2 − s (f²/2 +
/// R(s²))), where R = s² (2/3 + 2/5 s² + …). The first omitted term is below 2⁻⁶⁰ of the result. For k = 0:
/// f²/2 ≤ 0.086 rounds by u of itself, s (f²/2 + R) ≤ 0.0182 by 6 u, their difference by 0.07 u: 0.27 u
/// absolute beside a result of 0.3466, less for smaller f, so 1.8 u with the last rounding. For k ≠ 0
/// subtracting f rounds by another 0.35 u, beside a result of 0.3466 or more: 2.8 u.
///
/// ```
/// use chordal::math::elementary::ln;
/// assert_eq!((ln(1.0), ln(0.0)), (0.0, f64::NEG_INFINITY));
/// assert_eq!(ln(2.0), std::f64::consts::LN_2);
/// assert!(ln(-1.0).is_nan());
/// ```
#[must_use]
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    // 2⁵⁴ makes the smallest numbers normal.
    let small = x < f64::MIN_POSITIVE;
    let scaled = if small { x * 18_014_398_509_481_984.0 } else { x };
    let bits = scaled.to_bits();
    // The exponent as a number: its bits become the last places of 2⁵², which is then subtracted.
    let exponent = f64::from_bits((bits >> 52) | 0x4330_0000_0000_0000) - 4_503_599_627_370_496.0;
    let m = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    let upper = m > std::f64::consts::SQRT_2;
    let f = if upper { 0.5 * m } else { m } - 1.0;
    let bias = if small { 1077.0 } else { 1023.0 };
    let k = exponent - if upper { bias - 1.0 } else { bias };
    let s = f / (2.0 + f);
    let z = s * s;
    let mut r = 2.0 / 21.0;
    r = 2.0 / 19.0 + z * r;
    r = 2.0 / 17.0 + z * r;
    r = 2.0 / 15.0 + z * r;
    r = 2.0 / 13.0 + z * r;
    r = 2.0 / 11.0 + z * r;
    r = 2.0 / 9.0 + z * r;
    r = 2.0 / 7.0 + z * r;
    r = 2.0 / 5.0 + z * r;
    r = 2.0 / 3.0 + z * r;
    let half = 0.5 * f * f;
    // From the smallest terms to the largest. k·LN_2[0] is exact, so only this last difference
    // rounds it.
    let y = k * LN_2[0] - ((half - (s * (half + z * r) + k * LN_2[1])) - f);
    // The bits of 0, ∞ and NaN have no meaning as exponent and fraction; ∞ and NaN stay what they
    // are.
    let y = if x == 0.0 { f64::NEG_INFINITY } else { y };
    let y = if x < f64::INFINITY { y } else { x };
    if x >= 0.0 { y } else { f64::NAN }
}
