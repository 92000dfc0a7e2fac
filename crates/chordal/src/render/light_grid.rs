//! `LightGrid`: the light that reaches the pixels of a tile, traced at few of them and interpolated between
//! them wherever the surface is smooth and the light hardly changes.
//!
//! Source: G. Ward, F. Rubinstein, R. Clear, *A ray tracing solution for diffuse interreflection*, 1988, for
//! light that is cached and interpolated; here a quadtree of pixels replaces the cache, so that no order
//! matters.
use super::light::{LightShares, LitPoint, StudioLights};
use super::sample_pattern::{LightDetail, SamplePattern};
use super::traced_surface::{SeenPoint, TracedSurface};
use crate::math::{greater, lesser};

/// Pixels along the largest cells of the quadtree.
pub(super) const CELL: usize = 8;
/// Cells up to this size may contain edges: then each pixel uses the corners on its side of the edge.
const SMALL: usize = 4;
/// The widest range of shares over the corners of a cell that is interpolated, for cells of 8, 4 and 2
/// pixels: the smaller the cell, the less visible a kink inside it. Chosen by comparison side by side with
/// every pixel traced.
const RANGE: [f64; 3] = [0.08, 0.11, 0.16];

/// A rectangle of pixels: those of a tile, rounded up to whole cells, with one more on each side.
#[derive(Clone, Copy)]
pub(super) struct TileFrame {
    /// The first pixel, one left of and above the tile; may be −1.
    pub first: [i64; 2],
    /// Pixels along x and y, with the border.
    pub size: [usize; 2],
}

impl TileFrame {
    /// The index of a column and a row, counted from `first`.
    pub fn index(&self, [i, j]: [usize; 2]) -> usize {
        j * self.size[0] + i
    }

    /// The pixel of the picture.
    pub fn pixel(&self, index: usize) -> [i64; 2] {
        let [i, j] = [index % self.size[0], index / self.size[0]].map(|k| k as i64);
        [self.first[0] + i, self.first[1] + j]
    }

    pub fn len(&self) -> usize {
        self.size[0] * self.size[1]
    }
}

/// The data that light the pixels and do not change from tile to tile.
pub(super) struct LightSource<'a, S> {
    pub surface: &'a S,
    pub studio: &'a StudioLights,
    pub pattern: &'a SamplePattern,
}

/// The points that the pixels of a frame see.
pub(super) struct SeenPixels<'a> {
    pub frame: TileFrame,
    pub seen: &'a [SeenPoint],
    /// The pixels next to which the surface ends.
    pub edge: &'a [bool],
}

/// The light of each pixel, as far as it has been computed.
pub(super) struct LightGrid {
    pub shares: Vec<Option<LightShares>>,
}

/// A cell of the quadtree: its first column and row, and the shift of its size.
#[derive(Clone, Copy)]
struct LightCell {
    at: [usize; 2],
    side: usize,
}

impl LightCell {
    fn corners(self) -> [[usize; 2]; 4] {
        let ([i, j], n) = (self.at, self.side);
        [[i, j], [i + n, j], [i, j + n], [i + n, j + n]]
    }
}

impl LightGrid {
    /// The light of all pixels of a tile except its border.
    pub fn new<S: TracedSurface>(source: &LightSource<S>, pixels: &SeenPixels) -> Result<Self, S::Error> {
        let SeenPixels { frame, seen, .. } = *pixels;
        let mut grid = Self { shares: vec![None; frame.len()] };
        let starts = |n: usize| (1..n - 1).step_by(CELL);
        let mut cells: Vec<LightCell> = starts(frame.size[1])
            .flat_map(|j| starts(frame.size[0]).map(move |i| LightCell { at: [i, j], side: CELL }))
            .collect();
        while !cells.is_empty() {
            let detail = if cells[0].side > 1 { LightDetail::Area } else { LightDetail::Pixel };
            let mut needed: Vec<usize> =
                cells.iter().flat_map(|c| c.corners()).map(|p| frame.index(p)).collect();
            if detail == LightDetail::Pixel {
                // A cell of one pixel needs the light of that pixel alone.
                needed = cells.iter().map(|c| frame.index(c.at)).collect();
            }
            needed.sort_unstable();
            needed.dedup();
            // Neighbouring cells share corners, and small cells those of the larger ones: each is
            // traced once.
            needed.retain(|k| grid.shares[*k].is_none() && !matches!(seen[*k], SeenPoint::Nothing));
            let traced = shares_at(source, pixels, &needed, detail)?;
            for (k, shares) in needed.into_iter().zip(traced) {
                grid.shares[k] = Some(shares);
            }
            let mut parts = Vec::new();
            for cell in cells.into_iter().filter(|cell| cell.side > 1) {
                if !grid.interpolate(cell, pixels) {
                    let half = cell.side / 2;
                    let [i, j] = cell.at;
                    let quarters = [[i, j], [i + half, j], [i, j + half], [i + half, j + half]];
                    parts.extend(quarters.map(|at| LightCell { at, side: half }));
                }
            }
            cells = parts;
        }
        Ok(grid)
    }

