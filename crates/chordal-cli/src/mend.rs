//! `chordal mend`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::clock::Clock;
use crate::console::Console;
use crate::execution;
use crate::fault::Fault;
use crate::input::InputSource;
use crate::load;
use crate::numbers::grouped;
use crate::output::OutputTarget;
use crate::output_format::output_format;
use crate::output_set::OutputSetArgs;
use crate::output_set_write::SetPlace;
use crate::run_outcome;
use crate::spelling::CommandLine;
use crate::summary::{self, plural};
use chordal::budget::Length;
use chordal::budget::advice::Spell;
use chordal_io::Format;
use chordal_verbs::options::values::length;
use chordal_verbs::report::{FindingFacts, RepairFacts, Report, RunFacts, ValidityFacts};
use chordal_verbs::{Duplicates, HoleSelection, MendSpec, NestedShells, WeldTolerance, mend};
use clap::{ArgGroup, Args, ValueEnum};
use std::fmt::Write;
use std::io;

/// `chordal mend`
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("orients").multiple(true).args(["all", "orient"]))]
#[command(group = ArgGroup::new("cures").required(true).multiple(true).args([
    "all", "weld", "drop_duplicates", "drop_degenerate", "resolve_t_junctions", "split_nonmanifold", "orient", "fill_holes",
    "drop_unused",
]))]
#[command(after_help = "\
Repairs are applied in the order of this list, whatever the order on the command line. Nothing else is changed.

Examples:
  chordal mend scan.stl -o print.3mf --all --unit mm
  chordal mend scan.stl -o scan.obj --weld --drop-degenerate --orient
  chordal mend part.obj -o part.glb --weld=0.01mm --unit mm --fill-holes=20
  chordal inspect broken.ply && chordal mend broken.ply -o whole.ply --split-nonmanifold --orient --fill-holes")]
pub struct MendArgs {
    /// Output format, if not the one that the file name implies
    #[arg(long, value_name = "FORMAT")]
    pub to: Option<Format>,

    /// All repairs of this list, exactly and for all holes unless other options say otherwise: what a 3D
    /// print needs
    #[arg(long)]
    pub all: bool,

    /// Merge vertices with the same coordinates, or within a length of each other
    #[arg(long, value_name = "LENGTH", value_parser = length, num_args = 0..=1, require_equals = true)]
    pub weld: Option<Option<Length>>,

    /// Drop faces that repeat an earlier one, whatever their winding, or only those wound alike
    #[arg(long, value_name = "WHICH", num_args = 0..=1, require_equals = true, default_missing_value = "any")]
    pub drop_duplicates: Option<DuplicatesArg>,

    /// Drop faces without area, without opening cracks
    #[arg(long)]
    pub drop_degenerate: bool,

    /// Split faces where a vertex lies on their edge: exactly, or within a length
    #[arg(long, value_name = "LENGTH", value_parser = length, num_args = 0..=1, require_equals = true)]
    pub resolve_t_junctions: Option<Option<Length>>,

    /// Split the surface at edges with three or more faces and at vertices with several fans
    #[arg(long)]
    pub split_nonmanifold: bool,

    /// Wind faces consistently and closed pieces outwards; pieces inside others turn with them, unless
    /// --nested is given
    #[arg(long)]
    pub orient: bool,

    /// For a closed piece inside another that faces the same way: keep it solid, as it is wound, or turn it
    /// into a cavity
    #[arg(long, value_name = "WHICH", default_value = "keep", requires = "orients")]
    pub nested: NestedArg,

    /// Fill holes: all, or those with at most EDGES edges
    #[arg(long, value_name = "EDGES", num_args = 0..=1, require_equals = true)]
    pub fill_holes: Option<Option<usize>>,

    /// Drop vertices that no face uses
    #[arg(long)]
    pub drop_unused: bool,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub set: OutputSetArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// Which repeated faces are dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DuplicatesArg {
    /// With any winding
    Any,
    /// Only with the same winding
    Alike,
}

/// The orientation of closed pieces inside others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NestedArg {
    /// As they are wound relative to the piece around them
    Keep,
    /// Inwards within an odd number of others, outwards within an even number
    Cavity,
}

impl NestedArg {
    fn shells(self) -> NestedShells {
        match self {
            Self::Keep => NestedShells::Keep,
            Self::Cavity => NestedShells::Cavity,
        }
    }
}

/// Reads, mends, writes, reports.
pub fn run(args: &MendArgs) -> Result<(), Fault> {
    let clock = Clock::start();
    let console = Console::new(&args.console);
    let to = output_format(&args.output.output, args.to)?;
    let stdout = execution::stdout(&args.output, &args.console)?;
    let source = InputSource::from_arg(&args.input.input);
    let job = execution::job(&args.input, Some(&args.output), &console);
    let target = OutputTarget::prepare(&args.output.output, execution::existing(&args.output), &source)?;
    args.set.check(&target, to)?;
    let input = load::read(&args.input, &job, &console)?;
    load::refuse_files(&args.output.output, &args.input, &input)?;
    let input_triangles = input.shape.n_triangles();
    let name = source.name();
    let outcome = mend(input, &args.spec(), args.set.form(to), &job)
        .spelled(&CommandLine)
        .map_err(|failure| run_outcome::fault(&name, &failure, ""))?;
    let write_single = &mut |out: &mut dyn io::Write| outcome.write(out);
    let input = &*args.input.input;
    let place = SetPlace { target: &target, input, console: &console, names_files: outcome.names_files() };
    let bytes =
        args.set.write(&place, &outcome.certificate, write_single, |stem| outcome.write_files(stem))?;
    let run = RunFacts { input_triangles, ..run_outcome::facts("mend", name, target.name(), bytes) };
    let report = Report::new(outcome.certificate, clock.fill(run, &job));
    console.result(&report, &summary_text(&report), stdout)
}

