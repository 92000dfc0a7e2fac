//! A field in the plane as a drawing: tiles that are all one side by ranges, and pixels only along the outline.
use super::color::light;
use super::eye::Eye;
use super::field::{FieldPicture, NotDrawn, Tile, assemble, each_tile, refused};
use super::options::{Background, Options, Show, Viewpoint};
use super::trace::{Sample, backdrop, ready};
use crate::budget::{Camera, Job, Projection, Screen};
use crate::implicit::query::Counts;
use crate::implicit::{Field, LeafError, Slope, Tape};
use crate::math::{Box3, Interval};
use glam::DVec3;

/// The colour of the inside, in sRGB.
const INK: [u8; 3] = [38, 48, 62];
/// Pixels along the side of the first tiles, and of the last ones, which are evaluated pixel by pixel.
const FIRST: u32 = 128;
const LAST: u32 = 8;
/// The share of the picture that the field's box takes, as for drawings.
const FRAMED: f64 = 0.92;

/// The drawing of a field without z.
///
/// Source: M. Keeter, *Massively parallel rendering of complex closed-form implicit surfaces*, 2020.
pub(super) fn draw(field: &Field, options: &Options, job: &Job) -> Result<FieldPicture, NotDrawn> {
    let camera = match options.viewpoint {
        Viewpoint::Camera(camera) => camera,
        Viewpoint::Automatic(screen) => above(&field.bounds(), screen)?,
    };
    let eye = ready(&camera, options, job)?;
    let straight = matches!(camera.projection, Projection::Orthographic { .. });
    let level = |at: [f64; 2]| {
        let d = eye.ray(at).direction;
        d[0] == 0.0 && d[1] == 0.0
    };
    if !straight || !level([0.0, 0.0]) {
        let message = "a field in the plane is drawn from straight above: give an orthographic view along z";
        return Err(refused(message.to_owned()));
    }
    let sheet = Sheet { eye, options, screen: camera.screen, side: options.samples };
    let tiles = Tile::all(camera.screen, FIRST);
    let tape = Tape::of(field.sign());
    let (bytes, counts) = each_tile(&tiles, job, |tile| sheet.tile(&tape, tile))?;
    Ok(FieldPicture { picture: assemble(camera.screen, &tiles, &bytes), camera, counts })
}

/// Parallel rays along −z onto the whole box.
fn above(place: &Box3, screen: Screen) -> Result<Camera, NotDrawn> {
    let finite = (0..2).all(|k| place.min[k].is_finite() && place.max[k].is_finite());
    // Drawings by rule are commonly made for this square where they do not say.
    let (min, max) = if finite { (place.min, place.max) } else { ([-1.0; 3], [1.0; 3]) };
    let framed = if finite { FRAMED } else { 1.0 };
    let size = |k: usize| max[k] - min[k];
    let aspect = f64::from(screen.height_px) / f64::from(screen.width_px.max(1));
    let by_width = size(0) * aspect;
    let height = if by_width > size(1) { by_width } else { size(1) } / framed;
    if !(height > 0.0 && height.is_finite()) {
        return Err(refused(format!("the field's box {min:?} to {max:?} has no extent to show")));
    }
    let middle = |k: usize| min[k] / 2.0 + max[k] / 2.0;
    Ok(Camera {
        eye: [middle(0), middle(1), height],
        target: [middle(0), middle(1), 0.0],
        up: [0.0, 1.0, 0.0],
        near: 0.0,
        projection: Projection::Orthographic { height },
        screen,
    })
}

struct Sheet<'a> {
    eye: Eye,
    options: &'a Options,
    screen: Screen,
    side: u32,
}

/// What a tile is, before it is drawn.
struct Inked<'a> {
    /// How much of each pixel is inside, row by row of the first tile.
    cover: &'a mut [f64],
    /// The gradient's direction where the inside is coloured by it.
    slopes: &'a mut [[f64; 2]],
    first: Tile,
    counts: Counts,
}

