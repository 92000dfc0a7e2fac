//! `BatchRunner`: who runs the processes of a batch: this machine, or the workers of a cluster.
use super::bridge::Bridge;
use super::child;
use super::job::{BatchJob, JobEnd, JobFault, output_words};
use crate::fault::{Fault, plainly};
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Who does the files.
#[derive(Debug)]
pub enum BatchRunner<'a> {
    /// Processes of this machine.
    Here {
        /// The words that start this command again.
        program: &'a [OsString],
        /// How many run at once.
        jobs: usize,
    },
    /// The workers of a cluster.
    Cluster(Bridge),
}

impl BatchRunner<'_> {
    /// How many files it is given at once, at this moment: at least one.
    pub fn at_once(&self) -> usize {
        match self {
            Self::Here { jobs, .. } => *jobs,
            Self::Cluster(bridge) => bridge.at_once(),
        }
    }

    /// Does one file, and waits for its end.
    ///
    /// # Errors
    /// When no process can be started, or the cluster cannot be reached or has no use for the batch.
    pub fn run(&self, job: &BatchJob) -> Result<JobEnd, JobFault> {
        match self {
            Self::Here { program, .. } => run_here(program, job).map_err(JobFault::File),
            Self::Cluster(bridge) => bridge.run(job),
        }
    }
}

fn run_here(program: &[OsString], job: &BatchJob) -> Result<JobEnd, Fault> {
    // A folder of its own, where files beside the output get the names that it says.
    let folder = job.work_folder.join(job.number.to_string());
    if let Err(error) = fs::create_dir_all(&folder) {
        return Err(Fault::output("unwritable", format!("{}: {}", folder.display(), plainly(&error))));
    }
    let made = folder.join(&job.name);
    let end = child::run(&mut command(program, job, &made), job.timeout).map_err(|error| {
        let message = format!("the command cannot be started: {}", plainly(&error));
        Fault::output("not-started", message)
    })?;
    Ok(JobEnd { made, ..end })
}

fn command(program: &[OsString], job: &BatchJob, made: &Path) -> Command {
    let mut words = program.iter();
    let mut command = Command::new(words.next().cloned().unwrap_or_default());
    command.args(words).args(&job.head).args(output_words(job.is_report, made)).args(&job.tail);
    command
}
