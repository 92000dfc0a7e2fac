//! `Dual`: a value with its partial derivatives, and the operations on both.
use super::number::{Scalar, squares};
use super::op::{Binary, Unary};
use crate::math::{Interval, greater};

/// A value with its partial derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<N> {
    /// The value.
    pub value: N,
    /// Its derivatives along x, y and z.
    pub gradient: [N; 3],
}

/// Evaluates an expression for each of the three axes. An array's `map` takes a closure, which the compiler
/// may not inline into vectorized code, so loops over blocks contain no closures.
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

/// The treatment of kinks and jumps by [`Dual`]: take one side, or cover both.
pub(super) trait GeneralizedDerivative: Scalar {
    /// The derivatives of `|a|`.
    fn abs(a: Dual<Self>) -> [Self; 3];
    /// The derivatives of the smaller one.
    fn min(a: Dual<Self>, b: Dual<Self>) -> [Self; 3];
    /// The weighted mean of two gradients; `share`, clamped to [0, 1], is the weight of the first.
    fn mean(share: Self, da: [Self; 3], db: [Self; 3]) -> [Self; 3];
    /// The derivatives of a vector's length by its coordinates: the coordinates over the length. At 0, where
    /// the length has a kink, a generalized gradient.
    fn length_gradient<const N: usize>(parts: [Self; N], length: Self) -> [Self; N];
    /// The derivatives of the distance to a box by the signed distances to its sides.
    fn box_distance_gradient<const N: usize>(sides: [Self; N]) -> [Self; N];
    /// The derivative of a step function with this value.
    fn step_derivative(value: Self) -> Self;
    /// The number of times that `b` was subtracted from `a` to leave `value`.
    fn integer_quotient_of(a: Self, b: Self, value: Self) -> Self;
    /// `zero` where `condition` is 0, else `other`.
    fn select(condition: Self, zero: [Self; 3], other: [Self; 3]) -> [Self; 3];
    /// One decoration for all: a dual is defined and continuous where its value and all derivatives are.
    fn unify_decorations(slope: Dual<Self>) -> Dual<Self>;
}

impl GeneralizedDerivative for f64 {
    #[inline(always)]
    fn abs(a: Dual<Self>) -> [Self; 3] {
        each_axis!(k => if a.value < 0.0 { -a.gradient[k] } else { a.gradient[k] })
    }
    #[inline(always)]
    fn min(a: Dual<Self>, b: Dual<Self>) -> [Self; 3] {
        each_axis!(k => if a.value < b.value { a.gradient[k] } else { b.gradient[k] })
    }
    #[inline(always)]
    fn mean(share: Self, da: [Self; 3], db: [Self; 3]) -> [Self; 3] {
        each_axis!(k => {
            let mean = share * da[k] + (1.0 - share) * db[k];
            // An operand of weight 0 does not count, even if it is not finite.
            let mean = if share < 1.0 { mean } else { da[k] };
            if share > 0.0 { mean } else { db[k] }
        })
    }
    #[inline(always)]
    fn length_gradient<const N: usize>(mut parts: [Self; N], length: Self) -> [Self; N] {
        for part in &mut parts {
            *part = if length == 0.0 { 0.0 } else { *part / length };
        }
        parts
    }
    #[inline(always)]
    fn box_distance_gradient<const N: usize>(mut sides: [Self; N]) -> [Self; N] {
        let mut largest = 0;
        for (k, side) in sides.iter().enumerate() {
            // Of equal sides the last one, as in a chain of maxima.
            largest = if *side >= sides[largest] { k } else { largest };
        }
        if sides[largest] > 0.0 {
            for side in &mut sides {
                *side = greater(*side, 0.0);
            }
            return Self::length_gradient(sides, Self::length(sides));
        }
        for (k, side) in sides.iter_mut().enumerate() {
            *side = if k == largest { 1.0 } else { 0.0 };
        }
        sides
    }
    #[inline(always)]
    fn step_derivative(_: Self) -> Self {
        0.0
    }
    #[inline(always)]
    fn integer_quotient_of(a: Self, b: Self, value: Self) -> Self {
        // An integer, but for the rounding of the value.
        ((a - value) / b).round()
    }
    #[inline(always)]
    fn select(condition: Self, zero: [Self; 3], other: [Self; 3]) -> [Self; 3] {
        each_axis!(k => if condition == 0.0 { zero[k] } else { other[k] })
    }
    #[inline(always)]
    fn unify_decorations(slope: Dual<Self>) -> Dual<Self> {
        slope
    }
}

