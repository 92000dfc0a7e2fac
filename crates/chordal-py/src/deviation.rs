//! The deviation of two shapes, the verification of certificates, and histories, from Python's arguments.
use crate::source::Source;
use crate::spec::{GivenOptions, request};
use crate::spelling::Keywords;
use crate::work::ProgressListener;
use crate::{failure, work};
use chordal::budget::advice::Spell;
use chordal_verbs::{DeviationSpec, Input, deviation, history_of, verify};
use pyo3::prelude::*;
use std::sync::Arc;

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
    options: &GivenOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let spec: DeviationSpec = request(py, options)?;
    let listener = ProgressListener::new(progress, "deviation");
    let measured = work::run(py, listener, move |job| {
        let (a, b) = (Input::clone(&shape.input), Input::clone(&other.input));
        deviation(a, b, &spec, job).map(|mut report| {
            report.run.input = shape.name;
            report
        })
    })?;
    let report = measured.map_err(|error| failure::mesh(py, error))?.spelled(&Keywords);
    Ok(report.to_value().to_string())
}

/// The report of `chordal verify`, as JSON, for a shape and those that it was made from. `certificate` is that
/// of a report; without it, the certificate in the shape's file is verified.
#[pyfunction]
pub(crate) fn verified(
    py: Python<'_>,
    source: &Source,
    certificate: Option<&str>,
    against: Vec<PyRef<'_, Source>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let report_value = certificate.map(serde_json::from_str::<serde_json::Value>).transpose();
    let report_value = report_value.map_err(|error| failure::argument("certificate", error))?;
    let out = Arc::clone(source.input());
    let against: Vec<Input> = against.iter().map(|input| Input::clone(input.input())).collect();
    let listener = ProgressListener::new(progress, "verify");
    let verified = work::run(py, listener, move |job| verify(&out, report_value.as_ref(), &against, job))?;
    let report = verified.map_err(|error| failure::mesh(py, error))?;
    serde_json::to_string(&report).map_err(|error| failure::internal(py, &error.to_string()))
}

/// The history of a shape as JSON, as far as it is proved; with the parts of a composed shape.
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
