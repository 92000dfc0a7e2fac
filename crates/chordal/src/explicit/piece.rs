//! `Piece`: one smooth piece of a path: a line, a cubic Bézier curve, or an arc of an ellipse.
use super::bezier::mix;
use super::{Arc, Bezier};

/// One smooth piece of a [`Curve`](super::Curve), over a parameter from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece<const D: usize> {
    /// From the first point straight to the second.
    Line([[f64; D]; 2]),
    /// A cubic Bézier curve.
    Cubic(Bezier<D>),
    /// An arc of an ellipse.
    Arc(Arc<D>),
}

impl<const D: usize> Piece<D> {
    /// The quadratic Bézier curve with three control points, as the cubic that is the same curve.
    ///
    /// The inner control points are rounded: the curve moves by less than two units in the last place of the largest
    /// coordinate.
    ///
    /// ```
    /// use chordal::explicit::Piece;
    /// let arch = Piece::quadratic([[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]]);
    /// assert_eq!(arch.at(0.5), [1.0, 1.0]);
    /// ```
    #[must_use]
    pub fn quadratic([a, b, c]: [[f64; D]; 3]) -> Self {
        let third = |end: [f64; D]| std::array::from_fn(|k| (end[k] + 2.0 * b[k]) / 3.0);
        Self::Cubic(Bezier { control: [a, third(a), third(c), c] })
    }

    /// Where it starts.
    #[must_use]
    pub fn start(&self) -> [f64; D] {
        match self {
            Self::Line([a, _]) => *a,
            Self::Cubic(cubic) => cubic.control[0],
            Self::Arc(arc) => arc.ends()[0],
        }
    }

    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> [f64; D] {
        match self {
            Self::Line([_, b]) => *b,
            Self::Cubic(cubic) => cubic.control[3],
            Self::Arc(arc) => arc.ends()[1],
        }
    }

    /// The point at `t`; exactly [`Piece::start`] at 0 and [`Piece::end`] at 1.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; D] {
        match self {
            Self::Line([a, b]) => mix(*a, *b, t),
            Self::Cubic(cubic) => cubic.at(t),
            Self::Arc(arc) => arc.at(t),
        }
    }

    /// The first derivative at `t`.
    #[must_use]
    pub fn tangent(&self, t: f64) -> [f64; D] {
        match self {
            Self::Line([a, b]) => std::array::from_fn(|k| b[k] - a[k]),
            Self::Cubic(cubic) => cubic.tangent(t),
            Self::Arc(arc) => arc.tangent(t),
        }
    }

    /// The second derivative at `t`.
    #[must_use]
    pub fn second_derivative(&self, t: f64) -> [f64; D] {
        match self {
            Self::Line(_) => [0.0; D],
            Self::Cubic(cubic) => cubic.second_derivative(t),
            Self::Arc(arc) => arc.second_derivative(t),
        }
    }

    /// The same piece run backwards.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match self {
            Self::Line([a, b]) => Self::Line([*b, *a]),
            Self::Cubic(cubic) => Self::Cubic(cubic.reversed()),
            Self::Arc(arc) => Self::Arc(arc.reversed()),
        }
    }

    /// The lowest and highest coordinates of a box that holds the piece.
    #[must_use]
    pub fn hull(&self) -> [[f64; D]; 2] {
        match self {
            Self::Line([a, b]) => Bezier { control: [*a, *a, *b, *b] }.hull(),
            Self::Cubic(cubic) => cubic.hull(),
            Self::Arc(arc) => arc.hull(),
        }
    }

    /// Whether all its numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Line(points) => points.as_flattened().iter().all(|x| x.is_finite()),
            Self::Cubic(cubic) => cubic.control.as_flattened().iter().all(|x| x.is_finite()),
            Self::Arc(arc) => arc.is_finite(),
        }
    }

    /// The piece under `x ↦ columns·x + offset`.
    #[must_use]
    pub fn transformed(&self, map: &Affine<D>) -> Self {
        match self {
            Self::Line(points) => Self::Line(points.map(|p| map.point(p))),
            Self::Cubic(cubic) => Self::Cubic(Bezier { control: cubic.control.map(|p| map.point(p)) }),
            Self::Arc(arc) => Self::Arc(arc.transformed(map)),
        }
    }
}

/// An affine map of the plane or of space: `x ↦ columns·x + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine<const D: usize> {
    /// Where the axes go.
    pub columns: [[f64; D]; D],
    /// Where the origin goes.
    pub offset: [f64; D],
}

impl<const D: usize> Affine<D> {
    /// The map that changes nothing.
    #[must_use]
    pub fn identity() -> Self {
        let unit = |i: usize, k: usize| if i == k { 1.0 } else { 0.0 };
        Self { columns: std::array::from_fn(|i| std::array::from_fn(|k| unit(i, k))), offset: [0.0; D] }
    }

    /// Where a point goes.
    #[must_use]
    pub fn point(&self, p: [f64; D]) -> [f64; D] {
        let turned = self.vector(p);
        std::array::from_fn(|k| turned[k] + self.offset[k])
    }

    /// Where a difference of points goes.
    #[must_use]
    pub fn vector(&self, v: [f64; D]) -> [f64; D] {
        std::array::from_fn(|k| (0..D).fold(0.0, |sum, i| sum + self.columns[i][k] * v[i]))
    }

    /// The map that does `self` after `first`.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        Self { columns: first.columns.map(|column| self.vector(column)), offset: self.point(first.offset) }
    }

    /// How much a length can grow at most, from above (the Frobenius norm; at most √D times too large).
    #[must_use]
    pub fn stretch(&self) -> f64 {
        let squares = self.columns.as_flattened().iter().fold(0.0, |sum: f64, x| (sum + x * x).next_up());
        squares.sqrt().next_up()
    }
}
