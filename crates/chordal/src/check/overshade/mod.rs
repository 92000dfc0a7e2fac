//! What a mesh costs a graphics processor at a view: quads, helper lanes, triangles too small to be seen.
mod banded;
mod fixed;
mod flicker;
mod micro;
mod projected;

pub use flicker::{Flicker, flicker};
pub use micro::{MicroTriangles, micro_triangles};

use crate::budget::{Camera, Job, Progress, Stopped, par_map};
use crate::explicit::{Mesh, Sides};
use banded::{Band, Banded, NOBODY};
use fixed::quad_runs;
use std::sync::atomic::{AtomicU64, Ordering};

/// What is shaded: processors shade quads, 2×2 pixels that start at even ones, each for one triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shaded {
    /// Fragments: pairs of a triangle and a pixel that it is shaded at.
    pub fragments: u64,
    /// Quads: pairs of a triangle and a quad in which it has at least one fragment.
    pub quads: u64,
}

impl Shaded {
    /// Lanes launched: four a quad.
    #[must_use]
    pub fn lanes(&self) -> u64 {
        4 * self.quads
    }

    /// Lanes that run for the derivatives of others, and whose result is thrown away.
    #[must_use]
    pub fn helpers(&self) -> u64 {
        self.lanes() - self.fragments
    }

    /// The share of the lanes that are helpers, 0 to 3/4; 0 when nothing is shaded.
    #[must_use]
    pub fn helper_share(&self) -> f64 {
        if self.quads == 0 { 0.0 } else { self.helpers() as f64 / self.lanes() as f64 }
    }
}

/// What a mesh costs at a view.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Overshade {
    /// Triangles of the mesh.
    pub n_triangles: u64,
    /// Those of which something is on the screen and not culled.
    pub in_view: u64,
    /// Those of which something is on the screen, and that cover no pixel's centre: they are drawn for nothing.
    pub missed: u64,
    /// Those of which something is on the screen, and whose area there is less than a pixel's: micro-triangles.
    pub micro: u64,
    /// Pixels whose centre at least one triangle covers.
    pub covered_px: u64,
    /// What is shaded when every triangle is, hidden or not.
    pub every: Shaded,
    /// What is shaded after a depth pre-pass: a quad only where the triangle is the nearest at one of its pixels. So every
    /// covered pixel is one fragment.
    pub visible: Shaded,
    /// For each quad of the screen, row by row, how many triangles are shaded in it, hidden or not: that many lanes are
    /// launched for each of its pixels.
    pub launches: Vec<u32>,
    /// Quads a row of the screen.
    pub quad_columns: u32,
}

impl Overshade {
    /// Triangles that cover the centre of a pixel.
    #[must_use]
    pub fn drawn(&self) -> u64 {
        self.in_view - self.missed
    }

    /// The overshade ratio: lanes launched a covered pixel after a depth pre-pass, 1 at best; 0 when nothing is covered.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        if self.covered_px == 0 { 0.0 } else { self.visible.lanes() as f64 / self.covered_px as f64 }
    }

    /// The share of the triangles in view that are smaller than a pixel; 0 when none are in view.
    #[must_use]
    pub fn micro_share(&self) -> f64 {
        if self.in_view == 0 { 0.0 } else { self.micro as f64 / self.in_view as f64 }
    }
}

