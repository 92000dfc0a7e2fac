//! `Slope`: a value with its partial derivatives, and what operations do to both.
use super::number::{Number, squares};
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

/// An expression for each of the three axes: an array's `map` takes a closure, which the compiler may leave
/// outside of the code that it vectorises. So there are no closures in what runs in loops over blocks.
macro_rules! each_axis {
    ($k:ident => $value:expr) => {{
        let x = {
            let $k = 0;
            $value
        };
        let y = {
            let $k = 1;
            $value
        };
        let z = {
            let $k = 2;
            $value
        };
        [x, y, z]
    }};
}
pub(super) use each_axis;

/// What [`Slope`] does where a function has kinks or steps: take a side, or cover both.
pub(super) trait Kinks: Number {
    /// The derivatives of `|a|`.
    fn abs(a: Slope<Self>) -> [Self; 3];
    /// The derivatives of the smaller one of both.
    fn min(a: Slope<Self>, b: Slope<Self>) -> [Self; 3];
    /// A weighted mean of derivatives, which has this share of the first, cut to [0, 1].
    fn mean(share: Self, da: [Self; 3], db: [Self; 3]) -> [Self; 3];
    /// The derivatives of the length of a vector by its coordinates: these over the length. At 0, where there
    /// is a tip, one of all that are there around.
    fn shares<const N: usize>(parts: [Self; N], length: Self) -> [Self; N];
    /// The derivatives of the distance from a box by the distances from its sides.
    fn box_shares<const N: usize>(sides: [Self; N]) -> [Self; N];
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
        each_axis!(k => if a.value < 0.0 { -a.gradient[k] } else { a.gradient[k] })
    }
    #[inline(always)]
    fn min(a: Slope<Self>, b: Slope<Self>) -> [Self; 3] {
        each_axis!(k => if a.value < b.value { a.gradient[k] } else { b.gradient[k] })
    }
    #[inline(always)]
    fn mean(share: Self, da: [Self; 3], db: [Self; 3]) -> [Self; 3] {
        each_axis!(k => {
            let mean = share * da[k] + (1.0 - share) * db[k];
            // What has no share has no say, whatever it is.
            let mean = if share < 1.0 { mean } else { da[k] };
            if share > 0.0 { mean } else { db[k] }
        })
    }
    #[inline(always)]
    fn shares<const N: usize>(mut parts: [Self; N], length: Self) -> [Self; N] {
        for part in &mut parts {
            *part = if length == 0.0 { 0.0 } else { *part / length };
        }
        parts
    }
    #[inline(always)]
    fn box_shares<const N: usize>(mut sides: [Self; N]) -> [Self; N] {
        let mut largest = 0;
        for (k, side) in sides.iter().enumerate() {
            largest = if *side >= sides[largest] { k } else { largest };
        }
        if sides[largest] > 0.0 {
            for side in &mut sides {
                *side = if *side > 0.0 { *side } else { 0.0 };
            }
            return Self::shares(sides, Self::length(sides));
        }
        for (k, side) in sides.iter_mut().enumerate() {
            *side = if k == largest { 1.0 } else { 0.0 };
        }
        sides
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
        each_axis!(k => if condition == 0.0 { zero[k] } else { other[k] })
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
        each_axis!(k => {
            let d = a.gradient[k];
            d.choose(above, (-d).choose(below, d.hull(-d)))
        })
    }
    #[inline(always)]
    fn min(a: Slope<Self>, b: Slope<Self>) -> [Self; 3] {
        let (first, second) = (a.value.hi() < b.value.lo(), b.value.hi() < a.value.lo());
        each_axis!(k => {
            let (da, db) = (a.gradient[k], b.gradient[k]);
            da.choose(first, db.choose(second, da.hull(db)))
        })
    }
    /// The mean is linear in the share, so its ends are at those of the share.
    #[inline(always)]
    fn mean(share: Self, da: [Self; 3], db: [Self; 3]) -> [Self; 3] {
        let one = Self::point(1.0);
        let share = share.max(Self::point(0.0)).min(one).ends();
        let (all, none) = (share.lo >= 1.0, share.hi <= 0.0);
        let (low, high) = (Self::point(share.lo), Self::point(share.hi));
        each_axis!(k => {
            let (da, db) = (da[k], db[k]);
            let mean = (low * da + (one - low) * db).hull(high * da + (one - high) * db);
            da.choose(all, db.choose(none, mean))
        })
    }
    #[inline(always)]
    fn shares<const N: usize>(parts: [Self; N], _: Self) -> [Self; N] {
        let mut shares = parts;
        for (k, share) in shares.iter_mut().enumerate() {
            // The squares of the others.
            let mut rest = Self::point(0.0);
            for (other, part) in parts.iter().enumerate() {
                rest = if other == k { rest } else { rest + part.square() };
            }
            *share = parts[k].share_beside(rest);
        }
        shares
    }
    #[inline(always)]
    fn box_shares<const N: usize>(sides: [Self; N]) -> [Self; N] {
        let mut shares = sides;
        for (k, share) in shares.iter_mut().enumerate() {
            // The squares of the others where they are above 0, and the ends of the largest of them.
            let (mut rest, mut largest) = (Self::point(0.0), Self::UNKNOWN.ends());
            largest.hi = f64::NEG_INFINITY;
            for (other, side) in sides.iter().enumerate() {
                let with = rest + side.max(Self::point(0.0)).square();
                let ends = largest.max(side.ends());
                (rest, largest) = if other == k { (rest, largest) } else { (with, ends) };
            }
            *share = sides[k].box_share(rest, largest);
        }
        shares
    }
    #[inline(always)]
    fn flat(value: Self) -> Self {
        Self::point(0.0).choose(value.lo() == value.hi(), Self::UNKNOWN)
    }
    #[inline(always)]
    fn whole(a: Self, b: Self, _: Self) -> Self {
        let whole = a.ends().whole_quotient(b.ends());
        let n = Self::point(if b.hi() < 0.0 { -whole } else { whole });
        n.choose(!whole.is_nan(), Self::UNKNOWN)
    }
    #[inline(always)]
    fn pick(condition: Self, zero: [Self; 3], other: [Self; 3]) -> [Self; 3] {
        let condition = condition.ends();
        let (is_zero, never) = ((condition.lo == 0.0) & (condition.hi == 0.0), !condition.has_zero());
        each_axis!(k => {
            let both = zero[k].hull(other[k]).undefined();
            zero[k].choose(is_zero, other[k].choose(never, both))
        })
    }
    #[inline(always)]
    fn agree(slope: Slope<Self>) -> Slope<Self> {
        let [x, y, z] = slope.gradient;
        let all = slope.value.is_defined() & x.is_defined() & y.is_defined() & z.is_defined();
        Slope {
            value: slope.value.choose(all, slope.value.undefined()),
            gradient: each_axis!(k => slope.gradient[k].choose(all, slope.gradient[k].undefined())),
        }
    }
}

