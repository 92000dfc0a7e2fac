//! The face groups that name materials.
use crate::MATERIAL;
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};

/// The face groups that name materials.
pub(super) fn material_groups(mesh: &Mesh) -> Option<&Attribute> {
    mesh.attributes().iter().find(|attribute| is_material(attribute))
}

pub(super) fn is_material(attribute: &Attribute) -> bool {
    let is_kind = matches!(&attribute.semantic, Semantic::Group(kind) if kind == MATERIAL);
    is_kind && attribute.domain == Domain::Face && attribute.width == 1
}

/// The runs of faces with one material: the group, and the number of faces. [`split`](super::split) has made
/// them consecutive.
pub(super) fn material_runs(mesh: &Mesh) -> Vec<(usize, usize)> {
    match material_groups(mesh) {
        Some(groups) => {
            let runs = groups.values.chunk_by(|a, b| a == b);
            runs.map(|run| (run[0] as usize, run.len())).collect()
        }
        None => vec![(0, mesh.faces().len())],
    }
}
