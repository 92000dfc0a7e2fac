//! `Interval`: a range of real numbers that encloses every value, with the decoration *defined and
//! continuous*.
//!
//! Each operation returns a range that contains the exact result for all real numbers of its operands: the
//! ends are rounded outward by one step (see [`super::add_up`]), so an exactly representable end may be
//! widened by one unit in the last place. Exact ends are kept in two cases: 0 if a factor, a dividend or a
//! root is exactly 0 or a sum cancels to 0, and every end that is only selected or negated (`neg`, `abs`,
//! `min`, `max`, `hull`, `intersection`). A product or quotient that underflows keeps its sign:
//! `[1e-200, 1] · [1e-200, 1]` starts at 0, not below.
//!
//! Ends are never NaN. An infinite end means that the values are unbounded there, not that ∞ is one of them,
//! hence `[0, 0] · [−∞, ∞]` is `[0, 0]`.
//!
//! Operations are isotone: smaller operands give a range inside that of larger operands, and the claim
//! [`Interval::is_defined`] is lost only when operands grow. The smooth minimum is the one exception: its
//! ends are padded in proportion to their values, so a smaller range may extend beyond a larger one by some
//! units in the last place; both are valid.
//!
//! Source: IEEE Std 1788-2015, set-based flavour; the flag is its decoration `dac`.
use super::sub_up;
use bare::{BareInterval, lower, step_down, step_up, upper};
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

pub(crate) mod bare;
mod elementary;

/// All real numbers from `lo` to `hi`, or none, and whether the expression that produced it is defined and
/// continuous at all points of the box over which it was evaluated.
///
/// ```
/// use chordal::math::Interval;
/// let x = Interval::new(-1.0, 2.0)?;
/// let y = x.square() + Interval::point(1.0);
/// assert!(y.lo() <= 1.0 && y.contains(5.0) && y.hi() < 5.0 + 1e-14 && y.is_defined());
/// let z = y / x; // x holds 0
/// assert!(z.is_entire() && !z.is_defined());
/// # Ok::<(), chordal::math::exact::InvalidInterval>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
    defined: bool,
}

impl Interval {
    /// The empty interval.
    pub const EMPTY: Self = Self { lo: f64::INFINITY, hi: f64::NEG_INFINITY, defined: false };

