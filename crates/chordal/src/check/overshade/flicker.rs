//! `Flicker`: the change of the picture if the view moves by less than a pixel.
use super::binning::{BinnedMesh, MOST_SHIFT, NO_FACE, ScreenBand};
use super::over_bands;
use super::projection::{CHUNK, ScreenMesh};
use crate::budget::{Camera, Job, JobError, par_map};
use crate::explicit::{HitSides, Mesh, face_normal};
use crate::math::greater;
use glam::DVec3;

/// Shifts along an axis, in steps of 1/256 of a pixel: a quarter of a pixel apart, about the pixel's centre.
const SHIFTS: [i64; 4] = [-96, -32, 32, 96];
const _: () = assert!(SHIFTS[3] <= MOST_SHIFT);
/// The number of shifts.
const N: usize = SHIFTS.len() * SHIFTS.len();
/// The direction to the light, over the viewer's left shoulder: right, up and towards the eye.
const LIGHT: [f64; 3] = [-1.0, 1.0, 2.0];

/// The change of the picture of a mesh if the view moves by less than a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flicker {
    /// The root mean square of the difference between a pixel's shade and its mean over the shifts, 0 to 1/2,
    /// where 1 is the difference between black and white; 0 if no pixel is compared.
    pub rms: f64,
    /// The pixels that are compared: those covered at every shift, so that outlines do not count.
    pub n_pixels: u64,
}

/// Draws the mesh with a depth test at 16 shifts of the view, ±1/8 and ±3/8 of a pixel along both axes, and
/// compares.
///
/// The shade of a triangle is `½ + ½·n·l`: `n` is its unit normal on the visible side (0 for one without
/// area), and `l` the unit vector in the direction of (−1, 1, 2) to the right of the screen, up on it and
/// towards the eye. So a finely tessellated smooth surface flickers only as much as its shade changes within
/// a pixel, and a mesh that hides detail smaller than a pixel flickers with all of that detail. Rasterization
/// is as for [`super::overshade`]. Cost: 16 times as much.
///
/// # Errors
/// As for [`super::overshade`].
///
/// ```
/// use chordal::{Job, Mesh, View};
/// use chordal::check::shading::flicker;
/// use chordal::explicit::query::HitSides;
/// let flat = Mesh::new(vec![[-4., -4., 0.], [4., -4., 0.], [-4., 4., 0.]], vec![[0, 1, 2]]).unwrap();
/// let View::Camera(camera) = "8x8 height=8 eye=0,0,1 target=0,0,0".parse()? else { unreachable!() };
/// let found = flicker(&flat, &camera, HitSides::Both, &Job::default()).unwrap();
/// assert_eq!((found.rms, found.n_pixels), (0.0, 28)); // one shade, wherever it is seen
/// # Ok::<(), chordal::budget::camera::InvalidView>(())
/// ```
pub fn flicker(mesh: &Mesh, camera: &Camera, sides: HitSides, job: &Job) -> Result<Flicker, JobError> {
    let banded = BinnedMesh::new(mesh, camera, sides, job)?;
    let shades = shades(&banded.projected, job);
    let bands = over_bands(&banded, job, |band| band_flicker(&banded, band, &shades, job))?;
    let (mut sum, mut n_pixels) = (0.0, 0);
    for (changed, n) in bands {
        sum += changed;
        n_pixels += n;
    }
    let rms = if n_pixels == 0 { 0.0 } else { (sum / (n_pixels as f64 * N as f64)).sqrt() };
    Ok(Flicker { rms, n_pixels })
}

/// The shade of every triangle.
fn shades(projected: &ScreenMesh, job: &Job) -> Vec<f32> {
    let [right, up, back] = projected.axes();
    let light = (right * LIGHT[0] + up * LIGHT[1] + back * LIGHT[2]).normalize_or_zero();
    let n_faces = projected.mesh.faces().len();
    let starts: Vec<usize> = (0..n_faces).step_by(CHUNK).collect();
    let shade = |face: usize| {
        let corners = projected.mesh.corners(face);
        let normal = face_normal(corners).map_or(DVec3::ZERO, DVec3::from);
        let visible_normal = if projected.sees_front(corners[0], normal) { normal } else { -normal };
        (0.5 + 0.5 * visible_normal.dot(light)) as f32
    };
    let chunks = par_map(job, &starts, |_, start| -> Vec<f32> {
        (*start..n_faces.min(start + CHUNK)).map(shade).collect()
    });
    chunks.concat()
}

/// The sum of the squares of all changes in a band, and the number of pixels compared.
fn band_flicker(banded: &BinnedMesh, band: &ScreenBand, shades: &[f32], job: &Job) -> (f64, u64) {
    let n = (banded.projected.size[0] * (band.rows[1] - band.rows[0])) as usize;
    let (mut sums, mut squares, mut hits) = (vec![0.0; n], vec![0.0; n], vec![0_u8; n]);
    for shift in SHIFTS.iter().flat_map(|y| SHIFTS.map(|x| [x, *y])) {
        if job.is_cancelled() {
            return (0.0, 0);
        }
        for (at, face) in banded.nearest(band, shift).into_iter().enumerate() {
            if face != NO_FACE {
                // Shades have 24 bits, so f64 sums of 16 equal ones and of their squares are exact, and their
                // change is 0.
                let shade = f64::from(shades[face as usize]);
                sums[at] += shade;
                squares[at] += shade * shade;
                hits[at] += 1;
            }
        }
    }
    let compared = (0..n).filter(|at| usize::from(hits[*at]) == N);
    compared.fold((0.0, 0), |(changed, n_pixels), at| {
        let change = squares[at] - sums[at] * sums[at] / N as f64;
        (changed + greater(change, 0.0), n_pixels + 1)
    })
}
