//! `Slope`: a value with its partial derivatives, and what operations do to both.
use super::number::Number;
use super::op::{Binary, Unary};
use crate::math::Interval;

/// A value with its partial derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope<N> {
    /// The value.
    pub value: N,
    /// Its derivatives along x, y and z.
    pub gradient: [N; 3],
}

/// What [`Slope`] does where a function has kinks or steps: take a side, or cover both.
pub(super) trait Kinks: Number {
    /// The derivatives of `|a|`.
    fn abs(a: Slope<Self>) -> [Self; 3];
    /// The derivatives of the smaller one of both.
    fn min(a: Slope<Self>, b: Slope<Self>) -> [Self; 3];
    /// The derivative of a function with steps, which has this value.
    fn flat(value: Self) -> Self;
    /// How many whole `b`s were taken from `a` to leave `value`.
    fn whole(a: Self, b: Self, value: Self) -> Self;
    /// The first where `condition` is 0, else the second.
    fn pick(condition: Self, zero: [Self; 3], other: [Self; 3]) -> [Self; 3];
    /// One claim for all: a slope is defined and continuous where the value and all derivatives are.
    fn agree(slope: Slope<Self>) -> Slope<Self>;
}

impl Kinks for f64 {
    #[inline(always)]
    fn abs(a: Slope<Self>) -> [Self; 3] {
        a.gradient.map(|d| if a.value < 0.0 { -d } else { d })
    }
    #[inline(always)]
    fn min(a: Slope<Self>, b: Slope<Self>) -> [Self; 3] {
        [0, 1, 2].map(|k| if a.value < b.value { a.gradient[k] } else { b.gradient[k] })
    }
    #[inline(always)]
    fn flat(_: Self) -> Self {
        0.0
    }
    #[inline(always)]
    fn whole(a: Self, b: Self, value: Self) -> Self {
        ((a - value) / b).round()
    }
    #[inline(always)]
    fn pick(condition: Self, zero: [Self; 3], other: [Self; 3]) -> [Self; 3] {
        [0, 1, 2].map(|k| if condition == 0.0 { zero[k] } else { other[k] })
    }
    #[inline(always)]
    fn agree(slope: Slope<Self>) -> Slope<Self> {
        slope
    }
}

impl Kinks for Interval {
    #[inline(always)]
    fn abs(a: Slope<Self>) -> [Self; 3] {
        let (above, below) = (a.value.lo() >= 0.0, a.value.hi() <= 0.0);
        a.gradient.map(|d| d.choose(above, (-d).choose(below, d.hull(-d))))
    }
    #[inline(always)]
    fn min(a: Slope<Self>, b: Slope<Self>) -> [Self; 3] {
        let (first, second) = (a.value.hi() < b.value.lo(), b.value.hi() < a.value.lo());
        [0, 1, 2].map(|k| {
            let (da, db) = (a.gradient[k], b.gradient[k]);
            da.choose(first, db.choose(second, da.hull(db)))
        })
    }
    #[inline(always)]
    fn flat(value: Self) -> Self {
        Self::point(0.0).choose(value.lo() == value.hi(), Self::UNKNOWN)
    }
    #[inline(always)]
    fn whole(a: Self, b: Self, _: Self) -> Self {
        let whole = a.ends().whole_quotient(b.ends());
        let n = Self::point(if b.hi() < 0.0 { -whole } else { whole });
        n.choose(whole == whole, Self::UNKNOWN)
    }
    #[inline(always)]
    fn pick(condition: Self, zero: [Self; 3], other: [Self; 3]) -> [Self; 3] {
        let condition = condition.ends();
        let (is_zero, never) = (condition.lo == 0.0 && condition.hi == 0.0, !condition.has_zero());
        [0, 1, 2].map(|k| {
            let both = zero[k].hull(other[k]).undefined();
            zero[k].choose(is_zero, other[k].choose(never, both))
        })
    }
    #[inline(always)]
    fn agree(slope: Slope<Self>) -> Slope<Self> {
        let [x, y, z] = slope.gradient.map(Self::is_defined);
        let all = slope.value.is_defined() & x & y & z;
        let one = |range: Self| Self::from_ends(range.ends(), all);
        Slope { value: one(slope.value), gradient: slope.gradient.map(one) }
    }
}

