//! The rasterization cost of a mesh at a view: quads, helper lanes, triangles too small to be seen.
mod binning;
mod flicker;
mod micro;
mod projection;
mod raster_triangle;

pub use flicker::{Flicker, flicker};
pub use micro::{MicroTriangles, micro_triangles};

use crate::budget::{Camera, Job, JobError, Progress, par_map};
use crate::explicit::{HitSides, Mesh};
use binning::{BinnedMesh, NO_FACE, ScreenBand};
use raster_triangle::quad_runs;
use std::sync::atomic::{AtomicU64, Ordering};

/// The amount of shading. GPUs shade quads, 2×2 pixels aligned to even coordinates, each for one triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShadingCounts {
    /// Fragments: pairs of a triangle and a pixel in which it is shaded.
    pub fragments: u64,
    /// Quads: pairs of a triangle and a quad in which it has at least one fragment.
    pub quads: u64,
}

impl ShadingCounts {
    /// Lanes launched: four a quad.
    #[must_use]
    pub fn lanes(&self) -> u64 {
        4 * self.quads
    }

    /// Helper lanes, which run only for the derivatives of other lanes and whose results are discarded.
    #[must_use]
    pub fn helpers(&self) -> u64 {
        self.lanes() - self.fragments
    }

    /// The share of helpers among the lanes, 0 to 3/4; 0 if nothing is shaded.
    #[must_use]
    pub fn helper_share(&self) -> f64 {
        if self.quads == 0 { 0.0 } else { self.helpers() as f64 / self.lanes() as f64 }
    }
}

/// The rasterization cost of a mesh at a view.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Overshade {
    /// Triangles of the mesh.
    pub n_triangles: u64,
    /// Triangles that are partly on the screen and not culled.
    pub in_view: u64,
    /// Triangles in view that cover no pixel's centre: they are drawn without any effect.
    pub missed: u64,
    /// Triangles in view whose area on the screen is less than a pixel's: micro-triangles.
    pub micro: u64,
    /// Pixels whose centre is covered by at least one triangle.
    pub covered_px: u64,
    /// The shading if every triangle is shaded, hidden or not.
    pub every: ShadingCounts,
    /// The shading after a depth pre-pass: a quad is shaded only for triangles that are the nearest at one of
    /// its pixels. So every covered pixel is one fragment.
    pub visible: ShadingCounts,
    /// For each quad of the screen, row by row, the number of triangles shaded in it, hidden or not: that
    /// many lanes are launched for each of its pixels.
    pub launches: Vec<u32>,
    /// Quads in a row of the screen.
    pub quad_columns: u32,
}

impl Overshade {
    /// Triangles that cover the centre of a pixel.
    #[must_use]
    pub fn drawn(&self) -> u64 {
        self.in_view - self.missed
    }

    /// The overshade ratio: lanes launched per covered pixel after a depth pre-pass, 1 at best; 0 if
    /// nothing is covered.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        if self.covered_px == 0 { 0.0 } else { self.visible.lanes() as f64 / self.covered_px as f64 }
    }

    /// The share of the triangles in view that are smaller than a pixel; 0 if none are in view.
    #[must_use]
    pub fn micro_share(&self) -> f64 {
        if self.in_view == 0 { 0.0 } else { self.micro as f64 / self.in_view as f64 }
    }
}

