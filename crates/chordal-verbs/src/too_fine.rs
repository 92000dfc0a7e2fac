//! The note on triangles that are smaller than a pixel.
use crate::{MeshFailure, merged_parts, placements};
use chordal::Job;
use chordal::budget::advice::Message;
use chordal::budget::{Budget, JobError, PixelBudget, View};
use chordal::check;
use chordal::check::shading::MicroTriangles;
use chordal_io::Scene;

/// The most triangles, counted once for each instance, that are checked for a note. Chosen: they take some 200 MiB.
const MOST_CHECKED: u64 = 1 << 20;

/// A note if more than half of the triangles are smaller than a pixel at the budget's view; every mesh has some small ones
/// at its poles and seams.
pub(crate) fn too_fine_note(
    scene: &Scene,
    budget: &Budget,
    job: &Job,
) -> Result<Option<Message>, MeshFailure> {
    let Some(PixelBudget { view, .. }) = budget.pixels else { return Ok(None) };
    // A scene that cannot be merged, or is too large to check, gets no note.
    if placements::n_placed_faces(scene) > MOST_CHECKED {
        return Ok(None);
    }
    let Ok(mesh) = merged_parts::one_mesh(scene) else { return Ok(None) };
    let counts = match check::shading::micro_triangles(&mesh, &view, job) {
        Ok(counts) => counts,
        Err(JobError::Cancelled) => return Err(MeshFailure::Cancelled),
        Err(JobError::Refused(_)) => return Ok(None),
    };
    let MicroTriangles { n_micro, n_triangles } = counts;
    let is_most = n_micro > n_triangles / 2;
    let (kind, at) = match view {
        View::Camera(_) => ("triangles in view", "there"),
        View::MinDistance(_) => ("triangles", "even where the eye is nearest and faces them"),
    };
    Ok(is_most.then(|| {
        format!(
            "{n_micro} of {n_triangles} {kind} are smaller than a pixel {at}: more than the screen can show"
        )
        .into()
    }))
}
