//! Passes triangles through unchanged, at the precision of a format.
use super::file_rows::unsupported;
use super::format_rounding::RoundingTarget;
use super::notes::deformation_notes;
use crate::scene::flatten::{self, TransformedScene};
use crate::scene::placements;
use crate::scene::shown_parts::ShownParts;
use crate::{MeshFailure, OutputForm};
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Reference, RefusalCode};
use chordal::explicit::Semantic;
use chordal::math::{add_up, greater};
use chordal::{Job, Mesh};
use chordal_io::glb::{VertexStorage, round_deformation};
use chordal_io::{Format, Scene, WriteError};

/// Rounds the parts of a scene to the format, or to lattices if the format is quantized, and applies the transforms if the
/// format has no nodes.
///
/// # Errors
/// If a coordinate does not fit the format, or the nodes take it out of range.
pub(crate) fn pass_through(
    scene: Scene,
    to: OutputForm,
    notes: &mut Vec<Message>,
) -> Result<(Scene, Bound), MeshFailure> {
    notes.extend(deformation_notes(&scene));
    let transformed = flatten::flatten_for(scene, to.format)?;
    notes.extend(transformed.note());
    let TransformedScene { mut scene, moved_at_most: transform_error, .. } = transformed;
    let stretch = placements::part_scales(&scene);
    let mut moved = 0.0;
    let mut n_collapsed = 0;
    // A copy: poses are compared with those of the scene as it was, while its parts are replaced.
    let before = flatten::is_posed(&scene).then(|| scene.clone());
    let shown = before.as_ref().map(ShownParts::new);
    for (number, (part, stretch)) in scene.parts.iter_mut().zip(stretch).enumerate() {
        if to.is_quantized() {
            part.storage = Some(Box::new(VertexStorage::of(&part.mesh)));
        }
        let lattice = part.storage.as_ref().and_then(|storage| storage.lattice);
        let snapped = RoundingTarget::new(to.format, lattice).snap(&part.mesh)?;
        if lattice.is_some() {
            n_collapsed += n_new_collapsed(&part.mesh, &snapped.mesh);
        }
        let after = rounded_deformation(snapped.mesh, part.storage.as_deref(), to.format)?;
        let part_moved = match shown.as_ref().filter(|shown| shown.is_posed(number)) {
            Some(shown) => {
                let both = [&part.mesh, &after];
                shown.moved(number, both, snapped.moved_at_most, (None, &Job::default()))?
            }
            None => placements::scaled_up(snapped.moved_at_most, stretch),
        };
        moved = greater(part_moved, moved);
        part.mesh = after;
    }
    if n_collapsed > 0 {
        let what = "triangles that are smaller than a step of 16 bits have two corners at one place now";
        notes.push(format!("{what} ({n_collapsed}x)").into());
    }
    let total = if moved == 0.0 || transform_error == 0.0 {
        moved + transform_error
    } else {
        add_up(moved, transform_error)
    };
    if !total.is_finite() {
        return Err(MeshFailure::refused(
            RefusalCode::NotFinite,
            "the transforms of the scene take its coordinates out of range",
        ));
    }
    Ok((scene, Bound::proved(0.0, total, Reference::InputTriangles)))
}

/// A mesh with its joints and morph targets rounded as glTF stores them.
pub(crate) fn rounded_deformation(
    mesh: Mesh,
    storage: Option<&VertexStorage>,
    to: Format,
) -> Result<Mesh, WriteError> {
    let is_deformed =
        mesh.attributes().iter().any(|attribute| matches!(attribute.semantic, Semantic::Blended(_)));
    if !is_deformed || !to.is_gltf() {
        return Ok(mesh);
    }
    round_deformation(&mesh, storage).map_err(unsupported)
}

/// The number of triangles that have two corners at one point after rounding, and had not before.
fn n_new_collapsed(before: &Mesh, after: &Mesh) -> usize {
    let is_collapsed = |[a, b, c]: [[f64; 3]; 3]| a == b || b == c || c == a;
    (0..after.faces().len())
        .filter(|face| is_collapsed(after.corners(*face)) && !is_collapsed(before.corners(*face)))
        .count()
}
