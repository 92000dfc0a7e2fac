//! `cut`: solids cut along each other, at the positions that a file holds, and the bound of what they make.
use crate::MeshFailure;
use crate::format_rounding::RoundingTarget;
use chordal::boolean::provenance::BooleanError;
use chordal::boolean::{BooleanMesh, BooleanOp, BooleanStep, boolean_snapped};
use chordal::budget::{Bound, Evidence, JobError, Metric, Refusal, RefusalCode};
use chordal::math::{Box3, add_up, greater};
use chordal::{Job, Mesh};
use chordal_io::CoordinateOverflow;
use std::sync::Mutex;

/// Cuts meshes along each other, from left to right, and rounds the result before it is checked.
pub(crate) fn cut(
    meshes: &[&Mesh],
    ops: &[BooleanOp],
    target: RoundingTarget,
    job: &Job,
) -> Result<BooleanMesh, CutFailure> {
    let steps: Vec<BooleanStep> =
        ops.iter().zip(&meshes[1..]).map(|(op, mesh)| BooleanStep { op: *op, mesh }).collect();
    let overflow: Mutex<Option<CoordinateOverflow>> = Mutex::default();
    let snap = |positions: &mut [[f64; 3]]| {
        let points = Mesh::new(positions.to_vec(), Vec::new()).map_err(|invalid| {
            JobError::Refused(Refusal::new(RefusalCode::NotFinite, invalid.to_string()))
        })?;
        match target.snap(&points) {
            Ok(snapped) => {
                positions.copy_from_slice(snapped.mesh.positions());
                Ok(())
            }
            Err(why) => {
                *overflow.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(why);
                Err(JobError::Refused(Refusal::new(RefusalCode::NotFinite, why.to_string())))
            }
        }
    };
    let made = boolean_snapped(meshes[0], &steps, &snap, job);
    if let Some(why) = overflow.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        return Err(CutFailure::Other(MeshFailure::TooWide(why)));
    }
    made.map_err(|error| match error {
        BooleanError::Stopped(stopped) => CutFailure::Other(stopped.into()),
        BooleanError::NotClosed { operand, boundary_edges } => {
            CutFailure::NotClosed { operand, boundary_edges }
        }
    })
}

/// Why there is no cut yet.
pub(crate) enum CutFailure {
    /// An operand has to be closed first.
    NotClosed {
        operand: usize,
        boundary_edges: u64,
    },
    Other(MeshFailure),
}

/// The bound of the cut, and the largest of the operands' own: farther than both together from all surfaces
/// the triangles of an operand, and those cut from them, leave every point on its side.
pub(crate) fn whole_bound(made: &BooleanMesh, own: &[&Bound]) -> Bound {
    if own.is_empty() {
        return made.bound.clone();
    }
    // A distance between surfaces says nothing of their sides.
    let sides = "what is farther from a shape than the bound of its triangles is on the same side of both";
    let sides = Evidence::ProvedIf(vec![sides.to_owned()]);
    let all = made.bound.evidence().weaker(&sides);
    let evidence = own.iter().fold(all, |all, bound| all.weaker(bound.evidence()));
    let largest =
        own.iter().map(|bound| bound.at_most()).try_fold(0.0, |most, own| Some(greater(own?, most)));
    let at_most = made.bound.at_most().zip(largest).map(|(cut, own)| add_up(cut, own));
    let (at_most, evidence) = match at_most {
        Some(most) if most.is_finite() && evidence.bounds_above() => (Some(most), evidence),
        _ => (None, Evidence::Estimated),
    };
    let mut bound = Bound::with_evidence(0.0, at_most, evidence, made.bound.reference.clone());
    (bound.metric, bound.at) = (Metric::Solid, made.bound.at);
    bound
}

/// What the vertices of a cut are off by, generously: some hundred steps of rounding.
pub(crate) fn cutting_slack(bounds: &Box3) -> f64 {
    let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |most, x| greater(x.abs(), most));
    // Measured on random solids: below 20 steps where faces meet at more than a degree.
    1024.0 * f64::EPSILON * reach
}