#[inline(always)]
fn neg<N: Number>(x: N) -> N {
    N::near(Unary::Neg, x)
}

#[inline(always)]
fn recip<N: Number>(x: N) -> N {
    N::near(Unary::Recip, x)
}

#[inline(always)]
fn square<N: Number>(x: N) -> N {
    N::near(Unary::Square, x)
}

#[inline(always)]
fn twice<N: Number>(x: N) -> N {
    mul(N::constant(2.0), x)
}

#[inline(always)]
fn add<N: Number>(x: N, y: N) -> N {
    N::binary(Binary::Add, x, y)
}

#[inline(always)]
fn sub<N: Number>(x: N, y: N) -> N {
    N::binary(Binary::Sub, x, y)
}

#[inline(always)]
fn mul<N: Number>(x: N, y: N) -> N {
    N::binary(Binary::Mul, x, y)
}

#[inline(always)]
fn div<N: Number>(x: N, y: N) -> N {
    N::binary(Binary::Div, x, y)
}

/// √(1 − x²).
#[inline(always)]
fn beside<N: Number>(x: N) -> N {
    N::near(Unary::Sqrt, sub(N::constant(1.0), square(x)))
}

/// The chain rule for the value that an operation gave and, for sine and cosine, what the other one is there.
#[inline(always)]
fn chain<N: Kinks>(op: Unary, a: Slope<N>, value: N, other: N) -> Slope<N> {
    let one = N::constant(1.0);
    let factor = match op {
        Unary::Neg | Unary::Abs => one,
        Unary::Recip => neg(square(value)),
        Unary::Sqrt => recip(twice(value)),
        Unary::Square => twice(a.value),
        Unary::Floor | Unary::Ceil | Unary::Round | Unary::Not => N::flat(value),
        Unary::Sin => other,
        Unary::Cos => neg(other),
        Unary::Tan => add(one, square(value)),
        Unary::Asin => recip(beside(a.value)),
        Unary::Acos => neg(recip(beside(a.value))),
        Unary::Atan => recip(add(one, square(a.value))),
        Unary::Exp => value,
        Unary::Ln => recip(a.value),
    };
    let gradient = match op {
        Unary::Neg => each_axis!(k => neg(a.gradient[k])),
        Unary::Abs => N::abs(a),
        _ => each_axis!(k => mul(factor, a.gradient[k])),
    };
    N::agree(Slope { value, gradient })
}

