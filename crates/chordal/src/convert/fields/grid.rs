//! `FieldGrid`: tetrahedra that are small only where a solid's boundary is not that of linear functions.
//!
//! A cube around the solid is bisected until in each tetrahedron either membership is decided, or the
//! undecided primitives have a common direction in which they grow. Decided tetrahedra are dropped: they
//! contain no boundary, whatever their neighbours look like. All others conform.
use super::cells::{CellSizes, CellTest, PrunedTree, PrunedTreeCache, ZeroSide};
use super::cells::{index_of, prune, range_side, zeros};
use super::cells_at_vertices::CellsAtVertices;
use super::sampled_signs::SampledSigns;
use super::sizing::{SizingField, SizingPoint};
use super::tetrahedra::{IntegerBox, IntegerMap, Tetrahedra, Tetrahedron};
use super::vertex_values::VertexValues;
use crate::budget::{Job, par_map};
use crate::implicit::{Csg, DualRange, LeafError, Membership, PrimitiveEvaluator};
use crate::math::{Box3, greater, length};
use std::sync::Arc;

/// The options of a grid.
#[derive(Clone, Copy, Debug)]
pub(in crate::convert) struct GridOptions {
    /// The box that contains the solid.
    pub bounds: Box3,
    /// Cells whose longest edge, before stretching, is at most this are not cut, except by
    /// [`FieldGrid::refine`].
    pub floor: f64,
    /// Cells with a longer edge are cut wherever the boundary may be. A function known only at points is
    /// sampled at this spacing first: smaller features may be missed.
    pub coarsest: f64,
}

/// How completely a grid was refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::convert) enum FieldGridStatus {
    Whole,
    /// Cells without slopes were left uncut, or the memory was used up.
    CutShort,
    /// Cells were left uncut since ranges are too wide; only requested cells are cut now.
    Exhausted,
}

/// Why there is no grid.
#[derive(Clone, Debug)]
pub(in crate::convert) enum FieldGridError {
    /// A leaf could not be evaluated.
    Leaf(LeafError),
    /// The job was cancelled.
    Cancelled,
}

impl From<LeafError> for FieldGridError {
    fn from(error: LeafError) -> Self {
        Self::Leaf(error)
    }
}

/// A cell that the boundary may pass.
#[derive(Clone, Debug)]
pub(super) struct GridCell {
    pub tetrahedron: Tetrahedron,
    pub open: Arc<PrunedTree>,
    pub is_resolved: bool,
    is_alive: bool,
}

/// A conforming set of tetrahedra around the boundary of a solid.
#[derive(Debug)]
pub(in crate::convert) struct FieldGrid<'a> {
    pub(super) csg: &'a Csg,
    pub(super) job: &'a Job,
    pub(super) options: GridOptions,
    pub(super) tetrahedra: Tetrahedra,
    pub(super) values: VertexValues,
    /// By primitive.
    pub(super) zero: Vec<ZeroSide>,
    /// By primitive: whether it contains functions of the user, whose gradients may be known at points only.
    pub(super) has_leaves: Vec<bool>,
    cells: Vec<GridCell>,
    /// The trees of all cells.
    trees: PrunedTreeCache,
    pub(super) signs: SampledSigns,
    /// Whether slopes at corners decide, as ranges are too wide.
    pub(super) goes_by_samples: bool,
    extent: FieldGridStatus,
    n_alive: usize,
    /// Beyond so many cells no more are cut.
    most_cells: usize,
    cells_at_vertices: CellsAtVertices,
}

/// The next step for a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellAction {
    Done,
    Cut,
    /// Like [`CellAction::Cut`], whatever it contains: it is larger than `coarsest`, or requested.
    CutAnyway,
    /// Like [`CellAction::Cut`], but some function in it has no known slope: at steps and poles, and without
    /// values.
    CutBlindly,
    /// Too small to be cut.
    TooSmall,
}

/// A cell that has not been classified yet.
pub(super) struct PendingCell {
    pub tetrahedron: Tetrahedron,
    pub open: Arc<PrunedTree>,
}

/// The pending cells of one level, by their boxes, with the ranges in these.
struct PendingLevel {
    boxes: Vec<IntegerBox>,
    /// By cell: its box.
    box_of: Vec<u32>,
    /// By box: its part of `primitives` and `ranges`.
    queries: Vec<[u32; 2]>,
    primitives: Vec<u32>,
    ranges: Vec<DualRange>,
}