impl Sheet<'_> {
    fn tile(&self, tape: &Tape, tile: Tile) -> Result<(Vec<u8>, Counts), LeafError> {
        let n = (tile.size[0] * tile.size[1]) as usize;
        let (mut cover, mut slopes) = (vec![0.0; n], vec![[0.0; 2]; n]);
        let mut inked = Inked {
            cover: &mut cover,
            slopes: &mut slopes,
            first: tile,
            counts: Counts { beams: n as u64, ..Counts::default() },
        };
        self.divide(tape, tile, &mut inked)?;
        let counts = inked.counts;
        let mut bytes = Vec::with_capacity(4 * n);
        for (k, [_, y]) in tile.pixels().enumerate() {
            bytes.extend(self.pixel(y, cover[k], slopes[k]));
        }
        Ok((bytes, counts))
    }

    /// The part of the plane that a tile shows, with half a pixel around it for the ramps at its border.
    fn bounds(&self, tile: Tile) -> Box3 {
        let [x, y] = tile.at.map(f64::from);
        let [w, h] = tile.size.map(f64::from);
        let corners =
            [[x - 0.5, y - 0.5], [x + w + 0.5, y + h + 0.5], [x - 0.5, y + h + 0.5], [x + w + 0.5, y - 0.5]];
        let flat = |at: [f64; 2]| {
            let p = self.eye.ray(at).origin;
            [p[0], p[1], 0.0]
        };
        Box3::around(&corners.map(flat))
    }

    fn divide(&self, tape: &Tape, tile: Tile, inked: &mut Inked) -> Result<(), LeafError> {
        let bounds = self.bounds(tile);
        let (range, shorter) = tape.shortened(&bounds)?;
        let inside = range.hi() < 0.0 && range.is_defined() && !range.is_empty();
        if range.is_empty() || range.lo() >= 0.0 || inside && self.options.show != Show::Normals {
            if inside {
                self.each(tile, inked.first, |k| inked.cover[k] = 1.0);
                inked.counts.hits += u64::from(tile.size[0] * tile.size[1]);
            }
            return Ok(());
        }
        let tape = shorter.as_ref().unwrap_or(tape);
        if tile.size[0] <= LAST && tile.size[1] <= LAST {
            return self.pixels(tape, tile, inked);
        }
        for part in quarters(tile) {
            self.divide(tape, part, inked)?;
        }
        Ok(())
    }

    fn each(&self, tile: Tile, first: Tile, mut f: impl FnMut(usize)) {
        for [x, y] in tile.pixels() {
            f(((y - first.at[1]) * first.size[0] + (x - first.at[0])) as usize);
        }
    }

    /// The last tiles: pixels that the gradient shows to be far from the outline by one value, others by several.
    fn pixels(&self, tape: &Tape, tile: Tile, inked: &mut Inked) -> Result<(), LeafError> {
        let at = |[x, y]: [f64; 2]| {
            let p = self.eye.ray([x, y]).origin;
            [p[0], p[1], 0.0]
        };
        let step = (at([1.0, 0.0])[0] - at([0.0, 0.0])[0]).abs();
        let middles: Vec<[f64; 3]> =
            tile.pixels().map(|[x, y]| at([f64::from(x) + 0.5, f64::from(y) + 0.5])).collect();
        let boxes: Vec<Box3> = tile.pixels().map(|at| self.bounds(Tile { at, size: [1, 1] })).collect();
        let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
        tape.over(&boxes, &mut ranges)?;
        let side = self.side as usize;
        let parts = (0..side * side).map(|i| [i % side, i / side].map(|i| (i as f64 + 0.5) / side as f64));
        let parts: Vec<[f64; 2]> = parts.collect();
        let mut open = Vec::new();
        let mut points = Vec::new();
        let mut index = Vec::new();
        self.each(tile, inked.first, |k| index.push(k));
        for (i, pixel) in tile.pixels().enumerate() {
            let range = ranges[i];
            if range.is_empty() || range.lo() >= 0.0 {
                continue;
            }
            inked.counts.hits += 1;
            if range.hi() < 0.0 && range.is_defined() && self.options.show != Show::Normals {
                inked.cover[index[i]] = 1.0;
                continue;
            }
            inked.counts.uncertain += u64::from(range.is_entire());
            open.push(i);
            points.extend(parts.iter().map(|[u, v]| at([f64::from(pixel[0]) + u, f64::from(pixel[1]) + v])));
        }
        let mut values = vec![Slope { value: 0.0, gradient: [0.0; 3] }; points.len()];
        tape.gradient_at(&points, &mut values)?;
        for (i, values) in open.into_iter().zip(values.chunks_exact(parts.len())) {
            let sum: f64 = values.iter().map(|slope| ramp(slope, step / side as f64)).sum();
            inked.cover[index[i]] = sum / parts.len() as f64;
            let g = values[parts.len() / 2].gradient;
            let length = (g[0] * g[0] + g[1] * g[1]).sqrt();
            let unit = [g[0] / length, g[1] / length];
            inked.slopes[index[i]] = if unit[0].is_finite() { unit } else { [0.0; 2] };
        }
        let _ = middles;
        Ok(())
    }

    fn pixel(&self, y: u32, cover: f64, slope: [f64; 2]) -> [u8; 4] {
        let normals = self.options.show == Show::Normals;
        let ink =
            if normals { DVec3::new(slope[0], slope[1], 0.0) * 0.5 + DVec3::splat(0.5) } else { light(INK) };
        let sample = if self.options.background == Background::Studio {
            let paper = if normals { DVec3::ONE } else { backdrop(y, self.screen.height_px) };
            Sample { color: paper.lerp(ink, cover), alpha: 1.0 }
        } else {
            Sample { color: ink * cover, alpha: cover }
        };
        sample.bytes(1, self.options.show)
    }
}

/// How much of a square of that side is inside, from the value and the gradient in its middle.
fn ramp(slope: &Slope<f64>, side: f64) -> f64 {
    let [gx, gy, _] = slope.gradient;
    let reach = (gx * gx + gy * gy).sqrt() * side;
    let share = 0.5 - slope.value / reach;
    if share.is_finite() {
        if share > 0.0 { if share < 1.0 { share } else { 1.0 } } else { 0.0 }
    } else {
        f64::from(u8::from(slope.value < 0.0))
    }
}

fn quarters(tile: Tile) -> Vec<Tile> {
    let ([x, y], [w, h]) = (tile.at, tile.size);
    let halves = |at: u32, size: u32| {
        let first = size.div_ceil(2);
        [[at, first], [at + first, size - first]]
    };
    let (across, down) = (halves(x, w), halves(y, h));
    let pairs = down.into_iter().flat_map(|[y, h]| across.map(|[x, w]| Tile { at: [x, y], size: [w, h] }));
    pairs.filter(|tile| tile.size[0] > 0 && tile.size[1] > 0).collect()
}
