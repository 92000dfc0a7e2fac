//! `Source`: a shape that was read or made, for Python.
use crate::cage::Cage;
use crate::curve::curves;
use crate::deviation::{self, NamedInput};
use crate::outcome::{MeshOrder, MeshTask, Outcome};
use crate::python_leaf::CallLog;
use crate::script_value::take_exception;
use crate::spec::{self, GivenOptions, parse_argument};
use crate::spelling::Keywords;
use crate::volume::{BakedVolume, bake_input};
use crate::{failure, work};
use chordal::budget::advice::Spell;
use chordal::budget::{Refusal, RefusalCode, Unit};
use chordal_cli::spelling::CommandLine;
use chordal_io::font::Letters;
use chordal_io::{Format, Frame, Limits, ReadError, UnknownFormat};
use chordal_verbs::options::ReadOptions;
use chordal_verbs::{
    FormatHint, Input, Shape, SurfaceSpec, inspect, load_with, transform_input, written_names,
};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use std::path::Path;
use std::sync::Arc;

/// A shape that was read or made.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Source {
    input: Arc<Input>,
    name: Option<String>,
    /// The calls of the Python functions in it.
    calls: Vec<Arc<CallLog>>,
}

/// The options for reading bytes, as Python passes them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Reading {
    /// The name of the file, if they are from one.
    name: Option<String>,
    options: GivenOptions,
    /// The alignment of the lines of a text, see [`Letters::align`].
    align: f64,
}

/// The options for reading bytes, as the verbs take them.
struct ReadRequest {
    name: Option<String>,
    options: ReadOptions,
    align: f64,
}

impl ReadRequest {
    fn read(self, bytes: &[u8]) -> Result<(Input, Option<String>), ReadFailure> {
        let limits = self.options.limits(Limits::default());
        let letters = self.options.letters().map(|letters| Letters { align: self.align, ..letters });
        let hint = FormatHint {
            name: self.name.as_deref(),
            format: self.options.from,
            letters: letters.as_ref(),
            ..FormatHint::default()
        };
        let mut open = |path: &str| match &self.name {
            Some(first) => chordal_cli::read_beside(Path::new(first), path, limits.bytes),
            None => Err("bytes are in no folder".to_owned()),
        };
        match load_with(bytes, hint, &mut open, &limits) {
            Ok(mut input) => {
                self.options.complete(input.shape.frame_mut());
                Ok((input.spelled(&CommandLine), self.name))
            }
            Err(error) => Err(ReadFailure { error, name: self.name }),
        }
    }
}

/// Why bytes could not be read, and their file.
struct ReadFailure {
    error: ReadError,
    name: Option<String>,
}

#[pymethods]
impl Source {
    /// The shape in some bytes.
    #[new]
    fn new(py: Python<'_>, bytes: PyBackedBytes, reading: Reading) -> PyResult<Self> {
        let request = ReadRequest {
            name: reading.name,
            options: spec::request(py, &reading.options)?,
            align: reading.align,
        };
        let read = work::run(py, None, move |_| request.read(&bytes))?;
        let (input, name) = read.map_err(|failed| failure::read(py, failed.error, failed.name.as_deref()))?;
        Ok(Self { input: Arc::new(input), name, calls: Vec::new() })
    }

    /// Curves by their control points: `numbers` are all coordinates in double precision and native byte
    /// order; `shape` is the number of curves, of points of each (3n + 1 for n pieces), and of coordinates.
    #[staticmethod]
    fn curves(
        py: Python<'_>,
        numbers: PyBackedBytes,
        shape: (usize, usize, usize),
        unit: Option<&str>,
    ) -> PyResult<Self> {
        let metres_per_unit = parse_argument::<Unit>("unit", unit)?.map(Unit::metres);
        let frame = Frame { up: None, metres_per_unit, ..Frame::default() };
        let input = work::run(py, None, move |_| curves(&numbers, shape.1, shape.2, frame))?;
        let input = input.map_err(|error| failure::argument("control", error))?;
        Ok(Self::from_input(input, Vec::new()))
    }

