//! `simplify_to_count`: a mesh with at most a given number of triangles.
use super::error_monitor::CheckLevel;
use super::local_tolerance::LocalTolerance;
use super::reduction::{AttemptStart, FailedAttempt, MEAN_DISTANCE_ROUNDING, MeshReduction};
use super::simplified_mesh::{CLOSE, ROUNDINGS, SHARE, SimplifiedMesh, SimplifyFailure, bounded, unchanged};
use super::zero_area::ZeroAreaFaces;
use crate::budget::{Bounded, ErrorLimit, Failure, Job, JobError, RefusalCode, Tolerance};
use crate::check::{Goal, MappedPair, NearFaces};
use crate::explicit::{Mesh, Topology};
use crate::math::{greater, lesser};

/// The work spent on a result of a given size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// The error is about the least length that leaves so many triangles.
    #[default]
    Best,
    /// Each collapse is the one of least cost, and only the result is proved: usually about a tenth of the
    /// time and two to three times the error.
    Fast,
}

/// The first length, as a fraction of the largest mean distance from planes after collapses of least cost.
/// Measured on eight shapes: the final length is 0.8 to 2.1 times that distance.
const FIRST: f64 = 0.7;
/// The least first length, as a fraction of the diagonal. Chosen: flat parts stay flat within it, and a proof
/// need not resolve its own rounding.
const FLAT: f64 = 1e-10;
/// Distances within this fraction of the diagonal count as equal. Chosen: ten times the least length.
const TINY: f64 = 10.0 * FLAT;
/// The factor of the first length if that is too long.
const SHORTER: f64 = 0.25;
/// The part of the estimated step, on a logarithmic scale, that is taken, and the least and the largest
/// factor of a step; while mean distances are lost in rounding the largest factor is [`LEAP`]. Chosen:
/// smaller steps take more time. The last step bounds the excess of the length over the needed one, so a last
/// step of more than [`LAST`] is taken back.
const STEP: f64 = 0.9;
const STEPS: [f64; 2] = [1.03, 1.5];
const LAST: f64 = 1.04;
const LEAP: f64 = 10.0;
/// If more than this multiple of the count is left, a step does not stop at the count. Chosen: so that a step
/// that is too long is seen and taken back.
const MET_FROM: f64 = 1.25;
/// The range of the power of the length with which the number of triangles falls. Chosen; on smooth surfaces
/// it is 1.
const POWERS: [f64; 2] = [0.15, 4.0];
/// Collapses without a monitor may cost this fraction of the first length, and stop at this multiple of the
/// count. Measured: with larger fractions too many collapses have to be repeated.
const SLIGHT: f64 = 0.4;
const MANY: f64 = 2.5;
/// How often parts that are farther away than the length are repeated. Chosen: more retries rarely succeed.
const MOST_RETRIES: u32 = 6;

/// The same surface with at most a given number of triangles. [`simplify`](super::simplify()) with a count
/// alone does the same with [`Effort::Best`].
///
/// *What is returned.* With [`Effort::Best`] a length rises until no more than `most` triangles are left
/// within it, and every step is checked against it: the error is about that of `simplify` for a length that
/// leaves as many. With [`Effort::Fast`] each collapse is the one of least cost. Both are proved in the same
/// way, for all points of both surfaces. No separate component is removed.
///
/// *Inputs.* n × 3 positions, m × 3 indices; `topology` says which rows are one position.
///
/// *Cost.* [`Effort::Fast`]: 1.4 µs a triangle on one core, half of it for the bound, up to 10 µs if faces
/// are needles; more if less than half of the triangles are removed; 300 bytes a triangle. [`Effort::Best`]:
/// 8 to 30 µs, up to 70 µs if noise is as large as the length; 800 to 1,200 bytes.
///
/// # Errors
/// [`Failure::Unmet`] with the best result if the count cannot be reached; [`RefusalCode::Empty`] without a
/// triangle; the refusals of [`check::deviation`](crate::check::deviation).
///
/// ```
/// use chordal::lod::count::{Effort, simplify_to_count};
/// use chordal::{Job, Mesh, explicit::Topology};
/// // A wave of 800 triangles.
/// let row = |i: u32| (0..21).map(move |j| [f64::from(i), f64::from(j), f64::from(i % 10) * 0.3]);
/// let positions = (0..21).flat_map(row).collect();
/// let cell = |i: u32| (0..20).flat_map(move |j| { let a = 21 * i + j; [[a, a + 21, a + 22], [a, a + 22, a + 1]] });
/// let mesh = Mesh::new(positions, (0..20).flat_map(cell).collect())?;
/// let simplified = |effort| simplify_to_count(&mesh, 40, effort, Topology::Indices, &Job::default()).expect("reachable");
/// let (best, fast) = (simplified(Effort::Best), simplified(Effort::Fast));
/// assert!(best.shape.mesh.faces().len() <= 40 && fast.shape.mesh.faces().len() <= 40);
/// assert!(best.bound.at_most() <= fast.bound.at_most());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sources: those of [`simplify`](super::simplify()).
pub fn simplify_to_count(
    mesh: &Mesh,
    most: u64,
    effort: Effort,
    topology: Topology,
    job: &Job,
) -> Result<Bounded<SimplifiedMesh>, SimplifyFailure> {
    if mesh.faces().is_empty() {
        return Err(Failure::refused(RefusalCode::Empty, "there is no triangle to simplify"));
    }
    let count = usize::try_from(most).unwrap_or(usize::MAX);
    let simplified = match ZeroAreaFaces::set_aside(mesh, topology).filter(|_| mesh.faces().len() > count) {
        Some(faces) => beside_zero_areas(&faces, (count, effort), topology, job)?,
        None => faces_to_count(mesh, (count, effort), topology, job)?,
    };
    if simplified.shape.mesh.faces().len() as u64 > most {
        return Err(Failure::Unmet(Box::new(simplified)));
    }
    Ok(simplified)
}

