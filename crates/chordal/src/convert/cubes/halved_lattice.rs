//! `HalvedLattice`: a lattice whose cells are halved several times, with the values of its trilinear interpolant.
//!
//! The value in the middle of an edge is the mean of its ends, in the middle of a square it is the mean of two such means,
//! and in the middle of a cell the mean of two of these: along x first, then y, then z. So
//! 1. a value on an edge or a square follows from its ends or corners alone: cells that share it agree in every bit;
//! 2. a mean lies between its two numbers, rounding included: if the corners of an edge, a square or a cell of any level
//!    are on one side, so is every value in it. An edge with ends on different sides has exactly one half with such ends.
use super::rule::Polygonize;
use super::source::SampleSource;
use crate::math::{add_up, greater, lesser, mul_up};

/// The values at the corners of a cell, as finite numbers, and whether each of them is exactly the interpolant's.
pub(super) struct CellCorners {
    pub values: [f64; 8],
    pub exact: [bool; 8],
}

/// A source with each cell halved `level` times along each index.
pub(super) struct HalvedLattice<'a> {
    pub coarse: &'a dyn SampleSource,
    pub rule: &'a Polygonize,
    pub level: u32,
}

impl HalvedLattice<'_> {
    /// The values at the corners of a cell, numbered as in `case_table.rs`.
    pub fn corner_values(&self, cell: [usize; 3]) -> CellCorners {
        let root = cell.map(|i| i >> self.level);
        let mut values = self.coarse.corners(root).map(|value| self.rule.finite_sample(value));
        let mut exact = [true; 8];
        for bit in (0..self.level).rev() {
            // Along x, then y, then z, so that cells agree in every bit.
            for (axis, index) in cell.iter().enumerate() {
                // The half of a box along an axis keeps one end, and its other end is the middle.
                let keeps_low = index >> bit & 1 == 0;
                for low in (0..8_usize).filter(|c| c >> axis & 1 == 0) {
                    let high = low | 1 << axis;
                    let (middle, is_exact) = exact_mean(values[low], values[high]);
                    let moved = if keeps_low { high } else { low };
                    exact[moved] = is_exact && exact[low] && exact[high];
                    values[moved] = middle;
                }
            }
        }
        CellCorners { values, exact }
    }

    /// The largest error of a value at this level, given the largest size of a sample and the bits of integer samples; 0 if
    /// all values are exact.
    pub fn slack(level: u32, (largest, bits): (f64, Option<u32>)) -> f64 {
        // Each halving takes three means, and each mean adds a bit.
        if level == 0 || bits.is_some_and(|bits| bits + 3 * level < 53) {
            return 0.0;
        }
        // A mean has one rounding, of half a unit in the last place of the largest sample, and keeps the errors of its
        // two numbers: three means for each halving, and the losses below the smallest normal number.
        let halvings = f64::from(level);
        add_up(mul_up(2.0 * halvings * f64::EPSILON, largest), halvings * f64::MIN_POSITIVE)
    }
}

/// The mean of two numbers: between them, even if halves are rounded below the smallest normal number.
#[inline(always)]
pub(super) fn mean(a: f64, b: f64) -> f64 {
    let mean = 0.5 * a + 0.5 * b;
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    greater(lesser(mean, high), low)
}

/// The mean of two numbers, and whether it is exact: whether the error of the sum (T. J. Dekker, 1971; D. E. Knuth) and
/// the errors of the halves are 0.
#[inline(always)]
fn exact_mean(a: f64, b: f64) -> (f64, bool) {
    let (x, y) = (0.5 * a, 0.5 * b);
    let sum = x + y;
    let back = sum - x;
    let error = (x - (sum - back)) + (y - back);
    (mean(a, b), error == 0.0 && 2.0 * x == a && 2.0 * y == b)
}

impl SampleSource for HalvedLattice<'_> {
    fn size(&self) -> [usize; 3] {
        self.coarse.size().map(|n| ((n - 1) << self.level) + 1)
    }

    fn sides(&self, [j, k]: [usize; 2], words: &mut [u64]) {
        words.fill(0);
        for i in 0..self.size()[0] {
            words[i / 64] |= u64::from(self.rule.is_inside(self.at([i, j, k]))) << (i % 64);
        }
    }

    fn at(&self, index: [usize; 3]) -> f64 {
        let size = self.size();
        // The last sample is the far corner of the last cell.
        let cell = [0, 1, 2].map(|k| index[k].min(size[k] - 2));
        let corner = (0..3).fold(0, |corner, k| corner | (index[k] - cell[k]) << k);
        self.corner_values(cell).values[corner]
    }

    fn corners(&self, cell: [usize; 3]) -> [f64; 8] {
        self.corner_values(cell).values
    }
}

/// An upper bound of |g| on every triangle of a cell with these corners, from `bound.rs`: a quarter of the sum of the
/// largest mixed differences, with errors up to `slack` at the corners and of g at the vertices.
pub(super) fn largest_on_triangles(v: &[f64; 8], slack: f64) -> f64 {
    let low = v.iter().fold(f64::INFINITY, |least, x| lesser(*x, least));
    let range = v.iter().fold(f64::NEG_INFINITY, |most, x| greater(*x, most)) - low;
    if !range.is_finite() {
        return f64::INFINITY;
    }
    let mixed = |a: usize, b: usize, c: usize, d: usize| ((v[a] - v[b]) - (v[c] - v[d])).abs();
    let xy = greater(mixed(3, 2, 1, 0), mixed(7, 6, 5, 4));
    let yz = greater(mixed(6, 4, 2, 0), mixed(7, 5, 3, 1));
    let xz = greater(mixed(5, 4, 1, 0), mixed(7, 6, 3, 2));
    // Corners are rounded once when the level is subtracted, each mixed difference three times, and the sum twice, by
    // at most half a unit in the last place of four times the range: see `shift`.
    let rounding = add_up(mul_up(32.0 * f64::EPSILON, range), mul_up(4.0, slack));
    add_up(mul_up(0.25, (xy + yz) + xz), rounding)
}
