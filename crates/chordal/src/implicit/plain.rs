//! Expressions evaluated term by term, one number at a time: slow and plain, the oracle of the fast tape.
use super::op::{Binary, Unary};
use crate::math::Interval;

/// What terms can be evaluated to.
pub(super) trait Number: Clone {
    fn constant(value: f64) -> Self;
    fn unary(op: Unary, a: &Self) -> Self;
    fn binary(op: Binary, a: &Self, b: &Self) -> Self;
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn unary(op: Unary, a: &Self) -> Self {
        op.of(*a)
    }
    fn binary(op: Binary, a: &Self, b: &Self) -> Self {
        op.of(*a, *b)
    }
}

impl Number for Interval {
    fn constant(value: f64) -> Self {
        Self::point(value)
    }

    fn unary(op: Unary, a: &Self) -> Self {
        match op {
            Unary::Neg => -*a,
            Unary::Abs => a.abs(),
            Unary::Recip => Self::point(1.0) / *a,
            Unary::Sqrt => a.sqrt(),
            Unary::Square => a.square(),
            Unary::Sin | Unary::Cos => between(-1.0, 1.0, a.is_defined()),
            Unary::Not => between(0.0, 1.0, false),
            _ => Self::UNKNOWN,
        }
    }

    fn binary(op: Binary, a: &Self, b: &Self) -> Self {
        match op {
            Binary::Add => *a + *b,
            Binary::Sub => *a - *b,
            Binary::Mul => *a * *b,
            Binary::Div => *a / *b,
            Binary::Min => a.min(*b),
            Binary::Max => a.max(*b),
            Binary::Compare => between(-1.0, 1.0, false),
            _ => Self::UNKNOWN,
        }
    }
}

fn between(low: f64, high: f64, defined: bool) -> Interval {
    let range = Interval::new(low, high).unwrap_or(Interval::UNKNOWN);
    if defined { range } else { range.undefined() }
}

/// A value with its partial derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope<N> {
    /// The value.
    pub value: N,
    /// Its derivatives along x, y and z.
    pub gradient: [N; 3],
}

/// What [`Slope`] does where a function has a kink: take a side, or both.
pub(super) trait Kinks: Number {
    /// The derivatives of `|a|`.
    fn abs(a: &Slope<Self>) -> [Self; 3];
    /// The derivatives of the smaller one of both.
    fn min(a: &Slope<Self>, b: &Slope<Self>) -> [Self; 3];
    /// 0 where the function has steps, with what is known of it there.
    fn steps(value: &Self) -> Self;
}

impl Kinks for f64 {
    fn abs(a: &Slope<Self>) -> [Self; 3] {
        if a.value < 0.0 { a.gradient.map(|d| -d) } else { a.gradient }
    }
    fn min(a: &Slope<Self>, b: &Slope<Self>) -> [Self; 3] {
        if a.value < b.value { a.gradient } else { b.gradient }
    }
    fn steps(_: &Self) -> Self {
        0.0
    }
}

impl Kinks for Interval {
    fn abs(a: &Slope<Self>) -> [Self; 3] {
        if a.value.lo() >= 0.0 {
            a.gradient
        } else if a.value.hi() <= 0.0 {
            a.gradient.map(|d| -d)
        } else {
            a.gradient.map(|d| d.hull(-d))
        }
    }
    fn min(a: &Slope<Self>, b: &Slope<Self>) -> [Self; 3] {
        if a.value.hi() < b.value.lo() {
            a.gradient
        } else if b.value.hi() < a.value.lo() {
            b.gradient
        } else {
            std::array::from_fn(|k| a.gradient[k].hull(b.gradient[k]))
        }
    }
    fn steps(value: &Self) -> Self {
        // Where it is sure not to jump it is constant.
        if value.is_defined() { Self::point(0.0) } else { Self::UNKNOWN }
    }
}

impl<N: Kinks> Number for Slope<N> {
    fn constant(value: f64) -> Self {
        Self { value: N::constant(value), gradient: [0.0; 3].map(N::constant) }
    }

