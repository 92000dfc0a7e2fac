//! The renderer of meshes: rows in parallel, each pixel by its own fixed rays.
use super::camera::RayGenerator;
use super::color::{linear_to_srgb, srgb_to_linear, to_byte};
use super::heat_map::{HeatMap, ReferenceSurface};
use super::light::{Material, OcclusionTest, PixelRay, StudioLights};
use super::options::{Background, RenderOptions, RenderStyle, Viewpoint};
use super::render_mesh::RenderMesh;
use super::sample_pattern::SamplePattern;
use super::zebra::zebra_color;
use super::{Picture, frame, render_overshade};
use crate::budget::{Camera, Job, JobError, Progress, Refusal, RefusalCode, Screen, View, par_map};
use crate::explicit::{Mesh, Ray};
use crate::math::lesser;
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};

/// The width of lines in pixels, and their colour in sRGB.
const LINE_PX: f64 = 1.3;
const LINE: [u8; 3] = [38, 48, 62];
/// The width over which a line's side fades out: less than a pixel, so that lines are as smooth as outlines.
const LINE_SOFT_PX: f64 = 0.5;
/// Colours of the backdrop at the top and the bottom of the picture, in sRGB.
const BACKDROP: [[u8; 3]; 2] = [[247, 249, 251], [219, 225, 232]];
/// The most samples along a pixel's side.
const MOST_SAMPLES: u32 = 16;

/// Renders a mesh.
///
/// Each pixel is the mean over `samples²` rays at fixed positions under a tent filter two pixels wide, in
/// linear light and not in sRGB values. Shaded surfaces are lit by a lamp over the viewer's left shoulder
/// with soft shadows, a sky with ambient occlusion, and the ground; fronts and backs differ in colour. All
/// sample points are fixed, so the picture is the same, byte for byte, on any number of threads and every
/// target.
///
/// Cost: the tree over the mesh; then, for a pixel that shows the mesh or its shadow, `2·samples²` rays and
/// 64 to 96 more.
///
/// # Errors
/// [`JobError::Refused`] for an invalid camera, 0 or more than 16 samples, or a picture or tree beyond the
/// job's memory limit; [`JobError::Cancelled`] when the job was.
///
/// ```
/// use chordal::{Job, Mesh, render::{Background, RenderOptions, RenderStyle, render}};
/// let mesh = Mesh::new(vec![[0., 0., 0.], [1., 0., 0.], [0., 0., 1.]], vec![[0, 1, 2]]).unwrap();
/// let options = RenderOptions { background: Background::Transparent, ..RenderOptions::sized(40, 30) };
/// let picture = render(&mesh, &options, &Job::default())?;
/// assert_eq!(picture.pixel(0, 0)[3], 0);
/// assert_eq!(picture.pixel(15, 20)[3], 255);
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
pub fn render(mesh: &Mesh, options: &RenderOptions, job: &Job) -> Result<Picture, JobError> {
    if options.show == RenderStyle::Overshade {
        return Ok(render_overshade(mesh, options, job)?.0);
    }
    render_mesh(mesh, options, None, job)
}

/// Renders a mesh coloured by its distance from another surface: light where there is none, over yellow and
/// red to dark violet at `against.most` and beyond. The distance is that of the very point that is seen, not
/// interpolated between vertices. [`RenderStyle::Flat`] is lit as such; every other style is lit as
/// [`RenderStyle::Shaded`].
///
/// # Errors
/// As for [`render`].
///
/// ```
/// use chordal::{Job, Mesh};
/// use chordal::render::{RenderOptions, render_against};
/// use chordal::render::fields::ReferenceSurface;
/// let square = |z: f64| Mesh::new(vec![[0., 0., z], [1., 0., z], [0., 1., z]], vec![[0, 1, 2]]).unwrap();
/// let against = ReferenceSurface { mesh: &square(0.0), most: 0.5 };
/// let picture = render_against(&square(0.25), against, &RenderOptions::sized(40, 30), &Job::default())?;
/// assert_eq!((picture.width, picture.height), (40, 30));
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
pub fn render_against(
    mesh: &Mesh,
    against: ReferenceSurface,
    options: &RenderOptions,
    job: &Job,
) -> Result<Picture, JobError> {
    let show = if options.show == RenderStyle::Flat { RenderStyle::Flat } else { RenderStyle::Shaded };
    render_mesh(mesh, &RenderOptions { show, ..*options }, Some(HeatMap::new(against, job)?), job)
}

