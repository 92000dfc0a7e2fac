//! Bounds the distance between a marching cubes mesh and the trilinear isosurface, proved cell by cell.
//!
//! Let g be the interpolant minus the level, negated if high is inside, so that the shape is {g < 0}, and
//! S its boundary in the lattice's box (a tie is outside). Coordinates of a cell are indices, from 0 to 1.
//! `mesh` is the mesh with its vertices at the exact zeros of g on the edges; the written mesh differs from
//! it by rounding and by the margin, which are added at the end.
//!
//! **Every cell by its diagonal.** In a cell g is a convex combination of the corners. So a cell without
//! inside corners has no point with g < 0, and a cell without outside corners has only such points. So a point
//! of S lies in a cell with both kinds of corners, and so do triangles. Such a cell has an edge with ends on
//! both sides, and on it a vertex of the mesh and a point of S. So a point of the mesh or of S is within the
//! longest diagonal of its cell of the other.
//!
//! **g on a triangle.** Along each axis g is linear, so its Hessian H has no diagonal. Let q = Σ λᵢ Vᵢ be on
//! a triangle of the cell, with g(Vᵢ) = 0. Taylor's formula about q gives 0 = Σ λᵢ g(Vᵢ) = g(q) + ½ Σ λᵢ
//! (Vᵢ−q)ᵀ H(ξᵢ) (Vᵢ−q), hence |g(q)| ≤ Σ λᵢ (|Δx||Δy| Mxy + |Δy||Δz| Myz + |Δx||Δz| Mxz), with M the largest
//! mixed derivatives in the cell: each is linear in the third coordinate, so it is the larger of two second
//! differences of corners. By Cauchy and Schwarz Σ λᵢ|Δx||Δy| ≤ √(Σ λᵢΔx² · Σ λᵢΔy²), and a variance is at
//! most a quarter of the squared range (Popoviciu). Ranges are at most 1, so |g| ≤ e = (Mxy + Myz + Mxz)/4 on
//! all triangles of the cell.
//!
//! **A point far from 0 is on its side of the mesh.** Let g(x) > e at a point x of a cell. Along x's line in
//! the first axis g is linear, so it does not fall in one of the two directions. Go there to the cell's side,
//! then likewise along the second and third axis: a path to a corner on which g > e. It meets no triangle of
//! the cell, since |g| ≤ e on these, and the corner is outside. The mesh separates outside corners from inside
//! corners in every cell, so x is outside of the mesh. Likewise x with g(x) < −e is inside of it.
//!
//! **Three cells in a row.** Take a cell and the two cells beside it along an axis. Suppose that all 12
//! differences along the axis have one sign and are at least m > 0 in size; e is the largest of the three
//! cells. If r = e/m ≤ 1, points of the cell on the mesh or on S are within r of the other:
//! - From a point of S go along the axis by a little more than r both ways. That stays in the three cells,
//!   along it g changes by at least m a unit, so it ends at g > e and at g < −e: on different sides of the
//!   mesh, which therefore crosses the line between.
//! - From a point of the mesh, with |g| ≤ e, go along the axis by r, in the direction in which g falls or rises
//!   to 0: S is on the way.
//! - A point of S in a capped border that contains the axis has g ≤ 0. If g < −e, the point is inside of the
//!   mesh and in the border, hence in a cap. Otherwise go along the axis, in the border, to a point with
//!   g < −e: there are caps on the way, or the point is on one. A point of a cap of the mesh has g ≤ e, by the
//!   same formula with g ≤ 0 at its corners; if g > 0, go to a point with g = 0.
//!
//! A row that would leave the lattice is not used; then, and if the bound is large, another axis is tried.
//!
//! **The other cells**, those without such a row and those with the largest bounds, are cut up
//! (`cell_prover.rs`), aiming at an eighth more than the lower bound of the distance. So the result depends on
//! the actual shape, not on the worst case of a formula.
//!
//! For halved cells of several levels see `octree_bound.rs`.
use super::cell_prover::CellProver;
use super::marching_cubes::MarchingPlan;
use super::rule::{Border, Polygonize};
use super::slopes::{CellLanes, LANES, LOW, MinSlopeKernel, ShiftKernel, run, shift};
use super::source::{DenseSamples, SampleSource};
use crate::budget::{Job, par_map};
use crate::implicit::Affine3;
use crate::math::{Box3, add_up, div_up, greater, lesser, mul_up};
use std::collections::BTreeMap;

