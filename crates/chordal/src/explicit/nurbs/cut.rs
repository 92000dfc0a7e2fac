//! Parts of a curve, the reversed curve, the curve over another domain, and under an affine map.
use super::NurbsCurve;
use super::insert::SplineRows;
use super::knots::{InvalidNurbs, KnotVector};
use crate::explicit::AffineMap;

impl<const D: usize> NurbsCurve<D> {
    /// The parts before and after a parameter, which keep their parameters. They share the point at that
    /// parameter bit for bit, and both are clamped at it.
    ///
    /// Rounding is that of [`NurbsCurve::with_knot`] for each of up to `p` knots.
    ///
    /// # Errors
    /// When the parameter is not inside the domain, or an intermediate number overflows.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let arch = NurbsCurve::bezier(vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])?;
    /// let [left, right] = arch.split(0.5)?;
    /// assert_eq!(left.control(), [[0.0, 0.0], [0.0, 0.5], [0.25, 0.75], [0.5, 0.75]]);
    /// assert_eq!((right.control()[0], right.knots().domain()), ([0.5, 0.75], [0.5, 1.0]));
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn split(&self, t: f64) -> Result<[Self; 2], InvalidNurbs> {
        let (p, domain @ [from, to]) = (self.knots().degree(), self.knots().domain());
        if !(from < t && t < to) {
            return Err(InvalidNurbs::Outside { t, domain });
        }
        let refined = self.with_knots(&vec![t; p - self.knots().multiplicity(t)])?;
        let knots = refined.knots().knots();
        // The first of the p knots at `t`; the control point before its index is the point at `t`.
        let first = knots.partition_point(|knot| *knot < t);
        let mut left = knots[..first + p].to_vec();
        left.push(t);
        let mut right = vec![t];
        right.extend(&knots[first..]);
        let (control, weights) = (refined.control(), refined.weights());
        Ok([
            Self::new(KnotVector::new(p, left)?, control[..first].to_vec(), weights[..first].to_vec())?,
            Self::new(
                KnotVector::new(p, right)?,
                control[first - 1..].to_vec(),
                weights[first - 1..].to_vec(),
            )?,
        ])
    }

    /// The part between two parameters of the domain, clamped where it was cut.
    ///
    /// # Errors
    /// When a parameter is outside the domain, or the second is not after the first.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let circle = NurbsCurve::circle([0.0, 0.0], [[1.0, 0.0], [0.0, 1.0]])?;
    /// let half = circle.trimmed(0.25, 0.75)?;
    /// assert_eq!((half.at(0.25), half.at(0.75)), ([0.0, 1.0], [0.0, -1.0]));
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn trimmed(&self, from: f64, to: f64) -> Result<Self, InvalidNurbs> {
        let domain @ [first, last] = self.knots().domain();
        if let Some(t) = [from, to].into_iter().find(|t| !(first <= *t && *t <= last)) {
            return Err(InvalidNurbs::Outside { t, domain });
        }
        if from >= to {
            return Err(InvalidNurbs::Backwards { from, to });
        }
        let mut part = self.clone();
        if to < last {
            [part, _] = part.split(to)?;
        }
        if from > first {
            [_, part] = part.split(from)?;
        }
        Ok(part)
    }

    /// The same curve from its end to its start: its point at `−t` is that of this curve at `t`. Knots are
    /// negated, so that no number is rounded and the reverse of the reverse is this curve;
    /// [`NurbsCurve::with_domain`] maps it to another range.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let line = NurbsCurve::bezier(vec![[0.0, 0.0], [4.0, 0.0]])?;
    /// let back = line.reversed();
    /// assert_eq!((back.knots().domain(), back.at(-0.25)), ([-1.0, 0.0], [1.0, 0.0]));
    /// assert_eq!(back.reversed(), line);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    ///
    /// # Panics
    /// Never: negated knots in reverse are as valid as before.
    #[must_use]
    pub fn reversed(&self) -> Self {
        // 0 − 0 is +0, so that no knot is −0.
        let knots = self.knots().knots().iter().rev().map(|t| 0.0 - t).collect();
        let knots = KnotVector::new(self.knots().degree(), knots).expect("valid knots, negated");
        let control = self.control().iter().rev().copied().collect();
        let weights = self.weights().iter().rev().copied().collect();
        Self::new(knots, control, weights).expect("as many points as before")
    }

    /// The same points at other parameters: the domain is mapped linearly to that from `from` to `to`.
    ///
    /// Knots are rounded, equal ones alike, by three units in the last place of the larger of the two ends.
    /// That moves a point along the curve by that error times the curve's speed.
    ///
    /// # Errors
    /// When the range has no length, is not finite, or is too short for the knots to stay apart.
    pub fn with_domain(&self, from: f64, to: f64) -> Result<Self, InvalidNurbs> {
        if from >= to || from.is_nan() || to.is_nan() {
            return Err(InvalidNurbs::Backwards { from, to });
        }
        let [a, b] = self.knots().domain();
        // The ends exactly; both shares are computed separately, so that parameters near either end keep
        // their digits.
        let moved = |t: &f64| ((b - t) / (b - a)) * from + ((t - a) / (b - a)) * to;
        let knots = KnotVector::new(self.knots().degree(), self.knots().knots().iter().map(moved).collect())?;
        Self::new(knots, self.control().to_vec(), self.weights().to_vec())
    }

    /// The curve under `x ↦ columns·x + offset`: the map is applied to its control points; knots and weights
    /// stay.
    ///
    /// Rounding moves it by less than `D + 2` units in the last place of the largest intermediate value.
    ///
    /// # Errors
    /// When a coordinate overflows.
    ///
    /// ```
    /// use chordal::explicit::{nurbs::NurbsCurve, parametric::AffineMap};
    /// let circle = NurbsCurve::circle([0.0, 0.0], [[1.0, 0.0], [0.0, 1.0]])?;
    /// let wide = AffineMap { columns: [[2.0, 0.0], [0.0, 1.0]], offset: [1.0, 0.0] };
    /// assert_eq!(circle.transformed(&wide)?, NurbsCurve::circle([1.0, 0.0], [[2.0, 0.0], [0.0, 1.0]])?);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn transformed(&self, map: &AffineMap<D>) -> Result<Self, InvalidNurbs> {
        let control = self.control().iter().map(|p| map.point(*p)).collect();
        Self::new(self.knots().clone(), control, self.weights().to_vec())
    }
}

/// The knots and control points of a curve whose ends are clamped by `p + 1` knots each.
pub(super) fn clamped_rows<const D: usize>(curve: &NurbsCurve<D>) -> SplineRows<D> {
    let mut rows = SplineRows::new(curve);
    let (p, n) = (rows.degree, rows.points.len());
    if rows.knots[0] != rows.knots[p] || rows.knots[n] != rows.knots[n + p] {
        rows.clamp();
    }
    rows
}
