//! Repairs, from Python's arguments.
use crate::failure;
use crate::outcome::{MeshTask, Outcome};
use crate::source::Source;
use crate::spec::{GivenOptions, request};
use chordal_io::{Format, UnknownFormat};
use chordal_verbs::options::MendOptions;
use pyo3::prelude::*;

/// The triangles after repairs, rounded as in a file of a format.
#[pyfunction]
pub(crate) fn mend(
    py: Python<'_>,
    source: &Source,
    options: GivenOptions,
    format: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<Outcome> {
    let to: Format = format.parse().map_err(|error: UnknownFormat| failure::argument("format", error))?;
    let repairs: MendOptions = request(py, &options)?;
    Outcome::new(py, source.order(MeshTask::Mend(repairs.spec())), to.into(), progress)
}
