//! `EnclosedPiece`: a piece of a curve in Bernstein form, with intervals that contain the exact coefficients.
//!
//! All proofs about curves start here: lengths (`check/curve_length`) and closest points
//! (`explicit/closest_point`).
use super::NurbsCurve;
use super::knots::KnotVector;
use crate::explicit::{Arc, CurveSegment};
use crate::math::{DoubleDouble, Interval, exponent, greater, power_of_two};

/// A polynomial over `[0, 1]` in Bernstein form; these intervals contain its exact coefficients.
#[derive(Clone, Debug)]
pub(crate) struct IntervalRow<const N: usize>(pub Vec<[Interval; N]>);

/// Half of every number.
fn half(x: Interval) -> Interval {
    // Halving is exact, except for subnormal numbers.
    let is_exact = |x: f64| x == 0.0 || x.abs() >= 4.0 * f64::MIN_POSITIVE;
    if is_exact(x.lo()) && is_exact(x.hi()) {
        Interval::from_bare(crate::math::BareInterval { lo: 0.5 * x.lo(), hi: 0.5 * x.hi() }, x.is_defined())
    } else {
        x * Interval::point(0.5)
    }
}

impl<const N: usize> IntervalRow<N> {
    pub fn degree(&self) -> usize {
        self.0.len() - 1
    }

    /// The row over the part from `a` to `b`, with `0 ≤ a < b ≤ 1`.
    pub fn part(&self, a: f64, b: f64) -> Self {
        let (one, from, to) = (Interval::point(1.0), Interval::point(a), Interval::point(b));
        let mut row = self.0.clone();
        if b < 1.0 {
            // The left ends of de Casteljau's levels.
            let complement = one - to;
            for first in 1..row.len() {
                for i in (first..row.len()).rev() {
                    row[i] = mean(&row[i - 1], &row[i], [complement, to]);
                }
            }
        }
        if a > 0.0 {
            // The right ends; `a` is at a/b of the part to `b`.
            let shares = [(to - from) / to, from / to];
            for last in (1..row.len()).rev() {
                for i in 0..last {
                    row[i] = mean(&row[i], &row[i + 1], shares);
                }
            }
        }
        Self(row)
    }

    /// The value in the middle.
    pub fn middle(&self) -> [Interval; N] {
        let mut row = self.0.clone();
        for last in (1..row.len()).rev() {
            for i in 0..last {
                row[i] = std::array::from_fn(|c| half(row[i][c] + row[i + 1][c]));
            }
        }
        row[0]
    }

    /// The derivative; `None` for a constant.
    pub fn derivative(&self) -> Option<Self> {
        let n = Interval::point(self.degree() as f64);
        let step = |pair: &[[Interval; N]]| std::array::from_fn(|c| n * (pair[1][c] - pair[0][c]));
        (self.degree() > 0).then(|| Self(self.0.windows(2).map(step).collect()))
    }

    /// An interval around all values of each coordinate: the hull of the coefficients.
    pub fn range(&self) -> [Interval; N] {
        self.0[1..].iter().fold(self.0[0], |hull, x| std::array::from_fn(|c| hull[c].hull(x[c])))
    }
}

fn mean<const N: usize>(
    a: &[Interval; N],
    b: &[Interval; N],
    [complement, part]: [Interval; 2],
) -> [Interval; N] {
    std::array::from_fn(|c| complement * a[c] + part * b[c])
}

/// The factors `C(n, i)·C(m, j)/C(n + m, i + j)` of coefficients `i` and `j` in the product of two
/// polynomials of degrees `n` and `m` in Bernstein form.
#[derive(Clone, Debug)]
pub(crate) struct BernsteinFactors(Vec<Vec<Interval>>);

impl BernsteinFactors {
    pub fn new(n: usize, m: usize) -> Self {
        let [of_first, of_second, of_both] = [n, m, n + m].map(binomials);
        let row = |i: usize| (0..=m).map(|j| of_first[i] * of_second[j] / of_both[i + j]).collect();
        Self((0..=n).map(row).collect())
    }

    /// The coefficients of a sum of products; `product` gives the product of coefficients `i` and `j`, and
    /// `None` adds nothing.
    pub fn products(&self, product: impl Fn(usize, usize) -> Option<Interval>) -> Vec<Interval> {
        let (n, m) = (self.0.len() - 1, self.0[0].len() - 1);
        let mut sums = vec![Interval::point(0.0); n + m + 1];
        for (i, row) in self.0.iter().enumerate() {
            for (j, factor) in row.iter().enumerate() {
                if let Some(x) = product(i, j) {
                    sums[i + j] = sums[i + j] + *factor * x;
                }
            }
        }
        sums
    }
}

