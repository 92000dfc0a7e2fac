//! `chordal render`
use crate::args::{InputArgs, RenderArgs, Show};
use crate::clock::Clock;
use crate::common;
use crate::fault::Fault;
use crate::input::Source;
use crate::numbers::{Toward, point, short};
use crate::output::Target;
use crate::summary;
use crate::talk::Talk;
use chordal::budget::{Screen, View};
use chordal::render::{Cull as Culled, DARKEST_LANES, Options, Show as Shown, Viewpoint};
use chordal_verbs::report::Report;
use chordal_verbs::{Fineness, Input, USUAL_SCREEN, render, render_against};
use clap::ValueEnum;

/// Which sides of triangles a picture leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Cull {
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
    let talk = Talk::new(&args.talk);
    let viewpoint = viewpoint(args)?;
    let stdout = common::stdout(&args.output, &args.talk)?;
    let source = Source::from_arg(&args.input.input);
    let job = common::job(&args.input, Some(&args.output), &talk);
    let target = Target::prepare(&args.output.output, common::existing(&args.output), &source)?;
    let input = common::read(&args.input, &talk)?;

    let name = source.name();
    let options =
        Options { show: shown(args.show), cull: culled(args.cull), viewpoint, ..Options::default() };
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
        .map(|most| format!("distances, light at 0, darkest at {}", short(most, Toward::Nearest)));
    let lanes = report.certificate.overshade.as_ref().map(|_| {
        format!("lanes a pixel, light at 1, yellow 2, orange 4, red 8, darkest at {DARKEST_LANES} and more")
    });
    let picture = scale.or(lanes).map_or(picture.clone(), |scale| format!("{picture}: {scale}"));
    talk.result(&report.to_value(), &summary::render(&report, &picture, outcome.back_share), stdout)
}

/// The shape of `--against`, which `--show deviation` needs and nothing else takes.
fn against(args: &RenderArgs, talk: &Talk) -> Result<Option<Input>, Fault> {
    match (args.show, &args.against) {
        (Show::Deviation, Some(file)) => {
            let args = InputArgs { input: file.clone(), ..args.input.clone() };
            common::read_other(&args, talk).map(Some)
        }
        (Show::Deviation, None) => Err(Fault::usage("--show deviation needs --against FILE to measure from")),
        (_, Some(_)) => Err(Fault::usage("--against is for --show deviation")),
        (_, None) => Ok(None),
    }
}

/// The camera of `--view`, or one that frames the shape in a picture of `--size`.
fn viewpoint(args: &RenderArgs) -> Result<Viewpoint, Fault> {
    match args.view {
        Some(View::Camera(camera)) => Ok(Viewpoint::Camera(camera)),
        Some(View::Closest(_)) => Err(Fault::usage(
            "a picture is taken from one place: --view \"1280x960 fov=30 eye=4,-6,3 target=0,0,1\"",
        )),
        None => Ok(Viewpoint::Automatic(
            args.size.map_or(USUAL_SCREEN, |[width_px, height_px]| Screen { width_px, height_px }),
        )),
    }
}

fn fineness(args: &RenderArgs) -> Option<Fineness> {
    args.px.map(Fineness::Pixels).or(args.tol.map(Fineness::Length))
}

fn shown(show: Show) -> Shown {
    match show {
        Show::Shaded => Shown::Shaded,
        Show::Flat => Shown::Flat,
        Show::Wire => Shown::Wire,
        Show::Normals => Shown::Normals,
        Show::Zebra => Shown::Zebra,
        Show::Overshade => Shown::Overshade,
        // Colours over light.
        Show::Deviation => Shown::Shaded,
    }
}

fn culled(cull: Cull) -> Culled {
    match cull {
        Cull::None => Culled::None,
        Cull::Back => Culled::Back,
        Cull::Front => Culled::Front,
    }
}
