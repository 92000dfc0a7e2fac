//! `render`: a picture of any shape; smooth shapes are meshed first, finely enough for it.
use crate::report::{BoundFacts, BudgetFacts, Certificate, Output, OutputFacts};
use crate::{BudgetSpec, Input, MeshFailure, Shape, placed};
use chordal::budget::{Camera, Code, Failure, Length, Pixels, Refusal, Screen, Stopped, View};
use chordal::explicit::Topology;
use chordal::render::{Options, Picture, Up, Viewpoint, frame, render as trace};
use chordal::{Bounded, Budget, Job, Mesh, Patch, Tolerance, convert};
use chordal_io::{Axis, Frame, WriteError, png};
use std::io::Write;

/// A picture with what is known of what it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOutcome {
    /// The picture.
    pub picture: Picture,
    /// Its camera.
    pub camera: Camera,
    /// The triangles that it shows, and for smooth shapes how far those are from the true shape.
    pub certificate: Certificate,
}

impl RenderOutcome {
    /// Writes the picture as PNG, with the certificate as text beside it.
    ///
    /// # Errors
    /// When the sink fails.
    pub fn write(&self, mut out: &mut dyn Write) -> Result<(), WriteError> {
        let software = format!("chordal {}", self.certificate.version);
        let certificate = self.certificate.to_value().to_string();
        png::write(&self.picture, &[("Software", &software), ("chordal", &certificate)], &mut out)
    }
}

/// How finely a smooth shape is meshed for a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fineness {
    /// To so many pixels of the picture.
    Pixels(Pixels),
    /// To a length.
    Length(Length),
}

/// Takes a picture of a shape. Which way is up comes from the shape's frame, and is z where that does not say.
///
/// A smooth shape is meshed as finely as `fineness` says or, if it says nothing, to half a pixel of this very picture,
/// and the certificate says how far the triangles are from the true shape. Where then the eye is so close that no
/// length is half a pixel, a hundredth of a percent of the diagonal has to do, and a note says so.
///
/// # Errors
/// As for [`crate::mesh`]; also when the camera is none, or picture and triangles need more memory than the job allows.
///
/// ```
/// use chordal::render::Options;
/// use chordal_verbs::{Hint, load, render};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
/// let input = load(obj, Hint { name: Some("triangle.obj"), ..Hint::default() }, &Default::default())?;
/// let outcome = render(&input, &Options::sized(40, 30), None, &Default::default())?;
/// assert_eq!((outcome.picture.width, outcome.picture.height), (40, 30));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render(
    input: &Input,
    options: &Options,
    fineness: Option<Fineness>,
    job: &Job,
) -> Result<RenderOutcome, MeshFailure> {
    let mut certificate = Certificate::of(input);
    let options = Options { up: up(input.shape.frame()), ..*options };
    match &input.shape {
        Shape::Scene(scene) => {
            let mesh = placed::one_mesh(scene)?;
            shoot(&mesh, &options, certificate, job)
        }
        Shape::Drawing(_) | Shape::Curves(_) => Err(MeshFailure::Refused(Refusal {
            code: Code::Unsupported,
            message: "curves have no surface to take a picture of: mesh the drawing first, to a .glb"
                .to_owned(),
        })),
        Shape::Patches { patches, .. } => {
            let camera = camera_for(patches, &input.shape, &options, job)?;
            let Meshed { made, budget, note } =
                mesh_for(&input.shape, patches, fineness, &Shot { camera, job })?;
            certificate.notes.extend(note);
            certificate.budget = Some(BudgetFacts::of(&budget));
            certificate.bound = Some(BoundFacts::of(&made.bound));
            let options = Options { viewpoint: Viewpoint::Camera(camera), ..options };
            shoot(&made.shape, &options, certificate, job)
        }
    }
}

fn up(frame: &Frame) -> Up {
    match frame.up {
        Some(Axis::Y) => Up::Y,
        Some(Axis::Z) | None => Up::Z,
    }
}

