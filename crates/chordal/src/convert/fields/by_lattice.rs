//! Fields whose slopes are not known, on a lattice: the size of cells that a budget needs is tried on coarse meshes, predicted from their
//! errors, and decided by the proof.
use super::ask::Ask;
use super::lattice::Lattice;
use super::mesher::Wanted;
use super::polygonize::{Halt, polygonize};
use super::refine::refine;
use super::sharpen::sharpen;
use crate::budget::{Bound, Bounded, Code, Failure, Job, Progress, Tolerance};
use crate::check::{FieldDeviation, Goal, field_deviation};
use crate::explicit::Mesh;
use crate::implicit::{Field, Slope, Tape};
use crate::math::{Box3, length};

/// Cells along the longest side of the field's box in the first trial.
const FIRST: f64 = 40.0;
/// Cells along the longest side that are not gone below.
const COARSEST: f64 = 6.0;
/// Cells of features that are not to be lost at first, along the longest side, where there is a surface at all.
const MOST_EMPTY: f64 = 640.0;
/// The share of the budget that is aimed at: predictions are off by some.
const AIM: f64 = 0.8;
/// A trial whose error is below this share of what is aimed at is finer than need be.
const FINE: f64 = 0.6;
/// The share of triangles that cells are to be small enough for; the others are divided.
const TYPICAL: f64 = 0.7;
/// Where a proof fails the step becomes this share of itself,
const FINER: f64 = 0.6;
/// and what is aimed at this.
const LESS: f64 = 0.9;
/// Meshes tried and proved at most.
const TRIALS: usize = 8;

/// About 36 bytes a triangle for the mesh, and 90 for the tree that the proof looks things up in, with room.
const BYTES_A_TRIANGLE: u64 = 200;
/// The step shrinks to this share of itself at least where it has to shrink.
const SLOWEST: f64 = 0.9;
/// So many finer trials in a row without a smaller error are enough.
const STUCK: u32 = 3;

/// Meshes with places that no proof settles, after which no other is tried.
const HOPELESS: usize = 2;

type Outcome = Result<Bounded<Mesh>, Failure<Mesh>>;

/// A mesh within what is wanted, or the best.
pub(super) fn search_lattice(field: &Field, wanted: &Wanted, job: &Job) -> Outcome {
    LatticeSearch { field, tape: Tape::of(field.sign()), bounds: field.bounds(), wanted, job }.run()
}

struct LatticeSearch<'a> {
    field: &'a Field,
    tape: Tape,
    bounds: Box3,
    wanted: &'a Wanted,
    job: &'a Job,
}

/// A mesh with the size of its cells, and how far most of its triangles seem to be.
struct Trial {
    mesh: Mesh,
    step: f64,
    error: f64,
}

