//! The deviation of a closed mesh by the sandwich prover: the upper bound comes from the sandwich, the lower
//! bounds from points.
use super::probe::{ProbeSharpness, probe_distances};
use super::prover::{SandwichProver, SandwichVerdict};
use super::sandwich::SandwichGoal;
use super::surface_ball::project_to_surface;
use super::{FieldDeviation, FieldDeviationSearch, leaf_failure};
use crate::budget::{Bound, JobError, Reference, Tolerance};
use crate::check::deviation::OneSidedDistance;
use crate::explicit::Bvh;
use crate::implicit::Csg;
use crate::math::{greater, sub_down};

/// The margins of a sandwich in the order in which they are tried, as shares of what samples require. With a
/// limit a wide margin comes first, since a looser proof is quicker; the second one is that with which meshes
/// are built. Without a limit each is smaller than the previous one, until the goal is reached. Measured on a
/// ball and a torus within a limit, in ranges a face: 29 and 68 with a margin of 1, 42 and 109 with a half, 63
/// and 182 with a quarter.
const WITH_LIMIT: [f64; 2] = [1.0, 0.5];
const WITHOUT: [f64; 3] = [0.25, 1.0 / 16.0, 1.0 / 64.0];
/// The number of worst faces at which lower bounds are searched: a few with a limit that holds, since no
/// decision depends on them then, and more without.
const PROBED: [usize; 2] = [4, 32];

/// The lower bounds.
#[derive(Clone, Copy)]
struct LowerBounds {
    forward: f64,
    from_mesh: [f64; 3],
    backward: f64,
    from_field: [f64; 3],
}

/// The deviation of a closed mesh; `None` if it was not proved.
pub(super) fn sandwich_deviation(
    search: &FieldDeviationSearch,
    bvh: &Bvh,
) -> Result<Option<FieldDeviation>, JobError> {
    let csg = Csg::from_graph(search.tape.graph());
    let mut prover = SandwichProver::new(&csg, &search.bounds, search.job).map_err(leaf_failure)?;
    let mut prove = |limit: Option<f64>, margin: f64| -> Result<Option<SandwichVerdict>, JobError> {
        search.check_cancelled()?;
        let verdict = prover.prove(search.mesh, &SandwichGoal::new(limit, margin))?;
        Ok(verdict.is_proved().then_some(verdict))
    };
    for margin in WITH_LIMIT.iter().filter(|_| search.goal.max.is_some()) {
        if let Some(verdict) = prove(search.goal.max.map(Tolerance::get), *margin)? {
            let lower = lower_bounds(search, &verdict, bvh, PROBED[0])?;
            return Ok(conclusion(search, &csg, &verdict, &lower, bvh));
        }
    }
    let mut best: Option<(SandwichVerdict, LowerBounds)> = None;
    for margin in WITHOUT {
        // A smaller margin leaves less room for the proof, so it would fail too.
        let Some(verdict) = prove(None, margin)? else { break };
        // Lower bounds come from points, whatever the margin.
        let lower = match &best {
            Some((_, lower)) => *lower,
            None => lower_bounds(search, &verdict, bvh, PROBED[1])?,
        };
        let is_better = best.as_ref().is_none_or(|(best, _)| verdict.bound < best.bound);
        if is_better {
            best = Some((verdict, lower));
        }
        let bound = best.as_ref().map_or(f64::INFINITY, |(best, _)| best.bound);
        let least = greater(lower.forward, lower.backward);
        if bound <= search.sufficient_distance(least) || search.goal.max.is_some() || !is_better {
            break;
        }
    }
    Ok(best.and_then(|(verdict, lower)| conclusion(search, &csg, &verdict, &lower, bvh)))
}

/// The bound of a proved mesh; `None` if a lower bound contradicts it.
pub(super) fn bound_from_verdict(
    search: &FieldDeviationSearch,
    verdict: &SandwichVerdict,
    bvh: &Bvh,
) -> Result<Option<Bound>, JobError> {
    let csg = Csg::from_graph(search.tape.graph());
    let lower = lower_bounds(search, verdict, bvh, PROBED[0])?;
    Ok(conclusion(search, &csg, verdict, &lower, bvh).map(|deviation| deviation.bound))
}