/// Rasterizes the triangles of `mesh` as graphics processors do, and counts what they would shade.
///
/// Corners are rounded to 1/256 of a pixel; from there on all is exact: a pixel belongs to the triangles that hold its
/// centre, and to one of two that share an edge (the top-left rule). What lies before the near plane, or 2²¹ pixels
/// outside of the picture, is cut off; the pieces of a triangle that is cut are shaded one by one. `sides` says what is
/// culled. One sample a pixel; a triangle is shaded by itself, without merging quads of neighbours. The positions that
/// are rounded are computed in f64, where processors have f32.
///
/// Cost: O(triangles + rows that they cover + pixels), on all threads of the job. Memory: 32 bytes a vertex, 16 bytes a
/// triangle and up to 32 bytes a pixel.
///
/// # Errors
/// [`Stopped::Refused`] for a camera that is none, a screen of more than 2²⁰ pixels a side, or more memory than the job
/// allows; [`Stopped::Cancelled`] when the job was.
///
/// ```
/// use chordal::{Job, Mesh, View, check::overshade, explicit::Sides};
/// // The lower left half of a screen of 8 × 8 pixels.
/// let mesh = Mesh::new(vec![[-4., -4., 0.], [4., -4., 0.], [-4., 4., 0.]], vec![[0, 1, 2]]).unwrap();
/// let View::Camera(camera) = "8x8 height=8 eye=0,0,1 target=0,0,0".parse()? else { unreachable!() };
/// let found = overshade(&mesh, &camera, Sides::Both, &Job::default()).unwrap();
/// // Four of ten quads lie on the diagonal, which passes through centres: these belong to the other half.
/// assert_eq!((found.covered_px, found.visible.quads, found.visible.helpers()), (28, 10, 12));
/// # Ok::<(), chordal::budget::InvalidView>(())
/// ```
///
/// Source: K. Fatahalian et al., *Reducing shading on GPUs using quad-fragment merging*, 2010, for what quads cost.
pub fn overshade(mesh: &Mesh, camera: &Camera, sides: Sides, job: &Job) -> Result<Overshade, Stopped> {
    let banded = Banded::new(mesh, camera, sides, job)?;
    let bands = over_bands(&banded, job, |band| of_band(&banded, band))?;
    let mut found = Overshade {
        n_triangles: mesh.faces().len() as u64,
        in_view: banded.tally.in_view,
        missed: banded.tally.missed,
        micro: banded.tally.micro,
        covered_px: 0,
        every: Shaded { fragments: banded.tally.pixels, quads: 0 },
        visible: Shaded::default(),
        launches: Vec::new(),
        quad_columns: camera.screen.width_px.div_ceil(2),
    };
    for (launches, visible) in bands {
        found.visible.fragments += visible.fragments;
        found.visible.quads += visible.quads;
        found.every.quads += launches.iter().map(|n| u64::from(*n)).sum::<u64>();
        found.launches.extend(launches);
    }
    found.covered_px = found.visible.fragments;
    Ok(found)
}

/// `work` of every band, in their order.
fn over_bands<R: Send>(
    banded: &Banded,
    job: &Job,
    work: impl Fn(&Band) -> R + Sync,
) -> Result<Vec<R>, Stopped> {
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
        return Err(Stopped::Cancelled);
    }
    Ok(results.into_iter().flatten().collect())
}

/// The launches in each quad of a band, and what is visible of it.
fn of_band(banded: &Banded, band: &Band) -> (Vec<u32>, Shaded) {
    let width = banded.projected.size[0];
    let [top, bottom] = band.rows;
    let columns = (width + 1) / 2;
    let mut launches = vec![0_u32; (columns * ((bottom - top + 1) / 2)) as usize];
    banded.each(band, [0, 0], |_, piece, rows| {
        if rows[0] == rows[1] {
            return;
        }
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

/// Each triangle that is nearest somewhere in a quad is shaded in it.
fn visible(nearest: &[u32], width: usize) -> Shaded {
    let mut shaded = Shaded::default();
    for rows in nearest.chunks(2 * width) {
        let (upper, lower) = rows.split_at(width);
        for column in (0..width).step_by(2) {
            let two = |row: &[u32]| [0, 1].map(|k| row.get(column + k).copied().unwrap_or(NOBODY));
            let ([a, b], [c, d]) = (two(upper), two(lower));
            let all = [a, b, c, d];
            for (k, face) in all.iter().enumerate().filter(|(_, face)| **face != NOBODY) {
                shaded.fragments += 1;
                shaded.quads += u64::from(!all[..k].contains(face));
            }
        }
    }
    shaded
}
