//! `FieldOctree`: an octree of the cells that may contain the surface, with the slopes of the field there.
use super::super::{DistanceQuality, Dual, ExprGraph, Field, LeafError, Tape, Term};
use super::voxels::{FieldOctreeNode, Voxel, VoxelGrid};
use crate::budget::{Job, par_map};
use crate::math::{Box3, Interval, greater, lesser};

/// The first level at which cells may be kept, and the last, at which all are: cells of a 32nd to a 128th of
/// the size. Chosen by timing pictures; finer cells take longer to build than they save.
const FIRST: u32 = 5;
const LAST: u32 = 7;
/// The most cells before division ends: about 100 MB. Defined.
const MOST_CELLS: usize = 500_000;
/// Shorter tapes gain nothing by pruning, and one tape for all parts makes large batches.
const SHORT: usize = 48;
/// Cells processed at once. Chosen: enough for batches, with enough chunks for all threads.
const CHUNK: usize = 256;
/// The margins below and above the box, as fractions of its size. They differ, so that flat faces and planes
/// of symmetry do not lie between two cells.
const MARGIN: [f64; 2] = [0.0137, 0.0171];
/// The widest interval of slopes, relative to its middle, with which steps are long enough.
const NARROW: f64 = 0.35;
/// The widening of sampled slopes, as fractions of their width and of the largest slope. Chosen by looking at
/// pictures.
const WIDER: [f64; 2] = [0.25, 0.05];
/// The effect of rounding on the interval of a value at a point. Derived in
/// [`FieldOctree::classify_by_gradient`]: 2⁻⁴⁷.
const SLACK: f64 = 1.0 / 140_737_488_355_328.0;

/// Why an octree cannot be built.
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

/// A part that may contain the surface.
#[derive(Clone, Debug)]
pub(super) struct FieldOctreeCell {
    pub bounds: Box3,
    /// Intervals of the slopes along x, y and z; infinite if unknown.
    pub slopes: [[f64; 2]; 3],
    /// An interval of the value in the middle, widened by the effect of rounding on
    /// [`FieldOctreeCell::value_at`].
    pub middle: [f64; 2],
    pub tape: u32,
    /// The index in [`FieldOctree::estimates`]; [`NONE`] if the slopes are narrow.
    pub estimate: u32,
}

/// The slopes in a cell and the value in its middle, estimated from samples, not proved.
#[derive(Clone, Copy, Debug)]
pub(super) struct GradientEstimate {
    pub slopes: [[f64; 2]; 3],
    pub middle: f64,
}

impl GradientEstimate {
    /// Estimates from samples, the last in the middle; `None` if one is not finite.
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
            let largest = greater(-low, high);
            let margin = WIDER[0] * (high - low) + WIDER[1] * largest;
            [low - margin, high + margin]
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
            let offset = p[k] - middle[k];
            let (a, b) = (slopes[k][0] * offset, slopes[k][1] * offset);
            low += lesser(a, b);
            high += greater(b, a);
        }
        [low, high]
    }
}

/// The cells that may contain the surface of a field. The rest of space is proved to be on one side, by
/// intervals or by the field's distance quality. Each cell has a tape that is valid inside it, and intervals
/// of the slopes.
#[derive(Clone, Debug)]
pub struct FieldOctree {
    pub(super) corner: [f64; 3],
    pub(super) size: f64,
    pub(super) nodes: Vec<FieldOctreeNode>,
    pub(super) cells: Vec<FieldOctreeCell>,
    pub(super) tapes: Vec<Tape>,
    /// Whether the value is a distance bound outside and inside, if the tapes are those of the value.
    pub(super) is_distance_bound: [bool; 2],
    /// The best number of points per call of the tape.
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

/// The classification of one part.
struct OctantClass {
    part: FieldOctreeNode,
    slopes: [[f64; 2]; 3],
    middle: [f64; 2],
    settled: bool,
    tape: Option<Tape>,
}

const UNKNOWN: Dual<Interval> = Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };

impl OctantClass {
    /// A cell without information.
    fn unknown() -> Self {
        let unbounded = [f64::NEG_INFINITY, f64::INFINITY];
        Self {
            part: FieldOctreeNode::Cell(0),
            slopes: [unbounded; 3],
            middle: unbounded,
            settled: false,
            tape: None,
        }
    }
}