/// Half a unit in the last place of 1: the relative error of one rounding.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// An upper bound of the distance with its cell, and a lower bound with a point that attains it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IsosurfaceDistance {
    pub most: f64,
    pub at: [usize; 3],
    pub least: f64,
    pub witness: Option<[f64; 3]>,
}

/// The proof, with the numbers of the lattice that it needs.
pub(crate) struct IsosurfaceProof<'a> {
    local: CellProver<'a>,
    size: [usize; 3],
    /// The lengths of the three steps in space, rounded up.
    lengths: [f64; 3],
    /// A bound of this length suffices.
    enough: f64,
    /// The number of cells that may be cut up in addition to their share.
    some: usize,
    /// A bound of this fraction of the diagonal suffices, too.
    fine: f64,
    /// Whether the proof goes on if a bound of `enough` is out of reach.
    goes_on: bool,
}

/// Cells in each slab that are searched for a lower bound: cells with the largest bounds, and some cells without
/// a bound.
const WITNESSES: usize = 4;
/// The aim is the lower bound times this.
const AIM: f64 = 1.125;
/// A fraction of a cell's diagonal. Measured on a gyroid: below it, cutting up costs more than it improves.
const FINE: f64 = 1.0 / 32.0;
/// The same for a block. Measured on waves in 64 blocks: a quarter of the time with the fraction above, and the same
/// bound for the whole.
const FINE_OF_BLOCK: f64 = 1.0 / 16.0;
/// Bounds are stored in f32, rounded up: the aim is less by two such roundings, so that the stored bound is
/// within the request.
const STORED: f64 = 1.0 - f32::EPSILON as f64;
/// The aim falls by this factor from one round to the next.
const FALL: f64 = 0.6;
/// Cells with the same corners are proved once if there are at most so many kinds, and at least so many cells of each.
/// Chosen: a mask has 254 kinds, and eight times as many once it is halved.
const MOST_KINDS: usize = 4096;
const SHARED: usize = 4;
/// An aim that is out of reach for a kind grows by this factor. Chosen: the bound is at most that much too large, and
/// four steps double the aim.
const NEXT_AIM: f64 = 1.1875;
/// At most one in `SHARE` cells is cut up, plus `SOME` cells.
const SHARE: usize = 8;
const SOME: usize = 4096;

/// The values at the corners of a cell, less the level, as bits; and the capped borders of the cell, one bit for each of
/// six.
type CellKind = ([u64; 8], u8);

/// A cell with its bound, as a fraction of the diagonal.
#[derive(Clone, Copy)]
struct CellBound {
    most: f32,
    at: [u32; 3],
    /// The slab that stores the bound, and the number of the bound in it.
    slab: u32,
    number: u32,
}

impl<'a> IsosurfaceProof<'a> {
    pub fn new(
        source: &'a dyn SampleSource,
        affine: &'a Affine3,
        rule: &'a Polygonize,
        (moved, rounding): (f64, f64),
    ) -> Self {
        let diagonal = diagonal(affine);
        let lengths = affine.steps().map(|step| length_up(step.map(f64::abs)));
        let local = CellProver {
            source,
            rule,
            affine,
            diagonal,
            moved,
            rounding,
            slack: 0.0,
            gives_up: false,
            octree: None,
        };
        Self { local, size: source.size(), lengths, enough: 0.0, some: SOME, fine: FINE, goes_on: false }
    }

    /// The same proof, with a bound of `enough` as its goal.
    pub fn with_enough(self, enough: f64) -> Self {
        Self { enough, ..self }
    }

