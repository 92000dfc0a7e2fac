//! `Picture`: a rendered image, and its tiles, which are rendered in parallel.
use crate::budget::{Job, JobError, Progress, Screen, par_map};
use crate::implicit::query::BeamCounts;
use std::sync::atomic::{AtomicU64, Ordering};

/// An image of 8-bit sRGB colours with straight (not premultiplied) alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Four bytes per pixel, row by row from the top left: red, green, blue, alpha.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// Red, green, blue and alpha of the pixel in column `x` of row `y`.
    ///
    /// # Panics
    /// If there is no such pixel.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width && y < self.height, "({x}, {y}) is outside {} x {}", self.width, self.height);
        let at = 4 * (y as usize * self.width as usize + x as usize);
        [self.rgba[at], self.rgba[at + 1], self.rgba[at + 2], self.rgba[at + 3]]
    }

    /// Whether every pixel is fully opaque.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.rgba.chunks_exact(4).all(|pixel| pixel[3] == 255)
    }
}

/// A part of the picture: its first column and row, and its size.
#[derive(Clone, Copy)]
pub(super) struct ImageTile {
    pub at: [u32; 2],
    pub size: [u32; 2],
}

impl ImageTile {
    /// All tiles of a picture, row by row.
    pub fn all(screen: Screen, side: u32) -> Vec<Self> {
        let Screen { width_px, height_px } = screen;
        let rows = (0..height_px).step_by(side as usize);
        let at = rows.flat_map(|y| (0..width_px).step_by(side as usize).map(move |x| [x, y]));
        at.map(|[x, y]| Self { at: [x, y], size: [side.min(width_px - x), side.min(height_px - y)] })
            .collect()
    }

    pub fn pixels(self) -> impl Iterator<Item = [u32; 2]> {
        let ([x, y], [w, h]) = (self.at, self.size);
        (y..y + h).flat_map(move |y| (x..x + w).map(move |x| [x, y]))
    }
}

/// Copies the bytes of tiles into the picture.
pub(super) fn assemble(screen: Screen, tiles: &[ImageTile], bytes: &[Vec<u8>]) -> Picture {
    let Screen { width_px: width, height_px: height } = screen;
    let mut rgba = vec![0; 4 * width as usize * height as usize];
    for (tile, bytes) in tiles.iter().zip(bytes) {
        let length = 4 * tile.size[0] as usize;
        for (row, line) in bytes.chunks_exact(length).enumerate() {
            let at = 4 * ((tile.at[1] as usize + row) * width as usize + tile.at[0] as usize);
            rgba[at..at + length].copy_from_slice(line);
        }
    }
    Picture { width, height, rgba }
}

/// Calls `work` for each tile, with progress reports; it returns the tile's bytes and counts.
pub(super) fn each_tile<E: From<JobError> + Send>(
    tiles: &[ImageTile],
    job: &Job,
    work: impl Fn(ImageTile) -> Result<(Vec<u8>, BeamCounts), E> + Sync,
) -> Result<(Vec<Vec<u8>>, BeamCounts), E> {
    let done = AtomicU64::new(0);
    let results = par_map(job, tiles, |_, tile| {
        if job.is_cancelled() {
            return Ok((Vec::new(), BeamCounts::default()));
        }
        let result = work(*tile);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        job.report(Progress { stage: "render", done, total: tiles.len() as u64 });
        result
    });
    if job.is_cancelled() {
        return Err(JobError::Cancelled.into());
    }
    let mut counts = BeamCounts::default();
    let mut bytes = Vec::with_capacity(tiles.len());
    for result in results {
        let (tile_bytes, count) = result?;
        bytes.push(tile_bytes);
        counts = counts.merge(count);
    }
    Ok((bytes, counts))
}