/// What the chain rule needs beside the value.
#[inline(always)]
fn partner(op: Unary) -> Unary {
    match op {
        Unary::Sin => Unary::Cos,
        Unary::Cos => Unary::Sin,
        _ => Unary::Neg,
    }
}

#[inline(always)]
fn minus<N: Kinks>(a: Slope<N>) -> Slope<N> {
    Slope { value: neg(a.value), gradient: each_axis!(k => neg(a.gradient[k])) }
}

impl<N: Kinks> Number for Slope<N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        N::agree(Self { value: N::constant(value), gradient: [N::constant(0.0); 3] })
    }

    #[inline(always)]
    fn near(op: Unary, a: Self) -> Self {
        chain(op, a, N::near(op, a.value), N::near(partner(op), a.value))
    }

    #[inline(always)]
    fn is_near(self) -> bool {
        self.value.is_near()
    }

    #[inline(always)]
    fn unary(op: Unary, a: Self) -> Self {
        chain(op, a, N::unary(op, a.value), N::unary(partner(op), a.value))
    }

    #[inline(always)]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        let value = N::binary(op, a.value, b.value);
        let (da, db) = (a.gradient, b.gradient);
        let gradient = match op {
            Binary::Add => each_axis!(k => add(da[k], db[k])),
            Binary::Sub => each_axis!(k => sub(da[k], db[k])),
            Binary::Mul => each_axis!(k => add(mul(da[k], b.value), mul(a.value, db[k]))),
            Binary::Div => each_axis!(k => div(sub(da[k], mul(value, db[k])), b.value)),
            Binary::Min => N::min(a, b),
            Binary::Max => {
                let least = N::min(minus(a), minus(b));
                each_axis!(k => neg(least[k]))
            }
            Binary::SmoothMin => {
                let half = N::constant(0.5);
                N::mean(sub(half, mul(half, sub(a.value, b.value))), da, db)
            }
            Binary::LogSumExp => {
                let ratio = N::near(Unary::Exp, sub(b.value, a.value));
                N::mean(recip(add(N::constant(1.0), ratio)), da, db)
            }
            Binary::Atan2 => {
                let r = add(square(a.value), square(b.value));
                each_axis!(k => div(sub(mul(b.value, da[k]), mul(a.value, db[k])), r))
            }
            // a − n b with a whole n that is constant where nothing jumps.
            Binary::Mod => {
                let n = N::whole(a.value, b.value, value);
                each_axis!(k => sub(da[k], mul(n, db[k])))
            }
            Binary::Compare => [N::flat(value); 3],
            Binary::And => N::pick(a.value, da, db),
            Binary::Or => N::pick(a.value, db, da),
        };
        N::agree(Self { value, gradient })
    }

    #[inline(always)]
    fn length<const M: usize>(parts: [Self; M]) -> Self {
        let values = values_of(&parts);
        let value = N::near(Unary::Sqrt, squares(&values));
        weighted(value, N::shares(values, value), &parts)
    }

    #[inline(always)]
    fn box_distance<const M: usize>(sides: [Self; M]) -> Self {
        let values = values_of(&sides);
        weighted(N::box_distance(values), N::box_shares(values), &sides)
    }
}

#[inline(always)]
fn values_of<N: Number, const M: usize>(parts: &[Slope<N>; M]) -> [N; M] {
    let mut values = [parts[0].value; M];
    for (value, part) in values.iter_mut().zip(parts) {
        *value = part.value;
    }
    values
}

/// A value with the gradient that has these shares of those of its parts.
#[inline(always)]
fn weighted<N: Kinks, const M: usize>(value: N, shares: [N; M], parts: &[Slope<N>; M]) -> Slope<N> {
    let gradient = each_axis!(k => {
        let mut sum = mul(shares[0], parts[0].gradient[k]);
        for (share, part) in shares[1..].iter().zip(&parts[1..]) {
            sum = add(sum, mul(*share, part.gradient[k]));
        }
        sum
    });
    N::agree(Slope { value, gradient })
}