    /// The same proof for one of many blocks. With a length as the goal, all cells that need it are cut up. Without one, only
    /// a share of the cells is, down to larger parts, since every block has a worst cell.
    pub fn of_block(self, enough: f64) -> Self {
        let some = if enough > 0.0 { usize::MAX / 2 } else { 0 };
        Self { enough, some, fine: FINE_OF_BLOCK, goes_on: true, ..self }
    }

    /// The bound for all cells, without the rounding of vertices.
    pub fn max_distance(&self, plan: &MarchingPlan, job: &Job) -> IsosurfaceDistance {
        // 1. A bound for each cell.
        let mut slabs = plan.for_each_slab(job, |_, walk| {
            let mut rows = CellBatch::new(self);
            walk(&mut |at, _| {
                if !job.is_cancelled() {
                    rows.add(at);
                }
            });
            rows.finish()
        });
        let n_cells = slabs.iter().map(Vec::len).sum::<usize>();
        self.share_equal_cells(plan, &mut slabs, job);
        let top = self.length_of(largest_bound(&slabs));
        let none = IsosurfaceDistance { most: top, at: [0; 3], least: 0.0, witness: None };
        if job.is_cancelled() || n_cells == 0 {
            return none;
        }
        // 2. The lower bound.
        let candidates = plan.for_each_slab(job, |number, walk| {
            let picked = select_cells(&slabs[number]);
            let mut cells = Vec::new();
            let mut n = 0;
            walk(&mut |at, _| {
                if picked.binary_search(&n).is_ok() {
                    cells.push(at);
                }
                n += 1;
            });
            let mut seen: Option<(f64, [f64; 3])> = None;
            for cell in cells {
                if !job.is_cancelled() {
                    seen = self.local.witness(cell, seen.map_or(0.0, |s| s.0)).or(seen);
                }
            }
            seen
        });
        let mut seen = farther(None, candidates);
        // 3. Cells with the largest bounds get better bounds, in rounds, until the lower bound is near or the
        // cells are too many.
        let mut worst = none;
        for round in 0.. {
            let least = seen.map_or(0.0, |s| s.0);
            let aim = greater(self.enough, greater(self.fine * self.local.diagonal, AIM * least));
            let is_out_of_reach = least > self.enough && self.enough > 0.0 && !self.goes_on;
            if worst.most <= aim || is_out_of_reach || job.is_cancelled() {
                break;
            }
            let goal = STORED * greater(FALL * worst.most, aim);
            let mut cells = cells_above(plan, &slabs, self.to_diagonals(goal), job);
            // Cells that have no bound yet get one, however many they are.
            let is_open = round == 0 && worst.most >= 0.75 * self.local.diagonal;
            if cells.len() > n_cells / SHARE + self.some && !is_open {
                break;
            }
            let better =
                par_map(
                    job,
                    &cells,
                    |_, cell| if job.is_cancelled() { *cell } else { self.tighten(*cell, goal) },
                );
            better.iter().for_each(|cell| slabs[cell.slab as usize][cell.number as usize] = cell.most);
            cells = better;
            cells.sort_unstable_by(|a, b| b.most.total_cmp(&a.most).then_with(|| a.at.cmp(&b.at)));
            let looked_at = &cells[..cells.len().min(64)];
            let more = par_map(job, looked_at, |_, cell| {
                if job.is_cancelled() { None } else { self.local.witness(cell.at.map(|i| i as usize), least) }
            });
            seen = farther(seen, more);
            let before = worst.most;
            worst.most = self.length_of(largest_bound(&slabs));
            worst.at = cells.first().map_or([0; 3], |cell| cell.at.map(|i| i as usize));
            // Another round would not help.
            if worst.most > 0.97 * before {
                break;
            }
        }
        IsosurfaceDistance { least: seen.map_or(0.0, |s| s.0), witness: seen.map(|s| s.1), ..worst }
    }

