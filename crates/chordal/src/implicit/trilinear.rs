//! `Trilinear`: the trilinear interpolant of a grid.
use super::affine::Affine3;
use super::grid::Grid;
use super::leaf::{Leaf, LeafAnswer, LeafError};
use super::sparse::SparseGrid;
use crate::budget::Evidence;
use crate::math::{Box3, Interval, add_up, greater, lesser, mul_up, sub_down};
use std::sync::Arc;

/// The trilinear interpolant of a grid, dense or in bricks, as a leaf of expressions: the same samples give
/// the same bits.
///
/// Outside the lattice the value is that of the nearest index: each index is clamped between the first and
/// the last sample, so the function is continuous everywhere. The values are those of the samples; a density
/// becomes a field by `level − grid`. If a sample of the cell is NaN, the value is NaN, which counts as
/// outside.
///
/// Intervals are rounded outward, contain the computed values, and enclose the inverse of the lattice's
/// transform. In boxes of up to 64 cells they come from the corners of the box's part of each cell, otherwise
/// from the samples of blocks of cells.
///
/// ```
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal::implicit::evaluation::Trilinear;
/// use chordal::implicit::leaves::Leaf;
/// let grid = Grid::new([2, 2, 2], Samples::U8(vec![0, 1, 0, 1, 0, 1, 0, 1]), Affine3::IDENTITY)?;
/// let mut values = [0.0; 2];
/// Trilinear::new(grid).at(&[[0.25, 0.5, 0.5], [9.0, 0.0, 0.0]], &mut values).unwrap();
/// assert_eq!(values, [0.25, 1.0]);
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
#[derive(Clone, Debug)]
pub struct Trilinear<G = Grid> {
    grid: Arc<G>,
    /// From space to indices: three rows of `[a, b, c]` for a point minus the first sample's.
    inverse: [[Interval; 3]; 3],
    /// The smallest and largest samples of blocks of cells: first of blocks of 4³ cells, then of 4³ blocks of
    /// the level before.
    levels: Vec<MinMaxLevel>,
}

/// Samples on a lattice, dense or in bricks.
pub trait SampleGrid: Send + Sync + std::fmt::Debug {
    /// The number of samples along each index.
    fn size(&self) -> [usize; 3];

    /// The map from indices to space.
    fn affine(&self) -> &Affine3;

    /// One sample.
    fn sample(&self, index: [usize; 3]) -> f64;

    /// Whether the samples of the brick of 8³ that holds this one may differ; otherwise all equal the
    /// background, or minus that.
    fn is_stored(&self, _index: [usize; 3]) -> bool {
        true
    }
}

impl SampleGrid for Grid {
    fn size(&self) -> [usize; 3] {
        self.size()
    }

    fn affine(&self) -> &Affine3 {
        self.affine()
    }

    #[inline]
    fn sample(&self, index: [usize; 3]) -> f64 {
        self.sample(index)
    }
}

impl SampleGrid for SparseGrid {
    fn size(&self) -> [usize; 3] {
        self.size()
    }

    fn is_stored(&self, index: [usize; 3]) -> bool {
        self.is_stored(index)
    }

    fn affine(&self) -> &Affine3 {
        self.affine()
    }

    #[inline]
    fn sample(&self, index: [usize; 3]) -> f64 {
        self.sample(index)
    }
}

/// Samples that are shared.
impl<G: SampleGrid> SampleGrid for Arc<G> {
    fn size(&self) -> [usize; 3] {
        G::size(self)
    }

    fn affine(&self) -> &Affine3 {
        G::affine(self)
    }

    #[inline]
    fn sample(&self, index: [usize; 3]) -> f64 {
        G::sample(self, index)
    }

    fn is_stored(&self, index: [usize; 3]) -> bool {
        G::is_stored(self, index)
    }
}

/// The sample intervals of blocks of cells.
#[derive(Clone, Debug)]
struct MinMaxLevel {
    /// Blocks along each index.
    size: [usize; 3],
    /// The smallest and largest sample; [`Interval::UNKNOWN`] if one is not finite.
    ranges: Vec<Interval>,
}

/// The most cells, or blocks of a level, that are combined into one interval.
const MOST_BLOCKS: usize = 64;
/// Cells along a block, and blocks of one level along one of the next.
const BLOCK: usize = 4;

