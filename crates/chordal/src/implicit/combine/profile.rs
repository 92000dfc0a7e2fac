//! Profiles of revolution: removes the boundaries that a profile has only along the axis.
//!
//! A rectangle from x = 0 to 2 is `max(x − 2, −x)`, and the polygon of a vase has a side on the axis. In the
//! plane that side is a boundary. In the solid it would make the axis a surface of its own: an infinitely
//! thin hole, on which no box of any size is decided. So if one operand of a maximum or minimum changes its
//! sign only at the axis, only the other operand is kept, and a polygon is joined with its own mirror image.
use crate::implicit::material::MaterialMark;
use crate::implicit::op::{Binary, Unary};
use crate::implicit::{Expr, ExprGraph, Term};

/// An expression with the sign of a profile for x > 0. On the axis it has the sign of the points beside it.
pub(super) fn without_axis(sign: &Expr) -> Expr {
    let graph = ExprGraph::with_materials(sign);
    let mut terms: Vec<ProfileTerm> = Vec::with_capacity(graph.terms().len());
    for term in graph.terms() {
        let profile_term = ProfileTerm::new(term, &terms);
        terms.push(profile_term);
    }
    match terms.pop() {
        Some(ProfileTerm { sign: Some(changed), .. }) => changed,
        _ => sign.clone(),
    }
}

/// `slope · x + offset`, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LinearFunction {
    slope: f64,
    offset: f64,
}

impl LinearFunction {
    fn plus(self, other: Self) -> Option<Self> {
        Some(Self {
            slope: exact_sum(self.slope, other.slope)?,
            offset: exact_sum(self.offset, other.offset)?,
        })
    }

    fn negated(self) -> Self {
        Self { slope: -self.slope, offset: -self.offset }
    }

    fn times(self, factor: f64) -> Option<Self> {
        Some(Self { slope: exact_product(self.slope, factor)?, offset: exact_product(self.offset, factor)? })
    }

    /// Whether it is negative for all x > 0, but not everywhere.
    fn is_below(self) -> bool {
        self.slope < 0.0 && self.offset <= 0.0
    }

    fn is_above(self) -> bool {
        self.negated().is_below()
    }

    fn constant(self) -> Option<f64> {
        (self.slope == 0.0).then_some(self.offset)
    }
}

/// The known properties of a term.
struct ProfileTerm {
    /// The term.
    value: Expr,
    /// The term as a linear function of x, if it is one.
    line: Option<LinearFunction>,
    /// Another expression with its sign off the axis, if there is a better one.
    sign: Option<Expr>,
    /// The operand of an absolute value.
    inside: Option<(Expr, Option<LinearFunction>)>,
}

impl ProfileTerm {
    fn new(term: &Term, terms: &[Self]) -> Self {
        let at = |k: &u32| &terms[*k as usize];
        let plain = |value: Expr| Self { value, line: None, sign: None, inside: None };
        match term {
            Term::Const(c) => {
                Self { line: Some(LinearFunction { slope: 0.0, offset: *c }), ..plain(Expr::constant(*c)) }
            }
            Term::Axis(k) => {
                let line = (*k == 0).then_some(LinearFunction { slope: 1.0, offset: 0.0 });
                Self { line, ..plain(Expr::axes()[usize::from(*k)].clone()) }
            }
            Term::Unary(op, a) => {
                let a = at(a);
                let value = Expr::unary(*op, &a.value);
                match op {
                    Unary::Neg => Self {
                        line: a.line.map(LinearFunction::negated),
                        sign: a.sign.as_ref().map(|s| -s),
                        ..plain(value)
                    },
                    Unary::Abs => Self { inside: Some((a.value.clone(), a.line)), ..plain(value) },
                    _ => plain(value),
                }
            }
            Term::Binary(op, a, b) => {
                let (a, b) = (at(a), at(b));
                let value = Expr::binary(*op, &a.value, &b.value);
                let sign = match op {
                    Binary::Max => Self::chosen(Binary::Max, a, b, LinearFunction::is_below),
                    Binary::Min => Self::chosen(Binary::Min, a, b, LinearFunction::is_above),
                    Binary::Sub => Self::slab(a, b),
                    Binary::Mul | Binary::Div => Self::scaled(*op, a, b),
                    _ => None,
                };
                Self { line: Self::line(*op, a, b), sign, ..plain(value) }
            }
            Term::Leaf(leaf, [below, ..]) if MaterialMark::from_leaf(leaf).is_some() => {
                let below = at(below);
                let sign = below.sign.as_ref().map(|sign| sign.marked(leaf));
                Self { line: below.line, sign, ..plain(below.value.marked(leaf)) }
            }
            Term::Leaf(leaf, [x, y, z]) => {
                let coordinates = [x, y, z].map(|part| at(part).value.clone());
                // The axis in the leaf's own coordinate, if its x grows with ours.
                let axis = at(x).line.filter(|line| line.slope > 0.0).map(|line| line.offset);
                let sign = axis
                    .and_then(|axis| leaf.without_axis(axis))
                    .map(|joined| Expr::leaf(joined, coordinates.clone()));
                Self { sign, ..plain(Expr::leaf(leaf.clone(), coordinates)) }
            }
        }
    }

