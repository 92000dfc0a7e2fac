//! `MicroTriangles`: how many triangles are smaller than a pixel at a view.
use super::banded::Banded;
use crate::budget::{Closest, Job, Projection, Stopped, View};
use crate::check::parallel::over_chunks;
use crate::explicit::{Mesh, Sides};
use glam::DVec3;

/// Triangles smaller than a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MicroTriangles {
    /// How many have less than a pixel's area.
    pub n_micro: u64,
    /// Of how many: those in view of a camera, or all for a view that is only so close.
    pub n_triangles: u64,
}

/// Triangles a chunk, of which each takes some 5 ns (measured): a task takes longer than it costs.
const CHUNK: usize = 16_384;

/// How many triangles are smaller than a pixel at a view.
///
/// At a camera these are the triangles in view whose area there is less than a pixel's, as [`super::overshade`] counts them.
/// At a [`View::Closest`] it is an estimate in favour of the triangles: each is taken to face the eye, in the middle of the
/// picture and as near as that may come. (In the corner of the picture areas are larger, by 1/cos³ of the angle.)
///
/// # Errors
/// As for [`super::overshade`].
///
/// ```
/// use chordal::{Job, Mesh, check::micro_triangles};
/// let right = |a: f64| Mesh::new(vec![[0., 0., 0.], [a, 0., 0.], [0., a, 0.]], vec![[0, 1, 2]]).unwrap();
/// // 50 pixels a unit: half of 1.4² pixels is less than one, half of 1.5² is more.
/// let view = "1000x1000 fov=90 dist=10".parse()?;
/// let n_micro = |a: f64| micro_triangles(&right(a), &view, &Job::default()).unwrap().n_micro;
/// assert_eq!((n_micro(0.028), n_micro(0.03)), (1, 0));
/// # Ok::<(), chordal::budget::InvalidView>(())
/// ```
pub fn micro_triangles(mesh: &Mesh, view: &View, job: &Job) -> Result<MicroTriangles, Stopped> {
    match view {
        View::Camera(camera) => {
            let tally = Banded::new(mesh, camera, Sides::Both, job)?.tally;
            Ok(MicroTriangles { n_micro: tally.micro, n_triangles: tally.in_view })
        }
        View::Closest(closest) => {
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
fn pixel(closest: &Closest) -> f64 {
    let height = f64::from(closest.screen.height_px);
    match closest.projection {
        Projection::Perspective { fov_y_deg } => {
            2.0 * closest.distance * libm::tan(fov_y_deg * (std::f64::consts::PI / 360.0)) / height
        }
        Projection::Orthographic { height: length } => length / height,
    }
}
