//! Directed rounding by one step: each result is a bound on the exact value, for any rounding error.
//!
//! IEEE 754 operations round to the nearest number, so the exact value lies between the neighbours of the
//! result: `next_up` bounds it from above, `next_down` from below. That costs one unit in the last place if
//! the operation was exact, and needs no change of the rounding mode. Overflow to infinity and underflow to
//! zero are covered: the neighbours of ∞ and of 0 are the largest and the smallest number. NaN stays NaN.

/// `a + b`, bounded from above.
#[inline]
#[must_use]
pub fn add_up(a: f64, b: f64) -> f64 {
    (a + b).next_up()
}

/// `a + b`, bounded from below.
#[inline]
#[must_use]
pub fn add_down(a: f64, b: f64) -> f64 {
    (a + b).next_down()
}

/// `a − b`, bounded from above.
#[inline]
#[must_use]
pub fn sub_up(a: f64, b: f64) -> f64 {
    (a - b).next_up()
}

/// `a − b`, bounded from below.
#[inline]
#[must_use]
pub fn sub_down(a: f64, b: f64) -> f64 {
    (a - b).next_down()
}

/// `a · b`, bounded from above.
#[inline]
#[must_use]
pub fn mul_up(a: f64, b: f64) -> f64 {
    (a * b).next_up()
}

/// `a · b`, bounded from below.
#[inline]
#[must_use]
pub fn mul_down(a: f64, b: f64) -> f64 {
    (a * b).next_down()
}

/// `a / b`, bounded from above.
#[inline]
#[must_use]
pub fn div_up(a: f64, b: f64) -> f64 {
    (a / b).next_up()
}

/// `a / b`, bounded from below.
#[inline]
#[must_use]
pub fn div_down(a: f64, b: f64) -> f64 {
    (a / b).next_down()
}

/// `√a` for `a ≥ 0`, bounded from above.
#[inline]
#[must_use]
pub fn sqrt_up(a: f64) -> f64 {
    a.sqrt().next_up()
}

/// The length of a vector, bounded from above; also for very small and very large vectors.
#[inline]
#[must_use]
pub(crate) fn length_up<const D: usize>(v: [f64; D]) -> f64 {
    let largest = v.iter().fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most });
    // A power of two, so that squares neither underflow nor overflow.
    let scale = if largest < FEW {
        LARGE
    } else if largest > 1.0 / FEW {
        1.0 / LARGE
    } else {
        1.0
    };
    let sum = v.iter().fold(0.0, |sum, x| add_up(sum, mul_up(x * scale, x * scale)));
    if scale == 1.0 { sqrt_up(sum) } else { div_up(sqrt_up(sum), scale) }
}

/// 2⁻⁴⁰⁰ and 2⁶⁰⁰, derived from the range of exponents: squares of numbers below the first lose digits; after
/// multiplication by the second they do not.
const FEW: f64 = 3.872_591_914_849_318_3e-121;
const LARGE: f64 = 4.149_515_568_880_993e180;

/// `√a` for `a ≥ 0`, bounded from below, never negative.
#[inline]
#[must_use]
pub fn sqrt_down(a: f64) -> f64 {
    let root = a.sqrt().next_down();
    if root < 0.0 { 0.0 } else { root }
}
