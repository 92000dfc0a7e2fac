//! The scripts that a file carries: written out, and run again to verify the file.
use crate::args::InputArgs;
use crate::beside::read_beside;
use crate::console::Console;
use crate::fault::Fault;
use crate::inspect_text::script_text;
use crate::load::limits;
use crate::spelling::CommandLine;
use crate::summary::SummaryLines;
use crate::verb_run::VerbRun;
use chordal::Job;
use chordal::budget::advice::Spell;
use chordal_verbs::report::{Certificate, Report, SourceFacts};
use chordal_verbs::{Input, carried_sources, load_carried};

/// Writes the script that a file carries.
///
/// # Errors
/// If the file carries none, or the output cannot be written.
pub fn write_script(mut run: VerbRun<'_>) -> Result<(), Fault> {
    let target = run.target()?;
    let input = run.read()?;
    let sources = carried_sources(&input);
    let Some(source) = sources.first() else {
        return Err(Fault::usage(format!(
            "{}: it carries no script: .glb, .gltf and .3mf that were made from one do, without --no-source",
            run.name()
        )));
    };
    let bytes = target.write(&mut |out| Ok(out.write_all(source.text.as_bytes())?))?;
    run.report(Certificate::from_input(&input), (target.name(), bytes), |report| {
        summary_text(report, &sources)
    })
}

/// The summary: the script, the parameters that were set, and what else it takes to run it.
fn summary_text(report: &Report, sources: &[SourceFacts]) -> String {
    let mut lines = SummaryLines::of_run(&report.run);
    lines.add_if("script", sources.first().map(script_text));
    if sources.len() > 1 {
        let others: Vec<&str> = sources[1..].iter().map(|source| &*source.name).collect();
        lines.add("note", format!("the file was combined from more scripts: {}", others.join(", ")));
    }
    let files = sources.first().map_or(&[][..], |source| &source.files);
    for file in files {
        let how = if file.text.is_some() {
            "its text is in the report of inspect --json"
        } else {
            "not in the file"
        };
        lines.add("note", format!("the script reads {}: {how}", file.path));
    }
    lines.finish_run(&report.run)
}

/// Runs the scripts that a file carries. Other files that they read have to stand beside that file.
///
/// # Errors
/// As for a script.
pub fn run_again(
    args: &InputArgs,
    sources: &[SourceFacts],
    job: &Job,
    console: &Console,
) -> Result<Vec<Input>, Fault> {
    let limits = limits(args);
    let run = |source: &SourceFacts| {
        let mut open = |path: &str| read_beside(&args.input, path, limits.bytes);
        let name = format!("{} in {}", source.name, args.input.display());
        let loaded = load_carried(source, &mut open, &limits, job).spelled(&CommandLine);
        let mut input = loaded.map_err(|error| Fault::input(error.code, format!("{name}: {error}")))?;
        args.read.complete(input.shape.frame_mut());
        console.detail(&format!("{name}: run again"));
        Ok(input)
    };
    sources.iter().map(run).collect()
}
