//! Conversion of a shape to another format.
use crate::outcome::{FileBytes, file_bytes, form_of};
use crate::source::Source;
use crate::spec::GivenOptions;
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

/// A converted shape.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Conversion {
    outcome: Arc<ConvertOutcome>,
    /// The certificate in the spelling of Python; the file has that of the command.
    certificate: Certificate,
    name: Option<String>,
}

/// The same shape in another format; curves that it cannot hold are approximated within a length.
#[pyfunction]
pub(crate) fn convert(
    py: Python<'_>,
    source: &Source,
    format: &str,
    options: GivenOptions,
    length: Option<(String, String)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Conversion> {
    let (form, output) = form_of(py, format, &options)?;
    let length = length.map(|(name, text)| {
        text.parse::<Length>().map_err(|error| failure::budget(py, &format!("{name}: {error}")))
    });
    let length = length.transpose()?;
    let named = source.named_input();
    let listener = ProgressListener::new(progress, "convert");
    let outcome =
        work::run(py, listener, move |job| convert_within(Input::clone(&named.input), form, length, job))?;
    let mut outcome = outcome.map_err(|error| failure::mesh(py, error))?;
    output.strip(&mut outcome.certificate);
    let certificate = outcome.certificate.clone().spelled(&Keywords);
    let name = source.named_input().name;
    Ok(Conversion { outcome: Arc::new(outcome.spelled(&CommandLine)), certificate, name })
}

#[pymethods]
impl Conversion {
    /// The report of `chordal convert`, as JSON.
    #[getter]
    fn report(&self) -> String {
        let run = RunFacts { verb: "convert", input: self.name.clone(), ..RunFacts::default() };
        Report::new(self.certificate.clone(), run).to_value().to_string()
    }

    /// Whether the converted file references other files.
    #[getter]
    fn names_files(&self) -> bool {
        self.outcome.names_files()
    }

    /// The bytes of the file.
    fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let outcome = Arc::clone(&self.outcome);
        let written = work::run(py, None, move |_| {
            let mut bytes = Vec::new();
            outcome.write(&mut bytes).map(|()| bytes)
        })?;
        Ok(PyBytes::new(py, &written.map_err(|error| failure::write(py, &error))?))
    }

    /// The file, and the files that it references with their names, which begin with `stem`.
    fn write_files<'py>(&self, py: Python<'py>, stem: String) -> PyResult<FileBytes<'py>> {
        let outcome = Arc::clone(&self.outcome);
        let files = work::run(py, None, move |_| outcome.write_files(&stem).map(|files| files.into_owned()))?;
        Ok(file_bytes(py, files.map_err(|error| failure::write(py, &error))?))
    }
}
