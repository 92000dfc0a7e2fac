//! `FieldOctree`: an octree of the cells that may contain the surface, with the slopes of the field there.
use super::super::{DistanceQuality, Dual, ExprGraph, Field, LeafError, Tape, Term};
use super::voxels::{Voxel, VoxelGrid};
use crate::budget::{Job, par_map};
use crate::math::{Box3, Interval, greater, lesser};

/// The first level on which cells may stay, and the one on which all do: cells of a 32nd to a 128th of the
/// size. Chosen by timing pictures; finer ones take longer to make than they save.
const FIRST: u32 = 5;
const LAST: u32 = 7;
/// The most cells before division ends: about 100 MB.
const MOST_CELLS: usize = 500_000;
/// Shorter tapes gain nothing by pruning, and one tape for all makes large batches.
const SHORT: usize = 48;
/// Cells processed at once: enough for batches, with enough chunks for all threads.
const CHUNK: usize = 256;
/// The margins below and above the box, as fractions of its size. They differ, so that flat faces and planes
/// of symmetry do not lie between two cells.
const MARGIN: [f64; 2] = [0.0137, 0.0171];
/// The widest interval of slopes, relative to its middle, with which steps are long enough.
const NARROW: f64 = 0.35;
/// By how much sampled slopes are widened, as fractions of their width and of the largest: chosen by looking
/// at pictures.
const WIDER: [f64; 2] = [0.25, 0.05];
/// The effect of rounding on the interval of a value at a point: derived in
/// [`FieldOctree::classify_by_gradient`], 2⁻⁴⁷.
const SLACK: f64 = 1.0 / 140_737_488_355_328.0;

/// Why no octree can be built.
#[derive(Clone, Debug)]
pub enum FieldOctreeError {
    /// The box is empty, a single point, or reaches to infinity.
    Region(Box3),
    /// A leaf failed.
    Leaf(LeafError),
}

impl std::fmt::Display for FieldOctreeError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Region(b) => write!(f, "there is no finite box to look in: {:?} to {:?}", b.min, b.max),
            Self::Leaf(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for FieldOctreeError {}

impl From<LeafError> for FieldOctreeError {
    fn from(error: LeafError) -> Self {
        Self::Leaf(error)
    }
}

/// A part of space: 8 children in a row of the list, a cell, or a part without surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FieldOctreeNode {
    Outside,
    Inside,
    Children(u32),
    Cell(u32),
}

/// A part that may contain the surface.
#[derive(Clone, Debug)]
pub(super) struct FieldOctreeCell {
    pub bounds: Box3,
    /// Intervals of the slopes along x, y and z; infinite where nothing is known.
    pub slopes: [[f64; 2]; 3],
    /// An interval of the value in the middle, widened by the effect of rounding on
    /// [`FieldOctreeCell::value_at`].
    pub middle: [f64; 2],
    pub tape: u32,
    /// The index in [`FieldOctree::estimates`]; [`NONE`] where the slopes are narrow.
    pub estimate: u32,
}

/// The slopes in a cell and the value in its middle, estimated from samples: no proof.
#[derive(Clone, Copy, Debug)]
pub(super) struct GradientEstimate {
    pub slopes: [[f64; 2]; 3],
    pub middle: f64,
}

impl GradientEstimate {
    /// Estimates from samples, the last in the middle; `None` where some are not finite.
    fn from_samples(samples: &[Dual<f64>]) -> Option<Self> {
        let finite = |s: &Dual<f64>| s.value.is_finite() && s.gradient.iter().all(|g| g.is_finite());
        if !samples.iter().all(finite) {
            return None;
        }
        let slopes = [0, 1, 2].map(|k| {
            let first = samples[0].gradient[k];
            let [low, high] = samples
                .iter()
                .map(|s| s.gradient[k])
                .fold([first; 2], |[low, high], g| [lesser(g, low), greater(g, high)]);
            let most = greater(-low, high);
            let more = WIDER[0] * (high - low) + WIDER[1] * most;
            [low - more, high + more]
        });
        samples.last().map(|s| Self { slopes, middle: s.value })
    }
}

/// No row of [`FieldOctree::estimates`].
const NONE: u32 = u32::MAX;

