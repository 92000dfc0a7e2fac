//! `BatchJob` and `JobEnd`: the input and the outcome of the process for one file, on this machine or on a
//! cluster.
use crate::fault::Fault;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The job for one file.
#[derive(Clone, Debug)]
pub struct BatchJob<'a> {
    /// Its number in the batch.
    pub number: usize,
    /// The input.
    pub input: PathBuf,
    /// The name of the output.
    pub name: OsString,
    /// Whether the report is the output.
    pub is_report: bool,
    /// The words before those of the output: the verb and its input.
    pub head: Vec<OsString>,
    /// The words after those of the output: the options.
    pub tail: Vec<OsString>,
    /// The folder that the processes of the batch write to.
    pub work_folder: &'a Path,
    /// The time limit.
    pub timeout: Option<Duration>,
}

/// The outcome of a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobEnd {
    /// The path of the output, if there is one.
    pub output: PathBuf,
    /// The exit code of the process; `None` if it was killed.
    pub exit: Option<i32>,
    /// Why there is no exit code, as a sentence.
    pub why: Option<String>,
    /// The same as a code for programs, if there is one.
    pub code: Option<String>,
    /// The bytes written to stdout.
    pub stdout: Vec<u8>,
    /// The bytes written to stderr.
    pub stderr: Vec<u8>,
    /// The duration on a cluster, without the time that the job waited for a worker.
    pub seconds: Option<f64>,
}

impl JobEnd {
    /// The end of a process that took too long.
    pub fn timed_out(&mut self, timeout: Option<Duration>) {
        let limit = timeout.unwrap_or_default().as_secs_f64();
        self.why = Some(format!("stopped after {limit} s, which is the limit (--timeout)"));
    }
}

/// Why a job could not run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobFault {
    /// This job failed.
    File(Fault),
    /// No job of the batch can run any more.
    Batch(Fault),
}

/// The words for the output.
pub fn output_words(is_report: bool, output: &Path) -> Vec<OsString> {
    if is_report { Vec::new() } else { vec!["-o".into(), output.into()] }
}
