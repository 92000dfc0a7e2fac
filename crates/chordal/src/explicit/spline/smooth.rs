//! C2 splines through points: natural, clamped and periodic, with even or uneven knots.
//!
//! With knot intervals `h` and slopes `d` of the chords, second derivatives agree at a point between two
//! pieces if the tangents `m` solve `2λ·mᵢ₋₁ + 4·mᵢ + 2μ·mᵢ₊₁ = 6·(λ·dᵢ₋₁ + μ·dᵢ)` with `λ = hᵢ/(hᵢ₋₁ + hᵢ)`
//! and `μ = 1 − λ`. The matrix is diagonally dominant for any knots, so elimination is stable without
//! pivoting (L. H. Thomas, 1949). The corners of a periodic matrix are a change of rank one (J. Sherman, W.
//! J. Morrison, 1950).
use super::{InvalidSpline, Knots, at_least, from_ends, widths};
use crate::explicit::{Curve, CurveEnds, CurveSegment};

/// The end conditions of a C2 spline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SplineEnds<const D: usize> {
    /// No bending at the ends: second derivatives of 0.
    #[default]
    Natural,
    /// These first derivatives at the ends, by the knots: with uniform knots those of the first and the last
    /// piece.
    Clamped([[f64; D]; 2]),
    /// Closed: it continues to its first point, and is C2 there too.
    Periodic,
}

/// The smoothest path through `points`: C2, with second derivatives of zero at its two ends.
///
/// Among all paths through the points at integer parameters it has the smallest integral of the squared
/// second derivative. It solves one tridiagonal system in linear time.
///
/// # Errors
/// When there are fewer than two points, or numbers that are not finite.
///
/// ```
/// use chordal::explicit::spline;
/// let path = spline::natural(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]])?;
/// assert_eq!(path.at(1.0), [1.0, 1.0]);
/// assert_eq!(path.at(0.5)[1], 0.6875);
/// # Ok::<(), chordal::explicit::spline::InvalidSpline>(())
/// ```
pub fn natural<const D: usize>(points: &[[f64; D]]) -> Result<Curve<D>, InvalidSpline> {
    interpolating(points, Knots::Uniform, SplineEnds::Natural)
}

/// The C2 path through `points` at integer parameters that starts and ends with these first derivatives.
///
/// # Errors
/// When there are fewer than two points, or numbers that are not finite.
///
/// ```
/// use chordal::explicit::spline;
/// let path = spline::clamped(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]], [[1.0, 0.0], [1.0, 0.0]])?;
/// let pieces = path.segments();
/// assert_eq!(pieces[0].tangent(0.0), [1.0, 0.0]);
/// assert!((pieces[1].tangent(1.0)[0] - 1.0).abs() < 1e-15);
/// # Ok::<(), chordal::explicit::spline::InvalidSpline>(())
/// ```
pub fn clamped<const D: usize>(
    points: &[[f64; D]],
    tangents: [[f64; D]; 2],
) -> Result<Curve<D>, InvalidSpline> {
    interpolating(points, Knots::Uniform, SplineEnds::Clamped(tangents))
}

/// The closed C2 path through `points` at integer parameters, from the last one back to the first.
///
/// # Errors
/// When there are fewer than three points, or numbers that are not finite.
///
/// ```
/// use chordal::explicit::spline;
/// let square = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
/// let round = spline::periodic(&square)?;
/// assert!(round.is_closed() && round.at(1.0) == [0.0, 1.0]);
/// let [x, y] = round.at(0.5);
/// assert!((x - 0.6875).abs() < 1e-15 && (y - x).abs() < 1e-15);
/// # Ok::<(), chordal::explicit::spline::InvalidSpline>(())
/// ```
pub fn periodic<const D: usize>(points: &[[f64; D]]) -> Result<Curve<D>, InvalidSpline> {
    interpolating(points, Knots::Uniform, SplineEnds::Periodic)
}

/// The C2 path through `points` with these knots and ends. Piece `i` starts at point `i`; it is C2 with
/// respect to the knot intervals, which are those of [`widths`], and always G2 where its speed is not 0.
///
/// It solves one tridiagonal system in linear time.
///
/// # Errors
/// When there are fewer than two points (three for a periodic one), equal points in a row with centripetal or
/// chordal knots, or numbers that are not finite.
///
/// ```
/// use chordal::{check, explicit::spline::{self, Knots, SplineEnds}};
/// let points = [[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [0.0, 4.0]];
/// let path = spline::interpolating(&points, Knots::Chordal, SplineEnds::Periodic)?;
/// assert!(check::curves::joins(&path).iter().all(|join| join.geometric == Some(2)));
/// # Ok::<(), chordal::explicit::spline::InvalidSpline>(())
/// ```
pub fn interpolating<const D: usize>(
    points: &[[f64; D]],
    knots: Knots,
    ends: SplineEnds<D>,
) -> Result<Curve<D>, InvalidSpline> {
    let is_periodic = ends == SplineEnds::Periodic;
    at_least(points, if is_periodic { 3 } else { 2 })?;
    let n = points.len();
    let n_pieces = if is_periodic { n } else { n - 1 };
    let widths = widths(points, knots, n_pieces)?;
    let system = TangentSystem { points, widths: &widths };
    let tangents = match ends {
        SplineEnds::Periodic => system.periodic(),
        SplineEnds::Natural => system.open(None),
        SplineEnds::Clamped(tangents) => system.open(Some(tangents)),
    };
    let piece = |i: usize| {
        let j = (i + 1) % n;
        // Tangents are per unit of the knots, those of a piece per unit of its own parameter.
        let along = |m: [f64; D]| m.map(|x| x * widths[i]);
        CurveSegment::Cubic(from_ends([points[i], points[j]], [along(tangents[i]), along(tangents[j])]))
    };
    Ok(Curve::new((0..n_pieces).map(piece).collect(), CurveEnds::from(is_periodic))?)
}

