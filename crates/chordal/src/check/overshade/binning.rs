//! `BinnedMesh`: the triangles of a view binned into bands of rows, so that bands can be rasterized in
//! parallel.
use super::projection::{CHUNK, MOST_PX, ScreenMesh};
use super::raster_triangle::{RasterTriangle, RasterVertex, STEPS, box_meets};
use crate::budget::{Camera, Job, JobError, Refusal, RefusalCode, par_map};
use crate::explicit::{HitSides, Mesh};
use std::sync::atomic::{AtomicU64, Ordering};

/// The approximate number of pixels in a band: its buffers fit into the cache of a core, and the usual
/// screens have more bands than machines have cores.
const BAND_PX: i64 = 1 << 16;
/// Bytes for each pixel of the screen while bands are rasterized, including flicker.
const BYTES_PER_PIXEL: u64 = 32;
/// Pixel centres are shifted by less than half a pixel, which the rows of bands include.
pub(super) const MOST_SHIFT: i64 = STEPS / 2 - 1;
/// No triangle.
pub(super) const NO_FACE: u32 = u32::MAX;

/// A mesh before a camera, binned.
pub(super) struct BinnedMesh<'a> {
    pub projected: ScreenMesh<'a>,
    sides: HitSides,
    rows_of_a_band: i64,
    /// For each chunk of triangles the bands that they reach, sorted by band and then by triangle.
    entries: Vec<Vec<(u32, u32)>>,
    pub tally: RasterCounts,
}

/// Counts over the triangles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RasterCounts {
    pub in_view: u64,
    pub missed: u64,
    pub micro: u64,
    pub pixels: u64,
}

impl RasterCounts {
    fn add(&mut self, other: Self) {
        self.in_view += other.in_view;
        self.missed += other.missed;
        self.micro += other.micro;
        self.pixels += other.pixels;
    }
}

/// A band of the screen: its first row, which is even, and one past its last.
pub(super) struct ScreenBand {
    number: u32,
    pub rows: [i64; 2],
}

impl<'a> BinnedMesh<'a> {
    pub fn new(mesh: &'a Mesh, camera: &Camera, sides: HitSides, job: &Job) -> Result<Self, JobError> {
        let [width, height] = [camera.screen.width_px, camera.screen.height_px];
        let bytes = (u64::from(width) * BYTES_PER_PIXEL).saturating_mul(u64::from(height));
        let rows = mesh.positions().len() * size_of::<RasterVertex>() + mesh.faces().len() * size_of::<f32>();
        // Twice, since parts and their concatenation coexist.
        let bytes_held = bytes.saturating_add(2 * rows as u64);
        if bytes_held > job.memory_limit {
            return Err(too_much(&format!("{width}x{height} pixels need {bytes_held} bytes"), job));
        }
        if width > MOST_PX || height > MOST_PX {
            let message =
                format!("a screen is rasterized with at most {MOST_PX} pixels a side, not {width}x{height}");
            return Err(JobError::Refused(Refusal::new(RefusalCode::Unsupported, message)));
        }
        let mut banded = Self {
            projected: ScreenMesh::new(mesh, camera, job)?,
            sides,
            // Even, so that no quad of two by two pixels is in two bands.
            rows_of_a_band: (BAND_PX / i64::from(width) / 2 * 2).max(2),
            entries: Vec::new(),
            tally: RasterCounts::default(),
        };
        banded.sort(job.memory_limit - bytes_held, job)?;
        Ok(banded)
    }

    /// Counts the triangles and assigns them to their bands, within a number of bytes.
    fn sort(&mut self, bytes_left: u64, job: &Job) -> Result<(), JobError> {
        let n_entries = AtomicU64::new(0);
        let most = bytes_left / size_of::<(u32, u32)>() as u64;
        let n_faces = self.projected.mesh.faces().len();
        let starts: Vec<usize> = (0..n_faces).step_by(CHUNK).collect();
        let chunks = par_map(job, &starts, |_, start| {
            let (mut tally, mut entries) = (RasterCounts::default(), Vec::new());
            // Once over the limit, the count stays over it for any progress of other tasks, so no result
            // depends on the order.
            if !job.is_cancelled() && n_entries.load(Ordering::Relaxed) <= most {
                for face in *start..n_faces.min(start + CHUNK) {
                    let (counts, bands) = self.count_triangle(face);
                    tally.add(counts);
                    entries.extend((bands[0]..bands[1]).map(|band| (band as u32, face as u32)));
                }
                n_entries.fetch_add(entries.len() as u64, Ordering::Relaxed);
                // A stable sort: within a band, triangles stay in order.
                entries.sort_by_key(|entry| entry.0);
            }
            (tally, entries)
        });
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        if n_entries.into_inner() > most {
            return Err(too_much("so many triangles on so many rows need more memory", job));
        }
        for (tally, entries) in chunks {
            self.tally.add(tally);
            self.entries.push(entries);
        }
        Ok(())
    }

