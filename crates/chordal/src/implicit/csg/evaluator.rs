//! `PrimitiveEvaluator`: the primitives of a CSG tree, evaluated for many points or boxes at once.
use super::branches::ContinuousBranches;
use super::{Csg, Primitive};
use crate::budget::{Job, par_map};
use crate::implicit::op::Binary;
use crate::implicit::{Dual, LeafError, Tape, Term};
use crate::math::{Box3, Interval, greater, lesser};

/// The values and gradients of a primitive in a box, as far as known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualRange {
    /// A lower and an upper bound of all values; infinite if nothing is known, for example because the
    /// primitive is undefined at some point.
    pub value: [f64; 2],
    /// If the primitive is Lipschitz in the box: intervals of its generalized gradients (Clarke's), so that
    /// the mean value theorem holds with them.
    pub gradient: Option<[Interval; 3]>,
}

impl DualRange {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { value: [f64::NEG_INFINITY, f64::INFINITY], gradient: None };

    fn new(primitive: &Primitive, slope: &Dual<Interval>) -> Self {
        let bounded = |d: &Interval| d.is_defined() && d.lo() > f64::NEG_INFINITY && d.hi() < f64::INFINITY;
        let is_lipschitz = slope.value.is_defined() && slope.gradient.iter().all(bounded);
        let gradient = is_lipschitz.then_some(slope.gradient);
        Self { value: values(primitive, slope.value), gradient }
    }
}

/// The ends of an interval, if it contains all values.
fn values(primitive: &Primitive, range: Interval) -> [f64; 2] {
    let holds_all = range.is_defined() || primitive.is_total && !range.is_empty();
    if holds_all { [range.lo(), range.hi()] } else { DualRange::UNKNOWN.value }
}

/// Rows per call of a primitive. Chosen: several blocks of registers, and small enough to share among
/// threads.
const CHUNK: usize = 1024;
/// Queries evaluated at once: some tens of megabytes. Leaves get all queries in one call.
const AT_ONCE: usize = 1 << 17;
/// Tapes with fewer steps are not pruned by region. Chosen: pruning takes about as long as some hundred
/// evaluations of a step.
const LONG: usize = 48;
/// A region with at least this many queries gets its own tape. Measured on 100 blended balls: pruning a tape
/// costs as much as some 20 intervals.
const WORTH: usize = 32;
/// The deepest level of regions. Measured on 100 blended balls: beyond 9, tapes get no shorter.
const DEEPEST: u32 = 9;
/// The bytes of a step in a tape, roughly: its term, its step of the program, and overhead.
const BYTES_A_STEP: u64 = 160;

/// The number of points that take as long as a box. Measured: intervals with gradients take three to six
/// times as long as values.
const POINTS_A_BOX: u64 = 4;

/// A region of the domain with the tape of a primitive, pruned for the region and its surroundings.
#[derive(Debug)]
pub(super) struct TapeRegion {
    /// The cell itself; the tape is also valid half a cell around it.
    cell: Box3,
    level: u32,
    pub(super) tape: Tape,
    children: [Option<u32>; 8],
}

/// The primitives of a CSG tree over a domain, evaluated in batches on the threads of a job.
///
/// Long primitives, such as chains of blends, are pruned for each region of the domain with many queries.
/// Values are those of the unpruned primitive, bit for bit; intervals contain its values, and are tighter.
#[derive(Debug)]
pub struct PrimitiveEvaluator<'a> {
    csg: &'a Csg,
    job: &'a Job,
    /// By primitive: its regions, the first of which is the entire domain.
    pub(super) regions: Vec<Vec<TapeRegion>>,
    /// By primitive: its branches, if it has steps.
    branches: Vec<Option<ContinuousBranches>>,
    has_leaves: bool,
    steps_left: u64,
    n_points: u64,
    n_boxes: u64,
}