    /// Gives all cells with the same corners and the same capped borders one bound, if there are few such kinds.
    fn share_equal_cells(&self, plan: &MarchingPlan, slabs: &mut [Vec<f32>], job: &Job) {
        let n_cells = slabs.iter().map(Vec::len).sum::<usize>();
        let most = MOST_KINDS.min(n_cells / SHARED);
        // A slab with too many kinds stops early.
        let kinds = plan.for_each_slab(job, |_, walk| {
            let mut kinds = BTreeMap::new();
            let mut last = None;
            walk(&mut |at, _| {
                if kinds.len() <= most {
                    let kind = self.kind(at);
                    if last != Some(kind) {
                        kinds.entry(kind).or_insert(0.0_f32);
                        last = Some(kind);
                    }
                }
            });
            kinds
        });
        let mut shared: BTreeMap<CellKind, f32> = BTreeMap::new();
        for kinds in kinds {
            shared.extend(kinds);
            if shared.len() > most || job.is_cancelled() {
                return;
            }
        }
        let kinds: Vec<CellKind> = shared.into_keys().collect();
        let bounds =
            par_map(job, &kinds, |_, kind| if job.is_cancelled() { 1.0 } else { self.bound_of_kind(kind) });
        let bound_of: BTreeMap<CellKind, f32> = kinds.into_iter().zip(bounds).collect();
        let better = plan.for_each_slab(job, |number, walk| {
            let mut bounds = slabs[number].iter();
            let mut better = Vec::with_capacity(slabs[number].len());
            walk(&mut |at, _| {
                let bound_by_rows = bounds.next().copied().unwrap_or(1.0);
                better.push(
                    bound_of.get(&self.kind(at)).map_or(bound_by_rows, |bound| lesser(*bound, bound_by_rows)),
                );
            });
            better
        });
        slabs.iter_mut().zip(better).for_each(|(slab, better)| *slab = better);
    }

    /// The kind of a cell: its triangles and the interpolant in it depend on this alone, except for their position.
    fn kind(&self, at: [usize; 3]) -> CellKind {
        let mut capped = 0;
        for (k, border) in self.local.rule.border.iter().enumerate() {
            let ends = [at[k] == 0, at[k] + 2 == self.size[k]];
            for end in (0..2).filter(|end| ends[*end] && border[*end] == Border::Capped) {
                capped |= 1 << (2 * k + end);
            }
        }
        (self.corners(at).map(f64::to_bits), capped)
    }

    /// The bound of a cell in a separate lattice around the origin, with open borders except for capped ones: the proof for
    /// its triangles and its part of S holds in the whole lattice.
    fn bound_of_kind(&self, (corners, capped): &CellKind) -> f32 {
        let rule = self.local.rule;
        let border = [0, 1, 2].map(|k| {
            [0, 1].map(|end| if capped >> (2 * k + end) & 1 == 1 { Border::Capped } else { Border::Open })
        });
        let rule = Polygonize { border, offset: [0; 3], level: 0.0, ..*rule };
        let values = corners.map(f64::from_bits);
        let source = DenseSamples { values: &values, size: [2; 3], rule };
        let Ok(affine) = Affine3::new(self.local.affine.rows().map(|[a, b, c, _]| [a, b, c, 0.0])) else {
            return 1.0;
        };
        let CellProver { diagonal, moved, rounding, slack, .. } = self.local;
        let prover = CellProver {
            source: &source,
            rule: &rule,
            affine: &affine,
            diagonal,
            moved,
            rounding,
            slack,
            gives_up: true,
            octree: None,
        };
        // A search gives up once it is beyond its aim, so that low aims are cheap to try first.
        let mut most = diagonal;
        let mut aim = STORED * greater(self.enough, self.fine * diagonal);
        while most > aim {
            most = lesser(prover.cell_distance([0; 3], aim), most);
            aim *= NEXT_AIM;
        }
        // The roundings of triangles in the whole lattice differ from those in this one.
        self.to_diagonals(add_up(most, mul_up(2.0, rounding)))
    }