impl FieldOctreeCell {
    /// An interval of the value at a point of the cell, by the mean value theorem, from slopes and the value
    /// in the middle. Along a line its lower end is concave and its upper end convex: sums of minima and of
    /// maxima of straight lines.
    pub fn value_at(&self, (slopes, value): (&[[f64; 2]; 3], [f64; 2]), p: [f64; 3]) -> [f64; 2] {
        let [mut low, mut high] = value;
        let middle = self.bounds.centre();
        for k in 0..3 {
            let off = p[k] - middle[k];
            let (a, b) = (slopes[k][0] * off, slopes[k][1] * off);
            low += lesser(a, b);
            high += greater(b, a);
        }
        [low, high]
    }
}

/// The cells that may contain the surface of a field. Everything else is proved to be on one side, by
/// intervals or by the field's distance quality. Each cell has a tape that is valid inside it, and intervals
/// of the slopes.
#[derive(Clone, Debug)]
pub struct FieldOctree {
    pub(super) corner: [f64; 3],
    pub(super) size: f64,
    pub(super) nodes: Vec<FieldOctreeNode>,
    pub(super) cells: Vec<FieldOctreeCell>,
    pub(super) tapes: Vec<Tape>,
    /// Whether the value is a distance bound outside and inside, where the tapes are those of the value.
    pub(super) is_distance_bound: [bool; 2],
    /// The number of points that a call of the tape should have.
    pub(super) batch: usize,
    pub(super) voxels: VoxelGrid,
    /// Sampled slopes of the cells whose slopes are not narrow; see [`FieldOctree::sample_gradients`].
    pub(super) estimates: Vec<GradientEstimate>,
    occupied: Box3,
}

#[derive(Clone, Copy)]
struct PendingOctant {
    part: u32,
    bounds: Box3,
    tape: u32,
}

/// What was found out about one part.
struct OctantClass {
    part: FieldOctreeNode,
    slopes: [[f64; 2]; 3],
    middle: [f64; 2],
    settled: bool,
    tape: Option<Tape>,
}

const UNKNOWN: Dual<Interval> = Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };

impl OctantClass {
    /// A cell about which nothing is known.
    fn unknown() -> Self {
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        Self { part: FieldOctreeNode::Cell(0), slopes: [all; 3], middle: all, settled: false, tape: None }
    }
}

impl FieldOctree {
    /// Divides the field's own box.
    ///
    /// Cost: intervals for about 8 times the cells that the surface passes through at a 32nd of the size,
    /// more where its slopes turn quickly.
    ///
    /// # Errors
    /// [`FieldOctreeError`] when there is no finite box, or when a leaf fails.
    pub fn build(field: &Field, job: &Job) -> Result<Self, FieldOctreeError> {
        let place = field.bounds();
        let finite = |x: &f64| x.is_finite();
        let longest = (0..3).map(|k| place.max[k] - place.min[k]).fold(0.0, |a, b| greater(b, a));
        let flat = [0, 1, 2].iter().any(|k| place.min[*k] > place.max[*k]);
        if flat || !place.min.iter().chain(&place.max).all(finite) || !(longest > 0.0 && longest.is_finite())
        {
            return Err(FieldOctreeError::Region(place));
        }
        let size = longest * (1.0 + MARGIN[0] + MARGIN[1]);
        let middle = place.centre();
        let corner = middle.map(|m| m - (0.5 + MARGIN[0]) * longest);
        let own_sign = field.has_own_sign();
        let tape = Tape::new(field.sign());
        let worth = field.distance();
        let word =
            [worth.outside, worth.inside].map(|quality| !own_sign && quality >= DistanceQuality::Bound);
        let batch = batch_of(&ExprGraph::from_expr(field.sign()));
        let mut cells = Self {
            corner,
            size,
            nodes: vec![FieldOctreeNode::Outside],
            cells: Vec::new(),
            tapes: vec![tape],
            is_distance_bound: word,
            batch,
            voxels: VoxelGrid::default(),
            estimates: Vec::new(),
            occupied: Box3::EMPTY,
        };
        let levels = cells.divide(&place, job)?;
        cells.voxels = VoxelGrid::from_octree(&cells.nodes, levels);
        Ok(cells)
    }

    /// A box around the surface and the inside.
    #[must_use]
    pub fn occupied(&self) -> Box3 {
        self.occupied
    }

