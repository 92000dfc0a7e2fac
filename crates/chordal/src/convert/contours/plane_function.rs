//! Functions of the plane that vanish on a line or a circle, with a bound for the distance of their exact zeros from
//! it.
use crate::implicit::evaluation::{Binary, Unary};
use crate::implicit::{Primitive, Term};
use crate::math::{Interval, dot, greater, length};

/// A function whose sign is that of the distance to a line or circle, or the opposite of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneFunction {
    pub curve: PlaneCurve,
    /// Whether the function is negative if the distance is positive.
    pub is_opposite: bool,
    quadratic: PlaneQuadratic,
}

/// A curve with a signed distance in the plane.
#[derive(Clone, Copy, Debug)]
pub(super) enum PlaneCurve {
    /// The points `p` with `normal · p = offset`; negative if `normal · p` is less.
    Line { normal: [f64; 2], offset: f64 },
    /// Negative inside.
    Circle { centre: [f64; 2], radius: f64 },
    /// No curve: positive everywhere.
    Nowhere,
}

impl PlaneCurve {
    /// The signed distance.
    pub fn distance(&self, p: [f64; 2]) -> f64 {
        match self {
            Self::Line { normal, offset } => dot(*normal, p) - offset,
            Self::Circle { centre, radius } => length([p[0] - centre[0], p[1] - centre[1]]) - radius,
            Self::Nowhere => f64::INFINITY,
        }
    }
}

/// Coefficients count as equal, or as 0, up to this fraction. Defined: far above rounding; their error counts as
/// distance.
const NEAR: f64 = 1.0 / (1_u64 << 30) as f64;
/// Derived: sixteen roundings, more than the computation of a circle's constant takes.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

impl PlaneFunction {
    /// `None` unless the function is known to vanish on a line, on a circle or nowhere.
    pub fn from_primitive(primitive: &Primitive) -> Option<Self> {
        if !primitive.is_total() {
            return None;
        }
        match PlaneTerm::from_terms(primitive.tape().graph().terms())? {
            PlaneTerm::Quadratic(quadratic) => Self::from_quadratic(quadratic, false),
            PlaneTerm::Root { square, scale, offset } => {
                if scale.lo() <= 0.0 && scale.hi() >= 0.0 {
                    return None;
                }
                // The function is `scale · (√square − level)`.
                let is_opposite = scale.hi() < 0.0;
                let level = -offset / scale;
                // A root is above every negative level.
                if level.hi() < 0.0 {
                    return Some(Self { curve: PlaneCurve::Nowhere, is_opposite, quadratic: square });
                }
                // For a positive level, √s − l has the sign of s − l².
                let quadratic = square.plus(&PlaneQuadratic::constant(-(level * level)));
                if level.lo() > 0.0 { Self::from_quadratic(quadratic, is_opposite) } else { None }
            }
        }
    }

    fn from_quadratic(quadratic: PlaneQuadratic, is_opposite: bool) -> Option<Self> {
        let PlaneQuadratic(ranges) = quadratic;
        let mut middles = [0.0; 6];
        for (middle, range) in middles.iter_mut().zip(ranges) {
            *middle = range.midpoint().filter(|x| range.magnitude().is_finite() && x.is_finite())?;
        }
        let [xx, xy, yy, x, y, constant] = middles;
        if quadratic.as_constant().is_some() {
            let is_clear = ranges[5].lo() > 0.0 || ranges[5].hi() < 0.0;
            // A negative constant is negative everywhere, which is the opposite of `Nowhere`.
            let is_opposite = is_opposite != (constant < 0.0);
            return is_clear.then_some(Self { curve: PlaneCurve::Nowhere, is_opposite, quadratic });
        }
        if quadratic.is_linear() {
            // A line along an axis needs no rounding.
            let size = if y == 0.0 {
                x.abs()
            } else if x == 0.0 {
                y.abs()
            } else {
                length([x, y])
            };
            // Subtracted from 0, so that an offset of 0 is not −0.
            let curve = PlaneCurve::Line { normal: [x / size, y / size], offset: 0.0 - constant / size };
            return size.is_normal().then_some(Self { curve, is_opposite, quadratic });
        }
        let is_round = (yy - xx).abs() <= NEAR * xx.abs() && xy.abs() <= NEAR * xx.abs();
        let centre = [x, y].map(|x| 0.0 - x / (2.0 * xx));
        let square = dot(centre, centre) - constant / xx;
        if !xx.is_normal() || !is_round || !square.is_normal() || square < 0.0 {
            return None;
        }
        let curve = PlaneCurve::Circle { centre, radius: square.sqrt() };
        Some(Self { curve, is_opposite: is_opposite != (xx < 0.0), quadratic })
    }

