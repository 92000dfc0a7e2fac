//! Drawings of planar fields: intervals decide tiles that are all on one side, so pixels are evaluated only
//! along the outline.
use super::camera::{RayGenerator, ray_generator};
use super::color::{Backdrop, PremultipliedColor, srgb_to_linear};
use super::field_picture::{FieldPicture, FieldRenderError, refusal};
use super::options::{Background, RenderOptions, RenderStyle, Viewpoint};
use super::picture::{ImageTile, assemble, each_tile};
use crate::budget::{Camera, Job, Projection, Screen};
use crate::implicit::query::{BeamCounts, contains, normals};
use crate::implicit::{Field, LeafError, Tape};
use crate::math::{Box3, Interval, greater};
use glam::DVec3;

/// The colour of the inside, in sRGB.
const INK: [u8; 3] = [38, 48, 62];
/// Pixels along the side of the first tiles, and of the last ones, which are evaluated pixel by pixel.
const FIRST: u32 = 128;
const LAST: u32 = 8;
/// Sample points along the side of a pixel on the outline, for each of [`RenderOptions::samples`].
const PARTS: u32 = 2;
/// The fraction of the picture that the field's box fills, as usual for drawings.
const FRAMED: f64 = 0.92;

/// Draws a field that does not depend on z.
///
/// Source: M. Keeter, *Massively parallel rendering of complex closed-form implicit surfaces*, 2020.
pub(super) fn draw(
    field: &Field,
    options: &RenderOptions,
    job: &Job,
) -> Result<FieldPicture, FieldRenderError> {
    let camera = match options.viewpoint {
        Viewpoint::Camera(camera) => camera,
        Viewpoint::Automatic(screen) => top_view_camera(&field.bounds(), screen)?,
    };
    let eye = ray_generator(&camera, options, job)?;
    let is_orthographic = matches!(camera.projection, Projection::Orthographic { .. });
    // Parallel rays all have the direction of any one of them.
    let direction = eye.ray([0.0, 0.0]).direction;
    let is_vertical = direction[0] == 0.0 && direction[1] == 0.0;
    if !is_orthographic || !is_vertical {
        let message = "a field in the plane is drawn from straight above: give an orthographic view along z";
        return Err(refusal(message.to_owned()));
    }
    let renderer = DrawingRenderer { eye, options, backdrop: Backdrop::new(camera.screen.height_px) };
    let tiles = ImageTile::all(camera.screen, FIRST);
    let tape = Tape::new(field.sign());
    let (bytes, counts) =
        each_tile(&tiles, job, |tile| renderer.tile(&tape, tile).map_err(FieldRenderError::from))?;
    Ok(FieldPicture { picture: assemble(camera.screen, &tiles, &bytes), camera, counts })
}

/// An orthographic camera along −z onto the whole box.
pub(super) fn top_view_camera(bounds: &Box3, screen: Screen) -> Result<Camera, FieldRenderError> {
    let finite = (0..2).all(|k| bounds.min[k].is_finite() && bounds.max[k].is_finite());
    // Drawings of formulas without bounds are commonly made for this square.
    let (min, max) = if finite { (bounds.min, bounds.max) } else { ([-1.0; 3], [1.0; 3]) };
    let framed = if finite { FRAMED } else { 1.0 };
    let size = |k: usize| max[k] - min[k];
    let aspect = f64::from(screen.height_px) / f64::from(screen.width_px.max(1));
    let by_width = size(0) * aspect;
    let height = greater(by_width, size(1)) / framed;
    if !(height > 0.0 && height.is_finite()) {
        return Err(refusal(format!("the field's box {min:?} to {max:?} has no extent to show")));
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

struct DrawingRenderer<'a> {
    eye: RayGenerator,
    options: &'a RenderOptions,
    backdrop: Backdrop,
}

/// The coverage of a tile, before its pixels are coloured.
struct TileCoverage<'a> {
    /// The fraction of each pixel that is inside, row by row of the first tile.
    cover: &'a mut [f64],
    /// The direction of the gradient, if the inside is coloured by it.
    slopes: &'a mut [[f64; 2]],
    first: ImageTile,
    counts: BeamCounts,
}

