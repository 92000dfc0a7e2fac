//! Removal of knots that the curve hardly needs, with a proved bound on the change.
//!
//! Knot `t` can be removed without loss if the control points around it are those that its insertion creates
//! (`insert.rs`). These are `p − m + 1` equations for `p − m` new points, with `m` the multiplicity. One
//! equation is dropped and the others are solved from both sides; the choice that loses least is taken.
//!
//! *Bound.* The knot is inserted into the new curve again, in intervals, which gives the new curve `C′` by
//! control points `Q` with weights `v` on the knots of the old curve `C` with `P` and `w`. Then
//! `C − C′ = Σ Nᵢ (wᵢ(Pᵢ − Qᵢ) + (wᵢ − vᵢ)(Qᵢ − C′)) / Σ Nᵢ wᵢ`, a weighted mean of
//! `|Pᵢ − Qᵢ| + |wᵢ − vᵢ|/wᵢ·|Qᵢ − C′|`, where `|Qᵢ − C′|` is less than the diagonal of the box of the `Q`.
//! The largest of these bounds the distance of points with the same parameter.
//!
//! Source: W. Tiller, *Knot-removal algorithms for NURBS curves and surfaces*, 1992 (the equations).
use super::NurbsCurve;
use super::insert::SplineRows;
use super::knots::InvalidNurbs;
use crate::budget::Tolerance;
use crate::math::{Interval, add_up, div_up, greater, length_up, lesser, mul_up, sub_down, sub_up};

impl<const D: usize> NurbsCurve<D> {
    /// The curve with one knot fewer at a parameter, and an upper bound of the distance of points with the
    /// same parameter. The bound is proved: it covers all rounding.
    ///
    /// Cost: `p²` operations and `p` copies of the curve.
    ///
    /// # Errors
    /// When there is no such knot inside the domain, or the curve would be farther away than the tolerance:
    /// the bound is in the error.
    ///
    /// ```
    /// use chordal::{Tolerance, explicit::nurbs::NurbsCurve};
    /// let arch = NurbsCurve::bezier(vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])?;
    /// let (again, moved) = arch.with_knot(0.3, 1)?.without_knot(0.3, Tolerance::new(1e-9).unwrap())?;
    /// assert!(again.control().len() == 4 && moved < 1e-14);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn without_knot(&self, t: f64, tolerance: Tolerance) -> Result<(Self, f64), InvalidNurbs> {
        let [from, to] = self.knots().domain();
        if !(from < t && t < to) || self.knots().multiplicity(t) == 0 {
            return Err(InvalidNurbs::NoKnot(t));
        }
        let removal = KnotRemoval::new(self, t);
        let mut best: Option<(Self, f64)> = None;
        for dropped in removal.first..=removal.last {
            // Weights may come out as 0 or less: then this choice gives no curve.
            let Ok(candidate) = removal.solved(dropped) else { continue };
            let moved = removal.distance_up(&candidate);
            if best.as_ref().is_none_or(|(_, smallest)| moved < *smallest) {
                best = Some((candidate, moved));
            }
        }
        match best {
            Some((curve, moved)) if moved <= tolerance.get() => Ok((curve, moved)),
            best => Err(InvalidNurbs::Moved {
                by: best.map_or(f64::INFINITY, |(_, moved)| moved),
                limit: tolerance.get(),
            }),
        }
    }

    /// The curve without the knots that it can spare, removed from its start to its end, and a proved upper
    /// bound, within the tolerance, of the distance of points with the same parameter.
    ///
    /// ```
    /// use chordal::{Tolerance, explicit::nurbs::NurbsCurve};
    /// let arch = NurbsCurve::bezier(vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])?;
    /// let finer = arch.with_knots(&[0.2, 0.5, 0.5, 0.9])?;
    /// let (again, moved) = finer.without_spare_knots(Tolerance::new(1e-9).unwrap());
    /// assert!(again.control().len() == 4 && moved < 1e-13);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    #[must_use]
    pub fn without_spare_knots(&self, tolerance: Tolerance) -> (Self, f64) {
        let [from, to] = self.knots().domain();
        let inner: Vec<f64> = self.knots().knots().iter().copied().filter(|t| from < *t && *t < to).collect();
        let (mut curve, mut moved) = (self.clone(), 0.0);
        // A knot occurs in the list as often as in the curve, and is tried that many times.
        for t in inner {
            let Ok(remaining) = Tolerance::new(sub_down(tolerance.get(), moved)) else { break };
            if let Ok((simpler, by)) = curve.without_knot(t, remaining) {
                (curve, moved) = (simpler, if by == 0.0 { moved } else { add_up(moved, by) });
            }
        }
        (curve, moved)
    }
}

/// The equations of one removal.
struct KnotRemoval<'a, const D: usize> {
    curve: &'a NurbsCurve<D>,
    rows: SplineRows<D>,
    t: f64,
    /// The knots without the removed one.
    knots: Vec<f64>,
    /// The control points that its insertion creates as means, by the equations with the same indices.
    first: usize,
    last: usize,
}