    /// Every real number, as of an unbounded variable.
    pub const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY, defined: true };

    /// Any number, or none: the result of an operation that is not defined everywhere and has no useful
    /// range.
    pub const UNKNOWN: Self = Self { defined: false, ..Self::ENTIRE };

    /// The numbers from `lo` to `hi`; an infinite end leaves that side open.
    ///
    /// # Errors
    /// [`InvalidInterval`] when an end is NaN, `lo > hi`, or the interval contains no real number (`lo = ∞`
    /// or `hi = −∞`).
    pub fn new(lo: f64, hi: f64) -> Result<Self, InvalidInterval> {
        if lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY {
            Ok(Self { lo, hi, defined: true })
        } else {
            Err(InvalidInterval { lo, hi })
        }
    }

    /// The number `x` alone; [`Interval::UNKNOWN`] when `x` is NaN or infinite.
    #[inline(always)]
    #[must_use]
    pub fn point(x: f64) -> Self {
        if x.is_finite() { Self { lo: x, hi: x, defined: true } } else { Self::UNKNOWN }
    }

    /// The low end; +∞ when empty.
    #[inline(always)]
    #[must_use]
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// The high end; −∞ when empty.
    #[inline(always)]
    #[must_use]
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// Whether the expression is defined and continuous at every point of the box: only then does a change of
    /// sign between two points prove a zero between them.
    #[inline(always)]
    #[must_use]
    pub fn is_defined(self) -> bool {
        self.defined
    }

    /// The same numbers without that claim, for an operation that jumps or is undefined somewhere.
    #[inline(always)]
    #[must_use]
    pub fn undefined(self) -> Self {
        Self { defined: false, ..self }
    }

    /// Whether it contains no number.
    #[inline(always)]
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    /// Whether it contains every real number.
    #[must_use]
    pub fn is_entire(self) -> bool {
        self.lo == f64::NEG_INFINITY && self.hi == f64::INFINITY
    }

    /// Whether it contains the real number `x`; false for NaN and infinities.
    #[inline]
    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        x.is_finite() && self.lo <= x && x <= self.hi
    }

    /// Whether all its numbers are in `other`.
    #[must_use]
    pub fn is_subset_of(self, other: Self) -> bool {
        self.is_empty() || (other.lo <= self.lo && self.hi <= other.hi)
    }

    /// The smallest interval around both; defined if both operands are.
    #[inline(always)]
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        let (lo, hi) = (lower(self.lo, other.lo), upper(self.hi, other.hi));
        Self { lo, hi, defined: self.defined & other.defined }
    }

    /// The numbers in both; defined if both operands are, [`Interval::EMPTY`] if there are none.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        let (lo, hi) = (upper(self.lo, other.lo), lower(self.hi, other.hi));
        if lo <= hi { Self { lo, hi, defined: self.defined & other.defined } } else { Self::EMPTY }
    }

    /// `hi − lo`, bounded from above: 0 for a point and for the empty interval, ∞ for an open end.
    #[must_use]
    pub fn width(self) -> f64 {
        if self.lo < self.hi { sub_up(self.hi, self.lo) } else { 0.0 }
    }

    /// A finite number in it, the middle up to rounding; 0 for [`Interval::ENTIRE`], the largest (smallest)
    /// number if only the high (low) end is open. `None` if empty.
    #[must_use]
    pub fn midpoint(self) -> Option<f64> {
        if self.is_empty() {
            return None;
        }
        // Halved before the sum, which may overflow.
        let middle = match (self.lo == f64::NEG_INFINITY, self.hi == f64::INFINITY) {
            (true, true) => 0.0,
            (true, false) => f64::MIN,
            (false, true) => f64::MAX,
            (false, false) => 0.5 * self.lo + 0.5 * self.hi,
        };
        // Half of the smallest subnormal rounds to 0, which may be outside.
        Some(upper(self.lo, lower(self.hi, middle)))
    }

    /// The largest absolute value; 0 when empty.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        if self.is_empty() { 0.0 } else { upper(self.lo.abs(), self.hi.abs()) }
    }

    #[inline(always)]
    pub(crate) fn bare(self) -> BareInterval {
        BareInterval { lo: self.lo, hi: self.hi }
    }

    /// A defined range with these ends, which must be valid.
    #[inline(always)]
    pub(crate) fn from_endpoints(lo: f64, hi: f64) -> Self {
        Self { lo, hi, defined: true }
    }

    /// `self` if the condition holds, otherwise `other`, without a branch.
    #[inline(always)]
    pub(crate) fn choose(self, condition: bool, other: Self) -> Self {
        Self {
            lo: if condition { self.lo } else { other.lo },
            hi: if condition { self.hi } else { other.hi },
            defined: (condition & self.defined) | (!condition & other.defined),
        }
    }

    /// The result of an operation on `self` and `other`; empty if an operand is.
    #[inline(always)]
    fn combine(self, other: Self, ends: BareInterval) -> Self {
        Self::from_bare(ends.unless_either_empty(self.bare(), other.bare()), self.defined & other.defined)
    }

    /// The result of an operation; the caller sets `defined` to false if the operation is undefined
    /// somewhere.
    #[inline(always)]
    pub(crate) fn from_bare(ends: BareInterval, defined: bool) -> Self {
        Self { lo: ends.lo, hi: ends.hi, defined }
    }

    /// `|x|`, exactly.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self::from_bare(self.bare().abs().unless_empty(self.bare()), self.defined)
    }

    /// The minimum of a number from each, exactly.
    #[inline(always)]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        self.combine(other, self.bare().min(other.bare()))
    }

    /// The smooth minimum of a number from each; monotone in both.
    #[inline(always)]
    #[must_use]
    pub(crate) fn smooth_min(self, other: Self) -> Self {
        self.combine(other, self.bare().smooth_min(other.bare()))
    }

    /// The minimum of a number from each with a round kink; monotone in both.
    #[inline(always)]
    #[must_use]
    pub(crate) fn round_min(self, other: Self) -> Self {
        self.combine(other, self.bare().round_min(other.bare()))
    }

    /// `ln(eᵃ + eᵇ)`; monotone in both.
    #[inline(always)]
    #[must_use]
    pub(crate) fn log_sum_exp(self, other: Self) -> Self {
        self.combine(other, self.bare().log_sum_exp(other.bare()))
    }

    /// The maximum of a number from each, exactly.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.combine(other, self.bare().max(other.bare()))
    }

    /// `x²`, never below 0.
    #[inline(always)]
    #[must_use]
    pub fn square(self) -> Self {
        Self::from_bare(self.bare().square().unless_empty(self.bare()), self.defined)
    }

    /// `x / √(x² + y²)` with y² in `others_sq`: the sine of an angle, which grows with x and approaches 0 as
    /// y² grows. At x = y = 0 it takes any value that it may have nearby.
    #[inline(always)]
    #[must_use]
    pub(crate) fn direction_cosine(self, others_sq: Self) -> Self {
        let ends = self.bare().direction_cosine(others_sq.bare());
        self.combine(others_sq, ends)
    }

    /// The derivative of the distance from a box by the distance from one of its sides. Outside the box it is
    /// `x / |v|`, with v the positive parts of all side distances; inside it is 1 if x is the largest and 0
    /// if it is not. `others_sq` is the sum of squares of the others in v, `largest` the largest of the
    /// others.
    #[inline(always)]
    #[must_use]
    pub(crate) fn box_derivative(self, others_sq: Self, largest: BareInterval) -> Self {
        let outside = self.bare().max(BareInterval { lo: 0.0, hi: 0.0 }).direction_cosine(others_sq.bare());
        let (is_first, may_be_first) =
            ((largest.hi <= 0.0) & (largest.hi < self.lo), (largest.lo <= 0.0) & (largest.lo <= self.hi));
        let inside =
            BareInterval { lo: if is_first { 1.0 } else { 0.0 }, hi: if may_be_first { 1.0 } else { 0.0 } };
        let ends = BareInterval {
            lo: if self.lo > 0.0 { outside.lo } else { inside.lo },
            hi: if self.hi > 0.0 { outside.hi } else { inside.hi },
        };
        self.combine(others_sq, ends)
    }

    /// `√x` of the non-negative part: defined only if there is no negative part, empty if there is no
    /// non-negative part.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        Self::from_bare(self.bare().sqrt().unless_empty(self.bare()), self.defined & (self.lo >= 0.0))
    }

    /// `xⁿ`; `x⁰` is 1 for every `x`. A negative power of an interval that contains 0 is
    /// [`Interval::UNKNOWN`].
    #[must_use]
    pub fn powi(self, n: i32) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let count = n.unsigned_abs();
        let raised = if count == 0 {
            Self { lo: 1.0, hi: 1.0, defined: self.defined }
        // An even power falls below 0 and rises above it. It rises with |x|, so the ends of |x| give its ends.
        } else if count.is_multiple_of(2) {
            let Self { lo, hi, defined } = self.abs();
            Self { lo: power(lo, count, product_down), hi: power(hi, count, product_up), defined }
        } else {
            self.odd_power(count)
        };
        if n < 0 { Self::point(1.0) / raised } else { raised }
    }

    /// An odd power is monotone, so each end depends on one end of the base.
    fn odd_power(self, count: u32) -> Self {
        // `power` takes numbers from 0 on; behind a minus sign, an upper bound is a lower one.
        let low = |x: f64| {
            if x < 0.0 { -power(-x, count, product_up) } else { power(x, count, product_down) }
        };
        let high = |x: f64| {
            if x < 0.0 { -power(-x, count, product_down) } else { power(x, count, product_up) }
        };
        Self { lo: low(self.lo), hi: high(self.hi), defined: self.defined }
    }
}

