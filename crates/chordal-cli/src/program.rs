//! `Program`: the words that start this command again, and what comes with it.
use std::ffi::OsString;

/// How the program that the command is part of is started.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Program {
    /// The words before those of the command line.
    pub words: Vec<OsString>,
    /// The words before the address of a scheduler that start a client of a Dask cluster; none where there is no
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
