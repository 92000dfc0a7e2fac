//! The same shape in another format.
use crate::outcome::{FileBytes, file_bytes, form_of};
use crate::source::Source;
use crate::spelling::Keywords;
use crate::work::ProgressListener;
use crate::{failure, work};
use chordal::budget::Length;
use chordal::budget::advice::Spell;
use chordal_cli::spelling::CommandLine;
use chordal_verbs::report::{Certificate, Report, RunFacts};
use chordal_verbs::{ConvertOutcome, Input, convert_within};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::sync::Arc;

/// A shape as a format holds it.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Conversion {
    made: Arc<ConvertOutcome>,
    /// Its certificate in Python's words; the file has the command's.
    told: Certificate,
    name: Option<String>,
}

/// The same shape in another format; curves that it does not hold within a length.
#[pyfunction]
pub(crate) fn convert(
    py: Python<'_>,
    source: &Source,
    format: &str,
    packing: (bool, Option<String>),
    length: Option<(String, String)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Conversion> {
    let form = form_of(format, packing.0, packing.1.as_deref())?;
    let length = length.map(|(name, text)| {
        text.parse::<Length>().map_err(|error| failure::budget(py, &format!("{name}: {error}")))
    });
    let length = length.transpose()?;
    let named = source.named_input();
    let listener = ProgressListener::new(progress, "convert");
    let made =
        work::run(py, listener, move |job| convert_within(Input::clone(&named.input), form, length, job))?;
    let made = made.map_err(|error| failure::mesh(py, error))?;
    let told = made.certificate.clone().spelled(&Keywords);
    Ok(Conversion { made: Arc::new(made.spelled(&CommandLine)), told, name: source.named_input().name })
}

#[pymethods]
impl Conversion {
    /// The report of `chordal convert`, as JSON.
    #[getter]
    fn report(&self) -> String {
        let run = RunFacts { verb: "convert", input: self.name.clone(), ..RunFacts::default() };
        Report::new(self.told.clone(), run).to_value().to_string()
    }

    /// Whether the format names files beside it for what was converted.
    #[getter]
    fn names_files(&self) -> bool {
        self.made.names_files()
    }

    /// The bytes of the file.
    fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let made = Arc::clone(&self.made);
        let written = work::run(py, None, move |_| {
            let mut bytes = Vec::new();
            made.write(&mut bytes).map(|()| bytes)
        })?;
        Ok(PyBytes::new(py, &written.map_err(|error| failure::write(py, &error))?))
    }

    /// The file, and those beside it with their names, which begin with `stem`.
    fn write_files<'py>(&self, py: Python<'py>, stem: String) -> PyResult<FileBytes<'py>> {
        let made = Arc::clone(&self.made);
        let files = work::run(py, None, move |_| made.write_files(&stem).map(|files| files.into_owned()))?;
        Ok(file_bytes(py, files.map_err(|error| failure::write(py, &error))?))
    }
}