/// The binomial coefficients `n` over 0 to `n`, exactly below 2⁵³.
pub(crate) fn binomials(n: usize) -> Vec<Interval> {
    let mut row = vec![Interval::point(1.0)];
    for _ in 0..n {
        let sum = |pair: &[Interval]| {
            let exact = pair[0].lo() + pair[1].lo();
            let is_exact = pair.iter().all(|x| x.lo() == x.hi()) && exact < 9e15;
            if is_exact { Interval::point(exact) } else { pair[0] + pair[1] }
        };
        let mut next = vec![Interval::point(1.0)];
        next.extend(row.windows(2).map(sum));
        next.push(Interval::point(1.0));
        row = next;
    }
    row
}

/// A piece `X(t)/W(t)`, or `X(t)` without weights, for `0 ≤ t ≤ 1`, relative to an origin.
#[derive(Clone, Debug)]
pub(crate) struct EnclosedPiece<const D: usize> {
    pub points: IntervalRow<D>,
    pub weights: Option<IntervalRow<1>>,
}

impl<const D: usize> EnclosedPiece<D> {
    fn polynomial(control: &[[f64; D]], origin: [f64; D]) -> Self {
        Self { points: IntervalRow(control.iter().map(|p| seen_from(origin, *p)).collect()), weights: None }
    }

    /// The pieces of a segment of a path, with its numbers taken as exact: one, or up to four for an arc.
    pub fn of_segment(segment: &CurveSegment<D>, origin: [f64; D]) -> Vec<Self> {
        match segment {
            CurveSegment::Line(ends) => vec![Self::polynomial(ends, origin)],
            CurveSegment::Cubic(cubic) => vec![Self::polynomial(&cubic.control, origin)],
            CurveSegment::Arc(arc) => {
                let n = arc_pieces(arc);
                (0..n).map(|k| Self::of_arc(arc, origin, [k, n])).collect()
            }
            CurveSegment::Rational(curve) => {
                let (x, w) = (&curve.weighted().0, &curve.weights().0);
                // Control points are stored times their weights, so the origin is multiplied by the
                // weight, too.
                let point = |(x, [w]): (&[f64; D], &[f64; 1])| {
                    std::array::from_fn(|c| difference_of_product(x[c], origin[c], *w))
                };
                let points = x.iter().zip(w).map(point).collect();
                let weights = w.iter().map(|[w]| [Interval::point(*w)]).collect();
                vec![Self { points: IntervalRow(points), weights: Some(IntervalRow(weights)) }]
            }
        }
    }

    /// Part `k` of `n` equal parts of an arc, as a rational quadratic.
    fn of_arc(arc: &Arc<D>, origin: [f64; D], [k, n]: [u32; 2]) -> Self {
        // Multiples of an eighth are exact.
        let angle = |part: f64| {
            Interval::point(arc.start_rad()) + Interval::point(arc.sweep_rad()) * Interval::point(part)
        };
        let part = |share: f64| (f64::from(k) + share) / f64::from(n);
        let [u, v] = arc.axes();
        let towards = |angle: Interval| -> [Interval; D] {
            let (sin, cos) = (Interval::sin(angle), Interval::cos(angle));
            std::array::from_fn(|c| cos * Interval::point(u[c]) + sin * Interval::point(v[c]))
        };
        let centre: [Interval; D] = seen_from(origin, arc.centre());
        let one = Interval::point(1.0);
        let corner = Interval::cos(Interval::point(arc.sweep_rad()) * Interval::point(0.5 / f64::from(n)));
        // The middle control point is 1/cos of the half angle away. Times its weight, which is that
        // cosine, it is the direction itself, so nothing is divided.
        let point = |share: f64, weight: Interval| -> [Interval; D] {
            let out = towards(angle(part(share)));
            std::array::from_fn(|c| weight * centre[c] + out[c])
        };
        let points = vec![point(0.0, one), point(0.5, corner), point(1.0, one)];
        Self { points: IntervalRow(points), weights: Some(IntervalRow(vec![[one], [corner], [one]])) }
    }

    /// The part from `a` to `b`, with `0 ≤ a < b ≤ 1`.
    pub fn part(&self, a: f64, b: f64) -> Self {
        Self { points: self.points.part(a, b), weights: self.weights.as_ref().map(|w| w.part(a, b)) }
    }

    /// Changes the unit of length, and divides the weights by a power of two so that the largest is at most
    /// 1.
    pub fn scale(&mut self, unit: Interval) {
        let mut points = unit;
        if let Some(weights) = &mut self.weights {
            let heaviest = weights.0.iter().fold(0.0, |heaviest: f64, [w]| greater(w.hi(), heaviest));
            let weight_unit = Interval::point(power_of_two(-exponent(heaviest)));
            weights.0.iter_mut().for_each(|[w]| *w = *w * weight_unit);
            points = points * weight_unit;
        }
        self.points.0.iter_mut().for_each(|x| *x = x.map(|x| x * points));
    }

