//! `Polynomial`: the single polynomial through many points, for comparison with splines.
use super::spline::InvalidSpline;
use crate::math::{greater, lesser};

/// The polynomial of lowest degree through `points` at `nodes`.
///
/// The entire curve depends on every given point. Through equally spaced nodes it oscillates near the ends
/// (C. Runge, 1901): for 1/(1+25x²) at 11 nodes on [−1, 1] by 1.9, although the function is at most 1.
///
/// ```
/// use chordal::explicit::parametric::Polynomial;
/// let parabola = Polynomial::through(&[0.0, 1.0, 3.0], &[[0.0], [1.0], [9.0]])?;
/// assert_eq!(parabola.at(2.0), [4.0]);
/// # Ok::<(), chordal::explicit::spline::InvalidSpline>(())
/// ```
///
/// Source: J.-P. Berrut, L. N. Trefethen, *Barycentric Lagrange interpolation*, 2004 (the second form).
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial<const D: usize> {
    nodes: Vec<f64>,
    points: Vec<[f64; D]>,
    weights: Vec<f64>,
}

impl<const D: usize> Polynomial<D> {
    /// The polynomial through `points` at `nodes`, in quadratic time.
    ///
    /// # Errors
    /// When there is no point, the numbers of points and nodes differ, two nodes are equal, or a number is
    /// not finite.
    pub fn through(nodes: &[f64], points: &[[f64; D]]) -> Result<Self, InvalidSpline> {
        if points.is_empty() {
            return Err(InvalidSpline::TooFew(1));
        }
        if nodes.len() != points.len() {
            return Err(InvalidSpline::Tangents);
        }
        if !nodes.iter().chain(points.as_flattened()).all(|x| x.is_finite()) {
            return Err(InvalidSpline::NotFinite);
        }
        // Scaled by the width of all nodes, so that products of many differences overflow only for more
        // nodes.
        let (low, high) =
            nodes.iter().fold((nodes[0], nodes[0]), |(low, high), x| (lesser(*x, low), greater(*x, high)));
        let scale = if high > low { 4.0 / (high - low) } else { 1.0 };
        let weight = |i: usize| {
            let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
            1.0 / others.fold(1.0, |product, (_, x)| product * (scale * (nodes[i] - x)))
        };
        let weights: Vec<f64> = (0..nodes.len()).map(weight).collect();
        match weights.iter().position(|w| !w.is_finite()) {
            Some(i) => Err(InvalidSpline::Repeated(i)),
            None => Ok(Self { nodes: nodes.to_vec(), points: points.to_vec(), weights }),
        }
    }

    /// The point at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> [f64; D] {
        let (mut above, mut below) = ([0.0; D], 0.0);
        for ((node, point), weight) in self.nodes.iter().zip(&self.points).zip(&self.weights) {
            if x == *node {
                return *point;
            }
            // The second barycentric form: whatever factor the weights have in common cancels in
            // the quotient.
            let share = weight / (x - node);
            below += share;
            for k in 0..D {
                above[k] += share * point[k];
            }
        }
        above.map(|sum| sum / below)
    }
}
