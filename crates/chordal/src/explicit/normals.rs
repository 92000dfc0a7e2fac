//! Normals of triangles, and of vertices from the triangles around them.
use super::Mesh;
use glam::DVec3;

/// The unit normal `normalize((b − a) × (c − a))`; `None` for a triangle without area, never NaN.
///
/// ```
/// use chordal::explicit::face_normal;
/// let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
/// assert_eq!(face_normal([a, b, c]), Some([0.0, 0.0, 1.0]));
/// assert_eq!(face_normal([a, c, b]), Some([0.0, 0.0, -1.0]));
/// assert_eq!(face_normal([a, b, b]), None);
/// ```
#[must_use]
pub fn face_normal(corners: [[f64; 3]; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = corners.map(DVec3::from);
    let (ab, ac) = (b - a, c - a);
    // Scaled to the longer edge, so that neither tiny nor huge triangles leave the range of f64.
    let scale = ab.abs().max_element().max(ac.abs().max_element());
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    let normal = (ab / scale).cross(ac / scale);
    let longest = normal.abs().max_element();
    (longest > 0.0).then(|| (normal / longest).normalize().into())
}

/// One unit normal a vertex: the faces' normals weighted by their angle at the vertex, over all faces that share
/// its position. Vertices without a face of positive area get `[0, 0, 0]`.
///
/// Source: G. Thürmer and C. Wüthrich, *Computing vertex normals from polygonal facets*, 1998.
#[must_use]
pub fn vertex_normals(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut sums = vec![DVec3::ZERO; mesh.positions().len()];
    for (face_idx, face) in mesh.faces().iter().enumerate() {
        let corners = mesh.corners(face_idx);
        let Some(normal) = face_normal(corners) else { continue };
        for k in 0..3 {
            let at = DVec3::from(corners[k]);
            let angle =
                angle_between(DVec3::from(corners[(k + 1) % 3]) - at, DVec3::from(corners[(k + 2) % 3]) - at);
            sums[mesh.position_of(face[k]) as usize] += DVec3::from(normal) * angle;
        }
    }
    (0..mesh.positions().len() as u32)
        .map(|vertex| sums[mesh.position_of(vertex) as usize].normalize_or_zero().into())
        .collect()
}

fn angle_between(a: DVec3, b: DVec3) -> f64 {
    let (a, b) = (a.normalize_or_zero(), b.normalize_or_zero());
    libm::atan2(a.cross(b).length(), a.dot(b))
}
