//! The search from the points of a field's surface to a mesh: the order in which boxes are split, and its
//! end.
//!
//! Every box has an upper bound at once: its centre's distance plus half its diagonal. As in the other
//! direction, the boxes that seem farthest come first, and those with a proved sign change raise the lower
//! bound. Once the allowed work is used up, the result is the largest upper bound of the remaining boxes.
use super::forward::ForwardDistance;
use super::from_field::{self, BoxVerdict, TargetMesh, may_cross};
use super::{FieldDeviationSearch, LEAF_CHUNK, POINTS_A_BOX, cube, leaf_failure, sub_boxes};
use crate::budget::{JobError, par_map};
use crate::implicit::{LeafError, Tape};
use crate::math::{Box3, Interval, greater, lesser};
use std::sync::Arc;

/// The bounds for all points of the field's surface.
pub(super) struct BackwardDistance {
    /// A lower bound: some point is this far.
    pub least: f64,
    pub most: f64,
    pub at: [f64; 3],
}

/// The most boxes in all: a multiple of the faces plus a constant.
const BOXES_A_FACE: usize = 16;
const FEW_BOXES: usize = 1 << 21;
/// The most boxes of one round in which a sign change is searched.
const TRIED: usize = 256;
/// The most rounds: boxes of the last one have 2⁻⁴⁸ of the side of the first.
const ROUNDS: usize = 24;
/// A box whose diagonal is below this share of its distance tells about as much as its parts would.
const SMALL: f64 = 0.01;
/// The same share of the sufficient distance, if there is a limit.
const SMALL_FOR_LIMIT: f64 = 0.02;
/// A round processes the boxes above this fraction between the sufficient distance and the largest bound.
const UPPER_PART: f64 = 0.5;

/// A box through which the surface may pass.
#[derive(Clone)]
struct OpenBox {
    tape: Arc<Tape>,
    bounds: Box3,
    /// An upper bound on the distance of the surface in it from the mesh.
    most: f64,
    cuts: usize,
}

impl FieldDeviationSearch<'_> {
    pub fn backward(
        &self,
        forward: &ForwardDistance,
        target: &mut TargetMesh,
    ) -> Result<BackwardDistance, JobError> {
        let faces = self.mesh.faces().len();
        let relative = self.goal.max.is_none();
        let mut boxes_left = BOXES_A_FACE * faces + FEW_BOXES;
        let mut result = BackwardDistance { least: 0.0, most: 0.0, at: self.bounds.centre() };
        let root = cube(&self.bounds);
        let tape = Arc::new(self.tape.clone());
        let mut open =
            vec![OpenBox { tape, bounds: root, most: from_field::distance_of(&root, target), cuts: 0 }];
        loop {
            self.check_cancelled()?;
            // The order matters: the lower bound sets the sufficient distance, which decides about
            // all boxes of the round.
            result.least =
                greater(result.least, self.farthest(&open, greater(result.least, forward.least), target)?);
            let least = greater(result.least, forward.least);
            target.tolerance = self.sufficient_distance(least);
            if relative && forward.most > self.aim(least, super::FORWARD_SHARE) {
                // The remaining gap of the other direction cannot be closed here. And columns here are
                // measured by the residual of the mesh, so the bound of the surface is no smaller.
                let factor = 1.0 + (1.0 - super::FORWARD_SHARE) * greater(self.goal.relative, 0.0);
                target.tolerance = greater(target.tolerance, factor * forward.most);
            }
            let beyond = self.goal.max.is_some_and(|max| least > max.get());
            let tiny = |open: &OpenBox| {
                let share = if relative { SMALL * open.most } else { SMALL_FOR_LIMIT * target.tolerance };
                open.cuts >= ROUNDS || open.bounds.diagonal() < share
            };
            let level = round_threshold(&open, target.tolerance);
            // What is open then counts with its upper bound, which holds at any time.
            let exhausted = boxes_left == 0 || beyond || self.job.is_over();
            let (next, done): (Vec<_>, Vec<_>) =
                open.into_iter().partition(|b| b.most > target.tolerance && !exhausted && !tiny(b));
            done.iter().for_each(|b| result.settle(b.most, &b.bounds));
            // The far boxes first: they may raise the lower bound, and boxes that are near enough
            // then are never split.
            let (mut now, mut later): (Vec<_>, Vec<_>) = next.into_iter().partition(|b| b.most > level);
            if now.is_empty() {
                return Ok(result);
            }
            // No more boxes at once than the remaining work allows.
            later.extend(now.split_off(now.len().min(boxes_left / 64 + 1)));
            let tasks = self.tasks(now)?;
            let results = par_map(self.job, &tasks, |_, task| task.run(target));
            open = later;
            for batch in results {
                let batch = batch.map_err(leaf_failure)?;
                boxes_left = boxes_left.saturating_sub(batch.n_boxes);
                self.job.count_work(POINTS_A_BOX * batch.n_boxes as u64);
                if let Some((most, bounds)) = batch.settled {
                    result.settle(most, &bounds);
                }
                open.extend(batch.open);
            }
        }
    }

    /// A lower bound on the distance from some point of the field's surface to the mesh: the largest one of
    /// the boxes that seem farthest and have a proved sign change.
    fn farthest(&self, open: &[OpenBox], least: f64, target: &TargetMesh) -> Result<f64, JobError> {
        // An estimate, to select a few boxes; the proved number is computed for these.
        let estimate = |b: &OpenBox| b.most - b.bounds.diagonal();
        let mut far: Vec<(f64, usize)> = open
            .iter()
            .enumerate()
            .map(|(k, b)| (estimate(b), k))
            .filter(|(estimate, k)| 1.05 * estimate > least && open[*k].most < f64::INFINITY)
            .collect();
        let order = |a: &(f64, usize), b: &(f64, usize)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
        if far.len() > TRIED {
            far.select_nth_unstable_by(TRIED, order);
            far.truncate(TRIED);
        }
        let points: Vec<Box3> = far
            .iter()
            .flat_map(|(_, k)| corners_of(&open[*k].bounds))
            .map(|p| Box3 { min: p, max: p })
            .collect();
        let mut values = vec![Interval::UNKNOWN; points.len()];
        self.tape.over(&points, &mut values).map_err(leaf_failure)?;
        // Corners with opposite signs, both proved: somewhere in the box is a point of the surface,
        // however F behaves.
        let changes = |values: &[Interval]| {
            let sure = |sign: fn(&Interval) -> bool| values.iter().any(|v| v.is_defined() && sign(v));
            sure(|v| v.hi() < 0.0) && sure(|v| v.lo() >= 0.0)
        };
        let crossed = far.iter().zip(values.chunks_exact(8)).filter(|(_, values)| changes(values));
        let sure = crossed.map(|((_, k), _)| from_field::at_least(&open[*k].bounds, target));
        Ok(sure.fold(0.0, greater))
    }

    /// The batches of a round, with pruned tapes if that pays.
    fn tasks(&self, open: Vec<OpenBox>) -> Result<Vec<BoxBatch>, JobError> {
        if self.tape.has_leaves() {
            let tape = Arc::new(self.tape.clone());
            return Ok(open
                .chunks(LEAF_CHUNK / 64)
                .map(|boxes| BoxBatch { tape: Arc::clone(&tape), boxes: boxes.to_vec() })
                .collect());
        }
        // Neighbours in the list are neighbours in space, so a tape for a few of them is nearly as short as
        // one for each.
        let groups: Vec<&[OpenBox]> =
            open.chunk_by(|a, b| Arc::ptr_eq(&a.tape, &b.tape)).flat_map(|run| run.chunks(8)).collect();
        let tasks = par_map(self.job, &groups, |_, group| -> Result<BoxBatch, LeafError> {
            let domain =
                group.iter().fold(Box3::EMPTY, |all, b| all.union(from_field::tape_domain(&b.bounds)));
            let tape = &group[0].tape;
            let short = if tape.len() < 16 { None } else { tape.prune(&domain)?.1 };
            Ok(BoxBatch { tape: short.map_or_else(|| Arc::clone(tape), Arc::new), boxes: group.to_vec() })
        });
        tasks.into_iter().collect::<Result<_, _>>().map_err(leaf_failure)
    }
}

