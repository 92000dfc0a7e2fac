//! `simplify_to_count`: a mesh with so many triangles at most.
use super::error_monitor::CheckLevel;
use super::local_tolerance::LocalTolerance;
use super::reduction::{AttemptStart, FailedAttempt, MEAN_DISTANCE_ROUNDING, MeshReduction};
use super::simplify::{CLOSE, ROUNDINGS, SHARE, SimplifiedMesh, SimplifyFailure, bounded, unchanged};
use super::zero_area::ZeroAreaFaces;
use crate::budget::{Bounded, ErrorLimit, Failure, Job, JobError, RefusalCode, Tolerance};
use crate::check::{Goal, MappedPair, NearFaces};
use crate::explicit::{Mesh, Topology};
use crate::math::{greater, lesser};

/// How much work a triangle count is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// The error is about the least length that leaves so many triangles.
    #[default]
    Best,
    /// Each step is the one of least cost, and only the result is looked at: mostly about a tenth of the time and two to
    /// three times the error.
    Fast,
}

/// The first length, as a fraction of the largest mean distance from planes to which steps of least cost lead. Measured on
/// eight shapes: 0.8 to 2.1 times that distance are needed in the end.
const FIRST: f64 = 0.7;
/// The least first length, as a fraction of the diagonal: what is flat stays so within it, and a proof does not have to look
/// into its own roundings. Chosen.
const FLAT: f64 = 1e-10;
/// What is within this fraction of the diagonal is not told from less. Chosen.
const TINY: f64 = 10.0 * FLAT;
/// How much shorter the first length becomes where it is too long.
const SHORTER: f64 = 0.25;
/// The part of a step, on a logarithmic scale, that is taken of what the one before tells, and the least and the largest
/// factor; below what mean distances tell from roundings the largest one is [`LEAP`]. Chosen. The last step says how far the length may be
/// beyond what is needed: one of more than [`LAST`] is taken back.
const STEP: f64 = 0.9;
const STEPS: [f64; 2] = [1.03, 1.5];
const LAST: f64 = 1.04;
const LEAP: f64 = 10.0;
/// From this multiple of the count on a step is not stopped at it. Chosen.
const MET_FROM: f64 = 1.25;
/// The powers by which triangles and lengths may go together. Chosen; on smooth surfaces it is 1.
const POWERS: [f64; 2] = [0.15, 4.0];
/// Collapses without a monitor may cost this fraction of the first length, and stop at this multiple of the count. Measured:
/// with more, too many have to be done again.
const SLIGHT: f64 = 0.4;
const MANY: f64 = 2.5;
/// How often places are done again that are farther off than the length. Chosen.
const MENDED: u32 = 6;

/// The same surface with at most so many triangles, as [`simplify`](super::simplify()) makes it for a count alone, which is
/// with [`Effort::Best`].
///
/// *What is returned.* With [`Effort::Best`] a length rises until no more than `most` triangles are left within it, and every
/// step is checked against it: the error is about the one of `simplify` for a length that leaves as many. With
/// [`Effort::Fast`] each collapse is the one of least cost. Both are proved in the same way, for all points of both surfaces.
/// No separate component is removed.
///
/// *Inputs.* n × 3 positions, m × 3 indices; `topology` says which rows are one position.
///
/// *Cost.* [`Effort::Fast`]: 1.4 µs a triangle on one core, a half of it for the bound, up to 10 µs where faces are needles;
/// more where less than half of the triangles go; 300 bytes a triangle. [`Effort::Best`]: 8 to 30 µs, up to 70 µs where noise is
/// as large as the length; 800 to 1,200 bytes.
///
/// # Errors
/// [`Failure::Unmet`] with the best result where the count cannot be reached; [`RefusalCode::Empty`] without a triangle; the
/// refusals of [`check::deviation`](crate::check::deviation).
///
/// ```
/// use chordal::lod::count::{Effort, simplify_to_count};
/// use chordal::{Job, Mesh, explicit::Topology};
/// // A wave of 800 triangles.
/// let row = |i: u32| (0..21).map(move |j| [f64::from(i), f64::from(j), f64::from(i % 10) * 0.3]);
/// let positions = (0..21).flat_map(row).collect();
/// let cell = |i: u32| (0..20).flat_map(move |j| { let a = 21 * i + j; [[a, a + 21, a + 22], [a, a + 22, a + 1]] });
/// let mesh = Mesh::new(positions, (0..20).flat_map(cell).collect())?;
/// let made = |effort| simplify_to_count(&mesh, 40, effort, Topology::Indices, &Job::default()).expect("reachable");
/// let (best, fast) = (made(Effort::Best), made(Effort::Fast));
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
    let made = match ZeroAreaFaces::set_aside(mesh, topology).filter(|_| mesh.faces().len() > count) {
        Some(faces) => beside_zero_areas(&faces, (count, effort), topology, job)?,
        None => faces_to_count(mesh, (count, effort), topology, job)?,
    };
    if made.shape.mesh.faces().len() as u64 > most {
        return Err(Failure::Unmet(Box::new(made)));
    }
    Ok(made)
}