    /// The corners of all cells: points around the surface.
    pub fn corners(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.cells.iter().flat_map(|cell| {
            let b = cell.bounds;
            (0..8).map(move |i| corner(&b, i))
        })
    }

    /// The number of cells that the surface may pass through.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether there is no surface at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The side of the cube that was divided.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The tape of the whole surface.
    #[must_use]
    pub fn tape(&self) -> &Tape {
        &self.tapes[0]
    }

    /// The side of a voxel.
    pub(super) fn voxel_size(&self) -> f64 {
        self.size / f64::from(self.voxels.across)
    }

    /// The index of the tape that is valid at a point: that of its cell, else the whole one.
    pub(super) fn tape_at(&self, p: [f64; 3]) -> u32 {
        let (_, room) = self.voxels.at([0, 1, 2].map(|k| (p[k] - self.corner[k]) / self.voxel_size()));
        if let Voxel::Cell(cell) = room { self.cells[cell as usize].tape } else { 0 }
    }

    /// Divides every part that has to be, and returns the number of levels.
    fn divide(&mut self, place: &Box3, job: &Job) -> Result<u32, FieldOctreeError> {
        let all = Box3 { min: self.corner, max: self.corner.map(|x| x + self.size) };
        let mut open = vec![PendingOctant { part: 0, bounds: all, tape: 0 }];
        let mut level = 0;
        while !open.is_empty() {
            let many = open.len() + self.cells.len() > MOST_CELLS || job.is_cancelled();
            let chunks: Vec<&[PendingOctant]> = open.chunks(CHUNK).collect();
            let this = &*self;
            let found = par_map(job, &chunks, |_, chunk| this.classify(chunk, place, level));
            let mut next = Vec::new();
            for (chunk, found) in chunks.iter().zip(found) {
                for (one, found) in chunk.iter().zip(found?) {
                    self.insert(one, found, level == LAST || many, &mut next);
                }
            }
            open = next;
            level += 1;
        }
        Ok(level - 1)
    }

    /// Samples slopes in the cells whose slope intervals are not narrow. This is for light beams, which
    /// accept likely answers.
    ///
    /// Intervals of long expressions are often much wider than the values. Slopes sampled in the middle and
    /// at the corners, and widened, are seldom wrong; they miss only details thinner than a cell that no
    /// corner is nearest to.
    pub(crate) fn sample_gradients(&mut self, job: &Job) -> Result<(), LeafError> {
        let wide = |k: &usize| !is_narrow(&self.cells[*k].slopes);
        let wide: Vec<usize> = (0..self.cells.len()).filter(wide).collect();
        let chunks: Vec<&[usize]> = wide.chunks(CHUNK).collect();
        let this = &*self;
        let found = par_map(job, &chunks, |_, chunk| this.estimate_gradients(chunk));
        for (chunk, found) in chunks.iter().zip(found) {
            for (k, seen) in chunk.iter().zip(found?) {
                if let Some(seen) = seen {
                    self.cells[*k].estimate = self.estimates.len() as u32;
                    self.estimates.push(seen);
                }
            }
        }
        Ok(())
    }

    fn estimate_gradients(&self, chunk: &[usize]) -> Result<Vec<Option<GradientEstimate>>, LeafError> {
        let mut found = Vec::with_capacity(chunk.len());
        for run in chunk.chunk_by(|a, b| self.cells[*a].tape == self.cells[*b].tape) {
            let cells = run.iter().map(|k| &self.cells[*k]);
            let points: Vec<[f64; 3]> = cells
                .flat_map(|cell| (0..8).map(|i| corner(&cell.bounds, i)).chain([cell.bounds.centre()]))
                .collect();
            let mut slopes = vec![Dual { value: f64::NAN, gradient: [f64::NAN; 3] }; points.len()];
            self.tapes[self.cells[run[0]].tape as usize].gradient_at(&points, &mut slopes)?;
            found.extend(slopes.chunks_exact(9).map(GradientEstimate::from_samples));
        }
        Ok(found)
    }

