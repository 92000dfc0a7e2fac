//! `TileRenderer`: the pixels of one tile. The ray through the middle of each decides what it shows; only
//! pixels beside edges, and those whose colour differs from their neighbours', get all their rays.
use super::Picture;
use super::camera::RayGenerator;
use super::color::{Backdrop, PremultipliedColor};
use super::heat_map::HeatMap;
use super::light::{LightShares, OcclusionTest, ShadingPoint, StudioLights};
use super::light_grid::{CELL, LightGrid, LightSource, SeenPixels, TileFrame};
use super::options::{Background, RenderOptions, RenderStyle};
use super::picture::{ImageTile, assemble, each_tile};
use super::sample_pattern::SamplePattern;
use super::traced_surface::{SeenPoint, TracedSurface, direction_of};
use super::zebra::zebra_color;
use crate::budget::{Job, Screen};
use crate::explicit::Ray;
use crate::implicit::query::BeamCounts;
use crate::math::{greater, lesser};
use glam::DVec3;

/// Pixels along a tile's side: enough that its border costs little, few enough for caches and threads.
const TILE: u32 = 96;
/// The width of lines in pixels.
const LINE_PX: f64 = 1.3;
/// The width over which a line's side fades out: less than a pixel, so that lines are as smooth as outlines.
const LINE_SOFT_PX: f64 = 0.5;
/// A pixel with a neighbour whose channels differ by more than this fraction, plus a small part of white,
/// gets all its rays: some six levels of 255 in the middle of the range.
const SEEN_CHANGE: [f64; 2] = [0.06, 0.004];
/// Lines at this depth relative to that of the middle ray are in front of it: above the rounding of stored depths.
const IN_FRONT: f64 = 1.001;

/// Renders tiles of a picture of a surface.
pub(super) struct TileRenderer<'a, S> {
    pub surface: S,
    pub studio: StudioLights,
    pub eye: RayGenerator,
    pub pattern: SamplePattern,
    pub options: &'a RenderOptions,
    pub screen: Screen,
    pub backdrop: Backdrop,
    pub heat: Option<HeatMap>,
    /// The colour of lines along the triangles' edges, if these are shown.
    pub lines: Option<DVec3>,
}

/// One of the picture's rays.
#[derive(Clone, Copy)]
struct PictureRay<'a> {
    ray: &'a Ray,
    seen: &'a SeenPoint,
    shares: LightShares,
    row: u32,
}

/// A pixel that gets all its rays: its index in the frame, and its column and row.
type FinePixel = (usize, [u32; 2]);