impl<G: SampleGrid> Trilinear<G> {
    /// The leaf of a grid. Cost: one pass over the samples, and a twentieth of the bytes of an f64 grid.
    #[must_use]
    pub fn new(grid: G) -> Self {
        let inverse = inverse(grid.affine());
        let levels = levels(&grid);
        Self { grid: Arc::new(grid), inverse, levels }
    }

    /// The grid.
    #[must_use]
    pub fn grid(&self) -> &G {
        &self.grid
    }

    /// The fractional index of a point, not clamped.
    fn to_index(&self, point: [f64; 3]) -> [f64; 3] {
        let rows = self.grid.affine().rows();
        let from: [f64; 3] = std::array::from_fn(|k| point[k] - rows[k][3]);
        self.inverse.map(|row| {
            let term = |k: usize| row[k].midpoint().unwrap_or(0.0) * from[k];
            (term(0) + term(1)) + term(2)
        })
    }

    /// The lower sample along an axis and the fraction of the way to the next one, clamped to the lattice.
    fn split(&self, axis: usize, index: f64) -> (usize, f64) {
        let last = (self.grid.size()[axis] - 1) as f64;
        let clamped = if index > 0.0 { lesser(index, last) } else { 0.0 };
        // The last sample is the end of the last cell, with a fraction of 1.
        let low = (clamped.floor() as usize).min(self.grid.size()[axis].saturating_sub(2));
        (low, clamped - low as f64)
    }

    /// The eight samples of the cell that starts at a lower sample; repeated along an axis of one sample.
    fn corners(&self, low: [usize; 3]) -> [f64; 8] {
        let size = self.grid.size();
        std::array::from_fn(|c| {
            self.grid.sample(std::array::from_fn(|k| (low[k] + (c >> k & 1)).min(size[k] - 1)))
        })
    }

    /// The fractional indices that a box of space may contain, not clamped.
    fn index_ranges(&self, bounds: &Box3) -> [Interval; 3] {
        let rows = self.grid.affine().rows();
        let from: [Interval; 3] = std::array::from_fn(|k| {
            let side = Interval::new(bounds.min[k], bounds.max[k]).unwrap_or(Interval::UNKNOWN);
            side - Interval::point(rows[k][3])
        });
        self.inverse.map(|row| (row[0] * from[0] + row[1] * from[1]) + row[2] * from[2])
    }

    /// The cells that a range of indices touches: first and last along each axis.
    fn cells(&self, indices: &[Interval; 3]) -> [[usize; 2]; 3] {
        std::array::from_fn(|k| {
            let (low, _) = self.split(k, indices[k].lo());
            let (high, part) = self.split(k, indices[k].hi());
            // A box that ends on a sample touches only the cell before it, whose values there are the same.
            [low, if part == 0.0 && high > low { high - 1 } else { high }]
        })
    }

    fn range(&self, bounds: &Box3) -> Interval {
        let indices = self.index_ranges(bounds);
        if indices.iter().any(|range| range.is_empty() || range.lo().is_nan() || !range.is_defined()) {
            return Interval::UNKNOWN;
        }
        let cells = self.cells(&indices);
        if count(&cells) > MOST_BLOCKS {
            return self.coarse_range(&cells);
        }
        each(&cells)
            .map(|low| {
                let corners = self.corners(low);
                with_rounding(value_over(&corners, &cell_fractions(&indices, low)), &corners)
            })
            .reduce(Interval::hull)
            .unwrap_or(Interval::UNKNOWN)
    }

    /// The interval of the samples of all blocks that cover the cells, on the first level with few enough of
    /// them.
    fn coarse_range(&self, cells: &[[usize; 2]; 3]) -> Interval {
        let mut blocks = *cells;
        for level in &self.levels {
            blocks = blocks.map(|[low, high]| [low / BLOCK, high / BLOCK]);
            if count(&blocks) <= MOST_BLOCKS {
                let at = |[i, j, k]: [usize; 3]| level.ranges[i + level.size[0] * (j + level.size[1] * k)];
                let range = each(&blocks).map(at).reduce(Interval::hull).unwrap_or(Interval::UNKNOWN);
                return with_rounding(range, &[range.lo(), range.hi()]);
            }
        }
        Interval::UNKNOWN
    }

