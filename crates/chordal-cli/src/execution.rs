//! The steps before a verb that makes one thing of another: its job, and where its output goes.
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::console::{Console, StdoutUse};
use crate::fault::Fault;
use crate::overwrite::OverwritePolicy;
use crate::signal;
use chordal::Job;
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
