//! `Scalar`: the types that expressions evaluate to, and their operations.
use super::op::{Binary, Unary};
use crate::math::elementary::{self, NEAR, sin_cos_near, single};
use crate::math::{BareInterval, Interval};

/// A value of a term: f64, f32, an interval, or one of these with its derivatives.
///
/// All methods are inlined, and so compiled for each instruction set in the loops that use them.
pub(super) trait Scalar: Copy {
    fn constant(value: f64) -> Self;

    /// An operation on one number for which [`Scalar::is_near`] holds; without a branch.
    fn near(op: Unary, a: Self) -> Self;

    /// Whether its sine, cosine and tangent need no argument reduction in integers.
    fn is_near(self) -> bool;

    /// An operation on one number of any size.
    fn unary(op: Unary, a: Self) -> Self;

    /// An operation on two numbers.
    fn binary(op: Binary, a: Self, b: Self) -> Self;

    /// The length of a vector: the root of the sum of the squares, added in order.
    #[inline(always)]
    fn length<const N: usize>(parts: [Self; N]) -> Self {
        Self::near(Unary::Sqrt, squares(&parts))
    }

    /// The distance to a box, from the signed distances to its sides: `|max(v, 0)| + min(max of v, 0)`.
    #[inline(always)]
    fn box_distance<const N: usize>(mut sides: [Self; N]) -> Self {
        let zero = Self::constant(0.0);
        let mut largest = sides[0];
        for side in &mut sides {
            largest = Self::binary(Binary::Max, largest, *side);
            *side = Self::binary(Binary::Max, *side, zero);
        }
        Self::binary(Binary::Add, Self::length(sides), Self::binary(Binary::Min, largest, zero))
    }
}

/// The sum of the squares, added in order.
#[inline(always)]
pub(super) fn squares<N: Scalar>(parts: &[N]) -> N {
    let mut sum = N::near(Unary::Square, parts[0]);
    for part in &parts[1..] {
        sum = N::binary(Binary::Add, sum, N::near(Unary::Square, *part));
    }
    sum
}

/// Whether the operation is periodic, and so needs more argument reduction for large operands.
#[inline(always)]
pub(super) fn is_periodic(op: Unary) -> bool {
    matches!(op, Unary::Sin | Unary::Cos | Unary::Tan)
}

impl Scalar for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn near(op: Unary, a: Self) -> Self {
        match op {
            Unary::Sin => sin_cos_near(a).0,
            Unary::Cos => sin_cos_near(a).1,
            Unary::Tan => {
                let (sine, cosine) = sin_cos_near(a);
                sine / cosine
            }
            _ => op.apply(a),
        }
    }

    #[inline(always)]
    fn is_near(self) -> bool {
        self.abs() <= NEAR
    }

    #[inline(always)]
    fn unary(op: Unary, a: Self) -> Self {
        op.apply(a)
    }

    #[inline(always)]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        op.apply(a, b)
    }
}

impl Scalar for f32 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value as f32
    }

    #[inline(always)]
    fn near(op: Unary, a: Self) -> Self {
        match op {
            Unary::Sin => single::sin_cos_near(a).0,
            Unary::Cos => single::sin_cos_near(a).1,
            Unary::Tan => {
                let (sine, cosine) = single::sin_cos_near(a);
                sine / cosine
            }
            _ => op.apply_f32(a),
        }
    }

    #[inline(always)]
    fn is_near(self) -> bool {
        self.abs() <= single::NEAR
    }

    #[inline(always)]
    fn unary(op: Unary, a: Self) -> Self {
        op.apply_f32(a)
    }

    #[inline(always)]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        op.apply_f32(a, b)
    }
}

impl Scalar for Interval {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::point(value)
    }

    #[inline(always)]
    fn near(op: Unary, a: Self) -> Self {
        range(op, a, sin_cos_near)
    }

    #[inline(always)]
    fn is_near(self) -> bool {
        (self.lo().abs() <= NEAR) & (self.hi().abs() <= NEAR)
    }

    #[inline(always)]
    fn unary(op: Unary, a: Self) -> Self {
        range(op, a, elementary::sin_cos)
    }

    #[inline(always)]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        match op {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Min => Self::min(a, b),
            Binary::Max => Self::max(a, b),
            Binary::SmoothMin => Self::smooth_min(a, b),
            Binary::RoundMin => Self::round_min(a, b),
            Binary::LogSumExp => Self::log_sum_exp(a, b),
            Binary::Atan2 => Self::atan2(a, b),
            Binary::Mod => Self::rem_euclid(a, b),
            Binary::Compare => a.compare(b),
            Binary::And => a.and(b),
            Binary::Or => a.or(b),
        }
    }
}

#[inline(always)]
fn range(op: Unary, a: Interval, sin_cos: impl Fn(f64) -> (f64, f64)) -> Interval {
    match op {
        Unary::Neg => -a,
        Unary::Abs => a.abs(),
        Unary::Recip => Interval::point(1.0) / a,
        Unary::Sqrt => a.sqrt(),
        Unary::Square => a.square(),
        Unary::Floor => a.floor(),
        Unary::Ceil => a.ceil(),
        Unary::Round => a.round(),
        Unary::Sin => a.sin_by(sin_cos),
        Unary::Cos => a.cos_by(sin_cos),
        Unary::Tan => a.tan_by(sin_cos),
        Unary::Asin => Interval::asin(a),
        Unary::Acos => Interval::acos(a),
        Unary::Atan => Interval::atan(a),
        Unary::Exp => Interval::exp(a),
        Unary::Ln => Interval::ln(a),
        Unary::Not => a.one_at_zero(),
    }
}