    fn unary(op: Unary, a: &Self) -> Self {
        let value = N::unary(op, &a.value);
        let times = |factor: N| a.gradient.each_ref().map(|d| N::binary(Binary::Mul, &factor, d));
        let recip = |x: &N| N::unary(Unary::Recip, x);
        let neg = |x: &N| N::unary(Unary::Neg, x);
        let square = |x: &N| N::unary(Unary::Square, x);
        let one = || N::constant(1.0);
        let sub = |x: &N, y: &N| N::binary(Binary::Sub, x, y);
        let add = |x: &N, y: &N| N::binary(Binary::Add, x, y);
        let twice = |x: &N| N::binary(Binary::Mul, &N::constant(2.0), x);
        let gradient = match op {
            Unary::Neg => a.gradient.each_ref().map(neg),
            Unary::Abs => N::abs(a),
            Unary::Recip => times(neg(&square(&value))),
            Unary::Sqrt => times(recip(&twice(&value))),
            Unary::Square => times(twice(&a.value)),
            Unary::Floor | Unary::Ceil | Unary::Round | Unary::Not => times(N::steps(&value)),
            Unary::Sin => times(N::unary(Unary::Cos, &a.value)),
            Unary::Cos => times(neg(&N::unary(Unary::Sin, &a.value))),
            Unary::Tan => times(add(&one(), &square(&value))),
            Unary::Asin => times(recip(&N::unary(Unary::Sqrt, &sub(&one(), &square(&a.value))))),
            Unary::Acos => times(neg(&recip(&N::unary(Unary::Sqrt, &sub(&one(), &square(&a.value)))))),
            Unary::Atan => times(recip(&add(&one(), &square(&a.value)))),
            Unary::Exp => times(value.clone()),
            Unary::Ln => times(recip(&a.value)),
        };
        Self { value, gradient }
    }

    fn binary(op: Binary, a: &Self, b: &Self) -> Self {
        let value = N::binary(op, &a.value, &b.value);
        let neg = |x: &N| N::unary(Unary::Neg, x);
        let add = |x: &N, y: &N| N::binary(Binary::Add, x, y);
        let sub = |x: &N, y: &N| N::binary(Binary::Sub, x, y);
        let mul = |x: &N, y: &N| N::binary(Binary::Mul, x, y);
        let div = |x: &N, y: &N| N::binary(Binary::Div, x, y);
        let each = |f: &dyn Fn(&N, &N) -> N| -> [N; 3] {
            std::array::from_fn(|k| f(&a.gradient[k], &b.gradient[k]))
        };
        let gradient = match op {
            Binary::Add => each(&|da, db| add(da, db)),
            Binary::Sub => each(&|da, db| sub(da, db)),
            Binary::Mul => each(&|da, db| add(&mul(da, &b.value), &mul(&a.value, db))),
            Binary::Div => each(&|da, db| div(&sub(da, &mul(&value, db)), &b.value)),
            Binary::Min => N::min(a, b),
            Binary::Max => {
                let minus =
                    |s: &Self| Self { value: neg(&s.value), gradient: s.gradient.each_ref().map(neg) };
                N::min(&minus(a), &minus(b)).each_ref().map(neg)
            }
            Binary::Atan2 => {
                let square = |x: &N| N::unary(Unary::Square, x);
                let r = add(&square(&a.value), &square(&b.value));
                each(&|da, db| div(&sub(&mul(&b.value, da), &mul(&a.value, db)), &r))
            }
            // a − |b|·n with a whole n that is constant where nothing jumps; b is constant in all but odd cases.
            Binary::Mod => {
                let n = div(&sub(&a.value, &value), &b.value);
                let within = N::steps(&value);
                each(&|da, db| add(&sub(da, &mul(&n, db)), &within))
            }
            Binary::Compare => {
                let flat = N::steps(&value);
                each(&|_, _| flat.clone())
            }
            Binary::And | Binary::Or => {
                let within = N::steps(&value);
                let zero = N::unary(Unary::Not, &a.value);
                let keep = sub(&N::constant(1.0), &zero);
                let (of_a, of_b) = if op == Binary::And { (zero, keep) } else { (keep, zero) };
                each(&|da, db| add(&add(&mul(&of_a, da), &mul(&of_b, db)), &within))
            }
        };
        Self { value, gradient }
    }
}
