//! `FieldCover`: cells over a field's domain which show that a mesh misses no part of its surface.
//!
//! **Lemma (cover).** Let closed cells cover a cube about the field's bounds, so that those which meet the
//! cube's boundary do not meet the bounds. Let each be
//! - *decided*: F < 0 on all of it except for cracks, or F ≥ 0 on all of it,
//! - *growing*: with a direction n and a rate g > 0 so that n·γ ≥ g for every generalized gradient γ, in a
//!   box that holds the cell in its interior, of every literal that can have the value of F there; the
//!   literals are Lipschitz in that box, or
//! - *terminal*: handled in another way ([`super::walls`], [`super::prover`]).
//!
//! Then each component of A* (the interior of the closure of {F < 0}) meets a decided inner or a terminal
//! cell, and each component of B* (the interior of {F ≥ 0}) a decided outer or a terminal one.
//!
//! *Proof.* Let x(0) lie in A* and, as A is dense there, in A. While x(t) lies in growing cells only, let x'
//! be in −conv{n_C : C holds x}. This set is convex and upper semicontinuous in x, as cells are closed and
//! locally finite, so there is a solution (Filippov), until a cell of another kind is met. Along it F changes
//! at a rate in {γ·x' : γ in ∂F(x)} almost everywhere (Clarke's chain rule), and ∂F(x) lies in the hull of
//! the gradients of the literals that have the value F(x) at x. For each C that holds x these are among the
//! literals of C, as a literal is left out only where it never has the value, and x is in the interior of C's
//! box. So F falls at least at the least rate of all cells, and it is bounded below, so in finite time
//! another cell is met. The path to it is connected and lies in A. A decided cell there is an inner one since
//! F < 0. Upwards from B* likewise: F > 0 on the path, except at its start. Outside of the cube the bounds
//! guarantee that there is nothing of A, and the part of B* there is joined to the cells on the cube's
//! boundary, which are decided by the same guarantee. ∎
//!
//! *Parts.* A cell may be cut into parts, each with a direction or decided ([`super::cell_growth`]).
//!
//! A decided cell lies in the closure of A*, or of B*, with its interior in it, and so does the interior of
//! two such cells of one side that share a part of a side. So decided cells are joined across sides, and one
//! point of each set suffices.
//!
//! *By value, not by sign*: with the literals that may vanish in place of those that may have the value there
//! are fewer cells, but the flow may run in circles, and then nothing is shown.
//!
//! Cells share their sides bit for bit. Ranges are taken over boxes that are a little larger, so that cells
//! lie in their interiors. The cover depends on the field alone. Cells that are none of these at the size
//! limit are *open*: [`FieldCover::refine`] divides them further.
//!
//! Sources: F. Clarke, *Optimization and nonsmooth analysis*, 1983, 2.3 and 2.6; A. Filippov, *Differential
//! equations with discontinuous righthand sides*, 1988.
use super::cell_growth::{CellGrowth, DecidedPart, WindingProbe};
use super::local_trees::{LiteralSides, LocalTrees};
use super::regions::SignRegions;
use super::slope::padded;
use super::walls::{WallCell, cells_with_walls};
use crate::implicit::{DualRange, LeafError, Membership, Primitive, PrimitiveEvaluator};
use crate::math::{Box3, add_down, add_up, greater, lesser, mul_up, sub_up};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellState {
    /// F has one sign in it.
    Decided(Membership),
    /// The field grows along a direction.
    Grows,
    /// A terminal cell, handled by its walls.
    Walls,
    /// None of the other states.
    Open,
    /// Divided; its children are consecutive from this index.
    Divided(u32),
}

/// A cell of the octree.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoverCell {
    /// Its lowest corner, in cells of its level.
    corner: [u32; 3],
    level: u32,
    pub state: CellState,
    /// The tree that has the field's value in it.
    pub tree: u32,
}

#[derive(Clone, Debug)]
pub(super) struct FieldCover {
    /// The cube is `origin + [0, 2^DEEPEST·unit]³`.
    origin: [f64; 3],
    unit: f64,
    bounds: Box3,
    pub cells: Vec<CoverCell>,
    trees: LocalTrees,
    pub open: Vec<u32>,
    /// Points of decided parts of cells.
    part_points: Vec<WindingProbe>,
    /// The memory limit.
    most_bytes: u64,
}

