//! Errors as Python exceptions: those of `chordal._errors`, with fields for programs.
use crate::spelling::Keywords;
use chordal::budget::Refusal;
use chordal::budget::advice::Spell;
use chordal_io::{FileLocation, ReadError, WriteError};
use chordal_verbs::MeshFailure;
use pyo3::call::PyCallArgs;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The exception of a name, or the error that its creation raised.
fn exception<'py>(py: Python<'py>, name: &str, args: impl PyCallArgs<'py>) -> PyErr {
    let exception = py.import("chordal._errors").and_then(|errors| errors.getattr(name)?.call1(args));
    exception.map_or_else(|error| error, PyErr::from_value)
}

/// A bug in this library.
pub(crate) fn internal(py: Python<'_>, message: &str) -> PyErr {
    exception(py, "InternalError", (message,))
}

/// An invalid budget.
pub(crate) fn budget(py: Python<'_>, message: &str) -> PyErr {
    exception(py, "BudgetError", (message,))
}

/// An invalid argument.
pub(crate) fn argument(name: &str, error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(format!("{name}: {error}"))
}

/// Bytes that cannot be read. `source` is their file, if they are from one.
pub(crate) fn read(py: Python<'_>, error: ReadError, source: Option<&str>) -> PyErr {
    let error = error.spelled(&Keywords);
    let place = match &error.place {
        FileLocation::File => None,
        place => Some(place.to_string()),
    };
    exception(py, "ReadError", (error.code, place, &*error.message, source))
}

/// A shape that a format cannot hold.
pub(crate) fn write(py: Python<'_>, error: &WriteError) -> PyErr {
    exception(py, "WriteError", (error.to_string(),))
}

/// Work that was refused.
pub(crate) fn refused_error(py: Python<'_>, refusal: Refusal) -> PyErr {
    let Refusal { code, message } = refusal.spelled(&Keywords);
    exception(py, "Refused", (code.as_str(), &*message))
}

/// A mesh that could not be made. A mesh that misses its budget is not an error here.
pub(crate) fn mesh(py: Python<'_>, failure: MeshFailure) -> PyErr {
    match failure.spelled(&Keywords) {
        MeshFailure::Length(why) => budget(py, &why.to_string()),
        MeshFailure::Refused(refusal) => refused_error(py, refusal),
        MeshFailure::Usage(why) => exception(py, "Refused", ("unsupported", &*why)),
        other => exception(py, "Refused", (other.code(), other.to_string())),
    }
}
