//! `NurbsCurve`: a rational B-spline curve of any degree.
use super::knots::{InvalidNurbs, KnotVector};
use super::rational::quotient_derivatives;
use super::{BernsteinRow, RationalBezier};
use crate::explicit::{Bezier, Curve, CurveEnds, CurveSegment, InvalidCurve};
use crate::math::{distance, exponent, greater, power_of_two};

/// A curve `Σ Nᵢ(t) wᵢ Pᵢ / Σ Nᵢ(t) wᵢ` of any degree, in the plane or in space.
///
/// With weights of 1 it is a B-spline curve. Arcs of circles and ellipses are exact with weights.
///
/// ```
/// use chordal::explicit::nurbs::NurbsCurve;
/// let circle = NurbsCurve::circle([1.0, 0.0], [[2.0, 0.0], [0.0, 2.0]])?;
/// let [x, y] = circle.at(0.3);
/// assert!(((x - 1.0).hypot(y) - 2.0).abs() < 1e-15);
/// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsCurve<const D: usize> {
    knots: KnotVector,
    control: Vec<[f64; D]>,
    weights: Vec<f64>,
}

/// In proofs, weights must lie between this and its inverse, so that products with coordinates keep their
/// digits. Chosen: far beyond the weights of files.
pub(crate) const HEAVIEST: f64 = 1e30;

/// The weights times a power of two, so that the largest is from 1/2 to 1: squares of products stay in range.
pub(super) fn scaled_weights(weights: &[f64]) -> Vec<f64> {
    let heaviest = weights.iter().fold(0.0, |heaviest: f64, w| greater(*w, heaviest));
    let scale = power_of_two(-exponent(heaviest));
    weights.iter().map(|w| w * scale).collect()
}

/// Checks that there are as many control points and weights as needed, all finite, and the weights above 0.
pub(super) fn check<const D: usize>(
    control: &[[f64; D]],
    weights: &[f64],
    needed: usize,
) -> Result<(), InvalidNurbs> {
    for (what, found) in [("control points", control.len()), ("weights", weights.len())] {
        if found != needed {
            return Err(InvalidNurbs::Count { what, found, needed });
        }
    }
    if let Some(index) = control.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(InvalidNurbs::NotFinite { what: "control point", index });
    }
    if let Some(index) = weights.iter().position(|w| !w.is_finite()) {
        return Err(InvalidNurbs::NotFinite { what: "weight", index });
    }
    match weights.iter().position(|w| *w <= 0.0) {
        Some(index) => Err(InvalidNurbs::Weight(index)),
        None => Ok(()),
    }
}

impl<const D: usize> NurbsCurve<D> {
    /// A curve from knots, control points and their weights.
    ///
    /// # Errors
    /// When the number of control points or weights does not match the knots, a number is not finite, or a
    /// weight is not above 0.
    pub fn new(knots: KnotVector, control: Vec<[f64; D]>, weights: Vec<f64>) -> Result<Self, InvalidNurbs> {
        check(&control, &weights, knots.n_control())?;
        Ok(Self { knots, control, weights })
    }

    /// The knots.
    #[must_use]
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// The control points.
    #[must_use]
    pub fn control(&self) -> &[[f64; D]] {
        &self.control
    }