    /// Improves the bound of a cell, aiming at `aim`.
    fn tighten(&self, cell: CellBound, aim: f64) -> CellBound {
        let at = cell.at.map(|i| i as usize);
        let corners = self.corners(at);
        let mut most = self.length_of(cell.most);
        for axis in 0..3 {
            if most > aim {
                let planes = self.planes(at, axis, &corners);
                most = lesser(mul_up(shift(&planes, [0.0; 2], self.local.slack), self.lengths[axis]), most);
            }
        }
        // If the aim is out of reach, it grows.
        let mut goal = aim;
        while most > goal {
            most = lesser(self.local.cell_distance(at, goal), most);
            goal *= 1.25;
        }
        CellBound { most: self.to_diagonals(most), ..cell }
    }

    /// A length as a fraction of the diagonal, rounded up.
    fn to_diagonals(&self, length: f64) -> f32 {
        let part = div_up(length, self.local.diagonal);
        f32_up(lesser(part, 1.0))
    }

    /// The length of a fraction of the diagonal, rounded up.
    fn length_of(&self, part: f32) -> f64 {
        lesser(self.local.diagonal, mul_up(f64::from(part), self.local.diagonal))
    }

    fn sample(&self, [i, j, k]: [usize; 3]) -> f64 {
        self.local.rule.finite_sample(self.local.source.at([i, j, k])) - self.local.rule.level
    }

    fn corners(&self, [i, j, k]: [usize; 3]) -> [f64; 8] {
        std::array::from_fn(|c| self.sample([i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)]))
    }

    /// The values on the four planes of three cells in a row; the middle cell has these corners.
    fn planes(&self, at: [usize; 3], axis: usize, corners: &[f64; 8]) -> [[f64; 4]; 4] {
        let beside = |c: usize, behind: bool| {
            let mut there = [at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2)];
            there[axis] =
                // Beyond the lattice the last plane is repeated. Its difference is 0, so such a row proves
                // nothing.
                if behind { (at[axis] + 2).min(self.size[axis] - 1) } else { at[axis].saturating_sub(1) };
            self.sample(there)
        };
        let low = LOW[axis];
        [
            low.map(|c| beside(c, false)),
            low.map(|c| corners[c]),
            low.map(|c| corners[c + (1 << axis)]),
            low.map(|c| beside(c, true)),
        ]
    }
}

/// The cells of a slab, in batches of `LANES`.
struct CellBatch<'a> {
    proof: &'a IsosurfaceProof<'a>,
    at: Vec<[usize; 3]>,
    corners: Box<[CellLanes; 8]>,
    planes: Box<[[CellLanes; 4]; 4]>,
    out: Vec<f32>,
}

impl<'a> CellBatch<'a> {
    fn new(proof: &'a IsosurfaceProof<'a>) -> Self {
        let at = Vec::with_capacity(LANES);
        Self {
            proof,
            at,
            corners: Box::new([[0.0; LANES]; 8]),
            planes: Box::new([[[0.0; LANES]; 4]; 4]),
            out: Vec::new(),
        }
    }

    fn add(&mut self, at: [usize; 3]) {
        let lane = self.at.len();
        let corners = self.proof.corners(at);
        for (c, corner) in corners.into_iter().enumerate() {
            self.corners[c][lane] = corner;
        }
        self.at.push(at);
        if lane + 1 == LANES {
            self.flush();
        }
    }