fn render_mesh(
    mesh: &Mesh,
    options: &RenderOptions,
    heat: Option<HeatMap>,
    job: &Job,
) -> Result<Picture, JobError> {
    let camera = match options.viewpoint {
        Viewpoint::Automatic(screen) => frame(mesh, options.up, screen),
        Viewpoint::Camera(camera) => camera,
    };
    let eye = ray_generator(&camera, options, job)?;
    let Screen { width_px: width, height_px: height } = camera.screen;
    let surface = RenderMesh::new(mesh, options, job)?;
    let drawn_on = options.show == RenderStyle::Wire || heat.is_some();
    let material = if drawn_on { Material::Paper } else { Material::Clay };
    let studio = StudioLights::new(&surface.bvh().bounds(), &camera, options.up, material);
    let tracer = MeshRenderer {
        surface,
        studio,
        eye,
        pattern: SamplePattern::new(options.samples),
        options: *options,
        heat,
        line_light: srgb_to_linear(LINE),
    };
    let done = AtomicU64::new(0);
    let rows: Vec<u32> = (0..height).collect();
    let rows = par_map(job, &rows, |_, y| {
        if job.is_cancelled() {
            return Vec::new();
        }
        let backdrop = backdrop(*y, height);
        let row: Vec<u8> = (0..width).flat_map(|x| tracer.pixel(x, *y, backdrop)).collect();
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        job.report(Progress { stage: "render", done, total: u64::from(height) });
        row
    });
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    Ok(Picture { width, height, rgba: rows.concat() })
}

/// The ray generator, if camera and options are valid.
pub(super) fn ray_generator(
    camera: &Camera,
    options: &RenderOptions,
    job: &Job,
) -> Result<RayGenerator, JobError> {
    let refused = |code, message: String| JobError::Refused(Refusal::new(code, message));
    View::Camera(*camera).checked().map_err(|wrong| refused(RefusalCode::Unsupported, wrong.to_string()))?;
    let eye = RayGenerator::new(camera)
        .ok_or_else(|| refused(RefusalCode::Unsupported, "the camera has no axes".into()))?;
    if options.samples == 0 || options.samples > MOST_SAMPLES {
        let message = format!("samples are 1 to {MOST_SAMPLES} a pixel's side, not {}", options.samples);
        return Err(refused(RefusalCode::Unsupported, message));
    }
    let Screen { width_px: width, height_px: height } = camera.screen;
    // Each row is stored once by itself and once in the picture.
    let bytes = (8 * u64::from(width)).saturating_mul(u64::from(height));
    if bytes > job.memory_limit {
        let message =
            format!("{width}x{height} pixels need {bytes} bytes; the limit is {}", job.memory_limit);
        return Err(refused(RefusalCode::TooMuchMemory, message));
    }
    Ok(eye)
}

/// The backdrop in row `y`, counted from the top of the picture.
pub(super) fn backdrop(y: u32, height: u32) -> DVec3 {
    let [top, bottom] = BACKDROP.map(srgb_to_linear);
    top.lerp(bottom, (f64::from(y) + 0.5) / f64::from(height))
}

struct MeshRenderer<'a> {
    surface: RenderMesh<'a>,
    studio: StudioLights,
    eye: RayGenerator,
    pattern: SamplePattern,
    options: RenderOptions,
    heat: Option<HeatMap>,
    line_light: DVec3,
}

/// Premultiplied: colour times alpha, and alpha.
#[derive(Clone, Copy)]
pub(super) struct PremultipliedColor {
    pub color: DVec3,
    pub alpha: f64,
}

impl PremultipliedColor {
    pub const NOTHING: Self = Self { color: DVec3::ZERO, alpha: 0.0 };

    /// Adds a sample, clamped: a glint brighter than white would spoil the smoothness of its outline.
    pub fn add(&mut self, sample: Self) {
        self.color += sample.color.clamp(DVec3::ZERO, DVec3::ONE);
        self.alpha += sample.alpha;
    }

    /// The bytes of the mean of `n` samples.
    pub fn bytes(&self, n: usize, show: RenderStyle) -> [u8; 4] {
        if self.alpha <= 0.0 {
            return [0; 4];
        }
        let [r, g, b] = (self.color / self.alpha).to_array();
        let encode = if show == RenderStyle::Normals { to_byte } else { linear_to_srgb };
        [encode(r), encode(g), encode(b), to_byte(self.alpha / n as f64)]
    }
}

