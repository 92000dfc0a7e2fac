//! Places the chords of cubics by a density, a block of chords at a time.
//!
//! Loops run over slices, so that they are compiled to vector instructions.
use super::chord::{ChordDeviation, CubicChords};
use super::density::{LANES, Spreadable};
use crate::explicit::bernstein;
use crate::math::greater;

impl<const D: usize> Spreadable<D> for CubicChords<'_, D> {
    #[inline(always)]
    fn about_even_steps(&self, tolerance: f64) -> f64 {
        self.even_steps(tolerance)
    }

    #[inline(always)]
    fn deviation(&self, a: f64, b: f64) -> ChordDeviation {
        self.deviation(a, b)
    }

    #[inline(always)]
    fn density(&self, t: f64) -> f64 {
        let p = &self.cubic().control;
        let s = 1.0 - t;
        let (mut first_sq, mut both, mut first, mut second) = (0.0, 0.0, [0.0; D], [0.0; D]);
        for k in 0..D {
            let e = [p[1][k] - p[0][k], p[2][k] - p[1][k], p[3][k] - p[2][k]];
            first[k] = s * (s * e[0] + t * e[1]) + t * (s * e[1] + t * e[2]);
            second[k] = s * (e[1] - e[0]) + t * (e[2] - e[1]);
            first_sq += first[k] * first[k];
            both += first[k] * second[k];
        }
        // If the derivative vanishes there is no direction, and 0/0 would spoil the sum.
        let along = if first_sq > 0.0 { both / first_sq } else { 0.0 };
        let mut across_sq = 0.0;
        for k in 0..D {
            let across = second[k] - along * first[k];
            across_sq += across * across;
        }
        // P'' is 6 times `second`.
        (6.0 * across_sq.sqrt()).sqrt()
    }

    /// Bit for bit the numbers of `Bezier::at`.
    #[inline(always)]
    fn evaluate(&self, places: &[f64], axes: &mut [Vec<f64>; D]) {
        let [p0, p1, p2, p3] = self.cubic().control;
        for at in (0..places.len()).step_by(LANES) {
            let mut block = [0.0; LANES];
            block.copy_from_slice(&places[at..at + LANES]);
            for (k, axis) in axes.iter_mut().enumerate() {
                let mut x = [0.0; LANES];
                for i in 0..LANES {
                    let [w0, w1, w2, w3] = bernstein(block[i]);
                    x[i] = (w0 * p0[k] + w1 * p1[k]) + (w2 * p2[k] + w3 * p3[k]);
                }
                axis[at..at + LANES].copy_from_slice(&x);
            }
        }
    }

    /// Leaves two kinds of chords to `chord.rs`: those that are short compared with the deviation across them, and those
    /// beyond whose ends the curve extends and that miss the tolerance, for which the form without a chord may be better.
    #[inline(always)]
    fn certify(&self, places: &[f64], axes: &[Vec<f64>; D], tolerance: f64, deviations: &mut [f64]) {
        for at in (0..deviations.len()).step_by(LANES) {
            let ends = lanes(places, at);
            let axes: [[[f64; LANES]; 2]; D] = std::array::from_fn(|k| lanes(&axes[k], at));
            let block = simple_deviations(self.second_differences(), ends, &axes, tolerance);
            deviations[at..at + LANES].copy_from_slice(&block);
        }
    }
}

/// The starts and the ends of a block of chords.
#[inline(always)]
fn lanes(list: &[f64], at: usize) -> [[f64; LANES]; 2] {
    let (mut from, mut to) = ([0.0; LANES], [0.0; LANES]);
    from.copy_from_slice(&list[at..at + LANES]);
    to.copy_from_slice(&list[at + 1..at + 1 + LANES]);
    [from, to]
}

/// See [`Spreadable::certify`]: infinite for chords that it does not handle.
#[inline(always)]
fn simple_deviations<const D: usize>(
    [a0, a1]: [[f64; D]; 2],
    [from, to]: [[f64; LANES]; 2],
    axes: &[[[f64; LANES]; 2]; D],
    tolerance: f64,
) -> [f64; LANES] {
    let mut deviations = [0.0; LANES];
    for i in 0..LANES {
        let (a, b) = (from[i], to[i]);
        let h = b - a;
        let h_sq = h * h;
        let (mut s, mut q, mut c) = ([0.0; D], [0.0; D], [0.0; D]);
        let (mut s_along, mut q_along, mut c_sq, mut sq_all) = (0.0, 0.0, 0.0, 0.0);
        for k in 0..D {
            let d0 = h_sq * ((1.0 - a) * a0[k] + a * a1[k]);
            let d1 = h_sq * ((1.0 - b) * a0[k] + b * a1[k]);
            s[k] = d0 + d1;
            q[k] = d1 - d0;
            c[k] = axes[k][1][i] - axes[k][0][i];
            s_along += s[k] * c[k];
            q_along += q[k] * c[k];
            c_sq += c[k] * c[k];
            sq_all += s[k] * s[k] + q[k] * q[k];
        }
        let inverse = 1.0 / c_sq;
        let (s_share, q_share) = (s_along * inverse, q_along * inverse);
        let (mut s_sq, mut q_sq) = (0.0, 0.0);
        for k in 0..D {
            let (x, y) = (s[k] - s_share * c[k], q[k] - q_share * c[k]);
            s_sq += x * x;
            q_sq += y * y;
        }
        // Like `largest_deviation` of chord.rs, with u = q/(3·(√(s² + q²/3) + s)), which needs no quotient of
        // the two.
        let (s_len, q_len) = (s_sq.sqrt(), q_sq.sqrt());
        let below = (s_sq + q_sq * (1.0 / 3.0)).sqrt() + s_len;
        let u = if below > 0.0 { q_len / (3.0 * below) } else { 0.0 };
        let aside = (1.0 - u * u) * (3.0 * s_len + u * q_len) * 0.125;
        // The positions of the inner control points along the chord, in thirds of its length, as distances from
        // its middle; and by how much the farther one is beyond an end.
        let first = (0.5 * (3.0 * s_share - q_share) + 0.5).abs();
        let last = (0.5 * (3.0 * s_share + q_share) - 0.5).abs();
        let far = greater(first, last);
        let beyond_sq = if far > 1.5 { (far - 1.5) * (far - 1.5) * c_sq * (1.0 / 9.0) } else { 0.0 };
        let loss = (aside * aside + beyond_sq).sqrt();
        let is_handled = (c_sq > 0.0) & (sq_all <= 128.0 * c_sq) & ((beyond_sq == 0.0) | (loss <= tolerance));
        deviations[i] = if is_handled { loss } else { f64::INFINITY };
    }
    deviations
}
