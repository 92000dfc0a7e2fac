//! The renderer of meshes.
use super::camera::ray_generator;
use super::color::{Backdrop, srgb_to_linear};
use super::heat_map::{HeatMap, ReferenceSurface};
use super::light::{Material, StudioLights, StudioShape};
use super::options::{RenderOptions, RenderStyle, Viewpoint};
use super::picture_tile::TileRenderer;
use super::render_mesh::RenderMesh;
use super::sample_pattern::SamplePattern;
use super::{Picture, frame, render_overshade};
use crate::budget::{Job, JobError};
use crate::explicit::Mesh;

/// The colour of lines in sRGB.
const LINE: [u8; 3] = [38, 48, 62];

/// Renders a mesh.
///
/// Pixels along outlines, creases and lines, and where colours change, are the mean over `samples²` rays at
/// fixed positions under a tent filter two pixels wide, in linear light and not in sRGB values. All other
/// pixels have one ray, through their middle. Outlines and creases are found in the mesh, so that no part is
/// too thin to be seen. Shaded surfaces are lit by a lamp over the viewer's left shoulder with soft shadows,
/// a sky with ambient occlusion, and the ground; fronts and backs differ in colour. Light is traced at every
/// eighth pixel, at more pixels where it changes or the surface ends, and interpolated between. All sample
/// points are fixed, so the picture is the same, byte for byte, on any number of threads and every target.
///
/// Cost: the tree over the mesh and its adjacency; then one ray for each pixel, two for one that shows the
/// mesh, `2·samples²` along edges, and some hundred for each point where light is traced.
///
/// # Errors
/// [`JobError::Refused`] for an invalid camera, 0 or more than 16 samples, or a picture or tree beyond the
/// job's memory limit; [`JobError::Cancelled`] if the job was cancelled.
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

/// Renders a mesh coloured by its distance from another surface: from light at 0 through yellow and red to
/// dark violet at `against.most` and beyond. The distance is that of the very point that is seen, not
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
    let surface = RenderMesh::new(mesh, options, (&eye, camera.screen), job)?;
    let drawn_on = options.show == RenderStyle::Wire || heat.is_some();
    let material = if drawn_on { Material::Paper } else { Material::Clay };
    let pattern = SamplePattern::new(options.samples);
    let shape = StudioShape { bounds: surface.bvh().bounds(), up: options.up, material };
    let renderer = TileRenderer {
        surface,
        studio: StudioLights::new(&shape, &camera, &pattern),
        eye,
        pattern,
        options,
        screen: camera.screen,
        backdrop: Backdrop::new(camera.screen.height_px),
        heat,
        lines: (options.show == RenderStyle::Wire).then(|| srgb_to_linear(LINE)),
    };
    Ok(renderer.picture(job)?.0)
}