/// The answer to a query.
trait IntervalHull: Copy + Send + Sync {
    /// The answer that holds if at least one of the two does.
    fn hull(self, other: Self) -> Self;
}

impl IntervalHull for [f64; 2] {
    fn hull(self, [low, high]: Self) -> Self {
        [lesser(low, self[0]), greater(high, self[1])]
    }
}

impl IntervalHull for DualRange {
    /// The function may jump between the two, so there is no gradient.
    fn hull(self, other: Self) -> Self {
        Self { value: self.value.hull(other.value), gradient: None }
    }
}

impl IntervalHull for f64 {
    /// A point is evaluated only once.
    fn hull(self, _: Self) -> Self {
        self
    }
}

impl IntervalHull for Dual<f64> {
    /// A point is evaluated only once.
    fn hull(self, _: Self) -> Self {
        self
    }
}

/// Queries for one tape.
struct TapeBatch {
    primitive: u32,
    tape: Tape,
    rows: Vec<u32>,
}

impl TapeBatch {
    /// Adds a tape's queries in chunks. A leaf gets all queries in one call, and makes its own chunks.
    fn push_all(primitive: u32, tape: &Tape, rows: &[u32], batches: &mut Vec<Self>) {
        let size = if tape.has_leaves() { rows.len().max(1) } else { CHUNK };
        let batch = |rows: &[u32]| Self { primitive, tape: tape.clone(), rows: rows.to_vec() };
        batches.extend(rows.chunks(size).map(batch));
    }
}

/// The region of a query: a point or a box.
trait QueryRegion: Copy + Sync {
    /// Whether functions with steps are split into branches: for boxes only.
    const BRANCHES: bool;
    fn bounds(&self) -> Box3;
}

impl QueryRegion for [f64; 3] {
    const BRANCHES: bool = false;

    fn bounds(&self) -> Box3 {
        Box3 { min: *self, max: *self }
    }
}

impl QueryRegion for Box3 {
    const BRANCHES: bool = true;

    fn bounds(&self) -> Box3 {
        *self
    }
}

impl<'a> PrimitiveEvaluator<'a> {
    /// An evaluator for a domain. Points outside of it are allowed, but are evaluated with unpruned tapes.
    #[must_use]
    pub fn new(csg: &'a Csg, domain: &Box3, job: &'a Job) -> Self {
        let centre = domain.centre();
        let half = 0.5 * domain.diagonal();
        let cell = Box3 { min: centre.map(|x| x - half), max: centre.map(|x| x + half) };
        let root = |primitive: &Primitive| {
            vec![TapeRegion { cell, level: 0, tape: primitive.tape.clone(), children: [None; 8] }]
        };
        Self {
            csg,
            job,
            regions: csg.primitives.iter().map(root).collect(),
            branches: csg
                .primitives
                .iter()
                .map(|p| ContinuousBranches::from_terms(p.tape.graph().terms()))
                .collect(),
            has_leaves: csg.primitives.iter().any(|p| p.tape.has_leaves()),
            steps_left: job.memory_limit / 8 / BYTES_A_STEP,
            n_points: 0,
            n_boxes: 0,
        }
    }

