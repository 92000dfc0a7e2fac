//! The steps around a verb that makes one thing of another: its job, where its output goes, what went wrong.
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::console::{Console, StdoutUse};
use crate::fault::{Exit, Fault};
use crate::output::OverwritePolicy;
use crate::signal;
use chordal::Job;
use chordal_verbs::MeshFailure;
use chordal_verbs::report::RunFacts;
use std::path::Path;

/// A job that obeys the command line and signals.
pub fn job(input: &InputArgs, output: Option<&OutputArgs>, console: &Console) -> Job {
    job_on_threads(input, output.map_or(0, |args| args.threads), console)
}

/// The same on so many threads; 0 means all.
pub fn job_on_threads(input: &InputArgs, threads: usize, console: &Console) -> Job {
    let mut job = Job::default().with_threads(threads);
    job.memory_limit = input.memory_limit().unwrap_or(job.memory_limit);
    signal::install(job.cancel_flag());
    console.progress(job)
}

/// What `--force` says.
pub fn existing(args: &OutputArgs) -> OverwritePolicy {
    if args.force { OverwritePolicy::Replace } else { OverwritePolicy::Keep }
}

/// A run of a verb that made one thing of another and wrote it.
pub fn facts(verb: &'static str, input: String, output: String, bytes: u64) -> RunFacts {
    RunFacts { verb, input: Some(input), output: Some(output), bytes: Some(bytes), ..RunFacts::default() }
}

/// Whether a summary can go to stdout.
pub fn stdout(output: &OutputArgs, console: &ConsoleArgs) -> Result<StdoutUse, Fault> {
    stdout_for(&output.output, console)
}

/// The same for an output of that name.
pub fn stdout_for(output: &Path, console: &ConsoleArgs) -> Result<StdoutUse, Fault> {
    match (output.as_os_str() == "-", console.json) {
        (true, true) => Err(Fault::usage("--json and '-o -' both write to stdout: choose one")),
        (true, false) => Ok(StdoutUse::HoldsData),
        (false, _) => Ok(StdoutUse::Free),
    }
}

/// The fault of a verb that failed on the input of that name. `best` is said where a best result is at hand.
pub fn fault(name: &str, failure: &MeshFailure, best: &str) -> Fault {
    let exit = match failure.exit_code() {
        2 => Exit::Usage,
        3 => Exit::Input,
        4 => Exit::Output,
        130 => return Fault::interrupted(),
        _ => Exit::Budget,
    };
    let hint = if matches!(failure, MeshFailure::Unmet(_)) { best } else { "" };
    Fault::new(exit, failure.code(), format!("{name}: {failure}{hint}"))
}
