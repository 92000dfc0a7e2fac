//! Splines: chains of cubic pieces through or near points, as paths of Bézier pieces.
//!
//! | spline | interpolates | continuity | moving one point changes |
//! |---|---|---|---|
//! | [`hermite`] | yes, with given tangents | C1 | 2 pieces |
//! | [`catmull_rom`] | yes | C1 | 4 pieces |
//! | [`natural`], [`clamped`], [`periodic`], all of them [`interpolating`] | yes | C2 | all pieces, farther ones less |
//! | [`b_spline`] | no | C2 | 4 pieces |
//!
//! Each is a special case of [`NurbsCurve`](super::nurbs::NurbsCurve), which has any degree, knots and
//! weights: [`NurbsCurve::from_path`](super::nurbs::NurbsCurve::from_path) converts a path,
//! [`NurbsCurve::through`](super::nurbs::NurbsCurve::through) interpolates with any degree.
//!
//! In an interpolating spline piece `i` starts at point `i`. No cubic spline is C2, local and interpolating
//! at once: each of these lacks one of the three.
//!
//! Sources: G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, ch. 8–9; E. Catmull, R. Rom, *A class of
//! local interpolating splines*, 1974; C. Yuksel, S. Schaefer, J. Keyser, *Parameterization and applications
//! of Catmull–Rom curves*, 2011 (centripetal: no cusps and no loops within a piece).
use super::{Bezier, Curve, CurveEnds, CurveSegment, InvalidCurve};
use crate::math::{exponent, greater, power_of_two};
use std::fmt;

mod smooth;

pub use smooth::{SplineEnds, clamped, interpolating, natural, periodic};

/// The choice of the knots, which are the parameters of the points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Knots {
    /// Whole numbers.
    #[default]
    Uniform,
    /// Knot intervals are the square roots of the distances of the points.
    Centripetal,
    /// Knot intervals are the distances of the points: the speed is about 1, and the effect of a moved point
    /// follows distance.
    Chordal,
}

/// The reason why there is no spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InvalidSpline {
    /// There are fewer points than this.
    TooFew(usize),
    /// The numbers of points and tangents differ.
    Tangents,
    /// This point and the next are equal, and so would be their centripetal or chordal knots.
    Repeated(usize),
    /// A number is not finite, or an intermediate one overflows.
    NotFinite,
}

impl fmt::Display for InvalidSpline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew(n) => write!(f, "the spline needs at least {n} points"),
            Self::Tangents => f.write_str("the spline needs one tangent for each point"),
            Self::Repeated(i) => {
                write!(
                    f,
                    "point {i} and the next one are equal, and so would be their knots, which depend on distances"
                )
            }
            Self::NotFinite => f.write_str("the spline has a number that is not finite"),
        }
    }
}

impl std::error::Error for InvalidSpline {}

impl From<InvalidCurve> for InvalidSpline {
    fn from(_: InvalidCurve) -> Self {
        Self::NotFinite
    }
}

/// The path through `points` with these first derivatives (per piece) at the points.
///
/// # Errors
/// When there are fewer than two points, the numbers of points and tangents differ, or a number is not
/// finite.
///
/// ```
/// use chordal::explicit::spline;
/// let arch = spline::hermite(&[[0.0, 0.0], [1.0, 0.0]], &[[0.0, 3.0], [0.0, -3.0]])?;
/// assert_eq!(arch.at(0.5), [0.5, 0.75]);
/// # Ok::<(), chordal::explicit::spline::InvalidSpline>(())
/// ```
pub fn hermite<const D: usize>(
    points: &[[f64; D]],
    tangents: &[[f64; D]],
) -> Result<Curve<D>, InvalidSpline> {
    at_least(points, 2)?;
    if points.len() != tangents.len() {
        return Err(InvalidSpline::Tangents);
    }
    let ends = points.windows(2).zip(tangents.windows(2));
    path(ends.map(|(p, m)| from_ends([p[0], p[1]], [m[0], m[1]])), CurveEnds::Open)
}

/// The path through `points` whose tangent at each point is a mean of the slopes of the two chords there.
///
/// With uniform knots it is parallel to the line from the previous point to the next. At its ends an open
/// path takes the slopes of its first and its last chord.
///
/// # Errors
/// When there are fewer than two points (three for a closed path), equal points in a row with
/// centripetal or chordal knots, or numbers that are not finite.
///
/// ```
/// use chordal::explicit::{CurveEnds, spline::{self, Knots}};
/// let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
/// let round = spline::catmull_rom(&square, Knots::Uniform, CurveEnds::Closed)?;
/// assert_eq!((round.at(1.0), round.at(0.5)), ([1.0, 0.0], [0.5, -0.125]));
/// # Ok::<(), chordal::explicit::spline::InvalidSpline>(())
/// ```
pub fn catmull_rom<const D: usize>(
    points: &[[f64; D]],
    knots: Knots,
    ends: CurveEnds,
) -> Result<Curve<D>, InvalidSpline> {
    let closed = ends == CurveEnds::Closed;
    at_least(points, if closed { 3 } else { 2 })?;
    let n = points.len();
    let n_pieces = if closed { n } else { n - 1 };
    let widths = widths(points, knots, n_pieces)?;
    let slope = |i: usize| -> [f64; D] {
        let (a, b) = (points[i], points[(i + 1) % n]);
        std::array::from_fn(|k| (b[k] - a[k]) / widths[i])
    };
    // The derivative at a point, with respect to the knots.
    let tangent = |i: usize| -> [f64; D] {
        if !closed && i == 0 {
            return slope(0);
        }
        if !closed && i == n - 1 {
            return slope(n - 2);
        }
        let before = (i + n_pieces - 1) % n_pieces;
        let (d0, d1) = (widths[before], widths[i]);
        let (s0, s1) = (slope(before), slope(i));
        // The derivative of the parabola through the three points.
        std::array::from_fn(|k| (d1 * s0[k] + d0 * s1[k]) / (d0 + d1))
    };
    let pieces = (0..n_pieces).map(|i| {
        let j = (i + 1) % n;
        let along = |m: [f64; D]| m.map(|x| x * widths[i]);
        from_ends([points[i], points[j]], [along(tangent(i)), along(tangent(j))])
    });
    path(pieces, ends)
}