fn shoot(
    mesh: &Mesh,
    options: &Options,
    mut certificate: Certificate,
    job: &Job,
) -> Result<RenderOutcome, MeshFailure> {
    certificate.output = Some(Output::Triangles(OutputFacts::of(mesh, Topology::Indices)));
    let camera = match options.viewpoint {
        Viewpoint::Automatic(screen) => frame(mesh, options.up, screen),
        Viewpoint::Camera(camera) => camera,
    };
    let picture = trace(mesh, options, job).map_err(|stopped| match stopped {
        Stopped::Refused(refusal) => MeshFailure::Refused(refusal),
        Stopped::Cancelled => MeshFailure::Cancelled,
    })?;
    Ok(RenderOutcome { picture, camera, certificate })
}

fn tessellate(patches: &[Patch], budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, MeshFailure> {
    convert::patches_to_mesh(patches, budget, job).map_err(|failure| match failure {
        Failure::Refused(refusal) => MeshFailure::Refused(refusal),
        Failure::Cancelled => MeshFailure::Cancelled,
        Failure::Unmet(best) => {
            let message = format!("the budget was not met; the best reached is {}", best.bound);
            MeshFailure::Refused(Refusal { code: Code::Budget, message })
        }
    })
}

/// The camera of the options, or one that frames a coarse mesh of the patches.
fn camera_for(patches: &[Patch], shape: &Shape, options: &Options, job: &Job) -> Result<Camera, MeshFailure> {
    let screen = match options.viewpoint {
        Viewpoint::Camera(camera) => return Ok(camera),
        Viewpoint::Automatic(screen) => screen,
    };
    let mesh = tessellate(patches, &share_of(shape, COARSE)?, job)?.shape;
    Ok(frame(&mesh, options.up, screen))
}

/// Of the diagonal: fine enough to say where a shape ends in a picture with a margin, and quickly made.
const COARSE: f64 = 0.002;
/// Triangles for a shape so small that it has no diagonal.
const FEW: u64 = 10_000;
/// Pixels that nobody sees, at the edges of a picture whose pixels are mixed of several rays.
const UNSEEN_PX: f64 = 0.5;
/// Of the diagonal, where the eye is too close for pixels: half a pixel of a picture 5,000 pixels wide that shows all.
const CLOSE_UP: f64 = 1e-4;

/// Triangles for a picture, the budget that they were made for, and how that came about if that is odd.
struct Meshed {
    made: Bounded<Mesh>,
    budget: Budget,
    note: Option<String>,
}

/// From where, and under which conditions.
struct Shot<'a> {
    camera: Camera,
    job: &'a Job,
}

fn mesh_for(
    shape: &Shape,
    patches: &[Patch],
    fineness: Option<Fineness>,
    shot: &Shot,
) -> Result<Meshed, MeshFailure> {
    let made = |(budget, note): (Budget, Option<String>)| {
        Ok(Meshed { made: tessellate(patches, &budget, shot.job)?, budget, note })
    };
    let at_camera = |pixels| Budget::pixels(pixels, View::Camera(shot.camera));
    match fineness {
        Some(Fineness::Pixels(pixels)) => made((at_camera(pixels), None)),
        Some(Fineness::Length(length)) => {
            made(BudgetSpec { length: Some(length), ..BudgetSpec::default() }.resolve(shape)?)
        }
        None => match Pixels::new(UNSEEN_PX).map(|pixels| made((at_camera(pixels), None))) {
            Ok(Err(MeshFailure::Refused(Refusal { code: Code::TooClose, .. }))) | Err(_) => {
                made((share_of(shape, CLOSE_UP)?, Some(TOO_CLOSE.to_owned())))
            }
            Ok(meshed) => meshed,
        },
    }
}

const TOO_CLOSE: &str =
    "the eye is too close for a bound in pixels: the mesh is made to 0.01% of the diagonal instead";

/// A share of the diagonal; a shape so small that it has none gets a few triangles.
fn share_of(shape: &Shape, share: f64) -> Result<Budget, MeshFailure> {
    Ok(Tolerance::new(shape.diagonal()? * share).map_or(Budget::triangles(FEW), Budget::length))
}

/// The screen of a picture if nobody says.
pub const USUAL_SCREEN: Screen = Screen { width_px: 1280, height_px: 960 };