impl Neg for Interval {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo, defined: self.defined }
    }
}

impl Add for Interval {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.combine(other, self.bare().add(other.bare()))
    }
}

impl Sub for Interval {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.bare().mul(other.bare()))
    }
}

impl Div for Interval {
    type Output = Self;

    /// `x / y`; [`Interval::UNKNOWN`] when `other` contains 0.
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.combine(other, self.bare().div(other.bare()));
        quotient.choose(!other.bare().has_zero(), quotient.undefined())
    }
}

impl fmt::Display for Interval {
    /// `[1, 2]`, followed by `?` if it is not defined everywhere, or `empty`. The text reads back as the same
    /// f64 ends.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("empty");
        }
        write!(f, "[{}, {}]{}", self.lo, self.hi, if self.defined { "" } else { "?" })
    }
}

/// The error for two numbers that are not the ends of an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidInterval {
    lo: f64,
    hi: f64,
}

impl fmt::Display for InvalidInterval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "there is no real number from {} to {}", self.lo, self.hi)
    }
}

impl std::error::Error for InvalidInterval {}

#[inline]
fn product_down(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { below(a * b) }
}

#[inline]
fn product_up(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { step_up(a * b) }
}

/// A lower bound of a product of positive numbers; 0 if the product underflows.
#[inline]
fn below(rounded: f64) -> f64 {
    if rounded == 0.0 { 0.0 } else { step_down(rounded) }
}

/// `x^count` for `x ≥ 0` and `count ≥ 1` by squaring; an upper or lower bound, depending on `times`.
fn power(x: f64, count: u32, times: fn(f64, f64) -> f64) -> f64 {
    // The product starts at the lowest set bit of the exponent. Starting with 1 would round outward
    // once more for nothing.
    let (mut square, mut remaining) = (x, count);
    while remaining.is_multiple_of(2) {
        square = times(square, square);
        remaining /= 2;
    }
    let mut product = square;
    while remaining > 1 {
        square = times(square, square);
        remaining /= 2;
        if remaining % 2 == 1 {
            product = times(product, square);
        }
    }
    product
}