/// Reaches a count that includes faces without area: these are put back if they are farther away than the
/// error of the others, unless they would be most of the result.
fn beside_zero_areas(
    faces: &ZeroAreaFaces<'_>,
    (count, effort): (usize, Effort),
    topology: Topology,
    job: &Job,
) -> Result<Bounded<SimplifiedMesh>, JobError> {
    let tiny = ROUNDINGS * faces.rest.bounds().diagonal();
    let mut most_faces = count;
    // The second time there is space in the count for the faces that are put back.
    for is_last in [false, true] {
        let simplified = faces_to_count(&faces.rest, (most_faces, effort), topology, job)?;
        let length = greater(simplified.bound.at_most().unwrap_or(0.0), tiny);
        let restored = faces.restore(simplified.clone(), Some(&ErrorLimit::uniform(length)), job)?;
        let n_back = restored.shape.stats.kept_degenerate_faces as usize;
        if restored.shape.mesh.faces().len() <= count || (is_last && n_back <= count / 2) {
            return Ok(restored);
        }
        if n_back > count / 2 {
            return faces.restore(simplified, None, job);
        }
        most_faces = count - n_back;
    }
    faces.restore(faces_to_count(&faces.rest, (count, effort), topology, job)?, None, job)
}

fn faces_to_count(
    mesh: &Mesh,
    (count, effort): (usize, Effort),
    topology: Topology,
    job: &Job,
) -> Result<Bounded<SimplifiedMesh>, JobError> {
    let start = MeshReduction::new(mesh, topology);
    if start.is_empty() {
        return Ok(unchanged(mesh, start.stats));
    }
    let target = CountTarget { mesh, topology, count, diagonal: start.diagonal(), job };
    let is_whole = start.n_faces() == mesh.faces().len();
    if is_whole && start.n_faces() <= count && target.diagonal.is_finite() {
        return Ok(unchanged(mesh, start.stats));
    }
    match effort {
        Effort::Best if start.n_faces() > count => target.by_length(start),
        _ => target.by_cost(start).map(|result| result.0),
    }
}

/// A mesh, and the number of triangles to which it is reduced.
struct CountTarget<'a> {
    mesh: &'a Mesh,
    topology: Topology,
    count: usize,
    /// The diagonal of the box around all faces.
    diagonal: f64,
    job: &'a Job,
}

impl<'a> CountTarget<'a> {
    /// The result of collapses of least cost, with the largest mean distance from planes of the original.
    fn by_cost(&self, mut reduction: MeshReduction<'a>) -> Result<(Bounded<SimplifiedMesh>, f64), JobError> {
        reduction.run(self.count, &LocalTolerance::uniform(f64::INFINITY), self.job)?;
        let (simplified, near) = (reduction.mesh(), reduction.near_faces());
        let (mean, stats) = (reduction.largest_mean_distance(), reduction.stats);
        // Free the memory, since the proof needs as much again.
        drop(reduction);
        let deviation = self.pair(&simplified, &near)?.deviation(f64::INFINITY, &self.goal(0.0), self.job)?;
        Ok((bounded(simplified, &deviation, f64::INFINITY, stats), mean))
    }

