//! `chordal bake`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::clock::Clock;
use crate::console::Console;
use crate::execution;
use crate::fault::Fault;
use crate::input::InputSource;
use crate::load;
use crate::numbers::{RoundingDirection, grouped, point, short};
use crate::output::OutputTarget;
use crate::output_format::volume_format;
use crate::run_outcome;
use crate::spelling::CommandLine;
use crate::summary::{self, SummaryLines};
use chordal::budget::advice::Spell;
use chordal_io::Format;
use chordal_verbs::report::{DistanceGridFacts, Report, RunFacts};
use chordal_verbs::{BakeSpec, bake};
use clap::Args;

/// `chordal bake`
#[derive(Args, Debug)]
#[command(after_help = "\
Samples are f64, negative inside. A mesh that is no solid is baked too, and a warning says what its sides rest on.

Examples:
  chordal bake part.stl --cells 128 -o part.nrrd
  chordal bake part.stl --cells 512 --band 3 -o part.npy
  chordal bake scan.ply --cells 200 -o scan.nrrd && chordal mesh scan.nrrd -o closed.ply")]
pub struct BakeArgs {
    /// The format of the output, npy or nrrd, instead of what its name says
    #[arg(long, value_name = "FORMAT")]
    pub to: Option<Format>,

    /// Cubes along the longest side of the mesh's box; a margin comes on top
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub cells: u64,

    /// Distances only within so many cells of the surface, and the band's width with a sign elsewhere
    #[arg(long, value_name = "W", value_parser = band, allow_hyphen_values = true)]
    pub band: Option<f64>,

    /// Prove how far the surface of the samples, where their interpolant vanishes, is from the triangles, so that the
    /// bounds of what is made of the samples add to it
    #[arg(long)]
    pub bound: bool,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

fn band(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(width) if width > 0.0 && width <= 1e6 => Ok(width),
        _ => Err("a band is a number of cells above 0 and up to a million".to_owned()),
    }
}

/// Reads, samples, writes, reports.
pub fn run(args: &BakeArgs) -> Result<(), Fault> {
    let clock = Clock::start();
    let console = Console::new(&args.console);
    let to = volume_format(&args.output.output, args.to)?;
    let stdout = execution::stdout(&args.output, &args.console)?;
    let source = InputSource::from_arg(&args.input.input);
    let job = execution::job(&args.input, Some(&args.output), &console);
    let target = OutputTarget::prepare(&args.output.output, execution::existing(&args.output), &source)?;
    let input = load::read(&args.input, &job, &console)?;
    load::refuse_files(&args.output.output, &args.input, &input)?;
    let input_triangles = input.shape.n_triangles();
    let name = source.name();
    let spec = BakeSpec { cells: args.cells as usize, band: args.band, is_bounded: args.bound };
    let outcome = bake(input, &spec, to, &job)
        .spelled(&CommandLine)
        .map_err(|failure| run_outcome::fault(&name, &failure, ""))?;
    if let Some(facts) = outcome.certificate.baked.as_ref().filter(|facts| !facts.solid.is_solid) {
        console.warn(&name, &[&facts.solid.sentence]);
    }
    let bytes = target.write(&mut |out| outcome.write(out))?;
    let run = RunFacts { input_triangles, ..run_outcome::facts("bake", name, target.name(), bytes) };
    let report = Report::new(outcome.certificate, clock.fill(run, &job));
    report.certificate.notes.iter().for_each(|note| console.detail(note));
    console.result(&report, &summary_text(&report), stdout)
}

fn summary_text(report: &Report) -> String {
    let mut lines = SummaryLines::of_run(&report.run);
    if let Some(facts) = &report.certificate.baked {
        add_grid(&mut lines, facts);
    }
    lines.add_if("surface", report.certificate.bound.as_ref().map(summary::bound));
    lines.finish_run(&report.run)
}

fn add_grid(lines: &mut SummaryLines, facts: &DistanceGridFacts) {
    let [x, y, z] = facts.size.map(grouped);
    lines.add(
        "samples",
        format!("{x} x {y} x {z} of f64, {} apart", short(facts.spacing, RoundingDirection::Nearest)),
    );
    lines.add("origin", point(facts.origin));
    let band = facts.band.map(|band| {
        format!(
            "{} samples within {} are distances",
            grouped(facts.distances),
            short(band, RoundingDirection::Nearest)
        )
    });
    lines.add_if("band", band);
    let off = short(facts.off_at_most, RoundingDirection::Up);
    lines.add("distances", format!("off by at most {off} ({})", facts.evidence));
    let sides =
        if facts.solid.closed { "known for sure" } else { "by winding numbers, sure only away from holes" };
    lines.add("sides", sides);
    lines.add("solid", if facts.solid.is_solid { "yes" } else { "no" });
}
