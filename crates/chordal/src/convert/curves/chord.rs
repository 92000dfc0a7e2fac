//! `ChordDeviation`: a bound on the distance between a piece of a curve and its chord.
//!
//! *A cubic over `[a, b]`.* With `D0 = h²·P''(a)/6`, `D1 = h²·P''(b)/6`, `h = b − a`, the difference between the
//! curve at the fraction `t` of the piece and the chord's point at `t` is exactly
//! `−t(1−t)·[(2−t)·D0 + (1+t)·D1]`. With `u = 2t − 1`, `s = D0 + D1`, `q = D1 − D0` its length is
//! `(1−u²)/4·|3s/2 + u·q/2|`, which is at most `(1−u²)(3|s| + |u||q|)/8`, and largest at `u = √(r² + 1/3) − r`
//! for `r = |s|/|q|`.
//!
//! ```text
//!            . - ~ - .                s, q: the curve's deviation; `across` and `along` are relative to
//!         .´     |     `.             the chord. Points between the ends are compared across the chord,
//!   P(a) o-------+-------o P(b) )     points beyond an end across and along.
//!                chord       beyond
//! ```
//!
//! *The distance.* Along the chord, the curve starts at 0 and ends at the chord's length `L`, so it passes over
//! every point of the chord: each of them has a point of the curve perpendicular to the chord. So with the parts
//! of `s` and `q` across the chord, the formula bounds the distance from the chord to the curve, and that from
//! the curve to the chord for the points between the ends. Other points lie beyond an end by no more than the two
//! inner control points do: there the two distances are the legs of a right triangle. The formula with the whole
//! of `s` and `q` needs no chord and bounds both directions too, for points of equal parameter. The smaller of
//! the two bounds is used.
//!
//! *An arc of an ellipse* of half the angle `δ ≤ π/2` about the middle angle `m`: with `w = centre → middle`,
//! `v` the derivative there by angle, the difference between the curve at `m + φ` and the chord's point at
//! `sin φ/sin δ` is exactly `(cos φ − cos δ)·w`, so at most `(1 − cos δ)|w|`; across the chord, which runs along
//! `v`, it is that with the part of `w` across. The arc stays between the ends if `|v|·cos δ ≥ |w·v|/|v|·sin δ`.
//!
//! *Rounding.* The ends of a chord are evaluated with an error of at most `η = 16 ε·R`, `R` the sum over the
//! axes of the largest control coordinate (12 roundings of half a step in each coordinate of a cubic; for an
//! arc two units in the last place of sine and cosine, half a unit of an angle below 8π, and six roundings).
//! `D0` and `D1` are sums of six products with weights that add up to 8, which `h² ≤ 1` does not enlarge: the
//! error of each is less than `32 ε·R`. The error of the chord's direction is `2η/L` and rotates `s` and `q` by
//! that; if they are longer than 8 chords the form without a chord is used, so that this adds less than
//! `8·2·2η`. For an arc by its ends, the error of `v` is `4ε(|φ||w| + |v|)`, which is at most the part of 16
//! chords, and in all less than `256 ε·R`. The error of the arithmetic after that is less than 32 ε of lengths
//! below `8R`. All of it is below `1024 ε·R`.
use crate::explicit::{Arc, ArcPart, Bezier};
use crate::math::{difference, dot, greater, length};

/// The rounding error of a deviation bound, in units of ε times [`coordinate_reach`]: derived above.
const ROUNDING: f64 = 1024.0;

/// The deviation bound of a chord, and the fraction of the piece up to the farthest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChordDeviation {
    pub(crate) at_most: f64,
    pub(crate) fraction: f64,
}

/// The sum over the axes of the largest coordinates of `points`.
pub(crate) fn coordinate_reach<const D: usize>(points: &[[f64; D]]) -> f64 {
    (0..D)
        .map(|k| points.iter().fold(0.0, |most: f64, p| greater(p[k].abs(), most)))
        .fold(0.0, |sum, x| sum + x)
}

/// `a` without its part along `c`, whose square length is `c_sq`.
fn across<const D: usize>(a: [f64; D], c: [f64; D], c_sq: f64) -> [f64; D] {
    let along = dot(a, c) / c_sq;
    std::array::from_fn(|k| a[k] - along * c[k])
}

/// A cubic with the values that all its deviation bounds share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CubicChords<'a, const D: usize> {
    cubic: &'a Bezier<D>,
    /// A sixth of the second derivative at both ends.
    second_differences: [[f64; D]; 2],
}

impl<'a, const D: usize> CubicChords<'a, D> {
    pub(crate) fn new(cubic: &'a Bezier<D>) -> Self {
        let p = &cubic.control;
        let second =
            |i: usize| std::array::from_fn(|k| (p[i][k] - p[i + 1][k]) - (p[i + 1][k] - p[i + 2][k]));
        Self { cubic, second_differences: [second(0), second(1)] }
    }

