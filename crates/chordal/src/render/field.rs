//! Pictures straight from a field: rays meet the surface where the field changes its sign, without triangles.
use super::Picture;
use super::camera::{RayGenerator, frame_points};
use super::drawing::draw;
use super::light::{Material, OcclusionTest, PixelRay, StudioLights};
use super::options::{CullMode, RenderOptions, RenderStyle, UpAxis, Viewpoint};
use super::render_mesh::{ShadingPoint, facing_normal};
use super::sample_pattern::SamplePattern;
use super::trace::{CameraRay, PremultipliedColor, backdrop, ray_generator, shade_background};
use super::zebra::zebra_color;
use crate::budget::{Camera, Job, JobError, Progress, Projection, Refusal, RefusalCode, Screen, par_map};
use crate::explicit::Ray;
use crate::implicit::query::{Beam, BeamCounts, BeamRecord, FieldOctree, FieldOctreeError, FieldTracer};
use crate::implicit::{Field, LeafError, Tape};
use glam::DVec3;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// Pixels along a tile's side, whose rays go together: enough for long batches, few enough for caches and
/// threads; more for leaves that prefer larger batches.
const TILE: u32 = 16;
const LEAF_TILE: u32 = 64;
/// The radius of shadow rays at their start as a fraction of the size, and its growth: far below the lamp's.
const SHADOW_CONE: [f64; 2] = [2e-3, 1e-2]; // measured: a tenth of it takes five times as long, and looks the same
/// By how much shadow rays start off the surface, as a fraction of the size: far above the rounding of hits
/// (2⁻⁴²) and far below a pixel.
const LIFT: f64 = 1e-6; // derived: see above

/// A picture of a field, with its camera and the counts of its rays.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPicture {
    /// The picture.
    pub picture: Picture,
    /// Its camera.
    pub camera: Camera,
    /// The counts of the camera rays; of the pixels, for a planar field.
    pub counts: BeamCounts,
}

/// Why there is no picture of a field.
#[derive(Clone, Debug)]
pub enum FieldRenderError {
    /// The rendering was refused or cancelled.
    Stopped(JobError),
    /// A leaf failed.
    Leaf(LeafError),
}

