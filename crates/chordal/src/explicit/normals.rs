//! Normals of triangles, and of vertices from the triangles around them.
mod angle;
mod corner_terms;
mod lanes;
mod shading;
mod smooth;

pub use corner_terms::NormalWeight;
pub(crate) use shading::with_vertex_normals;
pub use shading::{Shading, with_normals};
pub use smooth::smooth_normals;

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
    let [a, b, c] = corners;
    let a = DVec3::from(a);
    let (ab, ac) = (DVec3::from(b) - a, DVec3::from(c) - a);
    // Scaled by the longer edge, so that neither tiny nor huge triangles leave the range of f64.
    let scale = ab.abs().max_element().max(ac.abs().max_element());
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    let normal = (ab / scale).cross(ac / scale);
    let longest = normal.abs().max_element();
    (longest > 0.0).then(|| (normal / longest).normalize().into())
}

/// One unit normal per vertex: [`smooth_normals`] with the faces weighted by their angle at the vertex.
///
/// Source: G. Thürmer and C. Wüthrich, *Computing vertex normals from polygonal facets*, 1998.
#[must_use]
pub fn vertex_normals(mesh: &Mesh) -> Vec<[f64; 3]> {
    smooth_normals(mesh, NormalWeight::Angle)
}