    /// Fills the pixels of a cell whose light follows from its corners; returns whether these are all of its
    /// pixels.
    fn interpolate(&mut self, cell: LightCell, pixels: &SeenPixels) -> bool {
        let SeenPixels { frame, seen, edge } = *pixels;
        let corners = cell.corners().map(|p| frame.index(p));
        let n = cell.side;
        // Shadows change quickly beside edges, where one part stands on another, so the largest cells avoid
        // them.
        let margin = if n > SMALL { n / 2 } else { 0 };
        let span = |at: usize, size: usize| at.saturating_sub(margin)..=(at + n + margin).min(size - 1);
        let [columns, rows] = [0, 1].map(|k| span(cell.at[k], frame.size[k]));
        let even = (1..4).all(|k| seen[corners[0]].is_one_with(&seen[corners[k]]))
            && !rows.flat_map(|j| columns.clone().map(move |i| [i, j])).any(|p| edge[frame.index(p)]);
        if !even && n > SMALL {
            return false;
        }
        // Where nothing is seen, no light is needed.
        if even && matches!(seen[corners[0]], SeenPoint::Nothing) {
            return true;
        }
        let range = RANGE[(CELL.ilog2() - n.ilog2()) as usize];
        let at_corners = corners.map(|k| self.shares[k]);
        if even && spread(&at_corners) > range {
            return false;
        }
        // What is filled here stays; the quarters of the cell fill only the rest.
        let mut is_filled = true;
        for [i, j] in (0..n).flat_map(|j| (0..n).map(move |i| [i, j])) {
            let k = frame.index([cell.at[0] + i, cell.at[1] + j]);
            if self.shares[k].is_some() || matches!(seen[k], SeenPoint::Nothing) {
                continue;
            }
            // In a cell with an edge, only corners on the pixel's side of it count.
            let of_corner =
                |c: usize| at_corners[c].filter(|_| even || seen[corners[c]].is_one_with(&seen[k]));
            let same_surface: [Option<LightShares>; 4] = std::array::from_fn(of_corner);
            let [u, v] = [i, j].map(|k| k as f64 / n as f64);
            let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
            self.shares[k] =
                if even || spread(&same_surface) <= range { weighted(same_surface, weights) } else { None };
            is_filled &= self.shares[k].is_some();
        }
        is_filled
    }

    /// The light at a position between the middles of pixels, from those around it that show the same
    /// surface; `None` if none does.
    pub fn at(&self, [x, y]: [f64; 2], point: &SeenPoint, pixels: &SeenPixels) -> Option<LightShares> {
        let SeenPixels { frame, seen, .. } = *pixels;
        let (i, j) = (x.floor(), y.floor());
        let (u, v) = (x - i, y - j);
        let (i, j) = (i as usize, j as usize);
        let around = [
            ([i, j], (1.0 - u) * (1.0 - v)),
            ([i + 1, j], u * (1.0 - v)),
            ([i, j + 1], (1.0 - u) * v),
            ([i + 1, j + 1], u * v),
        ];
        let same_surface = around.map(|([i, j], _)| {
            let k = (i < frame.size[0] && j < frame.size[1]).then(|| frame.index([i, j]))?;
            self.shares[k].filter(|_| seen[k].is_one_with(point))
        });
        weighted(same_surface, around.map(|(_, weight)| weight))
    }
}

/// The least weight of pixels from which light is interpolated: pixels farther away say little.
const LEAST_WEIGHT: f64 = 0.05;

/// The weighted mean of the known shares; `None` if these have next to no weight.
fn weighted(shares: [Option<LightShares>; 4], weights: [f64; 4]) -> Option<LightShares> {
    let known_weights: [f64; 4] = std::array::from_fn(|k| if shares[k].is_some() { weights[k] } else { 0.0 });
    let sum: f64 = known_weights.iter().sum();
    let mean = || LightShares::mean(shares.map(Option::unwrap_or_default), known_weights.map(|w| w / sum));
    (sum > LEAST_WEIGHT).then(mean)
}

/// The range of the known shares.
fn spread(shares: &[Option<LightShares>; 4]) -> f64 {
    let range = |f: fn(&LightShares) -> f64| {
        let values = || shares.iter().flatten().map(f);
        let most = values().fold(f64::NEG_INFINITY, |m, x| greater(x, m));
        most - values().fold(f64::INFINITY, |m, x| lesser(x, m))
    };
    greater(range(|s| s.sky), range(|s| s.lamp))
}

/// The light of some pixels, traced together.
fn shares_at<S: TracedSurface>(
    source: &LightSource<S>,
    pixels: &SeenPixels,
    needed: &[usize],
    detail: LightDetail,
) -> Result<Vec<LightShares>, S::Error> {
    let LightSource { surface, studio, pattern } = *source;
    let turned = |k: usize| {
        if detail == LightDetail::Area {
            pattern.unturned()
        } else {
            pattern.for_pixel(pixels.frame.pixel(k))
        }
    };
    let points: Vec<(usize, LitPoint)> = needed
        .iter()
        .filter_map(|k| Some((*k, pixels.seen[*k].lit(studio, surface.ray_offset())?)))
        .collect();
    let mut shares = surface.with_occlusion(|shadows| {
        let first = |(k, point): &(usize, LitPoint)| {
            let turned = turned(*k);
            studio.shares(shadows, point, turned.whole_sky(detail, point.normal), turned.rim())
        };
        points.iter().map(first).collect::<Vec<LightShares>>()
    })?;
    // If the whole rim is visible, or hidden, so is the lamp; only the other points need all rays.
    let open: Vec<usize> =
        (0..shares.len()).filter(|k| shares[*k].lamp > 0.0 && shares[*k].lamp < 1.0).collect();
    let lamps = surface.with_occlusion(|shadows| {
        let whole_lamp = |k: &usize| {
            let (index, point) = &points[*k];
            let turned = turned(*index);
            studio.lamp_sum(shadows, point, turned.whole_lamp(detail)).share()
        };
        open.iter().map(whole_lamp).collect::<Vec<f64>>()
    })?;
    for (k, lamp) in open.into_iter().zip(lamps) {
        shares[k].lamp = lamp;
    }
    Ok(shares)
}