    fn gradient_range(&self, bounds: &Box3) -> [Interval; 3] {
        let indices = self.index_ranges(bounds);
        if indices.iter().any(|range| range.is_empty() || !range.is_defined()) {
            return [Interval::UNKNOWN; 3];
        }
        let cells = self.cells(&indices);
        let size = self.grid.size();
        let mut slopes = if count(&cells) > MOST_BLOCKS {
            // No difference of two samples is larger than that of the largest and the smallest.
            let range = self.coarse_range(&cells);
            {
                let width = range.width();
                let slope = Interval::new(-width, width).unwrap_or(Interval::UNKNOWN);
                [if range.is_defined() { slope } else { Interval::UNKNOWN }; 3]
            }
        } else {
            let grow = |cells: [[usize; 2]; 3]| -> [[usize; 2]; 3] {
                std::array::from_fn(|k| {
                    // On a sample the slopes of both sides count.
                    let last = size[k].saturating_sub(2);
                    let low = indices[k].lo().floor() == indices[k].lo() && cells[k][0] > 0;
                    let high = indices[k].hi().floor() == indices[k].hi();
                    [cells[k][0] - usize::from(low), (cells[k][1] + usize::from(high)).min(last)]
                })
            };
            let cells = grow(cells);
            let slopes =
                each(&cells).map(|low| slopes_over(&self.corners(low), &cell_fractions(&indices, low)));
            slopes.reduce(|a, b| std::array::from_fn(|k| a[k].hull(b[k]))).unwrap_or([Interval::UNKNOWN; 3])
        };
        for k in 0..3 {
            // Outside the lattice the index is constant.
            if indices[k].lo() <= 0.0 || indices[k].hi() >= (size[k] - 1) as f64 {
                slopes[k] = slopes[k].hull(Interval::point(0.0));
            }
        }
        std::array::from_fn(|k| {
            (self.inverse[0][k] * slopes[0] + self.inverse[1][k] * slopes[1]) + self.inverse[2][k] * slopes[2]
        })
    }
}

impl<G: SampleGrid> Leaf for Trilinear<G> {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        for (point, out) in points.iter().zip(out) {
            let index = self.to_index(*point);
            let split: [(usize, f64); 3] = std::array::from_fn(|k| self.split(k, index[k]));
            let v = self.corners(split.map(|s| s.0));
            let [x, y, z] = split.map(|s| s.1);
            let along = |c: usize| v[c] * (1.0 - x) + v[c + 1] * x;
            let low = along(0) * (1.0 - y) + along(2) * y;
            let high = along(4) * (1.0 - y) + along(6) * y;
            let value = low * (1.0 - z) + high * z;
            *out = if index.iter().any(|x| x.is_nan()) { f64::NAN } else { value };
        }
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        for (point, out) in points.iter().zip(out) {
            let index = self.to_index(*point);
            let split: [(usize, f64); 3] = std::array::from_fn(|k| self.split(k, index[k]));
            let v = self.corners(split.map(|s| s.0));
            let part = split.map(|s| s.1);
            let mut slope: [f64; 3] = std::array::from_fn(|k| {
                let (p, q) = ((k + 1) % 3, (k + 2) % 3);
                let difference = |a: usize, b: usize| {
                    let low = a << p | b << q;
                    v[low | 1 << k] - v[low]
                };
                let near = difference(0, 0) * (1.0 - part[p]) + difference(1, 0) * part[p];
                let far = difference(0, 1) * (1.0 - part[p]) + difference(1, 1) * part[p];
                near * (1.0 - part[q]) + far * part[q]
            });
            // Beyond the lattice the value is constant along an index.
            for k in 0..3 {
                if index[k] < 0.0 || index[k] > (self.grid.size()[k] - 1) as f64 {
                    slope[k] = 0.0;
                }
            }
            *out = std::array::from_fn(|k| {
                let term = |row: usize| self.inverse[row][k].midpoint().unwrap_or(0.0) * slope[row];
                (term(0) + term(1)) + term(2)
            });
        }
        Ok(LeafAnswer::Given)
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        for (bounds, out) in boxes.iter().zip(out) {
            *out = self.range(bounds);
        }
        Ok(LeafAnswer::Given)
    }

    fn gradient_over(&self, boxes: &[Box3], out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        for (bounds, out) in boxes.iter().zip(out) {
            *out = self.gradient_range(bounds);
        }
        Ok(LeafAnswer::Given)
    }

    fn evidence(&self) -> Evidence {
        Evidence::Proved
    }
}

