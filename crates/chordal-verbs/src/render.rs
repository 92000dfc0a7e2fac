//! `render`: a picture of any shape. Smooth shapes are meshed first, finely enough for the picture; fields
//! are ray traced directly.
use crate::deviation::ComparedPair;
use crate::input::drawing_regions::{self, FilledRegions};
use crate::mesh::field;
use crate::mesh::isosurface::surface_of;
use crate::report::{
    BoundFacts, BudgetFacts, Certificate, FrameFacts, Output, OvershadeFacts, TriangleFacts, VerbFacts,
};
use crate::scene::merged_parts;
use crate::{BudgetSpec, Input, MeshFailure, Shape};
use crate::{ImplicitShape, VolumeShape};
use chordal::budget::advice::Message;
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::budget::{Failure, Length, Pixels, Refusal, RefusalCode, View};
use chordal::check::{self, Goal};
use chordal::explicit::Topology;
use chordal::explicit::query::{HitSides, facing};
use chordal::implicit::query::BeamCounts;
use chordal::math::{Box3, greater};
use chordal::render::drawings::render_comb as draw_comb;
use chordal::render::fields::{FieldRenderError, ReferenceSurface, render_field};
use chordal::render::{
    CullMode, Picture, RenderOptions, RenderStyle, UpAxis, Viewpoint, frame, render as trace,
    render_against as trace_against, render_overshade,
};
use chordal::{Bounded, Budget, Job, Mesh, Tolerance, convert};
use chordal_io::{Axis, Drawing, Frame, PictureFormat, WriteError};
use std::io::Write;

/// A picture with its certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOutcome {
    /// The picture.
    pub picture: Picture,
    /// Its camera.
    pub camera: Camera,
    /// The certificate of the triangles that it shows, with their distance to the true shape for smooth
    /// shapes.
    pub certificate: Certificate,
    /// The distance that maps to the darkest colour, in a picture of distances.
    pub darkest: Option<f64>,
    /// The fraction of back-facing triangles; `None` for parallel rays.
    pub back_share: Option<f64>,
}

impl RenderOutcome {
    /// Writes the picture, with the certificate as a text field of the format.
    ///
    /// # Errors
    /// If the format does not hold so many pixels, or the sink fails.
    pub fn write(&self, format: PictureFormat, mut out: &mut dyn Write) -> Result<(), WriteError> {
        let fields = self.told();
        format.write(&self.picture, &fields.each_ref().map(|(name, text)| (*name, text.as_str())), &mut out)
    }

    /// The text fields of the file, with their names: the program that wrote it, and the certificate.
    #[must_use]
    pub fn told(&self) -> [(&'static str, String); 2] {
        let software = format!("chordal {}", self.certificate.version);
        [("Software", software), ("chordal", self.certificate.to_value().to_string())]
    }
}

/// The tolerance within which a smooth shape is meshed for a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureTolerance {
    /// Within this number of pixels of the picture.
    Pixels(Pixels),
    /// Within a length.
    Length(Length),
}

