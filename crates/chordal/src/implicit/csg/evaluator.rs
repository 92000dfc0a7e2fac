//! `PrimitiveEvaluator`: the primitives of a CSG tree, asked for many points or boxes at once.
use super::branches::ContinuousBranches;
use super::{Csg, Primitive};
use crate::budget::{Job, par_map};
use crate::implicit::op::Binary;
use crate::implicit::{Dual, LeafError, Tape, Term};
use crate::math::{Box3, Interval};

/// What is known of a primitive in a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualRange {
    /// All values lie from the first to the second, which are infinite where nothing is known. Where a point
    /// has no value, nothing is.
    pub value: [f64; 2],
    /// Where the primitive is Lipschitz in the box: ranges of its generalized gradients (Clarke's), so that
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

/// The ends of a range of values, if it holds them all.
fn values(primitive: &Primitive, range: Interval) -> [f64; 2] {
    let holds_all = range.is_defined() || primitive.is_total && !range.is_empty();
    if holds_all { [range.lo(), range.hi()] } else { DualRange::UNKNOWN.value }
}

/// Rows in one call of a primitive: several blocks of registers, and small enough to share among threads.
const CHUNK: usize = 1024;
/// Questions that are answered at once: some tens of megabytes. Leaves are asked for everything in one call.
const AT_ONCE: usize = 1 << 17;
/// Tapes of fewer steps are not shortened by region. Chosen: shortening takes about as long as some hundred
/// evaluations of a step.
const LONG: usize = 48;
/// A region gets a tape of its own for so many questions. Measured on 100 blended balls: making a tape costs
/// as much as some 20 ranges.
const WORTH: usize = 32;
/// Halvings of the domain at most. Measured on 100 blended balls: tapes are not shorter after 9.
const DEEPEST: u32 = 9;
/// Bytes that a step takes in a tape, about: its term, its step of the program, and the space around.
const BYTES_A_STEP: u64 = 160;

/// A region of the domain with the steps of a primitive that matter in it and around it.
#[derive(Debug)]
pub(super) struct TapeRegion {
    /// The cell itself; the tape holds for half a cell around it too.
    cell: Box3,
    level: u32,
    pub(super) tape: Tape,
    children: [Option<u32>; 8],
}

/// The primitives of a CSG tree over a domain, evaluated for many questions at once, on the threads of a job.
///
/// Long primitives, such as chains of blends, are shortened for each region of the domain that many questions
/// fall into. Values are those of the whole primitive, bit for bit; ranges hold them, and are tighter.
#[derive(Debug)]
pub struct PrimitiveEvaluator<'a> {
    csg: &'a Csg,
    job: &'a Job,
    /// By primitive: its regions, the first of which is all of the domain.
    pub(super) regions: Vec<Vec<TapeRegion>>,
    /// By primitive: its steps, if it has any.
    branches: Vec<Option<ContinuousBranches>>,
    has_leaves: bool,
    steps_left: u64,
    n_points: u64,
    n_boxes: u64,
}

/// What can be answered.
trait IntervalHull: Copy + Send + Sync {
    /// What holds where one of both answers does.
    fn hull(self, other: Self) -> Self;
}

impl IntervalHull for [f64; 2] {
    fn hull(self, [low, high]: Self) -> Self {
        [if low < self[0] { low } else { self[0] }, if high > self[1] { high } else { self[1] }]
    }
}

impl IntervalHull for DualRange {
    /// It may step from one to the other.
    fn hull(self, other: Self) -> Self {
        Self { value: self.value.hull(other.value), gradient: None }
    }
}

impl IntervalHull for f64 {
    /// A point is asked for once.
    fn hull(self, _: Self) -> Self {
        self
    }
}

impl IntervalHull for Dual<f64> {
    /// A point is asked for once.
    fn hull(self, _: Self) -> Self {
        self
    }
}

/// Questions for one tape.
struct TapeBatch {
    primitive: u32,
    tape: Tape,
    rows: Vec<u32>,
}

impl TapeBatch {
    /// A tape's questions, in chunks. A leaf is asked for everything at once, by chunks of its own.
    fn push_all(primitive: u32, tape: &Tape, rows: &[u32], batches: &mut Vec<Self>) {
        let size = if tape.has_leaves() { rows.len().max(1) } else { CHUNK };
        let batch = |rows: &[u32]| Self { primitive, tape: tape.clone(), rows: rows.to_vec() };
        batches.extend(rows.chunks(size).map(batch));
    }
}

/// What can be asked for: where it is, and what it is asked for by tapes.
trait QueryRegion: Copy + Sync {
    /// Whether steps are looked at by branches: in boxes.
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
    /// Over a domain; points outside of it can be asked for too, at the cost of the whole tapes.
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

    /// How many points were evaluated so far.
    #[must_use]
    pub fn n_points(&self) -> u64 {
        self.n_points
    }

    /// How many boxes were evaluated so far.
    #[must_use]
    pub fn n_boxes(&self) -> u64 {
        self.n_boxes
    }