/// A count of faces, those without area among them: these are put back where they are farther than the rest is off, unless
/// they would be most of what is left.
fn beside_zero_areas(
    faces: &ZeroAreaFaces<'_>,
    (count, effort): (usize, Effort),
    topology: Topology,
    job: &Job,
) -> Result<Bounded<SimplifiedMesh>, JobError> {
    let tiny = ROUNDINGS * faces.rest.bounds().diagonal();
    let mut left = count;
    // A second time with room for those that are put back.
    for is_last in [false, true] {
        let made = faces_to_count(&faces.rest, (left, effort), topology, job)?;
        let length = greater(made.bound.at_most().unwrap_or(0.0), tiny);
        let whole = faces.restore(made.clone(), Some(&ErrorLimit::uniform(length)), job)?;
        let n_back = whole.shape.stats.kept_degenerate_faces as usize;
        if whole.shape.mesh.faces().len() <= count || (is_last && n_back <= count / 2) {
            return Ok(whole);
        }
        if n_back > count / 2 {
            return faces.restore(made, None, job);
        }
        left = count - n_back;
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
        _ => target.by_cost(start).map(|made| made.0),
    }
}

/// A mesh, and how many triangles are to be left of it.
struct CountTarget<'a> {
    mesh: &'a Mesh,
    topology: Topology,
    count: usize,
    /// That of the box around all faces.
    diagonal: f64,
    job: &'a Job,
}

impl<'a> CountTarget<'a> {
    /// Each step being the one of least cost; with the largest mean distance from planes of the original.
    fn by_cost(&self, mut reduction: MeshReduction<'a>) -> Result<(Bounded<SimplifiedMesh>, f64), JobError> {
        reduction.run(self.count, &LocalTolerance::uniform(f64::INFINITY), self.job)?;
        let (made, near) = (reduction.mesh(), reduction.near_faces());
        let (mean, kept) = (reduction.largest_mean_distance(), reduction.stats);
        // Free the memory, since the proof needs as much again.
        drop(reduction);
        let found = self.pair(&made, &near)?.deviation(f64::INFINITY, &self.goal(0.0), self.job)?;
        Ok((bounded(made, &found, f64::INFINITY, kept), mean))
    }

