//! Searches for the size of squares at which the polylines are within the budget.
use super::prove::{count_segments, estimate, prove};
use super::straight_runs::without_straight_runs;
use super::trace::{ContourLattice, TracedContours, trace};
use crate::budget::{Bound, Bounded, Evidence, Failure, Job, Progress, Reference, RefusalCode};
use crate::explicit::Polyline;
use crate::implicit::{Field, Tape};
use crate::math::{Box3, greater};

/// The limits that the polylines have to keep.
#[derive(Clone, Copy, Debug)]
pub(in crate::convert) struct ContourGoal {
    pub length: Option<f64>,
    pub segments: Option<u64>,
    /// Whether a measured result is accepted if no bound can be proved.
    pub measured: bool,
}

type ContourPolylines = Vec<Polyline<2>>;

/// Squares along the longest side: at first, and at most if none is crossed.
const FIRST: f64 = 64.0;
const MOST_EMPTY: f64 = 2048.0;
/// The most lattices.
const TRIALS: usize = 16;
/// The search ends after `STUCK` lattices whose bound is above this fraction of the last one, once there are
/// `STUCK_SEGMENTS`. With fewer segments, smaller squares cost little and may catch details between corners.
const STUCK_SHARE: f64 = 0.8;
const STUCK: usize = 2;
const STUCK_SEGMENTS: u64 = 1 << 14;
/// The most segments: each takes a few hundred bytes.
const MOST: u64 = 1 << 24;

/// Finds lines within the limits, or the best.
pub(in crate::convert) fn search(
    field: &Field,
    goal: &ContourGoal,
    job: &Job,
) -> Result<Bounded<ContourPolylines>, Failure<ContourPolylines>> {
    let tape = Tape::new(field.sign());
    let bounds = field.bounds();
    let sides = [0, 1].map(|k| bounds.max[k] - bounds.min[k]);
    let longest = greater(sides[0], sides[1]);
    let search = ContourSearch { tape, evidence: field.evidence(), bounds, goal, job };
    let mut step = longest / FIRST;
    let mut best: Option<Bounded<ContourPolylines>> = None;
    // With a count alone, lines are as fine as it allows, and their bound is computed afterwards.
    let Some(length) = goal.length else { return search.by_count(step) };
    let (mut stuck, mut last) = (0, f64::INFINITY);
    for round in 0..TRIALS {
        job.report(Progress { stage: "contours", done: round as u64, total: TRIALS as u64 });
        let traced = match search.trace_at_step(step, length) {
            // A refusal does not discard an earlier result.
            Err(Failure::Refused(_)) if best.is_some() => break,
            traced => traced?,
        };
        if traced.points.is_empty() {
            step *= 0.5;
            if longest / step > MOST_EMPTY {
                return Err(search.no_curve());
            }
            continue;
        }
        let estimated = estimate(&traced, job).map_err(leaf_failure)?;
        if estimated > 0.9 * length {
            // Distances fall with the square of the step.
            let part = (0.7 * length / estimated).sqrt();
            step *= greater(0.25, part);
            continue;
        }
        if !search.evidence.bounds_above() {
            let lines = search.polylines(&traced, None, estimated);
            return if goal.measured {
                search.check_segments(lines)
            } else {
                Err(Failure::Unmet(Box::new(lines)))
            };
        }
        let distance = prove(&traced, &bounds, length, job).map_err(leaf_failure)?;
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        let lines = search.polylines(&traced, Some(distance.most), distance.least);
        if distance.most <= length {
            // The length that the proof leaves is used to merge segments.
            let lines = without_straight_runs(lines, length);
            return search.check_segments(with_place(lines, distance.at));
        }
        if best.as_ref().and_then(|best| best.bound.at_most()).is_none_or(|most| distance.most < most) {
            best = Some(with_place(lines, distance.at));
        }
        // Stops if smaller squares do not help.
        stuck += usize::from(distance.most > STUCK_SHARE * last);
        last = distance.most;
        if count_segments(&traced) > MOST / 4 || stuck >= STUCK && count_segments(&traced) > STUCK_SEGMENTS {
            break;
        }
        step *= 0.6;
    }
    match best {
        Some(best) => Err(Failure::Unmet(Box::new(best))),
        None => {
            Err(Failure::refused(RefusalCode::Budget, "the budget needs squares too small to be told apart"))
        }
    }
}

fn with_place(mut lines: Bounded<ContourPolylines>, at: [f64; 2]) -> Bounded<ContourPolylines> {
    lines.bound.at = Some([at[0], at[1], 0.0]);
    lines
}

