//! `command`: the command `chordal`, for the script of that name in the package.
use chordal_cli::{Program, run_started_by};
use pyo3::prelude::*;
use std::ffi::OsString;

/// Run the command with these arguments, the program's name first, and return its exit code. `program` are
/// the words that start the command again; `bridge` are the words before the address that start a client of a
/// Dask cluster.
///
/// It takes over the process: from then on the command handles SIGINT and SIGTERM.
#[pyfunction]
pub(crate) fn command(
    py: Python<'_>,
    args: Vec<OsString>,
    program: Vec<OsString>,
    bridge: Vec<OsString>,
) -> u8 {
    // The executable of this process is Python's, which needs more words to start the command.
    let program = Program { words: program, bridge: Some(bridge) };
    py.detach(|| run_started_by(args, &program))
}