    /// The tree whose primitives are evaluated.
    #[must_use]
    pub fn csg(&self) -> &'a Csg {
        self.csg
    }

    /// The number of points evaluated so far.
    #[must_use]
    pub fn n_points(&self) -> u64 {
        self.n_points
    }

    /// The work so far, in evaluations of a point.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.n_points + POINTS_A_BOX * self.n_boxes
    }

    /// Whether the job's evaluations are used up, or it is to finish.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.job.is_over()
    }

    fn count(&mut self, points: usize, boxes: usize) {
        let (points, boxes) = (points as u64, boxes as u64);
        self.n_points += points;
        self.n_boxes += boxes;
        self.job.count_work(points + POINTS_A_BOX * boxes);
    }

    /// The number of boxes evaluated so far.
    #[must_use]
    pub fn n_boxes(&self) -> u64 {
        self.n_boxes
    }

    /// The value of a primitive at a point, for each query.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn values(&mut self, queries: &[(u32, [f64; 3])]) -> Result<Vec<f64>, LeafError> {
        self.count(queries.len(), 0);
        self.answer(queries, 0.0, |batch, at, out: &mut [f64]| batch.tape.at(at, out))
    }

    /// The value and gradient of a primitive at a point, for each query.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn duals(&mut self, queries: &[(u32, [f64; 3])]) -> Result<Vec<Dual<f64>>, LeafError> {
        self.count(queries.len(), 0);
        let none = Dual { value: 0.0, gradient: [0.0; 3] };
        self.answer(queries, none, |batch, at, out: &mut [Dual<f64>]| batch.tape.gradient_at(at, out))
    }

    /// An interval `[low, high]` of all values of a primitive in a box, rounded outward, for each query; see
    /// [`DualRange::value`].
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn ranges(&mut self, queries: &[(u32, Box3)]) -> Result<Vec<[f64; 2]>, LeafError> {
        self.count(0, queries.len());
        let primitives = &self.csg.primitives;
        self.answer(queries, DualRange::UNKNOWN.value, |batch, at, out: &mut [[f64; 2]]| {
            let mut ranges = vec![Interval::UNKNOWN; at.len()];
            batch.tape.over(at, &mut ranges)?;
            let primitive = &primitives[batch.primitive as usize];
            out.iter_mut().zip(ranges).for_each(|(out, range)| *out = values(primitive, range));
            Ok(())
        })
    }

    /// Intervals of the values and of the gradient of a primitive in a box, for each query.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn dual_ranges(&mut self, queries: &[(u32, Box3)]) -> Result<Vec<DualRange>, LeafError> {
        self.count(0, queries.len());
        let primitives = &self.csg.primitives;
        self.answer(queries, DualRange::UNKNOWN, |batch, at, out: &mut [DualRange]| {
            let unknown = Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };
            let mut slopes = vec![unknown; at.len()];
            batch.tape.gradient_over(at, &mut slopes)?;
            let primitive = &primitives[batch.primitive as usize];
            out.iter_mut().zip(slopes).for_each(|(out, slope)| *out = DualRange::new(primitive, &slope));
            Ok(())
        })
    }

    /// Returns the answers in the order of the queries, whatever the order of the batches.
    fn answer<Q: QueryRegion, R: IntervalHull>(
        &mut self,
        queries: &[(u32, Q)],
        none: R,
        ask: impl Fn(&TapeBatch, &[Q], &mut [R]) -> Result<(), LeafError> + Sync,
    ) -> Result<Vec<R>, LeafError> {
        let chunk_len = if self.has_leaves { queries.len().max(1) } else { AT_ONCE };
        let mut answers = Vec::with_capacity(queries.len());
        for chunk in queries.chunks(chunk_len) {
            self.answer_part(chunk, none, &ask, &mut answers)?;
        }
        Ok(answers)
    }

    fn answer_part<Q: QueryRegion, R: IntervalHull>(
        &mut self,
        queries: &[(u32, Q)],
        none: R,
        ask: &(impl Fn(&TapeBatch, &[Q], &mut [R]) -> Result<(), LeafError> + Sync),
        answers: &mut Vec<R>,
    ) -> Result<(), LeafError> {
        let batches = self.batches(queries)?;
        let batch_answers = par_map(self.job, &batches, |_, batch| {
            let at: Vec<Q> = batch.rows.iter().map(|row| queries[*row as usize].1).collect();
            let mut out = vec![none; at.len()];
            ask(batch, &at, &mut out).map(|()| out)
        });
        let start = answers.len();
        answers.resize(start + queries.len(), none);
        let mut is_known = vec![false; queries.len()];
        for (batch, answers_of_batch) in batches.iter().zip(batch_answers) {
            for (row, answer) in batch.rows.iter().zip(answers_of_batch?) {
                // Several branches may answer one query: their hull holds.
                let hull = &mut answers[start + *row as usize];
                *hull = if is_known[*row as usize] { hull.hull(answer) } else { answer };
                is_known[*row as usize] = true;
            }
        }
        Ok(())
    }

    /// Groups the queries by tape.
    fn batches<Q: QueryRegion>(&mut self, queries: &[(u32, Q)]) -> Result<Vec<TapeBatch>, LeafError> {
        let mut by_primitive: Vec<Vec<u32>> = vec![Vec::new(); self.regions.len()];
        queries.iter().enumerate().for_each(|(row, (p, _))| by_primitive[*p as usize].push(row as u32));
        let mut batches = Vec::new();
        for (primitive, rows) in by_primitive.into_iter().enumerate().filter(|(_, rows)| !rows.is_empty()) {
            let number = primitive as u32;
            let rows = if Q::BRANCHES { self.branch(number, queries, rows, &mut batches)? } else { rows };
            if rows.is_empty() {
                continue;
            }
            let tape = &self.regions[primitive][0].tape;
            // As long as there are no regions, few queries are not worth the first one.
            if !is_pruned(tape) || rows.len() < WORTH && self.regions[primitive].len() == 1 {
                TapeBatch::push_all(number, tape, &rows, &mut batches);
                continue;
            }
            self.route(number, queries, rows, &mut batches)?;
        }
        Ok(batches)
    }

    /// Adds queries for the branches of a primitive with steps. Returns the rows that cannot be split into
    /// branches.
    fn branch<Q: QueryRegion>(
        &mut self,
        primitive: u32,
        queries: &[(u32, Q)],
        rows: Vec<u32>,
        batches: &mut Vec<TapeBatch>,
    ) -> Result<Vec<u32>, LeafError> {
        let Some(branches) = &mut self.branches[primitive as usize] else { return Ok(rows) };
        let boxes: Vec<Box3> = rows.iter().map(|row| queries[*row as usize].1.bounds()).collect();
        let functions = branches.over(&boxes)?;
        let mut by_function: Vec<Vec<u32>> = vec![Vec::new(); branches.functions.len()];
        let mut unsplit = Vec::new();
        for (row, functions) in rows.into_iter().zip(functions) {
            match functions {
                Some(numbers) => {
                    numbers.into_iter().for_each(|number| by_function[number as usize].push(row))
                }
                None => unsplit.push(row),
            }
        }
        for (tape, rows) in branches.functions.iter().zip(&by_function) {
            TapeBatch::push_all(primitive, tape, rows, batches);
        }
        Ok(unsplit)
    }

    /// Passes queries down the regions of a primitive, level by level, and creates the regions that are worth
    /// it.
    fn route<Q: QueryRegion>(
        &mut self,
        primitive: u32,
        queries: &[(u32, Q)],
        rows: Vec<u32>,
        batches: &mut Vec<TapeBatch>,
    ) -> Result<(), LeafError> {
        let mut open = vec![(0_u32, rows)];
        while !open.is_empty() {
            let mut below: Vec<(u32, usize, Vec<u32>)> = Vec::new();
            for (number, rows) in open {
                let region = &self.regions[primitive as usize][number as usize];
                let mut rows_here = Vec::new();
                let mut parts: [Vec<u32>; 8] = Default::default();
                let ends = region.level == DEEPEST || !is_pruned(&region.tape);
                for row in rows {
                    let octant = if ends { None } else { region.octant(&queries[row as usize].1.bounds()) };
                    octant.map_or(&mut rows_here, |octant| &mut parts[octant]).push(row);
                }
                for (octant, rows) in parts.into_iter().enumerate() {
                    // A region that exists is used for few queries, too.
                    let exists = region.children[octant].is_some();
                    if exists || rows.len() >= WORTH && self.steps_left > region.tape.len() as u64 {
                        below.push((number, octant, rows));
                    } else {
                        rows_here.extend(rows);
                    }
                }
                TapeBatch::push_all(primitive, &region.tape, &rows_here, batches);
            }
            let children = self.children(primitive, &below)?;
            open = children.into_iter().zip(below).map(|(child, (_, _, rows))| (child, rows)).collect();
            // Regions that exist may have got no query.
            open.retain(|(_, rows)| !rows.is_empty());
        }
        Ok(())
    }

    /// The indices of child regions, which are created if they do not exist yet.
    fn children(
        &mut self,
        primitive: u32,
        requests: &[(u32, usize, Vec<u32>)],
    ) -> Result<Vec<u32>, LeafError> {
        let regions = &self.regions[primitive as usize];
        let new: Vec<(u32, usize)> = requests
            .iter()
            .map(|(parent, octant, _)| (*parent, *octant))
            .filter(|(parent, octant)| regions[*parent as usize].children[*octant].is_none())
            .collect();
        let children =
            par_map(self.job, &new, |_, (parent, octant)| regions[*parent as usize].child(*octant));
        // In the order of the requests, so that the numbers of regions do not depend on threads.
        for ((parent, octant), child) in new.iter().zip(children) {
            let child = child?;
            self.steps_left = self.steps_left.saturating_sub(child.tape.len() as u64);
            let regions = &mut self.regions[primitive as usize];
            regions[*parent as usize].children[*octant] = Some(regions.len() as u32);
            regions.push(child);
        }
        let regions = &self.regions[primitive as usize];
        let child =
            |(parent, octant, _): &(u32, usize, Vec<u32>)| regions[*parent as usize].children[*octant];
        Ok(requests.iter().map(|request| child(request).expect("it was made")).collect())
    }
}