/// The cube is larger than the bounds by this factor. Chosen: cells at the rim see the boundary from outside.
const MARGIN: f64 = 1.05;
/// The cube's middle is moved from that of the bounds by these fractions of their size, so that planes of
/// symmetric models are not in its own planes. Chosen: small and odd.
const OFFSET: [f64; 3] = [0.008_5, 0.011_55, 0.006_35];
/// Cells are so many times longer along an axis that is separate from the others: along an extrusion. Chosen:
/// a plate of a tenth of its length is one layer of cells down to a thousandth of it, and coordinates lose
/// six bits.
const STRETCH: f64 = 64.0;
/// The approximate bytes of a cell with its part of vertices and values: counted.
const BYTES_A_CELL: u64 = 400;
/// Cells may take one part in so many of the job's memory.
const SHARE: u64 = 4;
/// Cells in one task.
pub(super) const CELLS_A_TASK: usize = 128;
/// The most cells of one level that are cut at all. Chosen: a million cells in all, some seconds.
const MOST_CUT: usize = 1 << 18;
/// What is asked for at some places has at most so many times the cells. Chosen: about a pole, where vertices are off however
/// small cells are, they became twenty times as many.
const MOST_GROWTH: usize = 2;
/// So many are few. Chosen: a tenth of a second.
const FEW_CELLS: usize = 1 << 16;
/// The most cells without slopes that are cut. Chosen: steps are then resolved to a hundredth of their size,
/// and a volume without values is given up at once.
const MOST_BLIND: usize = 1 << 16;

impl<'a> FieldGrid<'a> {
    /// Builds a grid for the solid whose primitives are evaluated. The work depends on the shape, not on its
    /// size over the floor.
    ///
    /// # Errors
    /// The error of a leaf, or that the job is cancelled.
    pub fn build(
        evaluator: &mut PrimitiveEvaluator<'a>,
        options: GridOptions,
        job: &'a Job,
    ) -> Result<Self, FieldGridError> {
        let (centre, sides) = (options.bounds.centre(), options.bounds);
        let longest = (0..3).map(|k| sides.max[k] - sides.min[k]).fold(0.0, |a, b| greater(b, a));
        let side = MARGIN * longest;
        let csg = evaluator.csg();
        let stretch = separate_axes(csg).map(|is_separate| if is_separate { STRETCH } else { 1.0 });
        let origin = std::array::from_fn(|k| centre[k] + stretch[k] * (OFFSET[k] * longest - 0.5 * side));
        let (tetrahedra, all) = Tetrahedra::new(origin, side, stretch);
        let has_leaves: Vec<bool> = csg.primitives().iter().map(|p| p.tape().has_leaves()).collect();
        let zero = zeros(csg);
        let signs = SampledSigns::new(evaluator, &has_leaves, &zero, options.bounds, options.coarsest)?;
        let mut grid = Self {
            csg,
            job,
            options,
            tetrahedra,
            values: VertexValues::default(),
            zero,
            has_leaves,
            cells: Vec::new(),
            trees: PrunedTreeCache::default(),
            signs,
            goes_by_samples: false,
            extent: FieldGridStatus::Whole,
            n_alive: 0,
            most_cells: usize::MAX,
            cells_at_vertices: CellsAtVertices::default(),
        };
        (0..grid.tetrahedra.n_vertices()).for_each(|_| grid.values.push_vertex());
        let open = Arc::new(PrunedTree::new(csg.tree().clone()));
        let pending = all.into_iter().map(|tetrahedron| PendingCell { tetrahedron, open: Arc::clone(&open) });
        let nowhere = SizingField::new(&[], &[]);
        grid.refine_levels(evaluator, pending.collect(), &nowhere)?;
        Ok(grid)
    }

    /// Cuts cells that contain one of the points until they are as small as it requests. The others stay,
    /// except as far as conformity needs.
    ///
    /// # Errors
    /// Those of [`FieldGrid::build`].
    pub fn refine(
        &mut self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        places: &[SizingPoint],
    ) -> Result<(), FieldGridError> {
        let points: Vec<[f64; 3]> = places.iter().map(|place| place.at).collect();
        let asked = SizingField::new(places, &points);
        let pending: Vec<u32> = (0..self.cells.len() as u32)
            .filter(|c| {
                let cell = &self.cells[*c as usize];
                cell.is_alive && self.is_requested(&cell.tetrahedron, &asked)
            })
            .collect();
        self.most_cells = greater(MOST_GROWTH.saturating_mul(self.n_alive), FEW_CELLS);
        let pending = pending.into_iter().map(|c| self.remove_cell(c)).collect();
        self.refine_levels(evaluator, pending, &asked)
    }

