//! `command`: the command `chordal`, for the script of that name that comes with the package.
use pyo3::prelude::*;
use std::ffi::OsString;

/// Run the command with these arguments, the program's name first, and return its exit code.
///
/// It is meant for a process of its own: SIGINT and SIGTERM are the command's from then on.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, args: Vec<OsString>) -> PyResult<u8> {
    // The program of this process is the interpreter, which takes more words to become the command.
    let interpreter: OsString = py.import("sys")?.getattr("executable")?.extract()?;
    let program = [interpreter, "-m".into(), "chordal".into()];
    Ok(py.detach(|| chordal_cli::run_started_by(args, &program)))
}
