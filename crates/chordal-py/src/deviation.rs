//! How far two shapes are apart, from Python's arguments.
use crate::spec::parse_argument;
use crate::{failure, work};
use chordal::budget::Length;
use chordal::budget::advice::Spell;
use chordal_cli::spelling::CommandLine;
use chordal_verbs::{DeviationSpec, Input, deviation};
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
    let found = work::run(py, progress, move |job| {
        let (a, b) = (Input::clone(&shape.input), Input::clone(&other.input));
        deviation(a, b, &spec, job).map(|mut report| {
            report.run.input = shape.name;
            report
        })
    })?;
    let report = found.map_err(|error| failure::mesh(py, error))?.spelled(&CommandLine);
    Ok(report.to_value().to_string())
}
