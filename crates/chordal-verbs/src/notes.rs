//! Notes of a report that several verbs make.
use chordal::budget::advice::Message;
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