    /// A piece of a spline between two knots.
    pub fn of_nurbs(curve: &NurbsCurve<D>, piece: usize, origin: [f64; D]) -> Self {
        let knots = curve.knots();
        let (p, span) = (knots.degree(), knots.span(piece));
        let points: Vec<[Interval; D]> =
            curve.control()[span - p..=span].iter().map(|p| seen_from(origin, *p)).collect();
        if curve.is_polynomial() {
            return Self { points: bezier_row(knots, span, &points), weights: None };
        }
        let weights: Vec<[Interval; 1]> =
            curve.weights()[span - p..=span].iter().map(|w| [Interval::point(*w)]).collect();
        let weighted: Vec<[Interval; D]> =
            points.iter().zip(&weights).map(|(x, [w])| x.map(|x| x * *w)).collect();
        Self { points: bezier_row(knots, span, &weighted), weights: Some(bezier_row(knots, span, &weights)) }
    }
}

/// The number of parts of an arc with at most about a quarter turn each, and ends at multiples of a power of
/// two.
pub(crate) fn arc_pieces<const D: usize>(arc: &Arc<D>) -> u32 {
    match arc.sweep_rad().abs() {
        // A little more than one and two quarter turns, so that rounding does not matter.
        sweep if sweep < 1.6 => 1,
        sweep if sweep < 3.2 => 2,
        _ => 4,
    }
}

fn seen_from<const D: usize>(origin: [f64; D], p: [f64; D]) -> [Interval; D] {
    std::array::from_fn(|c| Interval::point(p[c]) - Interval::point(origin[c]))
}

/// `x − a·b`, with the digits that a rounded product would lose.
fn difference_of_product(x: f64, a: f64, b: f64) -> Interval {
    let plain = Interval::point(x) - Interval::point(a) * Interval::point(b);
    // If the parts of the product neither underflow nor overflow, its error is a number. Derived: 2⁻¹⁰²² /
    // 2⁻¹⁰⁶ and 2¹⁰²³ / 2²⁸, with a margin.
    let is_safe = |x: f64| (1e-250..1e250).contains(&x.abs());
    if !(is_safe(a) && is_safe(b) && is_safe(a * b)) {
        return plain;
    }
    let product = DoubleDouble::two_product(a, b);
    let sum = DoubleDouble::two_sum(x, -product.hi);
    Interval::point(sum.hi) + (Interval::point(sum.lo) - Interval::point(product.lo))
}

/// The coefficients of a piece in Bernstein form by de Boor's algorithm.
fn bezier_row<const N: usize>(knots: &KnotVector, span: usize, control: &[[Interval; N]]) -> IntervalRow<N> {
    let (p, at) = (knots.degree(), |k: usize| Interval::point(knots.knots()[k]));
    let [a, b] = [at(span), at(span + 1)];
    let coefficient = |j: usize| {
        let mut row = control.to_vec();
        for r in 1..=p {
            // Coefficient j is the blossom with j arguments b and the others a.
            let t = if r - 1 < j { b } else { a };
            for i in (r..=p).rev() {
                let (low, high) = (at(span - p + i), at(span + 1 + i - r));
                let shares = [(high - t) / (high - low), (t - low) / (high - low)];
                row[i] = mean(&row[i - 1], &row[i], shares);
            }
        }
        row[p]
    };
    IntervalRow((0..=p).map(coefficient).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn parts_contain_the_values_and_are_narrow() {
        let mut random = Random::new(21);
        for _ in 0..200 {
            let control: Vec<[f64; 1]> = (0..2 + random.below(5)).map(|_| random.point()).collect();
            let row = IntervalRow(control.iter().map(|[x]| [Interval::point(*x)]).collect());
            let exact = super::super::BernsteinRow(control.clone());
            let (a, b) = (random.between(0.1, 0.5), random.between(0.5, 0.9));
            for [from, to] in [[a, b], [0.0, a], [b, 1.0], [0.0, 1.0]] {
                let part = row.part(from, to);
                let [middle] = part.middle();
                let value = exact.at(0.5 * (from + to))[0];
                assert!((middle.midpoint().unwrap() - value).abs() < 1e-14 && middle.width() < 1e-14);
                let [range] = part.range();
                (0..=8).for_each(|k| {
                    let [value] = exact.at(from + (to - from) * f64::from(k) / 8.0);
                    assert!(range.lo() - 1e-15 <= value && value <= range.hi() + 1e-15);
                });
            }
        }
    }

    #[test]
    fn factors_multiply_polynomials_in_bernstein_form() {
        // t·(1 − t) = 0·B₀ + ½·B₁ + 0·B₂.
        let factors = BernsteinFactors::new(1, 1);
        let (a, b) = ([0.0, 1.0], [1.0, 0.0]);
        let products = factors.products(|i, j| Some(Interval::point(a[i] * b[j])));
        assert!(products[0].contains(0.0) && products[1].contains(0.5) && products[2].contains(0.0));
        // 60 over 30, which f64 cannot represent.
        let middle = binomials(60)[30];
        assert!(middle.lo() <= 118_264_581_564_861_424.0 && middle.hi() >= 118_264_581_564_861_424.0);
        assert!(middle.width() < 1e4);
    }
}
