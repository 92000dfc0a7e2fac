//! Directed rounding by one step: each result is a bound on the exact value, whatever the rounding error was.
//!
//! IEEE 754 operations round to the nearest number, so the exact value lies between the neighbours of what they
//! return: `next_up` bounds it from above, `next_down` from below. That costs one unit in the last place where
//! the operation was exact, and needs no change of the rounding mode. Overflow to infinity and underflow to zero
//! are covered: the neighbours of ∞ and of 0 are the largest and the smallest number. NaN stays NaN.

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

/// `√a` for `a ≥ 0`, bounded from below, never negative.
#[inline]
#[must_use]
pub fn sqrt_down(a: f64) -> f64 {
    let root = a.sqrt().next_down();
    if root < 0.0 { 0.0 } else { root }
}
