//! `command`: the command `chordal`, for the script of that name that comes with the package.
use chordal_cli::{Program, run_started_by};
use pyo3::prelude::*;
use std::ffi::OsString;

/// Run the command with these arguments, the program's name first, and return its exit code. `program` are the words
/// that start it again, and `bridge` those before an address that start a client of a Dask cluster.
///
/// It is meant for a process of its own: SIGINT and SIGTERM are the command's from then on.
#[pyfunction]
pub(crate) fn command(
    py: Python<'_>,
    args: Vec<OsString>,
    program: Vec<OsString>,
    bridge: Vec<OsString>,
) -> u8 {
    // The program of this process is the interpreter, which takes more words to become the command.
    let program = Program { words: program, bridge: Some(bridge) };
    py.detach(|| run_started_by(args, &program))
}