/// The equations for the tangents.
struct TangentSystem<'a, const D: usize> {
    points: &'a [[f64; D]],
    widths: &'a [f64],
}

/// Three neighbouring factors of a row, and its right side.
struct TangentRow<const D: usize>([f64; 3], [f64; D]);

impl<const D: usize> TangentSystem<'_, D> {
    fn slope(&self, i: usize) -> [f64; D] {
        let (a, b) = (self.points[i], self.points[(i + 1) % self.points.len()]);
        std::array::from_fn(|k| (b[k] - a[k]) / self.widths[i])
    }

    /// The row of a point between two pieces.
    fn inner(&self, i: usize) -> TangentRow<D> {
        let n = self.points.len();
        let before = (i + n - 1) % n;
        let [h0, h1] = [self.widths[before], self.widths[i]];
        if h0 == h1 {
            // The point itself cancels.
            let (a, c) = (self.points[before], self.points[(i + 1) % n]);
            return TangentRow([1.0, 4.0, 1.0], std::array::from_fn(|k| 3.0 * (c[k] - a[k]) / h0));
        }
        let [of_before, of_next] = [h1 / (h0 + h1), h0 / (h0 + h1)];
        let (d0, d1) = (self.slope(before), self.slope(i));
        let right = std::array::from_fn(|k| 6.0 * (of_before * d0[k] + of_next * d1[k]));
        TangentRow([2.0 * of_before, 4.0, 2.0 * of_next], right)
    }

    /// The tangents of an open path, with the given ones at its ends, if any.
    fn open(&self, ends: Option<[[f64; D]; 2]>) -> Vec<[f64; D]> {
        let n = self.points.len();
        let end = |side: usize| {
            let slope = self.slope(if side == 0 { 0 } else { n - 2 });
            // Without tangents the second derivative is 0 at the ends: 2·m₀ + m₁ = 3·d₀, and alike
            // at the last point.
            match ends {
                Some(tangents) => TangentRow([0.0, 1.0, 0.0], tangents[side]),
                None if side == 0 => TangentRow([0.0, 2.0, 1.0], slope.map(|x| 3.0 * x)),
                None => TangentRow([1.0, 2.0, 0.0], slope.map(|x| 3.0 * x)),
            }
        };
        let row = |i: usize| match i {
            0 => end(0),
            i if i == n - 1 => end(1),
            i => self.inner(i),
        };
        solved(&(0..n).map(row).collect::<Vec<_>>())
    }

    /// The tangents of a closed path.
    fn periodic(&self) -> Vec<[f64; D]> {
        let n = self.points.len();
        let mut rows: Vec<TangentRow<D>> = (0..n).map(|i| self.inner(i)).collect();
        // The corners are a row times a column: (γ, 0 …, c)ᵀ·(1, 0 …, a/γ) with γ = −b.
        let (a, c) = (rows[0].0[0], rows[n - 1].0[2]);
        let gamma = -rows[0].0[1];
        rows[0].0[1] -= gamma;
        rows[n - 1].0[1] -= a * c / gamma;
        let column: Vec<TangentRow<1>> = rows
            .iter()
            .enumerate()
            .map(|(i, row)| {
                TangentRow(
                    row.0,
                    [if i == 0 {
                        gamma
                    } else if i == n - 1 {
                        c
                    } else {
                        0.0
                    }],
                )
            })
            .collect();
        let (mut tangents, column) = (solved(&rows), solved(&column));
        // With v = (1, 0 …, a/γ), the solution is x − (v·x) / (1 + v·z)·z.
        let below = 1.0 + column[0][0] + a / gamma * column[n - 1][0];
        let share: [f64; D] =
            std::array::from_fn(|k| (tangents[0][k] + a / gamma * tangents[n - 1][k]) / below);
        for (tangent, [z]) in tangents.iter_mut().zip(&column) {
            (0..D).for_each(|k| tangent[k] -= share[k] * z);
        }
        tangents
    }
}

/// Forward elimination, then back substitution; outer factors of the first and the last row count as 0.
fn solved<const N: usize>(rows: &[TangentRow<N>]) -> Vec<[f64; N]> {
    let mut upper: Vec<f64> = Vec::with_capacity(rows.len());
    let mut solution: Vec<[f64; N]> = Vec::with_capacity(rows.len());
    for TangentRow([before, diagonal, next], right) in rows {
        let (pivot, row): (f64, [f64; N]) = match (upper.last(), solution.last()) {
            (Some(share), Some(last)) => {
                (diagonal - before * share, std::array::from_fn(|k| right[k] - before * last[k]))
            }
            _ => (*diagonal, *right),
        };
        upper.push(next / pivot);
        solution.push(row.map(|x| x / pivot));
    }
    for i in (0..solution.len() - 1).rev() {
        let next = solution[i + 1];
        (0..N).for_each(|k| solution[i][k] -= upper[i] * next[k]);
    }
    solution
}