/// Renders a shape. The up axis comes from the shape's frame, and is z if that is unknown.
///
/// [`RenderStyle::Overshade`] also counts the pixels that a graphics processor shades, for the certificate; a field has no
/// triangles to count.
///
/// A smooth shape is meshed within `fineness` or, by default, within half a pixel of this picture, and the certificate holds
/// the distance from the triangles to the true shape. If the eye is so close that no length is half a pixel, the default is
/// a hundredth of a percent of the diagonal, and a note says so. A volume is shown by the surface that its
/// [`crate::SurfaceSpec`] chooses, by default at the resolution of its lattice.
///
/// # Errors
/// As for [`crate::mesh`]; also if the camera is invalid, or picture and triangles need more memory than the job allows.
///
/// ```
/// use chordal::render::RenderOptions;
/// use chordal_verbs::{FormatHint, load, render};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
/// let input = load(obj, FormatHint { name: Some("triangle.obj"), ..FormatHint::default() }, &Default::default())?;
/// let outcome = render(&input, &RenderOptions::sized(40, 30), None, &Default::default())?;
/// assert_eq!((outcome.picture.width, outcome.picture.height), (40, 30));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render(
    input: &Input,
    options: &RenderOptions,
    fineness: Option<PictureTolerance>,
    job: &Job,
) -> Result<RenderOutcome, MeshFailure> {
    let mut certificate = Certificate::from_input(input);
    let options = RenderOptions { up: up_axis(input.shape.frame()), ..*options };
    match &input.shape {
        Shape::Scene(scene) => {
            let mesh = merged_parts::one_mesh(scene)?;
            draw_mesh(&mesh, &options, certificate, job)
        }
        Shape::Field(field) if convert::has_meshes(&field.field) => {
            let request = RenderRequest { options, fineness, shape: &input.shape };
            draw_meshed_field(field, &request, certificate, job)
        }
        Shape::Field(field) => draw_field(field, &options, certificate, job),
        Shape::Volume(sampled) => {
            let request = RenderRequest { options, fineness, shape: &input.shape };
            draw_volume(sampled, &request, certificate, job)
        }
        Shape::Curves(_) => {
            let message = "curves in space have no surface to take a picture of".to_owned();
            Err(MeshFailure::refused(RefusalCode::Unsupported, message))
        }
        Shape::Drawing(drawing) => {
            let request = RenderRequest { options, fineness, shape: &input.shape };
            draw_filled_regions(drawing, &request, certificate, job)
        }
        Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Cage(_) => {
            let camera = camera_for(&input.shape, &options, job)?;
            let PictureMesh { mesh, budget, note } =
                mesh_for(&input.shape, fineness, &CameraShot { camera, job })?;
            certificate.notes.extend(note);
            certificate.budget = Some(BudgetFacts::new(&budget));
            certificate.bound = Some(BoundFacts::new(&mesh.bound));
            let options = RenderOptions { viewpoint: Viewpoint::Camera(camera), ..options };
            draw_mesh(&mesh.shape, &options, certificate, job)
        }
    }
}

/// The surface of a volume at the lattice's own resolution, or within the requested tolerance.
fn draw_volume(
    sampled: &VolumeShape,
    request: &RenderRequest,
    mut certificate: Certificate,
    job: &Job,
) -> Result<RenderOutcome, MeshFailure> {
    let mut options = request.options;
    let budget = match request.fineness {
        None => None,
        Some(PictureTolerance::Length(length)) => {
            let spec = BudgetSpec { length: Some(length), ..BudgetSpec::default() };
            let (budget, note) = spec.resolve(request.shape)?;
            certificate.notes.extend(note);
            Some(budget)
        }
        Some(PictureTolerance::Pixels(pixels)) => {
            let camera = match options.viewpoint {
                Viewpoint::Camera(camera) => camera,
                Viewpoint::Automatic(screen) => {
                    // A camera is needed to turn pixels into a length, and a surface to place it: that of the lattice
                    // itself is enough. Its notes are dropped, since the final surface gives them again.
                    let coarse = surface_of(sampled, Budget::default(), &mut Vec::new(), job)?.0;
                    frame(&*merged_parts::one_mesh(&coarse)?, options.up, screen)
                }
            };
            options.viewpoint = Viewpoint::Camera(camera);
            Some(Budget::pixels(pixels, View::Camera(camera)))
        }
    };
    let (scene, bound) = surface_of(sampled, budget.unwrap_or_default(), &mut certificate.notes, job)?;
    certificate.budget = budget.map(|budget| BudgetFacts::new(&budget));
    certificate.bound = Some(BoundFacts::new(&bound));
    draw_mesh(&*merged_parts::one_mesh(&scene)?, &options, certificate, job)
}

/// Renders a field directly, clipped to its region; the certificate's notes state how reliable its rays are.
fn draw_field(
    shape: &ImplicitShape,
    options: &RenderOptions,
    mut certificate: Certificate,
    job: &Job,
) -> Result<RenderOutcome, MeshFailure> {
    let field = shape.clip_to_region();
    let drawn = render_field(&field, options, job).map_err(|failure| match failure {
        FieldRenderError::Stopped(stop) => stop.into(),
        FieldRenderError::Leaf(error) => MeshFailure::refused(RefusalCode::Unsupported, error.message),
    })?;
    let BeamCounts { beams, uncertain, capped, .. } = drawn.counts;
    certificate.notes.push(format!(
        "the picture is ray traced from the field itself: of {beams} rays {uncertain} passed a place that is not \
         proved free, {capped} of them stopped at the step limit; hits and misses are measured, not proved"
    ).into());
    Ok(RenderOutcome {
        picture: drawn.picture,
        camera: drawn.camera,
        certificate,
        darkest: None,
        back_share: None,
    })
}

