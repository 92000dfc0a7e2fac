//! The judge of offsets: how far triangles are from the surface at a distance from those that a step read.
use super::bound_judge::{JudgedBound, JudgedMesh, conclude_bound, unable};
use crate::MeshFailure;
use crate::report::OffsetFacts;
use chordal::budget::{Bound, JobError};
use chordal::check::{self, Goal};
use chordal::explicit::query::Bvh;
use chordal::math::{add_up, greater};
use chordal::{Job, Mesh, Tolerance};

/// The distance of a result from the offset of what was read, proved within the claim if possible.
pub(super) fn judge_offset(
    [read, written]: &[JudgedMesh; 2],
    facts: &OffsetFacts,
    claimed: &Bound,
    job: &Job,
) -> Result<JudgedBound, MeshFailure> {
    let Some(limit) = claimed.at_most().filter(|most| *most > 0.0) else {
        return unable("the claim has no upper bound");
    };
    if !(facts.distance.is_finite() && facts.distance > 0.0) {
        return unable("the distance of the offset is no length");
    }
    let moved =
        if read.moved == 0.0 && written.moved == 0.0 { 0.0 } else { add_up(read.moved, written.moved) };
    let judged = match &facts.kind[..] {
        "outward" => check::offset_deviation(&written.mesh, &read.mesh, facts.distance, limit, job),
        "inward" => check::offset_deviation(&written.mesh, &read.mesh, -facts.distance, limit, job),
        "hollow" => hollow(&written.mesh, &read.mesh, (facts.distance, limit), job),
        _ => return unable("the kind of the offset is not known"),
    };
    match judged {
        Ok(bound) => conclude_bound(&bound, moved, claimed),
        Err(JobError::Cancelled) => Err(MeshFailure::Cancelled),
        Err(JobError::Refused(refusal)) => unable(&refusal.message.to_string()),
    }
}

/// The faces near the solid against it, and the others, turned, against its inward offset: however they are divided, the
/// larger distance is that of both.
fn hollow(written: &Mesh, read: &Mesh, (wall, limit): (f64, f64), job: &Job) -> Result<Bound, JobError> {
    let bvh = Bvh::build(read, job)?;
    let is_outer = |corners: [[f64; 3]; 3]| {
        let middle = std::array::from_fn(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0);
        bvh.closest_distance_down(middle).is_some_and(|distance| distance < 0.5 * wall)
    };
    let numbers = 0..written.faces().len();
    let (outer, inner): (Vec<usize>, Vec<usize>) = numbers.partition(|face| is_outer(written.corners(*face)));
    let part = |faces: &[usize], is_turned: bool| {
        let faces = faces.iter().map(|face| {
            let [a, b, c] = written.faces()[*face];
            if is_turned { [a, c, b] } else { [a, b, c] }
        });
        Mesh::new(written.positions().to_vec(), faces.collect()).expect("the rows are the same")
    };
    let goal = Goal { max: Tolerance::new(limit).ok(), ..Goal::default() };
    let outer = check::deviation(&part(&outer, false), read, &goal, job)?.bound;
    let inner = check::offset_deviation(&part(&inner, true), read, -wall, limit, job)?;
    let most = outer.at_most().zip(inner.at_most()).map(|(outer, inner)| greater(outer, inner));
    Ok(Bound::with_evidence(0.0, most, inner.evidence().clone(), inner.reference))
}
