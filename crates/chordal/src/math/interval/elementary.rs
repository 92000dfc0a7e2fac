//! Elementary functions of ranges, rounding to integers, and Boolean operations.
//!
//! Source of the errors that are included: [`super::super::elementary`]. Unlike the arithmetic, these are
//! isotone only up to that error: the rounded value at one end may be on either side of the true one.
use super::Interval;
use super::bare::BareInterval;
use crate::math::elementary;

/// Defines operations with one operand by name, value and condition.
macro_rules! unary {
    ($($(#[$doc:meta])* $name:ident: $a:ident => $value:expr, |$v:ident| $defined:expr;)*) => {
        impl Interval {
            $($(#[$doc])*
            #[inline(always)]
            #[must_use]
            pub fn $name(self) -> Self {
                let $a = self.bare();
                let $v: BareInterval = $value;
                Self::from_bare($v.unless_empty($a), self.is_defined() & ($defined))
            })*
        }
    };
}

/// The condition for step functions: continuous only if constant.
#[inline(always)]
fn is_flat(value: BareInterval) -> bool {
    value.lo == value.hi
}

unary! {
    /// The largest integer that is not above; defined if it is one number.
    floor: a => a.floor(), |value| is_flat(value);
    /// The smallest integer that is not below; defined if it is one number.
    ceil: a => a.ceil(), |value| is_flat(value);
    /// The nearest integer, halves away from 0; defined if it is one number.
    round: a => a.round(), |value| is_flat(value);
    /// The arcsine of the part in [−1, 1].
    asin: a => BareInterval::asin(a).empty_if(!a.intersects_one()), |value| a.is_within_one();
    /// The arccosine of the part in [−1, 1].
    acos: a => BareInterval::acos(a).empty_if(!a.intersects_one()), |value| a.is_within_one();
    /// The arctangent.
    atan: a => BareInterval::atan(a), |value| true;
    /// `eˣ`.
    exp: a => BareInterval::exp(a), |value| true;
    /// The natural logarithm of the part above 0.
    ln: a => BareInterval::ln(a), |value| a.lo > 0.0;
    /// 1 for 0, otherwise 0; defined if it is one number.
    one_at_zero: a => a.not(), |value| is_flat(value);
}

impl Interval {
    /// The sine.
    #[must_use]
    pub fn sin(self) -> Self {
        self.sin_by(elementary::sin_cos)
    }

    /// The cosine.
    #[must_use]
    pub fn cos(self) -> Self {
        self.cos_by(elementary::sin_cos)
    }

    /// The tangent; [`Interval::UNKNOWN`] if there may be a pole.
    #[must_use]
    pub fn tan(self) -> Self {
        self.tan_by(elementary::sin_cos)
    }

    /// The sine; `at` returns the sine and cosine of each end.
    #[inline(always)]
    pub(crate) fn sin_by(self, at: impl Fn(f64) -> (f64, f64)) -> Self {
        let a = self.bare();
        Self::from_bare(a.sinusoid(0.5, at(a.lo).0, at(a.hi).0).unless_empty(a), self.is_defined())
    }

    /// The cosine, like [`Interval::sin_by`].
    #[inline(always)]
    pub(crate) fn cos_by(self, at: impl Fn(f64) -> (f64, f64)) -> Self {
        let a = self.bare();
        Self::from_bare(a.sinusoid(0.0, at(a.lo).1, at(a.hi).1).unless_empty(a), self.is_defined())
    }

    /// The tangent, like [`Interval::sin_by`].
    #[inline(always)]
    pub(crate) fn tan_by(self, at: impl Fn(f64) -> (f64, f64)) -> Self {
        let a = self.bare();
        let (low, high) = (at(a.lo), at(a.hi));
        let value = BareInterval::tan(a, low.0 / low.1, high.0 / high.1);
        Self::from_bare(value.unless_empty(a), self.is_defined() & a.is_without_pole())
    }
}

/// Like [`unary`], with two operands.
macro_rules! binary {
    ($($(#[$doc:meta])* $name:ident: $a:ident, $b:ident => $value:expr, |$v:ident| $defined:expr;)*) => {
        impl Interval {
            $($(#[$doc])*
            #[inline(always)]
            #[must_use]
            pub fn $name(self, other: Self) -> Self {
                let ($a, $b) = (self.bare(), other.bare());
                let $v: BareInterval = $value;
                let operands = self.is_defined() & other.is_defined();
                Self::from_bare($v.unless_either_empty($a, $b), operands & ($defined))
            })*
        }
    };
}

binary! {
    /// The angle of the points `(other, self)` from the first axis; not defined if the box of these points
    /// touches the negative axis or the origin.
    atan2: a, b => BareInterval::atan2(a, b), |value| a.is_off_cut(b);
    /// The remainder by |other|, from 0 to |other|; [`Interval::UNKNOWN`] if `other` contains 0, and not
    /// defined if it may jump.
    rem_euclid: a, b => a.rem(b), |value| !a.integer_quotient(b).is_nan();
    /// −1, 0 or 1 as it is below, at or above `other`; defined if it is one number.
    compare: a, b => a.compare(b), |value| is_flat(value);
    /// `other`, or 0 if `self` is 0; not defined if that is undecided.
    and: a, b => a.and(b), |value| a.is_decided();
    /// `self`, or `other` if `self` is 0; not defined if that is undecided.
    or: a, b => a.or_else(b), |value| a.is_decided();
}
