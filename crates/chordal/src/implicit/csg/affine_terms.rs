//! Terms that are linear functions of the coordinates: all levels with one gradient are planes of one family.
use crate::implicit::Term;
use crate::implicit::op::{Binary, Unary};
use crate::math::{exponent, length, power_of_two};
use std::collections::BTreeMap;

/// A term that is `gradient · p + offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct AffineTerm {
    /// Without rounding.
    gradient: [f64; 3],
    offset: f64,
    /// The sum of the absolute values that the offset was computed from: a bound on its rounding is a
    /// multiple of it.
    size: f64,
}

impl AffineTerm {
    const ZERO: Self = Self { gradient: [0.0; 3], offset: 0.0, size: 0.0 };

    fn is_constant(&self) -> bool {
        self.gradient == [0.0; 3]
    }

    fn negated(self) -> Self {
        Self { gradient: self.gradient.map(|x| 0.0 - x), offset: 0.0 - self.offset, size: self.size }
    }

    /// `None` if a component of the gradient would be rounded.
    fn plus(self, other: Self) -> Option<Self> {
        let mut gradient = [0.0; 3];
        for (k, sum) in gradient.iter_mut().enumerate() {
            *sum = exact_sum(self.gradient[k], other.gradient[k])?;
        }
        Some(Self { gradient, offset: self.offset + other.offset, size: self.size + other.size })
    }

    fn times(self, factor: f64) -> Option<Self> {
        let mut gradient = [0.0; 3];
        for (product, x) in gradient.iter_mut().zip(self.gradient) {
            let is_exact = x == 0.0 || is_power_of_two(x) || is_power_of_two(factor);
            *product = is_exact.then_some(x * factor)?;
        }
        Some(Self { gradient, offset: self.offset * factor, size: self.size * factor.abs() })
    }
}

/// The sum if it is not rounded (Knuth's two-sum).
fn exact_sum(a: f64, b: f64) -> Option<f64> {
    let sum = a + b;
    let part = sum - a;
    ((a - (sum - part)) + (b - part) == 0.0).then_some(sum)
}

fn is_power_of_two(x: f64) -> bool {
    x.is_normal() && power_of_two(exponent(x.abs()) - 1) == x.abs()
}

/// The planes of a term.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneFamily {
    /// Its number, the same for all terms of one gradient up to its sign.
    pub number: u32,
    /// The length of the gradient.
    pub steepness: f64,
    /// Whether the term has the opposite gradient.
    pub is_opposite: bool,
    pub offset: f64,
    pub size: f64,
}

/// The linear terms of an expression.
#[derive(Debug, Default)]
pub(super) struct AffineTerms {
    all: Vec<Option<AffineTerm>>,
    families: BTreeMap<[u64; 3], u32>,
}

impl AffineTerms {
    pub fn new(terms: &[Term]) -> Self {
        let mut affine: Vec<Option<AffineTerm>> = Vec::with_capacity(terms.len());
        for term in terms {
            let operand = |part: u32| affine[part as usize];
            let term_value = match *term {
                Term::Const(value) => {
                    Some(AffineTerm { offset: value, size: value.abs(), ..AffineTerm::ZERO })
                }
                Term::Axis(axis) => {
                    let gradient = std::array::from_fn(|k| if k == usize::from(axis) { 1.0 } else { 0.0 });
                    Some(AffineTerm { gradient, ..AffineTerm::ZERO })
                }
                Term::Unary(Unary::Neg, a) => operand(a).map(AffineTerm::negated),
                Term::Binary(op, a, b) => operand(a).zip(operand(b)).and_then(|(a, b)| combined(op, a, b)),
                Term::Unary(..) | Term::Leaf(..) => None,
            };
            affine.push(
                term_value.filter(|value| value.offset.is_finite() && length(value.gradient).is_finite()),
            );
        }
        Self { all: affine, families: BTreeMap::new() }
    }

    /// The planes of a term, if it is linear and not constant.
    pub fn family(&mut self, term: u32) -> Option<PlaneFamily> {
        let affine = self.all[term as usize].filter(|affine| !affine.is_constant())?;
        // Opposite gradients are one family: that whose first component other than 0 is positive.
        let is_opposite = affine.gradient.iter().find(|x| **x != 0.0).is_some_and(|x| *x < 0.0);
        let normalized = if is_opposite { affine.negated() } else { affine };
        let next = self.families.len() as u32;
        // −0 and 0 are one number.
        let key = normalized.gradient.map(|x| (x + 0.0).to_bits());
        let number = *self.families.entry(key).or_insert(next);
        let steepness = length(normalized.gradient);
        let AffineTerm { offset, size, .. } = normalized;
        (steepness > 0.0).then_some(PlaneFamily { number, steepness, is_opposite, offset, size })
    }
}

fn combined(op: Binary, a: AffineTerm, b: AffineTerm) -> Option<AffineTerm> {
    match op {
        Binary::Add => a.plus(b),
        Binary::Sub => a.plus(b.negated()),
        Binary::Mul if b.is_constant() => a.times(b.offset),
        Binary::Mul if a.is_constant() => b.times(a.offset),
        // Of a power of two alone, the reciprocal is exact.
        Binary::Div if b.is_constant() && is_power_of_two(b.offset) => a.times(1.0 / b.offset),
        _ => None,
    }
}