    /// The value of a primitive at a point, for each question.
    ///
    /// # Errors
    /// Fails if a leaf fails.
    pub fn values(&mut self, questions: &[(u32, [f64; 3])]) -> Result<Vec<f64>, LeafError> {
        self.n_points += questions.len() as u64;
        self.answer(questions, 0.0, |batch, at, out: &mut [f64]| batch.tape.at(at, out))
    }

    /// The value and gradient of a primitive at a point, for each question.
    ///
    /// # Errors
    /// Fails if a leaf fails.
    pub fn duals(&mut self, questions: &[(u32, [f64; 3])]) -> Result<Vec<Dual<f64>>, LeafError> {
        self.n_points += questions.len() as u64;
        let none = Dual { value: 0.0, gradient: [0.0; 3] };
        self.answer(questions, none, |batch, at, out: &mut [Dual<f64>]| batch.tape.gradient_at(at, out))
    }

    /// A range `[low, high]` of all values of a primitive in a box, rounded outward, for each question; see
    /// [`DualRange::value`].
    ///
    /// # Errors
    /// Fails if a leaf fails.
    pub fn ranges(&mut self, questions: &[(u32, Box3)]) -> Result<Vec<[f64; 2]>, LeafError> {
        self.n_boxes += questions.len() as u64;
        let primitives = &self.csg.primitives;
        self.answer(questions, DualRange::UNKNOWN.value, |batch, at, out: &mut [[f64; 2]]| {
            let mut found = vec![Interval::UNKNOWN; at.len()];
            batch.tape.over(at, &mut found)?;
            let primitive = &primitives[batch.primitive as usize];
            out.iter_mut().zip(found).for_each(|(out, range)| *out = values(primitive, range));
            Ok(())
        })
    }

