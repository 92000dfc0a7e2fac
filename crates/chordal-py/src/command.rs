//! `command`: the command `chordal`, for the script of that name that comes with the package.
use pyo3::prelude::*;
use std::ffi::OsString;

/// Run the command with these arguments, the program's name first, and return its exit code.
///
/// It is meant for a process of its own: SIGINT and SIGTERM are the command's from then on.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, args: Vec<OsString>) -> u8 {
    py.detach(|| chordal_cli::run(args))
}
