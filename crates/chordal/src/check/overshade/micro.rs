//! `MicroTriangles`: the number of triangles that are smaller than a pixel at a view.
use super::binning::BinnedMesh;
use crate::budget::{Job, JobError, MinDistanceView, Projection, View, over_chunks};
use crate::explicit::{HitSides, Mesh};
use glam::DVec3;

/// Triangles smaller than a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MicroTriangles {
    /// Triangles with less than a pixel's area.
    pub n_micro: u64,
    /// All triangles considered: those in view of a camera, or all for a view that only gives a distance.
    pub n_triangles: u64,
}

/// Triangles a chunk, each taking some 5 ns (measured): a task takes longer than its overhead.
const CHUNK: usize = 16_384;

/// Counts the triangles that are smaller than a pixel at a view.
///
/// At a camera these are the triangles in view whose area there is less than a pixel's, as
/// [`super::overshade`] counts them. At a [`View::MinDistance`] it is an estimate in favour of the triangles:
/// each is assumed to face the eye, in the middle of the picture and at the least distance. (In the corner of
/// the picture areas are larger, by 1/cos³ of the angle.)
///
/// # Errors
/// As for [`super::overshade`].
///
/// ```
/// use chordal::{Job, Mesh};
/// use chordal::check::shading::micro_triangles;
/// let right = |a: f64| Mesh::new(vec![[0., 0., 0.], [a, 0., 0.], [0., a, 0.]], vec![[0, 1, 2]]).unwrap();
/// // 50 pixels a unit: half of 1.4² pixels is less than one, half of 1.5² is more.
/// let view = "1000x1000 fov=90 dist=10".parse()?;
/// let n_micro = |a: f64| micro_triangles(&right(a), &view, &Job::default()).unwrap().n_micro;
/// assert_eq!((n_micro(0.028), n_micro(0.03)), (1, 0));
/// # Ok::<(), chordal::budget::camera::InvalidView>(())
/// ```
pub fn micro_triangles(mesh: &Mesh, view: &View, job: &Job) -> Result<MicroTriangles, JobError> {
    match view {
        View::Camera(camera) => {
            let tally = BinnedMesh::new(mesh, camera, HitSides::Both, job)?.tally;
            Ok(MicroTriangles { n_micro: tally.micro, n_triangles: tally.in_view })
        }
        View::MinDistance(closest) => {
            let pixel = pixel(closest);
            let small = |face: &[u32; 3]| {
                let [a, b, c] = face.map(|row| DVec3::from(mesh.positions()[row as usize]) / pixel);
                (b - a).cross(c - a).length() < 2.0
            };
            let count = |_: usize, faces: &[[u32; 3]]| faces.iter().filter(|face| small(face)).count() as u64;
            let counts = job.run(|| over_chunks(mesh.faces(), CHUNK, count));
            Ok(MicroTriangles { n_micro: counts.iter().sum(), n_triangles: mesh.faces().len() as u64 })
        }
    }
}

/// The side of a pixel in the middle of the picture, at the nearest distance.
fn pixel(closest: &MinDistanceView) -> f64 {
    let height = f64::from(closest.screen.height_px);
    match closest.projection {
        Projection::Perspective { fov_y_deg } => {
            2.0 * closest.distance * libm::tan(fov_y_deg * (std::f64::consts::PI / 360.0)) / height
        }
        Projection::Orthographic { height: length } => length / height,
    }
}
