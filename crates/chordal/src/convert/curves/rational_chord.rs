//! The deviation of a chord from a rational piece of a curve.
//!
//! Over `[a, b]` the piece is `X/W`, with polynomials of degree `n` in Bernstein form. With `A` and `B` its ends there and
//! `c = B − A`, the part of `G = X − A·W` across `c` vanishes at both ends; with coefficients `gᵢ` it is
//! `t(1−t)·Σ n(n−1)/(i(n−i))·gᵢ·Bᵢ₋₁ⁿ⁻²(t)`, so that the distance of the curve from the chord's line is at most a quarter
//! of the largest such term over the least weight. As for cubics ([`super::chord`]), the curve passes over every point of
//! the chord, and its points beyond an end lie beyond it by no more than the control points do.
//!
//! Without the direction of a chord, point `t` is compared with the chord's point at `t·Wₙ/((1−t)·W₀ + t·Wₙ)`: there the
//! coefficients are `gᵢ − i/n·Wₙ·c`, and `|c|` times the deviation of the weights from linear is added.
//!
//! *Equal steps.* The distance of a coefficient of degree `n` from the line between the end coefficients is at most
//! `i(n−i)/2` second differences, and those of a part of width `h` are at most `h²` times those of the whole piece. So both
//! forms are at most `n(n−1)/8·h²·(max|Δ²(X − C·W)| + 3R·max|Δ²W|)/min W`, `R` the largest distance of a control point
//! from `C`.
//!
//! *Rounding.* Coefficients of a part are weighted means, with an error of less than `8n·ε` of `R·W` in each coordinate. The
//! computations with them multiply that by `n/4` at most, and the division by the least weight by the ratio of weights; the
//! direction of the chord rotates by twice the error of its ends over its length, and is used only if no term is longer
//! than eight chords. All of it is below `64(n + 4)²·ε·R` times the ratio of weights, with `R` the sum over the axes.
use super::chord::{ChordDeviation, coordinate_reach, whole_steps};
use crate::explicit::nurbs::{BernsteinRow, RationalBezier};
use crate::math::{difference, dot, greater, length, lesser};

/// A rational piece with the values that all its deviation bounds share.
#[derive(Debug)]
pub(crate) struct RationalChords<'a, const D: usize> {
    curve: &'a RationalBezier<D>,
    /// The factor of `h²` in the bound for equal steps at the head of this file.
    bend: f64,
}

impl<'a, const D: usize> RationalChords<'a, D> {
    pub(crate) fn new(curve: &'a RationalBezier<D>) -> Self {
        let (x, w) = (&curve.weighted().0, &curve.weights().0);
        let centre = curve.ends()[0];
        let from_centre = |i: usize| -> [f64; D] { std::array::from_fn(|k| x[i][k] - centre[k] * w[i][0]) };
        let (mut of_points, mut of_weights, mut least, mut reach) = (0.0, 0.0, f64::INFINITY, 0.0);
        for i in 0..w.len() {
            least = lesser(w[i][0], least);
            reach = greater(length(from_centre(i)) / w[i][0], reach);
            if i + 2 < w.len() {
                let [a, b, c] = [i, i + 1, i + 2].map(from_centre);
                let second: [f64; D] = std::array::from_fn(|k| (a[k] - b[k]) - (b[k] - c[k]));
                of_points = greater(length(second), of_points);
                of_weights =
                    greater(((w[i][0] - w[i + 1][0]) - (w[i + 1][0] - w[i + 2][0])).abs(), of_weights);
            }
        }
        let n = curve.degree() as f64;
        Self { curve, bend: n * (n - 1.0) / 8.0 * (of_points + 3.0 * reach * of_weights) / least }
    }

    /// The number of equal steps that keeps the tolerance, as a float: it may be huge.
    pub(crate) fn even_steps(&self, tolerance: f64) -> f64 {
        whole_steps((self.bend / tolerance).sqrt())
    }

