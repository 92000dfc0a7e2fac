//! Halving of the cells that need it: an octree in each cell of a lattice, until the bound of every cell is within a length.
//!
//! In each round every cell that the surface passes gets a bound (`octree_bound.rs`), cells with bounds above the length
//! are halved along each index, and their parts that the surface passes are cells of the next round. A bound by triangles
//! is renewed after a cell near it was halved. The rounds end when all bounds are within the length, or before the
//! triangles exceed their limit.
use super::halved_lattice::HalvedLattice;
use super::octree::{HalvedCells, OctreeCell};
pub(in crate::convert) use super::octree::{MOST_HALVINGS, has_keys};
pub(in crate::convert) use super::octree_bound::LevelLattice;
use super::octree_bound::{CellEvidence, OctreeCellKind, OctreeProof};
pub(in crate::convert) use super::octree_mesh::OctreeMesh;
use super::rule::Polygonize;
use super::sign_bits::SignBits;
use super::source::SampleSource;
use super::transition_cells::OctreeSurface;
use crate::budget::{Job, par_map};
use crate::implicit::Affine3;
use crate::math::{greater, lesser};
use std::collections::BTreeMap;

/// The goal of a refinement and its limits.
pub(in crate::convert) struct RefinementGoal<'a> {
    /// The lattice, and the lattices of one halving after another, up to the limit.
    pub levels: &'a [LevelLattice],
    pub length: f64,
    /// The most triangles and bytes.
    pub triangles: u64,
    pub bytes: u64,
    /// The largest size of a sample, and the bits of integer samples.
    pub sample_precision: (f64, Option<u32>),
}

/// A mesh with its bound, for vertices as written.
pub(in crate::convert) struct RefinedIsosurface {
    /// None if no cell was halved: then the bound is for the mesh of the lattice.
    pub mesh: Option<OctreeMesh>,
    pub most: f64,
    pub least: f64,
    /// The point that attains the lower bound, or the middle of the cell with the largest bound.
    pub at: [f64; 3],
    /// Whether the side of every value is certain.
    pub is_sure: bool,
}

/// A leaf that the surface passes.
#[derive(Clone)]
struct BoundedCell {
    cell: OctreeCell,
    /// Infinite as long as it has none.
    most: f64,
    evidence: CellEvidence,
    triangles: u32,
}

/// The memory of a triangle while its mesh is made. Derived, and rounded up to a power of two: 12 bytes of indices, twice,
/// and half a vertex, of 56 bytes with its order, and as many while they are sorted.
const BYTES_OF_TRIANGLE: u64 = 128;
/// Triangles that a halved cell has for each that it had.
const GROWTH: u64 = 4;
/// A bound by rows above so many times the length is not improved by cutting up. Measured: such a bound is up to 12 times
/// the distance on smooth shapes.
const HOPELESS: f64 = 16.0;
/// Cells of one kind share their bound if there are at most so many kinds, and at least so many cells of each: as in
/// `bound.rs`.
const MOST_KINDS: usize = 4096;
const SHARED: usize = 4;
/// If the length is out of reach, the aim falls by this factor from one round to the next, and one in so many cells and
/// some more may be cut up: as in `bound.rs`.
const FALL: f64 = 0.6;
const SHARE: usize = 8;
const SOME: usize = 4096;
/// An aim that is out of reach grows by this factor. Chosen: the bound is at most that much too large.
const NEXT_AIM: f64 = 1.25;
/// The number of cells, with the largest bounds, that are searched for a lower bound. Chosen: as in `bound.rs`.
const WITNESSES: usize = 64;

/// Halves cells of a source until the bound is within the goal's length, or as far as the goal allows; `None` if the job
/// is cancelled, or if no cell has corners on both sides.
pub(in crate::convert) fn refine(
    source: &dyn SampleSource,
    (affine, rule): (&Affine3, &Polygonize),
    goal: &RefinementGoal<'_>,
    job: &Job,
) -> Option<RefinedIsosurface> {
    let slack = (0..goal.levels.len() as u32)
        .map(|level| {
            HalvedLattice::slack(
                level,
                (greater(goal.sample_precision.0, rule.level.abs()), goal.sample_precision.1),
            )
        })
        .fold(0.0, |most, slack| greater(slack, most));
    let halved = HalvedCells::none(source.size());
    let mut refinement = OctreeRefinement {
        source,
        affine,
        rule,
        goal,
        slack,
        job,
        halved,
        leaves: Vec::new(),
        is_sure: true,
    };
    refinement.leaves = refinement.passed_cells();
    refinement.run()
}