    pub(crate) fn cubic(&self) -> &'a Bezier<D> {
        self.cubic
    }

    /// A sixth of the second derivative at both ends.
    pub(crate) fn second_differences(&self) -> [[f64; D]; 2] {
        self.second_differences
    }

    /// The largest second difference, as a length.
    pub(crate) fn largest_second_difference(&self) -> f64 {
        let [a, b] = self.second_differences.map(|d| dot(d, d));
        if a > b { a.sqrt() } else { b.sqrt() }
    }

    /// The number of equal steps that keeps the tolerance, as a float: it may be huge.
    pub(crate) fn even_steps(&self, tolerance: f64) -> f64 {
        wang_steps(self.largest_second_difference(), tolerance)
    }

    /// The deviation of the chord between the points at `a` and `b`, in exact arithmetic.
    pub(crate) fn deviation(&self, a: f64, b: f64) -> ChordDeviation {
        let (start, end) = (self.cubic.at(a), self.cubic.at(b));
        let chord = difference(end, start);
        let h = b - a;
        let bend_at = |t: f64| -> [f64; D] {
            std::array::from_fn(|k| {
                (h * h) * ((1.0 - t) * self.second_differences[0][k] + t * self.second_differences[1][k])
            })
        };
        chord_deviation(chord, bend_at(a), bend_at(b))
    }
}

/// The number of equal steps that keeps the tolerance if the largest second difference is `bend` (G. Wang,
/// 1984).
#[inline(always)]
pub(crate) fn wang_steps(bend: f64, tolerance: f64) -> f64 {
    whole_steps((0.75 * bend / tolerance).sqrt())
}

/// Rounds a computed number of equal steps up to a whole number.
#[inline(always)]
pub(crate) fn whole_steps(steps: f64) -> f64 {
    // The steps between rounded parameters `i/n` differ by up to `ε·n` of themselves, twice that in the
    // deviation; the formulas for the steps and for the deviation lose less than 32 ε.
    let steps = (steps * (1.0 + f64::EPSILON * (32.0 + 4.0 * steps))).ceil();
    // A NaN comes from a second difference that is not finite, and means infinitely many steps.
    if steps <= 1.0 {
        1.0
    } else if steps.is_nan() {
        f64::INFINITY
    } else {
        steps
    }
}

/// The rounding error of a deviation bound for a curve of this [`coordinate_reach`].
#[inline(always)]
pub(crate) fn rounding_at(reach: f64) -> f64 {
    if reach == 0.0 {
        return 0.0;
    }
    // Squares of lengths below 1e-154 lose digits or vanish, so lengths below 1e-150 are not distinguished
    // from 0.
    let least = 1e-150;
    let rounding = ROUNDING * f64::EPSILON * reach;
    greater(rounding, least)
}

/// The deviation of a chord, from the chord, `D0` and `D1`.
fn chord_deviation<const D: usize>(chord: [f64; D], d0: [f64; D], d1: [f64; D]) -> ChordDeviation {
    let s: [f64; D] = std::array::from_fn(|k| d0[k] + d1[k]);
    let q = difference(d1, d0);
    let pointwise = largest_deviation(s, q);
    let length_sq = dot(chord, chord);
    let (n0, n1) = (dot(d0, d0), dot(d1, d1));
    let longest_sq = greater(n0, n1);
    // Beyond eight chords the direction of the chord is too inaccurate: see the head of this file.
    if !(longest_sq <= 64.0 * length_sq && length_sq > 0.0) {
        return pointwise;
    }
    let aside = largest_deviation(across(s, chord, length_sq), across(q, chord, length_sq));
    // The inner control points along the chord, from its start, in units of its square length.
    let (x0, x1) = (dot(d0, chord), dot(d1, chord));
    let first = (length_sq - 2.0 * x0 - x1) / 3.0;
    let second = length_sq - (length_sq + x0 + 2.0 * x1) / 3.0;
    let beyond = [-first, first - length_sq, -second, second - length_sq]
        .into_iter()
        .fold(0.0, |most, x| greater(x, most))
        / length_sq.sqrt();
    let at_most =
        if beyond > 0.0 { (aside.at_most * aside.at_most + beyond * beyond).sqrt() } else { aside.at_most };
    if at_most < pointwise.at_most { ChordDeviation { at_most, ..aside } } else { pointwise }
}

/// The largest `(1−u²)(3|s| + |u||q|)/8` and its fraction of the piece.
fn largest_deviation<const D: usize>(s: [f64; D], q: [f64; D]) -> ChordDeviation {
    let (s_len, q_len) = (length(s), length(q));
    if q_len == 0.0 {
        return ChordDeviation { at_most: 0.375 * s_len, fraction: 0.5 };
    }
    let r = s_len / q_len;
    // √(r² + 1/3) − r without cancellation; a ratio beyond the range of squares means that q is negligible.
    let u = if r < 1e100 { 1.0 / (3.0 * ((r * r + 1.0 / 3.0).sqrt() + r)) } else { 0.0 };
    let at_most = (1.0 - u * u) * (3.0 * s_len + u * q_len) / 8.0;
    let signed = if dot(s, q) < 0.0 { -u } else { u };
    ChordDeviation { at_most, fraction: 0.5 + 0.5 * signed }
}

