//! `BatchJob`: what the process of one file is given, wherever it runs, and what comes of it.
use crate::fault::Fault;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// One file to do.
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
    /// The words behind those: the options.
    pub tail: Vec<OsString>,
    /// Where the processes of the batch write.
    pub work_folder: &'a Path,
    /// How long it may take.
    pub timeout: Option<Duration>,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobEnd {
    /// Where the output is, if there is one.
    pub made: PathBuf,
    /// The exit code of the process; none where it was ended from outside.
    pub exit: Option<i32>,
    /// Why there is none, in a sentence, and for programs where there is a word for it.
    pub why: Option<String>,
    /// The same for programs.
    pub code: Option<String>,
    /// What went to stdout.
    pub stdout: Vec<u8>,
    /// What went to stderr.
    pub stderr: Vec<u8>,
    /// How long it took, where it did not begin when it was given.
    pub seconds: Option<f64>,
}

impl JobEnd {
    /// The end of a process that took too long.
    pub fn timed_out(&mut self, timeout: Option<Duration>) {
        let limit = timeout.unwrap_or_default().as_secs_f64();
        self.why = Some(format!("stopped after {limit} s, which is the limit (--timeout)"));
    }
}

/// Why nothing came of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobFault {
    /// This file cannot be done.
    File(Fault),
    /// No file can be done any more.
    Batch(Fault),
}

/// The words that say where the output goes.
pub fn output_words(is_report: bool, output: &Path) -> Vec<OsString> {
    if is_report { Vec::new() } else { vec!["-o".into(), output.into()] }
}
