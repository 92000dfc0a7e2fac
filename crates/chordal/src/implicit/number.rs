//! `Number`: what an expression can be evaluated to, and what each operation does there.
use super::op::{Binary, Unary};
use crate::math::Interval;
use crate::math::elementary::{self, NEAR, sin_cos_near, single};

/// A value of a term: f64, f32, a range, or one of these with its slopes.
///
/// Everything here is inlined, and so compiled for each instruction set where it is used in a loop.
pub(super) trait Number: Copy {
    fn constant(value: f64) -> Self;

    /// An operation on one number where that [`Number::is_near`]; without a branch.
    fn near(op: Unary, a: Self) -> Self;

    /// Whether sine, cosine and tangent of it need no reduction by integers.
    fn is_near(self) -> bool;

    /// An operation on one number, wherever it is.
    fn unary(op: Unary, a: Self) -> Self;

    /// An operation on two numbers.
    fn binary(op: Binary, a: Self, b: Self) -> Self;
}

/// Whether the operation turns its operand into an angle's rest, which needs more where that is large.
#[inline(always)]
pub(super) fn is_periodic(op: Unary) -> bool {
    matches!(op, Unary::Sin | Unary::Cos | Unary::Tan)
}

impl Number for f64 {
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
            _ => op.of(a),
        }
    }

    #[inline(always)]
    fn is_near(self) -> bool {
        self.abs() <= NEAR
    }

    #[inline(always)]
    fn unary(op: Unary, a: Self) -> Self {
        op.of(a)
    }

    #[inline(always)]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        op.of(a, b)
    }
}

impl Number for f32 {
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
            _ => op.of_f32(a),
        }
    }

    #[inline(always)]
    fn is_near(self) -> bool {
        self.abs() <= single::NEAR
    }

    #[inline(always)]
    fn unary(op: Unary, a: Self) -> Self {
        op.of_f32(a)
    }

    #[inline(always)]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        op.of_f32(a, b)
    }
}

impl Number for Interval {
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
        Unary::Not => a.not(),
    }
}
