//! Knot insertion, which keeps the curve; and clamping, after which its ends are control points.
//!
//! Boehm's step: with knot `t` in the span `k`, the new control point `i` from `k − p + 1` to `k` is
//! `(1 − α)·Pᵢ₋₁ + α·Pᵢ` with `α = (t − tᵢ)/(tᵢ₊ₚ − tᵢ)`: the blossom at the p neighbours of the new knot
//! vector, and a weighted mean, so that errors of control points never grow.
//!
//! *Rounding.* Each of the two shares takes three roundings, the products and their sum two more: less than
//! `4ε` of the larger point. So a knot moves coordinates by up to `4ε` of the largest; weights are sums of
//! positive terms and off by `4ε` of themselves, which moves points by that share of the distance of two
//! control points. The product with the weight and the division by it take another two. Together less than
//! `16ε` times the largest coordinate for each knot.
//!
//! Source: W. Boehm, *Inserting new knots into B-spline curves*, 1980.
use super::NurbsCurve;
use super::curve::scaled_weights;
use super::knots::{InvalidNurbs, KnotVector};
use crate::math::{exponent, greater, power_of_two};

/// The control points of a spline with its knots, while it is changed: weighted points and weights, or points
/// alone.
#[derive(Clone)]
pub(super) struct SplineRows<const D: usize> {
    pub degree: usize,
    pub knots: Vec<f64>,
    pub points: Vec<[f64; D]>,
    /// None if all weights are equal.
    pub weights: Option<Vec<[f64; 1]>>,
    /// The common weight, or the unit of the weights: a power of two.
    unit: f64,
}

impl<const D: usize> SplineRows<D> {
    pub fn new(curve: &NurbsCurve<D>) -> Self {
        let (degree, knots) = (curve.knots().degree(), curve.knots().knots().to_vec());
        if curve.is_polynomial() {
            let (points, unit) = (curve.control().to_vec(), curve.weights()[0]);
            return Self { degree, knots, points, weights: None, unit };
        }
        let scaled = scaled_weights(curve.weights());
        let points = curve.control().iter().zip(&scaled).map(|(p, w)| p.map(|x| x * w)).collect();
        let heaviest = curve.weights().iter().fold(0.0, |heaviest: f64, w| greater(*w, heaviest));
        let unit = power_of_two(exponent(heaviest));
        Self { degree, knots, points, weights: Some(scaled.into_iter().map(|w| [w]).collect()), unit }
    }

    /// The curve of the rows. `unchanged` returns the control points that have not changed, by their index.
    pub fn curve(self, unchanged: impl Fn(usize) -> Option<[f64; D]>) -> Result<NurbsCurve<D>, InvalidNurbs> {
        let knots = KnotVector::new(self.degree, self.knots)?;
        let point = |i: usize, x: [f64; D]| unchanged(i).unwrap_or(x);
        match self.weights {
            None => {
                let weights = vec![self.unit; self.points.len()];
                let points = self.points.into_iter().enumerate().map(|(i, x)| point(i, x)).collect();
                NurbsCurve::new(knots, points, weights)
            }
            Some(weights) => {
                let pairs = self.points.iter().zip(&weights).enumerate();
                let points = pairs.map(|(i, (x, [w]))| point(i, x.map(|x| x / w))).collect();
                NurbsCurve::new(knots, points, weights.iter().map(|[w]| w * self.unit).collect())
            }
        }
    }

    /// Other rows, with weights in the same unit.
    pub fn with(
        &self,
        degree: usize,
        knots: Vec<f64>,
        points: Vec<[f64; D]>,
        weights: Option<Vec<[f64; 1]>>,
    ) -> Self {
        Self { degree, knots, points, weights, unit: self.unit }
    }

    /// The index of the last knot that is not beyond `t`.
    fn span(&self, t: f64) -> usize {
        self.knots.partition_point(|knot| *knot <= t) - 1
    }

    /// Inserts a knot, which must lie in the domain or at its end.
    pub fn insert(&mut self, t: f64) {
        let k = self.span(t);
        insert_point(&self.knots, self.degree, k, t, &mut self.points);
        if let Some(weights) = &mut self.weights {
            insert_point(&self.knots, self.degree, k, t, weights);
        }
        self.knots.insert(k + 1, t);
    }

    /// Drops control points, and as many knots, from both ends.
    pub fn drop_ends(&mut self, [first, last]: [usize; 2]) {
        let range = first..self.points.len() - last;
        self.knots = self.knots[first..self.knots.len() - last].to_vec();
        self.points = self.points[range.clone()].to_vec();
        if let Some(weights) = &mut self.weights {
            *weights = weights[range].to_vec();
        }
    }

    /// Makes the spline start and end at control points: its first and its last knot are then repeated p + 1
    /// times.
    pub fn clamp(&mut self) {
        let p = self.degree;
        let [from, to] = [self.knots[p], self.knots[self.points.len()]];
        // Knots beyond the domain are dropped below.
        let multiplicity = |knots: &[f64], t: f64| knots.iter().filter(|knot| **knot == t).count();
        while multiplicity(&self.knots, to) < p {
            self.insert(to);
        }
        let n_after = self.knots.iter().filter(|knot| **knot > to).count();
        while multiplicity(&self.knots, from) < p {
            self.insert(from);
        }
        let n_before = self.knots.iter().filter(|knot| **knot < from).count();
        // At least p of the p + 1 knots that stay at each end are equal. The other one has no influence on
        // the curve, and is made equal to them.
        let n_dropped = |n_equal: usize, n_beyond: usize| (n_equal + n_beyond).saturating_sub(p + 1);
        let [n_from, n_to] = [multiplicity(&self.knots, from), multiplicity(&self.knots, to)];
        self.drop_ends([n_dropped(n_from, n_before), n_dropped(n_to, n_after)]);
        self.knots[0] = from;
        if let Some(knot) = self.knots.last_mut() {
            *knot = to;
        }
    }
}

