//! A bound of the distance between a part of a rational piece and the cubic that approximates it.
//!
//! The piece is `X/W`, of degree `n` in Bernstein form, the cubic `C`. Their parameters run differently, and only the
//! distance across matters. So a polynomial `φ` of degree 5 with coefficients from 0 to 1, the first 0 and the last 1, maps
//! parameters of the cubic to parameters of the piece. Since it runs from 0 to 1 within that range, all points of both
//! curves are paired, and the largest distance of a pair bounds the distance in both directions, for any such `φ`. It is
//! `|X(φ) − C·W(φ)|/W(φ)`; the numerator is a polynomial of degree `5n + 3`, and so is the denominator after degree
//! elevation. Both are split into four parts, and in each part the largest coefficient of the numerator over the least of
//! the denominator is a bound.
//!
//! *Rounding.* All coefficients are weighted means of `X` and of products of `W` with control points, with factors that are
//! positive and add up to 1. The errors are `8n·ε` of `R·W` for the part's coefficients; each of `n` steps of the
//! composition adds `(14 + 10n)·ε`, the product with the cubic `(20n + 30)·ε`, differences to the first point `8·ε`, and
//! splitting twice `4(5n + 3)·ε`: in each coordinate less than `(10n² + 70n + 60)·ε`, in all axes less than `64(n + 4)²·ε`
//! of `R` times the largest weight, with `R` the sum over the axes. The denominator has the same relative error.
use crate::explicit::Bezier;
use crate::explicit::nurbs::{BernsteinRow, binomials};
use crate::math::{greater, length, lesser};

/// The degree of `φ`. Chosen: with it bounds are 5 to 8 % larger than the distance on quarters of circles.
pub(super) const RUN: usize = 5;
/// Squares of lengths below 1e-154 lose digits or vanish, so lengths below this are not distinguished from 0.
const LEAST: f64 = 1e-150;

/// Factors of products of polynomials in Bernstein form, for pieces of a degree.
pub(super) struct RunFactors {
    degree: usize,
    /// For each step of the composition, of each coefficient with each of `φ`.
    steps: Vec<Vec<[f64; RUN + 1]>>,
    cubic: Vec<[f64; 4]>,
}

/// The factors of the products of the coefficients of two polynomials, the second of degree `M − 1`.
fn factors<const M: usize>(degree: usize) -> Vec<[f64; M]> {
    let (first, second, both) = (binomials(degree), binomials(M - 1), binomials(degree + M - 1));
    (0..=degree).map(|i| std::array::from_fn(|k| first[i] * second[k] / both[i + k])).collect()
}

impl RunFactors {
    pub fn new(degree: usize) -> Self {
        let steps = (0..degree).map(|step| factors(step * RUN)).collect();
        Self { degree, steps, cubic: factors(degree * RUN) }
    }

    /// The coefficients of a polynomial at `φ`: de Casteljau's algorithm with a polynomial for the parameter.
    fn composed<const N: usize>(&self, row: &BernsteinRow<N>, run: &[f64; RUN + 1]) -> Vec<[f64; N]> {
        let mut rows: Vec<Vec<[f64; N]>> = row.0.iter().map(|x| vec![*x]).collect();
        for (step, factors) in self.steps.iter().enumerate() {
            for i in 0..self.degree - step {
                let mut product = vec![[0.0; N]; factors.len() + RUN];
                for (j, row) in factors.iter().enumerate() {
                    let (x, y) = (rows[i][j], rows[i + 1][j]);
                    for (k, factor) in row.iter().enumerate() {
                        for axis in 0..N {
                            product[j + k][axis] += factor * ((1.0 - run[k]) * x[axis] + run[k] * y[axis]);
                        }
                    }
                }
                // The other products of this step start at later rows.
                rows[i] = product;
            }
        }
        rows.swap_remove(0)
    }

