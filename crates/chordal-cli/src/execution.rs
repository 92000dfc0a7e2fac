//! The steps before a verb starts: its job, and the checks of its output.
use crate::args::{ConsoleArgs, InputArgs, OutputArgs};
use crate::console::{Console, StdoutUse};
use crate::fault::Fault;
use crate::overwrite::OverwritePolicy;
use crate::signal;
use chordal::Job;
use std::path::Path;

/// A job with the limits of the command line, cancelled by signals.
pub fn job(input: &InputArgs, output: Option<&OutputArgs>, console: &Console) -> Job {
    job_on_threads(input, output.map_or(0, |args| args.threads), console)
}

/// The same with a number of threads; 0 means all.
pub fn job_on_threads(input: &InputArgs, threads: usize, console: &Console) -> Job {
    let mut job = Job::default().with_threads(threads);
    job.memory_limit = input.memory_limit().unwrap_or(job.memory_limit);
    signal::install(job.cancel_flag());
    console.progress(job)
}

/// The policy that `--force` selects.
pub fn existing(args: &OutputArgs) -> OverwritePolicy {
    if args.force { OverwritePolicy::Replace } else { OverwritePolicy::Keep }
}

/// Whether stdout is free for a summary.
pub fn stdout(output: &OutputArgs, console: &ConsoleArgs) -> Result<StdoutUse, Fault> {
    stdout_for(&output.output, console)
}

/// The same for a path.
pub fn stdout_for(output: &Path, console: &ConsoleArgs) -> Result<StdoutUse, Fault> {
    match (output.as_os_str() == "-", console.json) {
        (true, true) => Err(Fault::usage("--json and '-o -' both write to stdout: choose one")),
        (true, false) => Ok(StdoutUse::HoldsData),
        (false, _) => Ok(StdoutUse::Free),
    }
}
