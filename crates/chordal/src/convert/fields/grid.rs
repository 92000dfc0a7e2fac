//! `FieldGrid`: tetrahedra that are small only where a solid's boundary differs from that of linear functions.
//!
//! A cube around the solid is bisected until in each tetrahedron either membership is decided, or the
//! undecided primitives have a common direction in which they grow. Decided tetrahedra are dropped: they
//! contain no boundary, whatever their neighbours look like. All others form a conforming mesh.
// Long because reasons stand beside the steps that they explain.
use super::cells::{
    CellSizes, CellTest, CellsAtVertices, PrunedTree, PrunedTreeCache, ZeroSide, index_of, prune, range_side,
    zeros,
};
use super::sampled_signs::SampledSigns;
use super::sizing::{SizingField, SizingPoint};
use super::tetrahedra::{IntegerBox, Tetrahedra, Tetrahedron};
use super::vertex_values::VertexValues;
use crate::budget::{Job, par_map};
use crate::implicit::{Csg, DualRange, LeafError, Membership, PrimitiveEvaluator};
use crate::math::IntegerMap;
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
    /// Cells with a longer edge are cut wherever the boundary may be. Functions known only at points are
    /// sampled at this spacing first: smaller features may be missed.
    pub coarsest: f64,
}

/// How completely a grid was refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::convert) enum FieldGridStatus {
    Whole,
    /// Cells without slopes were left uncut, or the memory was used up.
    CutShort,
    /// Cells were left uncut since ranges are too wide; from then on only requested cells are cut.
    Exhausted,
}

/// The reason why there is no grid.
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

/// A cell that may contain boundary.
#[derive(Clone, Debug)]
pub(super) struct GridCell {
    pub tetrahedron: Tetrahedron,
    pub pruned: Arc<PrunedTree>,
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
    /// By primitive: whether it contains leaves, whose gradients may be known at points only.
    pub(super) has_leaves: Vec<bool>,
    cells: Vec<GridCell>,
    /// The trees of all cells.
    trees: PrunedTreeCache,
    pub(super) signs: SampledSigns,
    /// Whether slopes at corners decide, since ranges are too wide.
    pub(super) goes_by_samples: bool,
    extent: FieldGridStatus,
    n_alive: usize,
    /// If there are more cells than this, no more are cut.
    most_cells: usize,
    cells_at_vertices: CellsAtVertices,
}

/// The next step for a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellAction {
    Done,
    Cut,
    /// To be cut whatever the cell contains: it is larger than `coarsest`, or requested.
    CutAnyway,
    /// Like [`CellAction::Cut`], but some function in it has no known slope: at steps, poles, or without values.
    CutBlindly,
    /// Too small to be cut.
    TooSmall,
}

/// A cell that has not been classified yet.
pub(super) struct PendingCell {
    pub tetrahedron: Tetrahedron,
    pub pruned: Arc<PrunedTree>,
}

/// The pending cells of one level with their boxes, and the ranges of primitives in each box.
struct PendingLevel {
    boxes: Vec<IntegerBox>,
    /// By cell: its box.
    box_of: Vec<u32>,
    /// By box: its part of `primitives` and `ranges`.
    queries: Vec<[u32; 2]>,
    primitives: Vec<u32>,
    ranges: Vec<DualRange>,
}

/// The cube is larger than the bounds by this factor. Chosen: the boundary stays inside of the cells at the rim.
const MARGIN: f64 = 1.05;
/// The cube's middle is moved from that of the bounds by these fractions of their size, so that planes of
/// symmetric models are not in its own planes. Chosen: small and odd.
const OFFSET: [f64; 3] = [0.008_5, 0.011_55, 0.006_35];
/// The stretch of cells along an axis that is separate from the others: along an extrusion. Chosen: a plate as thick
/// as a tenth of its length stays one layer of cells down to cells of a thousandth, and coordinates lose six bits.
const STRETCH: f64 = 64.0;
/// The approximate bytes of a cell with its share of vertices and values. Measured: counted.
const BYTES_A_CELL: u64 = 400;
/// Cells may take the inverse of this of the job's memory. Chosen: the surface and its proof take the rest.
const SHARE: u64 = 4;
/// Cells in one task.
pub(super) const CELLS_A_TASK: usize = 128;
/// The most cells of one level that are cut. Chosen: a million cells in all, some seconds.
const MOST_CUT: usize = 1 << 18;
/// Requests for smaller cells may multiply the number of cells by this. Chosen: around a pole, where vertices are away from
/// the surface however small cells are, there would be twenty times as many.
const MOST_GROWTH: usize = 2;
/// Up to this many cells are allowed in any case. Chosen: a tenth of a second.
const FEW_CELLS: usize = 1 << 16;
/// The most cells without slopes of one level that are cut. Chosen: steps of functions are then resolved to a hundredth of
/// their size, and a volume without values is left uncut at once.
const MOST_BLIND: usize = 1 << 16;

