//! Sine, cosine and tangent: reduction by multiples of π/2 in three parts, then Taylor series on [−π/4, π/4].
//!
//! Source of the reduction: W. J. Cody and W. M. Waite, *Software Manual for the Elementary Functions*, 1980.
use super::payne_hanek::{self, ReducedAngle};

/// The largest absolute value for which arguments are reduced in floating point. Derived: 2¹⁶ quarter turns,
/// exactly 32768 π rounded down.
pub const NEAR: f64 = 102_943.0;

/// π/2 as a sum: two parts of 37 bits, so that their products with a number below 2¹⁶ are exact, and the next
/// 53 bits. The omitted part is below 2⁻¹³⁰. Derived with 300 bits.
const HALF_PI: [f64; 3] = [
    f64::from_bits(0x3ff9_21fb_5444_0000),
    f64::from_bits(0x3d86_8c23_4c4c_0000),
    f64::from_bits(0x3b29_8a2e_0370_7345),
];

/// 1.5 · 2⁵²: when it is added to a number below 2⁵¹, the low bits of the sum are the nearest integer.
pub(super) const TO_WHOLE: f64 = 6_755_399_441_055_744.0;

/// Reduces |x| ≤ [`NEAR`].
///
/// The products of n with the first two parts are exact, and so is the first difference: it is a multiple of
/// the last place of the smaller operand and below 1. The second and third differences keep their errors. The
/// losses are n·2⁻¹³⁰ of π/2 itself and n·2⁻¹²⁹ by rounding the third product, together below n·2⁻¹²⁸; and
/// `lo`'s own rounding, 2⁻¹⁰⁴ |hi|. For each n ≤ 2¹⁶ the nearest f64 was compared with n π/2: the distance is
/// never below n·2⁻⁶⁸, so the loss is below 2⁻⁶⁰ of the result, and the third product is so small beside it
/// that no difference cancels further.
#[inline(always)]
fn reduce(x: f64) -> ReducedAngle {
    let shifted = x * std::f64::consts::FRAC_2_PI + TO_WHOLE;
    let n = shifted - TO_WHOLE;
    let a = x - n * HALF_PI[0];
    let (b, b_rest) = difference(a, n * HALF_PI[1]);
    let (hi, hi_rest) = difference(b, n * HALF_PI[2]);
    ReducedAngle { hi, lo: hi_rest + b_rest, turns: shifted.to_bits() }
}

/// `a − b` and its rounding error, exactly (Knuth).
#[inline(always)]
fn difference(a: f64, b: f64) -> (f64, f64) {
    let d = a - b;
    let of_b = d - a;
    (d, (a - (d - of_b)) - (b + of_b))
}

/// sin(hi + lo), within 1.6 u of itself.
///
/// With z = hi²: the last addition rounds by u. The series beyond its first term is at most 0.103 |hi| and
/// rounds by 4.2 u of that, 0.47 u of the sine, which is at least 0.9 |hi|. `lo`'s factor is cos to z²/24 <
/// 0.016, so 0.04 u. The first omitted term is hi¹⁹/19!, 2⁻⁶³.
#[inline(always)]
fn sine(hi: f64, lo: f64) -> f64 {
    let z = hi * hi;
    let mut s = 1.0 / 355_687_428_096_000.0;
    s = -1.0 / 1_307_674_368_000.0 + z * s;
    s = 1.0 / 6_227_020_800.0 + z * s;
    s = -1.0 / 39_916_800.0 + z * s;
    s = 1.0 / 362_880.0 + z * s;
    s = -1.0 / 5040.0 + z * s;
    s = 1.0 / 120.0 + z * s;
    s = -1.0 / 6.0 + z * s;
    hi + (hi * (z * s) + lo * (1.0 - 0.5 * z))
}

/// cos(hi + lo), within 1.6 u of itself.
///
/// With z = hi²: rounding z costs 0.31 u, the series from z² on 0.07 u, both absolute and at most 0.54 u of
/// the cosine, which is at least 0.7; the last addition rounds by u; the rounding error of 1 − z/2 is kept.
/// The first omitted term is hi¹⁸/18!, below 2⁻⁵⁸.
#[inline(always)]
fn cosine(hi: f64, lo: f64) -> f64 {
    let z = hi * hi;
    let mut c = 1.0 / 20_922_789_888_000.0;
    c = -1.0 / 87_178_291_200.0 + z * c;
    c = 1.0 / 479_001_600.0 + z * c;
    c = -1.0 / 3_628_800.0 + z * c;
    c = 1.0 / 40_320.0 + z * c;
    c = -1.0 / 720.0 + z * c;
    c = 1.0 / 24.0 + z * c;
    let half = 0.5 * z;
    let leading = 1.0 - half;
    // (1 − leading) − half is exactly what rounding took from `leading`.
    leading + (((1.0 - leading) - half) + (z * (z * c) - hi * lo))
}

/// The sine or cosine after `turns` more quarter turns.
#[inline(always)]
fn rotate_quarters(sine: f64, cosine: f64, turns: u64) -> f64 {
    let value = if turns & 1 == 0 { sine } else { cosine };
    f64::from_bits(value.to_bits() ^ ((turns & 2) << 62))
}

#[inline(always)]
fn sin_cos_reduced(at: ReducedAngle) -> (f64, f64) {
    let (s, c) = (sine(at.hi, at.lo), cosine(at.hi, at.lo));
    (rotate_quarters(s, c, at.turns), rotate_quarters(s, c, at.turns.wrapping_add(1)))
}

/// [`sin_cos`] for |x| ≤ [`NEAR`]; no branch.
#[inline(always)]
pub(crate) fn sin_cos_near(x: f64) -> (f64, f64) {
    let (s, c) = sin_cos_reduced(reduce(x));
    (if x == 0.0 { x } else { s }, c)
}

/// The sine and the cosine of `x` radians; NaN if `x` is not finite.
#[must_use]
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if x.abs() <= NEAR { sin_cos_near(x) } else { sin_cos_far(x) }
}

#[inline(never)]
fn sin_cos_far(x: f64) -> (f64, f64) {
    if x.is_finite() { sin_cos_reduced(payne_hanek::reduce(x)) } else { (f64::NAN, f64::NAN) }
}

/// The sine of `x` radians, within 2 u of itself; NaN if `x` is not finite.
///
/// ```
/// use chordal::math::elementary::sin;
/// assert_eq!(sin(0.5), 0.479425538604203);
/// assert_eq!(sin(1e22), -0.8522008497671888);
/// ```
#[must_use]
#[inline]
pub fn sin(x: f64) -> f64 {
    sin_cos(x).0
}

/// The cosine of `x` radians, within 2 u of itself; NaN if `x` is not finite.
#[must_use]
#[inline]
pub fn cos(x: f64) -> f64 {
    sin_cos(x).1
}

/// The tangent of `x` radians, within 6 u of itself: the quotient of two values within 2 u, rounded once
/// more.
#[must_use]
#[inline]
pub fn tan(x: f64) -> f64 {
    let (s, c) = sin_cos(x);
    s / c
}