    /// The name of the kind, as in "patches".
    #[getter]
    fn kind(&self) -> &'static str {
        self.input.shape.kind()
    }

    /// The name of the format, as in "bpt".
    #[getter]
    fn format(&self) -> String {
        self.input.format.to_string()
    }

    /// Whether there is a format of that name.
    #[staticmethod]
    fn is_format(name: &str) -> bool {
        name.parse::<Format>().is_ok()
    }

    /// The name of the kind in the plural.
    #[getter]
    fn kinds(&self) -> &'static str {
        self.input.shape.kinds()
    }

    /// The formats that it can be written in.
    #[getter]
    fn written(&self) -> Vec<String> {
        written_names(&self.input.shape)
    }

    /// The file that it was read from.
    #[getter]
    fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// The report of `chordal inspect`, as JSON.
    fn inspect(&self, py: Python<'_>) -> PyResult<String> {
        let input = Arc::clone(&self.input);
        let mut report = work::run(py, None, move |_| inspect(&input).spelled(&Keywords))?;
        report.run.input.clone_from(&self.name);
        Ok(report.to_value().to_string())
    }

    /// The report of `chordal deviation` with another shape, as JSON.
    fn deviation(
        &self,
        py: Python<'_>,
        other: &Self,
        options: GivenOptions,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<String> {
        deviation::report(py, self.named_input(), other.named_input(), &options, progress)
    }

    /// A volume with options for its surface.
    fn surface(&self, py: Python<'_>, options: GivenOptions) -> PyResult<Self> {
        let spec: SurfaceSpec = spec::request(py, &options)?;
        let mut input = Input::clone(&self.input);
        let Shape::Volume(sampled) = &mut input.shape else {
            return Err(failure::internal(py, "this is no volume"));
        };
        sampled.surface = spec;
        Ok(Self { input: Arc::new(input), name: self.name.clone(), calls: Vec::new() })
    }

    /// Triangles transformed by a matrix, given by rows, into a unit; and the transformed interval of their
    /// distance to another shape.
    fn transformed(
        &self,
        py: Python<'_>,
        rows: [[f64; 4]; 4],
        unit: Option<&str>,
        interval: Lengths,
    ) -> PyResult<(Self, Lengths)> {
        let unit = parse_argument::<Unit>("unit", unit)?;
        let input = Arc::clone(&self.input);
        let transformed = work::run(py, None, move |_| transformed_input(&input, rows, unit, interval))?;
        let (input, interval) = transformed.map_err(|error| failure::argument("matrix", error))?;
        Ok((Self { input: Arc::new(input), name: None, calls: Vec::new() }, interval))
    }

    /// The polygons of a cage.
    fn cage(&self, py: Python<'_>) -> PyResult<Cage> {
        match &self.input.shape {
            Shape::Cage(polygons) => Ok(Cage::from_cage(polygons.cage.clone())),
            other => {
                let message =
                    format!("{} are no cage: surface= takes the polygons of an .obj as one", other.kind());
                Err(failure::refused_error(py, Refusal::new(RefusalCode::Unsupported, message)))
            }
        }
    }

    /// Signed distances to the shape on a lattice, the report, and why the budget was not met, if so.
    fn bake(
        &self,
        py: Python<'_>,
        options: GivenOptions,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<BakedVolume> {
        bake_input(py, self.named_input(), &options, progress).map_err(|error| self.raised().unwrap_or(error))
    }

    /// Triangles or polylines within a budget, rounded as in a file of a format.
    fn mesh(
        &self,
        py: Python<'_>,
        options: GivenOptions,
        format: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Outcome> {
        let to: Format = format.parse().map_err(|error: UnknownFormat| failure::argument("format", error))?;
        let (spec, patience) = spec::budget(py, &options)?;
        let order = self.order(MeshTask::Mesh(spec, patience));
        Outcome::new(py, order, to.into(), progress).map_err(|error| self.raised().unwrap_or(error))
    }
}

impl Source {
    /// A shape without a file, with the calls of its Python functions.
    pub(crate) fn from_input(input: Input, calls: Vec<Arc<CallLog>>) -> Self {
        Self { input: Arc::new(input), name: None, calls }
    }

    /// An order for a task that makes a mesh.
    pub(crate) fn order(&self, task: MeshTask) -> MeshOrder {
        MeshOrder { input: Arc::clone(&self.input), name: self.name.clone(), task, calls: self.calls.clone() }
    }

    /// Takes the exception that one of its Python functions raised.
    pub(crate) fn raised(&self) -> Option<PyErr> {
        take_exception(&self.calls)
    }

    pub(crate) fn input(&self) -> &Arc<Input> {
        &self.input
    }

    pub(crate) fn shape(&self) -> &Shape {
        &self.input.shape
    }

    pub(crate) fn frame(&self) -> Frame {
        *self.input.shape.frame()
    }

    pub(crate) fn calls(&self) -> Vec<Arc<CallLog>> {
        self.calls.clone()
    }

    pub(crate) fn named_input(&self) -> NamedInput {
        NamedInput { input: Arc::clone(&self.input), name: self.name.clone() }
    }
}

/// An interval of lengths; without an upper end if none is known.
type Lengths = (f64, Option<f64>);

fn transformed_input(
    input: &Input,
    rows: [[f64; 4]; 4],
    unit: Option<Unit>,
    (at_least, at_most): Lengths,
) -> Result<(Input, Lengths), String> {
    // Python gives rows; the verbs take columns, as glTF does.
    let matrix = std::array::from_fn(|k| rows[k % 4][k / 4]);
    let (mut transformed, stretch) = transform_input(input, &matrix).map_err(|error| error.to_string())?;
    if let (Shape::Scene(scene), Some(unit)) = (&mut transformed.shape, unit) {
        scene.frame.metres_per_unit = Some(unit.metres());
    }
    Ok((transformed, stretch.interval(at_least, at_most)))
}