impl<'a, const D: usize> KnotRemoval<'a, D> {
    fn new(curve: &'a NurbsCurve<D>, t: f64) -> Self {
        let (rows, p) = (SplineRows::new(curve), curve.knots().degree());
        let mut knots = curve.knots().knots().to_vec();
        let times = curve.knots().multiplicity(t);
        let at = knots.partition_point(|knot| *knot <= t) - 1;
        knots.remove(at);
        Self { curve, rows, t, knots, first: at - p, last: at - times }
    }

    /// The new curve if one equation is dropped.
    fn solved(&self, dropped: usize) -> Result<NurbsCurve<D>, InvalidNurbs> {
        let points = self.solved_row(&self.rows.points, dropped);
        let weights = self.rows.weights.as_ref().map(|weights| self.solved_row(weights, dropped));
        let n = points.len();
        let rows = self.rows.with(self.rows.degree, self.knots.clone(), points, weights);
        let old = self.curve.control();
        rows.curve(|i| match i {
            i if i < self.first => Some(old[i]),
            i if i >= self.last && i < n => Some(old[i + 1]),
            _ => None,
        })
    }

    fn solved_row<const N: usize>(&self, old: &[[f64; N]], dropped: usize) -> Vec<[f64; N]> {
        let mut new = old.to_vec();
        new.remove(self.last);
        let shares = |i: usize| {
            let (low, high) = (self.knots[i], self.knots[i + self.rows.degree]);
            [(high - self.t) / (high - low), (self.t - low) / (high - low)]
        };
        // Each equation contains two neighbouring new points: from the left end it gives the next
        // one, from the right end the previous one, up to the equation that is left out.
        for i in self.first..dropped {
            let [first_share, second_share] = shares(i);
            new[i] = std::array::from_fn(|k| (old[i][k] - first_share * new[i - 1][k]) / second_share);
        }
        for i in (dropped + 1..=self.last).rev() {
            let [first_share, second_share] = shares(i);
            new[i - 1] = std::array::from_fn(|k| (old[i][k] - second_share * new[i][k]) / first_share);
        }
        new
    }

    /// An upper bound of the distance of the old curve from a new one with the knot removed.
    fn distance_up(&self, new: &NurbsCurve<D>) -> f64 {
        let (control, weights) = (new.control(), new.weights());
        let is_polynomial = self.curve.is_polynomial() && new.is_polynomial();
        let weight = |i: usize| Interval::point(if is_polynomial { 1.0 } else { weights[i] });
        let mut largest: f64 = 0.0;
        let diagonal = diagonal_up(control);
        for i in 0..self.curve.control().len() {
            let old = self.curve.control()[i];
            // There is one point less from here on.
            let same = if i < self.first { i } else { i - 1 };
            let is_mean = self.first <= i && i <= self.last;
            let (point, new_weight): ([Interval; D], Interval) = if is_mean {
                let (low, high) = (Interval::point(self.knots[i]), self.knots[i + self.rows.degree]);
                let (t, high) = (Interval::point(self.t), Interval::point(high));
                let shares = [(high - t) / (high - low), (t - low) / (high - low)];
                let [first_share, second_share] = [shares[0] * weight(i - 1), shares[1] * weight(i)];
                // Shares that sum to 1 need no division.
                let total = if is_polynomial { Interval::point(1.0) } else { first_share + second_share };
                let x = |k: usize| {
                    (first_share * Interval::point(control[i - 1][k])
                        + second_share * Interval::point(control[i][k]))
                        / total
                };
                (std::array::from_fn(x), total)
            } else {
                (control[same].map(Interval::point), weight(same))
            };
            let distance = std::array::from_fn(|k| (point[k] - Interval::point(old[k])).magnitude());
            let distance = if distance == [0.0; D] { 0.0 } else { length_up::<D>(distance) };
            let before = if is_polynomial { 1.0 } else { self.curve.weights()[i] };
            let lighter = (new_weight - Interval::point(before)).magnitude();
            let by_weight = if lighter == 0.0 { 0.0 } else { mul_up(div_up(lighter, before), diagonal) };
            let sum = if by_weight == 0.0 { distance } else { add_up(distance, by_weight) };
            // A bound that is NaN is no bound.
            largest = if sum.is_nan() { f64::INFINITY } else { greater(sum, largest) };
        }
        largest
    }
}

/// The diagonal of the box of some points, bounded from above.
fn diagonal_up<const D: usize>(points: &[[f64; D]]) -> f64 {
    let side = |k: usize| {
        let [low, high] =
            points.iter().fold([points[0][k]; 2], |[low, high], p| [lesser(p[k], low), greater(p[k], high)]);
        greater(sub_up(high, low), 0.0)
    };
    length_up::<D>(std::array::from_fn(side))
}
