//! Places the chords of rational pieces by a density, a block of chords at a time.
//!
//! The deviations are those of [`super::rational_chord`], with loops over the chords of a block innermost, so that they
//! are compiled to vector instructions.
use super::chord::{ChordDeviation, whole_steps};
use super::density::{LANES, Spreadable};
use super::rational_chord::RationalChords;
use crate::explicit::nurbs::RationalBezier;
use crate::math::{dot, greater, length, lesser};

/// A number for each chord of a block.
type Lane = [f64; LANES];

/// Samples of the density by which the grid is chosen. Chosen: half of those of the coarsest grid.
const PROBES: u32 = 4;

impl<const D: usize> Spreadable<D> for RationalChords<'_, D> {
    /// By the largest of a few densities, since the formula for equal steps may give far too many for unequal weights.
    fn about_even_steps(&self, tolerance: f64) -> f64 {
        let densest = (0..PROBES)
            .fold(0.0, |most, i| greater(self.density((f64::from(i) + 0.5) / f64::from(PROBES)), most));
        lesser(whole_steps(densest / (8.0 * tolerance).sqrt()), self.even_steps(tolerance))
    }

    fn deviation(&self, a: f64, b: f64) -> ChordDeviation {
        self.deviation(a, b)
    }

    fn density(&self, t: f64) -> f64 {
        let [first, second] = self.curve().derivatives(t);
        let first_sq = dot(first, first);
        // If the derivative vanishes there is no direction.
        let along = if first_sq > 0.0 { dot(first, second) / first_sq } else { 0.0 };
        let across: [f64; D] = std::array::from_fn(|k| second[k] - along * first[k]);
        length(across).sqrt()
    }

    /// Does nothing: `certify` computes the ends of the chords itself.
    #[inline(always)]
    fn evaluate(&self, _: &[f64], _: &mut [Vec<f64>; D]) {}

    /// Leaves rare degrees to [`Self::deviation`].
    #[inline(always)]
    fn certify(&self, places: &[f64], _: &[Vec<f64>; D], _: f64, deviations: &mut [f64]) {
        match self.curve().degree() {
            2 => block_deviations::<D, 3>(self.curve(), places, deviations),
            3 => block_deviations::<D, 4>(self.curve(), places, deviations),
            4 => block_deviations::<D, 5>(self.curve(), places, deviations),
            5 => block_deviations::<D, 6>(self.curve(), places, deviations),
            _ => deviations.fill(f64::INFINITY),
        }
    }
}

/// The deviations of whole blocks of chords of a piece with `C` control points.
#[inline(always)]
fn block_deviations<const D: usize, const C: usize>(
    curve: &RationalBezier<D>,
    places: &[f64],
    deviations: &mut [f64],
) {
    let points: [[Lane; D]; C] = std::array::from_fn(|i| curve.weighted().0[i].map(|x| [x; LANES]));
    let weights: [[Lane; 1]; C] = std::array::from_fn(|i| curve.weights().0[i].map(|w| [w; LANES]));
    for at in (0..deviations.len()).step_by(LANES) {
        let (mut from, mut to) = ([0.0; LANES], [0.0; LANES]);
        from.copy_from_slice(&places[at..at + LANES]);
        to.copy_from_slice(&places[at + 1..at + 1 + LANES]);
        let (x, w) = (parts(&points, [&from, &to]), parts(&weights, [&from, &to]));
        deviations[at..at + LANES].copy_from_slice(&part_deviations(&x, &w));
    }
}

/// The coefficients over the part of each chord, with the arithmetic of `BernsteinRow::part`.
#[inline(always)]
fn parts<const N: usize, const C: usize>(whole: &[[Lane; N]; C], [from, to]: [&Lane; 2]) -> [[Lane; N]; C] {
    let mut row = *whole;
    for k in (0..C).rev() {
        let mut rest = row;
        for n in (1..=k).rev() {
            step(&mut rest, n, to);
        }
        step(&mut row, k, from);
        row[k] = rest[0];
    }
    row
}

/// One step of de Casteljau's algorithm: turns `n + 1` coefficients into `n`.
// With iterators over nested arrays the loops are not compiled to vector instructions: three times slower.
#[allow(clippy::needless_range_loop)]
#[inline(always)]
fn step<const N: usize, const C: usize>(row: &mut [[Lane; N]; C], n: usize, t: &Lane) {
    for i in 0..n {
        for k in 0..N {
            for l in 0..LANES {
                row[i][k][l] = (1.0 - t[l]) * row[i][k][l] + t[l] * row[i + 1][k][l];
            }
        }
    }
}

/// `RationalChords::deviation` of each chord of a block.
#[inline(always)]
fn part_deviations<const D: usize, const C: usize>(x: &[[Lane; D]; C], w: &[[Lane; 1]; C]) -> Lane {
    let n = C - 1;
    let (mut start, mut chord, mut length_sq, mut least) =
        ([[0.0; LANES]; D], [[0.0; LANES]; D], [0.0; LANES], w[0][0]);
    for l in 0..LANES {
        for k in 0..D {
            start[k][l] = x[0][k][l] / w[0][0][l];
            chord[k][l] = x[n][k][l] / w[n][0][l] - start[k][l];
            length_sq[l] += chord[k][l] * chord[k][l];
        }
    }
    for [w] in w {
        for l in 0..LANES {
            least[l] = lesser(w[l], least[l]);
        }
    }
    let (mut pointwise, mut aside) = ([0.0; LANES], [0.0; LANES]);
    let (mut beyond, mut longest_sq) = ([0.0; LANES], [0.0; LANES]);
    for i in 1..n {
        let part = i as f64 / n as f64;
        let times = (n * (n - 1)) as f64 / (4 * i * (n - i)) as f64;
        for l in 0..LANES {
            let (first, here, last) = (w[0][0][l], w[i][0][l], w[n][0][l]);
            let (mut g, mut off_sq, mut g_sq, mut along, mut across_sq) = ([0.0; D], 0.0, 0.0, 0.0, 0.0);
            for k in 0..D {
                g[k] = x[i][k][l] - start[k][l] * here;
                let from_chord = g[k] - part * last * chord[k][l];
                off_sq += from_chord * from_chord;
                g_sq += g[k] * g[k];
                along += g[k] * chord[k][l];
            }
            let along = along / length_sq[l];
            for k in 0..D {
                let across = g[k] - along * chord[k][l];
                across_sq += across * across;
            }
            let from_linear = (here - ((1.0 - part) * first + part * last)).abs();
            let both = times * (off_sq.sqrt() + length_sq[l].sqrt() * from_linear) / least[l];
            pointwise[l] = greater(both, pointwise[l]);
            aside[l] = greater(times * across_sq.sqrt() / least[l], aside[l]);
            longest_sq[l] = greater(g_sq / (here * here), longest_sq[l]);
            let place = along / here;
            beyond[l] = greater(greater(-place, place - 1.0), beyond[l]);
        }
    }
    let mut deviations = [0.0; LANES];
    for l in 0..LANES {
        let beyond_sq = beyond[l] * beyond[l] * length_sq[l];
        let by_chord = (aside[l] * aside[l] + beyond_sq).sqrt();
        // Beyond eight chords the direction of the chord is too inaccurate.
        let has_direction = (longest_sq[l] <= 64.0 * length_sq[l]) & (length_sq[l] > 0.0);
        deviations[l] = if has_direction { lesser(by_chord, pointwise[l]) } else { pointwise[l] };
    }
    deviations
}