    /// The length of something before stretching, from how far it reaches along each axis.
    pub fn size_of(&self, extent: [f64; 3]) -> f64 {
        let stretch = self.tetrahedra.stretch();
        length::<3>(std::array::from_fn(|k| extent[k] / stretch[k]))
    }

    /// The solid.
    pub fn csg(&self) -> &'a Csg {
        self.csg
    }

    /// Its memory, about.
    pub fn bytes(&self) -> u64 {
        BYTES_A_CELL * self.n_alive as u64 + self.trees.bytes()
    }

    #[cfg(test)]
    pub fn n_cells(&self) -> usize {
        self.n_alive
    }

    /// The cells in the order in which they were made.
    pub(super) fn cells(&self) -> impl Iterator<Item = &GridCell> {
        self.cells.iter().filter(|cell| cell.is_alive)
    }

    /// How completely the grid was refined.
    pub fn extent(&self) -> FieldGridStatus {
        self.extent
    }

    /// The cells that would have to be smaller than the floor.
    pub fn unresolved(&self) -> Vec<SizingPoint> {
        self.cells()
            .filter(|cell| !cell.is_resolved)
            .map(|cell| self.sizing_point(&cell.tetrahedron))
            .collect()
    }

    fn sizing_point(&self, one: &Tetrahedron) -> SizingPoint {
        let corners = one.corners.map(|v| self.tetrahedra.position(v));
        let at = std::array::from_fn(|k| 0.25 * corners.iter().map(|p| p[k]).sum::<f64>());
        SizingPoint { at, size: self.tetrahedra.longest(one.corners) }
    }

    fn is_requested(&self, one: &Tetrahedron, asked: &SizingField) -> bool {
        let bounds = || self.space(self.tetrahedra.box_of(one.corners));
        !asked.is_empty() && asked.is_smaller_in(&bounds(), self.tetrahedra.longest(one.corners))
    }

    fn space(&self, [min, max]: IntegerBox) -> Box3 {
        Box3 { min: self.tetrahedra.position_of(min), max: self.tetrahedra.position_of(max) }
    }

    fn remove_cell(&mut self, cell: u32) -> PendingCell {
        let cell = &mut self.cells[cell as usize];
        cell.is_alive = false;
        self.n_alive -= 1;
        PendingCell { tetrahedron: cell.tetrahedron, open: Arc::clone(&cell.open) }
    }

    /// Cuts level by level until all cells are done, too small or decided.
    fn refine_levels(
        &mut self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        mut pending: Vec<PendingCell>,
        asked: &SizingField,
    ) -> Result<(), FieldGridError> {
        let most = self.job.memory_limit / SHARE;
        while !pending.is_empty() {
            if self.job.is_cancelled() {
                return Err(FieldGridError::Cancelled);
            }
            // Every cut adds one cell, and others by conformity.
            let of_cells = BYTES_A_CELL * (self.n_alive + 2 * pending.len()) as u64;
            let is_full = of_cells + self.trees.bytes() > most
                || self.n_alive + pending.len() > self.most_cells
                || self.job.is_finishing();
            let mut judged = self.classify_cells(evaluator, pending, asked)?;
            self.refine_by_samples(evaluator, &mut judged)?;
            let count = |of: CellAction| judged.iter().filter(|(_, verdict)| *verdict == of).count();
            let (n_cut, n_blind) = (count(CellAction::Cut), count(CellAction::CutBlindly));
            if n_cut > MOST_CUT {
                self.extent = FieldGridStatus::Exhausted;
            } else if n_blind > MOST_BLIND || is_full && n_cut + n_blind > 0 {
                self.extent = self.extent.max(FieldGridStatus::CutShort);
            }
            let mut cut = Vec::new();
            for (one, verdict) in judged {
                let may_be_cut = !is_full && self.tetrahedra.refinement_edge(&one.tetrahedron).is_some();
                let is_cut = match verdict {
                    CellAction::CutAnyway => may_be_cut,
                    CellAction::Cut => may_be_cut && n_cut <= MOST_CUT,
                    CellAction::CutBlindly => may_be_cut && n_blind <= MOST_BLIND,
                    CellAction::Done | CellAction::TooSmall => false,
                };
                if is_cut || self.tetrahedra.has_middle(one.tetrahedron.corners) {
                    cut.push(one);
                } else {
                    self.add_cell(one, verdict == CellAction::Done);
                }
            }
            pending = self.bisect(cut);
            self.trees.remove_unused();
        }
        Ok(())
    }

    fn add_cell(&mut self, PendingCell { tetrahedron, open }: PendingCell, is_resolved: bool) {
        let number = self.cells.len() as u32;
        tetrahedron.corners.iter().for_each(|v| self.cells_at_vertices.push(*v, number));
        self.cells.push(GridCell { tetrahedron, open, is_resolved, is_alive: true });
        self.n_alive += 1;
    }

    /// Bisects cells, and those around the bisected edges.
    fn bisect(&mut self, cut: Vec<PendingCell>) -> Vec<PendingCell> {
        let mut halves = Vec::with_capacity(2 * cut.len());
        let mut open = cut;
        while !open.is_empty() {
            let mut edges = Vec::new();
            for one in open {
                let (parts, edge) = self.tetrahedra.bisect(&one.tetrahedron);
                halves.extend(
                    parts.map(|tetrahedron| PendingCell { tetrahedron, open: Arc::clone(&one.open) }),
                );
                if let Some(edge) = edge {
                    self.values.push_vertex();
                    edges.push(edge);
                }
            }
            // Finished cells that have one of the edges.
            open = Vec::new();
            for [a, b] in edges {
                let cells = &self.cells;
                let has_both = |c: &u32| {
                    let cell = &cells[*c as usize];
                    cell.is_alive && cell.tetrahedron.corners.contains(&a)
                };
                // The younger end has fewer cells around it.
                let found: Vec<u32> = self.cells_at_vertices.cells_at(b).filter(has_both).collect();
                open.extend(found.into_iter().map(|c| self.remove_cell(c)));
            }
        }
        halves
    }

    /// Drops decided cells, and classifies the others.
    fn classify_cells(
        &mut self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        pending: Vec<PendingCell>,
        asked: &SizingField,
    ) -> Result<Vec<(PendingCell, CellAction)>, FieldGridError> {
        let level = self.query_ranges(evaluator, &pending)?;
        let numbers: Vec<u32> = (0..pending.len() as u32).collect();
        let chunks: Vec<&[u32]> = numbers.chunks(CELLS_A_TASK).collect();
        let sift = |part: &[u32]| {
            let mut sides = Vec::new();
            let sift = |n: &u32| {
                let one = &pending[*n as usize];
                let ranges = level.ranges_of(*n, &one.open);
                let zeros = one.open.primitives.iter().map(|p| self.zero[*p as usize]);
                sides.clear();
                sides.extend(ranges.zip(zeros).map(|(range, zero)| range_side(range.value, zero)));
                prune(&one.open, &sides)
            };
            part.iter().map(sift).collect::<Vec<_>>()
        };
        let sifted: Vec<Option<Arc<PrunedTree>>> = par_map(self.job, &chunks, |_, part| sift(part)).concat();
        self.query_values(evaluator, &pending, &sifted)?;
        let view = &*self;
        let decide = |part: &[u32]| {
            let mut buffers = CellBuffers::default();
            let decide = |n: &u32| {
                let open = sifted[*n as usize].as_ref()?;
                let cell = CellQuery { level: &level, number: *n, one: pending[*n as usize].tetrahedron };
                view.cell_action(&cell, open, asked, &mut buffers)
            };
            part.iter().map(decide).collect::<Vec<_>>()
        };
        let verdicts: Vec<Option<(Arc<PrunedTree>, CellAction)>> =
            par_map(self.job, &chunks, |_, part| decide(part)).concat();
        let trees = &mut self.trees;
        let judged = pending.into_iter().zip(verdicts).filter_map(|(one, verdict)| {
            verdict.map(|(open, verdict)| {
                (PendingCell { open: trees.intern(open), tetrahedron: one.tetrahedron }, verdict)
            })
        });
        Ok(judged.collect())
    }

    /// `None` for a decided cell.
    fn cell_action(
        &self,
        cell: &CellQuery,
        open: &Arc<PrunedTree>,
        asked: &SizingField,
        buffers: &mut CellBuffers,
    ) -> Option<(Arc<PrunedTree>, CellAction)> {
        let whole = cell.level.boxes[cell.level.box_of[cell.number as usize] as usize];
        let sizes = CellSizes::new(&self.tetrahedra, cell.one.corners, self.options.floor);
        self.gather(cell, open, buffers);
        let CellBuffers { ranges, values, noise, sides, .. } = buffers;
        let facts = CellTest { csg: self.csg, open, ranges, values, noise, idle: &[], sizes };
        sides.clear();
        sides.extend(
            (0..values.len())
                .map(|k| range_side(facts.value_range(k), self.zero[open.primitives[k] as usize])),
        );
        let left = prune(open, sides)?;
        let is_requested = self.is_requested(&cell.one, asked);
        let space = self.space(whole);
        let is_coarse = sizes.longest > self.options.coarsest || is_requested;
        if is_coarse || self.misses_samples(open, values, &space, sizes.longest) {
            let is_empty = !is_requested && self.is_decided_by_signs(open, values, sides, &space);
            return Some((left, if is_empty { CellAction::Done } else { CellAction::CutAnyway }));
        }
        if !Arc::ptr_eq(&left, open) {
            self.gather(cell, &left, buffers);
        }
        self.gather_corner_gradients(cell, &left, buffers);
        let CellBuffers { ranges, values, noise, idle, .. } = buffers;
        let facts = CellTest { csg: self.csg, open: &left, ranges, values, noise, idle, sizes };
        let verdict = match (facts.is_resolved(), sizes.longest <= sizes.floor) {
            (true, _) => CellAction::Done,
            (false, true) => CellAction::TooSmall,
            (false, false) if self.extent == FieldGridStatus::Exhausted => CellAction::TooSmall,
            (false, false) if self.lacks_gradient(&left, ranges) => CellAction::CutBlindly,
            (false, false) => CellAction::Cut,
        };
        Some((left, verdict))
    }

    /// Whether the slope of some function without leaves is unknown.
    fn lacks_gradient(&self, open: &PrunedTree, ranges: &[DualRange]) -> bool {
        let is_unknown =
            |(p, range): (&u32, &DualRange)| !self.has_leaves[*p as usize] && range.gradient.is_none();
        open.primitives.iter().zip(ranges).any(is_unknown)
    }

    /// Collects the ranges and values of a cell.
    fn gather(&self, cell: &CellQuery, open: &PrunedTree, buffers: &mut CellBuffers) {
        buffers.ranges.clear();
        buffers.ranges.extend(cell.level.ranges_of(cell.number, open));
        buffers.values.clear();
        buffers.noise.clear();
        for p in &open.primitives {
            let at = cell.one.corners.map(|v| self.values.with_noise(v, *p).expect("it was asked for"));
            buffers.values.push(at.map(|[value, _]| value));
            buffers.noise.push(at.iter().fold(0.0, |most, [_, noise]| greater(*noise, most)));
        }
    }

    /// Evaluates ranges, once for each box: several tetrahedra share one.
    fn query_ranges(
        &self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        pending: &[PendingCell],
    ) -> Result<PendingLevel, FieldGridError> {
        let mut boxes: Vec<IntegerBox> = Vec::new();
        let mut numbers: IntegerMap<IntegerBox, u32> = IntegerMap::default(); // No order depends on it.
        let box_of: Vec<u32> = pending
            .iter()
            .map(|one| {
                let whole = self.tetrahedra.box_of(one.tetrahedron.corners);
                *numbers.entry(whole).or_insert_with(|| {
                    boxes.push(whole);
                    boxes.len() as u32 - 1
                })
            })
            .collect();
        // The first tree of each box, and the primitives of the other trees in it.
        let mut first: Vec<Option<&Arc<PrunedTree>>> = vec![None; boxes.len()];
        let mut others: Vec<(u32, u32)> = Vec::new();
        for (one, number) in pending.iter().zip(&box_of) {
            match first[*number as usize] {
                None => first[*number as usize] = Some(&one.open),
                Some(open) if Arc::ptr_eq(open, &one.open) => {}
                Some(_) => others.extend(one.open.primitives.iter().map(|p| (*number, *p))),
            }
        }
        others.sort_unstable();
        let mut others = others.as_slice();
        let (mut asked, mut primitives) = (Vec::with_capacity(boxes.len()), Vec::new());
        for (number, open) in first.iter().enumerate() {
            let start = primitives.len();
            primitives.extend_from_slice(&open.expect("each box has a cell").primitives);
            let n_more = others.iter().take_while(|(other, _)| *other as usize == number).count();
            if n_more > 0 {
                primitives.extend(others[..n_more].iter().map(|(_, p)| *p));
                others = &others[n_more..];
                primitives[start..].sort_unstable();
                let mut distinct = primitives.split_off(start);
                distinct.dedup();
                primitives.extend(distinct);
            }
            asked.push([start as u32, primitives.len() as u32]);
        }
        let mut questions = Vec::with_capacity(primitives.len());
        for (whole, [start, end]) in boxes.iter().zip(&asked) {
            let bounds = self.space(*whole);
            questions.extend(primitives[*start as usize..*end as usize].iter().map(|p| (*p, bounds)));
        }
        let ranges = evaluator.dual_ranges(&questions)?;
        Ok(PendingLevel { boxes, box_of, queries: asked, primitives, ranges })
    }

    /// Evaluates unknown values at the corners of undecided cells.
    fn query_values(
        &mut self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        pending: &[PendingCell],
        sifted: &[Option<Arc<PrunedTree>>],
    ) -> Result<(), FieldGridError> {
        let mut wanted: Vec<(u32, u32)> = Vec::new();
        for (one, open) in pending.iter().zip(sifted) {
            let Some(open) = open else { continue };
            for v in one.tetrahedron.corners {
                let unknown = open.primitives.iter().filter(|p| self.values.get(v, **p).is_none());
                wanted.extend(unknown.map(|p| (v, *p)));
            }
        }
        wanted.sort_unstable();
        wanted.dedup();
        let questions: Vec<(u32, [f64; 3])> =
            wanted.iter().map(|(v, p)| (*p, self.tetrahedra.position(*v))).collect();
        let points: Vec<(u32, Box3)> =
            questions.iter().map(|(p, at)| (*p, Box3 { min: *at, max: *at })).collect();
        let noise: Vec<f64> = evaluator.ranges(&points)?.iter().map(width).collect();
        if self.has_leaves.contains(&true) {
            self.values.extend_slopes(&wanted, &evaluator.duals(&questions)?, &noise);
        } else {
            self.values.extend(&wanted, &evaluator.values(&questions)?, &noise);
        }
        Ok(())
    }
}