/// Rasterizes the triangles of `mesh` as GPUs do, and counts their shading work.
///
/// Corners are rounded to 1/256 of a pixel; after that everything is exact. A pixel belongs to the triangles
/// that contain its centre, and to one of two that share an edge (the top-left rule). Parts before the near
/// plane, or 2²¹ pixels outside the picture, are clipped; the pieces of a clipped triangle are shaded
/// separately. `sides` selects the sides that are culled. One sample a pixel; each triangle is shaded
/// separately, without merging quads of neighbours. Positions are computed in f64 before rounding, where GPUs
/// use f32.
///
/// Cost: O(triangles + rows that they cover + pixels), on all threads of the job. Memory: 32 bytes a vertex,
/// 16 bytes a triangle and up to 32 bytes a pixel.
///
/// # Errors
/// [`JobError::Refused`] for an invalid camera, a screen of more than 2²⁰ pixels a side, or more memory than
/// the job allows; [`JobError::Cancelled`] if the job was cancelled.
///
/// ```
/// use chordal::{Job, Mesh, View};
/// use chordal::check::shading::overshade;
/// use chordal::explicit::query::HitSides;
/// // The lower left half of a screen of 8 × 8 pixels.
/// let mesh = Mesh::new(vec![[-4., -4., 0.], [4., -4., 0.], [-4., 4., 0.]], vec![[0, 1, 2]]).unwrap();
/// let View::Camera(camera) = "8x8 height=8 eye=0,0,1 target=0,0,0".parse()? else { unreachable!() };
/// let found = overshade(&mesh, &camera, HitSides::Both, &Job::default()).unwrap();
/// // Four of ten quads lie on the diagonal, which passes through centres: these belong to the other half.
/// assert_eq!((found.covered_px, found.visible.quads, found.visible.helpers()), (28, 10, 12));
/// # Ok::<(), chordal::budget::camera::InvalidView>(())
/// ```
///
/// Source: K. Fatahalian et al., *Reducing shading on GPUs using quad-fragment merging*, 2010, for the cost
/// of quads.
pub fn overshade(mesh: &Mesh, camera: &Camera, sides: HitSides, job: &Job) -> Result<Overshade, JobError> {
    let banded = BinnedMesh::new(mesh, camera, sides, job)?;
    let bands = over_bands(&banded, job, |band| band_quads(&banded, band))?;
    let mut counts = Overshade {
        n_triangles: mesh.faces().len() as u64,
        in_view: banded.tally.in_view,
        missed: banded.tally.missed,
        micro: banded.tally.micro,
        covered_px: 0,
        every: ShadingCounts { fragments: banded.tally.pixels, quads: 0 },
        visible: ShadingCounts::default(),
        launches: Vec::new(),
        quad_columns: camera.screen.width_px.div_ceil(2),
    };
    for (launches, visible) in bands {
        counts.visible.fragments += visible.fragments;
        counts.visible.quads += visible.quads;
        counts.every.quads += launches.iter().map(|n| u64::from(*n)).sum::<u64>();
        counts.launches.extend(launches);
    }
    counts.covered_px = counts.visible.fragments;
    Ok(counts)
}

/// Runs `work` on every band; results are in their order.
fn over_bands<R: Send>(
    banded: &BinnedMesh,
    job: &Job,
    work: impl Fn(&ScreenBand) -> R + Sync,
) -> Result<Vec<R>, JobError> {
    let bands = banded.bands();
    let total = bands.len() as u64;
    let done = AtomicU64::new(0);
    let results = par_map(job, &bands, |_, band| {
        let result = (!job.is_cancelled()).then(|| work(band));
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        job.report(Progress { stage: "rasterize", done, total });
        result
    });
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    Ok(results.into_iter().flatten().collect())
}

/// The launches in each quad of a band, and the visible shading.
fn band_quads(banded: &BinnedMesh, band: &ScreenBand) -> (Vec<u32>, ShadingCounts) {
    let width = banded.projected.size[0];
    let [top, bottom] = band.rows;
    let columns = (width + 1) / 2;
    let mut launches = vec![0_u32; (columns * ((bottom - top + 1) / 2)) as usize];
    banded.for_each_triangle(band, [0, 0], |_, piece, rows| {
        if rows[0] == rows[1] {
            return;
        }
        // A quad is shaded if any of its four pixels is covered, so spans of two rows are taken
        // together.
        for pair in rows[0] / 2..(rows[1] + 1) / 2 {
            let span = |row: i64| {
                if (rows[0]..rows[1]).contains(&row) { piece.span_within(row, width) } else { [0, 0] }
            };
            for [first, end] in quad_runs([span(2 * pair), span(2 * pair + 1)]) {
                let start = (pair - top / 2) * columns;
                launches[(start + first) as usize..(start + end) as usize].iter_mut().for_each(|n| *n += 1);
            }
        }
    });
    (launches, visible(&banded.nearest(band, [0, 0]), width as usize))
}

/// Each triangle that is nearest at a pixel of a quad is shaded in that quad.
fn visible(nearest: &[u32], width: usize) -> ShadingCounts {
    let mut shaded = ShadingCounts::default();
    for rows in nearest.chunks(2 * width) {
        let (upper, lower) = rows.split_at(width);
        for column in (0..width).step_by(2) {
            let two = |row: &[u32]| [0, 1].map(|k| row.get(column + k).copied().unwrap_or(NO_FACE));
            let ([a, b], [c, d]) = (two(upper), two(lower));
            let corners = [a, b, c, d];
            for (k, face) in corners.iter().enumerate().filter(|(_, face)| **face != NO_FACE) {
                shaded.fragments += 1;
                shaded.quads += u64::from(!corners[..k].contains(face));
            }
        }
    }
    shaded
}
