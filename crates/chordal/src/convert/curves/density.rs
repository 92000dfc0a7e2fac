//! The fast way to place chord ends: spread them by a density, check all chords at once, correct the density.
//!
//! A chord of width `h` in the parameter deviates by about `h²·|v|/8`, where `v` is the part of `P''` across
//! `P'`. So a curve needs about `∫ √(|v|/(8·tolerance)) dt` chords, spread by that density
//! (equidistribution). The density is sampled at the nodes of a grid, and a monotone cubic interpolates its
//! sums. Then the deviation of every chord is bounded. Where a chord fails, the square roots of the
//! deviations are a better density than the first one, since they include whatever the samples missed. Curves
//! that fail four times are left to the greedy method.
//!
//! Loops run over slices, all chords at once, so that they are compiled to vector instructions.
use super::chord::CubicChords;
use crate::explicit::{Bezier, bernstein};
use crate::math::{greater, lesser};

/// Intervals of the grid, one less than a multiple of [`LANES`]: for a few chords, for some, and at most; in
/// between half as many as there are chords. With fewer for some, the first spread fails more often; with
/// more, it costs more than it saves (20,000 random cubics at a thousandth of their box).
const COARSEST: usize = 7;
const GRID: usize = 15;
const FINEST: usize = 4096;
/// The number of spreads that are tried before the greedy method, which then gets 0.1 % to 5 % of random
/// cubics.
const ATTEMPTS: usize = 4;
/// A little more than the density requires, since it knows no chord: a third of a percent more segments, and
/// a tenth fewer second spreads.
const SPARE: f64 = 1.003;
/// A chord whose root of relative deviation is below this is treated as one where the curve has an
/// inflection. Measured: 0.7 and 0.85 leave as few to a fourth spread; without it a fifth more get there.
const FLAT: f64 = 0.85;
/// Chords that use less than this fraction of their tolerance, on average and with one chord to spare, are
/// placed again by the greedy method.
const WASTE: f64 = 0.85;
/// The largest number of chords for which one fewer is tried.
const FEW: usize = 12;

/// Buffers that are reused from curve to curve. The lists only ever grow; `n` says how much of them is valid.
#[derive(Clone, Debug)]
pub(crate) struct FlattenScratch<const D: usize> {
    /// The number of chords.
    n: usize,
    /// The parameters of the chord ends.
    places: Vec<f64>,
    /// The positions of the chord ends, a list for each axis: the numbers that `Bezier::at` gives.
    axes: [Vec<f64>; D],
    /// An upper bound of each chord's deviation.
    deviations: Vec<f64>,
    /// The data for the next placement: parameters, the wanted number of chords up to each, and the slopes of
    /// the first by the second.
    nodes: Vec<f64>,
    shares: Vec<f64>,
    slopes: Vec<f64>,
    n_nodes: usize,
}

impl<const D: usize> Default for FlattenScratch<D> {
    fn default() -> Self {
        let list = Vec::new;
        Self {
            n: 0,
            places: list(),
            axes: std::array::from_fn(|_| list()),
            deviations: list(),
            nodes: list(),
            shares: list(),
            slopes: list(),
            n_nodes: 0,
        }
    }
}

