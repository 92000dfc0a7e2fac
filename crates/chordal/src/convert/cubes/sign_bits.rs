//! `SignBits`: each sample's side of the level, and the vertices and cells that follow from that alone.
use super::rule::{Border, Polygonize};
use super::source::SampleSource;
use crate::budget::{Job, par_map_owned};

/// One bit a sample, in rows along the first index.
pub(crate) struct SignBits {
    pub size: [usize; 3],
    /// Words in a row.
    width: usize,
    words: Vec<u64>,
    border: [[Border; 2]; 3],
}

/// The kinds of vertices of a row, in their order: on the edges of the lattice along x, y and z, and at
/// samples in capped borders.
pub(super) const KINDS: usize = 4;

impl SignBits {
    /// Bytes that the bits of a lattice take.
    pub fn bytes(size: [usize; 3]) -> u64 {
        8 * (size[0].div_ceil(64) as u64).saturating_mul(size[1] as u64).saturating_mul(size[2] as u64)
    }

    pub fn new<S: SampleSource + ?Sized>(source: &S, rule: &Polygonize, job: &Job) -> Self {
        let size = source.size();
        let width = size[0].div_ceil(64);
        let mut words = vec![0; width * size[1] * size[2]];
        let slab = size[1] * planes(size[2]);
        let slabs: Vec<(usize, &mut [u64])> = words.chunks_mut(width * slab).enumerate().collect();
        par_map_owned(job, slabs, |(number, words)| {
            for (row, words) in words.chunks_exact_mut(width).enumerate() {
                let row = number * slab + row;
                if !job.is_cancelled() {
                    source.sides([row % size[1], row / size[1]], words);
                }
            }
        });
        Self { size, width, words, border: rule.border }
    }

    #[inline(always)]
    pub fn row(&self, j: usize, k: usize) -> &[u64] {
        let start = self.width * (j + self.size[1] * k);
        &self.words[start..start + self.width]
    }

    pub fn is_inside(&self, [i, j, k]: [usize; 3]) -> bool {
        self.row(j, k)[i / 64] >> (i % 64) & 1 == 1
    }

    /// The samples from 64·word on that begin a cell, as bits.
    #[inline(always)]
    fn cells(&self, word: usize) -> u64 {
        let cells_left = self.size[0] - 1 - (64 * word).min(self.size[0] - 1);
        if cells_left >= 64 { u64::MAX } else { (1 << cells_left) - 1 }
    }

    /// The samples of a row that have a vertex of a kind, 64 at a time.
    #[inline(always)]
    pub fn vertices(&self, kind: usize, [j, k]: [usize; 2], word: usize) -> u64 {
        let row = self.row(j, k);
        match kind {
            // The last sample of a row has no edge ahead.
            0 => (row[word] ^ shifted(row, word)) & self.cells(word),
            1 if j + 1 < self.size[1] => row[word] ^ self.row(j + 1, k)[word],
            2 if k + 1 < self.size[2] => row[word] ^ self.row(j, k + 1)[word],
            3 => row[word] & self.capped(j, k, word),
            _ => 0,
        }
    }

    /// The samples of a row that lie in a capped border.
    #[inline(always)]
    fn capped(&self, j: usize, k: usize, word: usize) -> u64 {
        let at = |axis: usize, index: usize| {
            let [low, high] = self.border[axis];
            (index == 0 && low == Border::Capped) || (index + 1 == self.size[axis] && high == Border::Capped)
        };
        if at(1, j) || at(2, k) {
            return u64::MAX;
        }
        let last = self.size[0] - 1;
        let mut mask = 0;
        if word == 0 && at(0, 0) {
            mask |= 1;
        }
        if word == last / 64 && at(0, last) {
            mask |= 1 << (last % 64);
        }
        mask
    }

    /// How the shape ends at the low and the high border of an axis.
    pub fn capped_ends(&self, axis: usize) -> [Border; 2] {
        self.border[axis]
    }

    /// The number of words in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of vertices of a kind in the row before sample `i`.
    pub fn rank(&self, kind: usize, [i, j, k]: [usize; 3]) -> u32 {
        let whole: u32 = (0..i / 64).map(|word| self.vertices(kind, [j, k], word).count_ones()).sum();
        whole + (self.vertices(kind, [j, k], i / 64) & ((1 << (i % 64)) - 1)).count_ones()
    }

    /// Visits the signs of the cells of a row that the surface passes, in order.
    #[inline(always)]
    pub fn cases(&self, [j, k]: [usize; 2], mut each: impl FnMut(usize, u8)) {
        let rows = [self.row(j, k), self.row(j + 1, k), self.row(j, k + 1), self.row(j + 1, k + 1)];
        for word in 0..self.width {
            let here = rows.map(|row| row[word]);
            let any = here[0] | here[1] | here[2] | here[3];
            // The samples one step ahead in their rows.
            let next = rows.map(|row| shifted(row, word));
            let any_next = next[0] | next[1] | next[2] | next[3];
            if any | any_next == 0 {
                continue;
            }
            // Cells with all corners inside are not passed either.
            let all = (here[0] & here[1] & here[2] & here[3]) & (next[0] & next[1] & next[2] & next[3]);
            let mut active = (any | any_next) & !all & self.cells(word);
            while active != 0 {
                let i = active.trailing_zeros();
                let bit = |word: u64| (word >> i & 1) as u8;
                let low = bit(here[0]) | bit(next[0]) << 1 | bit(here[1]) << 2 | bit(next[1]) << 3;
                let high = bit(here[2]) << 4 | bit(next[2]) << 5 | bit(here[3]) << 6 | bit(next[3]) << 7;
                each(64 * word + i as usize, low | high);
                active &= active - 1;
            }
        }
    }
}

/// The row shifted by one sample.
#[inline(always)]
fn shifted(row: &[u64], word: usize) -> u64 {
    row[word] >> 1 | if word + 1 < row.len() { row[word + 1] << 63 } else { 0 }
}

/// The number of planes of samples in a slab; it depends on the data alone.
pub(super) fn planes(n: usize) -> usize {
    n.div_ceil(64)
}