impl FieldOctree {
    /// Divides the field's own box.
    ///
    /// Cost: intervals for about 8 times the cells that the surface passes through at a 32nd of the size, and
    /// more where its slopes turn quickly.
    ///
    /// # Errors
    /// [`FieldOctreeError`] when there is no finite box, or when a leaf fails.
    pub fn build(field: &Field, job: &Job) -> Result<Self, FieldOctreeError> {
        let bounds = field.bounds();
        let finite = |x: &f64| x.is_finite();
        let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, |a, b| greater(b, a));
        let flat = [0, 1, 2].iter().any(|k| bounds.min[*k] > bounds.max[*k]);
        if flat
            || !bounds.min.iter().chain(&bounds.max).all(finite)
            || !(longest > 0.0 && longest.is_finite())
        {
            return Err(FieldOctreeError::Region(bounds));
        }
        let size = longest * (1.0 + MARGIN[0] + MARGIN[1]);
        let middle = bounds.centre();
        let corner = middle.map(|m| m - (0.5 + MARGIN[0]) * longest);
        let own_sign = field.has_own_sign();
        let tape = Tape::new(field.sign());
        let distance = field.distance();
        // With a sign of its own, the tape has other values than the field.
        let is_distance_bound =
            [distance.outside, distance.inside].map(|quality| !own_sign && quality >= DistanceQuality::Bound);
        let batch = batch_of(&ExprGraph::from_expr(field.sign()));
        let mut cells = Self {
            corner,
            size,
            nodes: vec![FieldOctreeNode::Outside],
            cells: Vec::new(),
            tapes: vec![tape],
            is_distance_bound,
            batch,
            voxels: VoxelGrid::default(),
            estimates: Vec::new(),
            occupied: Box3::EMPTY,
        };
        let levels = cells.divide(&bounds, job)?;
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

    /// The tape of the full field.
    #[must_use]
    pub fn tape(&self) -> &Tape {
        &self.tapes[0]
    }

    /// The side of a voxel.
    pub(super) fn voxel_size(&self) -> f64 {
        self.size / f64::from(self.voxels.across)
    }

    /// The index of the tape that is valid at a point: that of its cell, or 0 for the full tape.
    pub(super) fn tape_at(&self, p: [f64; 3]) -> u32 {
        let (_, voxel) = self.voxels.at([0, 1, 2].map(|k| (p[k] - self.corner[k]) / self.voxel_size()));
        if let Voxel::Cell(cell) = voxel { self.cells[cell as usize].tape } else { 0 }
    }

    /// Divides all parts that need it, and returns the number of levels.
    fn divide(&mut self, bounds: &Box3, job: &Job) -> Result<u32, FieldOctreeError> {
        let root = Box3 { min: self.corner, max: self.corner.map(|x| x + self.size) };
        let mut open = vec![PendingOctant { part: 0, bounds: root, tape: 0 }];
        let mut level = 0;
        while !open.is_empty() {
            let many = open.len() + self.cells.len() > MOST_CELLS || job.is_cancelled();
            let chunks: Vec<&[PendingOctant]> = open.chunks(CHUNK).collect();
            let this = &*self;
            let results = par_map(job, &chunks, |_, chunk| this.classify(chunk, bounds, level));
            let mut next = Vec::new();
            // In the order of the parts, so that numbers do not depend on threads.
            for (chunk, classes) in chunks.iter().zip(results) {
                for (octant, class) in chunk.iter().zip(classes?) {
                    self.insert(octant, class, level == LAST || many, &mut next);
                }
            }
            open = next;
            level += 1;
        }
        Ok(level - 1)
    }

    /// Samples slopes in the cells whose slope intervals are not narrow, for light beams, which accept likely
    /// answers.
    ///
    /// Intervals of long expressions are often much wider than the values. Slopes sampled in the middle and
    /// at the corners, and widened, are seldom wrong; they miss only details thinner than a cell and away
    /// from its corners.
    pub(crate) fn sample_gradients(&mut self, job: &Job) -> Result<(), LeafError> {
        let wide = |k: &usize| !is_narrow(&self.cells[*k].slopes);
        let wide: Vec<usize> = (0..self.cells.len()).filter(wide).collect();
        let chunks: Vec<&[usize]> = wide.chunks(CHUNK).collect();
        let this = &*self;
        let results = par_map(job, &chunks, |_, chunk| this.estimate_gradients(chunk));
        for (chunk, estimates) in chunks.iter().zip(results) {
            for (k, estimate) in chunk.iter().zip(estimates?) {
                if let Some(estimate) = estimate {
                    self.cells[*k].estimate = self.estimates.len() as u32;
                    self.estimates.push(estimate);
                }
            }
        }
        Ok(())
    }

