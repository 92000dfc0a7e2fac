//! `DoubleDouble`: a number as an unevaluated sum of two doubles, with about 106 bits, for differences that
//! cancel.
//!
//! Source: T. J. Dekker, *A floating-point technique for extending the available precision*, 1971. Products
//! are split without a fused multiply-add, so the results are the same everywhere; factors must be below
//! 1e300.

/// `hi + lo`, where `lo` is at most half a unit in the last place of `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DoubleDouble {
    pub(crate) hi: f64,
    pub(crate) lo: f64,
}

impl DoubleDouble {
    pub(crate) fn from_f64(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }

    /// `a + b`, exactly.
    pub(crate) fn two_sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let of_b = hi - a;
        Self { hi, lo: (a - (hi - of_b)) + (b - of_b) }
    }

    /// `a · b`, exactly unless it overflows or underflows.
    pub(crate) fn two_product(a: f64, b: f64) -> Self {
        let (a0, a1) = veltkamp_split(a);
        let (b0, b1) = veltkamp_split(b);
        let hi = a * b;
        Self { hi, lo: ((a0 * b0 - hi) + a0 * b1 + a1 * b0) + a1 * b1 }
    }

    /// The sum, to about 2⁻¹⁰⁴ of the larger one.
    pub(crate) fn plus(self, other: Self) -> Self {
        let s = Self::two_sum(self.hi, other.hi);
        Self::two_sum(s.hi, s.lo + (self.lo + other.lo))
    }

    /// The product, to about 2⁻¹⁰² of itself.
    pub(crate) fn times(self, other: Self) -> Self {
        let p = Self::two_product(self.hi, other.hi);
        Self::two_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }

    /// The quotient by `divisor` ≠ 0, to about 2⁻¹⁰² of itself.
    pub(crate) fn over(self, divisor: f64) -> Self {
        let q = self.hi / divisor;
        let product = Self::two_product(q, divisor);
        let remainder = ((self.hi - product.hi) - product.lo) + self.lo;
        Self::two_sum(q, remainder / divisor)
    }

    pub(crate) fn minus(self, other: Self) -> Self {
        self.plus(Self { hi: -other.hi, lo: -other.lo })
    }
}

/// The upper and the lower 26 bits of a number.
fn veltkamp_split(x: f64) -> (f64, f64) {
    // 2²⁷ + 1 (Veltkamp).
    let scaled = 134_217_729.0 * x;
    let upper = scaled - (scaled - x);
    (upper, x - upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_that_cancels_keeps_its_digits() {
        // (1 + 2⁻³⁰)² − 1 − 2⁻²⁹ = 2⁻⁶⁰, which plain arithmetic loses entirely.
        let tiny = 2.0_f64.powi(-30);
        let x = DoubleDouble::two_sum(1.0, tiny);
        let square = x.times(x).minus(DoubleDouble::from_f64(1.0)).minus(DoubleDouble::from_f64(2.0 * tiny));
        assert_eq!(square.hi, 2.0_f64.powi(-60));
        assert_eq!((1.0 + tiny) * (1.0 + tiny) - 1.0 - 2.0 * tiny, 0.0);
    }

    #[test]
    fn a_third_three_times_is_one() {
        let third = DoubleDouble::from_f64(1.0).over(3.0);
        let product = third.times(DoubleDouble::from_f64(3.0));
        assert_eq!(product.hi, 1.0);
        assert!(product.lo.abs() < 2.0_f64.powi(-100));
    }
}