/// The triangles of a field with meshes, for which rays are too slow.
fn draw_meshed_field(
    shape: &ImplicitShape,
    request: &RenderRequest,
    mut certificate: Certificate,
    job: &Job,
) -> Result<RenderOutcome, MeshFailure> {
    let field = field::finite(shape)?;
    let mesh = |budget: &Budget| convert::field_to_mesh(&field, budget, job).map_err(missed);
    let mut options = request.options;
    let coarse = fraction_of_diagonal(request.shape, MESHED)?;
    let budget = match request.fineness {
        None => coarse,
        Some(PictureTolerance::Length(length)) => {
            let spec = BudgetSpec { length: Some(length), ..BudgetSpec::default() };
            let (budget, note) = spec.resolve(request.shape)?;
            certificate.notes.extend(note);
            budget
        }
        Some(PictureTolerance::Pixels(pixels)) => {
            let camera = match options.viewpoint {
                Viewpoint::Camera(camera) => camera,
                Viewpoint::Automatic(screen) => frame(&mesh(&coarse)?.shape, options.up, screen),
            };
            options.viewpoint = Viewpoint::Camera(camera);
            Budget::pixels(pixels, View::Camera(camera))
        }
    };
    let meshed = mesh(&budget)?;
    certificate.budget = Some(BudgetFacts::new(&budget));
    certificate.bound = Some(BoundFacts::new(&meshed.bound));
    draw_mesh(&meshed.shape, &options, certificate, job)
}

/// Renders a shape coloured by its distance from another one, darkest at `darkest` or else at the largest distance. The
/// certificate's bound is that of [`crate::deviation`] between the two. Percentages are relative to the diagonal of
/// `against`.
///
/// Smooth shapes are meshed as finely as their distance needs.
///
/// # Errors
/// As for [`render`] and [`crate::deviation`].
pub fn render_against(
    input: Input,
    against: Input,
    darkest: Option<Length>,
    options: &RenderOptions,
    job: &Job,
) -> Result<RenderOutcome, MeshFailure> {
    let mut certificate = Certificate::from_input(&input);
    let options = RenderOptions { up: up_axis(input.shape.frame()), ..*options };
    let darkest = match darkest {
        Some(length) => Some(
            length
                .resolve(against.shape.diagonal()?, against.shape.frame().metres_per_unit)
                .map_err(MeshFailure::Length)?,
        ),
        None => None,
    };
    let pair = ComparedPair::from_shapes([input.shape, against.shape], &mut certificate, job)?;
    let measured = pair.measure(&Goal::default(), job)?;
    certificate.bound = Some(BoundFacts::new(&measured.bound));
    let most = darkest.map_or(measured.forward.at_most, Tolerance::get);
    let [mesh, other] = pair.meshes(&measured, job)?;
    certificate.output = Some(Output::Triangles(TriangleFacts::from_mesh(&mesh, Topology::Indices)));
    let camera = match options.viewpoint {
        Viewpoint::Automatic(screen) => frame(&mesh, options.up, screen),
        Viewpoint::Camera(camera) => camera,
    };
    let picture = trace_against(&mesh, ReferenceSurface { mesh: &other, most }, &options, job)?;
    let back_share = back_share(&mesh, &camera);
    Ok(RenderOutcome { picture, camera, certificate, darkest: Some(most), back_share })
}

/// Renders the paths of a drawing with their curvature combs. A note of the certificate states the scale of the teeth.
///
/// # Errors
/// If the shape is not a drawing; as for [`chordal::render::render_comb`].
pub fn render_comb(input: &Input, options: &RenderOptions, job: &Job) -> Result<RenderOutcome, MeshFailure> {
    let Shape::Drawing(drawing) = &input.shape else {
        let message = format!(
            "a curvature comb is drawn of the paths of a drawing, and the input holds {}",
            input.shape.kind()
        );
        return Err(MeshFailure::refused(RefusalCode::Unsupported, message));
    };
    let paths = drawing_regions::upright(drawing);
    let comb = draw_comb(&paths, options, job)?;
    let mut certificate = Certificate::from_input(input);
    certificate.notes.push(
        format!(
            "teeth are as long as the curvature times {:.3e}; the largest curvature of a tooth is {:.3e}",
            comb.scale, comb.most
        )
        .into(),
    );
    Ok(RenderOutcome {
        picture: comb.picture,
        camera: comb.camera,
        certificate,
        darkest: None,
        back_share: None,
    })
}