/// Fills `work` with chords of at most `tolerance`, nearly as few as possible, and returns the largest
/// deviation. `None` when that did not succeed or would take more than `most` chords.
#[inline(always)]
pub(crate) fn spread_by_density<const D: usize>(
    chords: &CubicChords<'_, D>,
    tolerance: f64,
    most: usize,
    work: &mut FlattenScratch<D>,
) -> Option<f64> {
    let cubic = chords.cubic();
    let whole = chords.deviation(0.0, 1.0).at_most;
    if whole <= tolerance {
        work.set_single_chord(cubic);
        return Some(whole);
    }
    // Equal steps would be about twice as many.
    let even = chords.even_steps(tolerance);
    let grid = if even <= 5.0 {
        COARSEST
    } else if even <= 60.0 {
        GRID
    } else if even < 4.0 * FINEST as f64 {
        (even as usize / 4).next_multiple_of(LANES) - 1
    } else {
        FINEST - 1
    };
    let needed = work.sample(cubic, grid) / (8.0 * tolerance).sqrt();
    // One chord was not enough, whatever the samples say; a NaN is handled in the same way.
    let mut n = if needed > 1.0 { (SPARE * needed).ceil() } else { 2.0 };
    if n > most as f64 {
        return None;
    }
    work.place_equal_shares(n as usize);
    for attempt in 0..ATTEMPTS {
        work.evaluate(cubic);
        let worst = work.certify(chords, tolerance);
        if worst <= tolerance {
            let worst = work.try_one_fewer(chords, tolerance, worst);
            return if work.is_wasteful(tolerance) { None } else { Some(worst) };
        }
        if work.split_few(tolerance, attempt) {
            continue;
        }
        let wanted = work.density_from_deviations(tolerance, attempt > 0);
        if wanted.is_nan() || wanted > most as f64 {
            return None;
        }
        // As many as the deviations require when they are even; more each time, since they will not be quite
        // even.
        let fewest = (wanted + 0.1 * attempt as f64).ceil();
        n = if fewest > n { fewest } else { n + if attempt > 1 { 1.0 } else { 0.0 } };
        work.place_equal_shares(n as usize);
    }
    None
}

impl<const D: usize> FlattenScratch<D> {
    /// The parameters of the chord ends.
    #[inline(always)]
    pub(crate) fn places(&self) -> &[f64] {
        &self.places[..=self.n]
    }

    /// The positions of the chord ends, a list for each axis.
    #[inline(always)]
    pub(crate) fn axes(&self) -> [&[f64]; D] {
        std::array::from_fn(|k| &self.axes[k][..=self.n])
    }

    /// Grows the buffers for `n` chords, and a whole block after the last one.
    #[inline(always)]
    fn set_n(&mut self, n: usize) {
        self.n = n;
        let room = n + 1 + 2 * LANES;
        if self.places.len() < room {
            let room = room.next_power_of_two();
            self.places.resize(room, 1.0);
            self.deviations.resize(room, 0.0);
            self.axes.iter_mut().for_each(|axis| axis.resize(room, 0.0));
        }
    }

    #[inline(always)]
    fn set_nodes(&mut self, n: usize) {
        self.n_nodes = n;
        if self.nodes.len() < n {
            let room = n.next_power_of_two();
            self.nodes.resize(room, 0.0);
            self.shares.resize(room, 0.0);
            self.slopes.resize(room, 0.0);
        }
    }

    #[inline(always)]
    fn set_single_chord(&mut self, cubic: &Bezier<D>) {
        self.set_n(1);
        (self.places[0], self.places[1]) = (0.0, 1.0);
        for (k, axis) in self.axes.iter_mut().enumerate() {
            (axis[0], axis[1]) = (cubic.at(0.0)[k], cubic.at(1.0)[k]);
        }
    }

    /// Sets parameters that were found elsewhere; there must be at least two.
    pub(crate) fn set_places(&mut self, cubic: &Bezier<D>, places: &[f64]) {
        self.set_n(places.len() - 1);
        self.places[..places.len()].copy_from_slice(places);
        self.evaluate(cubic);
    }

