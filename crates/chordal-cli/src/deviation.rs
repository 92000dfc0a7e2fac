//! `chordal deviation`
use crate::args::{ConsoleArgs, InputArgs};
use crate::clock::Clock;
use crate::console::{Console, StdoutUse};
use crate::execution;
use crate::fault::{Exit, Fault};
use crate::input::InputSource;
use crate::load;
use crate::numbers::{RoundingDirection, point, short};
use crate::options::TableArgs;
use crate::spelling::CommandLine;
use crate::summary::{self, SummaryLines};
use crate::volume::VolumeArgs;
use chordal::budget::advice::Spell;
use chordal_verbs::report::{DeviationFacts, OneSidedFacts, Report, RunFacts, Verdict};
use chordal_verbs::{DeviationSpec, deviation};
use clap::Args;
use std::path::PathBuf;

/// `chordal deviation`
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  chordal deviation simplified.obj original.obj
  chordal deviation teapot.glb teapot.bpt --max 0.1%
  chordal deviation bone.stl scan.nii.gz --iso 300
  chordal deviation a.stl b.stl --relative 0.01 --json")]
pub struct DeviationArgs {
    /// The shape to compare with. Input options apply to both shapes; those for fields and volumes only to
    /// inputs of that kind
    #[arg(value_name = "AGAINST", index = 2)]
    pub against: PathBuf,

    #[command(flatten)]
    pub options: TableArgs<DeviationSpec>,

    /// Number of threads; 0 uses all. The result does not depend on it
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub threads: usize,

    #[command(flatten)]
    pub volume: VolumeArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// Reads both shapes, measures, reports, and checks the limit.
pub fn run(args: &DeviationArgs) -> Result<(), Fault> {
    let clock = Clock::start();
    let console = Console::new(&args.console);
    let job = execution::job(&args.input, args.threads, &console);
    let (first, second) = (InputSource::from_arg(&args.input.input), InputSource::from_arg(&args.against));
    if matches!((&first, &second), (InputSource::Stdin, InputSource::Stdin)) {
        return Err(Fault::usage("only one of the two shapes can be stdin"));
    }
    let against = InputArgs { input: args.against.clone(), ..args.input.clone() };
    let [mut a, mut b] = load::read_both([&args.input, &against], &job, &console)?;
    args.volume.apply_to_both([&mut a.shape, &mut b.shape])?;
    let names = format!("{} and {}", first.name(), second.name());
    let mut report = deviation(a, b, &args.options, &job)
        .spelled(&CommandLine)
        .map_err(|failure| Fault::from_failure(&names, &failure))?;
    let run = RunFacts { input: Some(first.name()), ..report.run };
    report.run = clock.fill(run, &job);
    console.warn(&names, &report.certificate.notes);
    console.result(&report, &summary_text(&report, &second.name()), StdoutUse::Free)?;
    report.deviation().map_or(Ok(()), |facts| check(&names, &report, facts))
}

fn check(names: &str, report: &Report, facts: &DeviationFacts) -> Result<(), Fault> {
    let (Some(max), Some(bound)) = (facts.max, &report.certificate.bound) else { return Ok(()) };
    let max = short(max, RoundingDirection::Nearest);
    let line = match facts.verdict {
        Some(Verdict::Exceeds) => {
            let least = short(bound.at_least, RoundingDirection::Down);
            format!("{names}: they are at least {least} apart, which is more than {max}")
        }
        Some(Verdict::Undecided) => {
            format!("{names}: their distance is so close to {max} that neither side of it is proved")
        }
        Some(Verdict::Within) | None => return Ok(()),
    };
    Err(Fault { reported: true, ..Fault::new(Exit::CheckFailed, "deviation", line) })
}

/// The report for people.
fn summary_text(report: &Report, against: &str) -> String {
    let name = report.run.input.clone().unwrap_or_default();
    let mut lines = SummaryLines::titled(&format!("{name} <-> {against}"));
    if let (Some(bound), Some(facts)) = (&report.certificate.bound, report.deviation()) {
        lines.add("deviation", summary::bound(bound));
        if let Some(most) = bound.at_most.filter(|most| *most > 0.0 && facts.diagonal > 0.0) {
            let percent = 100.0 * most / facts.diagonal;
            lines.add(
                "",
                format!("at most {}% of the diagonal of the second", short(percent, RoundingDirection::Up)),
            );
        }
        lines.add("there", one_sided(&facts.forward));
        lines.add("back", one_sided(&facts.backward));
        if !facts.reached {
            lines.add("", "the ends are farther apart than was asked for; they hold all the same");
        }
        lines.add_if("limit", facts.verdict.zip(facts.max).map(|(verdict, max)| verdict_text(verdict, max)));
    }
    lines.add_if("seconds", report.run.seconds.map(|seconds| format!("{seconds:.2}")));
    lines.finish()
}

fn verdict_text(verdict: Verdict, max: f64) -> String {
    let max = short(max, RoundingDirection::Nearest);
    match verdict {
        Verdict::Within => format!("{max}: kept"),
        Verdict::Exceeds => format!("{max}: exceeded"),
        Verdict::Undecided => format!("{max}: neither kept nor exceeded for certain"),
    }
}

fn one_sided(side: &OneSidedFacts) -> String {
    let (least, most) =
        (short(side.at_least, RoundingDirection::Down), short(side.at_most, RoundingDirection::Up));
    if side.at_most == 0.0 {
        return "0".to_owned();
    }
    format!("between {least} and {most}, farthest {} -> {}", point(side.from), point(side.to))
}