/// One step of insertion for one row of control points; `k` is the index of the last knot that is not beyond
/// `t`.
fn insert_point<const N: usize>(knots: &[f64], p: usize, k: usize, t: f64, row: &mut Vec<[f64; N]>) {
    let n = row.len();
    let last = k.min(n - 1);
    let first = (k + 1).saturating_sub(p).max(1);
    let mean = |i: usize| -> [f64; N] {
        let (low, high) = (knots[i], knots[i + p]);
        // At an existing knot the control point is one of the old ones.
        if t <= low {
            return row[i - 1];
        }
        if t >= high {
            return row[i];
        }
        let (second_share, first_share) = ((t - low) / (high - low), (high - t) / (high - low));
        std::array::from_fn(|c| first_share * row[i - 1][c] + second_share * row[i][c])
    };
    let new: Vec<[f64; N]> = (first..=last).map(mean).collect();
    // The points first .. last−1 are replaced by the points first .. last.
    row.splice(first..last, new);
}

impl<const D: usize> NurbsCurve<D> {
    /// The same curve with a knot inserted `times` times.
    ///
    /// Every control point of the new curve is a weighted mean of old ones. Rounding moves the curve by less
    /// than `16ε` times the largest coordinate for each knot. Cost for one knot: the `p` points that it
    /// changes, and the copy of the others.
    ///
    /// # Errors
    /// When the parameter is not inside the domain, or the knot would be repeated more often than the degree.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let arch = NurbsCurve::bezier(vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])?;
    /// let finer = arch.with_knot(0.5, 1)?;
    /// assert_eq!(finer.control(), [[0.0, 0.0], [0.0, 0.5], [0.5, 1.0], [1.0, 0.5], [1.0, 0.0]]);
    /// assert_eq!(finer.at(0.25), arch.at(0.25));
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn with_knot(&self, t: f64, times: usize) -> Result<Self, InvalidNurbs> {
        // More repetitions than fit are refused below, however many there are.
        self.with_knots(&vec![t; times.min(self.knots().degree() + 1)])
    }

    /// The same curve with more knots, in any order, repeated or not.
    ///
    /// Like [`NurbsCurve::with_knot`] for each of them.
    ///
    /// # Errors
    /// When a parameter is not inside the domain, or a knot would be repeated more often than the degree.
    pub fn with_knots(&self, knots: &[f64]) -> Result<Self, InvalidNurbs> {
        let domain @ [from, to] = self.knots().domain();
        if let Some(t) = knots.iter().find(|t| !(from < **t && **t < to)) {
            return Err(InvalidNurbs::Outside { t: *t, domain });
        }
        let mut sorted = knots.to_vec();
        sorted.sort_by(f64::total_cmp);
        let degree = self.knots().degree();
        for same in sorted.chunk_by(|a, b| a == b) {
            if same.len() + self.knots().multiplicity(same[0]) > degree {
                let index = self.knots().knots().partition_point(|knot| *knot < same[0]);
                return Err(InvalidNurbs::Repeated { index, degree });
            }
        }
        let Some(first) = sorted.first() else { return Ok(self.clone()) };
        let (n, unchanged) = (self.control().len(), self.unchanged(*first, sorted[sorted.len() - 1]));
        let mut rows = SplineRows::new(self);
        sorted.iter().for_each(|t| rows.insert(*t));
        let n_points = rows.points.len();
        rows.curve(|i| match unchanged {
            // Points that no new knot affects are taken from the curve: those in the rows are multiplied
            // by their weights, and dividing by them would round.
            [before, _] if i < before => Some(self.control()[i]),
            [_, after] if n_points - i <= after => Some(self.control()[n - (n_points - i)]),
            _ => None,
        })
    }

    /// The numbers of control points at the start and at the end that are not affected by knots from `first`
    /// to `last`.
    fn unchanged(&self, first: f64, last: f64) -> [usize; 2] {
        let (p, n, knots) = (self.knots().degree(), self.control().len(), self.knots().knots());
        let span = |t: f64| knots.partition_point(|knot| *knot <= t) - 1;
        [span(first) + 1 - p, n.saturating_sub(span(last))]
    }

    /// The same curve with its first and last knot repeated, so that it starts and ends at its first and last
    /// control point. A curve that is clamped already stays the same, to the bit.
    ///
    /// Cost: that of the inserted knots ([`NurbsCurve::with_knot`]), up to twice the degree.
    ///
    /// # Errors
    /// When an intermediate number overflows.
    ///
    /// ```
    /// use chordal::explicit::nurbs::{KnotVector, NurbsCurve};
    /// let points = vec![[0.0, 0.0], [6.0, 0.0], [6.0, 6.0], [0.0, 6.0]];
    /// let open = NurbsCurve::new(KnotVector::uniform(3, 4)?, points, vec![1.0; 4])?;
    /// let clamped = open.clamped()?;
    /// assert_eq!((clamped.control()[0], clamped.at(1.0)), ([5.0, 1.0], [5.0, 5.0]));
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn clamped(&self) -> Result<Self, InvalidNurbs> {
        let (p, n, knots) = (self.knots().degree(), self.control().len(), self.knots().knots());
        if knots[0] == knots[p] && knots[n] == knots[n + p] {
            return Ok(self.clone());
        }
        let mut rows = SplineRows::new(self);
        rows.clamp();
        rows.curve(|_| None)
    }
}