    fn line(op: Binary, a: &Self, b: &Self) -> Option<LinearFunction> {
        let (first, second) = (a.line?, b.line?);
        match op {
            Binary::Add => first.plus(second),
            Binary::Sub => first.plus(second.negated()),
            Binary::Mul => match (first.constant(), second.constant()) {
                (_, Some(factor)) => first.times(factor),
                (Some(factor), _) => second.times(factor),
                _ => None,
            },
            Binary::Div => second.constant().filter(|by| is_power(*by)).and_then(|by| first.times(1.0 / by)),
            _ => None,
        }
    }

    /// The remaining operand of a maximum or minimum, if the other one can `never` decide off the axis.
    fn chosen(op: Binary, a: &Self, b: &Self, never: fn(LinearFunction) -> bool) -> Option<Expr> {
        let has_none = |part: &Self| part.line.is_some_and(never);
        let sign_of = |part: &Self| part.sign.as_ref().unwrap_or(&part.value).clone();
        match (has_none(a), has_none(b)) {
            (true, false) => Some(sign_of(b)),
            (false, true) => Some(sign_of(a)),
            _ if a.sign.is_some() || b.sign.is_some() => Some(Expr::binary(op, &sign_of(a), &sign_of(b))),
            _ => None,
        }
    }

    /// `|u| − c` is `max(u − c, −u − c)`, and `c − |u|` is the minimum of the negatives.
    fn slab(a: &Self, b: &Self) -> Option<Expr> {
        let (inside, half, outward) = match (&a.inside, b.line, a.line, &b.inside) {
            (Some(inside), Some(half), ..) => (inside, half.constant()?, true),
            (_, _, Some(half), Some(inside)) => (inside, half.constant()?, false),
            _ => return None,
        };
        let (u, line) = (&inside.0, inside.1?);
        let side = |line: LinearFunction| {
            line.plus(LinearFunction { slope: 0.0, offset: -half }).is_some_and(LinearFunction::is_below)
        };
        let remaining = match (side(line), side(line.negated())) {
            (true, false) => -u - half,
            (false, true) => u - half,
            _ => return None,
        };
        Some(if outward { remaining } else { -remaining })
    }

    /// The sign after scaling by a constant.
    fn scaled(op: Binary, a: &Self, b: &Self) -> Option<Expr> {
        let factor = |part: &Self| {
            part.line.and_then(LinearFunction::constant).is_some_and(|c| c != 0.0 && c.is_finite())
        };
        match (&a.sign, &b.sign) {
            (Some(sign), _) if factor(b) => Some(Expr::binary(op, sign, &b.value)),
            (_, Some(sign)) if op == Binary::Mul && factor(a) => Some(Expr::binary(op, &a.value, sign)),
            _ => None,
        }
    }
}

