//! `BatchRunner`: runs the processes of a batch, on this machine or on a cluster.
use super::bridge::Bridge;
use super::child;
use super::job::{BatchJob, JobEnd, JobFault, output_words};
use crate::fault::{Fault, plainly};
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::Command;

/// The machines that run the processes.
#[derive(Debug)]
pub enum BatchRunner<'a> {
    /// Processes of this machine.
    Here {
        /// The words that start this command again.
        program: &'a [OsString],
        /// The number of processes at once.
        jobs: usize,
    },
    /// The workers of a cluster.
    Cluster(Bridge),
}

impl BatchRunner<'_> {
    /// The number of files at once, at this moment; at least one.
    pub fn at_once(&self) -> usize {
        match self {
            Self::Here { jobs, .. } => *jobs,
            Self::Cluster(bridge) => bridge.at_once(),
        }
    }

    /// Runs one job, and waits for its end.
    ///
    /// # Errors
    /// If the process cannot be started, or the cluster cannot be reached or cannot run the batch.
    pub fn run(&self, job: &BatchJob) -> Result<JobEnd, JobFault> {
        match self {
            Self::Here { program, .. } => run_here(program, job).map_err(JobFault::File),
            Self::Cluster(bridge) => bridge.run(job),
        }
    }
}

fn run_here(program: &[OsString], job: &BatchJob) -> Result<JobEnd, Fault> {
    // One folder per job, so that side files can have the names by which the output references them.
    let folder = job.work_folder.join(job.number.to_string());
    if let Err(error) = fs::create_dir_all(&folder) {
        return Err(Fault::output("unwritable", format!("{}: {}", folder.display(), plainly(&error))));
    }
    let output = folder.join(&job.name);
    let end = child::run(&mut command(program, job, &output), job.timeout).map_err(|error| {
        let message = format!("the command cannot be started: {}", plainly(&error));
        Fault::output("not-started", message)
    })?;
    Ok(JobEnd { output, ..end })
}

fn command(program: &[OsString], job: &BatchJob, output: &Path) -> Command {
    let mut words = program.iter();
    let mut command = Command::new(words.next().cloned().unwrap_or_default());
    command.args(words).args(&job.head).args(output_words(job.is_report, output)).args(&job.tail);
    command
}
