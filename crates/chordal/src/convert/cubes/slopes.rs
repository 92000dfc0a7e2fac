//! Slopes of many cells at once: along one axis, over three cells in a row.
//!
//! Each cell needs the samples of four planes across the axis: its own two and one on either side, four samples in
//! each. The proof that uses them is in `bound.rs`.
use crate::math::simd::{self, Kernel};
use crate::math::{greater, lesser};

/// The number of cells processed at once.
pub(super) const LANES: usize = 64;

/// A half unit in the last place of 1: the relative error of one rounding.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// One number for each of these cells.
pub(super) type CellLanes = [f64; LANES];

/// For each axis the corners at its low end.
pub(super) const LOW: [[usize; 4]; 3] = [[0, 2, 4, 6], [0, 1, 4, 5], [0, 1, 2, 3]];

/// The smallest difference along each axis over a cell; not above 0 if the signs differ.
pub(super) struct MinSlopeKernel<'a> {
    pub corners: &'a [CellLanes; 8],
    pub out: &'a mut [CellLanes; 3],
}

impl Kernel for MinSlopeKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (axis, out) in self.out.iter_mut().enumerate() {
            for (lane, out) in out.iter_mut().enumerate() {
                let d = LOW[axis].map(|low| self.corners[low + (1 << axis)][lane] - self.corners[low][lane]);
                let (mut least, mut most) = (d[0], d[0]);
                for x in [d[1], d[2], d[3]] {
                    least = lesser(x, least);
                    most = greater(x, most);
                }
                *out = greater(least, -most);
            }
        }
    }
}

/// e/m over three cells in a row, rounded up: infinite if that proves no bound.
pub(super) struct ShiftKernel<'a> {
    /// g on the planes from low to high along the axis, four corners in each, in the order of those of a
    /// face; a missing plane equals its neighbour.
    pub planes: &'a [[CellLanes; 4]; 4],
    /// The largest error of a value.
    pub slack: f64,
    pub out: &'a mut CellLanes,
}

impl Kernel for ShiftKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { planes, slack, out } = self;
        for lane in 0..LANES {
            let w: [[f64; 4]; 4] = std::array::from_fn(|p| std::array::from_fn(|c| planes[p][c][lane]));
            out[lane] = shift(&w, [0.0; 2], slack);
        }
    }
}

/// [`ShiftKernel`] for one cell. The cells beside it may be parts of larger cells, with |g| up to `beside` on their
/// triangles.
#[inline(always)]
pub(super) fn shift(w: &[[f64; 4]; 4], beside: [f64; 2], slack: f64) -> f64 {
    let (mut low, mut high) = (w[0][0], w[0][0]);
    for x in w.as_flattened() {
        low = lesser(low, *x);
        high = greater(high, *x);
    }
    let range = high - low;
    // 1. Whether g rises or falls along the row, in the middle cell.
    let rises = w[2][0] > w[1][0];
    let grown = |x: f64| if rises { x } else { -x };
    // 2. For each cell e and m: mixed differences in its planes, and between the slopes from one plane to the
    // other.
    let mut across = [0.0; 4];
    for p in 0..4 {
        across[p] = ((w[p][3] - w[p][2]) - (w[p][1] - w[p][0])).abs();
    }
    let (mut error, mut slope) = ([0.0; 3], [0.0; 3]);
    for p in 0..3 {
        let s: [f64; 4] = std::array::from_fn(|c| grown(w[p + 1][c] - w[p][c]));
        let first = greater((s[1] - s[0]).abs(), (s[3] - s[2]).abs());
        let second = greater((s[2] - s[0]).abs(), (s[3] - s[1]).abs());
        error[p] = 0.25 * ((greater(across[p], across[p + 1]) + first) + second);
        slope[p] = lesser(lesser(s[0], s[1]), lesser(s[2], s[3]));
    }
    error[0] = greater(beside[0], error[0]);
    error[2] = greater(beside[1], error[2]);
    // 3. Corners are rounded once, and |g| is no more than the range, since the cell in the middle has both
    // signs; each mixed difference is rounded three times more, by half a unit in the last place of four
    // times the range at most, and the sum twice.
    let rounding = 64.0 * ROUNDING * range + 2.0 * slack;
    // 4. A neighbour counts unless |g| is above e on all of the plane between.
    let ends = |p: usize, sign: f64| {
        let g: [f64; 4] = std::array::from_fn(|c| sign * grown(w[p][c]));
        lesser(lesser(g[0], g[1]), lesser(g[2], g[3]))
    };
    let free = error[1] + 2.0 * rounding;
    let (mut most, mut least) = (error[1], slope[1]);
    let (free_before, free_behind) = (ends(1, -1.0) > free, ends(2, 1.0) > free);
    if !free_before {
        most = greater(most, error[0]);
        least = lesser(least, slope[0]);
    }
    if !free_behind {
        most = greater(most, error[2]);
        least = lesser(least, slope[2]);
    }
    // 5. Two roundings each of e and m, and one of the quotient.
    let slope = least - rounding;
    let shift = ((most + rounding) / slope) * (1.0 + 16.0 * ROUNDING);
    if slope > 0.0 && shift <= 1.0 { shift } else { f64::INFINITY }
}

/// Runs a kernel with this processor's vector instructions.
pub(super) fn run(kernel: impl Kernel<Output = ()>) {
    simd::dispatch(simd::isa(), kernel);
}
