//! How far two shapes are apart, and whether what a file says of that is so, from Python's arguments.
use crate::source::Source;
use crate::spec::parse_argument;
use crate::work::ProgressListener;
use crate::{failure, work};
use chordal::budget::Length;
use chordal::budget::advice::Spell;
use chordal_cli::spelling::CommandLine;
use chordal_verbs::{DeviationSpec, Input, deviation, history_of, verify};
use pyo3::prelude::*;
use std::sync::Arc;

/// How well the distance is to be known, as Python passes it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct DeviationArguments {
    relative: f64,
    absolute: Option<String>,
    max: Option<String>,
}

/// A shape and the name of its file.
pub(crate) struct NamedInput {
    pub input: Arc<Input>,
    pub name: Option<String>,
}

/// The report of `chordal deviation`, as JSON.
pub(crate) fn report(
    py: Python<'_>,
    shape: NamedInput,
    other: NamedInput,
    arguments: DeviationArguments,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let spec = DeviationSpec {
        relative: arguments.relative,
        absolute: parse_argument::<Length>("absolute", arguments.absolute.as_deref())?,
        max: parse_argument::<Length>("max", arguments.max.as_deref())?,
    };
    let listener = ProgressListener::new(progress, "deviation");
    let found = work::run(py, listener, move |job| {
        let (a, b) = (Input::clone(&shape.input), Input::clone(&other.input));
        deviation(a, b, &spec, job).map(|mut report| {
            report.run.input = shape.name;
            report
        })
    })?;
    let report = found.map_err(|error| failure::mesh(py, error))?.spelled(&CommandLine);
    Ok(report.to_value().to_string())
}

/// The report of `chordal verify`, as JSON: on a shape with its certificate, or that in a report, from the shapes that it was
/// made of.
#[pyfunction]
pub(crate) fn verified(
    py: Python<'_>,
    source: &Source,
    certificate: Option<&str>,
    against: Vec<PyRef<'_, Source>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let given = certificate.map(serde_json::from_str::<serde_json::Value>).transpose();
    let given = given.map_err(|error| failure::argument("certificate", error))?;
    let out = Arc::clone(source.input());
    let against: Vec<Input> = against.iter().map(|of| Input::clone(of.input())).collect();
    let listener = ProgressListener::new(progress, "verify");
    let found = work::run(py, listener, move |job| verify(&out, given.as_ref(), &against, job))?;
    let report = found.map_err(|error| failure::mesh(py, error))?;
    serde_json::to_string(&report).map_err(|error| failure::internal(py, &error.to_string()))
}

/// How a shape came about, as JSON, as far as that is proved; and what its parts are, where it was put together.
#[pyfunction]
pub(crate) fn history(py: Python<'_>, source: &Source) -> PyResult<String> {
    let input = Arc::clone(source.input());
    work::run(py, None, move |_| {
        let mut facts = serde_json::to_value(history_of(&input)).unwrap_or_default();
        if let Some(composed) = &input.composed {
            facts["composed"] = serde_json::to_value(composed.facts()).unwrap_or_default();
        }
        facts.to_string()
    })
}
