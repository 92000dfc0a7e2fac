//! `cut`: solids cut along each other, at the positions of a file, and the bound of the result.
use crate::MeshFailure;
use crate::output::format_rounding::RoundingTarget;
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
            Err(error) => {
                *overflow.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(error);
                Err(JobError::Refused(Refusal::new(RefusalCode::NotFinite, error.to_string())))
            }
        }
    };
    let solid = boolean_snapped(meshes[0], &steps, &snap, job);
    if let Some(error) = overflow.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        return Err(CutFailure::Other(MeshFailure::TooWide(error)));
    }
    solid.map_err(|error| match error {
        BooleanError::Stopped(stopped) => CutFailure::Other(stopped.into()),
        BooleanError::NotClosed { operand, boundary_edges } => {
            CutFailure::NotClosed { operand, boundary_edges }
        }
    })
}

/// The reason why there is no cut.
pub(crate) enum CutFailure {
    /// An operand has to be closed first.
    NotClosed {
        operand: usize,
        boundary_edges: u64,
    },
    Other(MeshFailure),
}

/// The bound of the cut plus the largest bound of the operands: the triangles of an operand, and those cut from them, leave
/// a point on its side if it is farther than both together from all surfaces.
pub(crate) fn total_bound(solid: &BooleanMesh, operand_bounds: &[&Bound]) -> Bound {
    if operand_bounds.is_empty() {
        return solid.bound.clone();
    }
    // A bound for the distance between surfaces does not imply that a point is on the same side of both.
    let sides = "what is farther from a shape than the bound of its triangles is on the same side of both";
    let sides = Evidence::ProvedIf(vec![sides.to_owned()]);
    let cut_evidence = solid.bound.evidence().weaker(&sides);
    let evidence =
        operand_bounds.iter().fold(cut_evidence, |cut_evidence, bound| cut_evidence.weaker(bound.evidence()));
    let bounds = operand_bounds.iter().map(|bound| bound.at_most());
    let largest = bounds.into_iter().try_fold(0.0, |most, bound| Some(greater(bound?, most)));
    let at_most = solid.bound.at_most().zip(largest).map(|(cut, operand)| add_up(cut, operand));
    let (at_most, evidence) = match at_most {
        Some(most) if most.is_finite() && evidence.bounds_above() => (Some(most), evidence),
        _ => (None, Evidence::Estimated),
    };
    let mut bound = Bound::with_evidence(0.0, at_most, evidence, solid.bound.reference.clone());
    // Of sides in every case: a film without thickness changes no side, and may be far from the true surface.
    (bound.metric, bound.at) = (Metric::Solid, solid.bound.at);
    bound
}

/// A generous bound for the displacement of the vertices of a cut: about a thousand steps of rounding.
pub(crate) fn cutting_slack(bounds: &Box3) -> f64 {
    let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |most, x| greater(x.abs(), most));
    // Measured on random solids: below 20 steps where faces meet at more than a degree.
    1024.0 * f64::EPSILON * reach
}
