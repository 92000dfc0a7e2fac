//! `view`: checks the text of a view.
use crate::failure;
use chordal::View;
use pyo3::prelude::*;

/// The normalized text of a view.
#[pyfunction]
pub(crate) fn view(py: Python<'_>, text: &str) -> PyResult<String> {
    let view = text.parse::<View>().map_err(|error| failure::budget(py, &format!("view: {error}")))?;
    Ok(view.to_string())
}
