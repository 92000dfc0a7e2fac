//! `SampleSource`: the samples that a polygonizer reads.
use super::rule::Polygonize;
use crate::implicit::SparseGrid;
use crate::math::simd::{self, Kernel};

/// Samples on a lattice, read row by row for their sides and one by one for their values.
pub(crate) trait SampleSource: Sync {
    /// The number of samples along each index.
    fn size(&self) -> [usize; 3];

    /// Sets bit i of `words` if the sample i of row (j, k) is inside; bits after the row stay 0.
    fn sides(&self, row: [usize; 2], words: &mut [u64]);

    /// One sample.
    fn at(&self, index: [usize; 3]) -> f64;

    /// The samples at the corners of a cell, numbered as in `case_table.rs`.
    fn corners(&self, [i, j, k]: [usize; 3]) -> [f64; 8] {
        std::array::from_fn(|c| self.at([i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)]))
    }
}

/// Samples in one slice, the first index running fastest.
pub(crate) struct DenseSamples<'a, T> {
    pub values: &'a [T],
    pub size: [usize; 3],
    pub rule: Polygonize,
}

impl<T: Copy + Into<f64> + Sync> SampleSource for DenseSamples<'_, T> {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn sides(&self, [j, k]: [usize; 2], words: &mut [u64]) {
        let start = self.size[0] * (j + self.size[1] * k);
        let row = &self.values[start..start + self.size[0]];
        simd::dispatch(simd::isa(), CompareKernel { row, rule: self.rule, words });
    }

    #[inline(always)]
    fn at(&self, [i, j, k]: [usize; 3]) -> f64 {
        self.values[i + self.size[0] * (j + self.size[1] * k)].into()
    }
}

/// Samples in bricks.
pub(crate) struct BrickSamples<'a> {
    pub grid: &'a SparseGrid,
    pub rule: Polygonize,
}

impl SampleSource for BrickSamples<'_> {
    fn size(&self) -> [usize; 3] {
        self.grid.size()
    }

    fn sides(&self, [j, k]: [usize; 2], words: &mut [u64]) {
        words.fill(0);
        for i in 0..self.grid.size()[0] {
            words[i / 64] |= u64::from(self.rule.is_inside(self.grid.sample([i, j, k]))) << (i % 64);
        }
    }

    #[inline(always)]
    fn at(&self, index: [usize; 3]) -> f64 {
        self.grid.sample(index)
    }
}

/// Compares a row of samples with the level.
struct CompareKernel<'a, T> {
    row: &'a [T],
    rule: Polygonize,
    words: &'a mut [u64],
}

impl<T: Copy + Into<f64>> Kernel for CompareKernel<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let rule = self.rule;
        match rule.inside {
            super::rule::Inside::Low => pack(self.row, self.words, |v| v < rule.level),
            super::rule::Inside::High => pack(self.row, self.words, |v| v > rule.level),
        }
    }
}

/// Packs bytes of 0 or 1 into bits, eight at a time: the product adds copies of each byte, shifted so that
/// none overlap.
#[inline(always)]
fn pack<T: Copy + Into<f64>>(row: &[T], words: &mut [u64], inside: impl Fn(f64) -> bool) {
    for (word, samples) in words.iter_mut().zip(row.chunks(64)) {
        let mut bytes = [0_u8; 64];
        for (byte, sample) in bytes.iter_mut().zip(samples) {
            *byte = u8::from(inside((*sample).into()));
        }
        *word = 0;
        for (eighth, eight) in bytes.as_chunks::<8>().0.iter().enumerate() {
            let bits = u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56;
            *word |= bits << (8 * eighth);
        }
    }
}