    /// Samples the density at the ends of `grid` equal steps, one less than a multiple of [`LANES`] and no
    /// fewer than 7, so that the nodes fill whole blocks. Returns the total.
    #[inline(always)]
    fn sample(&mut self, cubic: &Bezier<D>, grid: usize) -> f64 {
        self.set_nodes(grid + 1);
        let step = 1.0 / grid as f64;
        for block in 0..(grid + 1) / LANES {
            let at = block * LANES;
            let (mut nodes, mut slopes) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                nodes[i] = (at + i) as f64 * step;
                slopes[i] = chord_density(cubic, nodes[i]);
            }
            self.nodes[at..at + LANES].copy_from_slice(&nodes);
            self.slopes[at..at + LANES].copy_from_slice(&slopes);
        }
        let (w, shares) = (&mut self.slopes[..=grid], &mut self.shares[..=grid]);
        // The trapezoidal rule, corrected by the slopes at its ends where both are known (fourth order).
        for i in 1..grid - 1 {
            let plain = 0.5 * (w[i] + w[i + 1]);
            let bent = (w[i] + w[i + 1] - w[i - 1] - w[i + 2]) * (1.0 / 24.0);
            shares[i + 1] = plain + if bent.abs() < 0.25 * plain { bent } else { 0.0 };
        }
        (shares[0], shares[1], shares[grid]) = (0.0, 0.5 * (w[0] + w[1]), 0.5 * (w[grid - 1] + w[grid]));
        let mut sum = 0.0;
        for share in shares.iter_mut() {
            sum += *share * step;
            *share = sum;
        }
        for density in w.iter_mut() {
            *density = 1.0 / *density;
        }
        sum
    }

    /// As [`Self::sample`], from the deviations of the current chords: each counts as the square root of its
    /// deviation over the tolerance. At an inflection a deviation grows with a higher power of the width, so
    /// a small one counts more. At a sharp bend it grows with a lower power: a chord that still deviates too
    /// much after the first correction is `stubborn`, and counts as its deviation over the tolerance.
    #[inline(always)]
    fn density_from_deviations(&mut self, tolerance: f64, stubborn: bool) -> f64 {
        let n = self.n;
        self.set_nodes(n + 1);
        let (nodes, shares, slopes) = (&mut self.nodes[..=n], &mut self.shares[..=n], &mut self.slopes[..=n]);
        nodes.copy_from_slice(&self.places[..=n]);
        let scale = 1.0 / tolerance;
        for (share, loss) in shares[1..].iter_mut().zip(&self.deviations[..n]) {
            let times = loss * scale;
            let root = times.sqrt();
            let small = (FLAT * root).sqrt();
            let large = if stubborn & (times > 1.0) { times } else { root };
            *share = if root < FLAT { small } else { large };
        }
        let mut sum = 0.0;
        shares[0] = 0.0;
        for share in &mut shares[1..] {
            sum += *share;
            *share = sum;
        }
        for i in 1..n {
            slopes[i] = (nodes[i + 1] - nodes[i - 1]) / (shares[i + 1] - shares[i - 1]);
        }
        slopes[0] = nodes[1] / shares[1];
        slopes[n] = (nodes[n] - nodes[n - 1]) / (shares[n] - shares[n - 1]);
        sum
    }

    /// Places `n` chords with an equal share each, by the monotone cubic through the nodes (F. Fritsch, R.
    /// Carlson, 1980).
    #[inline(always)]
    fn place_equal_shares(&mut self, n: usize) {
        self.set_n(n);
        let last = self.n_nodes - 1;
        let (nodes, shares, slopes) = (&self.nodes[..=last], &self.shares[..=last], &self.slopes[..=last]);
        let places = &mut self.places[..=n];
        let share = shares[last] / n as f64;
        places[0] = 0.0;
        let mut step = 1;
        for i in 0..last {
            let (from, to) = (shares[i], shares[i + 1]);
            if to < step as f64 * share || step >= n {
                continue;
            }
            let (width, rise) = (to - from, nodes[i + 1] - nodes[i]);
            // Slopes beyond three times that of the secant would make the cubic non-monotone.
            let limited = |slope: f64| lesser(width * slope, 3.0 * rise);
            let (left, right) = (limited(slopes[i]), limited(slopes[i + 1]));
            let (second, third) = (3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise);
            // As many steps as end in this interval; a count that is too large or too small by rounding is
            // corrected below.
            let end = (to / share) as usize + 1;
            let end = lesser(end, n);
            let (base, scale) = (nodes[i], 1.0 / width);
            for (offset, place) in places[step..end.max(step)].iter_mut().enumerate() {
                let x = ((step + offset) as f64 * share - from) * scale;
                *place = base + x * (left + x * (second + x * third));
            }
            step = end.max(step);
        }
        // Rounding at the end may have left some out.
        places[step..].fill(1.0);
        restore_order(places);
    }

    /// Tries one chord fewer where the deviations allow it and one matters; returns the largest deviation of
    /// the result.
    #[inline(always)]
    fn try_one_fewer(&mut self, chords: &CubicChords<'_, D>, tolerance: f64, worst: f64) -> f64 {
        let n = self.n;
        if !(3..=FEW).contains(&n) {
            return worst;
        }
        let scale = 1.0 / tolerance;
        let wanted = self.deviations[..n].iter().fold(0.0, |sum, loss| sum + (loss * scale).sqrt());
        if wanted > (n - 1) as f64 {
            return worst;
        }
        let mut before = [1.0; FEW + 1];
        before[..n].copy_from_slice(&self.places[..n]);
        self.density_from_deviations(tolerance, false);
        self.place_equal_shares(n - 1);
        self.evaluate(chords.cubic());
        let fewer = self.certify(chords, tolerance);
        if fewer <= tolerance {
            return fewer;
        }
        self.set_places(chords.cubic(), &before[..=n]);
        worst
    }

    /// Whether far fewer chords could have the same deviation: where a curve turns back on itself, or nearly,
    /// a density by its bending puts many chords at the turn, which together deviate little.
    #[inline(always)]
    fn is_wasteful(&self, tolerance: f64) -> bool {
        let n = self.n as f64;
        let scale = 1.0 / tolerance;
        let wanted = self.deviations[..self.n].iter().fold(0.0, |sum, loss| sum + (loss * scale).sqrt());
        wanted < WASTE * n - 1.0
    }

    /// Halves the chords that deviate too much, when they are few for the attempt; returns whether it did.
    #[inline(always)]
    fn split_few(&mut self, tolerance: f64, attempt: usize) -> bool {
        let n = self.n;
        let many = self.deviations[..n].iter().filter(|loss| **loss > tolerance).count();
        let few = match attempt {
            0 | 1 => n / 16,
            _ => n / 8,
        };
        if many > few {
            return false;
        }
        let before = self.places[..=n].to_vec();
        self.set_n(n + many);
        let mut to = 0;
        for (i, from) in before.iter().enumerate() {
            self.places[to] = *from;
            to += 1;
            if i < n && self.deviations[i] > tolerance {
                self.places[to] = 0.5 * (from + before[i + 1]);
                to += 1;
            }
        }
        true
    }

    /// Evaluates the points at all parameters.
    #[inline(always)]
    fn evaluate(&mut self, cubic: &Bezier<D>) {
        let [p0, p1, p2, p3] = cubic.control;
        let n_blocks = self.n / LANES + 1;
        for block in 0..n_blocks {
            let at = block * LANES;
            let mut places = [0.0; LANES];
            places.copy_from_slice(&self.places[at..at + LANES]);
            for (k, axis) in self.axes.iter_mut().enumerate() {
                let mut x = [0.0; LANES];
                for i in 0..LANES {
                    let [w0, w1, w2, w3] = bernstein(places[i]);
                    x[i] = (w0 * p0[k] + w1 * p1[k]) + (w2 * p2[k] + w3 * p3[k]);
                }
                axis[at..at + LANES].copy_from_slice(&x);
            }
        }
    }

    /// Bounds the deviation of each chord; returns the largest.
    ///
    /// The vector loop does not handle chords that are short compared with the deviation across them, and
    /// does not compare with the form without a chord where the curve extends beyond the ends of the chord.
    /// Those get the bound of `chord.rs`.
    #[inline(always)]
    fn certify(&mut self, chords: &CubicChords<'_, D>, tolerance: f64) -> f64 {
        let n = self.n;
        for at in (0..n).step_by(LANES) {
            let places = lanes(&self.places, at);
            let axes: [[[f64; LANES]; 2]; D] = std::array::from_fn(|k| lanes(&self.axes[k], at));
            let found = simple_deviations(chords.second_differences(), places, &axes, tolerance);
            self.deviations[at..at + LANES].copy_from_slice(&found);
        }
        let mut worst = 0.0;
        for i in 0..n {
            if self.deviations[i] == f64::INFINITY {
                self.deviations[i] = chords.deviation(self.places[i], self.places[i + 1]).at_most;
            }
            worst = greater(self.deviations[i], worst);
        }
        worst
    }
}

