//! `chordal render`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::console::Console;
use crate::fault::Fault;
use crate::load;
use crate::numbers::{RoundingDirection, point, short};
use crate::options::TableArgs;
use crate::spelling::CommandLine;
use crate::summary;
use crate::verb_run::{RunArgs, VerbRun};
use crate::volume::VolumeArgs;
use chordal::Job;
use chordal::budget::View;
use chordal::budget::advice::Spell;
use chordal::budget::camera::Screen;
use chordal::render::DARKEST_LANES;
use chordal_io::PictureFormat;
use chordal_verbs::options::{PictureContent, PictureOptions};
use chordal_verbs::report::VerbFacts;
use chordal_verbs::{Input, RenderOutcome, render, render_against, render_comb};
use clap::Args;
use std::path::{Path, PathBuf};

/// `chordal render`
#[derive(Args, Debug)]
pub struct RenderArgs {
    #[command(flatten)]
    pub options: TableArgs<PictureOptions>,

    /// For --show deviation: the shape to compare with
    // Listed after --show, the first option of the table.
    #[arg(long, value_name = "FILE", display_order = 1)]
    pub against: Option<PathBuf>,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub volume: VolumeArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// Reads, renders, writes, reports.
pub fn run(args: &RenderArgs) -> Result<(), Fault> {
    let options = args.options.render_options();
    let options = options.map_err(|why| Fault::usage(why.spelled(&CommandLine).to_string()))?;
    let format = picture_format(&args.output.output)?;
    let run_args = RunArgs { input: &args.input, output: &args.output, console: &args.console };
    let mut run = VerbRun::start("render", run_args)?;
    let target = run.target()?;
    let mut input = run.read()?;
    let mut against = against(args, &run.job, &run.console)?;
    match &mut against {
        Some(against) => args.volume.apply_to_both([&mut input.shape, &mut against.shape])?,
        None => args.volume.apply(&mut input.shape)?,
    }
    let outcome = run.made(match against {
        Some(against) => render_against(input, against, args.options.darkest, &options, &run.job),
        None if args.options.content == PictureContent::Comb => render_comb(&input, &options, &run.job),
        None => render(&input, &options, args.options.tolerance, &run.job),
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
    let is_cost = matches!(outcome.certificate.verb, VerbFacts::Overshade { .. });
    let lanes = is_cost.then(|| {
        format!("lanes a pixel, light at 1, yellow 2, orange 4, red 8, darkest at {DARKEST_LANES} and more")
    });
    let legend = scale.or(lanes);
    legend.map_or(picture.clone(), |legend| format!("{picture}: {legend}"))
}

/// The shape of `--against`, which only `--show deviation` takes, and requires.
fn against(args: &RenderArgs, job: &Job, console: &Console) -> Result<Option<Input>, Fault> {
    match (args.options.content, &args.against) {
        (PictureContent::Deviation, Some(file)) => {
            let args = InputArgs { input: file.clone(), ..args.input.clone() };
            load::read_other(&args, job, console).map(Some)
        }
        (PictureContent::Deviation, None) => {
            Err(Fault::usage("--show deviation needs --against FILE, the shape to compare with"))
        }
        (_, Some(_)) => Err(Fault::usage("--against is for --show deviation")),
        (_, None) => Ok(None),
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