/// The sum, if it is not rounded. Source: D. Knuth, *The Art of Computer Programming* 2, 4.2.2 (two-sum).
fn exact_sum(a: f64, b: f64) -> Option<f64> {
    let sum = a + b;
    let second = sum - a;
    let error = (a - (sum - second)) + (b - second);
    (error == 0.0 && sum.is_finite()).then_some(sum)
}

/// The product, if it is not rounded: 0, or a normal number with a power of two as a factor.
fn exact_product(a: f64, factor: f64) -> Option<f64> {
    if a == 0.0 && factor.is_finite() {
        return Some(0.0);
    }
    let product = a * factor;
    let plain = product.is_normal() && (is_power(factor) || is_power(a));
    plain.then_some(product)
}

/// Whether it is a power of two or the negative of one: a number without a fraction in its bits.
fn is_power(x: f64) -> bool {
    let fraction = x.to_bits() & ((1 << (f64::MANTISSA_DIGITS - 1)) - 1);
    x.is_normal() && fraction == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::Field;
    use crate::implicit::shapes::{polygon, rectangle};

    fn on_axis(profile: &Field) -> f64 {
        without_axis(profile.sign()).at([0.0, 0.25, 0.0]).expect("a value")
    }

    #[test]
    fn profiles_with_a_side_on_the_axis_hold_it() {
        let square = rectangle([2.0, 4.0]).expect("a shape").moved([1.0, 0.0, 0.0]).expect("a shape");
        let triangle = polygon(&[[0.0, -1.0], [2.0, 0.0], [0.0, 1.0]]).expect("a shape");
        let moved = polygon(&[[-1.0, -1.0], [2.0, 0.0], [-1.0, 1.0]])
            .and_then(|shape| shape.moved([1.0, 0.0, 0.0]))
            .expect("a shape");
        let hole = rectangle([8.0, 8.0]).expect("a shape").difference(&triangle);
        for profile in [&square, &triangle, &moved] {
            assert_eq!(profile.sign().at([0.0, 0.25, 0.0]).expect("a value"), 0.0);
            assert!(on_axis(profile) < 0.0);
            assert!(on_axis(&profile.union(&square)) < 0.0);
            assert!(on_axis(&profile.intersection(&square)) < 0.0);
            assert!(on_axis(&profile.complement()) > 0.0);
        }
        assert!(on_axis(&hole) > 0.0);
    }

    #[test]
    fn off_the_axis_no_sign_changes() {
        let profiles = [
            rectangle([2.0, 4.0]).and_then(|shape| shape.moved([1.0, 0.0, 0.0])),
            rectangle([2.0, 4.0]).and_then(|shape| shape.moved([1.5, 0.0, 0.0])),
            rectangle([2.0, 4.0]),
            polygon(&[[0.0, -1.0], [2.0, 0.0], [0.0, 1.0]]),
            polygon(&[
                [0.0, -1.0],
                [1.0, -1.0],
                [0.5, 0.0],
                [1.0, 1.0],
                [0.0, 1.0],
                [0.0, 0.5],
                [0.25, 0.0],
                [0.0, -0.5],
            ]),
            polygon(&[[-1.0, -1.0], [2.0, 0.0], [-1.0, 1.0]]),
            polygon(&[[0.0, -1.0], [2.0, 0.0], [0.0, 1.0]]).and_then(|shape| shape.offset(-0.125)),
            polygon(&[[0.0, -1.0], [2.0, 0.0], [0.0, 1.0]]).and_then(|shape| shape.shell(0.25)),
        ];
        for profile in profiles.into_iter().map(|profile| profile.expect("a shape")) {
            let changed = without_axis(profile.sign());
            for k in 0..400 {
                let p = [0.01 + 0.11 * f64::from(k % 20), -2.2 + 0.23 * f64::from(k / 20), 0.0];
                let [before, after] = [profile.sign(), &changed].map(|sign| sign.at(p).expect("a value"));
                assert_eq!(before < 0.0, after < 0.0, "{p:?}: {before} {after}");
                assert_eq!(before > 0.0, after > 0.0, "{p:?}: {before} {after}");
            }
        }
    }
}
