//! Booleans of solids from left to right, from Python's arguments.
use crate::deviation::NamedInput;
use crate::failure;
use crate::outcome::{MeshOrder, MeshTask, Outcome};
use crate::source::Source;
use crate::spec::{self, GivenOptions};
use chordal::boolean::BooleanOp;
use chordal_io::{Format, UnknownFormat};
use chordal_verbs::{BooleanOperand, Input};
use pyo3::prelude::*;

/// Combines solids as triangles within a budget, rounded as in a file of a format.
#[pyfunction]
pub(crate) fn combine(
    py: Python<'_>,
    first: &Source,
    others: Vec<(String, Py<Source>)>,
    options: GivenOptions,
    format: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<Outcome> {
    let to: Format = format.parse().map_err(|error: UnknownFormat| failure::argument("format", error))?;
    let mut calls = first.calls();
    let NamedInput { input, name } = first.named_input();
    let mut operands = Vec::new();
    for (number, (op, other)) in (1..).zip(others) {
        let other = other.get();
        calls.extend(other.calls());
        let op = [BooleanOp::Union, BooleanOp::Difference, BooleanOp::Intersection]
            .into_iter()
            .find(|known| known.as_str() == op)
            .ok_or_else(|| failure::argument("steps", format!("'{op}' is no operation")))?;
        let NamedInput { input, name } = other.named_input();
        let name = name.unwrap_or_else(|| format!("step {number}"));
        operands.push(BooleanOperand { op, name, input: Input::clone(&input) });
    }
    let (spec, patience) = spec::budget(py, &options)?;
    let order = MeshOrder { input, name, task: MeshTask::Combine(operands, spec, patience), calls };
    Outcome::new(py, order, to.into(), progress)
}