struct OctreeRefinement<'a> {
    source: &'a dyn SampleSource,
    affine: &'a Affine3,
    rule: &'a Polygonize,
    goal: &'a RefinementGoal<'a>,
    /// The largest error of a value of any level.
    slack: f64,
    job: &'a Job,
    halved: HalvedCells,
    /// In the order of the lattice's cells, and of the parts in each.
    leaves: Vec<BoundedCell>,
    is_sure: bool,
}

/// A bit for each cell of a lattice.
struct CellFlags {
    size: [usize; 3],
    words: Vec<u64>,
}

impl CellFlags {
    fn new(samples: [usize; 3]) -> Self {
        let size = samples.map(|n| n - 1);
        Self { size, words: vec![0; size.iter().product::<usize>().div_ceil(64)] }
    }

    fn number(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.size[0] * (j + self.size[1] * k)
    }

    fn has(&self, cell: [usize; 3]) -> bool {
        let number = self.number(cell);
        self.words[number / 64] >> (number % 64) & 1 == 1
    }

    /// Sets the bits of a cell and of all cells around it.
    fn set_around(&mut self, cell: [usize; 3]) {
        let span = |k: usize| cell[k].saturating_sub(1)..(cell[k] + 2).min(self.size[k]);
        let (x, y, z) = (span(0), span(1), span(2));
        for k in z {
            for j in y.clone() {
                for i in x.clone() {
                    let number = self.number([i, j, k]);
                    self.words[number / 64] |= 1 << (number % 64);
                }
            }
        }
    }
}

impl BoundedCell {
    fn new(cell: OctreeCell) -> Self {
        Self { cell, most: f64::INFINITY, evidence: CellEvidence::Lasting, triangles: 0 }
    }
}

