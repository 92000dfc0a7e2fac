//! A budget, from Python's arguments.
use crate::failure;
use chordal::budget::attributes::{AttributeLimits, InvalidAttributeLimit};
use chordal::budget::proof::ProofEffort;
use chordal::budget::{InvalidLength, Length, PixelBudget, Pixels, View};
use chordal_verbs::{BudgetSpec, Effort, Normals, Spacing, parse_time};
use pyo3::prelude::*;
use std::str::FromStr;
use std::time::Duration;

/// The arguments of a budget as texts and numbers. `python/chordal/_budget.py` has made sure that they belong
/// together.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct BudgetArguments {
    /// The name of an argument, and the length as the command reads it.
    length: Option<(String, String)>,
    /// Device pixels, and the view.
    pixels: Option<(f64, String)>,
    /// Degrees between normals.
    angle_deg: Option<f64>,
    /// The largest distance of texture coordinates.
    uv_error: Option<f64>,
    /// The largest angle to the input's normals, in degrees.
    normal_error: Option<f64>,
    /// The most triangles.
    triangles: Option<u64>,
    /// The most segments.
    segments: Option<u64>,
    /// Where the ends of segments are placed: "fewest" or "even".
    spacing: String,
    /// What a count of triangles is worth, or the proof of a field: "best" or "fast", if it is said.
    effort: Option<String>,
    /// "proved" or "measured", if one is asked for.
    require: Option<String>,
    /// After how long the best of a field is taken, as the command reads it.
    within: Option<String>,
    /// The name of an argument and a length: how high a drawing is raised to a solid.
    extrude: Option<(String, String)>,
    /// The same: how wide its edges are cut off.
    bevel: Option<(String, String)>,
}

/// How long a field is worked on.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Patience {
    /// After how long the best is taken, if that is said.
    pub within: Option<Duration>,
    /// How far its proof is taken.
    pub proof: ProofEffort,
}

impl BudgetArguments {
    /// The same as the verbs take it, and how long a field is worked on.
    pub(crate) fn spec(self, py: Python<'_>) -> PyResult<(BudgetSpec, Patience)> {
        let wrong = |name: &str, error: String| failure::budget(py, &format!("{name}: {error}"));
        let within = self.within.as_deref().map(parse_time).transpose();
        let within = within.map_err(|error| wrong("within", error))?;
        let effort = self.effort.as_deref().map(parse_effort).transpose()?;
        // As in the command: the best of a field is a proof that is taken to its end.
        let proof = if effort == Some(Effort::Best) { ProofEffort::Full } else { ProofEffort::default() };
        let parse = |(name, text): (String, String)| {
            text.parse::<Length>().map_err(|error: InvalidLength| wrong(&name, error.to_string()))
        };
        let (extrude, bevel) = (self.extrude.map(parse).transpose()?, self.bevel.map(parse).transpose()?);
        let length = self.length.map(parse);
        let pixels = self.pixels.map(|(pixels, view)| {
            let pixels = Pixels::new(pixels).map_err(|error| wrong("pixels", error.to_string()))?;
            let view = view.parse::<View>().map_err(|error| wrong("view", error.to_string()))?;
            PyResult::Ok(PixelBudget { pixels, view })
        });
        let attributes = AttributeLimits::new(self.uv_error, self.normal_error);
        let attributes = attributes.map_err(|error| {
            let name = match error {
                InvalidAttributeLimit::Texcoord(_) => "uv_error",
                InvalidAttributeLimit::Normal(_) => "normal_error",
            };
            wrong(name, error.to_string())
        });
        let spec = BudgetSpec {
            length: length.transpose()?,
            pixels: pixels.transpose()?,
            angle_deg: self.angle_deg,
            attributes: attributes?,
            triangles: self.triangles,
            segments: self.segments,
            spacing: parse_spacing(&self.spacing)?,
            effort: effort.unwrap_or(Effort::Best),
            extrude,
            bevel,
            normals: Normals::default(),
            require: parse_argument("require", self.require.as_deref())?,
        };
        Ok((spec, Patience { within, proof }))
    }
}

fn parse_spacing(name: &str) -> PyResult<Spacing> {
    match name {
        "fewest" => Ok(Spacing::Fewest),
        "even" => Ok(Spacing::Even),
        _ => Err(failure::argument("spacing", format!("'fewest' or 'even', not '{name}'"))),
    }
}

fn parse_effort(name: &str) -> PyResult<Effort> {
    match name {
        "best" => Ok(Effort::Best),
        "fast" => Ok(Effort::Fast),
        _ => Err(failure::argument("effort", format!("'best' or 'fast', not '{name}'"))),
    }
}

/// What a text stands for that was given as the argument of that name.
pub(crate) fn parse_argument<T: FromStr<Err: std::fmt::Display>>(
    name: &str,
    text: Option<&str>,
) -> PyResult<Option<T>> {
    text.map(|text| text.parse().map_err(|error| failure::argument(name, error))).transpose()
}