    fn insert(&mut self, one: &PendingOctant, found: OctantClass, last: bool, next: &mut Vec<PendingOctant>) {
        let tape = match found.tape {
            Some(tape) => {
                self.tapes.push(tape);
                self.tapes.len() as u32 - 1
            }
            None => one.tape,
        };
        self.nodes[one.part as usize] = match found.part {
            FieldOctreeNode::Outside => FieldOctreeNode::Outside,
            FieldOctreeNode::Inside => {
                self.occupied = self.occupied.union(one.bounds);
                FieldOctreeNode::Inside
            }
            _ if last || found.settled => {
                self.occupied = self.occupied.union(one.bounds);
                let (slopes, middle) = (found.slopes, found.middle);
                self.cells.push(FieldOctreeCell { bounds: one.bounds, slopes, middle, tape, estimate: NONE });
                FieldOctreeNode::Cell(self.cells.len() as u32 - 1)
            }
            _ => {
                let first = self.nodes.len() as u32;
                for i in 0..8 {
                    self.nodes.push(FieldOctreeNode::Outside);
                    next.push(PendingOctant { part: first + i, bounds: octant(&one.bounds, i), tape });
                }
                FieldOctreeNode::Children(first)
            }
        };
    }

    fn classify(
        &self,
        open: &[PendingOctant],
        place: &Box3,
        level: u32,
    ) -> Result<Vec<OctantClass>, LeafError> {
        let boxes: Vec<Box3> = open.iter().map(|one| one.bounds).collect();
        let mut ranges = vec![Interval::UNKNOWN; open.len()];
        self.for_each_tape(open, |tape, rows| tape.over(&boxes[rows.clone()], &mut ranges[rows]))?;
        let mut found = Vec::with_capacity(open.len());
        for (one, range) in open.iter().zip(&ranges) {
            found.push(self.classify_by_range(one, *range, place, level)?);
        }
        if level < FIRST {
            return Ok(found);
        }
        let undecided: Vec<usize> =
            (0..open.len()).filter(|k| found[*k].part == FieldOctreeNode::Cell(0)).collect();
        let rest: Vec<PendingOctant> = undecided.iter().map(|k| open[*k]).collect();
        let boxes: Vec<Box3> = rest.iter().map(|one| one.bounds).collect();
        let middles: Vec<Box3> = boxes.iter().map(|b| Box3 { min: b.centre(), max: b.centre() }).collect();
        let mut slopes = vec![UNKNOWN; rest.len()];
        let mut values = vec![Interval::UNKNOWN; rest.len()];
        self.for_each_tape(&rest, |tape, rows| {
            tape.gradient_over(&boxes[rows.clone()], &mut slopes[rows.clone()])?;
            tape.over(&middles[rows.clone()], &mut values[rows])
        })?;
        for (row, k) in undecided.into_iter().enumerate() {
            let found = &mut found[k];
            if let Some(tape) = found.tape.as_ref().filter(|_| !has_gradient(&slopes[row])) {
                // Pruning may have left out what was undefined.
                tape.gradient_over(&boxes[row..=row], &mut slopes[row..=row])?;
            }
            self.classify_by_gradient(&boxes[row], ranges[k], slopes[row], values[row], found);
        }
        Ok(found)
    }

    /// Calls `work` with the rows of each run that shares a tape; neighbours in the list mostly do.
    fn for_each_tape(
        &self,
        open: &[PendingOctant],
        mut work: impl FnMut(&Tape, std::ops::Range<usize>) -> Result<(), LeafError>,
    ) -> Result<(), LeafError> {
        let mut start = 0;
        for run in open.chunk_by(|a, b| a.tape == b.tape) {
            work(&self.tapes[run[0].tape as usize], start..start + run.len())?;
            start += run.len();
        }
        Ok(())
    }

    /// Classifies a part by its interval, and prunes its tape.
    fn classify_by_range(
        &self,
        one: &PendingOctant,
        range: Interval,
        place: &Box3,
        level: u32,
    ) -> Result<OctantClass, LeafError> {
        let tape = &self.tapes[one.tape as usize];
        let settled = |part| OctantClass { part, settled: true, ..OctantClass::unknown() };
        let apart = (0..3).any(|k| one.bounds.min[k] > place.max[k] || one.bounds.max[k] < place.min[k]);
        if apart {
            return Ok(settled(FieldOctreeNode::Outside));
        }
        let range = if range.is_entire() { self.classify_by_distance(one, range)? } else { range };
        if let Some(part) = certain_side(range) {
            return Ok(settled(part));
        }
        let mut found = OctantClass::unknown();
        let shortens = level.is_multiple_of(2) && level > 0;
        if shortens && tape.len() > SHORT {
            let (_, shorter) = tape.prune(&one.bounds)?;
            found.tape = shorter.filter(|shorter| 4 * shorter.len() <= 3 * tape.len());
        }
        Ok(found)
    }