    /// Whether the function is negative at a point whose distance is below 0, or is not, by `is_below`.
    pub fn is_negative(&self, is_below: bool) -> bool {
        is_below != self.is_opposite
    }

    /// The largest distance of a zero of the function from the curve, among points with coordinates up to `reach`; the
    /// curve's centre and radius do not exceed it either.
    pub fn off_at_most(&self, reach: f64) -> f64 {
        let PlaneQuadratic(ranges) = self.quadratic;
        let middle = |k: usize| ranges[k].midpoint().unwrap_or(f64::NAN);
        // The coefficients of the curve itself, the change of the function for one unit of distance, and the scale of
        // the rounding in the constants.
        let (coefficients, steepness, rounding) = match self.curve {
            PlaneCurve::Nowhere => return 0.0,
            PlaneCurve::Line { normal, offset } => {
                let size = length([middle(3), middle(4)]);
                ([0.0, 0.0, 0.0, normal[0] * size, normal[1] * size, 0.0 - offset * size], size, size * reach)
            }
            PlaneCurve::Circle { centre, radius } => {
                let xx = middle(0);
                let squares = (dot(centre, centre), radius * radius);
                let [x, y] = centre.map(|x| 0.0 - 2.0 * xx * x);
                let coefficients = [xx, 0.0, xx, x, y, xx * (squares.0 - squares.1)];
                // `|p|² − r²` is at least `r (|p| − r)`.
                (coefficients, xx.abs() * radius, xx.abs() * (squares.0 + squares.1))
            }
        };
        let degrees = [reach * reach, reach * reach, reach * reach, reach, reach, 1.0];
        let parts = ranges.iter().zip(coefficients).zip(degrees).map(|((range, coefficient), degree)| {
            let (above, below) = ((range.hi() - coefficient).abs(), (coefficient - range.lo()).abs());
            degree * greater(above, below)
        });
        (parts.fold(0.0, |sum, part| sum + part) + ROUNDINGS * rounding) / steepness
    }
}

/// The coefficients of x², xy, y², x, y and 1, enclosed.
#[derive(Clone, Copy, Debug)]
struct PlaneQuadratic([Interval; 6]);

/// A term on the plane z = 0.
#[derive(Clone, Copy, Debug)]
enum PlaneTerm {
    Quadratic(PlaneQuadratic),
    /// `scale · √square + offset`.
    Root {
        square: PlaneQuadratic,
        scale: Interval,
        offset: Interval,
    },
}

fn is_zero(x: Interval) -> bool {
    x.lo() == 0.0 && x.hi() == 0.0
}

fn is_one(x: Interval) -> bool {
    x.lo() == 1.0 && x.hi() == 1.0
}

/// The sum, without rounding if one term is 0.
fn sum(a: Interval, b: Interval) -> Interval {
    if is_zero(a) {
        b
    } else if is_zero(b) {
        a
    } else {
        a + b
    }
}

/// The product, without rounding if one factor is 0 or 1.
fn product(a: Interval, b: Interval) -> Interval {
    if is_zero(a) || is_one(b) {
        a
    } else if is_zero(b) || is_one(a) {
        b
    } else {
        a * b
    }
}