    /// The bound for a part, by its weighted points and weights.
    pub fn distance<const D: usize>(
        &self,
        part: &RationalPart<D>,
        cubic: &Bezier<D>,
        run: &[f64; RUN + 1],
    ) -> f64 {
        let is_run = run.iter().all(|x| (0.0..=1.0).contains(x)) && run[0] == 0.0 && run[RUN] == 1.0;
        let (mut least, mut most) = (f64::INFINITY, 0.0);
        for [w] in &part.weights.0 {
            (least, most) = (lesser(*w, least), greater(*w, most));
        }
        if !(is_run && least > 0.0 && most.is_finite()) {
            return f64::INFINITY;
        }
        // 1. Relative to the first control point of the cubic.
        let origin = cubic.control[0];
        let from = |x: &[f64; D], w: f64| -> [f64; D] { std::array::from_fn(|k| x[k] - origin[k] * w) };
        let weighted = part.weighted.0.iter().zip(&part.weights.0).map(|(x, [w])| from(x, *w)).collect();
        let control = cubic.control.map(|c| from(&c, 1.0));
        // 2. Numerator and denominator.
        let points = self.composed(&BernsteinRow(weighted), run);
        let weights = self.composed(&part.weights, run);
        let mut above = vec![[0.0; D]; points.len() + 3];
        let mut below = vec![[0.0]; points.len() + 3];
        for (j, factors) in self.cubic.iter().enumerate() {
            let (x, [w]) = (points[j], weights[j]);
            for (k, factor) in factors.iter().enumerate() {
                below[j + k][0] += factor * w;
                for axis in 0..D {
                    above[j + k][axis] += factor * (x[axis] - control[k][axis] * w);
                }
            }
        }
        // 3. The bound of each quarter. The relative error is derived at the head of this file.
        let relative = 64.0 * ((self.degree + 4) * (self.degree + 4)) as f64 * f64::EPSILON;
        let reach = cubic
            .control
            .iter()
            .fold(part.reach, |far, p| greater(far, p.iter().fold(0.0, |sum: f64, x| sum + x.abs())));
        let rounding = relative * reach * most + LEAST * greater(most, 1.0);
        let ratio = |above: &[[f64; D]], below: &[[f64; 1]]| {
            // NaN counts as infinite.
            let larger = |far: f64, x: f64| if x.is_nan() { f64::INFINITY } else { greater(x, far) };
            let far = above.iter().map(|x| length(*x)).fold(0.0, larger);
            let least = below.iter().fold(f64::INFINITY, |least, [w]| lesser(*w, least)) * (1.0 - relative);
            // A length of up to three squares has less than 8 half roundings.
            (far * (1.0 + 8.0 * f64::EPSILON) + rounding) / least
        };
        let mut worst = 0.0;
        let halves = (split(&above), split(&below));
        for (above, below) in halves.0.iter().zip(&halves.1) {
            let (above, below) = (split(above), split(below));
            for (above, below) in above.iter().zip(&below) {
                worst = greater(ratio(above, below), worst);
            }
        }
        (worst * (1.0 + 4.0 * f64::EPSILON)).next_up()
    }
}

/// A part of a rational piece over `[0, 1]`, and the reach of the whole piece: the sum over the axes of the largest
/// coordinates.
pub(super) struct RationalPart<const D: usize> {
    pub weighted: BernsteinRow<D>,
    pub weights: BernsteinRow<1>,
    pub reach: f64,
}

/// The coefficients over the two halves.
fn split<const N: usize>(row: &[[f64; N]]) -> [Vec<[f64; N]>; 2] {
    let (mut left, mut right) = (Vec::with_capacity(row.len()), row.to_vec());
    for last in (0..row.len()).rev() {
        left.push(right[0]);
        for i in 0..last {
            right[i] = std::array::from_fn(|k| 0.5 * right[i][k] + 0.5 * right[i + 1][k]);
        }
    }
    [left, right]
}
