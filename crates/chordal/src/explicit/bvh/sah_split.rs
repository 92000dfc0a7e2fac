//! Splits a run of triangles in two where the surface area heuristic is smallest.

use crate::math::{greater, lesser};

/// Up to this number triangles are sorted along one axis and every split is tried; above, they are binned.
/// Chosen: a larger value finds cheaper splits, but sorts by insertion in quadratic time.
const SORTED: usize = 8;
/// Up to this number of triangles fewer bins are used: a sweep over all bins would cost more than the
/// triangles.
const FEW: usize = 64;
/// Bins per axis. Measured: 32 gain 1 % in queries.
const BINS: usize = 16;
/// Bins per axis for few triangles.
const FEW_BINS: usize = 8;
/// A box in local f32 coordinates. The fourth lane is unused; it makes a row one register.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box32 {
    pub low: [f32; 4],
    pub high: [f32; 4],
}

impl Box32 {
    const EMPTY: Self = Self { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        for k in 0..4 {
            self.low[k] = lesser(other.low[k], self.low[k]);
            self.high[k] = greater(other.high[k], self.high[k]);
        }
    }

    #[inline(always)]
    fn sides(&self) -> [f32; 3] {
        [self.high[0] - self.low[0], self.high[1] - self.low[1], self.high[2] - self.low[2]]
    }

    /// Half the surface area; 0 when empty.
    #[inline]
    pub fn area(&self) -> f32 {
        let [x, y, z] = self.sides();
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

    fn longest_axis(&self) -> usize {
        let [x, y, z] = self.sides();
        if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        }
    }
}

/// The box of one triangle. Its fourth lanes hold the two halves of the face index, as numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct BvhPrimitive {
    pub bounds: Box32,
}

impl BvhPrimitive {
    pub fn new(low: [f32; 3], high: [f32; 3], face: u32) -> Self {
        let halves = [face & 0xffff, face >> 16].map(|half| half as f32);
        let row = |v: [f32; 3], half: f32| [v[0], v[1], v[2], half];
        Self { bounds: Box32 { low: row(low, halves[0]), high: row(high, halves[1]) } }
    }

    pub fn face(&self) -> u32 {
        self.bounds.low[3] as u32 | (self.bounds.high[3] as u32) << 16
    }

    /// Twice the centre of the box; the fourth lane is meaningless.
    #[inline(always)]
    fn doubled_centre(&self) -> [f32; 4] {
        let Box32 { low, high } = &self.bounds;
        [low[0] + high[0], low[1] + high[1], low[2] + high[2], low[3] + high[3]]
    }
}

/// The bounds of a run of triangles: the box around them, and the box around their doubled centres.
#[derive(Clone, Copy, Debug)]
pub(super) struct PrimitiveBounds {
    pub bounds: Box32,
    pub middles: Box32,
}

impl PrimitiveBounds {
    const EMPTY: Self = Self { bounds: Box32::EMPTY, middles: Box32::EMPTY };

    #[inline(always)]
    fn add(&mut self, prim: &BvhPrimitive) {
        self.bounds.add(&prim.bounds);
        let middles = prim.doubled_centre();
        self.middles.add(&Box32 { low: middles, high: middles });
    }

    pub fn new(prims: &[BvhPrimitive]) -> Self {
        let mut extent = Self::EMPTY;
        prims.iter().for_each(|p| extent.add(p));
        extent
    }
}

/// Reorders two or more triangles and splits them in two. Returns the length of the first part, and the
/// bounds of both. With `extent` the split is by cost, without it into halves in the present order.
pub(super) fn cut(
    prims: &mut [BvhPrimitive],
    extent: Option<&PrimitiveBounds>,
) -> (usize, [PrimitiveBounds; 2]) {
    if let Some(PrimitiveBounds { middles, .. }) = extent {
        if prims.len() <= SORTED {
            return sorted(prims, middles.longest_axis());
        }
        let plane = if prims.len() <= FEW {
            best_plane::<FEW_BINS>(prims, middles)
        } else {
            best_plane::<BINS>(prims, middles)
        };
        if let Some(plane) = plane {
            return part_at(prims, plane);
        }
    }
    let half = prims.len() / 2;
    (half, [PrimitiveBounds::new(&prims[..half]), PrimitiveBounds::new(&prims[half..])])
}

/// Sorts few triangles along an axis and takes the cheapest of all splits.
fn sorted(prims: &mut [BvhPrimitive], axis: usize) -> (usize, [PrimitiveBounds; 2]) {
    // Insertion sort: stable, and fast for so few.
    for i in 1..prims.len() {
        let mut j = i;
        while j > 0 && prims[j].doubled_centre()[axis] < prims[j - 1].doubled_centre()[axis] {
            prims.swap(j, j - 1);
            j -= 1;
        }
    }
    // `right[i]` holds the triangles from i on.
    let mut right = [PrimitiveBounds::EMPTY; SORTED];
    let mut sum = PrimitiveBounds::EMPTY;
    for i in (1..prims.len()).rev() {
        sum.add(&prims[i]);
        right[i] = sum;
    }
    let mut left = PrimitiveBounds::EMPTY;
    let (mut best, mut lowest_cost) = ((1, [PrimitiveBounds::EMPTY; 2]), f32::INFINITY);
    for i in 1..prims.len() {
        left.add(&prims[i - 1]);
        let cost = left.bounds.area() * i as f32 + right[i].bounds.area() * (prims.len() - i) as f32;
        // The first in any case: areas may overflow, and then no cost is lower than another.
        if cost < lowest_cost || i == 1 {
            (best, lowest_cost) = ((i, [left, right[i]]), cost);
        }
    }
    best
}

