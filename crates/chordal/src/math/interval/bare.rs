//! `BareInterval`: the ends of ranges and every operation of [`super::Interval`] on them, without branches,
//! so that loops are vectorized.
//!
//! The ends of a range are never NaN, the low one never ∞ and the high one never −∞, except for the empty
//! range, which is from ∞ to −∞. The result of an operation on the empty range is arbitrary: the caller makes
//! it empty, with [`BareInterval::unless_empty`] or at the end of all operations. Separate functions say
//! whether an operation is defined and continuous over its operands.
use super::super::elementary::{self, outward, spread};

/// The smallest number above 0, exactly.
const TINY: f64 = f64::from_bits(1);

/// An [`super::Interval`] without its flag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BareInterval {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
}

/// The next lower number; 0, −∞ and NaN stay.
#[inline(always)]
fn below(x: f64) -> f64 {
    let bits = x.to_bits();
    // 1 upward from 0 and −1 below it. The tests are on the bits, which is cheaper.
    let away = ((bits as i64) >> 63) as u64 | 1;
    let moves = (bits << 1 != 0) & (bits != f64::NEG_INFINITY.to_bits());
    f64::from_bits(bits.wrapping_sub(if moves { away } else { 0 }))
}

/// The next higher number; 0, ∞ and NaN stay.
#[inline(always)]
fn above(x: f64) -> f64 {
    let bits = x.to_bits();
    let away = ((bits as i64) >> 63) as u64 | 1;
    let moves = (bits << 1 != 0) & (bits != f64::INFINITY.to_bits());
    f64::from_bits(bits.wrapping_add(if moves { away } else { 0 }))
}

/// `next_down`, for numbers that are not NaN.
#[inline(always)]
pub(crate) fn step_down(x: f64) -> f64 {
    if x == 0.0 { -TINY } else { below(x) }
}

/// `next_up`, for numbers that are not NaN.
#[inline(always)]
pub(crate) fn step_up(x: f64) -> f64 {
    if x == 0.0 { TINY } else { above(x) }
}