impl PendingLevel {
    /// The ranges of a tree's primitives in the box of a cell.
    fn ranges_of<'l>(&'l self, cell: u32, open: &'l PrunedTree) -> impl Iterator<Item = DualRange> + 'l {
        let [start, end] = self.queries[self.box_of[cell as usize] as usize];
        let part = start as usize..end as usize;
        let (primitives, ranges) = (&self.primitives[part.clone()], &self.ranges[part]);
        let is_same = primitives.len() == open.primitives.len();
        let of = move |(k, p): (usize, &u32)| ranges[if is_same { k } else { index_of(primitives, *p) }];
        open.primitives.iter().enumerate().map(of)
    }
}

/// A cell with the ranges of its level.
pub(super) struct CellQuery<'l> {
    level: &'l PendingLevel,
    number: u32,
    pub one: Tetrahedron,
}

/// Buffers that are reused for each cell.
#[derive(Default)]
pub(super) struct CellBuffers {
    pub ranges: Vec<DualRange>,
    pub values: Vec<[f64; 4]>,
    pub noise: Vec<f64>,
    pub sides: Vec<Membership>,
    pub idle: Vec<bool>,
}

/// The width of a range; infinite where an end is unknown.
fn width([low, high]: &[f64; 2]) -> f64 {
    let width = high - low;
    if width.is_nan() { f64::INFINITY } else { width }
}

/// The axes along which shapes are extruded: no primitive depends on that axis and on another one.
fn separate_axes(csg: &Csg) -> [bool; 3] {
    let mut is_separate = [true; 3];
    for primitive in csg.primitives() {
        let axes = primitive.tape().axes();
        if axes.iter().filter(|is_used| **is_used).count() > 1 {
            (0..3).for_each(|k| is_separate[k] &= !axes[k]);
        }
    }
    is_separate
}