/// The fraction of triangles that back-face culling would save.
fn back_share(mesh: &Mesh, camera: &Camera) -> Option<f64> {
    let is_perspective = matches!(camera.projection, Projection::Perspective { .. });
    is_perspective.then(|| facing(mesh, camera.eye).back_share())
}

/// The parameters of a picture.
struct RenderRequest<'a> {
    options: RenderOptions,
    fineness: Option<PictureTolerance>,
    shape: &'a Shape,
}

/// The filled regions of a drawing, seen from straight above unless a camera is given.
fn draw_filled_regions(
    drawing: &Drawing,
    request: &RenderRequest,
    mut certificate: Certificate,
    job: &Job,
) -> Result<RenderOutcome, MeshFailure> {
    let filling =
        FilledRegions::from_drawing(drawing, &mut certificate.notes).map_err(MeshFailure::Refused)?;
    let camera = match request.options.viewpoint {
        Viewpoint::Camera(camera) => camera,
        Viewpoint::Automatic(screen) => camera_above(&filling.bounds, screen),
    };
    let (budget, note) = match request.fineness {
        Some(PictureTolerance::Length(length)) => {
            BudgetSpec { length: Some(length), ..BudgetSpec::default() }.resolve(request.shape)?
        }
        Some(PictureTolerance::Pixels(pixels)) => (Budget::pixels(pixels, View::Camera(camera)), None),
        None => match Pixels::new(UNSEEN_PX) {
            Ok(pixels) => (Budget::pixels(pixels, View::Camera(camera)), None),
            Err(_) => (fraction_of_diagonal(request.shape, CLOSE_UP)?, Some(TOO_CLOSE.into())),
        },
    };
    certificate.notes.extend(note);
    let mesh = convert::outlines_to_mesh(&filling.outlines, &budget, job).map_err(missed)?;
    certificate.frame = FrameFacts::new(&filling.frame);
    certificate.budget = Some(BudgetFacts::new(&budget));
    certificate.bound = Some(BoundFacts::new(&mesh.bound));
    let options = RenderOptions { viewpoint: Viewpoint::Camera(camera), up: UpAxis::Y, ..request.options };
    draw_mesh(&mesh.shape, &options, certificate, job)
}

/// The fraction of the picture that a drawing spans. Chosen: leaves a narrow margin.
const FRAMED: f64 = 0.92;

/// A camera with parallel rays along −z that sees the whole box.
fn camera_above(bounds: &Box3, screen: Screen) -> Camera {
    // Halved first, so that the sum of two large coordinates does not overflow.
    let middle = |k: usize| bounds.min[k] / 2.0 + bounds.max[k] / 2.0;
    let size = |k: usize| bounds.max[k] - bounds.min[k];
    let aspect = f64::from(screen.height_px) / f64::from(screen.width_px.max(1));
    let by_width = size(0) * aspect;
    let height = greater(by_width, size(1));
    let height = if height > 0.0 { height / FRAMED } else { 1.0 };
    Camera {
        eye: [middle(0), middle(1), height],
        target: [middle(0), middle(1), 0.0],
        up: [0.0, 1.0, 0.0],
        near: 0.0,
        projection: Projection::Orthographic { height },
        screen,
    }
}

fn up_axis(frame: &Frame) -> UpAxis {
    match frame.up {
        Some(Axis::Y) => UpAxis::Y,
        Some(Axis::Z) | None => UpAxis::Z,
    }
}

fn draw_mesh(
    mesh: &Mesh,
    options: &RenderOptions,
    mut certificate: Certificate,
    job: &Job,
) -> Result<RenderOutcome, MeshFailure> {
    certificate.output = Some(Output::Triangles(TriangleFacts::from_mesh(mesh, Topology::Indices)));
    let camera = match options.viewpoint {
        Viewpoint::Automatic(screen) => frame(mesh, options.up, screen),
        Viewpoint::Camera(camera) => camera,
    };
    let picture = if options.show == RenderStyle::Overshade {
        let (picture, counts) = render_overshade(mesh, options, job)?;
        let sides = match options.cull {
            CullMode::None => HitSides::Both,
            CullMode::Back => HitSides::Front,
            CullMode::Front => HitSides::Back,
        };
        let flicker = check::shading::flicker(mesh, &camera, sides, job)?;
        let overshade = OvershadeFacts::new(&counts, &flicker, &camera, sides);
        certificate.verb = VerbFacts::Overshade { overshade };
        picture
    } else {
        trace(mesh, options, job)?
    };
    let back_share = back_share(mesh, &camera);
    Ok(RenderOutcome { picture, camera, certificate, darkest: None, back_share })
}