impl GeneralizedDerivative for Interval {
    #[inline(always)]
    fn abs(a: Dual<Self>) -> [Self; 3] {
        let (above, below) = (a.value.lo() >= 0.0, a.value.hi() <= 0.0);
        each_axis!(k => {
            let d = a.gradient[k];
            d.choose(above, (-d).choose(below, d.hull(-d)))
        })
    }
    #[inline(always)]
    fn min(a: Dual<Self>, b: Dual<Self>) -> [Self; 3] {
        let (first, second) = (a.value.hi() < b.value.lo(), b.value.hi() < a.value.lo());
        each_axis!(k => {
            let (da, db) = (a.gradient[k], b.gradient[k]);
            da.choose(first, db.choose(second, da.hull(db)))
        })
    }
    /// The mean is linear in the weight, so its extremes are at the ends of the weight's interval.
    #[inline(always)]
    fn mean(share: Self, da: [Self; 3], db: [Self; 3]) -> [Self; 3] {
        let one = Self::point(1.0);
        let share = share.max(Self::point(0.0)).min(one).bare();
        let (only_first, only_second) = (share.lo >= 1.0, share.hi <= 0.0);
        let (low, high) = (Self::point(share.lo), Self::point(share.hi));
        each_axis!(k => {
            let (da, db) = (da[k], db[k]);
            let mean = (low * da + (one - low) * db).hull(high * da + (one - high) * db);
            da.choose(only_first, db.choose(only_second, mean))
        })
    }
    #[inline(always)]
    fn length_gradient<const N: usize>(parts: [Self; N], _: Self) -> [Self; N] {
        let mut shares = parts;
        for (k, share) in shares.iter_mut().enumerate() {
            // The sum of the squares of the other coordinates.
            let mut others_sq = Self::point(0.0);
            for (i, part) in parts.iter().enumerate() {
                others_sq = if i == k { others_sq } else { others_sq + part.square() };
            }
            *share = parts[k].direction_cosine(others_sq);
        }
        shares
    }
    #[inline(always)]
    fn box_distance_gradient<const N: usize>(sides: [Self; N]) -> [Self; N] {
        let mut shares = sides;
        for (k, share) in shares.iter_mut().enumerate() {
            // The sum of the squares of the other sides above 0, and the interval of the largest other side.
            let (mut others_sq, mut largest) = (Self::point(0.0), Self::UNKNOWN.bare());
            largest.hi = f64::NEG_INFINITY;
            for (i, side) in sides.iter().enumerate() {
                let sum = others_sq + side.max(Self::point(0.0)).square();
                let ends = largest.max(side.bare());
                (others_sq, largest) = if i == k { (others_sq, largest) } else { (sum, ends) };
            }
            *share = sides[k].box_derivative(others_sq, largest);
        }
        shares
    }
    #[inline(always)]
    fn step_derivative(value: Self) -> Self {
        // With one value there is no jump in the box.
        Self::point(0.0).choose(value.lo() == value.hi(), Self::UNKNOWN)
    }
    #[inline(always)]
    fn integer_quotient_of(a: Self, b: Self, _: Self) -> Self {
        let quotient = a.bare().integer_quotient(b.bare());
        let n = Self::point(if b.hi() < 0.0 { -quotient } else { quotient });
        n.choose(!quotient.is_nan(), Self::UNKNOWN)
    }
    #[inline(always)]
    fn select(condition: Self, zero: [Self; 3], other: [Self; 3]) -> [Self; 3] {
        let condition = condition.bare();
        let (is_zero, never) = ((condition.lo == 0.0) & (condition.hi == 0.0), !condition.has_zero());
        each_axis!(k => {
            // A choice may jump from one to the other.
            let either = zero[k].hull(other[k]).undefined();
            zero[k].choose(is_zero, other[k].choose(never, either))
        })
    }
    #[inline(always)]
    fn unify_decorations(slope: Dual<Self>) -> Dual<Self> {
        let [x, y, z] = slope.gradient;
        let is_defined = slope.value.is_defined() & x.is_defined() & y.is_defined() & z.is_defined();
        Dual {
            value: slope.value.choose(is_defined, slope.value.undefined()),
            gradient: each_axis!(k => slope.gradient[k].choose(is_defined, slope.gradient[k].undefined())),
        }
    }
}

#[inline(always)]
fn neg<N: Scalar>(x: N) -> N {
    N::near(Unary::Neg, x)
}

#[inline(always)]
fn recip<N: Scalar>(x: N) -> N {
    N::near(Unary::Recip, x)
}

#[inline(always)]
fn square<N: Scalar>(x: N) -> N {
    N::near(Unary::Square, x)
}

#[inline(always)]
fn twice<N: Scalar>(x: N) -> N {
    mul(N::constant(2.0), x)
}

#[inline(always)]
fn add<N: Scalar>(x: N, y: N) -> N {
    N::binary(Binary::Add, x, y)
}

#[inline(always)]
fn sub<N: Scalar>(x: N, y: N) -> N {
    N::binary(Binary::Sub, x, y)
}

#[inline(always)]
fn mul<N: Scalar>(x: N, y: N) -> N {
    N::binary(Binary::Mul, x, y)
}