impl MendArgs {
    fn spec(&self) -> MendSpec {
        let weld_tolerance =
            |length: Option<Length>| length.map_or(WeldTolerance::Exact, WeldTolerance::Within);
        let base = if self.all { MendSpec::ALL } else { MendSpec::default() };
        MendSpec {
            weld: self.weld.map(weld_tolerance).or(base.weld),
            drop_duplicates: self
                .drop_duplicates
                .map(|which| match which {
                    DuplicatesArg::Any => Duplicates::EitherWay,
                    DuplicatesArg::Alike => Duplicates::SameWay,
                })
                .or(base.drop_duplicates),
            drop_degenerate: self.drop_degenerate || base.drop_degenerate,
            resolve_t_junctions: self.resolve_t_junctions.map(weld_tolerance).or(base.resolve_t_junctions),
            split_non_manifold: self.split_nonmanifold || base.split_non_manifold,
            orient: self.orient || base.orient,
            nested: self.nested.shells(),
            fill_holes: self
                .fill_holes
                .map(|most| most.map_or(HoleSelection::All, HoleSelection::UpTo))
                .or(base.fill_holes),
            drop_unused: self.drop_unused || base.drop_unused,
        }
    }
}

/// The repairs, inserted after the title of the usual summary.
fn summary_text(report: &Report) -> String {
    let certificate = &report.certificate;
    let summary = summary::mesh(report);
    let (title, rest) = summary.split_once('\n').unwrap_or((&summary, ""));
    let mut text = format!("{title}\n");
    let mut name = "mended";
    for facts in &certificate.mended {
        // Writing to a text does not fail.
        let _ = writeln!(text, "  {name:<11} {}: {}", facts.cure, changes_text(facts));
        name = "";
    }
    if certificate.was_split()
        && certificate.valid.as_ref().is_some_and(|valid| valid.topology == "positions")
    {
        text +=
            "  but         this format merges equal positions, which undoes the split; write OBJ or PLY\n";
    }
    text += rest;
    for (name, valid) in [("before", &certificate.valid_before), ("after", &certificate.valid)] {
        if let Some(valid) = valid {
            let _ = writeln!(text, "  {name:<11} {}", faults(valid));
        }
    }
    // Both need a search, which `inspect` does: the counts of edges do not show them.
    let _ = writeln!(text, "  {:<11} {NOT_CHECKED}", "");
    certificate.notes.iter().for_each(|note| {
        let _ = writeln!(text, "  {:<11} {note}", "note");
    });
    text
}

/// The faults that the lines before and after do not cover.
const NOT_CHECKED: &str = "not checked: components inside out, self-intersections";

fn changes_text(facts: &RepairFacts) -> String {
    let texts: Vec<String> =
        facts.changes.iter().map(|change| change_text(change.what, change.count)).collect();
    if texts.is_empty() { "nothing".to_owned() } else { texts.join(", ") }
}

/// `filled_holes` and 1 as `filled 1 hole`.
fn change_text(what: &str, count: u64) -> String {
    let (verb, noun) = match what {
        "left_unorientable" => ("left", "piece of one side only"),
        "left_t_junctions" => ("left", "T-junction"),
        "resolved_t_junctions" => ("resolved", "T-junction"),
        "left_nested_shells" => ("left", "shell within another"),
        "turned_nested_shells" => ("turned", "shell within another"),
        _ => what.split_once('_').unwrap_or(("", what)),
    };
    let singular = match noun {
        "vertices" => "vertex",
        noun => noun.strip_suffix('s').unwrap_or(noun),
    };
    format!("{verb} {}", plural(count, singular))
}

/// The findings of `inspect` that counts alone can show.
fn faults(valid: &ValidityFacts) -> String {
    if !valid.has_triangles() {
        return "no triangles".to_owned();
    }
    let findings: Vec<String> = FindingFacts::list(valid)
        .iter()
        .map(|finding| format!("{} {}", grouped(finding.count), finding.words))
        .collect();
    if findings.is_empty() { "none of the checked faults".to_owned() } else { findings.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_read_as_sentences() {
        assert_eq!(change_text("filled_holes", 1), "filled 1 hole");
        assert_eq!(change_text("split_vertices", 1), "split 1 vertex");
        assert_eq!(change_text("split_vertices", 2000), "split 2,000 vertices");
        assert_eq!(change_text("left_unorientable", 2), "left 2 pieces of one side only");
        assert_eq!(change_text("resolved_t_junctions", 1), "resolved 1 T-junction");
    }
}