impl fmt::Display for FieldRenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped(stopped) => stopped.fmt(f),
            Self::Leaf(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for FieldRenderError {}

impl From<JobError> for FieldRenderError {
    fn from(stopped: JobError) -> Self {
        Self::Stopped(stopped)
    }
}

impl From<LeafError> for FieldRenderError {
    fn from(error: LeafError) -> Self {
        Self::Leaf(error)
    }
}

impl From<FieldOctreeError> for FieldRenderError {
    fn from(unbounded: FieldOctreeError) -> Self {
        match unbounded {
            FieldOctreeError::Region(_) => refusal(
                "the field has no finite box; give a region to look in, as in -1,-1,-1 to 1,1,1".to_owned(),
            ),
            FieldOctreeError::Leaf(error) => Self::Leaf(error),
        }
    }
}

pub(super) fn refusal(message: String) -> FieldRenderError {
    FieldRenderError::Stopped(JobError::Refused(Refusal::new(RefusalCode::Unsupported, message)))
}

/// Renders a field.
///
/// The light is that of [`super::render`]. The surface is where the sign of the field changes, found on each
/// ray to 2⁻⁴² of the size, and its normal is the gradient. A field that does not depend on z is drawn in the
/// plane: dark inside, seen from straight above unless a camera is given. Of the styles in [`RenderStyle`],
/// triangle edges and lane counts are refused, and flat is the same as shaded.
///
/// The bytes are the same on any number of threads and every target.
///
/// Cost: the octree around the surface once; then as for a mesh, with some 5 values of the field per ray.
///
/// # Errors
/// [`FieldRenderError`]: as for [`super::render`]; when the field has no finite box; for edges and lanes; and
/// when a leaf fails.
///
/// ```
/// use chordal::implicit::{Distance, Expr, Field};
/// use chordal::Job;
/// use chordal::math::Box3;
/// use chordal::render::{Background, RenderOptions};
/// use chordal::render::fields::render_field;
/// let [x, y, z] = Expr::axes();
/// let ball = Field::new((x.square() + y.square() + z.square()).sqrt() - 1.0)
///     .with_distance(Distance::EXACT)
///     .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let options = RenderOptions { background: Background::Transparent, ..RenderOptions::sized(40, 30) };
/// let drawn = render_field(&ball, &options, &Job::default())?;
/// assert_eq!(drawn.picture.pixel(20, 15)[3], 255);
/// // A few rays graze the outline.
/// assert!(drawn.counts.certified_share() > 0.99);
/// # Ok::<(), chordal::render::fields::FieldRenderError>(())
/// ```
pub fn render_field(
    field: &Field,
    options: &RenderOptions,
    job: &Job,
) -> Result<FieldPicture, FieldRenderError> {
    if options.show == RenderStyle::Wire {
        return Err(refusal("a field has no edges to show; wire is for meshes".to_owned()));
    }
    if options.show == RenderStyle::Overshade {
        return Err(refusal("a field has no triangles to shade: mesh it first".to_owned()));
    }
    if !Tape::new(field.sign()).axes()[2] {
        return draw(field, options, job);
    }
    let mut cells = FieldOctree::build(field, job)?;
    cells.sample_gradients(job)?;
    let camera = match options.viewpoint {
        Viewpoint::Automatic(screen) => frame_field(&cells, options.up, screen),
        Viewpoint::Camera(camera) => camera,
    };
    let eye = ray_generator(&camera, options, job)?;
    let studio = StudioLights::new(&cells.occupied(), &camera, options.up, Material::Clay);
    let shot = FieldRenderer {
        tracer: FieldTracer::new(&cells),
        size: cells.size(),
        studio,
        cone: pixel_cone(&camera),
        eye,
        pattern: SamplePattern::new(options.samples),
        options,
        screen: camera.screen,
    };
    let (picture, counts) = shot.picture(job)?;
    Ok(FieldPicture { picture, camera, counts })
}

/// The camera of the automatic viewpoint for the cells of a field, like [`super::frame`] for a mesh.
#[must_use]
pub fn frame_field(cells: &FieldOctree, up: UpAxis, screen: Screen) -> Camera {
    frame_points(|| cells.corners().map(DVec3::from), up, screen)
}

/// The cone of half a pixel, for rays whose direction is 1 long along the line of sight.
fn pixel_cone(camera: &Camera) -> [f64; 2] {
    let height = f64::from(camera.screen.height_px);
    match camera.projection {
        Projection::Perspective { fov_y_deg } => [0.0, libm::tan(fov_y_deg.to_radians() / 2.0) / height],
        Projection::Orthographic { height: length } => [0.5 * length / height, 0.0],
    }
}

struct FieldRenderer<'a> {
    tracer: FieldTracer<'a>,
    size: f64,
    studio: StudioLights,
    cone: [f64; 2],
    eye: RayGenerator,
    pattern: SamplePattern,
    options: &'a RenderOptions,
    screen: Screen,
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
pub(super) fn each_tile(
    tiles: &[ImageTile],
    job: &Job,
    work: impl Fn(ImageTile) -> Result<(Vec<u8>, BeamCounts), LeafError> + Sync,
) -> Result<(Vec<Vec<u8>>, BeamCounts), FieldRenderError> {
    let done = AtomicU64::new(0);
    let found = par_map(job, tiles, |_, tile| {
        if job.is_cancelled() {
            return Ok((Vec::new(), BeamCounts::default()));
        }
        let found = work(*tile);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        job.report(Progress { stage: "render", done, total: tiles.len() as u64 });
        found
    });
    if job.is_cancelled() {
        return Err(FieldRenderError::Stopped(JobError::Cancelled));
    }
    let mut counts = BeamCounts::default();
    let mut bytes = Vec::with_capacity(tiles.len());
    for found in found {
        let (one, count) = found?;
        bytes.push(one);
        counts = counts.merge(count);
    }
    Ok((bytes, counts))
}

/// Collects shadow rays.
struct ShadowRayCollector {
    beams: Vec<Beam>,
    size: f64,
}

/// Gives the results of shadow rays, in the order in which they were collected.
struct ShadowRayResults {
    answers: std::vec::IntoIter<bool>,
    size: f64,
}

impl OcclusionTest for ShadowRayCollector {
    fn is_occluded(&mut self, origin: DVec3, direction: DVec3) -> bool {
        let cone = [SHADOW_CONE[0] * self.size, SHADOW_CONE[1]];
        let (origin, direction) = (origin.to_array(), direction.to_array());
        self.beams.push(Beam { origin, direction, from: 0.0, to: f64::INFINITY, cone });
        false
    }

    fn ray_offset(&self) -> f64 {
        LIFT * self.size
    }
}

impl OcclusionTest for ShadowRayResults {
    fn is_occluded(&mut self, _: DVec3, _: DVec3) -> bool {
        self.answers.next().unwrap_or(false)
    }

    fn ray_offset(&self) -> f64 {
        LIFT * self.size
    }
}

impl FieldRenderer<'_> {
    fn picture(&self, job: &Job) -> Result<(Picture, BeamCounts), FieldRenderError> {
        let side = if self.tracer.batch() > 1 << 12 { LEAF_TILE } else { TILE };
        let tiles = ImageTile::all(self.screen, side);
        let (bytes, counts) = each_tile(&tiles, job, |tile| self.tile(tile))?;
        Ok((assemble(self.screen, &tiles, &bytes), counts))
    }

    fn camera_rays(&self, tile: ImageTile) -> Vec<CameraRay<'_>> {
        let one = |[x, y]: [u32; 2]| {
            let pattern = self.pattern.for_pixel(x, y);
            let backdrop = backdrop(y, self.screen.height_px);
            self.pattern.pixel_offsets.iter().enumerate().map(move |(index, [dx, dy])| CameraRay {
                ray: self.eye.ray([f64::from(x) + dx, f64::from(y) + dy]),
                pixel_ray: PixelRay { pattern, ray: index },
                backdrop,
            })
        };
        tile.pixels().flat_map(one).collect()
    }

    fn tile(&self, tile: ImageTile) -> Result<(Vec<u8>, BeamCounts), LeafError> {
        let looks = self.camera_rays(tile);
        let beam = |ray: &Ray| Beam {
            origin: ray.origin,
            direction: ray.direction,
            from: ray.t_min,
            to: ray.t_max,
            cone: self.cone,
        };
        let beams: Vec<Beam> = looks.iter().map(|look| beam(&look.ray)).collect();
        let records = self.visible_hits(&beams)?;
        let counts = records.iter().fold(BeamCounts::default(), BeamCounts::add_record);
        let spots = self.shading_points(&beams, &records)?;
        let mut ask = ShadowRayCollector { beams: Vec::new(), size: self.size };
        for (look, spot) in looks.iter().zip(&spots) {
            self.sample(&mut ask, look, spot.as_ref());
        }
        let answers = self.tracer.occluded(&ask.beams)?.into_iter();
        let mut told = ShadowRayResults { answers, size: self.size };
        let n = self.pattern.pixel_offsets.len();
        let mut bytes = Vec::with_capacity(4 * looks.len() / n);
        for (looks, spots) in looks.chunks_exact(n).zip(spots.chunks_exact(n)) {
            let mut sum = PremultipliedColor::NOTHING;
            for (look, spot) in looks.iter().zip(spots) {
                sum.add(self.sample(&mut told, look, spot.as_ref()));
            }
            bytes.extend(sum.bytes(n, self.options.show));
        }
        Ok((bytes, counts))
    }

    /// The first hits that are not culled.
    fn visible_hits(&self, beams: &[Beam]) -> Result<Vec<BeamRecord>, LeafError> {
        let mut records = self.tracer.intersect(beams)?;
        let culled = match self.options.cull {
            CullMode::None => return Ok(records),
            CullMode::Back => false,
            CullMode::Front => true,
        };
        loop {
            let again: Vec<usize> = (0..records.len())
                .filter(|k| records[*k].hit.is_some_and(|met| met.entering == culled))
                .collect();
            if again.is_empty() {
                return Ok(records);
            }
            let rest: Vec<Beam> = again
                .iter()
                .map(|k| {
                    let from = records[*k].hit.map_or(f64::INFINITY, |met| met.t);
                    let length = DVec3::from(beams[*k].direction).length();
                    Beam { from: from + LIFT * self.size / length, ..beams[*k] }
                })
                .collect();
            for (k, record) in again.iter().zip(self.tracer.intersect(&rest)?) {
                let uncertain = records[*k].uncertain || record.uncertain;
                records[*k] = BeamRecord { uncertain, ..record };
            }
        }
    }

    fn shading_points(
        &self,
        beams: &[Beam],
        records: &[BeamRecord],
    ) -> Result<Vec<Option<ShadingPoint>>, LeafError> {
        let points: Vec<[f64; 3]> =
            records.iter().filter_map(|record| record.hit.map(|met| met.point)).collect();
        let mut normals = self.tracer.normals(&points)?.into_iter();
        let spot = |(beam, record): (&Beam, &BeamRecord)| {
            let met = record.hit?;
            let direction = DVec3::from(beam.direction);
            // Without a gradient the surface faces the eye.
            let outward = normals.next().flatten().map(DVec3::from);
            let away = if met.entering { 1.0 } else { -1.0 };
            let facing = outward.map_or(-direction.normalize(), |n| n * away);
            let normal = facing_normal(facing, -direction.normalize(), direction);
            let origin = DVec3::from(met.point) + normal * (LIFT * self.size);
            Some(ShadingPoint { face: 0, origin, flat: normal, normal, front: met.entering })
        };
        Ok(beams.iter().zip(records).map(spot).collect())
    }

    fn sample(
        &self,
        shadows: &mut impl OcclusionTest,
        look: &CameraRay,
        spot: Option<&ShadingPoint>,
    ) -> PremultipliedColor {
        let Some(spot) = spot else { return shade_background(&self.studio, self.options, shadows, look) };
        let direction = DVec3::from(look.ray.direction);
        let color = match self.options.show {
            RenderStyle::Normals => spot.normal_as_color(),
            RenderStyle::Zebra => {
                zebra_color(spot.normal, direction, DVec3::from(self.options.up.direction()))
            }
            _ => self.studio.shade(shadows, spot, direction, look.pixel_ray),
        };
        PremultipliedColor { color, alpha: 1.0 }
    }
}
