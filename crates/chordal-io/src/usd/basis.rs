//! Curves of USD's `BasisCurves`: lines, Bézier curves, B-splines and Catmull–Rom splines.
//!
//! Source: Pixar Animation Studios, *UsdGeomBasisCurves*, openusd.org, 2024; E. Catmull and R. Rom, *A class of local
//! interpolating splines*, 1974.
use chordal::explicit::{Bezier, Curve, CurveEnds, CurveSegment, InvalidCurve, spline};

/// How the points of a curve are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UsdBasis {
    Linear,
    Bezier,
    BSpline,
    CatmullRom,
}

/// The behaviour of a curve at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UsdWrap {
    NonPeriodic,
    Periodic,
    Pinned,
}

impl UsdBasis {
    /// The basis named by two words of a file; `None` if one of them is unknown.
    pub(super) fn from_words(kind: &str, basis: &str) -> Option<Self> {
        match (kind, basis) {
            ("linear", _) => Some(Self::Linear),
            ("cubic", "bezier") => Some(Self::Bezier),
            ("cubic", "bspline") => Some(Self::BSpline),
            ("cubic", "catmullRom") => Some(Self::CatmullRom),
            _ => None,
        }
    }
}

impl UsdWrap {
    pub(super) fn from_word(word: &str) -> Option<Self> {
        match word {
            "nonperiodic" => Some(Self::NonPeriodic),
            "periodic" => Some(Self::Periodic),
            "pinned" => Some(Self::Pinned),
            _ => None,
        }
    }
}

/// The number of points that a curve needs, in words; `None` if the number is right.
pub(super) fn misfit(n: usize, basis: UsdBasis, wrap: UsdWrap) -> Option<&'static str> {
    let (is_right, needed) = match (basis, wrap) {
        (UsdBasis::Linear, UsdWrap::Periodic) => (n >= 3, "3 or more"),
        (UsdBasis::Linear, _) => (n >= 2, "2 or more"),
        (UsdBasis::Bezier, UsdWrap::Periodic) => (n >= 3 && n.is_multiple_of(3), "a multiple of 3"),
        (UsdBasis::Bezier, _) => (n >= 4 && n % 3 == 1, "4 and 3 more for each other piece"),
        (_, UsdWrap::NonPeriodic) => (n >= 4, "4 or more"),
        (_, UsdWrap::Periodic) => (n >= 3, "3 or more"),
        (_, UsdWrap::Pinned) => (n >= 2, "2 or more"),
    };
    if is_right { None } else { Some(needed) }
}

/// The curve of these points, whose number must be right. Its slack bounds the rounding.
///
/// # Errors
/// If a number overflows.
pub(super) fn curve(points: &[[f64; 3]], basis: UsdBasis, wrap: UsdWrap) -> Result<Curve<3>, InvalidCurve> {
    let is_closed = wrap == UsdWrap::Periodic;
    let ends = CurveEnds::from(is_closed);
    let n = points.len();
    let at = |i: usize| points[i % n];
    match basis {
        UsdBasis::Linear => {
            let n_lines = if is_closed { n } else { n - 1 };
            let line = |i: usize| CurveSegment::Line([at(i), at(i + 1)]);
            Curve::new((0..n_lines).map(line).collect(), ends)
        }
        UsdBasis::Bezier => {
            // Three points for each piece: the fourth is the first of the next.
            let n_points = if is_closed { n } else { n - 1 };
            let cubic =
                |i: usize| CurveSegment::Cubic(Bezier { control: [at(i), at(i + 1), at(i + 2), at(i + 3)] });
            Curve::new((0..n_points).step_by(3).map(cubic).collect(), ends)
        }
        UsdBasis::BSpline | UsdBasis::CatmullRom => {
            let points = if wrap == UsdWrap::Pinned { pinned(points) } else { points.to_vec() };
            let path = if basis == UsdBasis::BSpline {
                spline::b_spline(&points, ends).map_err(|_| InvalidCurve::NotFinite { piece: 0 })?
            } else {
                catmull_rom(&points, ends)?
            };
            let reach =
                points.as_flattened().iter().fold(0.0, |most, x| chordal::math::greater(x.abs(), most));
            // Derived: a coordinate of a control point is a mean, or a point and a sixth of a difference, of
            // numbers up to the reach; it takes four roundings of at most twice the reach, and one more if a
            // point was added before the first: 5 ε in each of three coordinates, below 9 ε. Numbers that
            // underflow to 0 are below the least normal number.
            Ok(path.with_slack(9.0 * f64::EPSILON * reach + f64::MIN_POSITIVE))
        }
    }
}

