//! `SignLattice`: the sign of a field on a lattice of cubes, sampled near the surface and proved elsewhere.
//!
//! If the range over a block of samples, extended to the samples around it, has one sign, its cells contain no
//! surface. The other blocks are halved down to blocks of 2³ samples; those that remain cover the surface.
use super::leaf_failure;
use crate::budget::{Failure, Job, RefusalCode, par_map};
use crate::convert::Polygonize;
use crate::convert::cubes::marching_cubes::{Isosurface, march};
use crate::convert::cubes::source::SampleSource;
use crate::convert::grid_to_mesh::{check, vertex_errors};
use crate::convert::lattice::{BRICK, Lattice};
use crate::explicit::Mesh;
use crate::implicit::{Affine3, Field, LeafError, Tape};
use crate::math::{Box3, Interval, greater, length_up, mul_up, sqrt_up, sub_up};

/// Samples of a brick, and the 2³ blocks of them.
const VOLUME: usize = BRICK * BRICK * BRICK;
const BLOCKS: usize = VOLUME / 8;
/// Entries of the directory for bricks without samples: all outside, all inside.
const OUTSIDE: u32 = u32::MAX;
const INSIDE: u32 = u32::MAX - 1;
/// Boxes of a task. Chosen: enough to repay its start, and neighbours that share intermediate results.
const TASK: usize = 256;
/// How far beyond one step the first sample lies outside the bounds, in steps. Chosen: no simple fractions, so
/// that samples are seldom on faces that are parallel to an axis.
const SHIFT: [f64; 3] = [0.381_966, 0.436_571, 0.291_503];
/// Bytes for each triangle of a lattice's mesh: itself, its share of vertices, and of the tree and its construction.
/// Measured: a tree takes 80.
const BYTES_A_TRIANGLE: u64 = 200;

/// The samples of a brick near the surface.
pub(super) struct SignBrick {
    /// Its number along each index.
    pub at: [u32; 3],
    /// A bit for each block of 2³ samples, set if its cells may contain a part of the surface.
    pub blocks: u64,
    /// The values in single precision, with the same signs.
    values: Vec<f32>,
}

/// The sign of a field on a lattice.
pub(super) struct SignLattice {
    pub lattice: Lattice,
    pub bricks: Vec<SignBrick>,
    directory: Vec<u32>,
    n_bricks: [usize; 3],
    rule: Polygonize,
    step: f64,
    n_doubtful: u64,
}

/// The side of all points of a box, by the range of a field in it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum RangeSide {
    Inside,
    Outside,
    Unknown,
}

impl RangeSide {
    /// A point without a value is outside.
    pub(super) fn from_range(range: Interval) -> Self {
        if range.is_defined() && range.hi() < 0.0 {
            Self::Inside
        } else if range.lo() > 0.0 && !range.is_empty() {
            Self::Outside
        } else {
            Self::Unknown
        }
    }
}

impl SignLattice {
    /// Samples a field whose bounds are finite on cubes of side `step`.
    pub(super) fn sample(field: &Field, step: f64, job: &Job) -> Result<Self, Failure<Mesh>> {
        let rule = Polygonize::below(0.0);
        let lattice = lattice_around(&field.bounds(), step)?;
        check(lattice.size, &lattice.affine, &rule)?;
        let n_bricks = lattice.size.map(|n| n.div_ceil(BRICK));
        let n_entries: usize = n_bricks.iter().product();
        // The directory, and the sign bits for marching cubes.
        check_memory(4 * n_entries as u64 + lattice.len() as u64 / 8, job)?;
        let mut sampled = Self {
            lattice,
            bricks: Vec::new(),
            directory: vec![OUTSIDE; n_entries],
            n_bricks,
            rule,
            step,
            n_doubtful: 0,
        };
        let tape = Tape::new(field.sign());
        let near = sampled.bricks_near_surface(&tape, job)?;
        if job.is_finishing() {
            return Err(unfinished());
        }
        check_memory(near.len() as u64 * (4 * VOLUME + 64) as u64, job)?;
        let done = par_map(job, &near, |_, at| {
            let is_over = job.is_cancelled() || job.is_finishing();
            if is_over { Ok((None, 0)) } else { sampled.sample_brick(&tape, *at) }
        });
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        // Some bricks may be missing.
        if job.is_finishing() {
            return Err(unfinished());
        }
        for (result, at) in done.into_iter().zip(&near) {
            let (brick, n_doubtful) = result.map_err(|error| leaf_failure(&error))?;
            let entry = sampled.entry(*at);
            sampled.n_doubtful += n_doubtful;
            if let Some(brick) = brick {
                sampled.directory[entry] = sampled.bricks.len() as u32;
                sampled.bricks.push(brick);
            }
        }
        Ok(sampled)
    }