/// The deviation of the chord of an arc between the parameters `a` and `b`, in exact arithmetic.
pub(crate) fn arc_deviation<const D: usize>(arc: &Arc<D>, a: f64, b: f64) -> ChordDeviation {
    let ArcPart { half_rad: half, to_middle: w, along: v } = arc.part_about_middle(a, b);
    if half > std::f64::consts::FRAC_PI_2 {
        return ChordDeviation { at_most: f64::INFINITY, fraction: 0.5 };
    }
    let sin_quarter = libm::sin(0.5 * half);
    let sagitta = 2.0 * sin_quarter * sin_quarter;
    let (w_sq, v_sq) = (dot(w, w), dot(v, v));
    let (sin, cos) = libm::sincos(half);
    let stays = v_sq * cos >= dot(w, v).abs() * sin;
    // As for cubics: a chord that is short compared with the deviation across it has no reliable direction.
    let has_direction = sagitta * sagitta * w_sq <= 64.0 * (4.0 * sin * sin * v_sq) && v_sq > 0.0;
    let reach_sq = if stays && has_direction {
        let aside = across(w, v, v_sq);
        dot(aside, aside)
    } else {
        w_sq
    };
    ChordDeviation { at_most: sagitta * reach_sq.sqrt(), fraction: 0.5 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    /// The two-sided distance of a piece and its chord, by 2000 samples of both.
    fn sampled(cubic: &Bezier<2>, a: f64, b: f64) -> f64 {
        let n = 2000;
        let curve: Vec<_> = (0..=n).map(|i| cubic.at(a + (b - a) * f64::from(i) / f64::from(n))).collect();
        let (p, q) = (cubic.at(a), cubic.at(b));
        let to_chord = |x: [f64; 2]| {
            let c = [q[0] - p[0], q[1] - p[1]];
            let d = [x[0] - p[0], x[1] - p[1]];
            let t = if dot(c, c) > 0.0 { (dot(c, d) / dot(c, c)).clamp(0.0, 1.0) } else { 0.0 };
            (d[0] - t * c[0]).hypot(d[1] - t * c[1])
        };
        curve.iter().map(|x| to_chord(*x)).fold(0.0, f64::max)
    }

    #[test]
    fn a_parabola_loses_three_quarters_of_its_second_difference() {
        let cubic = Bezier { control: [[0.0, 0.0], [1.0, 1.0], [2.0, 1.0], [3.0, 0.0]] };
        let loss = CubicChords::new(&cubic).deviation(0.0, 1.0);
        assert_eq!(loss, ChordDeviation { at_most: 0.75, fraction: 0.5 });
        // A quarter of the length, a sixteenth of the deviation, times the cosine of the chord's slope of
        // 3/16 · 4 in 3.
        let part = CubicChords::new(&cubic).deviation(0.25, 0.5).at_most;
        let (x, y) = (0.75, cubic.at(0.5)[1] - cubic.at(0.25)[1]);
        let true_loss = 0.75 / 16.0 * x / f64::hypot(x, y);
        assert!((part / true_loss - 1.0).abs() < 1e-15, "{part} {true_loss}");
    }

    #[test]
    fn a_certificate_is_never_low_and_close_where_the_curve_does_not_turn_back() {
        let mut random = Random::new(1);
        let mut ratios = Vec::new();
        for _ in 0..3000 {
            let cubic = Bezier { control: std::array::from_fn(|_| [0; 2].map(|_| random.unit())) };
            let (x, y) = (random.unit(), random.unit());
            let (a, b) = if x < y { (x, y) } else { (y, x) };
            let (bound, truth) = (CubicChords::new(&cubic).deviation(a, b).at_most, sampled(&cubic, a, b));
            assert!(truth <= bound + ROUNDING * f64::EPSILON * 2.0, "{cubic:?} {a} {b}: {truth} > {bound}");
            ratios.push(bound / truth);
        }
        ratios.sort_by(f64::total_cmp);
        assert!(ratios[1500] < 1.02, "median {}", ratios[1500]);
    }

    #[test]
    fn a_chord_of_a_circle_loses_its_sagitta() {
        let circle = Arc::new([5.0, 5.0], [[2.0, 0.0], [0.0, 2.0]], 0.3, 6.0).unwrap();
        for n in [3, 7, 64, 1000] {
            let sagitta = 2.0 * (1.0 - libm::cos(3.0 / f64::from(n)));
            let loss = arc_deviation(&circle, 1.0 / f64::from(n), 2.0 / f64::from(n)).at_most;
            assert!((loss / sagitta - 1.0).abs() < 1e-9, "{n}: {loss} {sagitta}");
        }
        assert_eq!(arc_deviation(&circle, 0.0, 1.0).at_most, f64::INFINITY);
    }
}