/// Triangles of patches or of the limit surface of a cage.
fn tessellate(shape: &Shape, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, MeshFailure> {
    let mesh = match shape {
        Shape::Patches { patches, .. } => convert::patches_to_mesh(patches, budget, job),
        Shape::Surfaces { surfaces, .. } => convert::trimmed_surfaces_to_mesh(surfaces, budget, job),
        Shape::Cage(polygons) => chordal::convert::cage_to_mesh(&polygons.cage, budget, job),
        other => {
            let message = format!("{} have no patches", other.kind());
            Err(Failure::refused(RefusalCode::Unsupported, message))
        }
    };
    mesh.map_err(missed)
}

/// The failure of meshing for a picture; a coarser mesh would not do.
fn missed(failure: Failure<Mesh>) -> MeshFailure {
    MeshFailure::from_missed(failure, "the budget was not met; the best reached is ")
}

/// The camera of the options, or one that frames a coarse mesh of the shape.
fn camera_for(shape: &Shape, options: &RenderOptions, job: &Job) -> Result<Camera, MeshFailure> {
    let screen = match options.viewpoint {
        Viewpoint::Camera(camera) => return Ok(camera),
        Viewpoint::Automatic(screen) => screen,
    };
    let mesh = tessellate(shape, &fraction_of_diagonal(shape, COARSE)?, job)?.shape;
    Ok(frame(&mesh, options.up, screen))
}

/// A fraction of the diagonal. Chosen: fine enough to frame a shape in a picture with a margin, and fast to mesh.
const COARSE: f64 = 0.002;
/// The default fraction of the diagonal within which a field with meshes is meshed for a picture. Chosen: some pixels of the
/// usual screen.
const MESHED: f64 = 0.005;
/// The triangle budget of a shape so small that it has no diagonal. Chosen: more triangles would not be seen.
const FEW: u64 = 10_000;
/// An error in pixels that is invisible at the edges of an antialiased picture. Chosen: half a pixel.
const UNSEEN_PX: f64 = 0.5;
/// The fraction of the diagonal if the eye is too close for pixels. Derived: half a pixel of a picture 5,000 pixels wide
/// that shows all of the shape.
const CLOSE_UP: f64 = 1e-4;

/// The triangles of a picture, their budget, and a note if that budget is unusual.
struct PictureMesh {
    mesh: Bounded<Mesh>,
    budget: Budget,
    note: Option<Message>,
}

/// A camera, and the conditions of the job.
struct CameraShot<'a> {
    camera: Camera,
    job: &'a Job,
}

fn mesh_for(
    shape: &Shape,
    fineness: Option<PictureTolerance>,
    shot: &CameraShot,
) -> Result<PictureMesh, MeshFailure> {
    let build = |(budget, note): (Budget, Option<Message>)| {
        Ok(PictureMesh { mesh: tessellate(shape, &budget, shot.job)?, budget, note })
    };
    let at_camera = |pixels| Budget::pixels(pixels, View::Camera(shot.camera));
    match fineness {
        Some(PictureTolerance::Pixels(pixels)) => build((at_camera(pixels), None)),
        Some(PictureTolerance::Length(length)) => {
            build(BudgetSpec { length: Some(length), ..BudgetSpec::default() }.resolve(shape)?)
        }
        None => match Pixels::new(UNSEEN_PX).map(|pixels| build((at_camera(pixels), None))) {
            Ok(Err(MeshFailure::Refused(Refusal { code: RefusalCode::TooClose, .. }))) | Err(_) => {
                build((fraction_of_diagonal(shape, CLOSE_UP)?, Some(TOO_CLOSE.into())))
            }
            Ok(meshed) => meshed,
        },
    }
}

const TOO_CLOSE: &str =
    "the eye is too close for a bound in pixels: the mesh is within 0.01% of the diagonal instead";

/// A fraction of the diagonal as a budget; a shape so small that it has no diagonal gets a few triangles.
fn fraction_of_diagonal(shape: &Shape, share: f64) -> Result<Budget, MeshFailure> {
    Ok(Tolerance::new(shape.diagonal()? * share).map_or(Budget::triangles(FEW), Budget::length))
}

/// The default screen of a picture.
pub const USUAL_SCREEN: Screen = Screen { width_px: 1280, height_px: 960 };