/// The knot intervals of [`catmull_rom`], in which the path is C1, and of [`interpolating`], in which it is
/// C2.
///
/// # Errors
/// When two points in a row are equal and the knots are centripetal or chordal.
pub fn widths<const D: usize>(
    points: &[[f64; D]],
    knots: Knots,
    n_pieces: usize,
) -> Result<Vec<f64>, InvalidSpline> {
    let width = |i: usize| {
        let (a, b) = (points[i], points[(i + 1) % points.len()]);
        let width = match knots {
            Knots::Uniform => 1.0,
            Knots::Centripetal => distance(a, b).sqrt(),
            Knots::Chordal => distance(a, b),
        };
        // A NaN or infinite width is passed on: the path is refused for it later.
        if width == 0.0 { Err(InvalidSpline::Repeated(i)) } else { Ok(width) }
    };
    (0..n_pieces).map(width).collect()
}

/// The distance of two points; 0 only where they are equal.
fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let root = |scale: f64| {
        let square = (0..D).fold(0.0, |sum, k| sum + (scale * (b[k] - a[k])) * (scale * (b[k] - a[k])));
        square.sqrt() / scale
    };
    let largest = (0..D).fold(0.0, |largest: f64, k| greater((b[k] - a[k]).abs(), largest));
    // Squares of common lengths neither vanish nor overflow: 2^±400, chosen far from both limits.
    let is_common = exponent(largest).abs() < 400;
    if largest == 0.0 || is_common { root(1.0) } else { root(power_of_two(-exponent(largest))) }
}

/// The uniform cubic B-spline with these control points: C2, near them but not through them, inside their
/// convex hull.
///
/// Piece `i` depends only on the control points `i` to `i + 3`. So a moved point changes four pieces and
/// leaves the others identical to the bit.
///
/// # Errors
/// When there are fewer than four points (three for a closed path), or numbers that are not finite.
///
/// ```
/// use chordal::explicit::{CurveEnds, spline};
/// let path = spline::b_spline(&[[0.0, 0.0], [6.0, 0.0], [6.0, 6.0], [0.0, 6.0]], CurveEnds::Open)?;
/// assert_eq!(path.segments().len(), 1);
/// assert_eq!((path.start(), path.end()), ([5.0, 1.0], [5.0, 5.0]));
/// # Ok::<(), chordal::explicit::spline::InvalidSpline>(())
/// ```
pub fn b_spline<const D: usize>(control: &[[f64; D]], ends: CurveEnds) -> Result<Curve<D>, InvalidSpline> {
    let closed = ends == CurveEnds::Closed;
    at_least(control, if closed { 3 } else { 4 })?;
    let n = control.len();
    let n_pieces = if closed { n } else { n - 3 };
    let at = |i: usize| control[i % n];
    let knot = |i: usize| -> [f64; D] {
        let [a, b, c] = [at(i), at(i + 1), at(i + 2)];
        std::array::from_fn(|k| ((a[k] + c[k]) + 4.0 * b[k]) / 6.0)
    };
    let third = |near: [f64; D], far: [f64; D]| std::array::from_fn(|k| (2.0 * near[k] + far[k]) / 3.0);
    let piece = |i: usize| Bezier {
        control: [knot(i % n), third(at(i + 1), at(i + 2)), third(at(i + 2), at(i + 1)), knot((i + 1) % n)],
    };
    path((0..n_pieces).map(piece), ends)
}

fn from_ends<const D: usize>([a, b]: [[f64; D]; 2], [m, o]: [[f64; D]; 2]) -> Bezier<D> {
    let start = std::array::from_fn(|k| a[k] + m[k] / 3.0);
    let end = std::array::from_fn(|k| b[k] - o[k] / 3.0);
    Bezier { control: [a, start, end, b] }
}

fn at_least<const D: usize>(points: &[[f64; D]], n: usize) -> Result<(), InvalidSpline> {
    if points.len() < n { Err(InvalidSpline::TooFew(n)) } else { Ok(()) }
}

fn path<const D: usize>(
    pieces: impl Iterator<Item = Bezier<D>>,
    ends: CurveEnds,
) -> Result<Curve<D>, InvalidSpline> {
    Ok(Curve::new(pieces.map(CurveSegment::Cubic).collect(), ends)?)
}