    pub(crate) fn curve(&self) -> &'a RationalBezier<D> {
        self.curve
    }

    /// The deviation of the chord between the points at `a` and `b`, in exact arithmetic.
    pub(crate) fn deviation(&self, a: f64, b: f64) -> ChordDeviation {
        let BernsteinRow(x) = self.curve.weighted().part(a, b);
        let BernsteinRow(w) = self.curve.weights().part(a, b);
        let n = x.len() - 1;
        let start: [f64; D] = x[0].map(|x| x / w[0][0]);
        let end: [f64; D] = x[n].map(|x| x / w[n][0]);
        let chord = difference(end, start);
        let length_sq = dot(chord, chord);
        let least = w.iter().fold(f64::INFINITY, |least, [w]| lesser(*w, least));
        let (mut pointwise, mut aside, mut beyond, mut longest_sq) = ([0.0, 0.5], [0.0, 0.5], 0.0, 0.0);
        for i in 1..n {
            let share = i as f64 / n as f64;
            let factor = (n * (n - 1)) as f64 / (4 * i * (n - i)) as f64;
            let g: [f64; D] = std::array::from_fn(|k| x[i][k] - start[k] * w[i][0]);
            let from_chord: [f64; D] = std::array::from_fn(|k| g[k] - share * w[n][0] * chord[k]);
            let from_linear = (w[i][0] - ((1.0 - share) * w[0][0] + share * w[n][0])).abs();
            let without_direction = factor * (length(from_chord) + length_sq.sqrt() * from_linear) / least;
            if without_direction > pointwise[0] {
                pointwise = [without_direction, share];
            }
            longest_sq = greater(dot(g, g) / (w[i][0] * w[i][0]), longest_sq);
            let along = dot(g, chord) / length_sq;
            let across: [f64; D] = std::array::from_fn(|k| g[k] - along * chord[k]);
            let across_chord = factor * length(across) / least;
            if across_chord > aside[0] {
                aside = [across_chord, share];
            }
            let place = along / w[i][0];
            beyond = greater(greater(-place, place - 1.0), beyond);
        }
        let [at_most, fraction] = pointwise;
        let pointwise = ChordDeviation { at_most, fraction };
        // Beyond eight chords the direction of the chord is too inaccurate.
        if !(longest_sq <= 64.0 * length_sq && length_sq > 0.0) {
            return pointwise;
        }
        let beyond = beyond * length_sq.sqrt();
        let [aside, fraction] = aside;
        let at_most = if beyond > 0.0 { (aside * aside + beyond * beyond).sqrt() } else { aside };
        if at_most < pointwise.at_most { ChordDeviation { at_most, fraction } } else { pointwise }
    }
}

/// The rounding error that may be added to the deviation of any chord of the piece.
pub(super) fn rounding<const D: usize>(curve: &RationalBezier<D>) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, 0.0);
    for [w] in &curve.weights().0 {
        (least, most) = (lesser(*w, least), greater(*w, most));
    }
    let n = (curve.degree() + 4) as f64;
    let mut points = curve.control();
    points.extend(curve.ends());
    let reach = coordinate_reach(&points);
    let rounding = 64.0 * n * n * f64::EPSILON * reach * (most / least);
    // As for cubics: squares of smaller lengths lose digits; with small weights, those of products lose them earlier.
    if reach == 0.0 { 0.0 } else { greater(rounding, 1e-150 * (most / least)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::nurbs::NurbsCurve;
    use chordal_testkit::Random;

    #[test]
    fn a_chord_of_a_quarter_is_its_sagitta_away() {
        let circle = NurbsCurve::circle([0.0; 2], [[1.0, 0.0], [0.0, 1.0]]).unwrap().to_curve().unwrap();
        let crate::explicit::CurveSegment::Rational(quarter) = &circle.segments()[0] else {
            panic!("a quarter")
        };
        let chords = RationalChords::new(quarter);
        let mut random = Random::new(4);
        for _ in 0..200 {
            let a = 0.9 * random.unit();
            let b = a + (1.0 - a) * random.unit();
            let [p, q] = [a, b].map(|t| quarter.at(t));
            let sagitta = 1.0 - ((p[0] + q[0]) * (p[0] + q[0]) + (p[1] + q[1]) * (p[1] + q[1])).sqrt() / 2.0;
            let found = chords.deviation(a, b).at_most;
            assert!(found >= sagitta - 1e-15 && found < sagitta * 1.5 + 1e-14, "{a} {b} {found} {sagitta}");
        }
    }
}