impl<S: TracedSurface> TileRenderer<'_, S> {
    /// The whole picture.
    pub fn picture(&self, job: &Job) -> Result<(Picture, BeamCounts), S::Error> {
        let tiles = ImageTile::all(self.screen, TILE);
        let (bytes, counts) = each_tile(&tiles, job, |tile| self.tile(tile))?;
        Ok((assemble(self.screen, &tiles, &bytes), counts))
    }

    /// The bytes of a tile, row by row.
    pub fn tile(&self, tile: ImageTile) -> Result<(Vec<u8>, BeamCounts), S::Error> {
        let mut counts = BeamCounts::default();
        // 1. The points that the middles of the pixels see, and the edges between them.
        let frame = TileFrame {
            first: tile.at.map(|k| i64::from(k) - 1),
            // A multiple of the largest cells, so that every cell is whole, and one pixel more on
            // each side for neighbours.
            size: tile.size.map(|n| (n as usize).next_multiple_of(CELL) + 2),
        };
        let rays: Vec<Ray> = (0..frame.len()).map(|k| self.middle_ray(frame.pixel(k))).collect();
        let (seen, uncertain) = self.see(&rays, &mut counts)?;
        let edge = self.edges(frame, &seen, &uncertain);
        let pixels = SeenPixels { frame, seen: &seen, edge: &edge };
        // 2. Their light, traced at few pixels.
        let source = LightSource { surface: &self.surface, studio: &self.studio, pattern: &self.pattern };
        let light = if self.is_lit() {
            LightGrid::new(&source, &pixels)?
        } else {
            LightGrid { shares: vec![None; frame.len()] }
        };
        // 3. Their colours.
        let tile_pixels: Vec<(usize, [u32; 2])> = tile
            .pixels()
            .map(|[x, y]| {
                (frame.index([(x - tile.at[0]) as usize + 1, (y - tile.at[1]) as usize + 1]), [x, y])
            })
            .collect();
        let shown: Vec<PictureRay> = tile_pixels
            .iter()
            .map(|(k, [_, row])| PictureRay {
                ray: &rays[*k],
                seen: &seen[*k],
                shares: light.shares[*k].unwrap_or_default(),
                row: *row,
            })
            .collect();
        let colors = self.colors(&shown)?;
        // 4. All rays of the pixels for which one is not enough.
        let fine: Vec<bool> = (0..tile_pixels.len())
            .map(|p| edge[tile_pixels[p].0] || self.is_lined(&shown[p]) || changes(&colors, tile.size, p))
            .collect();
        let to_refine: Vec<FinePixel> =
            tile_pixels.iter().zip(&fine).filter(|(_, fine)| **fine).map(|(pixel, _)| *pixel).collect();
        let mut fine_bytes = self.fine_pixels(&to_refine, &pixels, &light, &mut counts)?.into_iter();
        let mut bytes = Vec::with_capacity(4 * tile_pixels.len());
        for (color, fine) in colors.into_iter().zip(fine) {
            let exact = if fine { fine_bytes.next() } else { None };
            bytes.extend(exact.unwrap_or_else(|| {
                let mut sum = PremultipliedColor::NOTHING;
                sum.add(color);
                sum.bytes(1, self.options.show)
            }));
        }
        Ok((bytes, counts))
    }

    fn middle_ray(&self, [x, y]: [i64; 2]) -> Ray {
        self.eye.ray([x as f64 + 0.5, y as f64 + 0.5])
    }

    /// Whether the light of surfaces and ground is rendered.
    fn is_lit(&self) -> bool {
        !matches!(self.options.show, RenderStyle::Normals | RenderStyle::Zebra)
    }

    fn has_ground(&self) -> bool {
        self.options.background != Background::Transparent
            && matches!(self.options.show, RenderStyle::Shaded | RenderStyle::Flat)
    }

    fn see(&self, rays: &[Ray], counts: &mut BeamCounts) -> Result<(Vec<SeenPoint>, Vec<bool>), S::Error> {
        let hits = self.surface.trace(rays, counts)?;
        let seen = |(ray, spot): (&Ray, Option<ShadingPoint>)| match spot {
            Some(spot) => SeenPoint::Surface(spot),
            None if self.has_ground() => self
                .studio
                .ground(DVec3::from(ray.origin), direction_of(ray))
                .map_or(SeenPoint::Nothing, SeenPoint::Ground),
            None => SeenPoint::Nothing,
        };
        let uncertain = hits.iter().map(|hit| hit.uncertain).collect();
        Ok((rays.iter().zip(hits.into_iter().map(|hit| hit.spot)).map(seen).collect(), uncertain))
    }

    /// The pixels of the frame, except its border, that see a different surface than one of their neighbours,
    /// or contain a line too thin to be seen by their middle ray.
    fn edges(&self, frame: TileFrame, seen: &[SeenPoint], uncertain: &[bool]) -> Vec<bool> {
        let lined =
            |k: usize| uncertain[k] || self.surface.nearest_line(frame.pixel(k)) < IN_FRONT * seen[k].depth();
        let lined: Vec<bool> = (0..frame.len()).map(lined).collect();
        let [w, h] = frame.size;
        let mut edge = vec![false; frame.len()];
        for [i, j] in (1..h - 1).flat_map(|j| (1..w - 1).map(move |i| [i, j])) {
            let k = frame.index([i, j]);
            // The pixels on both sides of an edge get all their rays, since it is chance in which of the two the
            // edge lies.
            let around = [k - w - 1, k - w, k - w + 1, k - 1, k, k + 1, k + w - 1, k + w, k + w + 1];
            edge[k] = around.iter().any(|n| lined[*n] || !seen[k].is_one_with(&seen[*n]));
        }
        edge
    }

    /// Whether lines are drawn on the surface that is seen.
    fn is_lined(&self, shown: &PictureRay) -> bool {
        self.lines.is_some() && matches!(shown.seen, SeenPoint::Surface(_))
    }

    fn colors(&self, shown: &[PictureRay]) -> Result<Vec<PremultipliedColor>, S::Error> {
        self.surface.with_occlusion(|shadows| shown.iter().map(|shown| self.color(shadows, shown)).collect())
    }

    fn color(&self, shadows: &mut dyn OcclusionTest, shown: &PictureRay) -> PremultipliedColor {
        let background = |share: f64| {
            if self.options.background == Background::Shadow {
                // To be put over another picture: black, and as opaque as the shadow is dark.
                return PremultipliedColor { alpha: 1.0 - share, ..PremultipliedColor::NOTHING };
            }
            let normals = self.options.show == RenderStyle::Normals;
            let color = if normals { DVec3::ONE } else { self.backdrop.at(shown.row) * share };
            PremultipliedColor { color, alpha: 1.0 }
        };
        let spot = match shown.seen {
            SeenPoint::Nothing if self.options.background == Background::Transparent => {
                return PremultipliedColor::NOTHING;
            }
            SeenPoint::Nothing => return background(1.0),
            SeenPoint::Ground(ground) => return background(self.studio.ground_share(ground, shown.shares)),
            SeenPoint::Surface(spot) => spot,
        };
        let direction = direction_of(shown.ray);
        let color = match self.options.show {
            RenderStyle::Normals => spot.normal_as_color(),
            RenderStyle::Zebra => {
                zebra_color(spot.normal, direction, DVec3::from(self.options.up.direction()))
            }
            RenderStyle::Shaded | RenderStyle::Flat | RenderStyle::Wire | RenderStyle::Overshade => {
                let lit = self.studio.shade(shadows, spot, direction, shown.shares);
                match (&self.heat, &self.lines) {
                    (Some(heat), _) => self.studio.recolor(lit, spot, heat.at(spot.at.into())),
                    (None, Some(line)) => lit.lerp(*line, self.line_strength(shown.ray, spot)),
                    (None, None) => lit,
                }
            }
        };
        PremultipliedColor { color, alpha: 1.0 }
    }

    /// The strength of the lines at the point where a ray meets a triangle.
    fn line_strength(&self, ray: &Ray, spot: &ShadingPoint) -> f64 {
        let Some(corners) = self.surface.corners(spot) else { return 0.0 };
        let edges = self.eye.edge_distances(ray, corners);
        let nearest = edges.iter().fold(f64::INFINITY, |least, e| lesser(e[0], least));
        let side = (0.5 * (LINE_PX + LINE_SOFT_PX) - nearest) / LINE_SOFT_PX;
        let side = if side > 0.0 { lesser(side, 1.0) } else { 0.0 };
        // The radius of the inscribed circle is the inverse sum of the inverse heights. Triangles that are
        // narrower than their lines would be covered by lines: these fade, so that fine meshes turn grey and
        // not black.
        let radius = 1.0 / edges.iter().map(|e| 1.0 / e[1]).sum::<f64>();
        let relative_width = radius / LINE_PX;
        side * if relative_width < 1.0 { 0.3 + 0.7 * relative_width } else { 1.0 }
    }

    /// The bytes of pixels by all their rays. Light is interpolated from the pixels around if these show the
    /// same surface.
    fn fine_pixels(
        &self,
        fine: &[FinePixel],
        pixels: &SeenPixels,
        light: &LightGrid,
        counts: &mut BeamCounts,
    ) -> Result<Vec<[u8; 4]>, S::Error> {
        let offsets = &self.pattern.pixel_offsets;
        let n = offsets.len();
        let rays: Vec<Ray> = fine
            .iter()
            .flat_map(|(_, [x, y])| {
                offsets.iter().map(|[dx, dy]| self.eye.ray([f64::from(*x) + dx, f64::from(*y) + dy]))
            })
            .collect();
        // Uncertain rays have done their part in choosing these pixels.
        let (seen, _) = self.see(&rays, counts)?;
        let interpolated = |s: usize| {
            let (column, row) = (fine[s / n].0 % pixels.frame.size[0], fine[s / n].0 / pixels.frame.size[0]);
            let [dx, dy] = offsets[s % n];
            // Light is known at the middles of pixels, which are half a pixel from their corners.
            light.at([column as f64 + dx - 0.5, row as f64 + dy - 0.5], &seen[s], pixels)
        };
        let mut shares: Vec<Option<LightShares>> = (0..seen.len()).map(interpolated).collect();
        // Rays that see a surface that no middle ray saw need light of their own.
        let new: Vec<usize> = (0..seen.len())
            .filter(|s| self.is_lit() && shares[*s].is_none() && !matches!(seen[*s], SeenPoint::Nothing))
            .collect();
        let traced = self.surface.with_occlusion(|shadows| {
            let trace_one = |s: &usize| {
                let [x, y] = fine[s / n].1;
                let turned = self.pattern.for_pixel([i64::from(x), i64::from(y)]);
                let point = seen[*s].lit(&self.studio, self.surface.ray_offset())?;
                let (sky, lamp) = (turned.sky(s % n, point.normal), turned.lamp(s % n));
                Some(self.studio.shares(shadows, &point, sky, lamp))
            };
            new.iter().map(trace_one).collect::<Vec<Option<LightShares>>>()
        })?;
        for (s, share) in new.into_iter().zip(traced) {
            shares[s] = share;
        }
        let shown: Vec<PictureRay> = (0..seen.len())
            .map(|s| PictureRay {
                ray: &rays[s],
                seen: &seen[s],
                shares: shares[s].unwrap_or_default(),
                row: fine[s / n].1[1],
            })
            .collect();
        let colors = self.colors(&shown)?;
        let bytes = |samples: &[PremultipliedColor]| {
            let mut sum = PremultipliedColor::NOTHING;
            samples.iter().for_each(|sample| sum.add(*sample));
            sum.bytes(n, self.options.show)
        };
        Ok(colors.chunks_exact(n).map(bytes).collect())
    }
}

