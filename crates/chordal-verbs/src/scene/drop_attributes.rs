//! Drops attributes of the parts of a scene.
use crate::MeshFailure;
use crate::output::file_rows::unsupported;
use chordal::Mesh;
use chordal::budget::advice::Message;
use chordal::explicit::{InvalidMesh, Semantic};
use chordal_io::{Part, Scene};

/// Drops the normals of a scene that will be recomputed, so that no edge is kept for them, and the tangents that belong to
/// them, with a note.
pub(crate) fn drop_normals(scene: &mut Scene, notes: &mut Vec<Message>) -> Result<(), MeshFailure> {
    if scene.parts.iter().any(|part| part.mesh.attribute(&Semantic::Tangent).is_some()) {
        notes.push("tangents were left out: they go with the old normals".into());
    }
    drop_attributes(scene, |semantic| matches!(semantic, Semantic::Normal | Semantic::Tangent))
}

/// Drops attributes of a scene.
pub(crate) fn drop_attributes(
    scene: &mut Scene,
    is_dropped: impl Fn(&Semantic) -> bool,
) -> Result<(), MeshFailure> {
    let has_some = |part: &&mut Part| part.mesh.attributes().iter().any(|a| is_dropped(&a.semantic));
    for part in scene.parts.iter_mut().filter(has_some) {
        part.mesh = without_attributes(&part.mesh, &is_dropped).map_err(unsupported)?;
    }
    Ok(())
}

/// A mesh without some of its attributes.
pub(crate) fn without_attributes(
    mesh: &Mesh,
    is_dropped: impl Fn(&Semantic) -> bool,
) -> Result<Mesh, InvalidMesh> {
    mesh.with_only(mesh.attributes().iter().filter(|attribute| !is_dropped(&attribute.semantic)).cloned())
}