    /// Classifies a part by its slopes.
    fn classify_by_gradient(
        &self,
        bounds: &Box3,
        range: Interval,
        slope: Dual<Interval>,
        value: Interval,
        found: &mut OctantClass,
    ) {
        // Slopes say nothing across a gap where the value is undefined.
        if !has_gradient(&slope) {
            found.settled = range.is_entire();
            return;
        }
        let gradient = slope.gradient;
        found.slopes = gradient.map(|g| [g.lo(), g.hi()]);
        // The mean value theorem: tighter than the interval itself where slopes hardly turn.
        let middle = bounds.centre();
        let sum = (0..3).fold(value, |sum, k| {
            let off = Interval::new(bounds.min[k], bounds.max[k]).unwrap_or(Interval::UNKNOWN)
                - Interval::point(middle[k]);
            sum + gradient[k] * off
        });
        if let Some(part) = certain_side(sum) {
            *found = OctantClass { part, settled: true, ..OctantClass::unknown() };
            return;
        }
        found.settled = range.is_entire() || is_narrow(&found.slopes);
        if value.is_defined() && !value.is_empty() {
            // Points on a beam are off by some 2⁻⁵⁰ of coordinates and lengths, sums by as much of their
            // terms.
            let magnitude = |x: [f64; 2]| greater(-x[0], x[1]);
            let parts = (0..3).fold(magnitude([value.lo(), value.hi()]), |sum, k| {
                sum + magnitude(found.slopes[k]) * (self.corner[k].abs() + 4.0 * self.size)
            });
            let slack = parts * SLACK;
            found.middle = [value.lo() - slack, value.hi() + slack];
        }
    }

    /// Where no interval is known, a value that is a distance bound may clear a part.
    fn classify_by_distance(&self, one: &PendingOctant, range: Interval) -> Result<Interval, LeafError> {
        let mut value = [f64::NAN];
        self.tapes[one.tape as usize].at(&[one.bounds.centre()], &mut value)?;
        // Half the diagonal, rounded well up.
        let reach = 0.500_001 * one.bounds.diagonal();
        let clear = if value[0] > reach {
            self.is_distance_bound[0]
        } else {
            value[0] < -reach && self.is_distance_bound[1]
        };
        Ok(if clear { Interval::point(value[0]) } else { range })
    }
}

/// Points with a negative value are inside. The interval contains all values that exist.
fn certain_side(range: Interval) -> Option<FieldOctreeNode> {
    if range.is_empty() || range.lo() >= 0.0 {
        return Some(FieldOctreeNode::Outside);
    }
    (range.hi() < 0.0 && range.is_defined()).then_some(FieldOctreeNode::Inside)
}

fn has_gradient(slope: &Dual<Interval>) -> bool {
    slope.value.is_defined() && slope.gradient.iter().all(|g| g.is_defined() && !g.is_empty())
}

fn is_narrow(slopes: &[[f64; 2]; 3]) -> bool {
    let (mut middle, mut width) = (0.0, 0.0);
    for [low, high] in slopes {
        let (m, w) = (0.5 * (low + high), 0.5 * (high - low));
        middle += m * m;
        width += w * w;
    }
    width <= NARROW * NARROW * middle
}

fn corner(b: &Box3, i: u32) -> [f64; 3] {
    [0, 1, 2].map(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] })
}

fn octant(b: &Box3, i: u32) -> Box3 {
    let middle = b.centre();
    let pick = |k: usize, low: f64, high: f64| if i >> k & 1 == 0 { low } else { high };
    Box3 {
        min: [0, 1, 2].map(|k| pick(k, b.min[k], middle[k])),
        max: [0, 1, 2].map(|k| pick(k, middle[k], b.max[k])),
    }
}

/// Expressions run best in blocks that stay in the processor's caches; leaves say what they prefer.
fn batch_of(graph: &ExprGraph) -> usize {
    graph.terms().iter().fold(1024, |most, term| match term {
        Term::Leaf(leaf, _) if leaf.preferred_batch() > most => leaf.preferred_batch(),
        _ => most,
    })
}
