//! `chordal mend`
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::fault::Fault;
use crate::numbers::grouped;
use crate::options::TableArgs;
use crate::output_format::output_format;
use crate::output_set::OutputSetArgs;
use crate::summary::{self, plural};
use crate::verb_run::{RunArgs, VerbRun};
use chordal_verbs::mend;
use chordal_verbs::options::MendOptions;
use chordal_verbs::report::{FindingFacts, RepairFacts, Report, ValidityFacts, VerbFacts};
use clap::Args;
use std::fmt::Write;

/// `chordal mend`
#[derive(Args, Debug)]
#[command(after_help = "\
Repairs run in the order of this list, whatever the order on the command line. Nothing else is changed.

Examples:
  chordal mend scan.stl -o print.3mf --all --unit mm
  chordal mend scan.stl -o scan.obj --weld --drop-degenerate --orient
  chordal mend part.obj -o part.glb --weld=0.01mm --unit mm --fill-holes=20
  chordal inspect broken.ply && chordal mend broken.ply -o whole.ply --split-nonmanifold --orient --fill-holes")]
pub struct MendArgs {
    #[command(flatten)]
    pub repairs: TableArgs<MendOptions>,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub set: OutputSetArgs,

    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// Reads, mends, writes, reports.
pub fn run(args: &MendArgs) -> Result<(), Fault> {
    let to = output_format(&args.output.output, args.repairs.to())?;
    let run_args = RunArgs { input: &args.input, output: &args.output, console: &args.console };
    let mut run = VerbRun::start("mend", run_args)?;
    let target = run.target()?;
    let form = args.set.form_for(&target, to)?;
    let input = run.read()?;
    let mut outcome = run.made(mend(input, &args.repairs.spec(), form, &run.job))?;
    args.set.strip(&mut outcome.certificate);
    let place = run.place(&target, outcome.names_files());
    let write_set = |stem: &str| outcome.write_files(stem);
    let bytes = args.set.write(&place, &outcome.certificate, &mut |out| outcome.write(out), write_set)?;
    run.report(outcome.certificate, (target.name(), bytes), summary_text)
}

/// The repairs, inserted after the title of the usual summary.
fn summary_text(report: &Report) -> String {
    let certificate = &report.certificate;
    let summary = summary::mesh(report);
    let (title, rest) = summary.split_once('\n').unwrap_or((&summary, ""));
    let mut text = format!("{title}\n");
    let mut name = "mended";
    for facts in certificate.verb.repairs() {
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
    let before = match &certificate.verb {
        VerbFacts::Mended { valid_before, .. } => Some(&**valid_before),
        _ => None,
    };
    for (name, valid) in [("before", before), ("after", certificate.valid.as_ref())] {
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
