//! A bound on the distance between a part of a rational surface and the bicubic patch that replaces it.
//!
//! With numerator `X` and denominator `W` of the surface in Bernstein form, and the patch `H`, points of equal
//! parameters are `|X − H·W| / W` apart. The numerator is a polynomial, of three degrees more than `X` in each
//! direction; its coefficients are sums of products, and the largest of them bounds it everywhere, as the least weight
//! bounds `W`. It vanishes twice at each side's ends, and falls with the fourth power of the part's size. Points of
//! equal parameters pair all points of both surfaces, so that the bound holds in both directions.
//!
//! *Rounding.* All coefficients of the surface are weighted means of control points times weights with positive
//! factors: the error of each coordinate is below `8(p + q + 1)·ε·R·W`, with `R` the largest coordinate of a control
//! point of the surface or the patch, for the weights, the pieces and the parts. The patch is taken as it is, rounded
//! numbers included. Differences to its corner and products add `16·ε·R·W`, and sums, of 16 terms at most with factors
//! that add up to 1, `24·ε·R·W`. All of this for three coordinates, with the division by the least weight, is below
//! `64(p + q + 4)·ε·R·W`.
use crate::explicit::Patch;
use crate::explicit::nurbs::{BernsteinRow, binomials};
use crate::math::{greater, lesser};

/// A length that counts as rounding. Derived: lengths below 1e-154 have squares that lose digits or vanish, and products
/// below the normal numbers lose less.
const LEAST: f64 = 1e-150;

/// The factors of products of two polynomials in Bernstein form, the second a cubic.
#[derive(Debug)]
pub(super) struct ProductFactors {
    degrees: [usize; 2],
    /// The largest coordinate of a control point of the surface.
    reach: f64,
    /// By direction, for each coefficient of the first: the factors with the four coefficients of the second.
    factors: [Vec<[f64; 4]>; 2],
}

impl ProductFactors {
    pub fn new(degrees: [usize; 2], reach: f64) -> Self {
        let of = |degree: usize| {
            let (first, second, both) = (binomials(degree), binomials(3), binomials(degree + 3));
            let factor = |i: usize, k: usize| first[i] * second[k] / both[i + k];
            (0..=degree).map(|i| std::array::from_fn(|k| factor(i, k))).collect()
        };
        Self { degrees, reach, factors: degrees.map(of) }
    }

    /// The largest distance between points of equal parameters of a part, by the rows of its coefficients, and of a patch.
    pub fn distance(&self, part: &[BernsteinRow<4>], patch: &Patch) -> f64 {
        let [p, q] = self.degrees;
        let corner = patch.control[0][0];
        let from_corner = |x: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| x[k] - corner[k]) };
        let control = patch.control.map(|row| row.map(from_corner));
        let width = p + 4;
        let mut sums = vec![[0.0; 3]; width * (q + 4)];
        let (mut least, mut most) = (f64::INFINITY, 0.0);
        for (j, row) in part.iter().enumerate() {
            for (i, x) in row.0.iter().enumerate() {
                let w = x[3];
                (least, most) = (lesser(w, least), greater(w, most));
                let point: [f64; 3] = std::array::from_fn(|k| x[k] - corner[k] * w);
                for (l, along_v) in self.factors[1][j].iter().enumerate() {
                    for (k, along_u) in self.factors[0][i].iter().enumerate() {
                        let factor = along_u * along_v;
                        let sum = &mut sums[(j + l) * width + i + k];
                        for axis in 0..3 {
                            sum[axis] += factor * (point[axis] - control[l][k][axis] * w);
                        }
                    }
                }
            }
        }
        let squares = sums.iter().map(|d| d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        // NaN counts as infinite.
        let more = |far: f64, one: f64| if one.is_nan() { f64::INFINITY } else { greater(one, far) };
        let largest_sq = squares.fold(0.0, more);
        if !(least > 0.0 && most.is_finite()) {
            return f64::INFINITY;
        }
        // A patch's control points may have larger coordinates than the surface's.
        let reach = patch
            .control
            .as_flattened()
            .as_flattened()
            .iter()
            .fold(self.reach, |far, x| greater(x.abs(), far));
        // Derived at the head of this file.
        let rounding = 64.0 * (p + q + 4) as f64 * f64::EPSILON * reach * most + LEAST;
        // Derived: half a rounding each for the square root, three products and their sums, the sum and the quotient.
        let bound = (largest_sq.sqrt() * (1.0 + 8.0 * f64::EPSILON) + rounding) / least;
        (bound * (1.0 + 4.0 * f64::EPSILON)).next_up()
    }
}
