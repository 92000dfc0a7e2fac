//! Levels of detail, from Python's arguments.
use crate::outcome::{FileBytes, file_bytes};
use crate::source::Source;
use crate::spec::parse_argument;
use crate::work::ProgressListener;
use crate::{failure, work};
use chordal::budget::advice::Spell;
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::{Length, Pixels};
use chordal_cli::spelling::CommandLine;
use chordal_io::glb::GltfPacking;
use chordal_io::tiles::GeoPlace;
use chordal_io::{FileSet, Format};
use chordal_verbs::report::{BoundFacts, Report, RunFacts};
use chordal_verbs::{Input, LodLens, LodOutcome, LodParts, LodSpec, Normals, Shape, TileErrors, lod};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::sync::Arc;

/// What levels are for, in Python's words.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct LodArguments {
    pixels: f64,
    view: String,
    nearest: Option<f64>,
    /// The name of an argument, and the length as the command reads it.
    length: Option<(String, String)>,
    distances: Vec<f64>,
    uv_error: Option<f64>,
    normal_error: Option<f64>,
    normals: Option<String>,
    /// "scaled" or "plain".
    errors: String,
    tile_triangles: Option<u64>,
    merge: bool,
    /// Degrees north and east, metres, as the command reads them.
    place: Option<String>,
    quantize: bool,
    compress: bool,
}

impl LodArguments {
    fn spec(self, py: Python<'_>) -> PyResult<LodSpec> {
        let wrong = |name: &str, error: String| failure::budget(py, &format!("{name}: {error}"));
        let lens: LodLens = self.view.parse().map_err(|error| wrong("view", error))?;
        let length = self
            .length
            .map(|(name, text)| text.parse::<Length>().map_err(|error| wrong(&name, error.to_string())));
        let length = length.transpose()?;
        if lens.has_distance && (self.nearest.is_some() || length.is_some()) {
            return Err(wrong(
                "view",
                "it says a distance, and so does nearest=, or tol= in its place".to_owned(),
            ));
        }
        let attributes = AttributeLimits::new(self.uv_error, self.normal_error);
        Ok(LodSpec {
            pixels: Pixels::new(self.pixels).map_err(|error| wrong("pixels", error.to_string()))?,
            lens: lens.closest,
            nearest: self.nearest.or(lens.distance()),
            length,
            distances: self.distances,
            normals: parse_argument::<Normals>("normals", self.normals.as_deref())?.unwrap_or_default(),
            errors: match self.errors.as_str() {
                "scaled" => TileErrors::Scaled,
                "plain" => TileErrors::Plain,
                other => {
                    return Err(failure::argument("errors", format!("'scaled' or 'plain', not '{other}'")));
                }
            },
            tile_triangles: self.tile_triangles,
            attributes: attributes.map_err(|error| wrong("uv_error, normal_error", error.to_string()))?,
            parts: if self.merge { LodParts::Merged } else { LodParts::Separate },
            place: parse_argument::<GeoPlace>("at", self.place.as_deref())?,
            packing: GltfPacking { is_compressed: self.compress, is_quantized: self.quantize },
        })
    }
}

/// Levels of detail with all that is known of them.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Levels {
    made: Arc<LodOutcome>,
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
    let spec = arguments.spec(py)?;
    let named = source.named_input();
    let made = work::run(py, ProgressListener::new(progress, "lod"), move |job| {
        lod(Input::clone(&named.input), &spec, job)
    })?;
    let made = made.map_err(|error| source.raised().unwrap_or_else(|| failure::mesh(py, error)))?;
    Ok(Levels { made: Arc::new(made.spelled(&CommandLine)), name: source.named_input().name })
}

#[pymethods]
impl Levels {
    /// The report of `chordal lod`, as JSON.
    #[getter]
    fn report(&self) -> String {
        let run = RunFacts { verb: "lod", input: self.name.clone(), ..RunFacts::default() };
        Report::new(self.made.certificate.clone(), run).to_value().to_string()
    }

    /// Why the finest level does not hold the budget, where it does not.
    #[getter]
    fn unmet(&self) -> Option<String> {
        self.made.unmet.as_ref().map(ToString::to_string)
    }

    /// A level as a shape of its own, and its bound as JSON; nothing where the finest level is cut in space.
    fn level(&self, py: Python<'_>, number: usize) -> PyResult<Option<(Source, String)>> {
        let made = Arc::clone(&self.made);
        let found = work::run(py, None, move |_| {
            let (scene, bound) = made.level(number)?;
            let input = Input::made(Shape::Scene(scene.into_owned()), Format::Glb);
            let bound = serde_json::to_string(&BoundFacts::new(bound)).ok()?;
            Some((input, bound))
        })?;
        Ok(found.map(|(input, bound)| (Source::from_input(input, Vec::new()), bound)))
    }

    /// The bytes of a glTF of all levels.
    fn write<'py>(&self, py: Python<'py>, format: &str) -> PyResult<Bound<'py, PyBytes>> {
        let format: Format = format.parse().map_err(|error| failure::argument("format", error))?;
        let made = Arc::clone(&self.made);
        let written = work::run(py, None, move |_| {
            let mut bytes = Vec::new();
            made.write(format, &mut bytes).map(|()| bytes)
        })?;
        Ok(PyBytes::new(py, &written.map_err(|error| failure::write(py, &error))?))
    }

    /// The files of a tileset: that which names all others, and these with their names.
    fn tileset<'py>(&self, py: Python<'py>) -> PyResult<FileBytes<'py>> {
        let made = Arc::clone(&self.made);
        let files = work::run(py, None, move |_| made.tileset().map(FileSet::into_owned))?;
        Ok(file_bytes(py, files.map_err(|error| failure::mesh(py, error))?))
    }
}
