//! `UpsampledSource`: a lattice whose cells are halved several times, with the values of its trilinear
//! interpolant.
use super::rule::Polygonize;
use super::source::SampleSource;
use crate::implicit::Affine3;
use crate::math::greater;
use std::sync::atomic::{AtomicBool, Ordering};

/// The interpolant of a source on a lattice with `parts` cells for each of the source's along each index.
///
/// A value between the source's samples is three means of two, rounded, and kept between the two: where the
/// corners of a source cell are on one side, so is all of the cell. At the source's own samples the values
/// are the source's.
pub(crate) struct UpsampledSource<'a> {
    coarse: &'a dyn SampleSource,
    rule: Polygonize,
    parts: usize,
    /// The largest error of a value; 0 where all are exact.
    pub slack: f64,
    /// Whether an inexact value came so near to the level that its side is uncertain.
    pub unsure: AtomicBool,
}

impl<'a> UpsampledSource<'a> {
    /// Halves the cells `halvings` times. `largest` is the largest size of a sample, `bits` the bits of
    /// integer samples.
    pub fn new(
        coarse: &'a dyn SampleSource,
        rule: &Polygonize,
        halvings: u32,
        (largest, bits): (f64, Option<u32>),
    ) -> Self {
        // Each mean multiplies by whole numbers of `halvings` bits: nothing is rounded while all fit in 53
        // bits.
        let exact = bits.is_some_and(|bits| bits + 3 * halvings < 53);
        let largest = greater(largest, rule.level.abs());
        // Three means of three roundings each, of numbers no larger than the largest.
        let slack = if exact { 0.0 } else { 8.0 * f64::EPSILON * largest };
        Self { coarse, rule: *rule, parts: 1 << halvings, slack, unsure: AtomicBool::new(false) }
    }

    /// The map from the finer lattice's indices to space; exact, as it divides by a power of two.
    pub fn affine(&self, coarse: &Affine3) -> Option<Affine3> {
        let parts = self.parts as f64;
        Affine3::new(coarse.rows().map(|[a, b, c, d]| [a / parts, b / parts, c / parts, d])).ok()
    }

    /// The lower of the two source samples around an index, and the fraction of the way to the next.
    #[inline(always)]
    fn split(&self, index: usize) -> (usize, f64) {
        (index / self.parts, (index % self.parts) as f64 / self.parts as f64)
    }

    #[inline(always)]
    fn sample(&self, index: [usize; 3]) -> f64 {
        self.rule.finite_sample(self.coarse.at(index))
    }

    /// The value at index `i` of the source along the first axis, interpolated along the other two.
    #[inline(always)]
    fn column(&self, i: usize, (j, y): (usize, f64), (k, z): (usize, f64)) -> f64 {
        let along = |k: usize| {
            let low = self.sample([i, j, k]);
            if y == 0.0 { low } else { mean(low, self.sample([i, j + 1, k]), y) }
        };
        if z == 0.0 { along(k) } else { mean(along(k), along(k + 1), z) }
    }
}

/// `a` and `b` mixed, never outside of their range.
#[inline(always)]
fn mean(a: f64, b: f64, part: f64) -> f64 {
    let mixed = a * (1.0 - part) + b * part;
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    if mixed < low {
        low
    } else if mixed > high {
        high
    } else {
        mixed
    }
}

impl SampleSource for UpsampledSource<'_> {
    fn size(&self) -> [usize; 3] {
        self.coarse.size().map(|n| (n - 1) * self.parts + 1)
    }

    fn sides(&self, [j, k]: [usize; 2], words: &mut [u64]) {
        let (j, k) = (self.split(j), self.split(k));
        let n = self.coarse.size()[0];
        words.fill(0);
        let mut unsure = false;
        // The side of the samples around the column, and whether they are on different sides.
        let mixed = |i: usize| {
            let rows = [j.0, if j.1 == 0.0 { j.0 } else { j.0 + 1 }];
            let planes = [k.0, if k.1 == 0.0 { k.0 } else { k.0 + 1 }];
            let side = |row: usize, plane: usize| self.rule.is_inside(self.sample([i, row, plane]));
            let first = side(rows[0], planes[0]);
            let same = planes.iter().all(|plane| rows.iter().all(|row| side(*row, *plane) == first));
            (first, !same)
        };
        let mut low = (self.column(0, j, k), mixed(0));
        for i in 0..n {
            let high = if i + 1 < n { (self.column(i + 1, j, k), mixed(i + 1)) } else { low };
            let count = if i + 1 < n { self.parts } else { 1 };
            let passed = low.1.1 || high.1.1 || low.1.0 != high.1.0;
            for part in 0..count {
                let inside = if passed {
                    let value =
                        if part == 0 { low.0 } else { mean(low.0, high.0, part as f64 / self.parts as f64) };
                    unsure |= (value - self.rule.level).abs() <= self.slack;
                    self.rule.is_inside(value)
                } else {
                    low.1.0
                };
                let at = i * self.parts + part;
                words[at / 64] |= u64::from(inside) << (at % 64);
            }
            low = high;
        }
        if unsure && self.slack > 0.0 {
            self.unsure.store(true, Ordering::Relaxed);
        }
    }

    fn at(&self, [i, j, k]: [usize; 3]) -> f64 {
        let (i, x) = self.split(i);
        let (j, k) = (self.split(j), self.split(k));
        let low = self.column(i, j, k);
        if x == 0.0 { low } else { mean(low, self.column(i + 1, j, k), x) }
    }
}