impl OctreeRefinement<'_> {
    fn surface(&self) -> OctreeSurface<'_> {
        let Self { source, affine, rule, halved, slack, .. } = self;
        OctreeSurface { source: *source, affine, rule, halved, slack: *slack }
    }

    /// The cells of the lattice that the surface passes.
    fn passed_cells(&self) -> Vec<BoundedCell> {
        let bits = SignBits::new(self.source, self.rule, self.job);
        let [_, ny, nz] = self.source.size();
        let planes: Vec<usize> = (0..nz - 1).collect();
        let cells = par_map(self.job, &planes, |_, k| {
            let mut cells = Vec::new();
            for j in 0..ny - 1 {
                bits.cases([j, *k], |i, _| {
                    cells.push(BoundedCell::new(OctreeCell { level: 0, at: [i, j, *k].map(|i| i as u32) }));
                });
            }
            cells
        });
        cells.concat()
    }

    fn run(mut self) -> Option<RefinedIsosurface> {
        let mut changed = None;
        let mut before: Option<(HalvedCells, Vec<BoundedCell>)> = None;
        let is_met = loop {
            self.bound_cells(changed.as_ref());
            if self.job.is_cancelled() {
                return None;
            }
            let triangles = self.triangles();
            // More triangles than were expected from halving: back to the state before it.
            if !self.allows(triangles)
                && let Some((halved, leaves)) = before.take()
            {
                (self.halved, self.leaves) = (halved, leaves);
                break false;
            }
            let (mut wide, mut more) = (0, 0);
            for leaf in self.leaves.iter().filter(|leaf| self.is_to_be_halved(leaf)) {
                wide += 1;
                more += (GROWTH - 1) * u64::from(leaf.triangles);
            }
            if wide == 0 {
                break !self.leaves.iter().any(|leaf| leaf.most > self.goal.length);
            }
            if !self.allows(triangles + more) || self.job.is_over() {
                break false;
            }
            before = Some((self.halved.clone(), self.leaves.clone()));
            changed = Some(self.halve_cells());
        };
        if !is_met {
            self.improve_largest_bounds();
        }
        self.finish(changed.is_some())
    }

    fn triangles(&self) -> u64 {
        self.leaves.iter().map(|leaf| u64::from(leaf.triangles)).sum()
    }

    fn allows(&self, triangles: u64) -> bool {
        let bytes = triangles.saturating_mul(BYTES_OF_TRIANGLE)
            + 2 * (self.leaves.len() * size_of::<BoundedCell>()) as u64
            + 2 * self.halved.bytes();
        triangles <= self.goal.triangles && bytes <= self.goal.bytes
    }

    fn is_to_be_halved(&self, leaf: &BoundedCell) -> bool {
        leaf.most > self.goal.length && usize::from(leaf.cell.level) + 1 < self.goal.levels.len()
    }

    /// Bounds the cells without a bound, and the `changed` cells with a bound by triangles.
    fn bound_cells(&mut self, changed: Option<&CellFlags>) {
        let surface = self.surface();
        let proof = OctreeProof { surface: &surface, levels: self.goal.levels, length: self.goal.length };
        let is_changed = |leaf: &BoundedCell| {
            leaf.most == f64::INFINITY || changed.is_some_and(|cells| cells.has(leaf.cell.root()))
        };
        let todo: Vec<usize> = (0..self.leaves.len()).filter(|at| is_changed(&self.leaves[*at])).collect();
        // 1. By rows of cells.
        let bounds = par_map(self.job, &todo, |_, at| {
            let mut leaf = self.leaves[*at].clone();
            if self.job.is_cancelled() {
                return leaf;
            }
            let values = surface.values(leaf.cell);
            leaf.triangles = 0;
            surface.for_each_triangle(leaf.cell, &values, |_| leaf.triangles += 1);
            if leaf.most == f64::INFINITY || leaf.evidence == CellEvidence::OfTriangles {
                leaf.most = proof.lasting_bound(leaf.cell, &values);
                leaf.evidence = CellEvidence::Lasting;
            }
            leaf
        });
        // 2. By their triangles.
        let is_open = |leaf: &BoundedCell| {
            let is_hopeless =
                leaf.most > HOPELESS * self.goal.length && leaf.most < proof.diagonal_bound(leaf.cell);
            leaf.most > self.goal.length && !is_hopeless && proof.may_cut(leaf.cell)
        };
        let open: Vec<OctreeCell> =
            bounds.iter().filter(|leaf| is_open(leaf)).map(|leaf| leaf.cell).collect();
        let near = self.bounds_by_triangles(&proof, &open);
        let mut near = near.into_iter();
        // The cells of `open` in the same order: a leaf changes only after it was tested.
        let mut better = bounds;
        for leaf in better.iter_mut().filter(|leaf| is_open(leaf)) {
            if let Some(most) = near.next().flatten() {
                (leaf.most, leaf.evidence) = (most, CellEvidence::OfTriangles);
            }
        }
        for (at, leaf) in todo.into_iter().zip(better) {
            self.leaves[at] = leaf;
        }
    }

    /// The bounds of cells by their triangles, if these are near enough: one for each kind if there are few kinds.
    fn bounds_by_triangles(&self, proof: &OctreeProof<'_>, cells: &[OctreeCell]) -> Vec<Option<f64>> {
        let job = self.job;
        let kinds = par_map(job, cells, |_, cell| proof.kind(*cell));
        let mut bound_of_kind: BTreeMap<OctreeCellKind, Option<f64>> = BTreeMap::new();
        let most = MOST_KINDS.min(cells.len() / SHARED);
        for kind in kinds.iter().flatten() {
            // One more than allowed shows that there are too many.
            if bound_of_kind.len() <= most {
                bound_of_kind.insert(*kind, None);
            }
        }
        let is_shared = bound_of_kind.len() <= most;
        if is_shared {
            let kinds: Vec<OctreeCellKind> = bound_of_kind.keys().copied().collect();
            let bounds =
                par_map(
                    job,
                    &kinds,
                    |_, kind| {
                        if job.is_cancelled() { None } else { proof.bound_of_kind(kind) }
                    },
                );
            bound_of_kind = kinds.into_iter().zip(bounds).collect();
        }
        let work: Vec<(OctreeCell, Option<OctreeCellKind>)> = cells.iter().copied().zip(kinds).collect();
        par_map(job, &work, |_, (cell, kind)| match kind {
            _ if job.is_cancelled() => None,
            Some(kind) if is_shared => bound_of_kind.get(kind).copied().flatten(),
            _ => proof.bound_if_near(*cell),
        })
    }

    /// Halves the cells with bounds above the length; returns the cells of the lattice around them.
    fn halve_cells(&mut self) -> CellFlags {
        let halved: Vec<OctreeCell> =
            self.leaves.iter().filter(|leaf| self.is_to_be_halved(leaf)).map(|leaf| leaf.cell).collect();
        let parts = par_map(self.job, &halved, |_, cell| self.passed_parts(*cell));
        let mut changed = CellFlags::new(self.source.size());
        halved.iter().for_each(|cell| changed.set_around(cell.root()));
        self.halved.halve(&halved);
        let mut leaves = Vec::with_capacity(self.leaves.len() + 4 * halved.len());
        // In the order of the leaves.
        let mut parts = parts.into_iter();
        for leaf in std::mem::take(&mut self.leaves) {
            if !self.halved.is_cell_halved(leaf.cell) {
                leaves.push(leaf);
            } else if let Some((cells, is_sure)) = parts.next() {
                leaves.extend(cells.into_iter().map(BoundedCell::new));
                self.is_sure &= is_sure;
            }
        }
        self.leaves = leaves;
        changed
    }

    /// The parts of a cell that the surface passes, and whether the sides of all corners are certain.
    fn passed_parts(&self, cell: OctreeCell) -> (Vec<OctreeCell>, bool) {
        let mut is_sure = true;
        let mut passed = Vec::new();
        for part in cell.parts() {
            let lattice =
                HalvedLattice { coarse: self.source, rule: self.rule, level: u32::from(part.level) };
            let corners = lattice.corner_values(part.index());
            let signs = corners.values.map(|value| self.rule.is_inside(value));
            if signs != [true; 8] && signs != [false; 8] {
                passed.push(part);
            }
            // A rounded value within its error of the level may be on the other side.
            let is_near = |c: usize| (corners.values[c] - self.rule.level).abs() <= self.slack;
            is_sure &= !(0..8).any(|c| !corners.exact[c] && is_near(c));
        }
        (passed, is_sure)
    }

    /// If the length is out of reach: improves the largest bounds, in rounds, as long as these are few and fall.
    fn improve_largest_bounds(&mut self) {
        let surface = self.surface();
        let proof = OctreeProof { surface: &surface, levels: self.goal.levels, length: self.goal.length };
        let largest =
            |leaves: &[BoundedCell]| leaves.iter().fold(0.0, |most: f64, leaf| greater(leaf.most, most));
        let mut leaves = self.leaves.clone();
        loop {
            let worst = largest(&leaves);
            let goal = greater(FALL * worst, self.goal.length);
            let open: Vec<usize> = (0..leaves.len()).filter(|at| leaves[*at].most > goal).collect();
            if open.is_empty() || open.len() > leaves.len() / SHARE + SOME || self.job.is_cancelled() {
                break;
            }
            let better = par_map(self.job, &open, |_, at| {
                let BoundedCell { cell, most, .. } = leaves[*at];
                let mut aim = goal;
                while most > aim && !self.job.is_cancelled() {
                    if let Some(bound) = proof.bound_within(cell, aim) {
                        return lesser(bound, most);
                    }
                    aim *= NEXT_AIM;
                }
                most
            });
            open.iter().zip(better).for_each(|(at, most)| leaves[*at].most = most);
            // Another round would not help.
            if largest(&leaves) > 0.97 * worst {
                break;
            }
        }
        self.leaves = leaves;
    }

    /// The mesh, if cells were halved, and its bound.
    fn finish(self, is_halved: bool) -> Option<RefinedIsosurface> {
        let surface = self.surface();
        let proof = OctreeProof { surface: &surface, levels: self.goal.levels, length: self.goal.length };
        let mut order: Vec<usize> = (0..self.leaves.len()).collect();
        order.sort_unstable_by(|a, b| {
            self.leaves[*b].most.total_cmp(&self.leaves[*a].most).then_with(|| a.cmp(b))
        });
        order.truncate(WITNESSES);
        let witnesses = par_map(self.job, &order, |_, at| {
            if self.job.is_cancelled() { None } else { proof.witness(self.leaves[*at].cell, 0.0) }
        });
        let mut seen: Option<(f64, [f64; 3])> = None;
        for witness in witnesses.into_iter().flatten() {
            if seen.is_none_or(|seen| witness.0 > seen.0) {
                seen = Some(witness);
            }
        }
        let cells: Vec<OctreeCell> = self.leaves.iter().map(|leaf| leaf.cell).collect();
        let mesh = is_halved.then(|| OctreeMesh::new(&surface, &cells, self.job));
        let worst = &self.leaves[*order.first()?];
        if self.job.is_cancelled() {
            return None;
        }
        let middle = {
            let side = 1.0 / (1_u64 << worst.cell.level) as f64;
            let offset = self.rule.offset;
            [0, 1, 2].map(|k| offset[k] as f64 + (f64::from(worst.cell.at[k]) + 0.5) * side)
        };
        // Both bounds are for the mesh as written.
        let least = lesser(seen.map_or(0.0, |seen| seen.0), worst.most);
        Some(RefinedIsosurface {
            mesh,
            most: worst.most,
            least,
            at: seen.map_or(self.affine.at(middle), |seen| seen.1),
            is_sure: self.is_sure || self.slack == 0.0,
        })
    }
}