/// A ray of the picture, its index in its pixel, and the backdrop there.
#[derive(Clone, Copy)]
pub(super) struct CameraRay<'a> {
    pub ray: Ray,
    pub pixel_ray: PixelRay<'a>,
    pub backdrop: DVec3,
}

/// The colour of a ray that meets nothing.
pub(super) fn shade_background(
    studio: &StudioLights,
    options: &RenderOptions,
    shadows: &mut impl OcclusionTest,
    look: &CameraRay,
) -> PremultipliedColor {
    if options.background == Background::Transparent {
        return PremultipliedColor::NOTHING;
    }
    let has_ground = matches!(options.show, RenderStyle::Shaded | RenderStyle::Flat);
    let mut ground = || {
        let (origin, direction) = (DVec3::from(look.ray.origin), DVec3::from(look.ray.direction));
        studio.ground(shadows, origin, direction, look.pixel_ray)
    };
    let share = if has_ground { ground().unwrap_or(1.0) } else { 1.0 };
    if options.background == Background::Shadow {
        return PremultipliedColor { alpha: 1.0 - share, ..PremultipliedColor::NOTHING };
    }
    let color = if options.show == RenderStyle::Normals { DVec3::ONE } else { look.backdrop * share };
    PremultipliedColor { color, alpha: 1.0 }
}

impl MeshRenderer<'_> {
    fn pixel(&self, x: u32, y: u32, backdrop: DVec3) -> [u8; 4] {
        let pattern = self.pattern.for_pixel(x, y);
        let mut sum = PremultipliedColor::NOTHING;
        for (index, [dx, dy]) in self.pattern.pixel_offsets.iter().enumerate() {
            let ray = self.eye.ray([f64::from(x) + dx, f64::from(y) + dy]);
            sum.add(self.sample(&CameraRay { ray, pixel_ray: PixelRay { pattern, ray: index }, backdrop }));
        }
        sum.bytes(self.pattern.pixel_offsets.len(), self.options.show)
    }

    fn sample(&self, look: &CameraRay) -> PremultipliedColor {
        let (ray, rays) = (&look.ray, look.pixel_ray);
        let Some((hit, spot)) = self.surface.intersect(ray) else {
            return shade_background(&self.studio, &self.options, &mut &self.surface, look);
        };
        let direction = DVec3::from(ray.direction);
        let color = match self.options.show {
            RenderStyle::Normals => spot.normal_as_color(),
            RenderStyle::Zebra => {
                zebra_color(spot.normal, direction, DVec3::from(self.options.up.direction()))
            }
            RenderStyle::Shaded | RenderStyle::Flat | RenderStyle::Overshade => {
                let lit = self.studio.shade(&mut &self.surface, &spot, direction, rays);
                match &self.heat {
                    Some(heat) => self.studio.recolor(lit, &spot, heat.at(ray.at(hit.t))),
                    None => lit,
                }
            }
            RenderStyle::Wire => {
                let paper = self.studio.shade(&mut &self.surface, &spot, direction, rays);
                paper.lerp(self.line_light, self.line_strength(ray, self.surface.corners(spot.face)))
            }
        };
        PremultipliedColor { color, alpha: 1.0 }
    }

    /// The strength of the lines where a ray meets a triangle.
    fn line_strength(&self, ray: &Ray, corners: [[f64; 3]; 3]) -> f64 {
        let edges = self.eye.edge_distances(ray, corners);
        let nearest = edges.iter().fold(f64::INFINITY, |least, e| lesser(e[0], least));
        let side = (0.5 * (LINE_PX + LINE_SOFT_PX) - nearest) / LINE_SOFT_PX;
        let side = if side > 0.0 { lesser(side, 1.0) } else { 0.0 };
        // The radius of the inscribed circle is the inverse sum of the inverse heights. Triangles that are
        // narrower than their lines would be all line: these fade, so that fine meshes turn grey and not
        // black.
        let radius = 1.0 / edges.iter().map(|e| 1.0 / e[1]).sum::<f64>();
        let room = radius / LINE_PX;
        side * if room < 1.0 { 0.3 + 0.7 * room } else { 1.0 }
    }
}