/// The number of cells or blocks from first to last.
fn count(ranges: &[[usize; 2]; 3]) -> usize {
    ranges.iter().map(|[low, high]| high - low + 1).fold(1, usize::saturating_mul)
}

fn each(ranges: &[[usize; 2]; 3]) -> impl Iterator<Item = [usize; 3]> + '_ {
    let [x, y, z] = *ranges;
    (z[0]..=z[1]).flat_map(move |k| (y[0]..=y[1]).flat_map(move |j| (x[0]..=x[1]).map(move |i| [i, j, k])))
}

/// The part of a cell that a range of indices covers, from 0 to 1 along each axis.
fn cell_fractions(indices: &[Interval; 3], low: [usize; 3]) -> [Interval; 3] {
    let unit = Interval::new(0.0, 1.0).unwrap_or(Interval::UNKNOWN);
    std::array::from_fn(|k| {
        let part = (indices[k] - Interval::point(low[k] as f64)).intersection(unit);
        if !part.is_empty() {
            part
        } else if indices[k].hi() < low[k] as f64 + 0.5 {
            // Rounding may leave the cell just beyond the range: then its nearer end counts.
            Interval::point(0.0)
        } else {
            Interval::point(1.0)
        }
    })
}

/// The interval of a weighted mean of two intervals; its extremes are at the ends of the weight.
fn lerp_range(a: Interval, b: Interval, part: Interval) -> Interval {
    let at = |t: f64| a * (Interval::point(1.0) - Interval::point(t)) + b * Interval::point(t);
    let either = at(part.lo()).hull(at(part.hi()));
    // A mean is never outside of its operands.
    either.intersection(a.hull(b))
}

/// The interval of the interpolant over a part of a cell. It is linear along each axis, so its extremes are
/// at the corners of the part: these are computed in plain numbers, axis by axis, and widened once for all
/// their roundings. Intervals throughout took most of the time of entire proofs.
fn value_over(v: &[f64; 8], [x, y, z]: &[Interval; 3]) -> Interval {
    if !v.iter().all(|v| v.is_finite()) || [x, y, z].iter().any(|part| part.is_empty()) {
        return Interval::UNKNOWN;
    }
    let (low_sample, high_sample) =
        v[1..].iter().fold((v[0], v[0]), |(a, b), v| (lesser(*v, a), greater(*v, b)));
    let Ok(hull) = Interval::new(low_sample, high_sample) else { return Interval::UNKNOWN };
    let rounding = rounding_of_means(v);
    if greater(low_sample.abs(), high_sample.abs()) > 0.5 * f64::MAX {
        // Means may overflow.
        return hull;
    }
    let mean = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
    let ends = |part: &Interval| [part.lo(), part.hi()];
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    // A part without width along an axis has one end there: often it is a point.
    let n_ends = |part: &Interval| if part.lo() == part.hi() { 1 } else { 2 };
    for x in &ends(x)[..n_ends(x)] {
        let lines = [0, 2, 4, 6].map(|c| mean(v[c], v[c + 1], *x));
        for y in &ends(y)[..n_ends(y)] {
            let (near, far) = (mean(lines[0], lines[1], *y), mean(lines[2], lines[3], *y));
            for z in &ends(z)[..n_ends(z)] {
                let value = mean(near, far, *z);
                (low, high) = (lesser(value, low), greater(value, high));
            }
        }
    }
    // A mean is never outside of its operands.
    Interval::new(sub_down(low, rounding), add_up(high, rounding))
        .map_or(hull, |around| around.intersection(hull))
}

/// More than the error of three means in a row, of three roundings each, if no operand exceeds the largest of
/// some numbers. The smallest normal number covers underflow.
fn rounding_of_means(samples: &[f64]) -> f64 {
    let largest = samples.iter().fold(0.0, |most: f64, v| greater(v.abs(), most));
    add_up(mul_up(8.0 * f64::EPSILON, largest), f64::MIN_POSITIVE)
}

