//! The fast way to place chord ends: places them by a density, checks all chords at once, corrects the density.
//!
//! A chord of width `h` in the parameter deviates by about `h²·|v|/8`, where `v` is the part of `P''` across
//! `P'`. So a curve needs about `∫ √(|v|/(8·tolerance)) dt` chords, spread by that density
//! (equidistribution). The density is sampled at the nodes of a grid, and a monotone cubic interpolates its
//! sums. Then the deviation of every chord is bounded. Where a chord fails, the square roots of the
//! deviations are a better density than the first one, since they include the features that samples missed.
//! Curves that fail four times are left to the greedy method.
//!
//! Loops run over slices, all chords at once, so that they are compiled to vector instructions.
use super::chord::ChordDeviation;
use crate::math::{greater, lesser};

/// Intervals of the grid, one less than a multiple of [`LANES`]: for a few chords, for some, and at most; in
/// between, half as many as there are chords. Measured: with fewer for some chords, the first placement fails more
/// often; with more, it costs more than it saves (20,000 random cubics at a thousandth of their box).
const COARSEST: usize = 7;
const GRID: usize = 15;
const FINEST: usize = 4096;
/// The number of placements that are tried before the greedy method. Measured: it then gets 0.1 % to 5 % of random
/// cubics.
const ATTEMPTS: usize = 4;
/// A little more chords than the density requires, since it is only approximate. Measured: a third of a percent more
/// segments, and a tenth fewer second placements.
const SPARE: f64 = 1.003;
/// A chord whose root of relative deviation is below this is treated as if the curve had an inflection there. Measured:
/// 0.7 and 0.85 leave equally few curves to a fourth placement; without it there are a fifth more.
const FLAT: f64 = 0.85;
/// Chords that use less than this fraction of their tolerance, on average and with one chord to spare, are
/// placed again by the greedy method. Chosen: the greedy method is slower, and gains little above it.
const WASTE: f64 = 0.85;
/// The most chords for which one fewer is tried. Chosen: one chord matters only among few.
const FEW: usize = 12;

/// A piece of a curve that can be split into chords by a density.
pub(crate) trait Spreadable<const D: usize> {
    /// The approximate number of equal steps that keeps the tolerance, as a float: it may be huge. It sets the grid.
    fn about_even_steps(&self, tolerance: f64) -> f64;

    /// The deviation of the chord from `a` to `b`, in exact arithmetic.
    fn deviation(&self, a: f64, b: f64) -> ChordDeviation;

    /// √|v|: the number of chords that a unit of the parameter needs at `t`, up to a factor.
    fn density(&self, t: f64) -> f64;

    /// The points at whole blocks of parameters, as input of [`Self::certify`].
    fn evaluate(&self, places: &[f64], axes: &mut [Vec<f64>; D]);

    /// Writes a bound of each chord's deviation, infinite for chords that are left to [`Self::deviation`]. All slices are
    /// one block longer than the number of chords.
    fn certify(&self, places: &[f64], axes: &[Vec<f64>; D], tolerance: f64, deviations: &mut [f64]);
}