    fn pair<'b>(&'b self, simplified: &'b Mesh, near: &'b [u32]) -> Result<MappedPair<'b>, JobError> {
        let near = NearFaces { by_row: near, topology: self.topology };
        MappedPair::new(self.mesh, simplified, (near, 0.0), self.job)
    }

    /// The goal of a deviation for distances within a length; 0 if none is known.
    fn goal(&self, length: f64) -> Goal {
        let close = greater(CLOSE * length, lesser(length, self.share_of_diagonal(TINY)));
        let close = greater(close, self.share_of_diagonal(ROUNDINGS));
        Goal { absolute: Tolerance::new(close).ok(), ..Goal::default() }
    }

    /// The result within a length that rises until few enough triangles are left.
    fn by_length(&self, mut start: MeshReduction<'a>) -> Result<Bounded<SimplifiedMesh>, JobError> {
        let (cheapest, mean) = self.by_cost(start.clone())?;
        // The error of the cheapest result is a limit: within a longer length there is nothing to gain.
        let enough = cheapest.bound.at_most().unwrap_or(f64::INFINITY);
        let flat = self.share_of_diagonal(FLAT);
        let is_known = mean > self.share_of_diagonal(MEAN_DISTANCE_ROUNDING);
        let mut length = greater(if is_known { FIRST * mean } else { 0.0 }, flat);
        let is_reached = cheapest.shape.mesh.faces().len() <= self.count;
        if !is_reached || !length.is_finite() || enough <= flat {
            return Ok(cheapest);
        }
        start.start_monitor(self.job)?;
        // The first length may leave too few triangles already.
        let (mut begin, mut reduction) = loop {
            let tolerance = start.uniform_tolerance(SHARE * length);
            let few = (MANY * self.count as f64) as usize;
            let begin = AttemptStart::new(start.after_unmonitored((SLIGHT, few), &tolerance, self.job)?);
            let is_shortest = SHORTER * length < flat;
            let mut reduction = begin.state(&start).clone();
            reduction.run(if is_shortest { self.count } else { 0 }, &tolerance, self.job)?;
            if reduction.n_faces() > self.count || is_shortest {
                break (begin, reduction);
            }
            length *= SHORTER;
        };
        let mut n_retries = 0;
        loop {
            if !self.rise(&mut reduction, &mut length, enough)? {
                return Ok(cheapest);
            }
            let (simplified, near) = (reduction.mesh(), reduction.near_faces());
            let pair = self.pair(&simplified, &near)?;
            let report = pair.violations(length, self.job)?;
            if report.is_empty() || n_retries == MOST_RETRIES {
                // If nothing is proved within the length, the deviation alone is the bound.
                let most = if report.is_empty() { report.at_most } else { f64::INFINITY };
                let deviation = pair.deviation(most, &self.goal(length), self.job)?;
                let simplified = bounded(simplified, &deviation, most, reduction.stats);
                return Ok(if simplified.bound.at_most() <= cheapest.bound.at_most() {
                    simplified
                } else {
                    cheapest
                });
            }
            drop(pair);
            let mut failed = FailedAttempt::new(reduction);
            begin.after_failure(&mut failed, &report);
            let tolerance = start.uniform_tolerance(SHARE * length);
            reduction = begin.state(&start).retry(&mut failed, &report, (&tolerance, n_retries));
            reduction.raise_check_levels(&failed, &report, CheckLevel::escalate);
            reduction.run_open(self.count, &tolerance, self.job)?;
            n_retries += 1;
        }
    }

    /// Raises a length until few enough triangles are left within it; `false` if no length up to `most`
    /// suffices.
    fn rise(&self, reduction: &mut MeshReduction<'a>, length: &mut f64, most: f64) -> Result<bool, JobError> {
        // At first the number is assumed to fall with the inverse of the length, as on smooth surfaces.
        let (mut power, mut largest) = (1.0, STEPS[1]);
        while reduction.n_faces() > self.count {
            let before = reduction.clone();
            let n = before.n_faces() as f64;
            let excess = n / greater(self.count as f64, 1.0);
            let is_tiny = *length < self.share_of_diagonal(MEAN_DISTANCE_ROUNDING);
            let step =
                within(libm::pow(excess, STEP * power), [STEPS[0], if is_tiny { LEAP } else { largest }]);
            // If the step is about the last one, it is shortened so that it need not be taken back.
            let step = if step < LAST * LAST { lesser(step, LAST) } else { step };
            let longer = *length * step;
            if longer <= *length || longer > most {
                return Ok(false);
            }
            let tolerance = reduction.uniform_tolerance(SHARE * longer);
            // Far from the count a step does not stop at it, so that a step that goes too far is seen and
            // taken back.
            let until = if excess > MET_FROM && step > LAST && !is_tiny { 0 } else { self.count };
            reduction.run_on(until, &tolerance, self.job)?;
            let n_left = reduction.n_faces();
            if n_left <= self.count && step > LAST && !is_tiny {
                // The step went too far, by an unknown factor.
                *reduction = before;
                (power, largest) = (POWERS[1], step.sqrt());
                continue;
            }
            *length = longer;
            // The power with which the number fell in this step.
            power = within(libm::log(step) / libm::log(n / n_left as f64), POWERS);
        }
        Ok(true)
    }

    fn share_of_diagonal(&self, share: f64) -> f64 {
        share * self.diagonal
    }
}

/// A number, or the nearest end of a range; the upper end for NaN.
fn within(x: f64, [low, high]: [f64; 2]) -> f64 {
    if x < low {
        low
    } else if x < high {
        x
    } else {
        high
    }
}
