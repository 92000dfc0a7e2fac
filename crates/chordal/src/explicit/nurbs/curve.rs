//! `NurbsCurve`: a rational B-spline curve of any degree.
use super::knots::{InvalidNurbs, KnotVector};
use super::{BernsteinRow, binomials};

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

/// Whether control points and weights are as many as needed, finite, and the weights above 0.
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
    /// # Errors
    /// When the numbers of control points or weights are not those that the knots need, a number is not finite, or a
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

    /// The point at a parameter; outside of the knots' range that of the nearer end.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; D] {
        self.derivatives(t, 0)[0]
    }

    /// The point and the derivatives up to an order. At a knot they are those to its right.
    #[must_use]
    pub fn derivatives(&self, t: f64, order: usize) -> Vec<[f64; D]> {
        let (piece, place) = self.knots.locate(t);
        let [a, b] = self.knots.piece(piece);
        let (mut points, mut weights): (Vec<[f64; D]>, Vec<f64>) = (Vec::new(), Vec::new());
        let (points_row, weights_row) = self.bezier_rows(piece);
        // By the parameter of the whole curve.
        let mut scale = 1.0;
        for k in 0..=order {
            points.push(derivative(&points_row, k, place).map(|x| x * scale));
            weights.push(derivative(&weights_row, k, place)[0] * scale);
            scale /= b - a;
        }
        // Leibniz' rule for the product of the curve with its denominator.
        let mut made: Vec<[f64; D]> = Vec::with_capacity(order + 1);
        for k in 0..=order {
            let binomial = binomials(k);
            let mut sum = points[k];
            for i in 1..=k {
                for (x, lower) in sum.iter_mut().zip(made[k - i]) {
                    *x -= binomial[i] * weights[i] * lower;
                }
            }
            made.push(sum.map(|x| x / weights[0]));
        }
        made
    }

    /// The weighted points and the weights of a piece, in Bernstein form.
    fn bezier_rows(&self, piece: usize) -> (BernsteinRow<D>, BernsteinRow<1>) {
        let weighted: Vec<[f64; D]> =
            self.control.iter().zip(&self.weights).map(|(p, w)| p.map(|x| x * w)).collect();
        let weights: Vec<[f64; 1]> = self.weights.iter().map(|w| [*w]).collect();
        (self.knots.piece_row(&weighted, piece), self.knots.piece_row(&weights, piece))
    }
}

/// The derivative of an order of a polynomial in Bernstein form.
fn derivative<const N: usize>(row: &BernsteinRow<N>, order: usize, t: f64) -> [f64; N] {
    let mut coefficients = row.0.clone();
    for _ in 0..order {
        let degree = coefficients.len() - 1;
        if degree == 0 {
            return [0.0; N];
        }
        let step = |pair: &[[f64; N]]| std::array::from_fn(|k| degree as f64 * (pair[1][k] - pair[0][k]));
        coefficients = coefficients.windows(2).map(step).collect();
    }
    BernsteinRow(coefficients).at(t)
}
