//! `RationalBezier`: one piece of a rational curve of any degree.
use super::{BernsteinRow, binomials};
use crate::explicit::AffineMap;
use crate::math::{greater, lesser};
use std::sync::Arc;

/// A curve `Σ Bᵢ(t) wᵢ Pᵢ / Σ Bᵢ(t) wᵢ` over a parameter from 0 to 1, given by its weighted control points
/// and their weights, which are above 0.
#[derive(Clone, Debug, PartialEq)]
pub struct RationalBezier<const D: usize> {
    rows: Arc<RationalRows<D>>,
    ends: [[f64; D]; 2],
}

#[derive(Debug, PartialEq)]
struct RationalRows<const D: usize> {
    weighted: BernsteinRow<D>,
    weights: BernsteinRow<1>,
}

impl<const D: usize> RationalBezier<D> {
    /// The curve with these control points and weights; both must have the same length, at least two, and
    /// weights above 0.
    pub(super) fn new(weighted: Vec<[f64; D]>, weights: Vec<[f64; 1]>, ends: [[f64; D]; 2]) -> Self {
        let rows = RationalRows { weighted: BernsteinRow(weighted), weights: BernsteinRow(weights) };
        Self { rows: Arc::new(rows), ends }
    }

    /// The degree.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.rows.weights.0.len() - 1
    }

    /// The control points.
    #[must_use]
    pub fn control(&self) -> Vec<[f64; D]> {
        self.weighted().0.iter().zip(&self.weights().0).map(|(x, [w])| x.map(|x| x / w)).collect()
    }

    /// The weights of the control points.
    #[must_use]
    pub fn control_weights(&self) -> Vec<f64> {
        self.weights().0.iter().map(|[w]| *w).collect()
    }

    pub(crate) fn weighted(&self) -> &BernsteinRow<D> {
        &self.rows.weighted
    }

    pub(crate) fn weights(&self) -> &BernsteinRow<1> {
        &self.rows.weights
    }

    /// Its first and last point.
    #[must_use]
    pub fn ends(&self) -> [[f64; D]; 2] {
        self.ends
    }

    /// The point at `t`; exactly its ends at 0 and 1.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; D] {
        if t <= 0.0 {
            return self.ends[0];
        }
        if t >= 1.0 {
            return self.ends[1];
        }
        let [w] = self.weights().at(t);
        self.weighted().at(t).map(|x| x / w)
    }

    /// The first and the second derivative at `t`.
    #[must_use]
    pub fn derivatives(&self, t: f64) -> [[f64; D]; 2] {
        let ([x, dx, ddx], [[w], [dw], [ddw]]) = (self.weighted().jet(t), self.weights().jet(t));
        let point = x.map(|x| x / w);
        let first: [f64; D] = std::array::from_fn(|k| (dx[k] - point[k] * dw) / w);
        let second = std::array::from_fn(|k| (ddx[k] - 2.0 * first[k] * dw - point[k] * ddw) / w);
        [first, second]
    }

    /// The third derivative at `t`.
    pub(crate) fn third_derivative(&self, t: f64) -> [f64; D] {
        quotient_derivatives(self.weighted(), self.weights(), t, 3)[3]
    }

    /// The same piece in reverse.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let (mut weighted, mut weights) = (self.weighted().0.clone(), self.weights().0.clone());
        weighted.reverse();
        weights.reverse();
        Self::new(weighted, weights, [self.ends[1], self.ends[0]])
    }

    /// The lowest and highest coordinates of a box that contains the piece: the box of its control points.
    #[must_use]
    pub fn bounds(&self) -> [[f64; D]; 2] {
        let mut points = self.control();
        points.extend(self.ends);
        points.iter().fold([points[0]; 2], |[low, high], p| {
            [std::array::from_fn(|k| lesser(p[k], low[k])), std::array::from_fn(|k| greater(p[k], high[k]))]
        })
    }

    /// Whether all its numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let numbers = self.weighted().0.as_flattened().iter().chain(self.weights().0.as_flattened());
        numbers.chain(self.ends.as_flattened()).all(|x| x.is_finite())
    }

    /// The piece under `x ↦ columns·x + offset`.
    #[must_use]
    pub fn transformed(&self, map: &AffineMap<D>) -> Self {
        let moved = |(x, [w]): (&[f64; D], &[f64; 1])| {
            let turned = map.vector(*x);
            std::array::from_fn(|k| turned[k] + w * map.offset[k])
        };
        let weighted = self.weighted().0.iter().zip(&self.weights().0).map(moved).collect();
        Self::new(weighted, self.weights().0.clone(), self.ends.map(|p| map.point(p)))
    }
}

/// The point of a rational piece at `t`, and its derivatives up to an order.
pub(super) fn quotient_derivatives<const N: usize>(
    points: &BernsteinRow<N>,
    weights: &BernsteinRow<1>,
    t: f64,
    order: usize,
) -> Vec<[f64; N]> {
    let weights: Vec<f64> = (0..=order).map(|k| derivative(weights, k, t)[0]).collect();
    // Leibniz' rule for the product of the curve with its denominator.
    let mut derivatives: Vec<[f64; N]> = Vec::with_capacity(order + 1);
    for k in 0..=order {
        let binomial = binomials(k);
        let mut sum = derivative(points, k, t);
        for i in 1..=k {
            for (x, lower) in sum.iter_mut().zip(derivatives[k - i]) {
                *x -= binomial[i] * weights[i] * lower;
            }
        }
        derivatives.push(sum.map(|x| x / weights[0]));
    }
    derivatives
}

/// The derivative of some order of a polynomial in Bernstein form.
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