impl DrawingRenderer<'_> {
    fn tile(&self, tape: &Tape, tile: ImageTile) -> Result<(Vec<u8>, BeamCounts), LeafError> {
        let n = (tile.size[0] * tile.size[1]) as usize;
        let (mut cover, mut slopes) = (vec![0.0; n], vec![[0.0; 2]; n]);
        let mut coverage = TileCoverage {
            cover: &mut cover,
            slopes: &mut slopes,
            first: tile,
            counts: BeamCounts { beams: n as u64, ..BeamCounts::default() },
        };
        self.divide(tape, tile, &mut coverage)?;
        let counts = coverage.counts;
        let mut bytes = Vec::with_capacity(4 * n);
        for (k, [_, y]) in tile.pixels().enumerate() {
            bytes.extend(self.pixel(y, cover[k], slopes[k]));
        }
        Ok((bytes, counts))
    }

    /// The part of the plane that a tile shows.
    fn bounds(&self, tile: ImageTile) -> Box3 {
        let [x, y] = tile.at.map(f64::from);
        let [w, h] = tile.size.map(f64::from);
        let corners = [[x, y], [x + w, y + h], [x, y + h], [x + w, y]];
        Box3::from_points(&corners.map(|at| self.point_at(at)))
    }

    fn divide(&self, tape: &Tape, tile: ImageTile, coverage: &mut TileCoverage) -> Result<(), LeafError> {
        let bounds = self.bounds(tile);
        let (range, shorter) = tape.prune(&bounds)?;
        match certain_side(&range) {
            Some(false) => return Ok(()),
            // Normals are shown per pixel, so a tile of the inside cannot be filled with one value.
            Some(true) if self.options.show != RenderStyle::Normals => {
                for_each_pixel(tile, coverage.first, |k| coverage.cover[k] = 1.0);
                coverage.counts.hits += u64::from(tile.size[0] * tile.size[1]);
                return Ok(());
            }
            _ => {}
        }
        // Below, the shorter expression is enough: it is equal on the whole tile.
        let tape = shorter.as_ref().unwrap_or(tape);
        if tile.size[0] <= LAST && tile.size[1] <= LAST {
            return self.pixels(tape, tile, coverage);
        }
        for part in quarters(tile) {
            self.divide(tape, part, coverage)?;
        }
        Ok(())
    }

    /// Covers the pixels of a last tile: by an interval if that puts the pixel on one side, else by the signs at
    /// several of its points.
    ///
    /// A ramp from value and gradient would be cheaper. But if two parts of a drawing touch, the value is
    /// 0 between them, and such a ramp shows seams.
    fn pixels(&self, tape: &Tape, tile: ImageTile, coverage: &mut TileCoverage) -> Result<(), LeafError> {
        let pixels: Vec<[u32; 2]> = tile.pixels().collect();
        let boxes: Vec<Box3> =
            pixels.iter().map(|at| self.bounds(ImageTile { at: *at, size: [1, 1] })).collect();
        let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
        tape.over(&boxes, &mut ranges)?;
        let side = (PARTS * self.options.samples) as usize;
        let part = |i: usize| (i as f64 + 0.5) / side as f64;
        let mut index = Vec::with_capacity(pixels.len());
        for_each_pixel(tile, coverage.first, |k| index.push(k));
        let (mut open, mut points) = (Vec::new(), Vec::new());
        for (i, [x, y]) in pixels.iter().enumerate() {
            match certain_side(&ranges[i]) {
                Some(inside) => coverage.cover[index[i]] = f64::from(u8::from(inside)),
                None => {
                    coverage.counts.uncertain += u64::from(ranges[i].is_entire());
                    open.push(index[i]);
                    let offsets = (0..side * side).map(|k| [part(k % side), part(k / side)]);
                    points
                        .extend(offsets.map(|[u, v]| self.point_at([f64::from(*x) + u, f64::from(*y) + v])));
                }
            }
        }
        for (k, inside) in open.into_iter().zip(contains(tape, &points)?.chunks_exact(side * side)) {
            let n = inside.iter().filter(|inside| **inside).count();
            coverage.cover[k] = n as f64 / inside.len() as f64;
        }
        coverage.counts.hits += index.iter().filter(|k| coverage.cover[**k] > 0.0).count() as u64;
        if self.options.show == RenderStyle::Normals {
            let middles: Vec<[f64; 3]> = pixels
                .iter()
                .map(|[x, y]| self.point_at([f64::from(*x) + 0.5, f64::from(*y) + 0.5]))
                .collect();
            for (k, normal) in index.into_iter().zip(normals(tape, &middles)?) {
                coverage.slopes[k] = normal.map_or([0.0; 2], |n| [n[0], n[1]]);
            }
        }
        Ok(())
    }

    /// The point in the plane that a position in the picture shows.
    fn point_at(&self, at: [f64; 2]) -> [f64; 3] {
        let p = self.eye.ray(at).origin;
        [p[0], p[1], 0.0]
    }

    fn pixel(&self, y: u32, cover: f64, slope: [f64; 2]) -> [u8; 4] {
        let normals = self.options.show == RenderStyle::Normals;
        let ink = if normals {
            DVec3::new(slope[0], slope[1], 0.0) * 0.5 + DVec3::splat(0.5)
        } else {
            srgb_to_linear(INK)
        };
        let sample = if self.options.background == Background::Studio {
            let paper = if normals { DVec3::ONE } else { self.backdrop.at(y) };
            PremultipliedColor { color: paper.lerp(ink, cover), alpha: 1.0 }
        } else {
            PremultipliedColor { color: ink * cover, alpha: cover }
        };
        sample.bytes(1, self.options.show)
    }
}

/// Whether all points are inside, or none is; `None` if the interval does not decide.
fn certain_side(range: &Interval) -> Option<bool> {
    if range.is_empty() || range.lo() >= 0.0 {
        return Some(false);
    }
    (range.hi() < 0.0 && range.is_defined()).then_some(true)
}

fn for_each_pixel(tile: ImageTile, first: ImageTile, mut f: impl FnMut(usize)) {
    for [x, y] in tile.pixels() {
        f(((y - first.at[1]) * first.size[0] + (x - first.at[0])) as usize);
    }
}

fn quarters(tile: ImageTile) -> Vec<ImageTile> {
    let ([x, y], [w, h]) = (tile.at, tile.size);
    let halves = |at: u32, size: u32| {
        let first = size.div_ceil(2);
        [[at, first], [at + first, size - first]]
    };
    let (across, down) = (halves(x, w), halves(y, h));
    let pairs =
        down.into_iter().flat_map(|[y, h]| across.map(|[x, w]| ImageTile { at: [x, y], size: [w, h] }));
    pairs.filter(|tile| tile.size[0] > 0 && tile.size[1] > 0).collect()
}