impl BackwardDistance {
    fn settle(&mut self, most: f64, bounds: &Box3) {
        if most > self.most {
            (self.most, self.at) = (most, bounds.centre());
        }
    }
}

/// Boxes to be split into 64 and classified with one tape.
struct BoxBatch {
    tape: Arc<Tape>,
    boxes: Vec<OpenBox>,
}

#[derive(Default)]
struct BoxBatchResult {
    /// The farthest of the settled boxes.
    settled: Option<(f64, Box3)>,
    open: Vec<OpenBox>,
    n_boxes: usize,
}

impl BoxBatch {
    fn run(&self, target: &TargetMesh) -> Result<BoxBatchResult, LeafError> {
        let parts: Vec<Box3> = self.boxes.iter().flat_map(|b| sub_boxes(&b.bounds)).collect();
        let crossed = may_cross(&self.tape, &parts)?;
        let crossed_idx: Vec<usize> = (0..parts.len()).filter(|k| crossed[*k]).collect();
        let boxes: Vec<Box3> = crossed_idx.iter().map(|k| parts[*k]).collect();
        let verdicts = from_field::bound_boxes(&self.tape, &boxes, target)?;
        let mut result = BoxBatchResult { n_boxes: parts.len(), ..BoxBatchResult::default() };
        for ((k, bounds), verdict) in crossed_idx.iter().zip(boxes).zip(verdicts) {
            // Each box has 64 parts, and they are in the order of the boxes.
            let parent = &self.boxes[k / 64];
            let most = match verdict {
                BoxVerdict::Nothing => continue,
                // A bound for a box holds for its parts.
                BoxVerdict::Near(far) | BoxVerdict::Open(far) => lesser(far, parent.most),
            };
            if most > target.tolerance {
                let tape = Arc::clone(&self.tape);
                result.open.push(OpenBox { tape, bounds, most, cuts: parent.cuts + 1 });
            } else if result.settled.is_none_or(|(far, _)| most > far) {
                result.settled = Some((most, bounds));
            }
        }
        Ok(result)
    }
}

/// The upper bound above which boxes are split in a round.
fn round_threshold(open: &[OpenBox], enough: f64) -> f64 {
    let most = open.iter().map(|b| b.most).filter(|most| *most < f64::INFINITY).fold(enough, greater);
    enough + UPPER_PART * (most - enough)
}

fn corners_of(bounds: &Box3) -> [[f64; 3]; 8] {
    std::array::from_fn(|n| {
        std::array::from_fn(|k| if n >> k & 1 == 0 { bounds.min[k] } else { bounds.max[k] })
    })
}