    /// The bricks whose range has both signs, searched from large blocks to small ones; the entries of the others are set.
    fn bricks_near_surface(&mut self, tape: &Tape, job: &Job) -> Result<Vec<[u32; 3]>, Failure<Mesh>> {
        let widest = self.n_bricks.iter().fold(1, |most, n| (*n).max(most));
        let mut level = widest.next_power_of_two().trailing_zeros();
        let mut blocks = vec![[0_u32; 3]];
        loop {
            let side = BRICK << level;
            let end = |at: [u32; 3]| at.map(|k| (k as usize + 1) * side);
            let hulls: Vec<Box3> =
                blocks.iter().map(|at| self.hull([at.map(|k| k as usize * side), end(*at)])).collect();
            let sides = range_sides(tape, &hulls, job)?;
            if job.is_finishing() {
                return Err(unfinished());
            }
            let mut open = Vec::new();
            for (at, side) in blocks.into_iter().zip(sides) {
                match side {
                    RangeSide::Unknown => open.push(at),
                    RangeSide::Outside => {}
                    RangeSide::Inside => self.fill(at, level),
                }
            }
            if level == 0 {
                return Ok(open);
            }
            level -= 1;
            // Each block becomes eight, of three numbers of four bytes.
            check_memory(8 * 12 * open.len() as u64, job)?;
            let parts = open.iter().flat_map(|at| {
                (0..8_u32).map(move |part| [0, 1, 2].map(|k| 2 * at[k as usize] + (part >> k & 1)))
            });
            // Blocks beyond the lattice hold no samples.
            let n = self.n_bricks;
            blocks = parts.filter(|at| (0..3).all(|k| ((at[k] as usize) << level) < n[k])).collect();
        }
    }

    /// Marks a block of bricks as inside.
    fn fill(&mut self, at: [u32; 3], level: u32) {
        let first = at.map(|k| (k as usize) << level);
        let end: [usize; 3] = std::array::from_fn(|k| (first[k] + (1 << level)).min(self.n_bricks[k]));
        for k in first[2]..end[2] {
            for j in first[1]..end[1] {
                let row = self.n_bricks[0] * (j + self.n_bricks[1] * k);
                self.directory[row + first[0]..row + end[0]].fill(INSIDE);
            }
        }
    }

    fn entry(&self, at: [u32; 3]) -> usize {
        let [i, j, k] = at.map(|k| k as usize);
        i + self.n_bricks[0] * (j + self.n_bricks[1] * k)
    }

    /// A box around samples and all cells that have one of them as a corner.
    pub(super) fn hull(&self, [first, end]: [[usize; 3]; 2]) -> Box3 {
        let last: [usize; 3] = std::array::from_fn(|k| end[k].min(self.lattice.size[k]));
        let Box3 { min, max } = self.lattice.hull([first, last]);
        let margin = mul_up(self.step, 1.0 + f64::EPSILON);
        Box3 { min: min.map(|x| -sub_up(margin, x)), max: max.map(|x| crate::math::add_up(x, margin)) }
    }

