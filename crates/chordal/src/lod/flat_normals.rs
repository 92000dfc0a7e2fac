//! Flat shading: normals that equal those of the faces, and are recomputed for the remaining faces.
use crate::explicit::{Attribute, Domain, Mesh, Semantic};
use crate::math::{cross, difference, dot, greater, length};

/// The largest angle between a normal and that of its face that counts as equal: 5°. Chosen: for normals in
/// eight bits per component and positions in f32.
const SAME_COSINE: f64 = 0.996_194_698_091_745_5;
/// Faces below this have no reliable normal: twice the area of a face, as a fraction of its longest side
/// squared. Chosen: rounding to f32 may rotate a needle.
const NEEDLE: f64 = 1e-3;
/// A normal that differs by no more than this keeps its old value: 0.06°. Chosen: not visible, and flat sides
/// are tilted by up to 1e-4 where points moved in them.
const ONE: f64 = 1e-3;

/// Whether each face has one normal at all corners, which is the face's normal.
pub(super) fn is_flat(mesh: &Mesh, attribute: &Attribute) -> bool {
    let is_normal = attribute.semantic == Semantic::Normal && attribute.width == 3;
    is_normal && (0..mesh.faces().len() as u32).all(|face| is_flat_at(mesh, attribute, face))
}

fn is_flat_at(mesh: &Mesh, attribute: &Attribute, face: u32) -> bool {
    let [n, m, o] = corner_normals(mesh, attribute, face);
    if n != m || n != o {
        return false;
    }
    // Halved, so that no difference overflows, and scaled to an extent of 1.
    let corners = mesh.corners(face as usize).map(|p| p.map(|x| 0.5 * x));
    let sides = [difference(corners[1], corners[0]), difference(corners[2], corners[0])];
    let most = sides.as_flattened().iter().fold(0.0, |most, x| greater(x.abs(), most));
    let [u, v] = sides.map(|side| side.map(|x| x / most));
    let face_normal = cross(u, v);
    let longest = dot(u, u) + dot(v, v);
    // The face is a needle, or all its corners are at one point, which makes this NaN.
    let is_wide = dot(face_normal, face_normal) > NEEDLE * NEEDLE * longest * longest;
    if !is_wide {
        return true;
    }
    dot(face_normal, n) >= SAME_COSINE * (dot(face_normal, face_normal) * dot(n, n)).sqrt() && dot(n, n) > 0.0
}

/// The values of a normal attribute at the corners of a face.
fn corner_normals(mesh: &Mesh, attribute: &Attribute, face: u32) -> [[f64; 3]; 3] {
    let at = |k: usize| match attribute.domain {
        Domain::Face => face as usize,
        Domain::Corner => 3 * face as usize + k,
        Domain::Vertex => mesh.faces()[face as usize][k] as usize,
    };
    [0, 1, 2].map(|k| std::array::from_fn(|i| attribute.row(at(k))[i]))
}

/// The normal of a face with these corners; the old normal if it is nearly the same.
pub(super) fn updated_normal(
    corners: [[f64; 3]; 3],
    mesh: &Mesh,
    attribute: &Attribute,
    face: u32,
) -> [f64; 3] {
    let [had, ..] = corner_normals(mesh, attribute, face);
    let face_normal = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
    let size = length(face_normal);
    let now = face_normal.map(|x| x / size);
    // NaN if the face has no area.
    let turned = size > 0.0 && (0..3).any(|k| (now[k] - had[k]).abs() > ONE);
    if turned { now } else { had }
}
