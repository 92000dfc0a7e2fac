//! Meshes a limit surface of triangles within a budget: a length, pixels, or the best mesh with a given
//! number of triangles.
use super::assemble::assemble;
use super::mesher::{CertifiedLeaves, LoopMesher};
use crate::budget::{Bound, Bounded, Budget, Failure, Job, Reference, RefusalCode, Tolerance};
use crate::check;
use crate::convert::budget_search::{Approximation, within_budget};
use crate::convert::ladder::LengthLadder;
use crate::convert::patches::allowance::{Allowance, TessellationFailure};
use crate::explicit::Mesh;
use crate::math::{greater, lesser, sub_down};

/// Peak memory in bytes per triangle, everything included: 500 were measured on a torus at 5e5 triangles.
const BYTES_PER_TRIANGLE: f64 = 700.0;
/// The number of leaves with samples for the lower bound of the distance, two points in each.
const SAMPLED_LEAVES: usize = 12;

/// The mesh that meets a budget.
pub(crate) fn mesh_within(
    mesher: &LoopMesher<'_>,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, TessellationFailure> {
    let allowance = Allowance {
        length: budget.length.map(Tolerance::get),
        pixels: budget.pixels.map(|p| (p.pixels, p.view.lens())),
        normal_deviation: None,
        share: 1.0,
        outline: None,
    };
    within_budget(&LoopApproximation { mesher, allowance, job }, budget, budget.triangles)
}

/// A limit surface as triangles, refined until they keep the error or become too many.
struct LoopApproximation<'a, 'm> {
    mesher: &'m LoopMesher<'a>,
    allowance: Allowance,
    job: &'m Job,
}

impl Approximation for LoopApproximation<'_, '_> {
    type Shape = Mesh;

    fn by_error(&self, requested: u64) -> Result<Option<Bounded<Mesh>>, TessellationFailure> {
        let (triangles, memory) = (self.job.triangle_limit as f64, self.job.memory_limit as f64);
        let needed = self.mesher.estimate(&self.allowance)?;
        if needed > triangles {
            return Err(too_many(needed, triangles));
        }
        if needed * BYTES_PER_TRIANGLE > memory {
            let bytes = needed * BYTES_PER_TRIANGLE;
            let message =
                format!("the budget needs about {bytes:.1e} bytes of memory; the limit is {memory:.1e}");
            return Err(Failure::refused(RefusalCode::TooMuchMemory, message));
        }
        let most = triangle_limit(self.job);
        match self.mesher.refine(&self.allowance, lesser(requested, most))? {
            Some(proved) => Ok(Some(finish(&proved, &self.allowance, self.job))),
            // The limit of the job stopped it, not the requested number.
            None if requested > most => Err(too_many(most as f64 + 1.0, triangles)),
            None => Ok(None),
        }
    }

    fn by_count(&self, most: u64) -> Result<Bounded<Mesh>, TessellationFailure> {
        within_count(self.mesher, &self.allowance, most, self.job)
    }

    fn count(mesh: &Mesh) -> u64 {
        mesh.faces().len() as u64
    }
}

/// The number of triangles that a job allows.
fn triangle_limit(job: &Job) -> u64 {
    job.triangle_limit.min((job.memory_limit as f64 / BYTES_PER_TRIANGLE) as u64)
}

fn too_many(needed: f64, limit: f64) -> TessellationFailure {
    let message = format!("the budget needs more than {needed:.1e} triangles; the limit is {limit:.1e}");
    Failure::refused(RefusalCode::TooManyTriangles, message)
}

/// Lengths per octave in the geometric series of candidate lengths: neighbours differ by 4.4 %.
const RUNGS: u32 = 16;
/// A series of 100 octaves extends below the rounding of any shape.
const OCTAVES: u32 = 100;

/// The finest mesh of the series with at most `most` triangles.
fn within_count(
    mesher: &LoopMesher<'_>,
    asked: &Allowance,
    most: u64,
    job: &Job,
) -> Result<Bounded<Mesh>, TessellationFailure> {
    let most = most.min(triangle_limit(job));
    let ladder = LengthLadder { size: mesher.longest_diagonal(), per_octave: RUNGS, octaves: OCTAVES };
    let rung = |k: u32| Allowance::from_length(ladder.length(k));
    // A length below the rounding does not fit, as one with too many triangles; greater ones may.
    let on = |k: u32| match mesher.refine(&rung(k), most) {
        Err(Failure::Refused(refusal)) if refusal.code == RefusalCode::BelowPrecision => Ok(None),
        other => other,
    };
    let Some(mut best) = on(0)? else {
        // Without a limit: either the refusal that `on` dropped, or the coarsest mesh, which has too many
        // triangles.
        let Some(proved) = mesher.refine(&rung(0), u64::MAX)? else {
            return Err(Failure::refused(
                RefusalCode::Budget,
                "no mesh of this surface has so few triangles",
            ));
        };
        return Err(Failure::Unmet(Box::new(finish(&proved, asked, job))));
    };
    ladder.finest(|k| {
        let Some(proved) = on(k)? else { return Ok(false) };
        if proved.bound() <= best.bound() {
            best = proved;
        }
        Ok::<_, TessellationFailure>(true)
    })?;
    Ok(finish(&best, asked, job))
}

/// The mesh with its bound; pixels at the view of the allowance.
fn finish(proved: &CertifiedLeaves<'_>, allowance: &Allowance, job: &Job) -> Bounded<Mesh> {
    let mesh = assemble(proved, job);
    let most = proved.bound();
    let (least, at) = measure_lower_bound(proved, &mesh);
    let mut bound = Bound::proved(lesser(least, most), most, Reference::LimitSurface);
    bound.at = at;
    bound.pixels = allowance.pixels.and_then(|(_, lens)| {
        proved.leaves.iter().try_fold(0.0, |worst, (_, proof)| {
            let pixels = lens.scale_at(&proof.place).pixels_of(proof.bound)?;
            Some(greater(pixels, worst))
        })
    });
    Bounded { shape: mesh, bound }
}

/// The measured lower bound of the distance and its location: at the middles of the worst triangles and of
/// the sides with the largest bending.
fn measure_lower_bound(proved: &CertifiedLeaves<'_>, mesh: &Mesh) -> (f64, Option<[f64; 3]>) {
    let mut order: Vec<usize> = (0..proved.leaves.len()).collect();
    order.sort_by(|a, b| proved.leaves[*b].1.bound.total_cmp(&proved.leaves[*a].1.bound).then(a.cmp(b)));
    let (mut samples, mut rounding) = (Vec::new(), 0.0);
    for &i in order.iter().take(SAMPLED_LEAVES) {
        let (leaf, proof) = &proved.leaves[i];
        let shape = &proved.cells[leaf.cell as usize].shape;
        rounding = greater(2.0 * shape.rounding_error(), rounding);
        let side = (1..3).fold(0, |worst, k| if proof.sides[k] > proof.sides[worst] { k } else { worst });
        samples.push(shape.point(leaf.middle(side)));
        let third = |k: usize| leaf.places.iter().map(|place| place[k]).sum::<f64>() / 3.0;
        samples.push(shape.point([third(0), third(1)]));
    }
    match check::surface_at_least(&samples, mesh) {
        Some((least, at)) => {
            let least = sub_down(least, rounding);
            (greater(least, 0.0), Some(samples[at]))
        }
        None => (0.0, samples.first().copied()),
    }
}
