//! Notes that several verbs add to a report.
use crate::scene::{merged_parts, placements};
use crate::{MeshFailure, OutputForm};
use chordal::budget::advice::{Cure, Message, Setting};
use chordal::budget::{Budget, JobError, PixelBudget, View};
use chordal::check::shading::MicroTriangles;
use chordal::lod::ReductionStats;
use chordal::{Job, check};
use chordal_io::glb::GltfPacking;
use chordal_io::{Part, Scene};

/// Notes on parts that a skin or morph targets move: the pose to which the bound applies, and skins that were not applied.
pub(crate) fn deformation_notes(scene: &Scene) -> Vec<Message> {
    if !scene.parts.iter().any(Part::is_deformed) {
        return Vec::new();
    }
    let mut notes: Vec<Message> = vec![
        "the bound is for the rest pose, by joints and default weights: animations move the parts afterwards"
            .into(),
    ];
    let poses = scene.rest_poses();
    let n_lacking = (0..scene.nodes.len()).filter(|node| poses.lacks_skin(*node)).count();
    if n_lacking > 0 {
        let what = "a skin lacks joints or matrices: its part is shown where its node places it";
        notes.push(format!("{what} ({n_lacking}x)").into());
    }
    notes
}

/// The note if the input is compressed or quantized and the output is not, though it could be.
pub(crate) fn packing_note(stored: GltfPacking, form: OutputForm) -> Option<Message> {
    let OutputForm { format, packing } = form;
    if !format.is_gltf() {
        return None;
    }
    let unpacked = stored.is_compressed && !packing.is_compressed;
    let widened = stored.is_quantized && !packing.is_quantized;
    let what = match (unpacked, widened) {
        (false, false) => return None,
        (true, false) => "the input is compressed, and the output is not: ",
        (false, true) => "the input is quantized, and the output is not: ",
        (true, true) => "the input is compressed and quantized, and the output is not: ",
    };
    let compress = |message: Message| message.value(Setting::Compress, "meshopt");
    let message = Message::from(what);
    let message = match (unpacked, widened) {
        (true, false) => compress(message).words(" compresses"),
        (false, _) => message.setting(Setting::Quantize).words(" rounds"),
        (true, true) => {
            compress(message).words(" compresses, and ").setting(Setting::Quantize).words(" rounds")
        }
    };
    Some(message.words(" the output"))
}

/// Notes on the course of a simplification.
pub(crate) fn reduction_notes(stats: &ReductionStats) -> Vec<Message> {
    let mut notes: Vec<Message> = Vec::new();
    if stats.locked_vertices > 0 {
        notes.push(format!(
            "where the mesh is not a manifold, or its winding is inconsistent, it stays as it is: {} fans of \
             triangles; mend takes such places apart",
            stats.locked_vertices
        ).into());
    }
    if stats.degenerate_faces > 0 {
        let n = stats.degenerate_faces;
        notes.push(format!("triangles without area were left out, and the bound counts it ({n}x)").into());
    }
    if stats.kept_degenerate_faces > 0 {
        let n = stats.kept_degenerate_faces;
        notes.push(
            Message::from(format!("triangles without area stay, far from all others ({n}x); "))
                .setting(Setting::Cure(Cure::DropDegenerate))
                .words(" of mend leaves them out"),
        );
    }
    notes.extend(unsettled_note(stats));
    if stats.dropped_components > 0 {
        let n = stats.dropped_components;
        notes.push(format!("separate pieces that the budget covers were left out ({n}x)").into());
    }
    notes
}

/// The note if all attempts to simplify failed.
pub(crate) fn unsettled_note(stats: &ReductionStats) -> Option<Message> {
    let n = stats.unsettled_faces;
    let start = format!(
        "triangles stay as they are, since no attempt was proved to be within the length: {n} in the last one were not; "
    );
    let message = Message::from(start)
        .words("where triangles cross, as ")
        .setting(Setting::SelfIntersections)
        .words(" of inspect shows, another length or a boolean union of the pieces helps");
    (n > 0).then_some(message)
}

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