    fn estimate_gradients(&self, chunk: &[usize]) -> Result<Vec<Option<GradientEstimate>>, LeafError> {
        let mut estimates = Vec::with_capacity(chunk.len());
        for run in chunk.chunk_by(|a, b| self.cells[*a].tape == self.cells[*b].tape) {
            let cells = run.iter().map(|k| &self.cells[*k]);
            let points: Vec<[f64; 3]> = cells
                .flat_map(|cell| (0..8).map(|i| corner(&cell.bounds, i)).chain([cell.bounds.centre()]))
                .collect();
            let mut slopes = vec![Dual { value: f64::NAN, gradient: [f64::NAN; 3] }; points.len()];
            self.tapes[self.cells[run[0]].tape as usize].gradient_at(&points, &mut slopes)?;
            estimates.extend(slopes.chunks_exact(9).map(GradientEstimate::from_samples));
        }
        Ok(estimates)
    }

    fn insert(
        &mut self,
        pending: &PendingOctant,
        class: OctantClass,
        last: bool,
        next: &mut Vec<PendingOctant>,
    ) {
        // A pruned tape serves the octant and all parts of it.
        let tape = match class.tape {
            Some(tape) => {
                self.tapes.push(tape);
                self.tapes.len() as u32 - 1
            }
            None => pending.tape,
        };
        self.nodes[pending.part as usize] = match class.part {
            FieldOctreeNode::Outside => FieldOctreeNode::Outside,
            FieldOctreeNode::Inside => {
                self.occupied = self.occupied.union(pending.bounds);
                FieldOctreeNode::Inside
            }
            _ if last || class.settled => {
                self.occupied = self.occupied.union(pending.bounds);
                let (slopes, middle) = (class.slopes, class.middle);
                self.cells.push(FieldOctreeCell {
                    bounds: pending.bounds,
                    slopes,
                    middle,
                    tape,
                    estimate: NONE,
                });
                FieldOctreeNode::Cell(self.cells.len() as u32 - 1)
            }
            _ => {
                let first = self.nodes.len() as u32;
                for i in 0..8 {
                    self.nodes.push(FieldOctreeNode::Outside);
                    next.push(PendingOctant { part: first + i, bounds: octant(&pending.bounds, i), tape });
                }
                FieldOctreeNode::Children(first)
            }
        };
    }

    fn classify(
        &self,
        open: &[PendingOctant],
        region: &Box3,
        level: u32,
    ) -> Result<Vec<OctantClass>, LeafError> {
        let boxes: Vec<Box3> = open.iter().map(|pending| pending.bounds).collect();
        let mut ranges = vec![Interval::UNKNOWN; open.len()];
        self.for_each_tape(open, |tape, rows| tape.over(&boxes[rows.clone()], &mut ranges[rows]))?;
        let mut classes = Vec::with_capacity(open.len());
        for (pending, range) in open.iter().zip(&ranges) {
            classes.push(self.classify_by_range(pending, *range, region, level)?);
        }
        if level < FIRST {
            return Ok(classes);
        }
        let undecided: Vec<usize> =
            (0..open.len()).filter(|k| classes[*k].part == FieldOctreeNode::Cell(0)).collect();
        let undecided_parts: Vec<PendingOctant> = undecided.iter().map(|k| open[*k]).collect();
        let boxes: Vec<Box3> = undecided_parts.iter().map(|pending| pending.bounds).collect();
        let middles: Vec<Box3> = boxes.iter().map(|b| Box3 { min: b.centre(), max: b.centre() }).collect();
        let mut slopes = vec![UNKNOWN; undecided_parts.len()];
        let mut values = vec![Interval::UNKNOWN; undecided_parts.len()];
        self.for_each_tape(&undecided_parts, |tape, rows| {
            tape.gradient_over(&boxes[rows.clone()], &mut slopes[rows.clone()])?;
            tape.over(&middles[rows.clone()], &mut values[rows])
        })?;
        for (row, k) in undecided.into_iter().enumerate() {
            let class = &mut classes[k];
            if let Some(tape) = class.tape.as_ref().filter(|_| !has_gradient(&slopes[row])) {
                // Pruning may have left out an undefined part.
                tape.gradient_over(&boxes[row..=row], &mut slopes[row..=row])?;
            }
            self.classify_by_gradient(&boxes[row], ranges[k], slopes[row], values[row], class);
        }
        Ok(classes)
    }

