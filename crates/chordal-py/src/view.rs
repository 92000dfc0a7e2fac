//! `view`: whether a text is a view.
use crate::failure;
use chordal::View;
use pyo3::prelude::*;

/// The view that a text describes, as it reads back.
#[pyfunction]
pub(crate) fn view(py: Python<'_>, text: &str) -> PyResult<String> {
    let view = text.parse::<View>().map_err(|error| failure::budget(py, &format!("view: {error}")))?;
    Ok(view.to_string())
}