    /// The counts of one triangle, and its bands: first, and one past the last.
    fn count_triangle(&self, face: usize) -> (RasterCounts, [i64; 2]) {
        let [width, height] = self.projected.size;
        let (mut in_view, mut area, mut pixels) = (false, 0_i64, 0_i64);
        let mut bands = [i64::MAX, 0];
        self.projected.clipped_triangles(face, |spots| {
            if !box_meets(spots, [width, height]) {
                return;
            }
            let Some(piece) = RasterTriangle::new(spots, [0, 0]) else {
                // Thinner than a step: it has no side that could be culled, and covers nothing.
                in_view = true;
                return;
            };
            if !self.sides.accepts(piece.front) || !piece.meets([width, height]) {
                return;
            }
            in_view = true;
            area = area.saturating_add(piece.area);
            let inside = piece.rows.map(|row| row.clamp(0, height));
            for row in inside[0]..inside[1] {
                let [first, end] = piece.span_within(row, width);
                pixels += end - first;
            }
            // With the rows that shifted centres may reach, so that flicker uses the same bands.
            let ys = spots.map(|spot| i64::from(spot.at[1]));
            let reached =
                [ys[0].min(ys[1]).min(ys[2]) - MOST_SHIFT, ys[0].max(ys[1]).max(ys[2]) + MOST_SHIFT];
            let reached = reached.map(|y| y.div_euclid(STEPS).clamp(0, height - 1) / self.rows_of_a_band);
            bands = [bands[0].min(reached[0]), bands[1].max(reached[1] + 1)];
        });
        let tally = RasterCounts {
            in_view: u64::from(in_view),
            missed: u64::from(in_view && pixels == 0),
            // Areas are doubled.
            micro: u64::from(in_view && area < 2 * STEPS * STEPS),
            pixels: pixels as u64,
        };
        (tally, bands)
    }

    pub fn bands(&self) -> Vec<ScreenBand> {
        let height = self.projected.size[1];
        let starts = (0..height).step_by(self.rows_of_a_band as usize);
        let band = |(number, start): (usize, i64)| ScreenBand {
            number: number as u32,
            rows: [start, height.min(start + self.rows_of_a_band)],
        };
        starts.enumerate().map(band).collect()
    }

    /// Visits the triangles of a band that have area and are not culled, in order, with pixel centres
    /// shifted, and with their rows in the band.
    pub fn for_each_triangle(
        &self,
        band: &ScreenBand,
        shift: [i64; 2],
        mut visit: impl FnMut(u32, &RasterTriangle, [i64; 2]),
    ) {
        for chunk in &self.entries {
            // Entries of a chunk are sorted by band.
            let start = chunk.partition_point(|entry| entry.0 < band.number);
            for (number, face) in &chunk[start..] {
                if *number != band.number {
                    break;
                }
                self.projected.clipped_triangles(*face as usize, |spots| {
                    if let Some(piece) = RasterTriangle::new(spots, shift)
                        && self.sides.accepts(piece.front)
                    {
                        let rows = piece.rows.map(|row| row.clamp(band.rows[0], band.rows[1]));
                        visit(*face, &piece, rows);
                    }
                });
            }
        }
    }

    /// The nearest triangle at each pixel of a band, row by row, or [`NO_FACE`]. Ties go to the first.
    pub fn nearest(&self, band: &ScreenBand, shift: [i64; 2]) -> Vec<u32> {
        let width = self.projected.size[0];
        let n = (width * (band.rows[1] - band.rows[0])) as usize;
        let (mut nearest, mut depth) = (vec![NO_FACE; n], vec![f64::NEG_INFINITY; n]);
        self.for_each_triangle(band, shift, |face, piece, rows| {
            for row in rows[0]..rows[1] {
                let [first, end] = piece.span_within(row, width);
                for column in first..end {
                    let at = ((row - band.rows[0]) * width + column) as usize;
                    let nearness = piece.nearness([column, row]);
                    if nearness > depth[at] {
                        (nearest[at], depth[at]) = (face, nearness);
                    }
                }
            }
        });
        nearest
    }
}

fn too_much(what: &str, job: &Job) -> JobError {
    let message = format!("{what}; the limit is {}", job.memory_limit);
    JobError::Refused(Refusal::new(RefusalCode::TooMuchMemory, message))
}
