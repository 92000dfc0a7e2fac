//! Splines of any degree through points.
//!
//! The knots are averages of `p` neighbouring parameters, so that every parameter lies in the support of its
//! own control point (the condition of Schoenberg and Whitney) and the banded system has one solution. Its
//! matrix is totally positive: elimination without exchanging rows loses no digits (C. de Boor, A. Pinkus,
//! 1977).
//!
//! Source: C. de Boor, *A Practical Guide to Splines*, 1978, ch. XIII; L. Piegl, W. Tiller, *The NURBS Book*,
//! 2nd ed., 1997, 9.2.1.
use super::NurbsCurve;
use super::knots::{InvalidNurbs, KnotVector};
use crate::explicit::spline::{InvalidSpline, Knots, widths};

impl<const D: usize> NurbsCurve<D> {
    /// The spline of a degree through points, with `p − 1` continuous derivatives. The parameter of a point
    /// is the sum of the knot intervals before it, of length 1 or given by the distances of the points
    /// ([`Knots`]).
    ///
    /// It starts at the first and ends at the last point exactly, and misses the others by rounding, a few
    /// units in the last place of the largest control coordinate. High degrees and uneven parameters
    /// oscillate between points, as polynomials do.
    /// Cost: `n·p²` operations for `n` points.
    ///
    /// # Errors
    /// When there are not more points than the degree, a number is not finite, two successive points are
    /// equal and the knots depend on distances, or distances are so uneven that rounding leaves no solution.
    ///
    /// ```
    /// use chordal::explicit::{nurbs::NurbsCurve, spline::Knots};
    /// let points = [[0.0, 0.0], [1.0, 2.0], [3.0, 1.0], [4.0, 4.0], [6.0, 3.0]];
    /// let curve = NurbsCurve::through(&points, 4, Knots::Uniform)?;
    /// let [x, y] = curve.at(2.0);
    /// assert!((x - 3.0).abs() < 1e-14 && (y - 1.0).abs() < 1e-14);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn through(points: &[[f64; D]], degree: usize, knots: Knots) -> Result<Self, InvalidNurbs> {
        // Refuses unsuitable degrees and counts.
        KnotVector::clamped(degree, points.len())?;
        if let Some(index) = points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(InvalidNurbs::NotFinite { what: "point", index });
        }
        let parameters = parameters(points, knots)?;
        let n = points.len();
        let knots = averaged_knots(&parameters, degree)?;
        let control = solved(&knots, &parameters, points)?;
        Self::new(knots, control, vec![1.0; n])
    }
}

/// Clamped knots of a spline with these parameters: each knot inside the domain is the mean of `degree` of
/// them.
pub(super) fn averaged_knots(parameters: &[f64], degree: usize) -> Result<KnotVector, InvalidNurbs> {
    let n = parameters.len();
    let mut knots = vec![parameters[0]; degree + 1];
    // Differences from the first keep the mean between the smallest and the largest.
    let mean = |run: &[f64]| run[0] + run.iter().map(|t| t - run[0]).sum::<f64>() / degree as f64;
    knots.extend((1..n - degree).map(|j| mean(&parameters[j..j + degree])));
    knots.extend(vec![parameters[n - 1]; degree + 1]);
    KnotVector::new(degree, knots)
}

fn parameters<const D: usize>(points: &[[f64; D]], knots: Knots) -> Result<Vec<f64>, InvalidNurbs> {
    let widths = widths(points, knots, points.len() - 1).map_err(|error| match error {
        InvalidSpline::Repeated(index) => InvalidNurbs::Coincident(index),
        _ => InvalidNurbs::NotFinite { what: "knot interval", index: 0 },
    })?;
    let mut parameters = vec![0.0];
    for (index, width) in widths.iter().enumerate() {
        let next = parameters[index] + width;
        // The distance vanishes beside the others.
        if next <= parameters[index] {
            return Err(InvalidNurbs::Coincident(index));
        }
        parameters.push(next);
    }
    Ok(parameters)
}

/// The control points with which the spline passes through each point at its parameter.
pub(super) fn solved<const D: usize>(
    knots: &KnotVector,
    parameters: &[f64],
    points: &[[f64; D]],
) -> Result<Vec<[f64; D]>, InvalidNurbs> {
    let (p, n) = (knots.degree(), points.len());
    // Row i has the columns from i − p to i + p, of which p + 1 consecutive ones are not 0.
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(n);
    let mut right = points.to_vec();
    for (i, t) in parameters.iter().enumerate() {
        let (first, values) = knots.basis(*t);
        let mut row = vec![0.0; 2 * p + 1];
        for (k, value) in values.iter().enumerate() {
            // Entries beyond the band are 0: no parameter leaves the support of its control point.
            if let Some(column) = (first + k + p).checked_sub(i)
                && column <= 2 * p
            {
                row[column] = *value;
            }
        }
        // Only the p rows above reach into this one.
        for j in i.saturating_sub(p)..i {
            let factor = row[j + p - i] / rows[j][p];
            if factor != 0.0 {
                for k in 0..=p {
                    row[j + p - i + k] -= factor * rows[j][p + k];
                }
                right[i] = std::array::from_fn(|c| right[i][c] - factor * right[j][c]);
            }
        }
        // In exact arithmetic the pivot is above 0; otherwise rounding has destroyed it.
        if row[p] <= 0.0 || !row[p].is_finite() {
            return Err(InvalidNurbs::Uneven(i));
        }
        rows.push(row);
    }
    for i in (0..n).rev() {
        for k in 1..=p.min(n - 1 - i) {
            let above = rows[i][p + k];
            right[i] = std::array::from_fn(|c| right[i][c] - above * right[i + k][c]);
        }
        right[i] = right[i].map(|x| x / rows[i][p]);
    }
    // The end control points equal the end points exactly.
    (right[0], right[n - 1]) = (points[0], points[n - 1]);
    Ok(right)
}

impl KnotVector {
    /// The basis functions that are not 0 at a parameter of the domain: the index of the first, and `p + 1`
    /// values, each at least 0, whose sum is 1 up to rounding.
    ///
    /// ```
    /// use chordal::explicit::nurbs::KnotVector;
    /// assert_eq!(KnotVector::clamped(2, 4)?.basis(1.0), (1, vec![0.5, 0.5, 0.0]));
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    #[must_use]
    pub fn basis(&self, t: f64) -> (usize, Vec<f64>) {
        let [from, to] = self.domain();
        let t = if t > from { crate::math::lesser(t, to) } else { from };
        let span = self.span(self.locate(t).0);
        let mut values = vec![1.0];
        for r in 1..=self.degree() {
            let mut next = vec![0.0; r + 1];
            for (j, value) in values.iter().enumerate() {
                let (low, high) = (self.knots()[span + 1 + j - r], self.knots()[span + 1 + j]);
                next[j] += (high - t) / (high - low) * value;
                next[j + 1] += (t - low) / (high - low) * value;
            }
            values = next;
        }
        (span - self.degree(), values)
    }
}