/// √|v|: the number of chords that a unit of the parameter needs there, up to a factor.
#[inline(always)]
fn chord_density<const D: usize>(cubic: &Bezier<D>, t: f64) -> f64 {
    let p = &cubic.control;
    let s = 1.0 - t;
    let (mut first_sq, mut both, mut first, mut second) = (0.0, 0.0, [0.0; D], [0.0; D]);
    for k in 0..D {
        let e = [p[1][k] - p[0][k], p[2][k] - p[1][k], p[3][k] - p[2][k]];
        first[k] = s * (s * e[0] + t * e[1]) + t * (s * e[1] + t * e[2]);
        second[k] = s * (e[1] - e[0]) + t * (e[2] - e[1]);
        first_sq += first[k] * first[k];
        both += first[k] * second[k];
    }
    // Where the derivative vanishes there is no direction, and 0/0 would spoil the sum.
    let along = if first_sq > 0.0 { both / first_sq } else { 0.0 };
    let mut across_sq = 0.0;
    for k in 0..D {
        let across = second[k] - along * first[k];
        across_sq += across * across;
    }
    // P'' is 6 times `second`.
    (6.0 * across_sq.sqrt()).sqrt()
}

/// Rounding, or a density of zero, may have put a parameter before its neighbour or made it NaN: it is
/// advanced by an equal step.
#[inline(always)]
fn restore_order(places: &mut [f64]) {
    let mut ordered = true;
    for pair in places.windows(2) {
        ordered &= pair[1] > pair[0];
    }
    if ordered {
        return;
    }
    let n = places.len();
    for i in 1..n - 1 {
        let before = places[i - 1];
        if places[i].is_nan() || places[i] <= before || places[i] >= 1.0 {
            places[i] = before + (1.0 - before) / (n - i) as f64;
        }
    }
}