#[inline(always)]
pub(crate) fn lower(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(crate) fn upper(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// A lower bound of the value that was rounded to `y` within `spread`; the largest number if `y` is ∞.
#[inline(always)]
fn down(y: f64, spread: f64) -> f64 {
    let y = if y == f64::INFINITY { f64::MAX } else { y };
    y - outward(y, spread)
}

/// An upper bound, like [`down`].
#[inline(always)]
fn up(y: f64, spread: f64) -> f64 {
    -down(-y, spread)
}

/// −1, 0 or 1 as `a` is below, at or above `b`.
#[inline(always)]
fn sign(a: f64, b: f64) -> f64 {
    let not_below = if a > b { 1.0 } else { 0.0 };
    if a < b { -1.0 } else { not_below }
}

/// The largest `x / √(x² + y²)` for y² in `others_sq`.
#[inline(always)]
fn max_direction_cosine(x: f64, others_sq: BareInterval) -> f64 {
    let others_sq = if x > 0.0 { others_sq.lo } else { others_sq.hi };
    let x = BareInterval { lo: x, hi: x };
    let share = x.div(x.square().add(BareInterval { lo: others_sq, hi: others_sq }).sqrt()).hi;
    // Also covers the cases in which all numbers are 0 or a square overflows.
    lower(share, if x.hi > 0.0 { 1.0 } else { 0.0 })
}

impl BareInterval {
    pub(crate) const EMPTY: Self = Self { lo: f64::INFINITY, hi: f64::NEG_INFINITY };
    pub(crate) const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    #[inline(always)]
    pub(crate) fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    #[inline(always)]
    pub(crate) fn has_zero(self) -> bool {
        (self.lo <= 0.0) & (self.hi >= 0.0)
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        (self.lo == 0.0) & (self.hi == 0.0)
    }

    #[inline(always)]
    fn select(self, this: bool, other: Self) -> Self {
        Self { lo: if this { self.lo } else { other.lo }, hi: if this { self.hi } else { other.hi } }
    }

    /// Empty if the condition holds.
    #[inline(always)]
    pub(crate) fn empty_if(self, is_empty: bool) -> Self {
        Self::EMPTY.select(is_empty, self)
    }

    /// Empty if the operand is: the last step of every operation on ranges.
    #[inline(always)]
    pub(crate) fn unless_empty(self, a: Self) -> Self {
        Self::EMPTY.select(a.is_empty(), self)
    }

    /// [`BareInterval::unless_empty`] for two operands.
    #[inline(always)]
    pub(crate) fn unless_either_empty(self, a: Self, b: Self) -> Self {
        Self::EMPTY.select(a.is_empty() | b.is_empty(), self)
    }

    #[inline(always)]
    pub(crate) fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }

    #[inline(always)]
    pub(crate) fn hull(self, other: Self) -> Self {
        Self { lo: lower(self.lo, other.lo), hi: upper(self.hi, other.hi) }
    }

    #[inline(always)]
    pub(crate) fn add(self, other: Self) -> Self {
        // Low ends are never +∞ and high ends never −∞ (except for the empty range), so ∞ − ∞ does not occur.
        let (lo, hi) = (self.lo + other.lo, self.hi + other.hi);
        // A sum that rounds to 0 is 0: addition does not underflow.
        Self { lo: below(lo), hi: above(hi) }
    }

    #[inline(always)]
    pub(crate) fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    /// The smallest and largest of the four products of ends, one step outward. A product of 0 and ∞ is 0:
    /// the first one is set so, and if another one is such a product, 0 is among the remaining products too,
    /// or they extend beyond it. A product that underflows keeps its sign; an exact 0 stays.
    #[inline(always)]
    pub(crate) fn mul(self, other: Self) -> Self {
        let first = self.lo * other.lo;
        let first = if first.is_nan() { 0.0 } else { first };
        let others = [self.lo * other.hi, self.hi * other.lo, self.hi * other.hi];
        let lo = lower(others[2], lower(others[1], lower(others[0], first)));
        let hi = upper(others[2], upper(others[1], upper(others[0], first)));
        // Whether some product of the two ranges is below (above) 0: then an end of 0 is an
        // underflow, and must not be read as exactly 0.
        let (below_a, above_a) = (self.lo < 0.0, self.hi > 0.0);
        let (below_b, above_b) = (other.lo < 0.0, other.hi > 0.0);
        let negative = (below_a & above_b) | (above_a & below_b);
        let positive = (below_a & below_b) | (above_a & above_b);
        let lo = if (lo == 0.0) & negative { -TINY } else { below(lo) };
        let hi = if (hi == 0.0) & positive { TINY } else { above(hi) };
        Self { lo, hi }
    }

    /// The quotient if `other` does not contain 0, otherwise all numbers.
    #[inline(always)]
    pub(crate) fn div(self, other: Self) -> Self {
        let flipped = other.hi < 0.0;
        let (over, under) = (self.neg().select(flipped, self), other.neg().select(flipped, other));
        // With a positive divisor the smaller of its ends makes the larger quotient. ∞/∞ does not occur: the
        // dividends below that may be infinite are divided by the divisor's low end, which is finite.
        let lo = over.lo / if over.lo >= 0.0 { under.hi } else { under.lo };
        let hi = over.hi / if over.hi >= 0.0 { under.lo } else { under.hi };
        let lo = if (lo == 0.0) & (over.lo < 0.0) { -TINY } else { below(lo) };
        let hi = if (hi == 0.0) & (over.hi > 0.0) { TINY } else { above(hi) };
        Self::ENTIRE.select(other.has_zero(), Self { lo, hi })
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        let across = (self.lo < 0.0) & (self.hi > 0.0);
        let larger = upper(-self.lo, self.hi);
        let folded = Self { lo: 0.0, hi: larger };
        let flipped = self.neg().select((self.hi <= 0.0) & (self.lo < 0.0), self);
        folded.select(across, flipped)
    }

    /// `min(a, b) − max(1 − |a − b|, 0)²/4`, which is monotone in both. Rounding: the squared number is at
    /// most 1 and off by at most 2u (u = ε/2: half a step of |a − b|, and half of the difference from 1), so
    /// a quarter of its square is off by at most 1.25u, and the last difference by u of itself. The pad is
    /// four times as much, for the true value and for those computed anywhere between the ends.
    #[inline(always)]
    pub(crate) fn smooth_min(self, other: Self) -> Self {
        let at = |a: f64, b: f64| {
            let near = 1.0 - (a - b).abs();
            let near = if near > 0.0 { near } else { 0.0 };
            lower(a, b) - 0.25 * (near * near)
        };
        let pad = |x: f64| 4.0 * f64::EPSILON * (1.0 + x.abs());
        let (lo, hi) = (at(self.lo, other.lo), at(self.hi, other.hi));
        Self { lo: lo - pad(lo), hi: hi + pad(hi) }
    }

    /// The round minimum, which is monotone in both. Rounding, in units u = 2⁻⁵³ of the numbers: `h` is off
    /// by 2u; the subtracted term, at most 0.3 with a slope of at most 1/2, is off by u for that and 3u for
    /// its own steps; the last difference by u of itself. The pad is more than twice that, for the true value
    /// and for those computed anywhere between the ends.
    #[inline(always)]
    pub(crate) fn round_min(self, other: Self) -> Self {
        let at = |a: f64, b: f64| {
            let near = 1.0 - (a - b).abs();
            let near = if near > 0.0 { near } else { 0.0 };
            lower(a, b) - near * near / (1.0 + near + (1.0 + near * (2.0 - near)).sqrt())
        };
        let pad = |x: f64| 8.0 * f64::EPSILON * (1.0 + x.abs());
        let (lo, hi) = (at(self.lo, other.lo), at(self.hi, other.hi));
        Self { lo: lo - pad(lo), hi: hi + pad(hi) }
    }

    /// `ln(eᵃ + eᵇ) = max + ln(1 + e^(min − max))`, which is monotone in both. Rounding: the difference is
    /// off by u of itself, so its exponential, which is at most 1, by 0.4u; within [`spread::EXP`], that is
    /// 8u; the sum with 1 by u; the logarithm, at most ln 2, by that and within [`spread::LN`], together 15u;
    /// and the last sum by u of itself. The pad is twice as much, for the true value and for those computed
    /// between the ends.
    #[inline(always)]
    pub(crate) fn log_sum_exp(self, other: Self) -> Self {
        let at = |a: f64, b: f64| {
            let (low, high) = (lower(a, b), upper(a, b));
            // Equal infinities have no difference.
            let fall = if low == high { 0.0 } else { low - high };
            high + elementary::ln(1.0 + elementary::exp(fall))
        };
        let pad = |x: f64| 16.0 * f64::EPSILON * (1.0 + x.abs());
        let (lo, hi) = (at(self.lo, other.lo), at(self.hi, other.hi));
        Self { lo: lo - pad(lo), hi: hi + pad(hi) }
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self { lo: lower(self.lo, other.lo), hi: lower(self.hi, other.hi) }
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self { lo: upper(self.lo, other.lo), hi: upper(self.hi, other.hi) }
    }

    #[inline(always)]
    pub(crate) fn square(self) -> Self {
        let a = self.abs();
        let (lo, hi) = (a.lo * a.lo, a.hi * a.hi);
        let hi = if (hi == 0.0) & (a.hi != 0.0) { TINY } else { above(hi) };
        Self { lo: below(lo), hi }
    }

    /// `x / √(x² + y²)` for y² in `others_sq`.
    #[inline(always)]
    pub(crate) fn direction_cosine(self, others_sq: Self) -> Self {
        Self { lo: -max_direction_cosine(-self.lo, others_sq), hi: max_direction_cosine(self.hi, others_sq) }
    }

    /// The root of the non-negative part.
    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        let lo = if self.lo > 0.0 { below(self.lo.sqrt()) } else { 0.0 };
        let hi = if self.hi > 0.0 { above(self.hi.sqrt()) } else { 0.0 };
        Self::EMPTY.select(self.hi < 0.0, Self { lo, hi })
    }

    #[inline(always)]
    pub(crate) fn floor(self) -> Self {
        Self { lo: self.lo.floor(), hi: self.hi.floor() }
    }

    #[inline(always)]
    pub(crate) fn ceil(self) -> Self {
        Self { lo: self.lo.ceil(), hi: self.hi.ceil() }
    }

    #[inline(always)]
    pub(crate) fn round(self) -> Self {
        Self { lo: self.lo.round(), hi: self.hi.round() }
    }

    /// The range of a wave from −1 to 1 with the value `at_lo` at the low end and `at_hi` at the high end.
    /// Its maxima are where x/π − `shift` is even and its minima where it is odd.
    ///
    /// The test for integers between the ends has a margin: x/π − shift is rounded within 4 u of 1 more than
    /// its size. Without a finite end the result is [−1, 1].
    #[inline(always)]
    pub(crate) fn sinusoid(self, shift: f64, at_lo: f64, at_hi: f64) -> Self {
        let (first, last) = self.integers_between(shift);
        let (none, one) = (last < first, last == first);
        let even = (0.5 * first).floor() * 2.0 == first;
        // Of two integers in a row, one is even and one is odd.
        let (top, bottom) = (!none & (!one | even), !none & (!one | !even));
        let lo = upper(down(lower(at_lo, at_hi), spread::SIN), -1.0);
        let hi = lower(up(upper(at_lo, at_hi), spread::SIN), 1.0);
        Self { lo: if bottom { -1.0 } else { lo }, hi: if top { 1.0 } else { hi } }
    }

    /// The first and the last integer that x/π − `shift` may take, for x from `lo` to `hi`.
    #[inline(always)]
    fn integers_between(self, shift: f64) -> (f64, f64) {
        const MARGIN: f64 = 4.0 * f64::EPSILON; // Twice the 4 u of rounding that is derived above.
        let (a, b) =
            (self.lo * std::f64::consts::FRAC_1_PI - shift, self.hi * std::f64::consts::FRAC_1_PI - shift);
        ((a - (a.abs() + 1.0) * MARGIN).ceil(), (b + (b.abs() + 1.0) * MARGIN).floor())
    }

    /// Whether the tangent certainly has no pole from `lo` to `hi`.
    #[inline(always)]
    pub(crate) fn is_without_pole(self) -> bool {
        let (first, last) = self.integers_between(0.5);
        last < first
    }

    /// The tangent, from its values at both ends; all numbers if there may be a pole.
    #[inline(always)]
    pub(crate) fn tan(self, at_lo: f64, at_hi: f64) -> Self {
        let rising = Self { lo: down(at_lo, spread::TAN), hi: up(at_hi, spread::TAN) };
        rising.select(self.is_without_pole(), Self::ENTIRE)
    }

    /// Whether the entire range lies in [−1, 1].
    #[inline(always)]
    pub(crate) fn is_within_one(self) -> bool {
        (self.lo >= -1.0) & (self.hi <= 1.0)
    }

    /// Whether part of the range lies in [−1, 1].
    #[inline(always)]
    pub(crate) fn intersects_one(self) -> bool {
        (self.lo <= 1.0) & (self.hi >= -1.0)
    }

    /// The part from −1 to 1.
    #[inline(always)]
    fn clip_to_one(self) -> Self {
        let common = Self { lo: upper(self.lo, -1.0), hi: lower(self.hi, 1.0) };
        common.empty_if(common.is_empty())
    }

    #[inline(always)]
    pub(crate) fn asin(self) -> Self {
        let part = self.clip_to_one();
        let (lo, hi) = (elementary::asin(part.lo), elementary::asin(part.hi));
        Self { lo: down(lo, spread::ANGLE), hi: up(hi, spread::ANGLE) }
    }

    #[inline(always)]
    pub(crate) fn acos(self) -> Self {
        let part = self.clip_to_one();
        let (lo, hi) = (elementary::acos(part.hi), elementary::acos(part.lo));
        Self { lo: down(lo, spread::ANGLE), hi: up(hi, spread::ANGLE) }
    }

    #[inline(always)]
    pub(crate) fn atan(self) -> Self {
        let (lo, hi) = (elementary::atan(self.lo), elementary::atan(self.hi));
        Self { lo: down(lo, spread::ANGLE), hi: up(hi, spread::ANGLE) }
    }

    #[inline(always)]
    pub(crate) fn exp(self) -> Self {
        let (lo, hi) = (elementary::exp(self.lo), elementary::exp(self.hi));
        // An exponential is never 0.
        let hi = if hi == 0.0 { TINY } else { up(hi, spread::EXP) };
        let lo = upper(down(lo, spread::EXP), 0.0);
        Self { lo, hi }
    }

    /// The logarithm of the part above 0.
    #[inline(always)]
    pub(crate) fn ln(self) -> Self {
        let (lo, hi) = (elementary::ln(self.lo), elementary::ln(self.hi));
        let lo = if self.lo > 0.0 { down(lo, spread::LN) } else { f64::NEG_INFINITY };
        let hi = if self.hi == f64::INFINITY { self.hi } else { up(hi, spread::LN) };
        Self::EMPTY.select(self.hi <= 0.0, Self { lo, hi })
    }

    /// Whether the angle of the points `(other, self)` certainly does not jump: 0 is not among their
    /// ordinates, or all abscissas are positive.
    #[inline(always)]
    pub(crate) fn is_off_cut(self, other: Self) -> bool {
        !self.has_zero() | (other.lo > 0.0)
    }

    /// The angles of the points `(other, self)`. Off the cut they lie between those of the corners: along a
    /// side the angle is monotone. An angle that underflows keeps its sign.
    #[inline(always)]
    pub(crate) fn atan2(self, other: Self) -> Self {
        let (a, b) = (elementary::atan2(self.lo, other.lo), elementary::atan2(self.lo, other.hi));
        let (c, d) = (elementary::atan2(self.hi, other.lo), elementary::atan2(self.hi, other.hi));
        let (lo, hi) = (lower(lower(a, b), lower(c, d)), upper(upper(a, b), upper(c, d)));
        let lo = if (lo == 0.0) & (self.lo < 0.0) { -TINY } else { down(lo, spread::ANGLE) };
        let hi = if (hi == 0.0) & (self.hi > 0.0) { TINY } else { up(hi, spread::ANGLE) };
        let pi_up = step_up(std::f64::consts::PI);
        let turn = Self { lo: -pi_up, hi: pi_up };
        Self { lo, hi }.select(self.is_off_cut(other), turn)
    }

    /// The integer quotient, if it is the same everywhere; otherwise NaN.
    #[inline(always)]
    pub(crate) fn integer_quotient(self, other: Self) -> f64 {
        let quotient = self.div(other.abs());
        let (first, last) = (quotient.lo.floor(), quotient.hi.floor());
        if (first == last) & !other.has_zero() { first } else { f64::NAN }
    }

    /// The remainder of `self` by |other|.
    #[inline(always)]
    pub(crate) fn rem(self, other: Self) -> Self {
        let size = other.abs();
        let quotient = self.integer_quotient(other);
        let multiple = size
            .mul(Self { lo: quotient, hi: quotient }.select(!quotient.is_nan(), Self { lo: 0.0, hi: 0.0 }));
        let remainder = self.sub(multiple);
        let exact = Self { lo: upper(remainder.lo, 0.0), hi: lower(remainder.hi, size.hi) };
        let any = Self { lo: 0.0, hi: size.hi };
        let value = exact.select(!quotient.is_nan(), any);
        Self::ENTIRE.select(other.has_zero(), value)
    }

    #[inline(always)]
    pub(crate) fn compare(self, other: Self) -> Self {
        Self { lo: sign(self.lo, other.hi), hi: sign(self.hi, other.lo) }
    }

    /// 1 for 0, otherwise 0.
    #[inline(always)]
    pub(crate) fn not(self) -> Self {
        let lo = if self.is_zero() { 1.0 } else { 0.0 };
        let hi = if self.has_zero() { 1.0 } else { 0.0 };
        Self { lo, hi }
    }

    /// Whether it is certainly 0, or certainly not 0.
    #[inline(always)]
    pub(crate) fn is_decided(self) -> bool {
        self.is_zero() | !self.has_zero()
    }

    /// `other`, or 0 if `self` is 0.
    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        let zero = Self { lo: 0.0, hi: 0.0 };
        let either = zero.select(self.is_zero(), other.hull(zero));
        other.select(!self.has_zero(), either)
    }

    /// `self`, or `other` if `self` is 0.
    #[inline(always)]
    pub(crate) fn or_else(self, other: Self) -> Self {
        let either = other.select(self.is_zero(), self.hull(other));
        self.select(!self.has_zero(), either)
    }
}