fn leaf_failure(error: crate::implicit::LeafError) -> Failure<ContourPolylines> {
    Failure::refused(RefusalCode::LeafFailed, error.message)
}

struct ContourSearch<'a> {
    tape: Tape,
    evidence: Evidence,
    bounds: Box3,
    goal: &'a ContourGoal,
    job: &'a Job,
}

impl ContourSearch<'_> {
    fn trace_at_step(&self, step: f64, pad: f64) -> Result<TracedContours, Failure<ContourPolylines>> {
        let Some(lattice) = ContourLattice::covering(&self.bounds, step) else {
            let message = format!(
                "the budget needs squares of {step:e}, which are too many for the region or too \
                     small for its coordinates"
            );
            return Err(Failure::refused(RefusalCode::Budget, message));
        };
        let traced =
            trace(&self.tape, lattice, pad, self.job).map_err(leaf_failure)?.ok_or(Failure::Cancelled)?;
        let n = count_segments(&traced);
        if n > MOST || 256 * n > self.job.memory_limit {
            return Err(Failure::refused(
                RefusalCode::TooMuchMemory,
                format!("the curve has {n} segments, which is too many"),
            ));
        }
        Ok(traced)
    }

    fn no_curve(&self) -> Failure<ContourPolylines> {
        let [low, high] = [self.bounds.min, self.bounds.max];
        Failure::refused(
            RefusalCode::Empty,
            format!(
                "there is no curve: the field is nowhere negative on {MOST_EMPTY} points along the longest side of the \
                 region from {:?} to {:?}",
                [low[0], low[1]],
                [high[0], high[1]]
            ),
        )
    }

    fn polylines(&self, traced: &TracedContours, most: Option<f64>, least: f64) -> Bounded<ContourPolylines> {
        let line = |line: &Vec<u32>| Polyline {
            points: line.iter().map(|row| traced.points[*row as usize]).collect(),
            places: Vec::new(),
            closed: true,
        };
        let most = most.filter(|most| *most < f64::INFINITY);
        let evidence = match most {
            Some(_) => self.evidence.clone(),
            None => Evidence::Measured { samples: count_segments(traced) },
        };
        let least = if most.is_some_and(|most| least > most) { 0.0 } else { least };
        let bound = Bound::with_evidence(least, most, evidence, Reference::Field);
        Bounded { shape: traced.lines.iter().map(line).collect(), bound }
    }

    fn check_segments(
        &self,
        lines: Bounded<ContourPolylines>,
    ) -> Result<Bounded<ContourPolylines>, Failure<ContourPolylines>> {
        let n: u64 = lines.shape.iter().map(|line| line.n_segments() as u64).sum();
        let fits = self.goal.segments.is_none_or(|most| n <= most);
        lines.met_if(fits)
    }

    /// The lines of the finest lattice found with no more segments than the goal allows.
    fn by_count(&self, first: f64) -> Result<Bounded<ContourPolylines>, Failure<ContourPolylines>> {
        let most = self.goal.segments.unwrap_or(0);
        let mut step = first;
        let mut fits: Option<f64> = None;
        // Coarser until there are few enough segments, then finer as long as the number allows.
        for _ in 0..TRIALS {
            let n = count_segments(&self.trace_at_step(step, step)?);
            if n > most {
                if fits.is_some() {
                    break;
                }
                step *= 1.5;
            } else {
                if n > 0 {
                    fits = Some(step);
                }
                step *= 0.7;
            }
        }
        let Some(step) = fits else {
            let message = format!("{most} segments are too few: no lattice that shows the curve has so few");
            return Err(Failure::refused(RefusalCode::Budget, message));
        };
        // The least aim that is proved, from a quarter of a step on.
        let mut aim = 0.25 * step;
        loop {
            let traced = self.trace_at_step(step, aim)?;
            let estimated = estimate(&traced, self.job).map_err(leaf_failure)?;
            if !self.evidence.bounds_above() {
                return Ok(self.polylines(&traced, None, estimated));
            }
            let distance = prove(&traced, &self.bounds, aim, self.job).map_err(leaf_failure)?;
            if self.job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            if distance.most <= aim || aim > 4.0 * step || !distance.has_inside {
                let lines =
                    with_place(self.polylines(&traced, Some(distance.most), distance.least), distance.at);
                let is_accepted = distance.has_inside || self.goal.measured;
                return if is_accepted {
                    self.check_segments(lines)
                } else {
                    Err(Failure::Unmet(Box::new(lines)))
                };
            }
            aim *= 2.0;
        }
    }
}