/// The most halvings: corners are integers of u32, and a cell of this level is 2⁻³⁰ of the cube.
const DEEPEST: u32 = 30;
/// The cube's side as a multiple of the longest side of the bounds, and the offset of its centre. Chosen:
/// boundary cells of level 2 do not meet the bounds, and planes of symmetry do not run along sides of cells.
const ROOM: f64 = 2.25;
const OFF_CENTRE: [f64; 3] = [0.0137, 0.0071, -0.0113];
/// The first level whose cells are classified: its boundary cells do not meet the bounds.
const FIRST: u32 = 2;
/// The share of the job's memory for cells and their trees: the mesh, its copies and the queries need the
/// rest.
const MEMORY_SHARE: u64 = 8;
/// The most cells: indices are u32. Chosen: so many take some seconds.
const MOST_CELLS: usize = 1 << 22;
/// Ranges of primitives in one query: some tens of megabytes.
const ASKED_AT_ONCE: usize = 1 << 17;

/// Walls are searched only in cells with at most this many primitives. Chosen: twice as many as usually meet
/// in a corner, with as many copies of them.
const FEW: usize = 24;
/// Cells in which walls are searched at once: some tens of megabytes.
const WALLS_AT_ONCE: usize = 1 << 11;

/// The ranges of a cell's primitives.
struct CellRanges {
    bounds: Box3,
    slopes: Vec<DualRange>,
}