    fn flush(&mut self) {
        let mut slowest = [[0.0; LANES]; 3];
        run(MinSlopeKernel { corners: &self.corners, out: &mut slowest });
        let mut axes = [3; LANES];
        for (lane, at) in self.at.iter().enumerate() {
            // The axis with the largest slope of its slowest edge; but one with three cells in a row comes
            // first, whatever its slope.
            let mut best = (false, 0.0);
            for axis in 0..3 {
                let slope = slowest[axis][lane];
                let has_row = at[axis] > 0 && at[axis] + 2 < self.proof.size[axis];
                if slope > 0.0 && (has_row, slope) > best {
                    best = (has_row, slope);
                    axes[lane] = axis;
                }
            }
            if axes[lane] < 3 {
                let corners = std::array::from_fn(|c| self.corners[c][lane]);
                let planes = self.proof.planes(*at, axes[lane], &corners);
                for (lanes, plane) in self.planes.iter_mut().zip(planes) {
                    for (lanes, value) in lanes.iter_mut().zip(plane) {
                        lanes[lane] = value;
                    }
                }
            }
        }
        let mut shifts = [0.0; LANES];
        run(ShiftKernel { planes: &self.planes, slack: self.proof.local.slack, out: &mut shifts });
        for lane in 0..self.at.len() {
            let most = match axes[lane] {
                3 => self.proof.local.diagonal,
                axis => lesser(self.proof.local.diagonal, mul_up(shifts[lane], self.proof.lengths[axis])),
            };
            self.out.push(self.proof.to_diagonals(most));
        }
        self.at.clear();
    }

    fn finish(mut self) -> Vec<f32> {
        self.flush();
        self.out
    }
}

/// The nearest f32 that is not below.
fn f32_up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

/// The farthest of all; the first of equals.
fn farther(first: Option<(f64, [f64; 3])>, rest: Vec<Option<(f64, [f64; 3])>>) -> Option<(f64, [f64; 3])> {
    rest.into_iter()
        .flatten()
        .fold(first, |best, one| if best.is_none_or(|best| one.0 > best.0) { Some(one) } else { best })
}

/// The numbers of cells to examine: some of those with the largest bound, and as many with the next largest.
fn select_cells(bounds: &[f32]) -> Vec<usize> {
    let top = bounds.iter().fold(0.0, |m: f32, x| greater(*x, m));
    let equal: Vec<usize> = (0..bounds.len()).filter(|i| bounds[*i] == top).collect();
    let mut picked: Vec<usize> =
        equal.iter().step_by(equal.len().div_ceil(WITNESSES).max(1)).copied().collect();
    let mut others: Vec<usize> =
        (0..bounds.len()).filter(|i| bounds[*i] < top && bounds[*i] > 0.5 * top).collect();
    if others.len() > WITNESSES {
        others.select_nth_unstable_by(WITNESSES, |a, b| bounds[*b].total_cmp(&bounds[*a]).then(a.cmp(b)));
        others.truncate(WITNESSES);
    }
    picked.extend(others);
    picked.sort_unstable();
    picked
}

/// Cells with bounds above `aim`.
fn cells_above(plan: &MarchingPlan, slabs: &[Vec<f32>], aim: f32, job: &Job) -> Vec<CellBound> {
    let cells = plan.for_each_slab(job, |slab, walk| {
        let bounds = &slabs[slab];
        let mut cells = Vec::new();
        if bounds.iter().any(|bound| *bound > aim) {
            let mut n = 0;
            walk(&mut |at, _| {
                if bounds[n] > aim {
                    cells.push(CellBound {
                        most: bounds[n],
                        at: at.map(|i| i as u32),
                        slab: slab as u32,
                        number: n as u32,
                    });
                }
                n += 1;
            });
        }
        cells
    });
    cells.concat()
}

fn largest_bound(slabs: &[Vec<f32>]) -> f32 {
    slabs.iter().flatten().fold(0.0, |m: f32, x| greater(*x, m))
}

/// The longest diagonal of a cell, rounded up.
pub(crate) fn diagonal(affine: &Affine3) -> f64 {
    let steps = affine.steps();
    let diagonals = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[y, z]| {
        length_up([0, 1, 2].map(|k| {
            let sum = (steps[0][k] + y * steps[1][k]) + z * steps[2][k];
            let size = (steps[0][k].abs() + steps[1][k].abs()) + steps[2][k].abs();
            // Two additions, each with a rounding of at most that fraction of the size.
            add_up(sum.abs(), mul_up(4.0 * ROUNDING, size))
        }))
    });
    diagonals.into_iter().fold(0.0, |most, d| greater(d, most))
}

fn length_up(sides: [f64; 3]) -> f64 {
    Box3 { min: [0.0; 3], max: sides }.diagonal()
}