impl<'a> FieldGrid<'a> {
    /// Builds a grid for the evaluator's solid. The work depends on the shape, and hardly on the floor.
    ///
    /// # Errors
    /// The error of a leaf, or [`FieldGridError::Cancelled`].
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
        let (tetrahedra, roots) = Tetrahedra::new(origin, side, stretch);
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
        let pruned = Arc::new(PrunedTree::new(csg.tree().clone()));
        let pending =
            roots.into_iter().map(|tetrahedron| PendingCell { tetrahedron, pruned: Arc::clone(&pruned) });
        let no_sizing = SizingField::new(&[], &[]);
        grid.refine_levels(evaluator, pending.collect(), &no_sizing)?;
        Ok(grid)
    }

    /// Cuts cells that contain one of the points until they are as small as the point requests. Others are cut only
    /// if conformity requires it.
    ///
    /// # Errors
    /// Those of [`FieldGrid::build`].
    pub fn refine(
        &mut self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        places: &[SizingPoint],
    ) -> Result<(), FieldGridError> {
        let points: Vec<[f64; 3]> = places.iter().map(|place| place.at).collect();
        let sizing = SizingField::new(places, &points);
        let pending: Vec<u32> = (0..self.cells.len() as u32)
            .filter(|c| {
                let cell = &self.cells[*c as usize];
                cell.is_alive && self.is_requested(&cell.tetrahedron, &sizing)
            })
            .collect();
        self.most_cells = greater(MOST_GROWTH.saturating_mul(self.n_alive), FEW_CELLS);
        let pending = pending.into_iter().map(|c| self.remove_cell(c)).collect();
        self.refine_levels(evaluator, pending, &sizing)
    }

    /// The length before stretching of a part that extends this far along each axis.
    pub fn size_of(&self, extent: [f64; 3]) -> f64 {
        let stretch = self.tetrahedra.stretch();
        length::<3>(std::array::from_fn(|k| extent[k] / stretch[k]))
    }

    /// The solid.
    pub fn csg(&self) -> &'a Csg {
        self.csg
    }

    /// Its approximate memory.
    pub fn bytes(&self) -> u64 {
        BYTES_A_CELL * self.n_alive as u64 + self.trees.bytes()
    }

    #[cfg(test)]
    pub fn n_cells(&self) -> usize {
        self.n_alive
    }

    /// The cells in the order in which they were added.
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

    fn sizing_point(&self, tetrahedron: &Tetrahedron) -> SizingPoint {
        let corners = tetrahedron.corners.map(|v| self.tetrahedra.position(v));
        let at = std::array::from_fn(|k| 0.25 * corners.iter().map(|p| p[k]).sum::<f64>());
        SizingPoint { at, size: self.tetrahedra.longest(tetrahedron.corners) }
    }

    fn is_requested(&self, tetrahedron: &Tetrahedron, sizing: &SizingField) -> bool {
        let bounds = || self.space(self.tetrahedra.box_of(tetrahedron.corners));
        !sizing.is_empty() && sizing.is_smaller_in(&bounds(), self.tetrahedra.longest(tetrahedron.corners))
    }

    fn space(&self, [min, max]: IntegerBox) -> Box3 {
        Box3 { min: self.tetrahedra.position_of(min), max: self.tetrahedra.position_of(max) }
    }

    fn remove_cell(&mut self, cell: u32) -> PendingCell {
        let cell = &mut self.cells[cell as usize];
        cell.is_alive = false;
        self.n_alive -= 1;
        PendingCell { tetrahedron: cell.tetrahedron, pruned: Arc::clone(&cell.pruned) }
    }

    /// Cuts level by level until all cells are done, too small or decided.
    fn refine_levels(
        &mut self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        mut pending: Vec<PendingCell>,
        sizing: &SizingField,
    ) -> Result<(), FieldGridError> {
        let most = self.job.memory_limit / SHARE;
        while !pending.is_empty() {
            if self.job.is_cancelled() {
                return Err(FieldGridError::Cancelled);
            }
            // Every cut adds one cell, and conformity adds more.
            let of_cells = BYTES_A_CELL * (self.n_alive + 2 * pending.len()) as u64;
            let is_full = of_cells + self.trees.bytes() > most
                || self.n_alive + pending.len() > self.most_cells
                || self.job.is_finishing();
            let mut judged = self.classify_cells(evaluator, pending, sizing)?;
            self.refine_by_samples(evaluator, &mut judged)?;
            let count = |action: CellAction| judged.iter().filter(|(_, verdict)| *verdict == action).count();
            let (n_cut, n_blind) = (count(CellAction::Cut), count(CellAction::CutBlindly));
            if n_cut > MOST_CUT {
                self.extent = FieldGridStatus::Exhausted;
            } else if n_blind > MOST_BLIND || is_full && n_cut + n_blind > 0 {
                self.extent = self.extent.max(FieldGridStatus::CutShort);
            }
            let mut cut = Vec::new();
            for (cell, verdict) in judged {
                let may_be_cut = !is_full && self.tetrahedra.refinement_edge(&cell.tetrahedron).is_some();
                let is_cut = match verdict {
                    CellAction::CutAnyway => may_be_cut,
                    CellAction::Cut => may_be_cut && n_cut <= MOST_CUT,
                    CellAction::CutBlindly => may_be_cut && n_blind <= MOST_BLIND,
                    CellAction::Done | CellAction::TooSmall => false,
                };
                // A cell with a midpoint on one of its edges has to be cut for conformity, whatever it
                // contains.
                if is_cut || self.tetrahedra.has_middle(cell.tetrahedron.corners) {
                    cut.push(cell);
                } else {
                    self.add_cell(cell, verdict == CellAction::Done);
                }
            }
            pending = self.bisect(cut);
            self.trees.remove_unused();
        }
        Ok(())
    }

    fn add_cell(&mut self, PendingCell { tetrahedron, pruned }: PendingCell, is_resolved: bool) {
        let number = self.cells.len() as u32;
        tetrahedron.corners.iter().for_each(|v| self.cells_at_vertices.push(*v, number));
        self.cells.push(GridCell { tetrahedron, pruned, is_resolved, is_alive: true });
        self.n_alive += 1;
    }

    /// Bisects cells, and all others around the bisected edges.
    fn bisect(&mut self, cut: Vec<PendingCell>) -> Vec<PendingCell> {
        let mut halves = Vec::with_capacity(2 * cut.len());
        let mut pending = cut;
        while !pending.is_empty() {
            // Cells are cut at their own refinement edge, which is not always the edge that has the midpoint.
            // Their halves have it then, and are cut in the next level.
            let mut edges = Vec::new();
            for PendingCell { tetrahedron, pruned } in pending {
                let (parts, edge) = self.tetrahedra.bisect(&tetrahedron);
                halves.extend(
                    parts.map(|tetrahedron| PendingCell { tetrahedron, pruned: Arc::clone(&pruned) }),
                );
                // Only the first of the cells around an edge reports it, so that its midpoint gets one entry in
                // the values.
                if let Some(edge) = edge {
                    self.values.push_vertex();
                    edges.push(edge);
                }
            }
            // Cells of the grid that have one of the edges.
            pending = Vec::new();
            for [a, b] in edges {
                let cells = &self.cells;
                let has_both_ends = |c: &u32| {
                    let cell = &cells[*c as usize];
                    cell.is_alive && cell.tetrahedron.corners.contains(&a)
                };
                // The newer end has fewer cells around it.
                let around: Vec<u32> = self.cells_at_vertices.cells_at(b).filter(has_both_ends).collect();
                pending.extend(around.into_iter().map(|c| self.remove_cell(c)));
            }
        }
        halves
    }

    /// Drops decided cells, and classifies the others.
    fn classify_cells(
        &mut self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        pending: Vec<PendingCell>,
        sizing: &SizingField,
    ) -> Result<Vec<(PendingCell, CellAction)>, FieldGridError> {
        let level = self.query_ranges(evaluator, &pending)?;
        let numbers: Vec<u32> = (0..pending.len() as u32).collect();
        let chunks: Vec<&[u32]> = numbers.chunks(CELLS_A_TASK).collect();
        // Ranges over boxes come first: values at corners are evaluated only in cells that these leave open.
        let sift = |part: &[u32]| {
            let mut sides = Vec::new();
            let sift = |n: &u32| {
                let cell = &pending[*n as usize];
                let ranges = level.ranges_of(*n, &cell.pruned);
                let zeros = cell.pruned.primitives.iter().map(|p| self.zero[*p as usize]);
                sides.clear();
                sides.extend(ranges.zip(zeros).map(|(range, zero)| range_side(range.value, zero)));
                prune(&cell.pruned, &sides)
            };
            part.iter().map(sift).collect::<Vec<_>>()
        };
        let sifted: Vec<Option<Arc<PrunedTree>>> = par_map(self.job, &chunks, |_, part| sift(part)).concat();
        self.query_values(evaluator, &pending, &sifted)?;
        let view = &*self;
        let decide = |part: &[u32]| {
            let mut buffers = CellBuffers::default();
            let decide = |n: &u32| {
                let pruned = sifted[*n as usize].as_ref()?;
                let tetrahedron = pending[*n as usize].tetrahedron;
                let cell = CellQuery { level: &level, number: *n, tetrahedron };
                view.cell_action(&cell, pruned, sizing, &mut buffers)
            };
            part.iter().map(decide).collect::<Vec<_>>()
        };
        let verdicts: Vec<Option<(Arc<PrunedTree>, CellAction)>> =
            par_map(self.job, &chunks, |_, part| decide(part)).concat();
        let trees = &mut self.trees;
        let judged = pending.into_iter().zip(verdicts).filter_map(|(cell, verdict)| {
            verdict.map(|(pruned, verdict)| {
                (PendingCell { pruned: trees.intern(pruned), tetrahedron: cell.tetrahedron }, verdict)
            })
        });
        Ok(judged.collect())
    }

    /// `None` for a decided cell.
    fn cell_action(
        &self,
        cell: &CellQuery,
        pruned: &Arc<PrunedTree>,
        sizing: &SizingField,
        buffers: &mut CellBuffers,
    ) -> Option<(Arc<PrunedTree>, CellAction)> {
        let cell_box = cell.level.boxes[cell.level.box_of[cell.number as usize] as usize];
        let sizes = CellSizes::new(&self.tetrahedra, cell.tetrahedron.corners, self.options.floor);
        self.gather(cell, pruned, buffers);
        let CellBuffers { ranges, values, noise, sides, .. } = buffers;
        let test = CellTest { csg: self.csg, pruned, ranges, values, noise, idle: &[], sizes };
        sides.clear();
        sides.extend(
            (0..values.len())
                .map(|k| range_side(test.value_range(k), self.zero[pruned.primitives[k] as usize])),
        );
        let rest = prune(pruned, sides)?;
        let is_requested = self.is_requested(&cell.tetrahedron, sizing);
        let space = self.space(cell_box);
        let is_coarse = sizes.longest > self.options.coarsest || is_requested;
        if is_coarse || self.misses_samples(pruned, values, &space, sizes.longest) {
            let is_empty = !is_requested && self.is_decided_by_signs(pruned, values, sides, &space);
            return Some((rest, if is_empty { CellAction::Done } else { CellAction::CutAnyway }));
        }
        // The buffers are by index in the tree's primitives, which has changed if some were pruned.
        if !Arc::ptr_eq(&rest, pruned) {
            self.gather(cell, &rest, buffers);
        }
        self.gather_corner_gradients(cell, &rest, buffers);
        let CellBuffers { ranges, values, noise, idle, .. } = buffers;
        let test = CellTest { csg: self.csg, pruned: &rest, ranges, values, noise, idle, sizes };
        let verdict = match (test.is_resolved(), sizes.longest <= sizes.floor) {
            (true, _) => CellAction::Done,
            (false, true) => CellAction::TooSmall,
            (false, false) if self.extent == FieldGridStatus::Exhausted => CellAction::TooSmall,
            (false, false) if self.lacks_gradient(&rest, ranges) => CellAction::CutBlindly,
            (false, false) => CellAction::Cut,
        };
        Some((rest, verdict))
    }

    /// Whether the slope of some primitive without leaves is unknown.
    fn lacks_gradient(&self, pruned: &PrunedTree, ranges: &[DualRange]) -> bool {
        let is_unknown =
            |(p, range): (&u32, &DualRange)| !self.has_leaves[*p as usize] && range.gradient.is_none();
        pruned.primitives.iter().zip(ranges).any(is_unknown)
    }

    /// Collects the ranges and values of a cell.
    fn gather(&self, cell: &CellQuery, pruned: &PrunedTree, buffers: &mut CellBuffers) {
        buffers.ranges.clear();
        buffers.ranges.extend(cell.level.ranges_of(cell.number, pruned));
        buffers.values.clear();
        buffers.noise.clear();
        for p in &pruned.primitives {
            let pairs =
                cell.tetrahedron.corners.map(|v| self.values.with_noise(v, *p).expect("it was asked for"));
            buffers.values.push(pairs.map(|[value, _]| value));
            buffers.noise.push(pairs.iter().fold(0.0, |most, [_, noise]| greater(*noise, most)));
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
            .map(|cell| {
                let cell_box = self.tetrahedra.box_of(cell.tetrahedron.corners);
                *numbers.entry(cell_box).or_insert_with(|| {
                    boxes.push(cell_box);
                    boxes.len() as u32 - 1
                })
            })
            .collect();
        // A tree's list is in order already. It is merged and sorted only if cells of one box have different
        // trees.
        // The first tree of each box, and the primitives of the other trees in it.
        let mut first: Vec<Option<&Arc<PrunedTree>>> = vec![None; boxes.len()];
        let mut others: Vec<(u32, u32)> = Vec::new();
        for (cell, number) in pending.iter().zip(&box_of) {
            match first[*number as usize] {
                None => first[*number as usize] = Some(&cell.pruned),
                Some(pruned) if Arc::ptr_eq(pruned, &cell.pruned) => {}
                Some(_) => others.extend(cell.pruned.primitives.iter().map(|p| (*number, *p))),
            }
        }
        others.sort_unstable();
        let mut others = others.as_slice();
        let (mut spans, mut primitives) = (Vec::with_capacity(boxes.len()), Vec::new());
        for (number, pruned) in first.iter().enumerate() {
            let start = primitives.len();
            primitives.extend_from_slice(&pruned.expect("each box has a cell").primitives);
            let n_more = others.iter().take_while(|(other, _)| *other as usize == number).count();
            if n_more > 0 {
                primitives.extend(others[..n_more].iter().map(|(_, p)| *p));
                others = &others[n_more..];
                primitives[start..].sort_unstable();
                let mut distinct = primitives.split_off(start);
                distinct.dedup();
                primitives.extend(distinct);
            }
            spans.push([start as u32, primitives.len() as u32]);
        }
        let mut queries = Vec::with_capacity(primitives.len());
        for (cell_box, [start, end]) in boxes.iter().zip(&spans) {
            let bounds = self.space(*cell_box);
            queries.extend(primitives[*start as usize..*end as usize].iter().map(|p| (*p, bounds)));
        }
        let ranges = evaluator.dual_ranges(&queries)?;
        Ok(PendingLevel { boxes, box_of, queries: spans, primitives, ranges })
    }

    /// Evaluates unknown values at the corners of undecided cells.
    fn query_values(
        &mut self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        pending: &[PendingCell],
        sifted: &[Option<Arc<PrunedTree>>],
    ) -> Result<(), FieldGridError> {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (cell, pruned) in pending.iter().zip(sifted) {
            let Some(pruned) = pruned else { continue };
            for v in cell.tetrahedron.corners {
                let unknown = pruned.primitives.iter().filter(|p| self.values.get(v, **p).is_none());
                pairs.extend(unknown.map(|p| (v, *p)));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let queries: Vec<(u32, [f64; 3])> =
            pairs.iter().map(|(v, p)| (*p, self.tetrahedra.position(*v))).collect();
        let points: Vec<(u32, Box3)> =
            queries.iter().map(|(p, at)| (*p, Box3 { min: *at, max: *at })).collect();
        // The range over a single point is as wide as its rounding errors.
        let noise: Vec<f64> = evaluator.ranges(&points)?.iter().map(width).collect();
        if self.has_leaves.contains(&true) {
            self.values.extend_slopes(&pairs, &evaluator.duals(&queries)?, &noise);
        } else {
            self.values.extend(&pairs, &evaluator.values(&queries)?, &noise);
        }
        Ok(())
    }
}

impl PendingLevel {
    /// The ranges of a tree's primitives in the box of a cell.
    fn ranges_of<'l>(&'l self, cell: u32, pruned: &'l PrunedTree) -> impl Iterator<Item = DualRange> + 'l {
        let [start, end] = self.queries[self.box_of[cell as usize] as usize];
        let part = start as usize..end as usize;
        let (primitives, ranges) = (&self.primitives[part.clone()], &self.ranges[part]);
        let is_same = primitives.len() == pruned.primitives.len();
        // The tree's primitives are among those of the box, so lists of equal length are equal.
        let range = move |(k, p): (usize, &u32)| ranges[if is_same { k } else { index_of(primitives, *p) }];
        pruned.primitives.iter().enumerate().map(range)
    }
}

/// A cell with the ranges of its level.
pub(super) struct CellQuery<'l> {
    level: &'l PendingLevel,
    number: u32,
    pub tetrahedron: Tetrahedron,
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

/// The width of a range; infinite if an end is unknown.
fn width([low, high]: &[f64; 2]) -> f64 {
    let width = high - low;
    if width.is_nan() { f64::INFINITY } else { width }
}

/// The axes along which shapes are extruded: no primitive depends both on such an axis and on another one.
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