/// Whether pruning may shorten a tape: it has many steps, some of which are choices, and no leaves, which are
/// faster in large batches.
fn is_pruned(tape: &Tape) -> bool {
    let chooses = |term: &Term| {
        matches!(
            term,
            Term::Binary(
                Binary::Min | Binary::Max | Binary::SmoothMin | Binary::RoundMin | Binary::And | Binary::Or,
                ..
            )
        )
    };
    tape.len() >= LONG && !tape.has_leaves() && tape.graph().terms().iter().any(chooses)
}

impl TapeRegion {
    /// The octant of a box's centre, if the box lies within the octant and its surroundings.
    fn octant(&self, bounds: &Box3) -> Option<usize> {
        let (centre, middle) = (bounds.centre(), self.cell.centre());
        let octant = (0..3).fold(0, |octant, k| octant | usize::from(centre[k] >= middle[k]) << k);
        let around = around(&self.octant_cell(octant));
        let fits = (0..3).all(|k| around.min[k] <= bounds.min[k] && bounds.max[k] <= around.max[k]);
        fits.then_some(octant)
    }

    fn octant_cell(&self, octant: usize) -> Box3 {
        let middle = self.cell.centre();
        let high = |k: usize| octant >> k & 1 == 1;
        Box3 {
            min: std::array::from_fn(|k| if high(k) { middle[k] } else { self.cell.min[k] }),
            max: std::array::from_fn(|k| if high(k) { self.cell.max[k] } else { middle[k] }),
        }
    }

    fn child(&self, octant: usize) -> Result<Self, LeafError> {
        let cell = self.octant_cell(octant);
        let (_, shorter) = self.tape.prune(&around(&cell))?;
        let tape = shorter.unwrap_or_else(|| self.tape.clone());
        Ok(Self { cell, level: self.level + 1, tape, children: [None; 8] })
    }
}

/// A cell grown by half of its size on every side.
fn around(cell: &Box3) -> Box3 {
    let half = |k: usize| 0.5 * (cell.max[k] - cell.min[k]);
    Box3 {
        min: std::array::from_fn(|k| cell.min[k] - half(k)),
        max: std::array::from_fn(|k| cell.max[k] + half(k)),
    }
}
