//! Levels of detail, from Python's arguments.
use crate::outcome::{FileBytes, file_bytes};
use crate::source::Source;
use crate::spec::{GivenOptions, mismatch, request};
use crate::spelling::Keywords;
use crate::work::ProgressListener;
use crate::{failure, work};
use chordal::budget::advice::Spell;
use chordal_cli::spelling::CommandLine;
use chordal_io::{FileSet, Format};
use chordal_verbs::options::{LodContainer, LodOptions, OutputOptions};
use chordal_verbs::report::{BoundFacts, Certificate, Report, RunFacts};
use chordal_verbs::{Input, LodOutcome, LodSpec, Shape, lod};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::sync::Arc;

/// The options of levels of detail, as Python passes them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct LodArguments {
    options: GivenOptions,
    /// Whether a large finest level is split into tiles.
    tiles: bool,
    /// The options of the files.
    output: GivenOptions,
}

impl LodArguments {
    fn spec(&self, py: Python<'_>) -> PyResult<(LodSpec, OutputOptions)> {
        let options: LodOptions = request(py, &self.options)?;
        let container = if self.tiles { LodContainer::Tiles } else { LodContainer::OneFile };
        let output: OutputOptions = request(py, &self.output)?;
        let spec = options.spec(container, output.packing).map_err(|why| mismatch(py, why))?;
        Ok((spec, output))
    }
}

/// Levels of detail with their certificate.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Levels {
    outcome: Arc<LodOutcome>,
    /// The certificate in the words of Python, and why the budget is not met; files have those of the command.
    certificate: Certificate,
    unmet: Option<String>,
    name: Option<String>,
}

/// Levels of detail of a shape.
#[pyfunction]
pub(crate) fn levels(
    py: Python<'_>,
    source: &Source,
    arguments: LodArguments,
    progress: Option<Py<PyAny>>,
) -> PyResult<Levels> {
    let (spec, output) = arguments.spec(py)?;
    let named = source.named_input();
    let outcome = work::run(py, ProgressListener::new(progress, "lod"), move |job| {
        lod(Input::clone(&named.input), &spec, job)
    })?;
    let mut outcome = outcome.map_err(|error| source.raised().unwrap_or_else(|| failure::mesh(py, error)))?;
    output.strip(&mut outcome.certificate);
    let certificate = outcome.certificate.clone().spelled(&Keywords);
    let unmet = outcome.unmet.clone().map(|why| why.spelled(&Keywords).to_string());
    let outcome = Arc::new(outcome.spelled(&CommandLine));
    Ok(Levels { outcome, certificate, unmet, name: source.named_input().name })
}

#[pymethods]
impl Levels {
    /// The report of `chordal lod`, as JSON.
    #[getter]
    fn report(&self) -> String {
        let run = RunFacts { verb: "lod", input: self.name.clone(), ..RunFacts::default() };
        Report::new(self.certificate.clone(), run).to_value().to_string()
    }

    /// Why the finest level does not meet the budget, if it does not.
    #[getter]
    fn unmet(&self) -> Option<String> {
        self.unmet.clone()
    }

    /// A level as a shape, and its bound as JSON; `None` if the finest level is split into tiles.
    fn level(&self, py: Python<'_>, number: usize) -> PyResult<Option<(Source, String)>> {
        let outcome = Arc::clone(&self.outcome);
        let level = work::run(py, None, move |_| {
            let (scene, bound) = outcome.level(number)?;
            let input = Input::made(Shape::Scene(scene.into_owned()), Format::Glb);
            let bound = serde_json::to_string(&BoundFacts::new(bound)).ok()?;
            Some((input, bound))
        })?;
        Ok(level.map(|(input, bound)| (Source::from_input(input, Vec::new()), bound)))
    }

    /// The bytes of a glTF of all levels.
    fn write<'py>(&self, py: Python<'py>, format: &str) -> PyResult<Bound<'py, PyBytes>> {
        let format: Format = format.parse().map_err(|error| failure::argument("format", error))?;
        let outcome = Arc::clone(&self.outcome);
        let written = work::run(py, None, move |_| {
            let mut bytes = Vec::new();
            outcome.write(format, &mut bytes).map(|()| bytes)
        })?;
        Ok(PyBytes::new(py, &written.map_err(|error| failure::write(py, &error))?))
    }

    /// The files of a tileset: the document, and the tiles with their names.
    fn tileset<'py>(&self, py: Python<'py>) -> PyResult<FileBytes<'py>> {
        let outcome = Arc::clone(&self.outcome);
        let files = work::run(py, None, move |_| outcome.tileset().map(FileSet::into_owned))?;
        Ok(file_bytes(py, files.map_err(|error| failure::mesh(py, error))?))
    }
}