impl LatticeSearch<'_> {
    fn run(&self) -> Outcome {
        let first = self.first()?;
        match (self.wanted.length, self.wanted.triangles) {
            (None, Some(most)) => self.by_count(first, most),
            (Some(length), most) => self.by_length(first, length, most),
            (None, None) => Err(Failure::refused(Code::Budget, "the budget has no length and no count")),
        }
    }

    fn longest(&self) -> f64 {
        (0..3).map(|k| self.bounds.max[k] - self.bounds.min[k]).fold(0.0, |a, b| if b > a { b } else { a })
    }

    /// The first mesh that is not empty.
    fn first(&self) -> Result<Trial, Failure<Mesh>> {
        let mut cells = FIRST;
        loop {
            let trial = self.trial(self.longest() / cells)?;
            if !trial.mesh.faces().is_empty() {
                return Ok(trial);
            }
            cells *= 2.0;
            if cells > MOST_EMPTY {
                return Err(self.nothing(cells / 2.0));
            }
        }
    }

    /// Why there is no surface.
    fn nothing(&self, cells: f64) -> Failure<Mesh> {
        let [low, high] = [self.bounds.min, self.bounds.max];
        Failure::refused(
            Code::Empty,
            format!(
                "there is no surface to mesh: the field is nowhere negative on {cells} points along the longest side of \
                 the box from {low:?} to {high:?}"
            ),
        )
    }

    fn trial(&self, step: f64) -> Result<Trial, Failure<Mesh>> {
        let Some(lattice) = Lattice::over(&self.bounds, step) else {
            return Err(Failure::refused(
                Code::TooManyTriangles,
                format!(
                    "cells of {step:e} are too many to count in the box of the field, or too small for its coordinates"
                ),
            ));
        };
        let made = polygonize(&self.tape, &lattice, self.job)
            .and_then(|made| Ok(sharpen(&self.tape, made, lattice.step, self.job)?));
        let mesh = made.map_err(|halt| match halt {
            Halt::Cancelled => Failure::Cancelled,
            Halt::Leaf(error) => Failure::refused(Code::LeafFailed, error.message),
            Halt::TooMany => {
                Failure::refused(Code::TooManyTriangles, "the mesh would have more than 2^32 vertices")
            }
        })?;
        let error = self.error(&mesh)?;
        Ok(Trial { mesh, step, error })
    }

    /// How far most triangles seem to be from the surface: |F| / |∇F| at the middles of them and of their edges, at the
    /// share [`TYPICAL`] of all.
    fn error(&self, mesh: &Mesh) -> Result<f64, Failure<Mesh>> {
        // A sample of some thousand triangles tells as much as all.
        let stride = (mesh.faces().len() / 20_000).max(1);
        let faces: Vec<usize> = (0..mesh.faces().len()).step_by(stride).collect();
        let points: Vec<[f64; 3]> = faces
            .iter()
            .flat_map(|face| {
                let [a, b, c] = mesh.corners(*face);
                [
                    std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0),
                    std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k]),
                    std::array::from_fn(|k| 0.5 * b[k] + 0.5 * c[k]),
                    std::array::from_fn(|k| 0.5 * c[k] + 0.5 * a[k]),
                ]
            })
            .collect();
        let slopes = Ask { tape: &self.tape, job: self.job }
            .slopes(&points)
            .map_err(|error| Failure::refused(Code::LeafFailed, error.message))?;
        let far = |slope: &Slope<f64>| {
            let far = slope.value.abs() / length(slope.gradient);
            if far.is_finite() { far } else { 0.0 }
        };
        let mut errors: Vec<f64> = slopes
            .chunks_exact(4)
            .map(|of| of.iter().map(far).fold(0.0, |a, b| if b > a { b } else { a }))
            .collect();
        errors.sort_by(f64::total_cmp);
        Ok(errors.get((TYPICAL * errors.len() as f64) as usize).copied().unwrap_or(0.0))
    }

    fn by_length(&self, first: Trial, length: Tolerance, most: Option<u64>) -> Outcome {
        let mut aim = AIM * length.get();
        let mut base = self.base(first, aim)?;
        let goal = Goal { max: Some(length), ..Goal::default() };
        let mut best: Option<Bounded<Mesh>> = None;
        let mut unresolved = 0;
        for round in 0..TRIALS {
            self.job.report(Progress { stage: "prove", done: round as u64, total: TRIALS as u64 });
            let mesh = self.refined(&mut base, aim)?;
            let found = self.proved(&mesh, &goal)?;
            let bound = found.bound.clone();
            let within = bound.at_most().is_some_and(|far| far <= length.get());
            let settled = within || self.is_measured(&found);
            let made = Bounded { shape: mesh, bound };
            if settled {
                return self.counted(made, most);
            }
            best = Some(made);
            // Places that no proof settles are not settled by smaller cells either.
            unresolved += usize::from(found.unresolved > 0);
            if unresolved == HOPELESS {
                break;
            }
            // Something fell between the points of the lattice, or was bent too much to divide.
            let step = FINER * base.step;
            if self.affordable(&base, step).is_err() {
                break;
            }
            base = self.trial(step)?;
            aim *= LESS;
        }
        match best {
            Some(best) => Err(Failure::Unmet(Box::new(best))),
            None => Err(Failure::refused(Code::Budget, "no mesh was made")),
        }
    }

    /// A mesh most of whose triangles are within the aim, without many more than that takes.
    fn base(&self, first: Trial, aim: f64) -> Result<Trial, Failure<Mesh>> {
        let coarsest = self.longest() / COARSEST;
        let mut trial = first;
        // Much finer than asked for: coarser, as long as the surface keeps its holes and parts.
        while trial.error < FINE * aim && trial.step < coarsest {
            let factor = if trial.error > 0.0 { (aim / trial.error).sqrt() } else { 2.0 };
            let step = trial.step * if factor > 2.0 { 2.0 } else { factor };
            let next = self.trial(if step > coarsest { coarsest } else { step })?;
            if next.mesh.faces().is_empty() || euler(&next.mesh) != euler(&trial.mesh) {
                break;
            }
            trial = next;
        }
        // Where the field jumps the error stays whatever the step; the proof has the last word on that.
        let (mut stuck, mut power) = (0, 2.0);
        while trial.error > aim && stuck < STUCK {
            let factor = shrink(aim / trial.error, power);
            let step = trial.step * if factor > SLOWEST { SLOWEST } else { factor };
            self.affordable(&trial, step)?;
            let next = self.trial(step)?;
            stuck = if next.error > SLOWEST * trial.error { stuck + 1 } else { 0 };
            power = fitted(&trial, &next);
            trial = next;
        }
        Ok(trial)
    }

    /// The base with its worse triangles divided; on smaller cells where that does not help.
    fn refined(&self, base: &mut Trial, aim: f64) -> Result<Mesh, Failure<Mesh>> {
        loop {
            let found = refine(&self.tape, &base.mesh, aim, self.job)
                .map_err(|error| Failure::refused(Code::LeafFailed, error.message))?;
            if self.job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            if let Some(mesh) = found {
                return Ok(mesh);
            }
            let step = FINER * base.step;
            self.affordable(base, step)?;
            *base = self.trial(step)?;
        }
    }

    /// Whether there is nothing to prove with, and nobody asks for a proof.
    fn is_measured(&self, found: &FieldDeviation) -> bool {
        self.wanted.measured && found.bound.at_most().is_none() && !self.tape.evidence().bounds_above()
    }

    fn proved(&self, mesh: &Mesh, goal: &Goal) -> Result<FieldDeviation, Failure<Mesh>> {
        Ok(field_deviation(mesh, self.field, goal, self.job)?)
    }

    fn counted(&self, made: Bounded<Mesh>, most: Option<u64>) -> Outcome {
        if most.is_none_or(|most| made.shape.faces().len() as u64 <= most) {
            Ok(made)
        } else {
            Err(Failure::Unmet(Box::new(made)))
        }
    }

    /// Triangles grow with the square of the number of cells along a side.
    fn affordable(&self, trial: &Trial, step: f64) -> Result<(), Failure<Mesh>> {
        let ratio = trial.step / step;
        let needs = trial.mesh.faces().len() as f64 * ratio * ratio;
        let limit = self.job.triangle_limit as f64;
        let bytes = BYTES_A_TRIANGLE as f64 * needs;
        if needs > limit {
            let message = format!("the budget needs about {needs:.1e} triangles; the limit is {limit:.1e}");
            return Err(Failure::refused(Code::TooManyTriangles, message));
        }
        if bytes > self.job.memory_limit as f64 {
            let message = format!(
                "the budget needs about {needs:.1e} triangles and {bytes:.1e} bytes; the limit is {:.1e}",
                self.job.memory_limit as f64
            );
            return Err(Failure::refused(Code::TooMuchMemory, message));
        }
        Ok(())
    }

    /// The finest lattice found whose triangles are no more than that.
    fn by_count(&self, first: Trial, most: u64) -> Outcome {
        // More than the job holds are not looked for.
        let bytes = self.job.memory_limit / BYTES_A_TRIANGLE;
        let most = most.min(self.job.triangle_limit).min(bytes);
        let mut fits: Option<Trial> = None;
        let mut trial = first;
        for _ in 0..TRIALS {
            let count = trial.mesh.faces().len() as f64;
            let ratio = (count / most as f64).sqrt();
            let good = count <= most as f64;
            let step = trial.step * ratio * if good { 1.005 } else { 1.02 };
            if good {
                let better = fits.as_ref().is_none_or(|fits| trial.step < fits.step);
                if better {
                    fits = Some(trial);
                }
                if ratio > 0.97 {
                    break;
                }
            }
            trial = self.trial(step)?;
            if trial.mesh.faces().is_empty() {
                break;
            }
        }
        let Some(best) = fits else {
            let message =
                format!("{most} triangles are too few: the coarsest lattice that shows the shape has more");
            return Err(Failure::refused(Code::Budget, message));
        };
        let found = self.proved(&best.mesh, &Goal::default())?;
        let bound: Bound = found.bound;
        let made = Bounded { shape: best.mesh, bound };
        if made.bound.at_most().is_some() || self.wanted.measured {
            Ok(made)
        } else {
            Err(Failure::Unmet(Box::new(made)))
        }
    }
}

/// Vertices less edges plus triangles of a closed mesh: its parts and holes.
fn euler(mesh: &Mesh) -> i64 {
    mesh.positions().len() as i64 - mesh.faces().len() as i64 / 2
}

/// By how much the step shrinks so that an error that falls with its `power` shrinks by `ratio`.
fn shrink(ratio: f64, power: f64) -> f64 {
    let factor = libm::pow(ratio, 1.0 / power);
    // From far away a prediction is worth little.
    if factor < 0.1 { 0.1 } else { factor }
}

/// The power of the step that the errors of two trials follow, between 1 and 2.
fn fitted(coarse: &Trial, fine: &Trial) -> f64 {
    let power = libm::log(coarse.error / fine.error) / libm::log(coarse.step / fine.step);
    if power > 1.0 && power < 2.0 {
        power
    } else if power >= 2.0 {
        2.0
    } else {
        1.0
    }
}
