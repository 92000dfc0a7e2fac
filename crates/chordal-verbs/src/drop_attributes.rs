//! Drops attributes of the parts of a scene.
use crate::MeshFailure;
use crate::file_rows::unsupported;
use chordal::Mesh;
use chordal::budget::advice::Message;
use chordal::explicit::Semantic;
use chordal_io::{Part, Scene};

/// Drops the normals of a scene that will be recomputed, so that they preserve no edge, and the tangents that go
/// with them, with a note.
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
        let mesh = &part.mesh;
        let mut bare = Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec()).map_err(unsupported)?;
        if let Some(id) = mesh.position_id() {
            bare = bare.with_position_id(id.to_vec()).map_err(unsupported)?;
        }
        for attribute in mesh.attributes().iter().filter(|attribute| !is_dropped(&attribute.semantic)) {
            bare = bare.with_attribute(attribute.clone()).map_err(unsupported)?;
        }
        part.mesh = bare;
    }
    Ok(())
}