/// Lower bounds on the distance of points of the worst faces from the surface, and of nearby surface points
/// from the mesh.
fn lower_bounds(
    search: &FieldDeviationSearch,
    verdict: &SandwichVerdict,
    bvh: &Bvh,
    n: usize,
) -> Result<LowerBounds, JobError> {
    let mut worst: Vec<usize> = (0..verdict.bounds.len()).collect();
    let order = |a: &usize, b: &usize| verdict.bounds[*b].total_cmp(&verdict.bounds[*a]).then(a.cmp(b));
    if worst.len() > n {
        worst.select_nth_unstable_by(n, order);
        worst.truncate(n);
    }
    worst.sort_unstable_by(order);
    let centre = search.bounds.centre();
    let mut lower = LowerBounds { forward: 0.0, from_mesh: centre, backward: 0.0, from_field: centre };
    let middles: Vec<[f64; 3]> = worst.iter().map(|face| middle(&search.mesh.corners(*face))).collect();
    let most: Vec<f64> = worst.iter().map(|face| verdict.bounds[*face]).collect();
    let probed = probe_distances(&search.tape, &middles, &most, ProbeSharpness::ROUGH);
    for (p, probed) in middles.iter().zip(probed.map_err(leaf_failure)?) {
        // A rounded centroid is off the triangle by less than the floor.
        let least = sub_down(probed.at_least, search.floor);
        if least > lower.forward {
            (lower.forward, lower.from_mesh) = (least, *p);
        }
    }
    let mut starts = Vec::new();
    let mut sizes = Vec::new();
    for face in &worst {
        let corners = search.mesh.corners(*face);
        let side = |k: usize| -> [f64; 3] {
            std::array::from_fn(|i| 0.5 * corners[k][i] + 0.5 * corners[(k + 1) % 3][i])
        };
        starts.extend([middle(&corners), side(0), side(1), side(2)]);
        sizes.extend([verdict.bounds[*face]; 4]);
    }
    for witness in
        project_to_surface(&search.tape, &starts, &sizes).map_err(leaf_failure)?.into_iter().flatten()
    {
        let Some(distance) = bvh.closest_distance_down(witness.at) else { continue };
        let least = sub_down(distance, witness.radius);
        if least > lower.backward {
            (lower.backward, lower.from_field) = (least, witness.at);
        }
    }
    Ok(lower)
}

fn middle(corners: &[[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0)
}

/// `None` if a lower bound exceeds the verdict's bound: then the field breaks one of its promises.
fn conclusion(
    search: &FieldDeviationSearch,
    csg: &Csg,
    verdict: &SandwichVerdict,
    lower: &LowerBounds,
    bvh: &Bvh,
) -> Option<FieldDeviation> {
    let least = greater(lower.forward, lower.backward);
    if least > verdict.bound {
        return None;
    }
    let nearest = |p: [f64; 3]| bvh.closest_point(p).map_or(p, |closest| closest.point);
    let one_sided = |at_least: f64, from: [f64; 3], to: [f64; 3]| OneSidedDistance {
        at_least,
        at_most: verdict.bound,
        from,
        to,
    };
    let forward = one_sided(lower.forward, lower.from_mesh, lower.from_mesh);
    let backward = one_sided(lower.backward, lower.from_field, nearest(lower.from_field));
    let most = verdict.bound;
    let evidence = search.evidence.weaker(&csg.evidence());
    let mut bound = Bound::with_evidence(least, Some(most), evidence, Reference::Field);
    bound.at = Some(if lower.backward > lower.forward { lower.from_field } else { lower.from_mesh });
    let beyond = search.goal.max.is_some_and(|max| least > max.get());
    let reached = most <= search.sufficient_distance(least) || beyond;
    Some(FieldDeviation { bound, forward, backward, reached, unresolved: 0 })
}