    /// Samples a brick; also returns the number of samples whose sign may be wrong through rounding.
    fn sample_brick(&self, tape: &Tape, at: [u32; 3]) -> Result<(Option<SignBrick>, u64), LeafError> {
        let first = at.map(|k| k as usize * BRICK);
        // Outside, until a range or a value shows otherwise.
        let mut values = vec![self.step as f32; VOLUME];
        // 1. From the whole brick to blocks of 2³ samples.
        let mut open = vec![[0_usize; 3]];
        let mut size = BRICK;
        while size > 2 {
            size /= 2;
            let halves = open.iter().flat_map(|at| {
                (0..8_usize).map(move |part| [0, 1, 2].map(|k| at[k] + size * (part >> k & 1)))
            });
            let within = halves.filter(|at| (0..3).all(|k| first[k] + at[k] < self.lattice.size[k]));
            let blocks: Vec<[usize; 3]> = within.collect();
            let hulls: Vec<Box3> = blocks
                .iter()
                .map(|at| {
                    let low: [usize; 3] = std::array::from_fn(|k| first[k] + at[k]);
                    self.hull([low, low.map(|x| x + size)])
                })
                .collect();
            let mut ranges = vec![Interval::UNKNOWN; hulls.len()];
            tape.over(&hulls, &mut ranges)?;
            open.clear();
            for (at, range) in blocks.into_iter().zip(ranges) {
                match RangeSide::from_range(range) {
                    RangeSide::Unknown => open.push(at),
                    RangeSide::Outside => {}
                    RangeSide::Inside => {
                        each_in(at, size, |inner| values[inner] = -self.step as f32);
                    }
                }
            }
        }
        // 2. The samples of the blocks that are still open, by ranges at points, which include rounding.
        let (mut blocks, mut rows, mut points) = (0_u64, Vec::new(), Vec::new());
        for at in &open {
            blocks |= 1 << block_of(*at);
            each_in(*at, 2, |inner| {
                let index = [inner % BRICK, inner / BRICK % BRICK, inner / (BRICK * BRICK)];
                let sample: [usize; 3] = std::array::from_fn(|k| first[k] + index[k]);
                if (0..3).all(|k| sample[k] < self.lattice.size[k]) {
                    rows.push(inner);
                    points.push(self.lattice.at(sample));
                }
            });
        }
        let boxes: Vec<Box3> = points.iter().map(|p| Box3 { min: *p, max: *p }).collect();
        let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
        tape.over(&boxes, &mut ranges)?;
        let mut doubtful = (Vec::new(), Vec::new());
        for ((row, point), range) in rows.iter().zip(&points).zip(&ranges) {
            match (RangeSide::from_range(*range), range.midpoint()) {
                (RangeSide::Unknown, _) | (_, None) => {
                    doubtful.0.push(*row);
                    doubtful.1.push(*point);
                }
                (_, Some(value)) => values[*row] = signed_f32(value),
            }
        }
        // 3. Where a range leaves the sign open, the sign is that of the computed value.
        let mut computed = vec![0.0; doubtful.0.len()];
        tape.at(&doubtful.1, &mut computed)?;
        for (row, value) in doubtful.0.iter().zip(&computed) {
            values[*row] = if value.is_nan() { self.step as f32 } else { signed_f32(*value) };
        }
        let n_doubtful = doubtful.0.len() as u64;
        Ok((Some(SignBrick { at, blocks, values }), n_doubtful))
    }

    /// The triangles between the signs: closed, at least by indices.
    pub(super) fn polygonize(&self, job: &Job) -> Result<Mesh, Failure<Mesh>> {
        let isosurface: Isosurface<f64> = march(self, &self.lattice.affine, &self.rule, job)?;
        if isosurface.faces.is_empty() {
            return Err(Failure::refused(
                RefusalCode::Empty,
                "there is no surface: no sample of the lattice is inside",
            ));
        }
        check_memory(BYTES_A_TRIANGLE * isosurface.faces.len() as u64, job)?;
        Ok(Mesh::by_construction(isosurface.positions, isosurface.faces))
    }

    /// The diagonal of a cell, rounded up.
    pub(super) fn cell_diagonal(&self) -> f64 {
        mul_up(sqrt_up(3.0), self.step)
    }

    /// The largest distance by which rounding moves samples and vertices.
    pub(super) fn rounding(&self) -> f64 {
        vertex_errors(&self.lattice.affine, &self.rule, self.lattice.size).1
    }

    /// The number of samples whose sign may be wrong through rounding.
    pub(super) fn n_doubtful(&self) -> u64 {
        self.n_doubtful
    }

    /// Whether the corners of a cell are on both sides.
    pub(super) fn is_mixed(&self, [i, j, k]: [usize; 3]) -> bool {
        let inside =
            |corner: usize| self.value([i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)]) < 0.0;
        let first = inside(0);
        (1..8).any(|corner| inside(corner) != first)
    }

    fn value(&self, index: [usize; 3]) -> f32 {
        let brick = index.map(|i| i / BRICK);
        match self.directory[brick[0] + self.n_bricks[0] * (brick[1] + self.n_bricks[1] * brick[2])] {
            OUTSIDE => self.step as f32,
            INSIDE => -self.step as f32,
            stored => {
                let [i, j, k] = index.map(|i| i % BRICK);
                self.bricks[stored as usize].values[i + BRICK * (j + BRICK * k)]
            }
        }
    }
}

impl SampleSource for SignLattice {
    fn size(&self) -> [usize; 3] {
        self.lattice.size
    }

    fn sides(&self, [j, k]: [usize; 2], words: &mut [u64]) {
        words.fill(0);
        let row = self.n_bricks[0] * (j / BRICK + self.n_bricks[1] * (k / BRICK));
        let inner = BRICK * (j % BRICK + BRICK * (k % BRICK));
        for (brick, entry) in self.directory[row..row + self.n_bricks[0]].iter().enumerate() {
            let mut bits = match *entry {
                OUTSIDE => continue,
                INSIDE => 0xFF,
                stored => {
                    let values = &self.bricks[stored as usize].values[inner..inner + BRICK];
                    values.iter().enumerate().fold(0, |bits, (i, v)| bits | u64::from(*v < 0.0) << i)
                }
            };
            let first = BRICK * brick;
            let left = self.lattice.size[0] - first;
            // Bits beyond the last sample of the row stay 0.
            if left < BRICK {
                bits &= (1 << left) - 1;
            }
            words[first / 64] |= bits << (first % 64);
        }
    }