/// A slope from the value that an operation gave and the factor of the chain rule, or the rule itself.
#[inline(always)]
fn of_unary<N: Kinks>(op: Unary, a: Slope<N>, of: impl Fn(Unary, N) -> N) -> Slope<N> {
    let value = of(op, a.value);
    let times = |factor: N| a.gradient.map(|d| N::binary(Binary::Mul, factor, d));
    let recip = |x: N| N::near(Unary::Recip, x);
    let neg = |x: N| N::near(Unary::Neg, x);
    let square = |x: N| N::near(Unary::Square, x);
    let one = N::constant(1.0);
    let twice = |x: N| N::binary(Binary::Mul, N::constant(2.0), x);
    let beside = |x: N| N::near(Unary::Sqrt, N::binary(Binary::Sub, one, square(x)));
    let gradient = match op {
        Unary::Neg => a.gradient.map(neg),
        Unary::Abs => N::abs(a),
        Unary::Recip => times(neg(square(value))),
        Unary::Sqrt => times(recip(twice(value))),
        Unary::Square => times(twice(a.value)),
        Unary::Floor | Unary::Ceil | Unary::Round | Unary::Not => times(N::flat(value)),
        Unary::Sin => times(of(Unary::Cos, a.value)),
        Unary::Cos => times(neg(of(Unary::Sin, a.value))),
        Unary::Tan => times(N::binary(Binary::Add, one, square(value))),
        Unary::Asin => times(recip(beside(a.value))),
        Unary::Acos => times(neg(recip(beside(a.value)))),
        Unary::Atan => times(recip(N::binary(Binary::Add, one, square(a.value)))),
        Unary::Exp => times(value),
        Unary::Ln => times(recip(a.value)),
    };
    N::agree(Slope { value, gradient })
}

impl<N: Kinks> Number for Slope<N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        N::agree(Self { value: N::constant(value), gradient: [N::constant(0.0); 3] })
    }

    #[inline(always)]
    fn near(op: Unary, a: Self) -> Self {
        of_unary(op, a, N::near)
    }

    #[inline(always)]
    fn is_near(self) -> bool {
        self.value.is_near()
    }

    #[inline(always)]
    fn unary(op: Unary, a: Self) -> Self {
        of_unary(op, a, N::unary)
    }

    #[inline(always)]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        let value = N::binary(op, a.value, b.value);
        let neg = |x: N| N::near(Unary::Neg, x);
        let add = |x: N, y: N| N::binary(Binary::Add, x, y);
        let sub = |x: N, y: N| N::binary(Binary::Sub, x, y);
        let mul = |x: N, y: N| N::binary(Binary::Mul, x, y);
        let div = |x: N, y: N| N::binary(Binary::Div, x, y);
        let (da, db) = (a.gradient, b.gradient);
        let axes = [0, 1, 2];
        let gradient = match op {
            Binary::Add => axes.map(|k| add(da[k], db[k])),
            Binary::Sub => axes.map(|k| sub(da[k], db[k])),
            Binary::Mul => axes.map(|k| add(mul(da[k], b.value), mul(a.value, db[k]))),
            Binary::Div => axes.map(|k| div(sub(da[k], mul(value, db[k])), b.value)),
            Binary::Min => N::min(a, b),
            Binary::Max => {
                let minus = |s: Self| Self { value: neg(s.value), gradient: s.gradient.map(neg) };
                N::min(minus(a), minus(b)).map(neg)
            }
            Binary::Atan2 => {
                let square = |x: N| N::near(Unary::Square, x);
                let r = add(square(a.value), square(b.value));
                axes.map(|k| div(sub(mul(b.value, da[k]), mul(a.value, db[k])), r))
            }
            // a − n b with a whole n that is constant where nothing jumps.
            Binary::Mod => {
                let n = N::whole(a.value, b.value, value);
                axes.map(|k| sub(da[k], mul(n, db[k])))
            }
            Binary::Compare => [N::flat(value); 3],
            Binary::And => N::pick(a.value, da, db),
            Binary::Or => N::pick(a.value, db, da),
        };
        N::agree(Self { value, gradient })
    }
}
