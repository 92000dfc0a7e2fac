//! Checks the normals of a file by its own triangles: whether they are computed as the certificate states, and whether they
//! point to the front of their faces.
use super::attribute_pair::{cross, degrees_off, dot, row_at};
use crate::MeshFailure;
use crate::Normals;
use crate::output::file_rows::unsupported;
use crate::scene::drop_attributes::without_attributes;
use chordal::Mesh;
use chordal::explicit::{Semantic, Topology, with_normals};
use chordal_io::{Format, Scene};
use serde_json::Value;

/// The method by which normals were computed, according to a certificate.
pub(super) fn stated_normals(certificate: &Value) -> Option<Normals> {
    let notes = certificate.get("notes").and_then(Value::as_array).into_iter().flatten();
    notes.filter_map(Value::as_str).find_map(Normals::from_note)
}

/// Whether every normal is the one that a method computes, within `room_deg`. Vertices may have been tied by indices or by
/// coordinates at that time: a normal is right by either.
pub(super) fn are_computed(scene: &Scene, method: Normals, tolerance_deg: f64) -> Result<bool, MeshFailure> {
    let Some(shading) = method.shading(true, Format::Glb) else { return Ok(false) };
    for mesh in scene.parts.iter().map(|part| &part.mesh).filter(|mesh| !mesh.faces().is_empty()) {
        let Some(normals) = mesh.attribute(&Semantic::Normal).filter(|normals| normals.width == 3) else {
            continue;
        };
        let plain = without_attributes(mesh, |semantic| !matches!(semantic, Semantic::Group(_)));
        let plain = plain.map_err(unsupported)?;
        let mut recomputed = Vec::new();
        for topology in [Topology::Indices, Topology::Positions] {
            recomputed.push(with_normals(&plain, topology, shading).map_err(unsupported)?);
        }
        let agrees = |face: usize, k: usize| {
            let stated = direction(row_at(mesh, normals, face, k));
            recomputed.iter().any(|computed| {
                let expected = computed.attribute(&Semantic::Normal);
                let expected =
                    expected.map_or([0.0; 3], |normals| direction(row_at(computed, normals, face, k)));
                degrees_off([expected, stated]) <= tolerance_deg
            })
        };
        if !(0..mesh.faces().len()).all(|face| (0..3).all(|k| agrees(face, k))) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The share of the area, divided equally among the corners of its faces, whose normals point backwards, or are 0.
pub(super) fn share_backwards(scene: &Scene) -> f64 {
    let (mut backwards, mut total) = (0.0, 0.0);
    for mesh in scene.parts.iter().map(|part| &part.mesh) {
        let Some(normals) = mesh.attribute(&Semantic::Normal).filter(|normals| normals.width == 3) else {
            continue;
        };
        for face in 0..mesh.faces().len() {
            let front = front_of(mesh, face);
            let area = dot(front, front).sqrt();
            for k in 0..3 {
                let along = dot(direction(row_at(mesh, normals, face, k)), front);
                total += area;
                backwards += if along > 0.0 { 0.0 } else { area };
            }
        }
    }
    if total > 0.0 { backwards / total } else { 0.0 }
}

/// The vector to the front of a face, with twice its area as its length.
fn front_of(mesh: &Mesh, face: usize) -> [f64; 3] {
    let [a, b, c] = mesh.corners(face);
    let along = |to: [f64; 3]| [to[0] - a[0], to[1] - a[1], to[2] - a[2]];
    cross(along(b), along(c))
}

fn direction(row: &[f64]) -> [f64; 3] {
    std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0))
}
