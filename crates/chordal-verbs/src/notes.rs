//! Notes of a report that several verbs make.
use crate::{MeshFailure, flatten};
use chordal::Job;
use chordal::budget::advice::Message;
use chordal::budget::{Budget, JobError, PixelBudget, View};
use chordal::check;
use chordal::check::shading::MicroTriangles;
use chordal::lod::ReductionStats;
use chordal_io::{Part, Scene};

/// What a bound of meshes that skins or morph targets deform does not cover.
pub(crate) fn deformation_note(scene: &Scene) -> Option<Message> {
    let note = "the bound is of meshes at rest: skins and morph targets move them afterwards";
    scene.parts.iter().any(Part::is_deformed).then(|| note.into())
}

/// Notes on the course of a simplification.
pub(crate) fn reduction_notes(stats: &ReductionStats) -> Vec<Message> {
    let mut notes: Vec<Message> = Vec::new();
    if stats.locked_vertices > 0 {
        notes.push(format!(
            "where the mesh is not a manifold or wound against itself it stays as it is: {} vertices; mend takes such \
             places apart",
            stats.locked_vertices
        ).into());
    }
    if stats.degenerate_faces > 0 {
        let n = stats.degenerate_faces;
        notes.push(format!("triangles with two corners at one position were left out ({n}x)").into());
    }
    if stats.dropped_components > 0 {
        let n = stats.dropped_components;
        notes.push(format!("separate pieces that the budget covers were left out ({n}x)").into());
    }
    notes
}

/// The most triangles, counted once for each instance, that are looked at for a note. Chosen: some 200 MiB.
const MOST_CHECKED: u64 = 1 << 20;

/// A note where most triangles are smaller than a pixel at the budget's view: more than half, since every
/// mesh has some at its poles and seams.
pub(crate) fn too_fine_note(
    scene: &Scene,
    budget: &Budget,
    job: &Job,
) -> Result<Option<Message>, MeshFailure> {
    let Some(PixelBudget { view, .. }) = budget.pixels else { return Ok(None) };
    // A scene that cannot be merged, or is too large to check, gets no note.
    if flatten::n_placed_faces(scene) > MOST_CHECKED {
        return Ok(None);
    }
    let Ok(mesh) = flatten::one_mesh(scene) else { return Ok(None) };
    let found = match check::shading::micro_triangles(&mesh, &view, job) {
        Ok(found) => found,
        Err(JobError::Cancelled) => return Err(MeshFailure::Cancelled),
        Err(JobError::Refused(_)) => return Ok(None),
    };
    let MicroTriangles { n_micro, n_triangles } = found;
    let most = n_micro > n_triangles / 2;
    let (of, at) = match view {
        View::Camera(_) => ("triangles in view", "there"),
        View::MinDistance(_) => ("triangles", "even where the eye is nearest and faces them"),
    };
    Ok(most.then(|| {
        format!(
            "{n_micro} of {n_triangles} {of} are smaller than a pixel {at}: more than the screen can show"
        )
        .into()
    }))
}