/// A split between bin `below − 1` and bin `below` of `axis`.
#[derive(Clone, Copy)]
struct SplitPlane {
    axis: usize,
    bins: BinMapping,
    below: u32,
}

/// Equal intervals along each axis; the first and the last are half as long.
#[derive(Clone, Copy)]
struct BinMapping {
    from: [f32; 4],
    factor: [f32; 4],
}

impl BinMapping {
    fn new(middles: &Box32, n: usize) -> Self {
        let factor = |k: usize| {
            let factor = (n - 1) as f32 / (middles.high[k] - middles.low[k]);
            // If all centres coincide, or nearly, one bin takes all triangles.
            if factor < f32::MAX { factor } else { 0.0 }
        };
        Self { from: middles.low, factor: [factor(0), factor(1), factor(2), 0.0] }
    }

    /// The bin along each axis. Adding 2²³ to a number below 2²³ rounds it to an integer in the low bits.
    #[inline(always)]
    fn bin_of(&self, middles: [f32; 4]) -> [u32; 4] {
        const WHOLE: f32 = (1 << 23) as f32;
        let mut bins = [0; 4];
        for k in 0..4 {
            bins[k] = ((middles[k] - self.from[k]) * self.factor[k] + WHOLE).to_bits() & 0xff;
        }
        bins
    }
}

#[derive(Clone, Copy)]
struct SahBin {
    bounds: Box32,
    n: u32,
}

/// The plane between bins with the smallest sum of `area · count` over both sides; `None` if all centres
/// coincide.
fn best_plane<const N: usize>(prims: &[BvhPrimitive], middles: &Box32) -> Option<SplitPlane> {
    let bins = BinMapping::new(middles, N);
    let mut filled = [[SahBin { bounds: Box32::EMPTY, n: 0 }; N]; 3];
    for prim in prims {
        let at = bins.bin_of(prim.doubled_centre());
        for axis in 0..3 {
            // The mask changes nothing; it lets the compiler drop the check of the index.
            let bin = &mut filled[axis][at[axis] as usize & (N - 1)];
            bin.bounds.add(&prim.bounds);
            bin.n += 1;
        }
    }
    let mut best: Option<(f32, SplitPlane)> = None;
    for (axis, filled) in filled.iter().enumerate() {
        if let Some((cost, below)) = sweep(filled)
            && best.is_none_or(|(lowest_cost, _)| cost < lowest_cost)
        {
            best = Some((cost, SplitPlane { axis, bins, below: below as u32 }));
        }
    }
    best.map(|(_, plane)| plane)
}

/// The cheapest split between bins, if one has triangles on both sides.
fn sweep<const N: usize>(bins: &[SahBin; N]) -> Option<(f32, usize)> {
    let mut right = [0.0_f32; N];
    let (mut bounds, mut n) = (Box32::EMPTY, 0);
    for i in (1..N).rev() {
        bounds.add(&bins[i].bounds);
        n += bins[i].n;
        // NaN marks planes with no triangle to their right.
        right[i] = if n == 0 { f32::NAN } else { bounds.area() * n as f32 };
    }
    let (mut bounds, mut n) = (Box32::EMPTY, 0);
    let mut best: Option<(f32, usize)> = None;
    for i in 1..N {
        bounds.add(&bins[i - 1].bounds);
        n += bins[i - 1].n;
        let cost = bounds.area() * n as f32 + right[i];
        if n > 0 && !right[i].is_nan() && best.is_none_or(|(lowest_cost, _)| cost < lowest_cost) {
            best = Some((cost, i));
        }
    }
    best
}

/// Moves the triangles below the plane to the front.
fn part_at(prims: &mut [BvhPrimitive], plane: SplitPlane) -> (usize, [PrimitiveBounds; 2]) {
    // The bins come from the same function as in the sweep: another formula could round a triangle
    // to the other side, and leave one side empty.
    let is_left = |prim: &BvhPrimitive| plane.bins.bin_of(prim.doubled_centre())[plane.axis] < plane.below;
    let (mut left, mut right) = (PrimitiveBounds::EMPTY, PrimitiveBounds::EMPTY);
    let (mut i, mut j) = (0, prims.len());
    while i < j {
        if is_left(&prims[i]) {
            left.add(&prims[i]);
            i += 1;
        } else {
            j -= 1;
            right.add(&prims[i]);
            prims.swap(i, j);
        }
    }
    (i, [left, right])
}
