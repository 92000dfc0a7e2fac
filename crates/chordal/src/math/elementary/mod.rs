//! Our own elementary functions: the same bits on every platform and in every lane, with a proved error.
//!
//! They use only additions, subtractions, multiplications, divisions, square roots, comparisons and bit
//! operations, without branches, so that loops over them are vectorized (see [`super::simd`]) and give the
//! same bits as single calls. Polynomials are truncated Taylor series: their remainder is a line of
//! arithmetic, not the result of a search. One case branches: arguments of sine, cosine and tangent beyond
//! [`NEAR`] are reduced with integers (`payne_hanek.rs`).
//!
//! Proved errors, with u = 2⁻⁵³ and for all finite arguments for which the function has a value `f`: the
//! result is within `K·u·|f| + 2⁻¹⁰⁷⁴` of it, with K = 2 for [`sin`], [`cos`] and [`exp`], 3 for [`ln`], 6
//! for [`tan`] and 10 for the functions that return an angle. The derivations are in the comments of each
//! function, and the tests compare with 200 bits. Ranges ([`super::Interval`]) rely on these numbers.
//!
//! [`single`] has the same functions in f32, for pictures: with an error that is measured, not proved.
mod angle;
mod exponential;
mod payne_hanek;
pub mod single;
mod trigonometric;

pub use angle::{acos, asin, atan, atan2};
pub use exponential::{exp, ln};
pub(crate) use trigonometric::sin_cos_near;
pub use trigonometric::{NEAR, cos, sin, sin_cos, tan};

/// The relative padding that encloses the proved errors: 2 K u, so that a range contains the rounded values
/// as well as the true ones, and 1.01 u for the rounding of [`outward`] itself; powers of two, so that the
/// product is exact. Derived from the constants K of the module's documentation, with 2.8 for the logarithm,
/// 5.1 for the tangent and 9.6 for angles.
pub(crate) mod spread {
    const U: f64 = f64::EPSILON / 2.0; // Half a unit in the last place of 1: exact.
    /// For sine and cosine.
    pub(crate) const SIN: f64 = 8.0 * U;
    /// For the exponential.
    pub(crate) const EXP: f64 = 8.0 * U;
    /// For the logarithm.
    pub(crate) const LN: f64 = 8.0 * U;
    /// For the tangent.
    pub(crate) const TAN: f64 = 16.0 * U;
    /// For angles.
    pub(crate) const ANGLE: f64 = 32.0 * U;
}

/// A bound on the distance of the true value from the rounded `y`, for a padding of [`spread`]. The added
/// constant is a few of the smallest numbers, for subnormal results, whose last place cannot get smaller; an
/// exact 0 stays.
#[inline(always)]
pub(crate) fn outward(y: f64, spread: f64) -> f64 {
    let tiny = f64::from_bits(4); // Four times the smallest number, exactly.
    if y == 0.0 { 0.0 } else { y.abs() * spread + tiny }
}
