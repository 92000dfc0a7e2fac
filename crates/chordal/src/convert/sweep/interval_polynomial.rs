//! `IntervalPolynomial`: sums and products of polynomials in Bernstein form, with intervals as coefficients.
//!
//! Coefficients are multiplied by binomial coefficients, so that a product is a convolution (the scaled Bernstein basis;
//! R. T. Farouki, V. T. Rajan, *Algorithms for polynomials in Bernstein form*, 1988).
use crate::explicit::nurbs::{IntervalRow, interval_binomials};
use crate::math::Interval;

/// A polynomial over `[0, 1]`; the exact coefficients are in these intervals.
#[derive(Clone, Debug)]
pub(super) struct IntervalPolynomial(Vec<Interval>);

/// A vector of polynomials.
pub(super) type IntervalVector = [IntervalPolynomial; 3];

/// The binomial coefficients `n` over 0 to `n`.
fn binomials(n: usize) -> Vec<Interval> {
    // All of them are below 2⁵³, hence exact: 56 over 28 is 7.6e15.
    if n > 56 {
        return interval_binomials(n);
    }
    let mut at: u64 = 1;
    let mut row = vec![Interval::point(1.0)];
    for k in 0..n as u64 {
        // The products stay below 2⁵³·56.
        at = at * (n as u64 - k) / (k + 1);
        row.push(Interval::point(at as f64));
    }
    row
}

impl IntervalPolynomial {
    pub fn constant(x: f64) -> Self {
        Self(vec![Interval::point(x)])
    }

    /// One coordinate of a row.
    pub fn coordinate<const N: usize>(row: &IntervalRow<N>, k: usize) -> Self {
        let binomials = binomials(row.degree());
        Self(row.0.iter().zip(binomials).map(|(x, c)| c * x[k]).collect())
    }

    /// Three coordinates of a row, from one on.
    pub fn vector<const N: usize>(row: &IntervalRow<N>, from: usize) -> IntervalVector {
        std::array::from_fn(|k| Self::coordinate(row, from + k))
    }

    fn degree(&self) -> usize {
        self.0.len() - 1
    }

    pub fn times(&self, other: &Self) -> Self {
        let mut product = vec![Interval::point(0.0); self.degree() + other.degree() + 1];
        for (i, x) in self.0.iter().enumerate() {
            for (j, y) in other.0.iter().enumerate() {
                product[i + j] = product[i + j] + *x * *y;
            }
        }
        Self(product)
    }

    pub fn scaled(&self, by: f64) -> Self {
        Self(self.0.iter().map(|x| *x * Interval::point(by)).collect())
    }

    fn raised(&self, degree: usize) -> Self {
        // The coefficients of 1 are the binomial coefficients themselves.
        if degree == self.degree() {
            return self.clone();
        }
        self.times(&Self(binomials(degree - self.degree())))
    }

    pub fn plus(&self, other: &Self) -> Self {
        self.with(other, |x, y| x + y)
    }

    pub fn minus(&self, other: &Self) -> Self {
        self.with(other, |x, y| x - y)
    }

    fn with(&self, other: &Self, of: impl Fn(Interval, Interval) -> Interval) -> Self {
        let degree = self.degree().max(other.degree());
        let [a, b] = [self, other].map(|x| x.raised(degree));
        Self(a.0.iter().zip(&b.0).map(|(x, y)| of(*x, *y)).collect())
    }

    pub fn derivative(&self) -> Self {
        let n = self.degree();
        if n == 0 {
            return Self::constant(0.0);
        }
        // n·(cᵢ₊₁ − cᵢ)·C(n − 1, i), by the stored [i] = cᵢ·C(n, i): (i + 1)·[i + 1] − (n − i)·[i].
        let of = |i: usize| {
            Interval::point((i + 1) as f64) * self.0[i + 1] - Interval::point((n - i) as f64) * self.0[i]
        };
        Self((0..n).map(of).collect())
    }

    /// An interval around all values: the hull of the coefficients.
    pub fn range(&self) -> Interval {
        let binomials = binomials(self.degree());
        let all = self.0.iter().zip(binomials).map(|(x, c)| *x / c);
        all.reduce(Interval::hull).unwrap_or(Interval::point(0.0))
    }

    /// The values at 0 and at 1.
    pub fn ends(&self) -> [Interval; 2] {
        [self.0[0], self.0[self.degree()]]
    }
}

pub(super) fn dot(a: &IntervalVector, b: &IntervalVector) -> IntervalPolynomial {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

pub(super) fn cross(a: &IntervalVector, b: &IntervalVector) -> IntervalVector {
    let of = |i: usize, j: usize| a[i].times(&b[j]).minus(&a[j].times(&b[i]));
    [of(1, 2), of(2, 0), of(0, 1)]
}

/// The largest length of a vector.
pub(super) fn largest(v: &IntervalVector) -> f64 {
    let squares = v.each_ref().map(|x| x.range().square());
    (squares[0] + squares[1] + squares[2]).sqrt().hi()
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn products_sums_and_derivatives_contain_the_values() {
        let mut random = Random::new(5);
        for _ in 0..200 {
            let row = |random: &mut Random| -> Vec<[f64; 1]> {
                (0..1 + random.below(6)).map(|_| random.point()).collect()
            };
            let (a, b) = (row(&mut random), row(&mut random));
            let polynomial = |row: &[[f64; 1]]| {
                let row = IntervalRow(row.iter().map(|[x]| [Interval::point(*x)]).collect());
                IntervalPolynomial::coordinate(&row, 0)
            };
            let at = |row: &[[f64; 1]], t: f64| crate::explicit::nurbs::BernsteinRow(row.to_vec()).at(t)[0];
            let t = random.unit();
            let (x, y) = (at(&a, t), at(&b, t));
            let (p, q) = (polynomial(&a), polynomial(&b));
            let value = |of: &IntervalPolynomial| {
                let rest: f64 = 1.0 - t;
                let n = of.degree() as i32;
                let terms = of.0.iter().enumerate();
                terms
                    .map(|(i, c)| c.midpoint().unwrap() * t.powi(i as i32) * rest.powi(n - i as i32))
                    .sum::<f64>()
            };
            for (made, truth) in [(p.times(&q), x * y), (p.plus(&q), x + y), (p.minus(&q), x - y)] {
                assert!((value(&made) - truth).abs() < 1e-13);
                let range = made.range();
                assert!(range.lo() - 1e-13 <= truth && truth <= range.hi() + 1e-13);
            }
            let step = 1e-6;
            let slope = (at(&a, t + step) - at(&a, t - step)) / (2.0 * step);
            assert!((value(&p.derivative()) - slope).abs() < 1e-7, "{slope}");
        }
    }
}
