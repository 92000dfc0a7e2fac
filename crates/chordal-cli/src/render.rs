//! `chordal render`
use crate::args::{InputArgs, RenderArgs, RenderMode};
use crate::clock::Clock;
use crate::common;
use crate::console::Console;
use crate::fault::Fault;
use crate::input::InputSource;
use crate::numbers::{RoundingDirection, point, short};
use crate::output::OutputTarget;
use crate::summary;
use chordal::budget::{Screen, View};
use chordal::render::{CullMode as Culled, DARKEST_LANES, RenderOptions, RenderStyle as Shown, Viewpoint};
use chordal_verbs::report::Report;
use chordal_verbs::{Input, PictureTolerance, USUAL_SCREEN, render, render_against};
use clap::ValueEnum;

/// Which sides of triangles a picture leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CullArg {
    /// Neither: both are shown
    None,
    /// The backs: a triangle wound the wrong way is a hole
    Back,
    /// The fronts
    Front,
}

/// Reads, renders, writes, reports.
pub fn run(args: &RenderArgs) -> Result<(), Fault> {
    let clock = Clock::start();
    let talk = Console::new(&args.console);
    let viewpoint = viewpoint(args)?;
    let stdout = common::stdout(&args.output, &args.console)?;
    let source = InputSource::from_arg(&args.input.input);
    let job = common::job(&args.input, Some(&args.output), &talk);
    let target = OutputTarget::prepare(&args.output.output, common::existing(&args.output), &source)?;
    let input = common::read(&args.input, &talk)?;

    let name = source.name();
    let options = RenderOptions {
        show: shown(args.show),
        cull: culling(args.cull),
        viewpoint,
        ..RenderOptions::default()
    };
    let against = against(args, &talk)?;
    let outcome = match against {
        Some(against) => render_against(input, against, args.darkest, &options, &job),
        None => render(&input, &options, fineness(args), &job),
    };
    let outcome = outcome.map_err(|failure| common::fault(&name, &failure, ""))?;
    let bytes = target.write(&mut |out| outcome.write(out))?;

    let run = common::run("render", name, &target, bytes);
    let report = Report::new(outcome.certificate, clock.fill(run, &job));
    report.certificate.notes.iter().for_each(|note| talk.detail(note));
    let Screen { width_px, height_px } = outcome.camera.screen;
    let picture = format!("{width_px}x{height_px} from {}", point(outcome.camera.eye));
    talk.detail(&format!("the picture again: --view \"{}\"", View::Camera(outcome.camera)));
    let scale = outcome
        .darkest
        .map(|most| format!("distances, light at 0, darkest at {}", short(most, RoundingDirection::Nearest)));
    let lanes = report.certificate.overshade.as_ref().map(|_| {
        format!("lanes a pixel, light at 1, yellow 2, orange 4, red 8, darkest at {DARKEST_LANES} and more")
    });
    let picture = scale.or(lanes).map_or(picture.clone(), |scale| format!("{picture}: {scale}"));
    talk.result(&report.to_value(), &summary::render(&report, &picture, outcome.back_share), stdout)
}

/// The shape of `--against`, which `--show deviation` needs and nothing else takes.
fn against(args: &RenderArgs, talk: &Console) -> Result<Option<Input>, Fault> {
    match (args.show, &args.against) {
        (RenderMode::Deviation, Some(file)) => {
            let args = InputArgs { input: file.clone(), ..args.input.clone() };
            common::read_other(&args, talk).map(Some)
        }
        (RenderMode::Deviation, None) => {
            Err(Fault::usage("--show deviation needs --against FILE to measure from"))
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
            "a picture is taken from one place: --view \"1280x960 fov=30 eye=4,-6,3 target=0,0,1\"",
        )),
        None => Ok(Viewpoint::Automatic(
            args.size.map_or(USUAL_SCREEN, |[width_px, height_px]| Screen { width_px, height_px }),
        )),
    }
}

fn fineness(args: &RenderArgs) -> Option<PictureTolerance> {
    args.px.map(PictureTolerance::Pixels).or(args.tol.map(PictureTolerance::Length))
}

fn shown(show: RenderMode) -> Shown {
    match show {
        RenderMode::Shaded => Shown::Shaded,
        RenderMode::Flat => Shown::Flat,
        RenderMode::Wire => Shown::Wire,
        RenderMode::Normals => Shown::Normals,
        RenderMode::Zebra => Shown::Zebra,
        RenderMode::Overshade => Shown::Overshade,
        // Colours over light.
        RenderMode::Deviation => Shown::Shaded,
    }
}

fn culling(cull: CullArg) -> Culled {
    match cull {
        CullArg::None => Culled::None,
        CullArg::Back => Culled::Back,
        CullArg::Front => Culled::Front,
    }
}