impl PlaneQuadratic {
    fn constant(value: Interval) -> Self {
        let mut coefficients = [Interval::point(0.0); 6];
        coefficients[5] = value;
        Self(coefficients)
    }

    fn axis(k: usize) -> Self {
        let mut coefficients = [Interval::point(0.0); 6];
        coefficients[3 + k] = Interval::point(1.0);
        Self(coefficients)
    }

    fn as_constant(&self) -> Option<Interval> {
        self.0[..5].iter().all(|x| is_zero(*x)).then_some(self.0[5])
    }

    fn is_linear(&self) -> bool {
        self.0[..3].iter().all(|x| is_zero(*x))
    }

    fn negated(&self) -> Self {
        Self(self.0.map(|x| if is_zero(x) { x } else { -x }))
    }

    fn plus(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| sum(self.0[k], other.0[k])))
    }

    fn scaled(&self, factor: Interval) -> Self {
        Self(self.0.map(|x| product(x, factor)))
    }

    fn times(&self, other: &Self) -> Option<Self> {
        if let Some(by) = other.as_constant() {
            return Some(self.scaled(by));
        }
        if let Some(by) = self.as_constant() {
            return Some(other.scaled(by));
        }
        if !self.is_linear() || !other.is_linear() {
            return None;
        }
        // (ax + by + c) · (dx + ey + f), by x², xy, y², x, y and 1.
        let ([_, _, _, a, b, c], [_, _, _, d, e, f]) = (self.0, other.0);
        let mixed = |p: Interval, q: Interval, r: Interval, s: Interval| sum(product(p, s), product(q, r));
        Some(Self([
            product(a, d),
            mixed(a, b, d, e),
            product(b, e),
            mixed(a, c, d, f),
            mixed(b, c, e, f),
            product(c, f),
        ]))
    }
}

impl PlaneTerm {
    /// The plane term of the last of some terms.
    fn from_terms(terms: &[Term]) -> Option<Self> {
        let mut plane_terms: Vec<Option<Self>> = Vec::with_capacity(terms.len());
        for term in terms {
            let operand = |part: u32| plane_terms[part as usize];
            let plane_term = match *term {
                Term::Const(value) if value.is_finite() => {
                    Some(Self::Quadratic(PlaneQuadratic::constant(Interval::point(value))))
                }
                Term::Axis(k) if k < 2 => Some(Self::Quadratic(PlaneQuadratic::axis(usize::from(k)))),
                Term::Axis(_) => Some(Self::Quadratic(PlaneQuadratic::constant(Interval::point(0.0)))),
                Term::Unary(op, a) => operand(a).and_then(|a| a.after(op)),
                Term::Binary(op, a, b) => operand(a).zip(operand(b)).and_then(|(a, b)| a.with(op, b)),
                Term::Const(_) | Term::Leaf(..) => None,
            };
            plane_terms.push(plane_term);
        }
        plane_terms.pop().flatten()
    }

    fn as_constant(&self) -> Option<Interval> {
        match self {
            Self::Quadratic(quadratic) => quadratic.as_constant(),
            Self::Root { .. } => None,
        }
    }

    fn after(self, op: Unary) -> Option<Self> {
        match (op, self) {
            (Unary::Neg, _) => Some(self.negated()),
            (Unary::Square, Self::Quadratic(quadratic)) => quadratic.times(&quadratic).map(Self::Quadratic),
            (Unary::Square, Self::Root { square, scale, offset }) if is_zero(offset) => {
                Some(Self::Quadratic(square.scaled(product(scale, scale))))
            }
            (Unary::Sqrt, Self::Quadratic(square)) => {
                Some(Self::Root { square, scale: Interval::point(1.0), offset: Interval::point(0.0) })
            }
            _ => None,
        }
    }