    /// Ranges of the values and of the gradient of a primitive in a box, for each question.
    ///
    /// # Errors
    /// Fails if a leaf fails.
    pub fn dual_ranges(&mut self, questions: &[(u32, Box3)]) -> Result<Vec<DualRange>, LeafError> {
        self.n_boxes += questions.len() as u64;
        let primitives = &self.csg.primitives;
        self.answer(questions, DualRange::UNKNOWN, |batch, at, out: &mut [DualRange]| {
            let unknown = Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };
            let mut found = vec![unknown; at.len()];
            batch.tape.gradient_over(at, &mut found)?;
            let primitive = &primitives[batch.primitive as usize];
            out.iter_mut().zip(found).for_each(|(out, slope)| *out = DualRange::new(primitive, &slope));
            Ok(())
        })
    }

    /// Answers in the order of the questions, whatever the batches.
    fn answer<Q: QueryRegion, R: IntervalHull>(
        &mut self,
        questions: &[(u32, Q)],
        none: R,
        ask: impl Fn(&TapeBatch, &[Q], &mut [R]) -> Result<(), LeafError> + Sync,
    ) -> Result<Vec<R>, LeafError> {
        let most = if self.has_leaves { questions.len().max(1) } else { AT_ONCE };
        let mut answers = Vec::with_capacity(questions.len());
        for part in questions.chunks(most) {
            self.answer_part(part, none, &ask, &mut answers)?;
        }
        Ok(answers)
    }

    fn answer_part<Q: QueryRegion, R: IntervalHull>(
        &mut self,
        questions: &[(u32, Q)],
        none: R,
        ask: &(impl Fn(&TapeBatch, &[Q], &mut [R]) -> Result<(), LeafError> + Sync),
        answers: &mut Vec<R>,
    ) -> Result<(), LeafError> {
        let batches = self.batches(questions)?;
        let found = par_map(self.job, &batches, |_, batch| {
            let at: Vec<Q> = batch.rows.iter().map(|row| questions[*row as usize].1).collect();
            let mut out = vec![none; at.len()];
            ask(batch, &at, &mut out).map(|()| out)
        });
        let start = answers.len();
        answers.resize(start + questions.len(), none);
        let mut is_known = vec![false; questions.len()];
        for (batch, found) in batches.iter().zip(found) {
            for (row, answer) in batch.rows.iter().zip(found?) {
                let known = &mut answers[start + *row as usize];
                *known = if is_known[*row as usize] { known.hull(answer) } else { answer };
                is_known[*row as usize] = true;
            }
        }
        Ok(())
    }

    /// The questions by tape.
    fn batches<Q: QueryRegion>(&mut self, questions: &[(u32, Q)]) -> Result<Vec<TapeBatch>, LeafError> {
        let mut by_primitive: Vec<Vec<u32>> = vec![Vec::new(); self.regions.len()];
        questions.iter().enumerate().for_each(|(row, (p, _))| by_primitive[*p as usize].push(row as u32));
        let mut batches = Vec::new();
        for (primitive, rows) in by_primitive.into_iter().enumerate().filter(|(_, rows)| !rows.is_empty()) {
            let number = primitive as u32;
            let rows = if Q::BRANCHES { self.branch(number, questions, rows, &mut batches)? } else { rows };
            if rows.is_empty() {
                continue;
            }
            let tape = &self.regions[primitive][0].tape;
            if !is_pruned(tape) || rows.len() < WORTH && self.regions[primitive].len() == 1 {
                TapeBatch::push_all(number, tape, &rows, &mut batches);
                continue;
            }
            self.route(number, questions, rows, &mut batches)?;
        }
        Ok(batches)
    }

    /// Asks the functions that a primitive with steps is made of; what is left is to be asked for as a whole.
    fn branch<Q: QueryRegion>(
        &mut self,
        primitive: u32,
        questions: &[(u32, Q)],
        rows: Vec<u32>,
        batches: &mut Vec<TapeBatch>,
    ) -> Result<Vec<u32>, LeafError> {
        let Some(branches) = &mut self.branches[primitive as usize] else { return Ok(rows) };
        let boxes: Vec<Box3> = rows.iter().map(|row| questions[*row as usize].1.bounds()).collect();
        let functions = branches.over(&boxes)?;
        let mut by_function: Vec<Vec<u32>> = vec![Vec::new(); branches.functions.len()];
        let mut left = Vec::new();
        for (row, functions) in rows.into_iter().zip(functions) {
            match functions {
                Some(all) => all.into_iter().for_each(|number| by_function[number as usize].push(row)),
                None => left.push(row),
            }
        }
        for (tape, rows) in branches.functions.iter().zip(&by_function) {
            TapeBatch::push_all(primitive, tape, rows, batches);
        }
        Ok(left)
    }

    /// Sends questions down the regions of a primitive, level by level, making those that are worth it.
    fn route<Q: QueryRegion>(
        &mut self,
        primitive: u32,
        questions: &[(u32, Q)],
        rows: Vec<u32>,
        batches: &mut Vec<TapeBatch>,
    ) -> Result<(), LeafError> {
        let mut open = vec![(0_u32, rows)];
        while !open.is_empty() {
            let mut below: Vec<(u32, usize, Vec<u32>)> = Vec::new();
            for (number, rows) in open {
                let region = &self.regions[primitive as usize][number as usize];
                let mut here = Vec::new();
                let mut parts: [Vec<u32>; 8] = Default::default();
                let ends = region.level == DEEPEST || !is_pruned(&region.tape);
                for row in rows {
                    let octant = if ends { None } else { region.octant(&questions[row as usize].1.bounds()) };
                    octant.map_or(&mut here, |octant| &mut parts[octant]).push(row);
                }
                for (octant, rows) in parts.into_iter().enumerate() {
                    let exists = region.children[octant].is_some();
                    if exists || rows.len() >= WORTH && self.steps_left > region.tape.len() as u64 {
                        below.push((number, octant, rows));
                    } else {
                        here.extend(rows);
                    }
                }
                TapeBatch::push_all(primitive, &region.tape, &here, batches);
            }
            let children = self.children(primitive, &below)?;
            open = children.into_iter().zip(below).map(|(child, (_, _, rows))| (child, rows)).collect();
            open.retain(|(_, rows)| !rows.is_empty());
        }
        Ok(())
    }

    /// The numbers of child regions, made where they are not there yet.
    fn children(&mut self, primitive: u32, wanted: &[(u32, usize, Vec<u32>)]) -> Result<Vec<u32>, LeafError> {
        let regions = &self.regions[primitive as usize];
        let new: Vec<(u32, usize)> = wanted
            .iter()
            .map(|(parent, octant, _)| (*parent, *octant))
            .filter(|(parent, octant)| regions[*parent as usize].children[*octant].is_none())
            .collect();
        let made = par_map(self.job, &new, |_, (parent, octant)| regions[*parent as usize].child(*octant));
        for ((parent, octant), child) in new.iter().zip(made) {
            let child = child?;
            self.steps_left = self.steps_left.saturating_sub(child.tape.len() as u64);
            let regions = &mut self.regions[primitive as usize];
            regions[*parent as usize].children[*octant] = Some(regions.len() as u32);
            regions.push(child);
        }
        let regions = &self.regions[primitive as usize];
        let child =
            |(parent, octant, _): &(u32, usize, Vec<u32>)| regions[*parent as usize].children[*octant];
        Ok(wanted.iter().map(|one| child(one).expect("it was made")).collect())
    }
}

/// Whether a region may have fewer steps: there are many, and some of them choose. Leaves want to be asked
/// for much at once.
fn is_pruned(tape: &Tape) -> bool {
    let chooses = |term: &Term| {
        matches!(
            term,
            Term::Binary(Binary::Min | Binary::Max | Binary::SmoothMin | Binary::And | Binary::Or, ..)
        )
    };
    tape.len() >= LONG && !tape.has_leaves() && tape.graph().terms().iter().any(chooses)
}

impl TapeRegion {
    /// The octant whose region holds a box, which is the one of its middle, if any.
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

/// A cell with half of its size on every side.
fn around(cell: &Box3) -> Box3 {
    let half = |k: usize| 0.5 * (cell.max[k] - cell.min[k]);
    Box3 {
        min: std::array::from_fn(|k| cell.min[k] - half(k)),
        max: std::array::from_fn(|k| cell.max[k] + half(k)),
    }
}