#[inline(always)]
fn div<N: Scalar>(x: N, y: N) -> N {
    N::binary(Binary::Div, x, y)
}

/// √(1 − x²).
#[inline(always)]
fn beside<N: Scalar>(x: N) -> N {
    N::near(Unary::Sqrt, sub(N::constant(1.0), square(x)))
}

/// The chain rule, from the value of an operation and, for sine and cosine, the value of the other of the
/// two.
#[inline(always)]
fn chain<N: GeneralizedDerivative>(op: Unary, a: Dual<N>, value: N, other: N) -> Dual<N> {
    let one = N::constant(1.0);
    let factor = match op {
        // These two have gradients of their own below.
        Unary::Neg | Unary::Abs => one,
        Unary::Recip => neg(square(value)),
        Unary::Sqrt => recip(twice(value)),
        Unary::Square => twice(a.value),
        Unary::Floor | Unary::Ceil | Unary::Round | Unary::Not => N::step_derivative(value),
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
    N::unify_decorations(Dual { value, gradient })
}

/// The operation whose value the chain rule needs in addition.
#[inline(always)]
fn partner(op: Unary) -> Unary {
    match op {
        Unary::Sin => Unary::Cos,
        Unary::Cos => Unary::Sin,
        // The chain rule needs no second value: any cheap operation will do.
        _ => Unary::Neg,
    }
}

#[inline(always)]
fn minus<N: GeneralizedDerivative>(a: Dual<N>) -> Dual<N> {
    Dual { value: neg(a.value), gradient: each_axis!(k => neg(a.gradient[k])) }
}

impl<N: GeneralizedDerivative> Scalar for Dual<N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        N::unify_decorations(Self { value: N::constant(value), gradient: [N::constant(0.0); 3] })
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
                let negated = N::min(minus(a), minus(b));
                each_axis!(k => neg(negated[k]))
            }
            Binary::SmoothMin => {
                let half = N::constant(0.5);
                N::mean(sub(half, mul(half, sub(a.value, b.value))), da, db)
            }
            Binary::RoundMin => {
                let (one, half) = (N::constant(1.0), N::constant(0.5));
                // The share of the first is 1/2 − t/(2√(2 − t²)) with their difference t, from −1 to 1.
                let difference = N::binary(Binary::Max, sub(a.value, b.value), neg(one));
                let difference = N::binary(Binary::Min, difference, one);
                let beside = N::near(Unary::Sqrt, sub(N::constant(2.0), square(difference)));
                N::mean(sub(half, mul(half, div(difference, beside))), da, db)
            }
            Binary::LogSumExp => {
                // If it overflows, the share is 0, which is its limit.
                let ratio = N::near(Unary::Exp, sub(b.value, a.value));
                N::mean(recip(add(N::constant(1.0), ratio)), da, db)
            }
            Binary::Atan2 => {
                let r = add(square(a.value), square(b.value));
                each_axis!(k => div(sub(mul(b.value, da[k]), mul(a.value, db[k])), r))
            }
            // a − n b, with an integer n that is constant between jumps.
            Binary::Mod => {
                let n = N::integer_quotient_of(a.value, b.value, value);
                each_axis!(k => sub(da[k], mul(n, db[k])))
            }
            Binary::Compare => [N::step_derivative(value); 3],
            Binary::And => N::select(a.value, da, db),
            Binary::Or => N::select(a.value, db, da),
        };
        N::unify_decorations(Self { value, gradient })
    }

    #[inline(always)]
    fn length<const M: usize>(parts: [Self; M]) -> Self {
        let values = values_of(&parts);
        let value = N::near(Unary::Sqrt, squares(&values));
        weighted(value, N::length_gradient(values, value), &parts)
    }

    #[inline(always)]
    fn box_distance<const M: usize>(sides: [Self; M]) -> Self {
        let values = values_of(&sides);
        weighted(N::box_distance(values), N::box_distance_gradient(values), &sides)
    }
}

#[inline(always)]
fn values_of<N: Scalar, const M: usize>(parts: &[Dual<N>; M]) -> [N; M] {
    let mut values = [parts[0].value; M];
    for (value, part) in values.iter_mut().zip(parts) {
        *value = part.value;
    }
    values
}

/// A value whose gradient is the sum of its parts' gradients with these weights.
#[inline(always)]
fn weighted<N: GeneralizedDerivative, const M: usize>(
    value: N,
    shares: [N; M],
    parts: &[Dual<N>; M],
) -> Dual<N> {
    let gradient = each_axis!(k => {
        let mut sum = mul(shares[0], parts[0].gradient[k]);
        for (share, part) in shares[1..].iter().zip(&parts[1..]) {
            sum = add(sum, mul(*share, part.gradient[k]));
        }
        sum
    });
    N::unify_decorations(Dual { value, gradient })
}