    #[inline(always)]
    fn at(&self, index: [usize; 3]) -> f64 {
        f64::from(self.value(index))
    }
}

/// The failure of a lattice that is stopped because the job finishes: a coarser mesh is returned instead.
fn unfinished() -> Failure<Mesh> {
    Failure::refused(
        RefusalCode::Empty,
        "the time ended before the cells that the tolerance needs were sampled",
    )
}

/// The sides of many boxes; unknown for boxes that were not evaluated because the job ends.
pub(super) fn range_sides(tape: &Tape, boxes: &[Box3], job: &Job) -> Result<Vec<RangeSide>, Failure<Mesh>> {
    let tasks: Vec<&[Box3]> = boxes.chunks(TASK).collect();
    let done = par_map(job, &tasks, |_, part| {
        let mut ranges = vec![Interval::UNKNOWN; part.len()];
        let is_over = job.is_cancelled() || job.is_finishing();
        if is_over { Ok(ranges) } else { tape.over(part, &mut ranges).map(|()| ranges) }
    });
    if job.is_cancelled() {
        return Err(Failure::Cancelled);
    }
    let mut sides = Vec::with_capacity(boxes.len());
    for ranges in done {
        sides.extend(
            ranges.map_err(|error: LeafError| leaf_failure(&error))?.into_iter().map(RangeSide::from_range),
        );
    }
    Ok(sides)
}

/// Cubes around a box, with two steps and a bit beyond it on each side.
fn lattice_around(bounds: &Box3, step: f64) -> Result<Lattice, Failure<Mesh>> {
    let origin: [f64; 3] = std::array::from_fn(|k| bounds.min[k] - (1.0 + SHIFT[k]) * step);
    let counts: [f64; 3] = std::array::from_fn(|k| ((bounds.max[k] - origin[k]) / step).ceil() + 3.0);
    let largest = counts.iter().fold(0.0, |most, n| greater(*n, most));
    // Indices of bricks and blocks stay far below 2³².
    if largest.is_nan() || largest >= f64::from(1_u32 << 24) {
        let message = format!("the tolerance is so small that the shape is {largest:.1e} cells wide");
        return Err(Failure::refused(RefusalCode::TooMuchMemory, message));
    }
    let affine = Affine3::cubes(origin, step);
    let affine = affine.map_err(|error| Failure::refused(RefusalCode::BelowPrecision, error.to_string()))?;
    Ok(Lattice { size: counts.map(|n| n as usize), affine })
}

/// Refuses a number of bytes beyond the job's memory.
pub(super) fn check_memory(bytes: u64, job: &Job) -> Result<(), Failure<Mesh>> {
    if bytes <= job.memory_limit {
        return Ok(());
    }
    let message = format!("cells that small need {bytes} bytes; the limit is {}", job.memory_limit);
    Err(Failure::refused(RefusalCode::TooMuchMemory, message))
}

/// The value in single precision; values below 0 stay below 0.
fn signed_f32(value: f64) -> f32 {
    let single = value as f32;
    if value < 0.0 && single == 0.0 { -f32::MIN_POSITIVE } else { single }
}

/// The number of a block of 2³ samples in its brick.
fn block_of(at: [usize; 3]) -> usize {
    let [i, j, k] = at.map(|x| x / 2);
    i + 4 * (j + 4 * k)
}

/// The first sample of a block in its brick, by the block's number.
pub(super) fn block_at(number: usize) -> [usize; 3] {
    [number % 4, number / 4 % 4, number / 16].map(|x| 2 * x)
}

/// The number of blocks in a brick.
pub(super) const N_BLOCKS: usize = BLOCKS;

/// Visits the samples of a cube in a brick.
fn each_in(at: [usize; 3], size: usize, mut visit: impl FnMut(usize)) {
    for k in at[2]..at[2] + size {
        for j in at[1]..at[1] + size {
            for i in at[0]..at[0] + size {
                visit(i + BRICK * (j + BRICK * k));
            }
        }
    }
}

/// The longest half diagonal of a box, rounded up.
pub(super) fn half_diagonal(bounds: &Box3) -> f64 {
    let middle = bounds.centre();
    let half_sides = std::array::from_fn(|k| {
        let (low, high) = (sub_up(middle[k], bounds.min[k]), sub_up(bounds.max[k], middle[k]));
        greater(low, high)
    });
    length_up::<3>(half_sides)
}