impl FieldCover {
    /// A cover whose cells are not classified yet.
    pub fn new(evaluator: &PrimitiveEvaluator, bounds: &Box3, memory_limit: u64) -> Self {
        let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, |a: f64, b| greater(b, a));
        let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |a: f64, b| greater(b.abs(), a));
        // A nearly degenerate box gets a cube that is larger than the padding of its cells.
        let least = reach * f64::EPSILON * f64::from(1 << 20);
        let longest = greater(longest, least);
        let longest =
            if longest > 0.0 { longest } else { f64::MIN_POSITIVE * f64::from(1 << 30) * f64::from(1 << 20) };
        let side = ROOM * longest;
        let unit = side / f64::from(1 << DEEPEST);
        let centre = bounds.centre();
        let origin = std::array::from_fn(|k| centre[k] + OFF_CENTRE[k] * longest - 0.5 * side);
        let root = CoverCell { corner: [0; 3], level: 0, state: CellState::Open, tree: 0 };
        let trees = LocalTrees::new(evaluator.csg());
        Self {
            origin,
            unit,
            bounds: *bounds,
            cells: vec![root],
            trees,
            open: vec![0],
            part_points: Vec::new(),
            most_bytes: memory_limit / MEMORY_SHARE,
        }
    }

    /// The cube that the cells cover.
    pub fn domain(&self) -> Box3 {
        self.bounds_of(&self.cells[0])
    }

    pub fn size_of(&self, cell: u32) -> f64 {
        f64::from(1_u32 << (DEEPEST - self.cells[cell as usize].level)) * self.unit
    }

    pub fn bounds_of(&self, cell: &CoverCell) -> Box3 {
        let side = 1_u32 << (DEEPEST - cell.level);
        let at = |k: usize, i: u32| self.origin[k] + f64::from(i) * self.unit;
        Box3 {
            min: std::array::from_fn(|k| at(k, cell.corner[k] * side)),
            max: std::array::from_fn(|k| at(k, (cell.corner[k] + 1) * side)),
        }
    }

    /// Divides open cells, and those of their children that stay open, until none is left or there are too
    /// many. `is_worth` selects cells by box and size.
    pub fn refine(
        &mut self,
        evaluator: &mut PrimitiveEvaluator,
        regions: &mut SignRegions,
        mut is_worth: impl FnMut(&Box3, f64) -> bool,
    ) -> Result<(), LeafError> {
        loop {
            let is_over = evaluator.is_over();
            let (mut now, mut later) = (Vec::new(), Vec::new());
            for cell in std::mem::take(&mut self.open) {
                let bounds = self.bounds_of(&self.cells[cell as usize]);
                let level = self.cells[cell as usize].level;
                // A divided cell has eight children, and those of the cells before it need room
                // too.
                let has_room = self.has_room(8 * (now.len() + 1));
                let may_be = level < DEEPEST && has_room && !is_over;
                let is_divided = level < FIRST || may_be && is_worth(&bounds, self.size_of(cell));
                if is_divided { now.push(cell) } else { later.push(cell) }
            }
            self.open = later;
            if now.is_empty() {
                return Ok(());
            }
            let first_open = self.open.len();
            // In batches, since a query holds the ranges of all primitives in all cells of it.
            while !now.is_empty() {
                if !self.has_room(8 * now.len()) {
                    self.open.extend(now);
                    break;
                }
                let later = now.split_off(self.batch_len(&now));
                let parts: Vec<u32> = now.iter().flat_map(|cell| self.divide(*cell)).collect();
                self.classify_cells(evaluator, &parts)?;
                now = later;
            }
            // Cells that were open before have been looked at.
            self.resolve_walls(evaluator, regions, first_open)?;
        }
    }

    /// Whether there is memory for `n_more` cells.
    fn has_room(&self, n_more: usize) -> bool {
        let n_cells = self.cells.len() + n_more;
        n_cells < MOST_CELLS
            && (n_cells * size_of::<CoverCell>()) as u64 + self.trees.bytes() < self.most_bytes
    }

    /// How many of the given cells are divided at once; at least one.
    fn batch_len(&self, cells: &[u32]) -> usize {
        let mut n_asked = 0;
        let fits = |cell: &&u32| {
            n_asked += 8 * self.trees.get(self.cells[**cell as usize].tree).primitives.len();
            n_asked <= ASKED_AT_ONCE
        };
        cells.iter().take_while(fits).count().max(1)
    }

    /// Divides a cell and returns its children.
    fn divide(&mut self, cell: u32) -> std::ops::Range<u32> {
        let CoverCell { corner, level, tree, .. } = self.cells[cell as usize];
        let first = self.cells.len() as u32;
        self.cells[cell as usize].state = CellState::Divided(first);
        self.cells.extend((0..8_u32).map(|octant| CoverCell {
            corner: std::array::from_fn(|k| 2 * corner[k] + (octant >> k & 1)),
            level: level + 1,
            state: CellState::Open,
            tree,
        }));
        first..first + 8
    }

    /// Classifies cells. Cells that stay open are added to the list of open cells.
    fn classify_cells(&mut self, evaluator: &mut PrimitiveEvaluator, cells: &[u32]) -> Result<(), LeafError> {
        let mut padded_cells = Vec::with_capacity(cells.len());
        for cell in cells {
            let bounds = self.bounds_of(&self.cells[*cell as usize]);
            // Where the bounds promise that there is nothing, no range is needed.
            let is_apart =
                (0..3).any(|k| bounds.min[k] > self.bounds.max[k] || bounds.max[k] < self.bounds.min[k]);
            if is_apart {
                self.cells[*cell as usize].state = CellState::Decided(Membership::Outside);
            } else if self.cells[*cell as usize].level < FIRST {
                self.open.push(*cell);
            } else {
                padded_cells.push((*cell, padded(&bounds)));
            }
        }
        let primitives =
            |cover: &Self, cell: u32| cover.trees.get(cover.cells[cell as usize].tree).primitives.clone();
        let questions: Vec<(u32, Box3)> = padded_cells
            .iter()
            .flat_map(|(cell, bounds)| primitives(self, *cell).into_iter().map(|p| (p, *bounds)))
            .collect();
        // First ranges alone; most cells are decided by them. What is left gets the mean value
        // theorem, and what that leaves a search for a direction.
        let slopes = evaluator.dual_ranges(&questions)?;
        let mut remaining = slopes.as_slice();
        let mut undecided: Vec<(u32, CellRanges)> = Vec::new();
        for (cell, bounds) in padded_cells {
            let (cell_slopes, after) = remaining.split_at(primitives(self, cell).len());
            remaining = after;
            let ranges = CellRanges { bounds, slopes: cell_slopes.to_vec() };
            if !self.decide(cell, &ranges) {
                undecided.push((cell, ranges));
            }
        }
        self.sharpen(evaluator, &mut undecided)?;
        let primitives = evaluator.csg().primitives();
        let mut parts: Vec<(u32, DecidedPart)> = Vec::new();
        let mut grown: Vec<u32> = Vec::new();
        for (cell, ranges) in undecided {
            if !self.decide(cell, &ranges) {
                match self.find_growth(cell, &ranges, primitives) {
                    Some(decided) => {
                        parts.extend(decided.into_iter().map(|part| (cell, part)));
                        grown.push(cell);
                    }
                    None => self.open.push(cell),
                }
            }
        }
        self.settle_parts(evaluator, grown, &parts)
    }

    /// Accepts cells that grow except for decided parts, if the signs are proved at the points of these
    /// parts.
    fn settle_parts(
        &mut self,
        evaluator: &mut PrimitiveEvaluator,
        grown: Vec<u32>,
        parts: &[(u32, DecidedPart)],
    ) -> Result<(), LeafError> {
        let point = |at: [f64; 3]| Box3 { min: at, max: at };
        let questions: Vec<(u32, Box3)> = parts
            .iter()
            .flat_map(|(_, part)| part.signs.iter().map(|(p, _)| (*p, point(part.probe.at))))
            .collect();
        let ranges = evaluator.ranges(&questions)?;
        let mut remaining = ranges.as_slice();
        let mut results = parts.iter().map(|(cell, part)| {
            let (part_ranges, after) = remaining.split_at(part.signs.len());
            remaining = after;
            // Strictly: on a zero set a point would be in no part.
            let holds = |((_, is_positive), [low, high]): (&(u32, bool), &[f64; 2])| {
                if *is_positive { *low > 0.0 } else { *high < 0.0 }
            };
            (*cell, part.signs.iter().zip(part_ranges).all(holds))
        });
        // Parts are in the order of the cells, so the list is sorted.
        let failed: Vec<u32> = results.by_ref().filter(|(_, holds)| !holds).map(|(cell, _)| cell).collect();
        let is_failed = |cell: u32| failed.binary_search(&cell).is_ok();
        for cell in grown {
            if is_failed(cell) {
                self.open.push(cell);
            } else {
                self.cells[cell as usize].state = CellState::Grows;
            }
        }
        let sound = parts.iter().filter(|(cell, _)| !is_failed(*cell));
        self.part_points.extend(sound.map(|(_, part)| part.probe));
        Ok(())
    }

    /// Searches for walls in the cells that were just left open.
    fn resolve_walls(
        &mut self,
        evaluator: &mut PrimitiveEvaluator,
        regions: &mut SignRegions,
        first_open: usize,
    ) -> Result<(), LeafError> {
        let primitives = evaluator.csg().primitives();
        let has_walls = |cell: u32| {
            let in_cell = &self.trees.get(self.cells[cell as usize].tree).primitives;
            let is_parallel = |a: u32, b: u32| primitives[a as usize].is_parallel_to(&primitives[b as usize]);
            let has_parallel = |k: usize| in_cell[..k].iter().any(|b| is_parallel(in_cell[k], *b));
            in_cell.len() <= FEW && (0..in_cell.len()).any(has_parallel)
        };
        let cells: Vec<u32> =
            self.open[first_open..].iter().copied().filter(|cell| has_walls(*cell)).collect();
        for part in cells.chunks(WALLS_AT_ONCE) {
            let along: Vec<WallCell> = part
                .iter()
                .flat_map(|cell| {
                    let bounds = self.bounds_of(&self.cells[*cell as usize]);
                    let side = self.size_of(*cell);
                    (0..3).map(move |axis| WallCell { cell: *cell, axis, bounds, side })
                })
                .collect();
            for (cell, points) in cells_with_walls(regions, evaluator, &along)? {
                let state = &mut self.cells[cell as usize].state;
                // A cell is tried along all three axes, and the first wall decides it.
                if *state == CellState::Open {
                    *state = CellState::Walls;
                    self.part_points.extend(points);
                }
            }
        }
        let cells = &self.cells;
        self.open.retain(|cell| cells[*cell as usize].state == CellState::Open);
        Ok(())
    }

    /// Decides a cell if it is on one side.
    fn decide(&mut self, cell: u32, ranges: &CellRanges) -> bool {
        let local = self.trees.get(self.cells[cell as usize].tree);
        let sides: Vec<LiteralSides> =
            ranges.slopes.iter().map(|slope| LiteralSides::from_range(&slope.value)).collect();
        let side = local.membership(&sides, &ranges.slopes);
        if side != Membership::Unknown {
            self.cells[cell as usize].state = CellState::Decided(side);
        }
        side != Membership::Unknown
    }

    /// Tightens ranges by the mean value theorem about the centres of cells.
    fn sharpen(
        &self,
        evaluator: &mut PrimitiveEvaluator,
        cells: &mut [(u32, CellRanges)],
    ) -> Result<(), LeafError> {
        let mut questions = Vec::new();
        for (cell, ranges) in cells.iter() {
            let local = self.trees.get(self.cells[*cell as usize].tree);
            let centre = ranges.bounds.centre();
            questions.extend(local.primitives.iter().map(|p| (*p, Box3 { min: centre, max: centre })));
        }
        let middles = evaluator.ranges(&questions)?;
        let mut remaining = middles.as_slice();
        for (_, ranges) in cells {
            let (cell_middles, after) = remaining.split_at(ranges.slopes.len());
            remaining = after;
            let centre = ranges.bounds.centre();
            for (slope, middle) in ranges.slopes.iter_mut().zip(cell_middles) {
                let Some(gradient) = slope.gradient else { continue };
                // |F(x) − F(centre)| ≤ Σ |∂ₖF|·|xₖ − centreₖ|. Both this and the range hold, so the narrower ends
                // stay.
                let stray = (0..3).fold(0.0, |sum, k| {
                    let (low, high) =
                        (sub_up(centre[k], ranges.bounds.min[k]), sub_up(ranges.bounds.max[k], centre[k]));
                    add_up(sum, mul_up(gradient[k].magnitude(), greater(low, high)))
                });
                let (low, high) = (add_down(middle[0], -stray), add_up(middle[1], stray));
                let [a, b] = &mut slope.value;
                *a = greater(low, *a);
                *b = lesser(high, *b);
            }
        }
        Ok(())
    }

    /// Drops the literals that never have the value, and searches for a direction in which all others grow,
    /// or one for each part of the cell. Returns the decided parts if that succeeds.
    fn find_growth(
        &mut self,
        cell: u32,
        ranges: &CellRanges,
        primitives: &[Primitive],
    ) -> Option<Vec<DecidedPart>> {
        let before = self.cells[cell as usize].tree;
        let values: Vec<[f64; 2]> = ranges.slopes.iter().map(|slope| slope.value).collect();
        let tree = self.trees.by_value(before, &values);
        let (old, local) = (self.trees.get(before), self.trees.get(tree));
        let slope = |p: u32| &ranges.slopes[old.index_of(p)];
        let growth = CellGrowth { local, slope, primitives, bounds: &ranges.bounds };
        let decided_parts = if growth.has_direction(local) { Some(Vec::new()) } else { growth.parts() };
        self.cells[cell as usize].tree = tree;
        decided_parts
    }

    /// The leaf that contains a given cell of a level, if the leaf is at least as large.
    fn leaf(&self, corner: [u32; 3], level: u32) -> Option<u32> {
        let mut cell = 0_u32;
        loop {
            let node = &self.cells[cell as usize];
            let CellState::Divided(first) = node.state else { return Some(cell) };
            if node.level == level {
                return None;
            }
            // `corner` counts cells of `level`: a child's octant is made of the bits that
            // distinguish the cells of its level.
            let shift = level - node.level - 1;
            let octant = (0..3).fold(0, |octant, k| octant | (corner[k] >> shift & 1) << k);
            cell = first + octant;
        }
    }

    /// The points around which a mesh has to wind correctly: one for each set of decided cells of one side
    /// that are joined across sides, and those of the parts of cells with walls.
    pub fn winding_probes(&self) -> Vec<WindingProbe> {
        let mut points = self.component_probes();
        points.extend(&self.part_points);
        points
    }

    /// The centre of the largest cell of each set.
    fn component_probes(&self) -> Vec<WindingProbe> {
        let n = self.cells.len();
        let mut sets: Vec<u32> = (0..n as u32).collect();
        for (number, cell) in self.cells.iter().enumerate() {
            if !matches!(cell.state, CellState::Decided(_)) {
                continue;
            }
            // Smaller neighbours are left out by `leaf`; they find this cell from their side.
            for (axis, step) in [(0, 1_i64), (1, 1), (2, 1), (0, -1), (1, -1), (2, -1)] {
                let moved = i64::from(cell.corner[axis]) + step;
                if moved < 0 || moved >= 1 << cell.level {
                    continue;
                }
                let mut corner = cell.corner;
                corner[axis] = moved as u32;
                let Some(other) = self.leaf(corner, cell.level) else { continue };
                if self.cells[other as usize].state == cell.state {
                    let (a, b) = (root(&mut sets, number as u32), root(&mut sets, other));
                    // The lower number becomes the root, so the result does not depend on the order.
                    let (low, high) = if a < b { (a, b) } else { (b, a) };
                    sets[high as usize] = low;
                }
            }
        }
        let mut largest: Vec<Option<u32>> = vec![None; n];
        for (number, cell) in self.cells.iter().enumerate() {
            if matches!(cell.state, CellState::Decided(_)) {
                let best = &mut largest[root(&mut sets, number as u32) as usize];
                // A large cell is farther from the surface, so winding numbers around its centre
                // are easier to certify. Among equal ones the first stays.
                if best.is_none_or(|best| self.cells[best as usize].level > cell.level) {
                    *best = Some(number as u32);
                }
            }
        }
        let point = |number: u32| {
            let cell = &self.cells[number as usize];
            let CellState::Decided(side) = cell.state else { unreachable!("only decided cells are in sets") };
            WindingProbe { at: self.bounds_of(cell).centre(), side }
        };
        largest.into_iter().flatten().map(point).collect()
    }
}

fn root(sets: &mut [u32], mut cell: u32) -> u32 {
    while sets[cell as usize] != cell {
        sets[cell as usize] = sets[sets[cell as usize] as usize];
        cell = sets[cell as usize];
    }
    cell
}