    /// The weights of the control points.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The point at a parameter; outside the domain, the point of the nearer end.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; D] {
        self.derivatives(t, 0)[0]
    }

    /// The point and the derivatives up to an order. At a knot they are those to its right.
    #[must_use]
    pub fn derivatives(&self, t: f64, order: usize) -> Vec<[f64; D]> {
        let (piece, at) = self.knots.locate(t);
        let [a, b] = self.knots.piece(piece);
        let (points, weights) = self.bezier_rows(piece);
        let mut derivatives = quotient_derivatives(&points, &weights, at, order);
        // Convert derivatives by the piece's parameter to those by the curve's.
        let mut scale = 1.0;
        for derivative in &mut derivatives {
            *derivative = derivative.map(|x| x * scale);
            scale /= b - a;
        }
        derivatives
    }

    /// The curve as a path of Bézier pieces between its knots: lines and cubics if all weights are equal and
    /// the degree is 1 to 3, otherwise rational pieces. It is closed if it ends where it starts. The rounding
    /// of the pieces is included in [`Curve::slack`].
    ///
    /// # Errors
    /// When an intermediate number overflows.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let path = NurbsCurve::circle([0.0, 0.0], [[1.0, 0.0], [0.0, 1.0]])?.to_curve()?;
    /// assert_eq!((path.segments().len(), path.is_closed(), path.at(1.0)), (4, true, [0.0, 1.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_curve(&self) -> Result<Curve<D>, InvalidCurve> {
        let p = self.knots.degree();
        // Equal weights have no effect, but their means would have roundings.
        let is_polynomial = self.is_polynomial();
        let (x, w) = if is_polynomial {
            let x = self.knots.to_bezier(&self.control);
            let ones = vec![[1.0]; x.len()];
            (x, ones)
        } else {
            let (weighted, weights) = self.weighted();
            (self.knots.to_bezier(&weighted), self.knots.to_bezier(&weights))
        };
        let [first, last] = [self.control[0], self.control[self.control.len() - 1]];
        // A clamped curve ends at control points; multiplying by weights and dividing again would move them.
        let [from, to] = self.knots.clamped_ends();
        let joint_of = |k: usize| -> [f64; D] {
            let at = k * p;
            match (k == 0 && from, at + 1 == w.len() && to) {
                (true, _) => first,
                (_, true) => last,
                _ => x[at].map(|x| x / w[at][0]),
            }
        };
        let reach = self.control.as_flattened().iter().fold(0.0, |largest: f64, x| greater(x.abs(), largest));
        // Derived: a coefficient is a weighted mean in p steps of three roundings, of products with a weight,
        // and divided by one; a quadratic raised to a cubic takes three more. Each coordinate of a point is
        // off by less than 4p + 8 steps.
        let rounding = (4 * p + 8) as f64 * f64::EPSILON * D as f64 * reach;
        // A curve with periodic knots may miss its start by rounding.
        let n = self.knots.n_pieces();
        let missed = distance(joint_of(n), joint_of(0));
        let is_closed = missed <= rounding;
        let joint = |k: usize| if k == n && is_closed { joint_of(0) } else { joint_of(k) };
        let slack = if is_closed { rounding + 2.0 * missed } else { rounding };
        let piece = |k: usize| {
            let (x, w) = (&x[k * p..=(k + 1) * p], &w[k * p..=(k + 1) * p]);
            let (start, end) = (joint(k), joint(k + 1));
            let point = |i: usize| -> [f64; D] { x[i].map(|x| x / w[i][0]) };
            match (p, is_polynomial) {
                (1, true) => CurveSegment::Line([start, end]),
                (2, true) => CurveSegment::quadratic([start, point(1), end]),
                (3, true) => CurveSegment::Cubic(Bezier { control: [start, point(1), point(2), end] }),
                _ => CurveSegment::Rational(RationalBezier::new(x.to_vec(), w.to_vec(), [start, end])),
            }
        };
        let pieces: Vec<CurveSegment<D>> = (0..n).map(piece).collect();
        Ok(Curve::new(pieces, CurveEnds::from(is_closed))?.with_slack(slack))
    }

    /// Whether all weights are equal, so that they have no effect.
    pub(crate) fn is_polynomial(&self) -> bool {
        self.weights.iter().all(|w| *w == self.weights[0])
    }

    /// The points times their weights, and the weights.
    fn weighted(&self) -> (Vec<[f64; D]>, Vec<[f64; 1]>) {
        let weights = scaled_weights(&self.weights);
        let points = self.control.iter().zip(&weights).map(|(p, w)| p.map(|x| x * w)).collect();
        (points, weights.iter().map(|w| [*w]).collect())
    }

    /// The weighted points and the weights of a piece, in Bernstein form.
    fn bezier_rows(&self, piece: usize) -> (BernsteinRow<D>, BernsteinRow<1>) {
        let (weighted, weights) = self.weighted();
        (self.knots.piece_row(&weighted, piece), self.knots.piece_row(&weights, piece))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A knot beyond those that repeat at an end leaves a control point without influence.
    #[test]
    fn a_curve_starts_at_its_first_control_point_only_if_it_has_influence() {
        for (p, knots) in [
            (1, vec![-1.0, 0.0, 0.0, 1.0, 1.0]),
            (1, vec![0.0, 0.0, 1.0, 1.0, 2.0]),
            (2, vec![-1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]),
            (2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0]),
        ] {
            let is_first = knots[0] < 0.0;
            let knots = KnotVector::new(p, knots).unwrap();
            assert_eq!(knots.clamped_ends(), [!is_first, is_first]);
            let mut control = vec![[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]][..=p].to_vec();
            control.insert(if is_first { 0 } else { p + 1 }, [50.0, 70.0]);
            for weight in [1.0, 2.0] {
                let mut weights = vec![1.0; p + 2];
                weights[1] = weight;
                let curve = NurbsCurve::new(knots.clone(), control.clone(), weights).unwrap();
                let raised = curve.elevated(1).unwrap();
                for other in [curve.to_curve().unwrap(), raised.to_curve().unwrap()] {
                    for (t, there) in [(0.0, 0.0), (0.3, 0.3), (1.0, 1.0)] {
                        let (a, b) = (curve.at(t), other.at(there));
                        assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-12, "{p} {t} {a:?} {b:?}");
                    }
                }
            }
        }
        let often = KnotVector::new(1, vec![0.0, 0.0, 0.0, 1.0, 1.0]).unwrap_err();
        assert_eq!(
            often.to_string(),
            "knot 0 occurs more than 2 times, which is as often as degree 1 allows at an end"
        );
    }
}