    /// Calls `work` with the rows of each run that shares a tape; neighbours in the list usually do.
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
        pending: &PendingOctant,
        range: Interval,
        region: &Box3,
        level: u32,
    ) -> Result<OctantClass, LeafError> {
        let tape = &self.tapes[pending.tape as usize];
        let settled = |part| OctantClass { part, settled: true, ..OctantClass::unknown() };
        let apart =
            (0..3).any(|k| pending.bounds.min[k] > region.max[k] || pending.bounds.max[k] < region.min[k]);
        if apart {
            return Ok(settled(FieldOctreeNode::Outside));
        }
        // An interval without ends says nothing, but a distance may.
        let range = if range.is_entire() { self.classify_by_distance(pending, range)? } else { range };
        if let Some(part) = certain_side(range) {
            return Ok(settled(part));
        }
        let mut class = OctantClass::unknown();
        let shortens = level.is_multiple_of(2) && level > 0;
        if shortens && tape.len() > SHORT {
            let (_, shorter) = tape.prune(&pending.bounds)?;
            class.tape = shorter.filter(|shorter| 4 * shorter.len() <= 3 * tape.len());
        }
        Ok(class)
    }

    /// Classifies a part by its slopes.
    fn classify_by_gradient(
        &self,
        bounds: &Box3,
        range: Interval,
        slope: Dual<Interval>,
        value: Interval,
        class: &mut OctantClass,
    ) {
        // Slopes prove nothing across a gap where the value is undefined.
        if !has_gradient(&slope) {
            class.settled = range.is_entire();
            return;
        }
        let gradient = slope.gradient;
        class.slopes = gradient.map(|g| [g.lo(), g.hi()]);
        // The mean value theorem: tighter than the interval itself where slopes hardly turn.
        let middle = bounds.centre();
        let sum = (0..3).fold(value, |sum, k| {
            let offset = Interval::new(bounds.min[k], bounds.max[k]).unwrap_or(Interval::UNKNOWN)
                - Interval::point(middle[k]);
            sum + gradient[k] * offset
        });
        if let Some(part) = certain_side(sum) {
            *class = OctantClass { part, settled: true, ..OctantClass::unknown() };
            return;
        }
        class.settled = range.is_entire() || is_narrow(&class.slopes);
        if value.is_defined() && !value.is_empty() {
            // Points on a beam are off by some 2⁻⁵⁰ of coordinates and lengths, sums by as much of their
            // terms.
            let magnitude = |x: [f64; 2]| greater(-x[0], x[1]);
            let parts = (0..3).fold(magnitude([value.lo(), value.hi()]), |sum, k| {
                sum + magnitude(class.slopes[k]) * (self.corner[k].abs() + 4.0 * self.size)
            });
            let slack = parts * SLACK;
            class.middle = [value.lo() - slack, value.hi() + slack];
        }
    }

    /// If no interval is known, a value that is a distance bound may clear a part.
    fn classify_by_distance(&self, pending: &PendingOctant, range: Interval) -> Result<Interval, LeafError> {
        let mut value = [f64::NAN];
        self.tapes[pending.tape as usize].at(&[pending.bounds.centre()], &mut value)?;
        // Half the diagonal, rounded well up.
        let reach = 0.500_001 * pending.bounds.diagonal();
        let clear = if value[0] > reach {
            self.is_distance_bound[0]
        } else {
            value[0] < -reach && self.is_distance_bound[1]
        };
        // Any number of this sign will do, since only the side is used.
        Ok(if clear { Interval::point(value[0]) } else { range })
    }
}

/// The side of all points, if they share one: points with a negative value are inside. The interval contains
/// all existing values.
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

/// The best batch size: expressions run best in blocks that stay in the processor's caches; leaves have their
/// own preference.
fn batch_of(graph: &ExprGraph) -> usize {
    graph.terms().iter().fold(1024, |batch, term| match term {
        Term::Leaf(leaf, _) if leaf.preferred_batch() > batch => leaf.preferred_batch(),
        _ => batch,
    })
}
