//! `chordal render`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::console::Console;
use crate::fault::Fault;
use crate::load;
use crate::numbers::{RoundingDirection, point, short};
use crate::summary;
use crate::verb_run::{RunArgs, VerbRun};
use crate::volume::VolumeArgs;
use chordal::Job;
use chordal::budget::camera::Screen;
use chordal::budget::{Length, Pixels, View};
use chordal::render::{CullMode as Culled, DARKEST_LANES, RenderOptions, RenderStyle as Shown, Viewpoint};
use chordal_io::PictureFormat;
use chordal_verbs::options::values::length;
use chordal_verbs::{
    Input, PictureTolerance, RenderOutcome, USUAL_SCREEN, render, render_against, render_comb,
};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

/// `chordal render`
#[derive(Args, Debug)]
pub struct RenderArgs {
    /// The contents of the picture
    #[arg(long, value_name = "WHAT", default_value = "shaded")]
    pub show: RenderMode,

    /// For --show deviation: the shape to compare with
    #[arg(long, value_name = "FILE")]
    pub against: Option<PathBuf>,

    /// For --show deviation: the distance of the darkest colour. Default: the largest one
    #[arg(long, value_name = "LENGTH", value_parser = length, requires = "against")]
    pub darkest: Option<Length>,

    /// Which sides of triangles are not drawn, as on a GPU
    #[arg(long, value_name = "SIDES", default_value = "none")]
    pub cull: CullArg,

    /// Size of the picture
    #[arg(long, value_name = "WxH", value_parser = size, conflicts_with = "view", allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,

    /// The camera, with the size of the picture: "1280x960 fov=30 eye=4,-6,3 target=0,0,1"
    #[arg(long, value_name = "VIEW")]
    pub view: Option<View>,

    /// For smooth shapes: maximum distance to the true shape
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pub tol: Option<Length>,

    /// For smooth shapes: maximum distance in the picture, in pixels. Default: 0.5
    #[arg(long, value_name = "PIXELS", allow_hyphen_values = true, conflicts_with = "tol")]
    pub px: Option<Pixels>,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub volume: VolumeArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// The contents of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RenderMode {
    /// Shaded, with the file's normals if it has some
    Shaded,
    /// Flat shaded
    Flat,
    /// The triangles' edges
    Wire,
    /// The direction of the normal as a colour
    Normals,
    /// Zebra stripes, as reflected by a mirror: a jump of the curvature shows as a kink of the stripes
    Zebra,
    /// The curvature along the paths of a drawing, as combs on the outer side of each bend
    Comb,
    /// How many lanes a GPU launches for each pixel, from light for one to dark for 16 and more; the report
    /// counts quads, helper lanes, triangles too small to be seen, and flicker
    Overshade,
    /// The distance from the shape of --against as a colour, from light through yellow and red to dark
    Deviation,
}

/// The sides of triangles that are not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CullArg {
    /// Both are drawn
    None,
    /// The backs: a triangle wound the wrong way is a hole
    Back,
    /// The fronts
    Front,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "expected a size like 1280x960".to_owned();
    let (width, height) = text.split_once('x').ok_or_else(wrong)?;
    let size = [width.parse().map_err(|_| wrong())?, height.parse().map_err(|_| wrong())?];
    if size.contains(&0) { Err("a picture is at least 1x1 pixels".into()) } else { Ok(size) }
}

/// Reads, renders, writes, reports.
pub fn run(args: &RenderArgs) -> Result<(), Fault> {
    let viewpoint = viewpoint(args)?;
    let format = picture_format(&args.output.output)?;
    let run_args = RunArgs { input: &args.input, output: &args.output, console: &args.console };
    let mut run = VerbRun::start("render", run_args)?;
    let target = run.target()?;
    let mut input = run.read()?;
    let options = RenderOptions {
        show: render_style(args.show),
        cull: cull_mode(args.cull),
        viewpoint,
        ..RenderOptions::default()
    };
    let mut against = against(args, &run.job, &run.console)?;
    match &mut against {
        Some(against) => args.volume.apply_to_both([&mut input.shape, &mut against.shape])?,
        None => args.volume.apply(&mut input.shape)?,
    }
    let outcome = run.made(match against {
        Some(against) => render_against(input, against, args.darkest, &options, &run.job),
        None if args.show == RenderMode::Comb => render_comb(&input, &options, &run.job),
        None => render(&input, &options, tolerance(args), &run.job),
    })?;
    let bytes = target.write(&mut |out| outcome.write(format, out))?;

    run.print_notes(&outcome.certificate);
    run.console.detail(&format!("the picture again: --view \"{}\"", View::Camera(outcome.camera)));
    let (picture, back_share) = (picture_text(&outcome), outcome.back_share);
    run.report(outcome.certificate, (target.name(), bytes), |report| {
        summary::render(report, &picture, back_share)
    })
}

