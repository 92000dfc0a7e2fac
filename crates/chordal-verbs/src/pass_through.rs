//! Passes triangles through unchanged, at the precision of a format.
use crate::MeshFailure;
use crate::flatten::{self, TransformedScene};
use crate::placements;
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Reference, RefusalCode};
use chordal::math::{add_up, greater};
use chordal_io::{Format, Scene, snap};

/// Rounds the parts of a scene to the format, and applies the transforms where the format has no nodes.
///
/// # Errors
/// When a coordinate does not fit the format, or the nodes take it out of range.
pub(crate) fn pass_through(
    scene: Scene,
    to: Format,
    notes: &mut Vec<Message>,
) -> Result<(Scene, Bound), MeshFailure> {
    let placed = if to.has_nodes() { TransformedScene::unchanged(scene) } else { flatten::flatten(scene)? };
    notes.extend(placed.note());
    let TransformedScene { mut scene, moved_at_most: placed, .. } = placed;
    let stretch = placements::part_scales(&scene);
    let mut moved = 0.0;
    for (part, stretch) in scene.parts.iter_mut().zip(stretch) {
        let snapped = snap(&part.mesh, to)?;
        let part_moved = placements::scaled_up(snapped.moved_at_most, stretch);
        moved = greater(part_moved, moved);
        part.mesh = snapped.mesh;
    }
    let all = if moved == 0.0 || placed == 0.0 { moved + placed } else { add_up(moved, placed) };
    if !all.is_finite() {
        return Err(MeshFailure::refused(
            RefusalCode::NotFinite,
            "the transforms of the scene take its coordinates out of range",
        ));
    }
    Ok((scene, Bound::proved(0.0, all, Reference::InputTriangles)))
}
