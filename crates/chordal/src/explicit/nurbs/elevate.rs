//! Degree elevation: the same curve as a spline of a higher degree.
//!
//! The blossom of degree `q = p + 1` at `q` arguments is the mean of the blossom of degree `p` over all
//! choices of `p` of them. A control point of the raised spline takes `q` neighbouring knots, of which
//! exactly one has an index that is `c` modulo `q`, for each `c`. Leave out that one: for fixed `c`, these
//! choices are the control points of the curve itself with finer knots, namely those of the raised spline
//! without every `q`th. The raised control points are means of `q` such refinements (H. Prautzsch's
//! algorithm), and all intermediate steps are weighted means, without differences or extrapolation.
//!
//! *Rounding.* The refinements round like [`NurbsCurve::with_knot`], by `16ε` of the largest coordinate, for
//! each of up to `p + 1` knots that affect a point, and the mean adds less than `q` more.
//!
//! Source: H. Prautzsch, *Degree elevation of B-spline curves*, 1984; H. Prautzsch, B. Piper, 1991.
use super::NurbsCurve;
use super::cut::clamped_rows;
use super::insert::SplineRows;
use super::knots::InvalidNurbs;

impl<const D: usize> NurbsCurve<D> {
    /// The same curve, its degree raised by `by`: the multiplicity of each knot grows by `by`, so that as
    /// many derivatives stay continuous. A curve that does not start and end at control points is clamped
    /// first ([`NurbsCurve::clamped`]).
    ///
    /// Rounding moves the curve by less than `20(p + 2)·ε` times the largest coordinate for each raise, from
    /// degree `p`.
    /// Cost: for each raise, `p + 1` copies of the curve with each of its knots inserted about once.
    ///
    /// # Errors
    /// When the degree would exceed 30.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let line = NurbsCurve::bezier(vec![[0.0, 0.0], [3.0, 6.0]])?;
    /// let cubic = line.elevated(2)?;
    /// assert_eq!(cubic.control(), [[0.0, 0.0], [1.0, 2.0], [2.0, 4.0], [3.0, 6.0]]);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn elevated(&self, by: usize) -> Result<Self, InvalidNurbs> {
        // Refuse the degree before the work, even if the sum overflows.
        let p = self.knots().degree().saturating_add(by);
        super::KnotVector::clamped(p, p.saturating_add(1).min(64))?;
        if by == 0 {
            return Ok(self.clone());
        }
        let mut rows = clamped_rows(self);
        for _ in 0..by {
            rows = raised(&rows);
        }
        let (last, is_clamped) = (rows.points.len() - 1, self.knots().clamped_ends());
        // Multiplying by weights and dividing again would move them.
        rows.curve(|i| match i {
            0 if is_clamped[0] => self.control().first().copied(),
            i if i == last && is_clamped[1] => self.control().last().copied(),
            _ => None,
        })
    }
}

/// The rows with a degree raised by one; they must be clamped by `p + 1` knots.
fn raised<const D: usize>(rows: &SplineRows<D>) -> SplineRows<D> {
    let q = rows.degree + 1;
    let mut knots = Vec::new();
    // Each knot once more: the smoothness there stays what it was.
    for same in rows.knots.chunk_by(|a, b| a == b) {
        knots.extend(same);
        knots.push(same[0]);
    }
    let n = knots.len() - q - 1;
    let mut points = vec![[0.0; D]; n];
    let mut weights = rows.weights.as_ref().map(|_| vec![[0.0]; n]);
    for c in 0..q {
        let finer = without_each(rows, &knots, c);
        // The first knot of control point i that is not dropped, as an index among the kept knots.
        let row = |i: usize| {
            let first = if (i + 1) % q == c { i + 2 } else { i + 1 };
            let dropped = if c == 0 { first / q } else { (first + q - c) / q };
            first - dropped - 1
        };
        for i in 0..n {
            add(&mut points[i], finer.points[row(i)]);
            if let (Some(sums), Some(finer_weights)) = (&mut weights, &finer.weights) {
                add(&mut sums[i], finer_weights[row(i)]);
            }
        }
    }
    let mean = |sum: &mut [f64]| sum.iter_mut().for_each(|x| *x /= q as f64);
    mean(points.as_flattened_mut());
    if let Some(weights) = &mut weights {
        mean(weights.as_flattened_mut());
    }
    rows.with(q, knots, points, weights)
}

fn add<const N: usize>(sum: &mut [f64; N], x: [f64; N]) {
    (0..N).for_each(|k| sum[k] += x[k]);
}

/// The rows with the knots of the raised spline except its first and last and those with index `c` modulo
/// `q`.
fn without_each<const D: usize>(rows: &SplineRows<D>, knots: &[f64], c: usize) -> SplineRows<D> {
    let q = rows.degree + 1;
    let mut finer = rows.clone();
    let inner = 1..knots.len() - 1;
    let [from, to] = [knots[0], knots[knots.len() - 1]];
    let kept: Vec<f64> =
        inner.filter(|k| k % q != c).map(|k| knots[k]).filter(|t| *t > from && *t < to).collect();
    for same in kept.chunk_by(|a, b| a == b) {
        let present = rows.knots.iter().filter(|knot| **knot == same[0]).count();
        for _ in present..same.len() {
            finer.insert(same[0]);
        }
    }
    finer
}
