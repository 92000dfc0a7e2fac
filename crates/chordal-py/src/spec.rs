//! A budget, from Python's arguments.
use crate::failure;
use chordal::budget::{InvalidLength, Length, PixelBudget, Pixels, View};
use chordal_verbs::BudgetSpec;
use pyo3::prelude::*;

/// The arguments of a budget as texts and numbers. `python/chordal/_budget.py` has made sure that they belong together.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Wanted {
    /// A length as the command reads it, and the name of the argument that it is from.
    length: Option<(String, String)>,
    /// Device pixels, and the view.
    pixels: Option<(f64, String)>,
    /// The most triangles.
    triangles: Option<u64>,
}

impl Wanted {
    /// The same as the verbs take it.
    pub(crate) fn spec(self, py: Python<'_>) -> PyResult<BudgetSpec> {
        let wrong = |name: &str, error: String| failure::budget(py, &format!("{name}: {error}"));
        let length = self.length.map(|(name, text)| {
            text.parse::<Length>().map_err(|error: InvalidLength| wrong(&name, error.to_string()))
        });
        let pixels = self.pixels.map(|(pixels, view)| {
            let pixels = Pixels::new(pixels).map_err(|error| wrong("pixels", error.to_string()))?;
            let view = view.parse::<View>().map_err(|error| wrong("view", error.to_string()))?;
            PyResult::Ok(PixelBudget { pixels, view })
        });
        Ok(BudgetSpec { length: length.transpose()?, pixels: pixels.transpose()?, triangles: self.triangles })
    }
}
