//! Meshes a surface within a budget: a length, pixels, or the best mesh with a given number of triangles.
use super::allowance::{Allowance, TessellationFailure};
use super::mesher::{CertifiedTiles, PatchMesher};
use super::sheet_plan::BYTES_PER_TRIANGLE;
use super::subpatch::PatchSurface;
use crate::budget::{Bounded, Budget, Failure, Job, RefusalCode, Tolerance};
use crate::convert::budget_search::{Approximation, within_budget};
use crate::convert::ladder::LengthLadder;
use crate::explicit::Mesh;

/// The mesh of a surface that meets a budget.
pub(crate) fn mesh_within(
    sheets: &dyn PatchSurface<'_>,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, TessellationFailure> {
    job.run(|| {
        let adjacency = sheets.adjacency();
        let mesher = PatchMesher::new(sheets, &adjacency, job);
        let allowance = Allowance {
            length: budget.length.map(Tolerance::get),
            pixels: budget.pixels.map(|p| (p.pixels, p.view.lens())),
            normal_deviation: budget.angle_deg.map(|angle| 2.0 * libm::sin(0.5 * angle.to_radians())),
            share: 1.0,
            outline: None,
        };
        within_budget(&PatchApproximation { mesher: &mesher, allowance, job }, budget, budget.triangles)
    })
}

/// A surface as triangles: planned first, since a plan tells the number of triangles before any is proved.
struct PatchApproximation<'a, 'm, 's> {
    mesher: &'m PatchMesher<'a, 's>,
    allowance: Allowance,
    job: &'m Job,
}

impl Approximation for PatchApproximation<'_, '_, '_> {
    type Shape = Mesh;

    fn by_error(&self, most: u64) -> Result<Option<Bounded<Mesh>>, TessellationFailure> {
        let planned = self.mesher.plan_within_limits(&self.allowance)?;
        if planned.count(self.mesher) > most {
            return Ok(None);
        }
        let mut proved = self.mesher.prove(planned, &self.allowance)?;
        Ok((proved.count() <= most).then(|| self.mesher.finish(&mut proved, &self.allowance)))
    }

    fn by_count(&self, most: u64) -> Result<Bounded<Mesh>, TessellationFailure> {
        within_count(self.mesher, &self.allowance, most, self.job)
    }

    fn count(mesh: &Mesh) -> u64 {
        mesh.faces().len() as u64
    }
}

/// Lengths per octave in the geometric series of candidate lengths: neighbours differ by 2.2 %. Measured: with 16,
/// there were small meshes whose bound was more than 1.15 times that of another length with as many triangles.
const RUNGS: u32 = 32;
/// Octaves of the series. Derived: 100 octaves extend below the rounding of any shape.
const OCTAVES: u32 = 100;
/// The factor by which a count may exceed that of a finer length. Measured on coarse meshes; the search for the finest
/// length starts beyond it.
const COUNT_NOISE: u64 = 2;
/// Smaller meshes may have bounds well below their candidate length, so all coarser lengths are compared. Chosen: such
/// meshes take little time.
const SMALL: u64 = 2000;

/// The mesh with the smallest bound among the meshes of the series that have at most `most` triangles.
fn within_count(
    mesher: &PatchMesher<'_, '_>,
    allowance: &Allowance,
    most: u64,
    job: &Job,
) -> Result<Bounded<Mesh>, TessellationFailure> {
    let most = most.min(job.triangle_limit).min((job.memory_limit as f64 / BYTES_PER_TRIANGLE) as u64);
    let ladder = LengthLadder { size: mesher.longest_diagonal(), per_octave: RUNGS, octaves: OCTAVES };
    let rung = |k: u32| Allowance::from_length(ladder.length(k));
    let count = |k: u32| -> Result<u64, TessellationFailure> {
        match mesher.plan(&rung(k)) {
            Ok(planned) => Ok(planned.count(mesher)),
            Err(Failure::Refused(refusal)) if refusal.code == RefusalCode::BelowPrecision => Ok(u64::MAX),
            Err(other) => Err(other),
        }
    };
    // Goes finer by quarter octaves until even a noisy count cannot fit, then back one length at a time.
    let mut fine = 0;
    while fine < ladder.n_rungs() && count(fine)? <= COUNT_NOISE.saturating_mul(most) {
        fine += RUNGS / 4;
    }
    let mut k = fine;
    while k > 0 && count(k)? > most {
        k -= 1;
    }
    let mut best: Option<CertifiedTiles<'_>> = None;
    for k in (0..=k).rev() {
        let mut proved = mesher.prove(mesher.plan(&rung(k))?, &rung(k))?;
        let count = proved.count();
        if count <= most && best.as_ref().is_none_or(|best| proved.bound() < best.bound()) {
            best = Some(proved);
        } else if count > most && k == 0 && best.is_none() {
            let best = mesher.finish(&mut proved, allowance);
            return Err(Failure::Unmet(Box::new(best)));
        }
        // The next lengths are so much larger than the best bound that theirs will hardly be less.
        let settled =
            best.as_ref().is_some_and(|best| rung(k).length.is_some_and(|rung| 0.8 * rung > best.bound()));
        if settled && count > SMALL {
            break;
        }
    }
    match best {
        Some(mut best) => Ok(mesher.finish(&mut best, allowance)),
        None => Err(Failure::refused(RefusalCode::Budget, "no mesh of this surface has so few triangles")),
    }
}