    fn with(self, op: Binary, other: Self) -> Option<Self> {
        match op {
            Binary::Add => self.plus(other),
            Binary::Sub => self.plus(other.negated()),
            Binary::Mul => self.times(other),
            Binary::Div => {
                let by = other.as_constant().filter(|by| by.lo() > 0.0 || by.hi() < 0.0)?;
                // Exact in these cases, in which a quotient would be rounded outward.
                let over = |x: Interval| if is_zero(x) || is_one(by) { x } else { x / by };
                Some(match self {
                    Self::Quadratic(PlaneQuadratic(all)) => Self::Quadratic(PlaneQuadratic(all.map(over))),
                    Self::Root { square, scale, offset } => {
                        Self::Root { square, scale: over(scale), offset: over(offset) }
                    }
                })
            }
            _ => None,
        }
    }

    fn negated(self) -> Self {
        match self {
            Self::Quadratic(quadratic) => Self::Quadratic(quadratic.negated()),
            Self::Root { square, scale, offset } => {
                Self::Root { square, scale: -scale, offset: if is_zero(offset) { offset } else { -offset } }
            }
        }
    }

    fn plus(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Quadratic(a), Self::Quadratic(b)) => Some(Self::Quadratic(a.plus(&b))),
            (Self::Root { square, scale, offset }, added @ Self::Quadratic(_))
            | (added @ Self::Quadratic(_), Self::Root { square, scale, offset }) => {
                let offset = sum(offset, added.as_constant()?);
                Some(Self::Root { square, scale, offset })
            }
            (Self::Root { .. }, Self::Root { .. }) => None,
        }
    }

    fn times(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Quadratic(a), Self::Quadratic(b)) => a.times(&b).map(Self::Quadratic),
            (Self::Root { square, scale, offset }, factor @ Self::Quadratic(_))
            | (factor @ Self::Quadratic(_), Self::Root { square, scale, offset }) => {
                let by = factor.as_constant()?;
                Some(Self::Root { square, scale: product(scale, by), offset: product(offset, by) })
            }
            (Self::Root { .. }, Self::Root { .. }) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::{Csg, Expr};

    fn function(expr: &Expr) -> Option<PlaneFunction> {
        PlaneFunction::from_primitive(&Csg::from_expr(expr).primitives()[0])
    }

    #[test]
    fn lines_and_circles_are_told_however_they_are_written() {
        let [x, y, z] = Expr::axes();
        let (u, v) = (&x * 0.8 - &y * 0.6 - 3.0, &x * 0.6 + &y * 0.8);
        let turned = function(&((u.square() + v.square()).sqrt() * 2.0 - 5.0)).unwrap();
        let PlaneCurve::Circle { centre, radius } = turned.curve else { panic!("{turned:?}") };
        let off = turned.off_at_most(10.0);
        assert!(off < 1e-12 && (centre[0] - 2.4).abs() + (centre[1] + 1.8).abs() < 1e-12, "{centre:?} {off}");
        assert!((radius - 2.5).abs() < 1e-12 && turned.is_negative(true));
        let outside = function(&(Expr::constant(4.0) - x.square() - y.square())).unwrap();
        assert!(
            matches!(outside.curve, PlaneCurve::Circle { radius: 2.0, .. }) && !outside.is_negative(true)
        );
        let line = function(&((&x - 3.0) * 2.0 + &z)).unwrap();
        assert!(line.curve.distance([5.0, 7.0]) == 2.0 && line.off_at_most(10.0) < 1e-13);
        let above = function(&(&z - 1.0)).unwrap();
        assert!(matches!(above.curve, PlaneCurve::Nowhere) && above.is_negative(false));
        for other in [x.square() + &y, x.square() + y.square() * 2.0 - 1.0, x.sin(), x.square().sqrt() - 1.0]
        {
            assert!(function(&other).is_none(), "{other:?}");
        }
    }
}
