//! `Curvature`: whether a primitive is convex or concave, by the rules of composition.
//!
//! Planes, balls, cylinders, cones, capsules and rounded boxes are convex functions, and so they are at most
//! as large on a triangle as at its corners, however coarse it is. The rules are about the exact function of
//! real numbers, on all of space: a function that is not defined everywhere is unknown. Sums, maxima and
//! positive multiples of convex functions are convex. The square of a convex function that is nowhere
//! negative is convex, since squares grow there. So is the root of a sum of such squares and of squares of
//! linear functions, since a norm is convex and grows with the size of each of its components.
//!
//! Source: M. Grant, S. Boyd, Y. Ye, *Disciplined convex programming*, 2006; S. Boyd, L. Vandenberghe,
//! *Convex optimization*, 2004, 3.2.
use crate::implicit::Term;
use crate::implicit::op::{Binary, Unary};
use crate::implicit::shapes::is_axis_distance;

/// How a function bends, as far as known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// It is linear, which is both.
    Linear,
    /// It is nowhere above its linear interpolation.
    Convex,
    /// It is nowhere below its linear interpolation.
    Concave,
    /// Nothing is known.
    Unknown,
}

impl Curvature {
    /// The curvature of the last of some terms.
    pub(super) fn from_terms(terms: &[Term]) -> Self {
        let mut bendings: Vec<TermBending> = Vec::with_capacity(terms.len());
        terms.iter().for_each(|term| bendings.push(TermBending::new(term, &bendings)));
        bendings.last().map_or(Self::Unknown, |root| root.curvature)
    }

    /// Whether it is nowhere above its linear interpolation.
    #[must_use]
    pub fn is_convex(self) -> bool {
        matches!(self, Self::Linear | Self::Convex)
    }

    /// Whether it is nowhere below its linear interpolation.
    #[must_use]
    pub fn is_concave(self) -> bool {
        matches!(self, Self::Linear | Self::Concave)
    }

    fn negated(self) -> Self {
        match self {
            Self::Convex => Self::Concave,
            Self::Concave => Self::Convex,
            same => same,
        }
    }

    fn plus(self, other: Self) -> Self {
        match (self, other) {
            (Self::Linear, known) | (known, Self::Linear) => known,
            (known, same) if known == same => known,
            _ => Self::Unknown,
        }
    }
}

/// The properties of a term, as far as known.
#[derive(Clone, Copy, Debug)]
struct TermBending {
    curvature: Curvature,
    /// It is at least 0 everywhere.
    is_positive: bool,
    /// It is a sum of squares of functions that are linear, or convex and at least 0, and of numbers that are
    /// at least 0.
    is_sum_of_squares: bool,
    constant: Option<f64>,
}

impl TermBending {
    const UNKNOWN: Self =
        Self { curvature: Curvature::Unknown, is_positive: false, is_sum_of_squares: false, constant: None };

    /// The constant 0.
    const ZERO: Self = Self {
        curvature: Curvature::Linear,
        is_positive: true,
        is_sum_of_squares: true,
        constant: Some(0.0),
    };

    fn new(term: &Term, below: &[Self]) -> Self {
        let bending = |part: u32| below[part as usize];
        match *term {
            Term::Const(value) if value.is_finite() => Self {
                is_positive: value >= 0.0,
                is_sum_of_squares: value >= 0.0,
                constant: Some(value),
                ..Self::ZERO
            },
            Term::Axis(_) => Self { curvature: Curvature::Linear, ..Self::UNKNOWN },
            Term::Unary(op, a) => bending(a).after(op),
            Term::Binary(Binary::Mul, a, b) if a == b => bending(a).after(Unary::Square),
            Term::Binary(op, a, b) => bending(a).with(op, bending(b)),
            // The length of a vector of two components.
            Term::Leaf(ref leaf, [x, y, _]) if is_axis_distance(&**leaf) => {
                let square = |part: u32| bending(part).after(Unary::Square);
                square(x).with(Binary::Add, square(y)).after(Unary::Sqrt)
            }
            Term::Const(_) | Term::Leaf(..) => Self::UNKNOWN,
        }
    }

    fn after(self, op: Unary) -> Self {
        let is_norm = self.curvature == Curvature::Linear || self.is_convex_and_positive();
        let convex = Self { curvature: Curvature::Convex, is_positive: true, ..Self::UNKNOWN };
        match op {
            Unary::Neg => Self { curvature: self.curvature.negated(), ..Self::UNKNOWN },
            Unary::Abs if is_norm => convex,
            Unary::Square if is_norm => Self { is_sum_of_squares: true, ..convex },
            Unary::Sqrt if self.is_sum_of_squares => convex,
            Unary::Exp if self.curvature.is_convex() => convex,
            Unary::Abs | Unary::Square | Unary::Exp => {
                Self { curvature: Curvature::Unknown, ..convex }.where_defined(self)
            }
            _ => Self::UNKNOWN,
        }
    }

    fn with(self, op: Binary, other: Self) -> Self {
        let both_positive = self.is_positive && other.is_positive;
        match op {
            Binary::Add => Self {
                curvature: self.curvature.plus(other.curvature),
                is_positive: both_positive,
                is_sum_of_squares: self.is_sum_of_squares && other.is_sum_of_squares,
                constant: None,
            },
            Binary::Sub => self.with(Binary::Add, other.after(Unary::Neg)),
            Binary::Mul => match (self.constant, other.constant) {
                (Some(factor), _) => other.times(factor),
                (None, Some(factor)) => self.times(factor),
                (None, None) => Self::UNKNOWN,
            },
            Binary::Div => match other.constant.filter(|divisor| *divisor != 0.0) {
                // Only the sign of the factor matters.
                Some(divisor) => self.times(divisor),
                None => Self::UNKNOWN,
            },
            Binary::Max if self.curvature.is_convex() && other.curvature.is_convex() => Self {
                curvature: Curvature::Convex,
                is_positive: self.is_positive || other.is_positive,
                ..Self::UNKNOWN
            },
            Binary::Min if self.curvature.is_concave() && other.curvature.is_concave() => {
                Self { curvature: Curvature::Concave, is_positive: both_positive, ..Self::UNKNOWN }
            }
            Binary::LogSumExp if self.curvature.is_convex() && other.curvature.is_convex() => {
                Self { curvature: Curvature::Convex, ..Self::UNKNOWN }
            }
            _ => Self::UNKNOWN,
        }
    }

    /// The properties of its multiple, which depend only on the sign of the factor.
    fn times(self, factor: f64) -> Self {
        match factor {
            factor if factor > 0.0 => Self { constant: None, ..self },
            factor if factor < 0.0 => self.after(Unary::Neg),
            // 0 times a function that is defined everywhere is 0.
            0.0 if self.curvature != Curvature::Unknown => Self::ZERO,
            _ => Self::UNKNOWN,
        }
    }

    fn is_convex_and_positive(self) -> bool {
        self.is_positive && self.curvature.is_convex()
    }

    /// Only functions of known curvature are known to be defined everywhere.
    fn where_defined(self, below: Self) -> Self {
        if below.curvature == Curvature::Unknown { Self::UNKNOWN } else { self }
    }
}