/// Chords processed at once: a whole number of vectors with every instruction set.
const LANES: usize = 8;

/// The starts and the ends of a block of chords.
#[inline(always)]
fn lanes(list: &[f64], at: usize) -> [[f64; LANES]; 2] {
    let (mut from, mut to) = ([0.0; LANES], [0.0; LANES]);
    from.copy_from_slice(&list[at..at + LANES]);
    to.copy_from_slice(&list[at + 1..at + 1 + LANES]);
    [from, to]
}

/// See [`FlattenScratch::certify`]: infinite for chords that it does not handle.
#[inline(always)]
fn simple_deviations<const D: usize>(
    [a0, a1]: [[f64; D]; 2],
    [from, to]: [[f64; LANES]; 2],
    axes: &[[[f64; LANES]; 2]; D],
    tolerance: f64,
) -> [f64; LANES] {
    let mut found = [0.0; LANES];
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
        // As `largest_deviation` of chord.rs, with u = q/(3·(√(s² + q²/3) + s)), which needs no quotient of
        // the two.
        let (s_len, q_len) = (s_sq.sqrt(), q_sq.sqrt());
        let below = (s_sq + q_sq * (1.0 / 3.0)).sqrt() + s_len;
        let u = if below > 0.0 { q_len / (3.0 * below) } else { 0.0 };
        let aside = (1.0 - u * u) * (3.0 * s_len + u * q_len) * 0.125;
        // The inner control points along the chord, from its start and from its end, in thirds of its length;
        // the distance of the farther one from the middle, and by how much that is beyond an end.
        let first = (0.5 * (3.0 * s_share - q_share) + 0.5).abs();
        let last = (0.5 * (3.0 * s_share + q_share) - 0.5).abs();
        let far = greater(first, last);
        let beyond_sq = if far > 1.5 { (far - 1.5) * (far - 1.5) * c_sq * (1.0 / 9.0) } else { 0.0 };
        let loss = (aside * aside + beyond_sq).sqrt();
        let known = (c_sq > 0.0) & (sq_all <= 128.0 * c_sq) & ((beyond_sq == 0.0) | (loss <= tolerance));
        found[i] = if known { loss } else { f64::INFINITY };
    }
    found
}