/// Whether a pixel of a tile differs from a neighbour by more than shading explains.
fn changes(colors: &[PremultipliedColor], size: [u32; 2], p: usize) -> bool {
    let [w, h] = size.map(|n| n as usize);
    let (i, j) = (p % w, p / w);
    let beside = [
        (i > 0).then(|| p - 1),
        (i + 1 < w).then(|| p + 1),
        (j > 0).then(|| p - w),
        (j + 1 < h).then(|| p + w),
    ];
    beside.into_iter().flatten().any(|q| {
        let (a, b) = (&colors[p], &colors[q]);
        let channels = |c: &PremultipliedColor| {
            // Channels above 1 are stored as 1, so that differences among them are not seen.
            let clamped = c.color.clamp(DVec3::ZERO, DVec3::ONE);
            [clamped.x, clamped.y, clamped.z, c.alpha]
        };
        channels(a).into_iter().zip(channels(b)).any(|(a, b)| {
            let (low, high) = (lesser(a, b), greater(a, b));
            high - low > SEEN_CHANGE[0] * high + SEEN_CHANGE[1]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::camera::{frame, ray_generator};
    use super::super::light::{Material, StudioShape};
    use super::super::options::Viewpoint;
    use super::super::render_mesh::RenderMesh;
    use super::*;
    use crate::explicit::Mesh;

    /// A ball on a plate, with a slab that hangs over both: outlines, creases, soft and hard shadows.
    fn scene() -> Mesh {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        let (rings, around) = (24_u32, 48_u32);
        for i in 0..=rings {
            let polar = std::f64::consts::PI * f64::from(i) / f64::from(rings);
            for j in 0..around {
                let angle = std::f64::consts::TAU * f64::from(j) / f64::from(around);
                let ring = libm::sin(polar);
                positions.push([ring * libm::cos(angle), ring * libm::sin(angle), libm::cos(polar)]);
            }
        }
        for (i, j) in (0..rings).flat_map(|i| (0..around).map(move |j| (i, j))) {
            let at = |i: u32, j: u32| i * around + j % around;
            faces.extend([
                [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
            ]);
        }
        for (size, z) in [(2.0, -1.0), (0.7, 1.6)] {
            let first = positions.len() as u32;
            positions.extend([[-size, -size, z], [size, -size, z], [size, size, z], [-size, size, z]]);
            faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        Mesh::new(positions, faces).expect("finite")
    }

    #[test]
    fn the_picture_is_that_of_all_rays_of_all_pixels() {
        let (mesh, job) = (scene(), Job::default());
        let options = RenderOptions::sized(192, 128);
        let Viewpoint::Automatic(screen) = options.viewpoint else { unreachable!("the default") };
        let camera = frame(&mesh, options.up, screen);
        let eye = ray_generator(&camera, &options, &job).expect("valid");
        let surface = RenderMesh::new(&mesh, &options, (&eye, screen), &job).expect("small");
        let pattern = SamplePattern::new(options.samples);
        let shape = StudioShape { bounds: surface.bvh().bounds(), up: options.up, material: Material::Clay };
        let studio = StudioLights::new(&shape, &camera, &pattern);
        let renderer = TileRenderer {
            surface,
            studio,
            eye,
            pattern,
            options: &options,
            screen,
            backdrop: Backdrop::new(screen.height_px),
            heat: None,
            lines: None,
        };
        let mut off = Vec::new();
        for tile in ImageTile::all(screen, TILE) {
            let fast = renderer.tile(tile).expect("not refused").0;
            // The plain picture: every pixel by all its rays, each with light of its own.
            let frame = TileFrame { first: [-1, -1], size: [1, 1] };
            let nothing = SeenPixels { frame, seen: &[SeenPoint::Nothing], edge: &[false] };
            let places: Vec<FinePixel> = tile.pixels().map(|at| (0, at)).collect();
            let dark = LightGrid { shares: vec![None] };
            let plain = renderer.fine_pixels(&places, &nothing, &dark, &mut BeamCounts::default());
            let plain = plain.expect("not refused").concat();
            off.extend(fast.iter().zip(plain).map(|(a, b)| u32::from(a.abs_diff(b))));
        }
        off.sort_unstable();
        let mean = f64::from(off.iter().sum::<u32>()) / off.len() as f64;
        // Of 255 levels; the plain picture's own noise is about one. Measured: 17 in a thousandth, along shadows.
        assert!(mean < 1.0, "{mean} levels apart in the mean");
        assert!(
            off[off.len() * 999 / 1000] <= 20,
            "{} levels apart in a thousandth",
            off[off.len() * 999 / 1000]
        );
    }
}