/// Buffers that are reused from curve to curve. The lists only ever grow; the first `n` entries are valid.
#[derive(Clone, Debug)]
pub(crate) struct FlattenScratch<const D: usize> {
    /// The number of chords.
    n: usize,
    /// The parameters of the chord ends.
    places: Vec<f64>,
    /// The positions of the chord ends by [`Spreadable::evaluate`], a list for each axis.
    axes: [Vec<f64>; D],
    /// An upper bound of each chord's deviation.
    deviations: Vec<f64>,
    /// The data for the next placement: parameters, the required number of chords up to each, and the derivatives of
    /// the parameters by that number.
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
/// deviation. `None` if that did not succeed or would take more than `most` chords.
#[inline(always)]
pub(crate) fn spread_by_density<const D: usize, P: Spreadable<D>>(
    chords: &P,
    tolerance: f64,
    most: usize,
    work: &mut FlattenScratch<D>,
) -> Option<f64> {
    let whole = chords.deviation(0.0, 1.0).at_most;
    if whole <= tolerance {
        work.set_places(chords, &[0.0, 1.0]);
        return Some(whole);
    }
    // Equal steps would be about twice as many.
    let even = chords.about_even_steps(tolerance);
    let grid = if even <= 5.0 {
        COARSEST
    } else if even <= 60.0 {
        GRID
    } else if even < 4.0 * FINEST as f64 {
        (even as usize / 4).next_multiple_of(LANES) - 1
    } else {
        FINEST - 1
    };
    let needed = work.sample(chords, grid) / (8.0 * tolerance).sqrt();
    // At least two, since one chord was not enough, whatever the samples give; also for NaN.
    let mut n = if needed > 1.0 { (SPARE * needed).ceil() } else { 2.0 };
    if n > most as f64 {
        return None;
    }
    work.place_equal_shares(n as usize);
    for attempt in 0..ATTEMPTS {
        work.evaluate(chords);
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
        // The number that the deviations require if they become equal, and more with each attempt, since they will
        // not be quite equal.
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
        let len = n + 1 + 2 * LANES;
        if self.places.len() < len {
            let len = len.next_power_of_two();
            self.places.resize(len, 1.0);
            self.deviations.resize(len, 0.0);
            self.axes.iter_mut().for_each(|axis| axis.resize(len, 0.0));
        }
    }

    #[inline(always)]
    fn set_nodes(&mut self, n: usize) {
        self.n_nodes = n;
        if self.nodes.len() < n {
            let len = n.next_power_of_two();
            self.nodes.resize(len, 0.0);
            self.shares.resize(len, 0.0);
            self.slopes.resize(len, 0.0);
        }
    }

    /// Sets given parameters; there must be at least two.
    #[inline(always)]
    pub(crate) fn set_places<P: Spreadable<D>>(&mut self, chords: &P, places: &[f64]) {
        self.set_n(places.len() - 1);
        self.places[..places.len()].copy_from_slice(places);
        self.evaluate(chords);
    }

    /// Samples the density at the ends of `grid` equal steps, one less than a multiple of [`LANES`] and no
    /// fewer than 7, so that the nodes fill whole blocks. Returns the total.
    #[inline(always)]
    fn sample<P: Spreadable<D>>(&mut self, chords: &P, grid: usize) -> f64 {
        self.set_nodes(grid + 1);
        let step = 1.0 / grid as f64;
        for block in 0..(grid + 1) / LANES {
            let at = block * LANES;
            let (mut nodes, mut slopes) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                nodes[i] = (at + i) as f64 * step;
                slopes[i] = chords.density(nodes[i]);
            }
            self.nodes[at..at + LANES].copy_from_slice(&nodes);
            self.slopes[at..at + LANES].copy_from_slice(&slopes);
        }
        let (w, shares) = (&mut self.slopes[..=grid], &mut self.shares[..=grid]);
        // The trapezoidal rule, corrected by the slopes at both ends of an interval if these are known (fourth order).
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

    /// Like [`Self::sample`], but by the deviations of the current chords: the share of each is the square root of its
    /// deviation over the tolerance. At an inflection a deviation grows with a higher power of the width, so the share of
    /// a small one is increased. At a sharp bend it grows with a lower power: after the first correction (`stubborn`), the
    /// share of a chord that still deviates too much is its deviation over the tolerance.
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
            // `&` instead of `&&`, so that the loop has no branch and becomes vector instructions.
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
            // The steps that end in this interval; a count that is too large or too small by rounding is corrected
            // below.
            let end = (to / share) as usize + 1;
            let end = lesser(end, n);
            let (base, scale) = (nodes[i], 1.0 / width);
            for (offset, place) in places[step..end.max(step)].iter_mut().enumerate() {
                let x = ((step + offset) as f64 * share - from) * scale;
                *place = base + x * (left + x * (second + x * third));
            }
            step = end.max(step);
        }
        // Rounding may have left out steps at the end.
        places[step..].fill(1.0);
        restore_order(places);
    }

    /// Tries one chord fewer if the deviations allow it and there are few; returns the largest deviation of the result.
    #[inline(always)]
    fn try_one_fewer<P: Spreadable<D>>(&mut self, chords: &P, tolerance: f64, worst: f64) -> f64 {
        let n = self.n;
        if !(3..=FEW).contains(&n) {
            return worst;
        }
        let scale = 1.0 / tolerance;
        // A deviation goes with the square of the chord: this many chords of equal deviations would just do.
        let wanted = self.deviations[..n].iter().fold(0.0, |sum, loss| sum + (loss * scale).sqrt());
        if wanted > (n - 1) as f64 {
            return worst;
        }
        let mut before = [1.0; FEW + 1];
        before[..n].copy_from_slice(&self.places[..n]);
        self.density_from_deviations(tolerance, false);
        self.place_equal_shares(n - 1);
        self.evaluate(chords);
        let fewer = self.certify(chords, tolerance);
        if fewer <= tolerance {
            return fewer;
        }
        self.set_places(chords, &before[..=n]);
        worst
    }

    /// Whether far fewer chords could have the same deviation: if a curve turns back on itself, or nearly, a density by
    /// its bending puts many chords at the turn, which together deviate little.
    #[inline(always)]
    fn is_wasteful(&self, tolerance: f64) -> bool {
        let n = self.n as f64;
        let scale = 1.0 / tolerance;
        let wanted = self.deviations[..self.n].iter().fold(0.0, |sum, loss| sum + (loss * scale).sqrt());
        wanted < WASTE * n - 1.0
    }

    /// Halves the chords that deviate too much, if they are few; returns whether it did.
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
    fn evaluate<P: Spreadable<D>>(&mut self, chords: &P) {
        chords.evaluate(&self.places[..(self.n / LANES + 1) * LANES], &mut self.axes);
    }

    /// The largest deviation of the current chords, and the index of its chord.
    #[inline(always)]
    pub(crate) fn worst_chord<P: Spreadable<D>>(&mut self, chords: &P) -> (f64, usize) {
        // With a tolerance of 0, chords whose fast bound may be too large are passed to `deviation`.
        let most = self.certify(chords, 0.0);
        (most, self.deviations[..self.n].iter().position(|loss| *loss == most).unwrap_or(0))
    }

    /// Bounds the deviation of each chord; returns the largest.
    #[inline(always)]
    fn certify<P: Spreadable<D>>(&mut self, chords: &P, tolerance: f64) -> f64 {
        let n = self.n;
        let blocks = n.div_ceil(LANES) * LANES;
        chords.certify(&self.places[..=blocks], &self.axes, tolerance, &mut self.deviations[..blocks]);
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

/// Repairs parameters that rounding, or a density of zero, has put before their neighbour or made NaN: they are
/// advanced by equal steps.
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
            // An equal share of what is left up to 1, so that the points behind it still have room.
            places[i] = before + (1.0 - before) / (n - i) as f64;
        }
    }
}

/// Chords processed at once: a whole number of vectors with every instruction set.
pub(super) const LANES: usize = 8;
