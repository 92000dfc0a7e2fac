//! Normals of a file, looked at again by its own triangles: whether they are what the certificate says was computed, and
//! whether they look to the front of the faces that they shade.
use super::attribute_pair::{cross, degrees_off, dot, row_at};
use crate::Normals;
use crate::file_rows::unsupported;
use crate::{MeshFailure, drop_attributes::without_attributes};
use chordal::Mesh;
use chordal::explicit::{Semantic, Topology, with_normals};
use chordal_io::{Format, Scene};
use serde_json::Value;

/// How a certificate says that normals were computed.
pub(super) fn said_normals(certificate: &Value) -> Option<Normals> {
    let notes = certificate.get("notes").and_then(Value::as_array).into_iter().flatten();
    notes.filter_map(Value::as_str).find_map(Normals::from_note)
}

/// Whether every normal is the one that is computed so, to `room_deg`. Which vertices of a file were one position when
/// that was done, its indices say or its coordinates: a normal is right by either.
pub(super) fn are_computed(scene: &Scene, how: Normals, room_deg: f64) -> Result<bool, MeshFailure> {
    let Some(shading) = how.shading(true, Format::Glb) else { return Ok(false) };
    for mesh in scene.parts.iter().map(|part| &part.mesh).filter(|mesh| !mesh.faces().is_empty()) {
        let Some(own) = mesh.attribute(&Semantic::Normal).filter(|own| own.width == 3) else { continue };
        let plain = without_attributes(mesh, |semantic| !matches!(semantic, Semantic::Group(_)));
        let plain = plain.map_err(unsupported)?;
        let mut again = Vec::new();
        for topology in [Topology::Indices, Topology::Positions] {
            again.push(with_normals(&plain, topology, shading).map_err(unsupported)?);
        }
        let agrees = |face: usize, k: usize| {
            let said = direction(row_at(mesh, own, face, k));
            again.iter().any(|made| {
                let found = made.attribute(&Semantic::Normal);
                let found = found.map_or([0.0; 3], |found| direction(row_at(made, found, face, k)));
                degrees_off([found, said]) <= room_deg
            })
        };
        if !(0..mesh.faces().len()).all(|face| (0..3).all(|k| agrees(face, k))) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The share of the area, by the corners of its faces, where normals look to the back, or nowhere.
pub(super) fn share_backwards(scene: &Scene) -> f64 {
    let (mut backwards, mut all) = (0.0, 0.0);
    for mesh in scene.parts.iter().map(|part| &part.mesh) {
        let Some(own) = mesh.attribute(&Semantic::Normal).filter(|own| own.width == 3) else { continue };
        for face in 0..mesh.faces().len() {
            let front = front_of(mesh, face);
            let area = dot(front, front).sqrt();
            for k in 0..3 {
                let along = dot(direction(row_at(mesh, own, face, k)), front);
                all += area;
                backwards += if along > 0.0 { 0.0 } else { area };
            }
        }
    }
    if all > 0.0 { backwards / all } else { 0.0 }
}

/// The direction to the front of a face, twice its area long.
fn front_of(mesh: &Mesh, face: usize) -> [f64; 3] {
    let [a, b, c] = mesh.corners(face);
    let along = |to: [f64; 3]| [to[0] - a[0], to[1] - a[1], to[2] - a[2]];
    cross(along(b), along(c))
}

fn direction(row: &[f64]) -> [f64; 3] {
    std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0))
}