/// The size of the picture, the eye, and the meaning of its colours.
fn picture_text(outcome: &RenderOutcome) -> String {
    let Screen { width_px, height_px } = outcome.camera.screen;
    let picture = format!("{width_px}x{height_px} from {}", point(outcome.camera.eye));
    let scale = outcome
        .darkest
        .map(|most| format!("distances, light at 0, darkest at {}", short(most, RoundingDirection::Nearest)));
    let lanes = outcome.certificate.overshade.as_ref().map(|_| {
        format!("lanes a pixel, light at 1, yellow 2, orange 4, red 8, darkest at {DARKEST_LANES} and more")
    });
    let legend = scale.or(lanes);
    legend.map_or(picture.clone(), |legend| format!("{picture}: {legend}"))
}

/// The shape of `--against`, which only `--show deviation` takes, and requires.
fn against(args: &RenderArgs, job: &Job, console: &Console) -> Result<Option<Input>, Fault> {
    match (args.show, &args.against) {
        (RenderMode::Deviation, Some(file)) => {
            let args = InputArgs { input: file.clone(), ..args.input.clone() };
            load::read_other(&args, job, console).map(Some)
        }
        (RenderMode::Deviation, None) => {
            Err(Fault::usage("--show deviation needs --against FILE, the shape to compare with"))
        }
        (_, Some(_)) => Err(Fault::usage("--against is for --show deviation")),
        (_, None) => Ok(None),
    }
}

/// The camera of `--view`, or one that frames the shape in a picture of `--size`.
fn viewpoint(args: &RenderArgs) -> Result<Viewpoint, Fault> {
    match args.view {
        Some(View::Camera(camera)) => Ok(Viewpoint::Camera(camera)),
        Some(View::MinDistance(_)) => Err(Fault::usage(
            "a picture needs a camera with a position: --view \"1280x960 fov=30 eye=4,-6,3 target=0,0,1\"",
        )),
        None => Ok(Viewpoint::Automatic(
            args.size.map_or(USUAL_SCREEN, |[width_px, height_px]| Screen { width_px, height_px }),
        )),
    }
}

fn tolerance(args: &RenderArgs) -> Option<PictureTolerance> {
    args.px.map(PictureTolerance::Pixels).or(args.tol.map(PictureTolerance::Length))
}

fn render_style(show: RenderMode) -> Shown {
    match show {
        RenderMode::Shaded => Shown::Shaded,
        RenderMode::Flat => Shown::Flat,
        RenderMode::Wire => Shown::Wire,
        RenderMode::Normals => Shown::Normals,
        RenderMode::Zebra => Shown::Zebra,
        RenderMode::Overshade => Shown::Overshade,
        // Distances are colours that are shaded as well; combs are drawn by `render_comb` in its own style.
        RenderMode::Deviation | RenderMode::Comb => Shown::Shaded,
    }
}

/// The format of the file extension; PNG without one, as for stdout.
fn picture_format(path: &Path) -> Result<PictureFormat, Fault> {
    let Some(extension) = path.extension() else { return Ok(PictureFormat::default()) };
    PictureFormat::from_extension(&extension.to_string_lossy()).ok_or_else(|| {
        Fault::usage(format!(
            "{}: pictures are written as PNG, JPEG or WebP: give a name that ends in .png, .jpg or .webp",
            path.display()
        ))
    })
}

fn cull_mode(cull: CullArg) -> Culled {
    match cull {
        CullArg::None => Culled::None,
        CullArg::Back => Culled::Back,
        CullArg::Front => Culled::Front,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_size_of_a_picture() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for text in ["", "640", "640x", "0x1", "1x1x1", "-1x5"] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
