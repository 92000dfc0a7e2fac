//! The job of a verb.
use crate::args::InputArgs;
use crate::console::Console;
use crate::signal;
use chordal::Job;

/// A job with the limits of the command line and a number of threads, 0 for all; signals cancel it.
pub fn job(input: &InputArgs, threads: usize, console: &Console) -> Job {
    let mut job = Job::default().with_threads(threads);
    job.memory_limit = input.memory_limit().unwrap_or(job.memory_limit);
    signal::install(job.cancel_flag());
    console.progress(job)
}
