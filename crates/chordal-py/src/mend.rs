//! Repairs, from Python's arguments.
use crate::failure;
use crate::outcome::{MeshTask, Outcome};
use crate::source::Source;
use chordal::budget::Length;
use chordal_io::{Format, UnknownFormat};
use chordal_verbs::{Duplicates, HoleSelection, MendSpec, NestedShells, WeldTolerance};
use pyo3::prelude::*;

/// The requested cures, as Python passes them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct MendArguments {
    all: bool,
    /// An empty text for equal coordinates, or a length.
    weld: Option<String>,
    /// "any" or "alike".
    drop_duplicates: Option<String>,
    drop_degenerate: bool,
    /// As `weld`.
    resolve_t_junctions: Option<String>,
    split_nonmanifold: bool,
    orient: bool,
    /// "keep" or "cavity".
    nested: String,
    /// 0 for all holes.
    fill_holes: Option<usize>,
    drop_unused: bool,
}

fn weld_tolerance(name: &str, text: &str) -> PyResult<WeldTolerance> {
    if text.is_empty() {
        return Ok(WeldTolerance::Exact);
    }
    text.parse::<Length>().map(WeldTolerance::Within).map_err(|error| failure::argument(name, error))
}

impl MendArguments {
    fn spec(self) -> PyResult<MendSpec> {
        let base = if self.all { MendSpec::ALL } else { MendSpec::default() };
        let weld = self.weld.map(|text| weld_tolerance("weld", &text)).transpose()?;
        let t_junctions = self.resolve_t_junctions.map(|text| weld_tolerance("resolve_t_junctions", &text));
        let duplicates = self.drop_duplicates.map(|which| match which.as_str() {
            "any" => Ok(Duplicates::EitherWay),
            "alike" => Ok(Duplicates::SameWay),
            _ => Err(failure::argument("drop_duplicates", format!("'any' or 'alike', not '{which}'"))),
        });
        let nested = match self.nested.as_str() {
            "keep" => NestedShells::Keep,
            "cavity" => NestedShells::Cavity,
            which => return Err(failure::argument("nested", format!("'keep' or 'cavity', not '{which}'"))),
        };
        let holes = self.fill_holes.map(|max_edges| match max_edges {
            0 => HoleSelection::All,
            max_edges => HoleSelection::UpTo(max_edges),
        });
        Ok(MendSpec {
            weld: weld.or(base.weld),
            drop_duplicates: duplicates.transpose()?.or(base.drop_duplicates),
            drop_degenerate: self.drop_degenerate || base.drop_degenerate,
            resolve_t_junctions: t_junctions.transpose()?.or(base.resolve_t_junctions),
            split_non_manifold: self.split_nonmanifold || base.split_non_manifold,
            orient: self.orient || base.orient,
            nested,
            fill_holes: holes.or(base.fill_holes),
            drop_unused: self.drop_unused || base.drop_unused,
        })
    }
}

/// The triangles after repairs, rounded as in a file of a format.
#[pyfunction]
pub(crate) fn mend(
    py: Python<'_>,
    source: &Source,
    arguments: MendArguments,
    format: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<Outcome> {
    let to: Format = format.parse().map_err(|error: UnknownFormat| failure::argument("format", error))?;
    Outcome::new(py, source.order(MeshTask::Mend(arguments.spec()?)), to.into(), progress)
}