    fn pair<'b>(&'b self, made: &'b Mesh, near: &'b [u32]) -> Result<MappedPair<'b>, JobError> {
        let near = NearFaces { by_row: near, topology: self.topology };
        MappedPair::new(self.mesh, made, (near, 0.0), self.job)
    }

    /// How well the distance is to be known of what is within a length, if one is known.
    fn goal(&self, length: f64) -> Goal {
        let close = greater(CLOSE * length, lesser(length, self.share_of_diagonal(TINY)));
        let close = greater(close, self.share_of_diagonal(ROUNDINGS));
        Goal { absolute: Tolerance::new(close).ok(), ..Goal::default() }
    }

    /// Within a length that rises until few enough triangles are left.
    fn by_length(&self, mut start: MeshReduction<'a>) -> Result<Bounded<SimplifiedMesh>, JobError> {
        let (cheapest, mean) = self.by_cost(start.clone())?;
        let enough = cheapest.bound.at_most().unwrap_or(f64::INFINITY);
        let flat = self.share_of_diagonal(FLAT);
        let is_known = mean > self.share_of_diagonal(MEAN_DISTANCE_ROUNDING);
        let mut length = greater(if is_known { FIRST * mean } else { 0.0 }, flat);
        let is_reached = cheapest.shape.mesh.faces().len() <= self.count;
        if !is_reached || !length.is_finite() || enough <= flat {
            return Ok(cheapest);
        }
        start.start_monitor(self.job)?;
        let (mut begin, mut reduction) = loop {
            let room = start.uniform_tolerance(SHARE * length);
            let few = (MANY * self.count as f64) as usize;
            let begin = AttemptStart::new(start.after_slight((SLIGHT, few), &room, self.job)?);
            let is_shortest = SHORTER * length < flat;
            let mut reduction = begin.from(&start).clone();
            reduction.run(if is_shortest { self.count } else { 0 }, &room, self.job)?;
            if reduction.n_faces() > self.count || is_shortest {
                break (begin, reduction);
            }
            length *= SHORTER;
        };
        let mut mended = 0;
        loop {
            if !self.rise(&mut reduction, &mut length, enough)? {
                return Ok(cheapest);
            }
            let (made, near) = (reduction.mesh(), reduction.near_faces());
            let pair = self.pair(&made, &near)?;
            let places = pair.violations(length, self.job)?;
            if places.is_empty() || mended == MENDED {
                let most = if places.is_empty() { places.at_most } else { f64::INFINITY };
                let found = pair.deviation(most, &self.goal(length), self.job)?;
                let made = bounded(made, &found, most, reduction.stats);
                return Ok(if made.bound.at_most() <= cheapest.bound.at_most() { made } else { cheapest });
            }
            drop(pair);
            let mut tried = FailedAttempt::new(reduction);
            begin.follow(&mut tried, &places);
            let room = start.uniform_tolerance(SHARE * length);
            reduction = begin.from(&start).retry(&mut tried, &places, (&room, mended));
            reduction.raise_check_levels(&tried, &places, CheckLevel::escalate);
            reduction.run_open(self.count, &room, self.job)?;
            mended += 1;
        }
    }

    /// Raises a length until few enough triangles are left within it; `false` where none up to `most` does.
    fn rise(&self, reduction: &mut MeshReduction<'a>, length: &mut f64, most: f64) -> Result<bool, JobError> {
        // As the inverse of the length to begin with, as where a surface is smooth.
        let (mut power, mut largest) = (1.0, STEPS[1]);
        while reduction.n_faces() > self.count {
            let before = reduction.clone();
            let n = before.n_faces() as f64;
            let asked = n / greater(self.count as f64, 1.0);
            let is_tiny = *length < self.share_of_diagonal(MEAN_DISTANCE_ROUNDING);
            let step =
                within(libm::pow(asked, STEP * power), [STEPS[0], if is_tiny { LEAP } else { largest }]);
            // One that is about the last is not to be taken back.
            let step = if step < LAST * LAST { lesser(step, LAST) } else { step };
            let longer = *length * step;
            if longer <= *length || longer > most {
                return Ok(false);
            }
            let room = reduction.uniform_tolerance(SHARE * longer);
            // Far from the count there is none to be met: a step beyond it is taken back.
            let until = if asked > MET_FROM && step > LAST && !is_tiny { 0 } else { self.count };
            reduction.run_on(until, &room, self.job)?;
            let got = reduction.n_faces();
            if got <= self.count && step > LAST && !is_tiny {
                // That was too far, and it is not known by how much.
                *reduction = before;
                (power, largest) = (POWERS[1], step.sqrt());
                continue;
            }
            *length = longer;
            power = within(libm::log(step) / libm::log(n / got as f64), POWERS);
        }
        Ok(true)
    }

    fn share_of_diagonal(&self, share: f64) -> f64 {
        share * self.diagonal
    }
}

/// A number, or the end of a range that is nearest to it; the upper one for no number.
fn within(x: f64, [low, high]: [f64; 2]) -> f64 {
    if x < low {
        low
    } else if x < high {
        x
    } else {
        high
    }
}
