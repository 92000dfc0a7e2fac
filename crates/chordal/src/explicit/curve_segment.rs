//! `CurveSegment`: one smooth piece of a path: a line, a cubic or rational Bézier curve, or an elliptical arc.
use super::bezier::lerp;
use super::nurbs::RationalBezier;
use super::{AffineMap, Arc, Bezier};

/// One smooth piece of a [`Curve`](super::Curve), over a parameter from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveSegment<const D: usize> {
    /// A straight line from the first point to the second.
    Line([[f64; D]; 2]),
    /// A cubic Bézier curve.
    Cubic(Bezier<D>),
    /// An arc of an ellipse.
    Arc(Arc<D>),
    /// A rational Bézier curve of any degree.
    Rational(RationalBezier<D>),
}

impl<const D: usize> CurveSegment<D> {
    /// The quadratic Bézier curve with three control points, as an equal cubic.
    ///
    /// The inner control points are rounded: the curve moves by less than two units in the last place of the
    /// largest coordinate.
    ///
    /// ```
    /// use chordal::explicit::CurveSegment;
    /// let arch = CurveSegment::quadratic([[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]]);
    /// assert_eq!(arch.at(0.5), [1.0, 1.0]);
    /// ```
    #[must_use]
    pub fn quadratic([a, b, c]: [[f64; D]; 3]) -> Self {
        let third = |end: [f64; D]| std::array::from_fn(|k| (end[k] + 2.0 * b[k]) / 3.0);
        Self::Cubic(Bezier { control: [a, third(a), third(c), c] })
    }

    /// The start point.
    #[must_use]
    pub fn start(&self) -> [f64; D] {
        match self {
            Self::Line([a, _]) => *a,
            Self::Cubic(cubic) => cubic.control[0],
            Self::Arc(arc) => arc.ends()[0],
            Self::Rational(curve) => curve.ends()[0],
        }
    }

    /// The end point.
    #[must_use]
    pub fn end(&self) -> [f64; D] {
        match self {
            Self::Line([_, b]) => *b,
            Self::Cubic(cubic) => cubic.control[3],
            Self::Arc(arc) => arc.ends()[1],
            Self::Rational(curve) => curve.ends()[1],
        }
    }

    /// The point at `t`; exactly [`CurveSegment::start`] at 0 and [`CurveSegment::end`] at 1.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; D] {
        match self {
            Self::Line([a, b]) => lerp(*a, *b, t),
            Self::Cubic(cubic) => cubic.at(t),
            Self::Arc(arc) => arc.at(t),
            Self::Rational(curve) => curve.at(t),
        }
    }

    /// The first derivative at `t`.
    #[must_use]
    pub fn tangent(&self, t: f64) -> [f64; D] {
        match self {
            Self::Line([a, b]) => std::array::from_fn(|k| b[k] - a[k]),
            Self::Cubic(cubic) => cubic.tangent(t),
            Self::Arc(arc) => arc.tangent(t),
            Self::Rational(curve) => curve.derivatives(t)[0],
        }
    }

    /// The second derivative at `t`.
    #[must_use]
    pub fn second_derivative(&self, t: f64) -> [f64; D] {
        match self {
            Self::Line(_) => [0.0; D],
            Self::Cubic(cubic) => cubic.second_derivative(t),
            Self::Arc(arc) => arc.second_derivative(t),
            Self::Rational(curve) => curve.derivatives(t)[1],
        }
    }

    /// The same piece in reverse.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match self {
            Self::Line([a, b]) => Self::Line([*b, *a]),
            Self::Cubic(cubic) => Self::Cubic(cubic.reversed()),
            Self::Arc(arc) => Self::Arc(arc.reversed()),
            Self::Rational(curve) => Self::Rational(curve.reversed()),
        }
    }

    /// The lowest and highest coordinates of a box that contains the piece.
    #[must_use]
    pub fn bounds(&self) -> [[f64; D]; 2] {
        match self {
            Self::Line([a, b]) => Bezier { control: [*a, *a, *b, *b] }.bounds(),
            Self::Cubic(cubic) => cubic.bounds(),
            Self::Arc(arc) => arc.bounds(),
            Self::Rational(curve) => curve.bounds(),
        }
    }

    /// Whether all its numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Line(points) => points.as_flattened().iter().all(|x| x.is_finite()),
            Self::Cubic(cubic) => cubic.control.as_flattened().iter().all(|x| x.is_finite()),
            Self::Arc(arc) => arc.is_finite(),
            Self::Rational(curve) => curve.is_finite(),
        }
    }

    /// The piece under `x ↦ columns·x + offset`.
    #[must_use]
    pub fn transformed(&self, map: &AffineMap<D>) -> Self {
        match self {
            Self::Line(points) => Self::Line(points.map(|p| map.point(p))),
            Self::Cubic(cubic) => Self::Cubic(Bezier { control: cubic.control.map(|p| map.point(p)) }),
            Self::Arc(arc) => Self::Arc(arc.transformed(map)),
            Self::Rational(curve) => Self::Rational(curve.transformed(map)),
        }
    }
}
