//! `Program`: the words that start this command again.
use std::ffi::OsString;

/// How to start the program that contains the command.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Program {
    /// The words before those of the command line.
    pub words: Vec<OsString>,
    /// The words that start a client of a Dask cluster, without the address of its scheduler; `None` without
    /// Python.
    pub bridge: Option<Vec<OsString>>,
}

impl Program {
    /// The program of this process.
    #[must_use]
    pub fn own() -> Self {
        Self { words: std::env::current_exe().ok().map(OsString::from).into_iter().collect(), bridge: None }
    }
}
