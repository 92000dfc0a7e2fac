//! `chordal verify`
use crate::args::{ConsoleArgs, InputArgs};
use crate::carried;
use crate::console::{Console, StdoutUse};
use crate::execution;
use crate::fault::{Exit, Fault};
use crate::input::InputSource;
use crate::load;
use crate::numbers::{RoundingDirection, short};
use crate::options::TableArgs;
use crate::spelling::CommandLine;
use crate::summary::SummaryLines;
use crate::volume::VolumeArgs;
use chordal::budget::advice::Spell;
use chordal_verbs::options::VerifyOptions;
use chordal_verbs::{
    ClaimFacts, ClaimVerdict, Input, VerifyReport, carried_sources, inputs_to_verify, n_coarser_levels,
    verify_levels,
};
use clap::Args;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// `chordal verify`
#[derive(Args, Debug)]
#[command(after_help = "\
Exit codes: 0 when every claim was re-proved, 1 when one is wrong, 6 when one is neither.

Examples:
  chordal verify teapot.glb --against teapot.bpt
  chordal verify part.glb
  chordal verify small.glb --against cage.obj smooth.ply grid.nrrd again.ply
  chordal verify part.stl --against part.3mf --certificate report.json --json")]
pub struct VerifyArgs {
    /// The source of IN; after several steps also the intermediate files, in any order. A script that IN carries need not
    /// be given
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub against: Vec<PathBuf>,

    /// The report that --json printed when IN was written, for formats without a certificate
    #[arg(long, value_name = "REPORT")]
    pub certificate: Option<PathBuf>,

    #[command(flatten)]
    pub options: TableArgs<VerifyOptions>,

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

/// Reads all files, verifies, reports.
pub fn run(args: &VerifyArgs) -> Result<(), Fault> {
    let console = Console::new(&args.console);
    let mut job = execution::job(&args.input, args.threads, &console);
    job.proof_effort = args.options.proof();
    let name = InputSource::from_arg(&args.input.input).name();
    let given = args.certificate.as_deref().map(read_report).transpose()?;
    // --surface applies to inputs that were read as cages, not to the output that was made from them.
    let mut output_args = args.input.clone();
    output_args.read.surface = None;
    let mut out = load::read_other(&output_args, &job, &console)?;
    let mut coarser = Vec::new();
    for level in 1..=n_coarser_levels(&out) {
        coarser.push(load::read_other(&InputArgs { level, ..output_args.clone() }, &job, &console)?);
    }
    let inputs = inputs_to_verify(&out, given.as_ref());
    let is_cage = |sha256: &str| {
        inputs.iter().any(|input| input.sha256.as_deref() == Some(sha256) && input.kind == "cage")
    };
    let mut against = Vec::with_capacity(args.against.len());
    for path in &args.against {
        let mut source_args = InputArgs { input: path.clone(), ..args.input.clone() };
        // The option names the format of the output, of which the files that it was made from know
        // nothing.
        source_args.read.from = None;
        against.push(load::read_of_digest(&source_args, is_cage, &job, &console)?);
    }
    let given_digests: Vec<_> = against.iter().filter_map(Input::sha256).map(str::to_owned).collect();
    let mut sources = carried_sources(&out);
    sources.retain(|source| !given_digests.contains(&source.sha256));
    if against.is_empty() && sources.is_empty() {
        return Err(Fault::usage(format!(
            "{name}: it carries no script: name its source with --against FILE"
        )));
    }
    against.extend(carried::run_again(&output_args, &sources, &job, &console)?);
    args.volume.apply_to_all(std::iter::once(&mut out).chain(&mut against).map(|input| &mut input.shape))?;
    let report = verify_levels((&out, &coarser), given.as_ref(), &against, &job)
        .spelled(&CommandLine)
        .map_err(|failure| Fault::from_failure(&name, &failure))?;
    console.result(&report, &summary_text(&name, &report), StdoutUse::Free)?;
    check(&name, &report)
}

/// The report of the run that wrote the file.
fn read_report(path: &Path) -> Result<Value, Fault> {
    let source = InputSource::File(path.to_owned());
    let bytes = source.read(MOST_BYTES)?;
    serde_json::from_slice(&bytes).map_err(|error| {
        Fault::input("not-json", format!("{}: this is not a report: {error}", source.name()))
    })
}

/// The most bytes of a report. Chosen: a thousand times a usual one.
const MOST_BYTES: u64 = 64 << 20;

fn check(name: &str, report: &VerifyReport) -> Result<(), Fault> {
    let (exit, code, verdict) = match report.verdict {
        ClaimVerdict::Proved => return Ok(()),
        ClaimVerdict::Refuted => (Exit::CheckFailed, "refuted", "is wrong"),
        ClaimVerdict::Open => (Exit::NotProved, "not-re-proved", "was not re-proved"),
    };
    let (claim, reason) = match report.worst() {
        Some(worst) => (&worst.claim[..], worst.reason.as_deref().unwrap_or("no reason is given")),
        None => ("certificate", "it claims nothing"),
    };
    let line = format!("{name}: the claim '{claim}' {verdict}: {reason}");
    Err(Fault { reported: true, ..Fault::new(exit, code, line) })
}

/// The report for people.
fn summary_text(name: &str, report: &VerifyReport) -> String {
    let mut lines = SummaryLines::titled(name);
    for claim in &report.claims {
        lines.add(verdict_name(claim.verdict), claim_text(claim));
    }
    let verdict = match report.verdict {
        ClaimVerdict::Proved => "every claim was re-proved",
        ClaimVerdict::Open => "not every claim was re-proved",
        ClaimVerdict::Refuted => "a claim is wrong",
    };
    if !report.unchecked.is_empty() {
        lines.add("not checked", report.unchecked.join(", "));
    }
    lines.add("verdict", verdict);
    lines.finish()
}

fn verdict_name(verdict: ClaimVerdict) -> &'static str {
    match verdict {
        ClaimVerdict::Proved => "re-proved",
        ClaimVerdict::Open => "open",
        ClaimVerdict::Refuted => "wrong",
    }
}

fn claim_text(claim: &ClaimFacts) -> String {
    let mut text = claim.claim.clone();
    if let Some((least, Some(most))) = claim.found {
        let ends = [(least, RoundingDirection::Down), (most, RoundingDirection::Up)];
        let [least, most] = ends.map(|(end, to)| short(end, to));
        text += &format!(": between {least} and {most}");
        if let Some(claimed) = claim.claimed {
            text += &format!(", at most {} claimed", short(claimed, RoundingDirection::Up));
        }
    }
    if let Some(reason) = &claim.reason {
        text += &format!(": {reason}");
    }
    text
}
