//! What ranges become under sine and its kin, under rounding to whole numbers, and under decisions.
//!
//! Source of the errors that are allowed for: [`super::super::elementary`]. Unlike the arithmetic, these are isotone only up to
//! that error: the rounded value at one end may be on either side of the true one.
use super::Interval;
use super::ends::Ends;
use crate::math::elementary;

/// What an operation with one operand is called, and how it is done.
macro_rules! unary {
    ($($(#[$doc:meta])* $name:ident: $a:ident => $value:expr, |$v:ident| $defined:expr;)*) => {
        impl Interval {
            $($(#[$doc])*
            #[inline(always)]
            #[must_use]
            pub fn $name(self) -> Self {
                let $a = self.ends();
                let $v: Ends = $value;
                Self::from_ends($v, self.is_defined() & ($defined))
            })*
        }
    };
}

/// For what has steps: continuous only where it is constant.
#[inline(always)]
fn is_flat(value: Ends) -> bool {
    value.lo == value.hi
}

unary! {
    /// The largest whole number that is not above; defined where that is one number.
    floor: a => a.floor(), |value| is_flat(value);
    /// The smallest whole number that is not below; defined where that is one number.
    ceil: a => a.ceil(), |value| is_flat(value);
    /// The nearest whole number, halves away from 0; defined where that is one number.
    round: a => a.round(), |value| is_flat(value);
    /// The angle whose sine it is, for the part in [−1, 1].
    asin: a => Ends::asin(a), |value| (a.lo >= -1.0) & (a.hi <= 1.0);
    /// The angle whose cosine it is, for the part in [−1, 1].
    acos: a => Ends::acos(a), |value| (a.lo >= -1.0) & (a.hi <= 1.0);
    /// The angle whose tangent it is.
    atan: a => Ends::atan(a), |value| true;
    /// `eˣ`.
    exp: a => Ends::exp(a), |value| true;
    /// The natural logarithm of the part above 0.
    ln: a => Ends::ln(a), |value| a.lo > 0.0;
    /// 1 where it is 0, else 0; defined where that is one number.
    not: a => a.not(), |value| is_flat(value);
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

    /// The tangent; [`Interval::UNKNOWN`] where there may be a pole.
    #[must_use]
    pub fn tan(self) -> Self {
        self.tan_by(elementary::sin_cos)
    }

    /// The sine, by a function that knows both ends' sines and cosines.
    #[inline(always)]
    pub(crate) fn sin_by(self, at: impl Fn(f64) -> (f64, f64)) -> Self {
        let a = self.ends();
        Self::from_ends(a.wave(0.5, at(a.lo).0, at(a.hi).0), self.is_defined())
    }

    /// The cosine, as [`Interval::sin_by`].
    #[inline(always)]
    pub(crate) fn cos_by(self, at: impl Fn(f64) -> (f64, f64)) -> Self {
        let a = self.ends();
        Self::from_ends(a.wave(0.0, at(a.lo).1, at(a.hi).1), self.is_defined())
    }

    /// The tangent, as [`Interval::sin_by`].
    #[inline(always)]
    pub(crate) fn tan_by(self, at: impl Fn(f64) -> (f64, f64)) -> Self {
        let a = self.ends();
        let (low, high) = (at(a.lo), at(a.hi));
        let value = Ends::tan(a, low.0 / low.1, high.0 / high.1);
        Self::from_ends(value, self.is_defined() && a.is_without_pole())
    }
}

/// As [`unary`], with two operands.
macro_rules! binary {
    ($($(#[$doc:meta])* $name:ident: $a:ident, $b:ident => $value:expr, |$v:ident| $defined:expr;)*) => {
        impl Interval {
            $($(#[$doc])*
            #[inline(always)]
            #[must_use]
            pub fn $name(self, other: Self) -> Self {
                let ($a, $b) = (self.ends(), other.ends());
                let $v: Ends = $value;
                let operands = self.is_defined() & other.is_defined();
                Self::from_ends($v, operands & ($defined))
            })*
        }
    };
}

binary! {
    /// The angle of the points `(other, self)` from the first axis; not defined where the box of these points touches the
    /// negative axis or the origin.
    atan2: a, b => Ends::atan2(a, b), |value| a.is_off_cut(b);
    /// What is left when whole |other|s are taken away, from 0 to |other|; [`Interval::UNKNOWN`] when `other` holds 0,
    /// and not defined where it may jump.
    rem_euclid: a, b => a.rem(b), |value| !a.whole_quotient(b).is_nan();
    /// −1, 0 or 1 as it is below, at or above `other`; defined where that is one number.
    compare: a, b => a.compare(b), |value| is_flat(value);
    /// `other`, or 0 where it is 0 itself; not defined where that is open.
    and: a, b => a.and(b), |value| a.is_decided();
    /// Itself, or `other` where it is 0; not defined where that is open.
    or: a, b => a.or_else(b), |value| a.is_decided();
}