/// An interval during the evaluation of a tape. Unlike [`Interval`] it marks an empty interval by a flag, and
/// its ends are then arbitrary. Every operation on an empty interval gives an empty one, so the flag is
/// enough and the operations need no check.
#[derive(Clone, Copy)]
pub(super) struct TapeInterval {
    pub(super) ends: BareInterval,
    pub(super) defined: bool,
    pub(super) some: bool,
}

impl TapeInterval {
    #[inline(always)]
    pub(super) fn from_interval(range: Interval) -> Self {
        Self { ends: range.bare(), defined: range.is_defined(), some: !range.is_empty() }
    }

    /// The side of a box; unknown if the ends form no interval.
    #[inline(always)]
    pub(super) fn side(lo: f64, hi: f64) -> Self {
        let valid = (lo <= hi) & (lo < f64::INFINITY) & (hi > f64::NEG_INFINITY);
        Self {
            ends: BareInterval {
                lo: if valid { lo } else { f64::NEG_INFINITY },
                hi: if valid { hi } else { f64::INFINITY },
            },
            defined: valid,
            some: true,
        }
    }

    #[inline(always)]
    pub(super) fn interval(self) -> Interval {
        Interval::from_bare(self.ends.empty_if(!self.some), self.defined)
    }

    /// The result of an operation: its interval, whether it is defined, and whether it is not empty.
    #[inline(always)]
    fn to(self, ends: BareInterval, defined: bool, some: bool) -> Self {
        Self { ends, defined: self.defined & defined, some: self.some & some }
    }

    #[inline(always)]
    fn step(op: Unary, x: Self, sin_cos: impl Fn(f64) -> (f64, f64)) -> Self {
        let a = x.ends;
        match op {
            Unary::Neg => x.to(a.neg(), true, true),
            Unary::Abs => x.to(a.abs(), true, true),
            Unary::Recip => x.to(BareInterval { lo: 1.0, hi: 1.0 }.div(a), !a.has_zero(), true),
            Unary::Sqrt => x.to(a.sqrt(), a.lo >= 0.0, a.hi >= 0.0),
            Unary::Square => x.to(a.square(), true, true),
            Unary::Floor => x.flat(a.floor()),
            Unary::Ceil => x.flat(a.ceil()),
            Unary::Round => x.flat(a.round()),
            Unary::Not => x.flat(a.not()),
            Unary::Sin => x.to(a.sinusoid(0.5, sin_cos(a.lo).0, sin_cos(a.hi).0), true, true),
            Unary::Cos => x.to(a.sinusoid(0.0, sin_cos(a.lo).1, sin_cos(a.hi).1), true, true),
            Unary::Tan => {
                let (low, high) = (sin_cos(a.lo), sin_cos(a.hi));
                x.to(BareInterval::tan(a, low.0 / low.1, high.0 / high.1), a.is_without_pole(), true)
            }
            Unary::Asin => x.to(BareInterval::asin(a), a.is_within_one(), a.intersects_one()),
            Unary::Acos => x.to(BareInterval::acos(a), a.is_within_one(), a.intersects_one()),
            Unary::Atan => x.to(BareInterval::atan(a), true, true),
            Unary::Exp => x.to(BareInterval::exp(a), true, true),
            Unary::Ln => x.to(BareInterval::ln(a), a.lo > 0.0, a.hi > 0.0),
        }
    }

    /// The result of a step function; continuous only if it is constant.
    #[inline(always)]
    fn flat(self, ends: BareInterval) -> Self {
        self.to(ends, ends.lo == ends.hi, true)
    }
}

impl Scalar for TapeInterval {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::from_interval(Interval::point(value))
    }

    #[inline(always)]
    fn near(op: Unary, a: Self) -> Self {
        Self::step(op, a, sin_cos_near)
    }

    #[inline(always)]
    fn is_near(self) -> bool {
        (self.ends.lo.abs() <= NEAR) & (self.ends.hi.abs() <= NEAR)
    }

    #[inline(always)]
    fn unary(op: Unary, a: Self) -> Self {
        Self::step(op, a, elementary::sin_cos)
    }

    #[inline(always)]
    fn binary(op: Binary, x: Self, y: Self) -> Self {
        let (a, b) = (x.ends, y.ends);
        // Defined only where both operands are.
        let joined = x.to(a, y.defined, y.some);
        match op {
            Binary::Add => joined.to(a.add(b), true, true),
            Binary::Sub => joined.to(a.sub(b), true, true),
            Binary::Mul => joined.to(a.mul(b), true, true),
            Binary::Div => joined.to(a.div(b), !b.has_zero(), true),
            Binary::Min => joined.to(a.min(b), true, true),
            Binary::Max => joined.to(a.max(b), true, true),
            Binary::SmoothMin => joined.to(a.smooth_min(b), true, true),
            Binary::RoundMin => joined.to(a.round_min(b), true, true),
            Binary::LogSumExp => joined.to(a.log_sum_exp(b), true, true),
            Binary::Atan2 => joined.to(BareInterval::atan2(a, b), a.is_off_cut(b), true),
            Binary::Mod => joined.to(a.rem(b), !a.integer_quotient(b).is_nan(), true),
            Binary::Compare => joined.flat(a.compare(b)),
            Binary::And => joined.to(a.and(b), a.is_decided(), true),
            Binary::Or => joined.to(a.or_else(b), a.is_decided(), true),
        }
    }
}