/// Widens an interval of the interpolant to contain the result of [`Leaf::at`]: a mean of two equal samples
/// can be off by its last place. A mean of numbers that are not negative is not negative either, rounded or
/// not, and likewise for numbers that are not positive.
fn with_rounding(range: Interval, samples: &[f64]) -> Interval {
    let rounding = rounding_of_means(samples);
    let around = Interval::new(-rounding, rounding).unwrap_or(Interval::UNKNOWN);
    let end = |lo: f64, hi: f64| Interval::new(lo, hi).unwrap_or(Interval::UNKNOWN);
    let wide = range + around;
    let wide =
        if samples.iter().all(|v| *v >= 0.0) { wide.intersection(end(0.0, f64::INFINITY)) } else { wide };
    if samples.iter().all(|v| *v <= 0.0) { wide.intersection(end(f64::NEG_INFINITY, 0.0)) } else { wide }
}

/// The intervals of the derivatives along the indices over a part of a cell. Each is bilinear in the other
/// two indices.
fn slopes_over(v: &[f64; 8], parts: &[Interval; 3]) -> [Interval; 3] {
    std::array::from_fn(|k| {
        let (p, q) = ((k + 1) % 3, (k + 2) % 3);
        let difference = |a: usize, b: usize| {
            let low = a << p | b << q;
            Interval::point(v[low | 1 << k]) - Interval::point(v[low])
        };
        let near = lerp_range(difference(0, 0), difference(1, 0), parts[p]);
        let far = lerp_range(difference(0, 1), difference(1, 1), parts[p]);
        lerp_range(near, far, parts[q])
    })
}

/// The inverse of the linear part, enclosed in intervals.
fn inverse(affine: &Affine3) -> [[Interval; 3]; 3] {
    let m = affine.rows().map(|row| [row[0], row[1], row[2]].map(Interval::point));
    let minor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant = (m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1)) + m[0][2] * minor(0, 2);
    std::array::from_fn(|r| std::array::from_fn(|c| minor(c, r) / determinant))
}

/// The intervals of blocks, level by level until one block covers everything.
fn levels<G: SampleGrid>(grid: &G) -> Vec<MinMaxLevel> {
    let size = grid.size();
    let mut blocks = size.map(|n| (n - 1).max(1).div_ceil(BLOCK));
    let first = all(blocks).map(|block| {
        let mut range = Interval::EMPTY;
        let mut is_finite = true;
        // Blocks share the samples at their border.
        let span = |k: usize| block[k] * BLOCK..=((block[k] + 1) * BLOCK).min(size[k] - 1);
        for k in span(2) {
            for j in span(1) {
                for i in span(0) {
                    let value = grid.sample([i, j, k]);
                    is_finite &= value.is_finite();
                    range = range.hull(Interval::point(value));
                }
            }
        }
        let hull = || Interval::new(range.lo(), range.hi()).unwrap_or(Interval::UNKNOWN);
        if is_finite { hull() } else { Interval::UNKNOWN }
    });
    let first = first.collect();
    let mut levels = vec![MinMaxLevel { size: blocks, ranges: first }];
    while blocks.iter().any(|n| *n > 1) {
        let below = &levels[levels.len() - 1];
        let fine = below.size;
        blocks = fine.map(|n| n.div_ceil(BLOCK));
        let ranges = all(blocks).map(|block| {
            let span: [[usize; 2]; 3] =
                std::array::from_fn(|k| [block[k] * BLOCK, ((block[k] + 1) * BLOCK).min(fine[k]) - 1]);
            let at = |[i, j, k]: [usize; 3]| below.ranges[i + fine[0] * (j + fine[1] * k)];
            each(&span).map(at).reduce(Interval::hull).unwrap_or(Interval::UNKNOWN)
        });
        let ranges = ranges.collect();
        levels.push(MinMaxLevel { size: blocks, ranges });
    }
    levels
}

fn all(size: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..size[2]).flat_map(move |k| (0..size[1]).flat_map(move |j| (0..size[0]).map(move |i| [i, j, k])))
}