/// The points with one added before the first and one after the last, so that the curve starts and ends at
/// the given ones.
fn pinned(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let beyond = |end: [f64; 3], next: [f64; 3]| std::array::from_fn(|k| 2.0 * end[k] - next[k]);
    let n = points.len();
    let mut extended = vec![beyond(points[0], points[1])];
    extended.extend_from_slice(points);
    extended.push(beyond(points[n - 1], points[n - 2]));
    extended
}

/// The uniform Catmull–Rom spline; an open one starts at the second point and ends at the last but one.
fn catmull_rom(points: &[[f64; 3]], ends: CurveEnds) -> Result<Curve<3>, InvalidCurve> {
    let n = points.len();
    let n_pieces = if ends == CurveEnds::Closed { n } else { n - 3 };
    let piece = |i: usize| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| points[(i + k) % n]);
        let start = std::array::from_fn(|k| b[k] + (c[k] - a[k]) / 6.0);
        let end = std::array::from_fn(|k| c[k] - (d[k] - b[k]) / 6.0);
        CurveSegment::Cubic(Bezier { control: [b, start, end, c] })
    };
    Curve::new((0..n_pieces).map(piece).collect(), ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polygon around the origin that is not planar.
    fn points(n: usize) -> Vec<[f64; 3]> {
        (0..n).map(|i| [(i * i % 7) as f64, (i * 3 % 5) as f64, i as f64 / 4.0]).collect()
    }

    /// The value of a piece by the matrix of the basis, as in the schema.
    fn by_matrix(p: [[f64; 3]; 4], basis: UsdBasis, t: f64) -> [f64; 3] {
        let weights = match basis {
            UsdBasis::BSpline => [
                (1.0 - t).powi(3) / 6.0,
                (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                (-3.0 * t * t * t + 3.0 * t * t + 3.0 * t + 1.0) / 6.0,
                t * t * t / 6.0,
            ],
            _ => [
                (-t * t * t + 2.0 * t * t - t) / 2.0,
                (3.0 * t * t * t - 5.0 * t * t + 2.0) / 2.0,
                (-3.0 * t * t * t + 4.0 * t * t + t) / 2.0,
                (t * t * t - t * t) / 2.0,
            ],
        };
        std::array::from_fn(|k| (0..4).map(|i| weights[i] * p[i][k]).sum())
    }

    #[test]
    fn splines_are_those_of_their_matrix_at_every_wrap() {
        for basis in [UsdBasis::BSpline, UsdBasis::CatmullRom] {
            for (wrap, n_pieces) in [(UsdWrap::NonPeriodic, 4), (UsdWrap::Periodic, 7), (UsdWrap::Pinned, 6)]
            {
                let points = points(7);
                let path = curve(&points, basis, wrap).unwrap();
                assert_eq!((path.segments().len(), path.is_closed()), (n_pieces, wrap == UsdWrap::Periodic));
                let all = if wrap == UsdWrap::Pinned { pinned(&points) } else { points.clone() };
                for step in 0..=8 * n_pieces {
                    let s = step as f64 / 8.0;
                    let piece = (s as usize).min(n_pieces - 1);
                    let four = [0, 1, 2, 3].map(|k| all[(piece + k) % all.len()]);
                    let (found, truth) = (path.at(s), by_matrix(four, basis, s - piece as f64));
                    assert!((0..3).all(|k| (found[k] - truth[k]).abs() < 1e-14), "{basis:?} {wrap:?} {s}");
                }
                if wrap == UsdWrap::Pinned {
                    let off =
                        |a: [f64; 3], b: [f64; 3]| (0..3).fold(0.0, |sum: f64, k| sum + (a[k] - b[k]).abs());
                    assert!(
                        off(path.start(), points[0]) <= path.slack()
                            && off(path.end(), points[6]) <= path.slack()
                    );
                }
            }
        }
    }

    #[test]
    fn lines_and_bezier_curves_are_exact() {
        let open = curve(&points(7), UsdBasis::Bezier, UsdWrap::Pinned).unwrap();
        assert_eq!((open.segments().len(), open.end(), open.slack()), (2, points(7)[6], 0.0));
        let closed = curve(&points(6), UsdBasis::Bezier, UsdWrap::Periodic).unwrap();
        assert_eq!((closed.segments().len(), closed.end(), closed.is_closed()), (2, points(6)[0], true));
        let lines = curve(&points(3), UsdBasis::Linear, UsdWrap::Periodic).unwrap();
        assert_eq!((lines.segments().len(), lines.at(2.0), lines.is_closed()), (3, points(3)[2], true));
        assert_eq!(curve(&points(2), UsdBasis::Linear, UsdWrap::NonPeriodic).unwrap().segments().len(), 1);
    }
}
