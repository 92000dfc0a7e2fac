//! `ScriptValue`: a shape or a formula of the language of shape scripts, for Python.
use crate::path::path_of;
use crate::python_leaf::{CallLog, FirstAnswers, PythonLeaf};
use crate::source::Source;
use crate::{failure, work};
use chordal::Job;
use chordal::budget::Evidence;
use chordal::implicit::evaluation::Dual;
use chordal::implicit::leaves::LeafError;
use chordal::implicit::{Distance, DistanceQuality, Expr, Field};
use chordal::math::{Box3, Interval};
use chordal_io::{FileLocation, Format, Frame, Warning};
use chordal_script::language::{Arg, CallError, ScriptPath, function, functions, operate};
use chordal_verbs::{ImplicitShape, Input, Shape, scene_to_field};
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::{PyBool, PyBytes, PyDict, PyList, PyString, PyTuple};
use std::sync::Arc;

/// A shape, a path or a formula.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct ScriptValue {
    arg: Arg,
    /// The calls of the Python functions in it.
    calls: Vec<Arc<CallLog>>,
    /// Notes about the shapes that it was made from.
    notes: Vec<String>,
}

/// The Python functions and notes of arguments.
#[derive(Default)]
struct ArgOrigins {
    calls: Vec<Arc<CallLog>>,
    notes: Vec<String>,
}

/// The result of a call of the language.
// The value is moved to Python's heap at once, so its size on the stack does not matter.
#[allow(clippy::large_enum_variant)]
#[derive(IntoPyObject)]
pub(crate) enum LanguageValue {
    Number(f64),
    ScriptValue(ScriptValue),
}

fn value_error(fault: CallError) -> PyErr {
    PyValueError::new_err(fault.0)
}

/// A Python value as an argument of the language. Its functions and notes are added to `origins`.
fn arg_of(value: &Bound<'_, PyAny>, origins: &mut ArgOrigins, depth: u32) -> PyResult<Arg> {
    if let Ok(script_value) = value.cast::<ScriptValue>() {
        origins.calls.extend(script_value.get().calls.iter().cloned());
        origins.notes.extend(script_value.get().notes.iter().cloned());
        return Ok(script_value.get().arg.clone());
    }
    if let Ok(source) = value.cast::<Source>() {
        let path = path_of(source.get().shape()).map_err(PyValueError::new_err)?;
        return Ok(Arg::path(path));
    }
    if value.is_none() {
        return Ok(Arg::Nothing);
    }
    // Before the numbers, of which a bool is one in Python.
    if value.is_instance_of::<PyBool>() {
        return Ok(Arg::Truth(value.is_truthy()?));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Arg::Text(text.to_string_lossy().into_owned()));
    }
    // Only so deep, since a list may contain itself.
    if (value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>()) && depth > 0 {
        let items = value.try_iter()?.map(|item| arg_of(&item?, origins, depth - 1));
        return Ok(Arg::List(items.collect::<PyResult<_>>()?));
    }
    match value.extract::<f64>() {
        Ok(number) => Ok(Arg::Number(number)),
        Err(_) => Ok(Arg::Other(format!("a {}", value.get_type().name()?))),
    }
}

impl ScriptValue {
    fn into_value(result: Arg, origins: ArgOrigins) -> PyResult<LanguageValue> {
        let ArgOrigins { mut calls, notes: all_notes } = origins;
        let mut notes: Vec<String> = Vec::new();
        for note in all_notes {
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
        // By address, which is as good as any order to bring equal ones together.
        calls.sort_by_key(|log| Arc::as_ptr(log) as usize);
        calls.dedup_by(|a, b| Arc::ptr_eq(a, b));
        match result {
            Arg::Number(value) => Ok(LanguageValue::Number(value)),
            arg => Ok(LanguageValue::ScriptValue(Self { arg, calls, notes })),
        }
    }

    /// A shape with notes about its origin.
    pub(crate) fn from_field(field: Field, notes: Vec<String>) -> Self {
        Self { arg: Arg::shape(field), calls: Vec::new(), notes }
    }

    /// The path, if it is one.
    pub(crate) fn path(&self) -> Option<&ScriptPath> {
        if let Arg::Path(path) = &self.arg { Some(path) } else { None }
    }

    fn field(&self) -> PyResult<&Field> {
        match &self.arg {
            Arg::Shape(solid) => Ok(&solid.field),
            Arg::Path(_) => Err(PyTypeError::new_err(
                "this is a path, not a shape: polygon() fills it, and sweep() follows it",
            )),
            _ => Err(PyTypeError::new_err("this is a formula, not a shape: field() turns it into one")),
        }
    }

    fn evaluable_field(&self) -> PyResult<Field> {
        match &self.arg {
            Arg::Shape(solid) => Ok(solid.field.clone()),
            Arg::Formula(formula) => Ok(Field::new(formula.expr.clone())),
            other => Err(PyTypeError::new_err(format!("{} has no value at points", other.kind()))),
        }
    }
}

/// The exception of a Python function if there is one, else the error of a leaf.
pub(crate) fn leaf_failure(error: &LeafError, calls: &[Arc<CallLog>]) -> PyErr {
    take_exception(calls).unwrap_or_else(|| PyRuntimeError::new_err(error.to_string()))
}

/// The first exception that a Python function raised.
pub(crate) fn take_exception(calls: &[Arc<CallLog>]) -> Option<PyErr> {
    calls.iter().find_map(|calls| calls.take())
}

fn points_of(bytes: &[u8]) -> Vec<[f64; 3]> {
    let number = |k: usize| f64::from_ne_bytes(std::array::from_fn(|i| bytes[8 * k + i]));
    (0..bytes.len() / 24).map(|row| [0, 1, 2].map(|k| number(3 * row + k))).collect()
}

fn bytes_of(numbers: impl Iterator<Item = f64>) -> Vec<u8> {
    numbers.flat_map(f64::to_ne_bytes).collect()
}

#[pymethods]
impl ScriptValue {
    /// Calls a function of the language.
    #[staticmethod]
    #[pyo3(signature = (name, *args, **named))]
    fn call(
        py: Python<'_>,
        name: &str,
        args: &Bound<'_, PyTuple>,
        named: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<LanguageValue> {
        let function = function(name).ok_or_else(|| failure::internal(py, "no such function"))?;
        let mut origins = ArgOrigins::default();
        let by_position = args.iter().map(|arg| arg_of(&arg, &mut origins, 2)).collect::<PyResult<_>>()?;
        let by_name = named.map_or_else(
            || Ok(Vec::new()),
            |named| {
                named
                    .iter()
                    .map(|(name, arg)| Ok((name.extract()?, arg_of(&arg, &mut origins, 2)?)))
                    .collect::<PyResult<_>>()
            },
        )?;
        let job = Job::default();
        let result = function.call_within(by_position, by_name, &job, &mut origins.notes);
        Self::into_value(result.map_err(value_error)?, origins)
    }

    /// Applies an operator; `None` if it is not defined for the operands.
    #[staticmethod]
    fn operate(
        operator: &str,
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
    ) -> PyResult<Option<LanguageValue>> {
        let mut origins = ArgOrigins::default();
        let (a, b) = (arg_of(a, &mut origins, 0)?, arg_of(b, &mut origins, 0)?);
        match operate(operator, &a, &b) {
            Some(result) => Self::into_value(result.map_err(value_error)?, origins).map(Some),
            None => Ok(None),
        }
    }

    /// The coordinate function of an axis.
    #[staticmethod]
    fn axis(k: usize) -> PyResult<Self> {
        let value =
            Arg::axes().into_iter().nth(k).map(|(_, arg)| Self { arg, calls: Vec::new(), notes: Vec::new() });
        value.ok_or_else(|| PyValueError::new_err("there are three axes"))
    }

    /// The shape of a function from the bytes of points to the bytes of values, with an optional function for
    /// gradients.
    #[staticmethod]
    fn callable(call: Py<PyAny>, gradient: Option<Py<PyAny>>, lipschitz: Option<f64>) -> Self {
        let calls = Arc::<CallLog>::default();
        let leaf = PythonLeaf {
            call,
            gradient,
            lipschitz,
            calls: Arc::clone(&calls),
            first: FirstAnswers::default(),
        };
        let mut field = Field::new(Expr::leaf(Arc::new(leaf), Expr::axes()));
        // If the slope is at most 1, the value is never more than the distance.
        if lipschitz.is_some_and(|slope| slope <= 1.0) {
            field = field
                .with_distance(Distance { outside: DistanceQuality::Bound, inside: DistanceQuality::Bound });
        }
        Self { arg: Arg::shape(field), calls: vec![calls], notes: Vec::new() }
    }

    /// The same shape with a bounding box, which the caller guarantees.
    fn with_bounds(&self, bounds: [[f64; 3]; 2]) -> PyResult<Self> {
        let [min, max] = bounds;
        let field = self.field()?.clone().with_bounds(Box3 { min, max });
        Ok(Self { arg: Arg::shape(field), calls: self.calls.clone(), notes: self.notes.clone() })
    }

    /// Notes about its origin.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Whether it is a shape.
    #[getter]
    fn is_shape(&self) -> bool {
        matches!(self.arg, Arg::Shape(_))
    }

    /// The quality of the value as a distance, outside and inside.
    #[getter]
    fn distance(&self) -> PyResult<(&'static str, &'static str)> {
        let distance = self.field()?.distance();
        Ok((distance.outside.as_str(), distance.inside.as_str()))
    }

    /// The best evidence that proofs about it can have, and their assumptions.
    #[getter]
    fn evidence(&self) -> PyResult<(&'static str, Vec<String>)> {
        let evidence = self.field()?.evidence();
        let kind = evidence.as_str();
        Ok((kind, if let Evidence::ProvedIf(sentences) = evidence { sentences } else { Vec::new() }))
    }

    /// A bounding box.
    #[getter]
    fn bounds(&self) -> PyResult<[[f64; 3]; 2]> {
        let Box3 { min, max } = self.field()?.bounds();
        Ok([min, max])
    }

    /// The number of distinct terms of the expression.
    #[getter]
    fn terms(&self) -> PyResult<usize> {
        Ok(self.evaluable_field()?.tape().len())
    }

    /// The values at points: three coordinates a point in double precision and native byte order.
    fn values<'py>(&self, py: Python<'py>, points: PyBackedBytes) -> PyResult<Bound<'py, PyBytes>> {
        let field = self.evaluable_field()?;
        let points = points_of(&points);
        let values = self.evaluated(py, points.len(), move || {
            let mut values = vec![0.0; points.len()];
            field.tape().at(&points, &mut values).map(|()| bytes_of(values.into_iter()))
        })?;
        Ok(PyBytes::new(py, &values.map_err(|error| leaf_failure(&error, &self.calls))?))
    }

    /// The gradients at points, in the same form.
    fn gradients<'py>(&self, py: Python<'py>, points: PyBackedBytes) -> PyResult<Bound<'py, PyBytes>> {
        let field = self.evaluable_field()?;
        let points = points_of(&points);
        let gradients = self.evaluated(py, points.len(), move || {
            let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; points.len()];
            let result = field.tape().gradient_at(&points, &mut slopes);
            result.map(|()| bytes_of(slopes.into_iter().flat_map(|slope| slope.gradient)))
        })?;
        Ok(PyBytes::new(py, &gradients.map_err(|error| leaf_failure(&error, &self.calls))?))
    }

    /// An interval that encloses the values in each box: six numbers a box, its low and high corner, and two
    /// numbers an interval, which are infinite if nothing is known.
    fn ranges<'py>(&self, py: Python<'py>, boxes: PyBackedBytes) -> PyResult<Bound<'py, PyBytes>> {
        let field = self.evaluable_field()?;
        let corners = points_of(&boxes);
        let boxes: Vec<Box3> =
            corners.as_chunks::<2>().0.iter().map(|&[min, max]| Box3 { min, max }).collect();
        let ranges = self.evaluated(py, boxes.len(), move || {
            let mut ranges = vec![Interval::point(0.0); boxes.len()];
            let ends = |range: Interval| match range.is_defined() {
                true => [range.lo(), range.hi()],
                false => [f64::NEG_INFINITY, f64::INFINITY],
            };
            field.tape().over(&boxes, &mut ranges).map(|()| bytes_of(ranges.into_iter().flat_map(ends)))
        })?;
        Ok(PyBytes::new(py, &ranges.map_err(|error| leaf_failure(&error, &self.calls))?))
    }

    /// The shape as a source, cut off at a box.
    fn source(&self, region: Option<[[f64; 3]; 2]>) -> PyResult<Source> {
        self.source_in(region, Frame::default())
    }
}

impl ScriptValue {
    /// Evaluates on this thread if points are few and there is no Python function, which might take long.
    fn evaluated<T: Send + 'static>(
        &self,
        py: Python<'_>,
        n_points: usize,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> PyResult<T> {
        if n_points <= work::FEW_POINTS && self.calls.is_empty() {
            return work::run_briefly(py, work);
        }
        work::run(py, None, move |_| work())
    }

    fn source_in(&self, region: Option<[[f64; 3]; 2]>, frame: Frame) -> PyResult<Source> {
        let region = region.map(|[min, max]| Box3 { min, max });
        let implicit = ImplicitShape::new(self.field()?.clone(), region, frame);
        let warnings = self.notes.iter().map(|note| warning_of(note)).collect();
        let input = Input { warnings, ..Input::made(Shape::Field(implicit), Format::Star) };
        Ok(Source::from_input(input, self.calls.clone()))
    }
}

/// The box that a field is cut off at, if any.
#[pyfunction]
pub(crate) fn region_of(source: &Source) -> Option<[[f64; 3]; 2]> {
    let Shape::Field(implicit) = source.shape() else { return None };
    implicit.region.map(|Box3 { min, max }| [min, max])
}

/// The field of a source; `None` for other shapes.
#[pyfunction]
pub(crate) fn field_of(source: &Source) -> Option<ScriptValue> {
    let Shape::Field(implicit) = source.shape() else { return None };
    Some(ScriptValue { arg: Arg::shape(implicit.field.clone()), calls: source.calls(), notes: Vec::new() })
}

/// The signed distance to triangles, as a value and as a source.
#[pyfunction]
pub(crate) fn mesh_field(py: Python<'_>, source: &Source) -> PyResult<(ScriptValue, Source)> {
    let Shape::Scene(scene) = source.shape() else {
        return Err(failure::internal(py, "these are no triangles"));
    };
    let (scene, frame) = (scene.clone(), source.frame());
    let field = work::run(py, None, move |job| scene_to_field(scene, job))?;
    let field = field.map_err(|error| failure::mesh(py, error.into()))?;
    let notes = field.notes.into_iter().map(|(_, note)| note).collect();
    let value = ScriptValue::from_field(field.field, notes);
    let shape = value.source_in(None, frame)?;
    Ok((value, shape))
}

/// A note as a warning of the input, as in the report of a script.
fn warning_of(note: &str) -> Warning {
    Warning { code: "script-said", count: 1, place: FileLocation::File, message: note.to_owned().into() }
}

/// Every function of the language: its name, its usage, its description, and the quality of its value as a
/// distance.
#[pyfunction]
pub(crate) fn language() -> Vec<(&'static str, String, &'static str, &'static str)> {
    functions().map(|f| (f.name, f.usage(), f.about, f.distance)).collect()
}

/// The name of a parameter, its default and its value.
type ParameterSetting = (String, f64, f64);

/// The line and the text of a warning.
type LineWarning = (u64, &'static str);

/// The shape of a shape script, with its parameters and warnings.
#[pyfunction]
pub(crate) fn script(
    py: Python<'_>,
    text: String,
    set: Vec<(String, f64)>,
) -> PyResult<(ScriptValue, Vec<ParameterSetting>, Vec<LineWarning>)> {
    let options = chordal_script::RunOptions { set: set.into_iter().collect(), ..Default::default() };
    let result = work::run(py, None, move |job| chordal_script::run(&text, &options, job))?;
    let result = result.map_err(|error| {
        let place = error.place.map_or(chordal_io::FileLocation::File, |(line, column)| {
            chordal_io::FileLocation::LineColumn { line, column }
        });
        failure::read(py, chordal_io::ReadError::new(error.code, place, error.message), None)
    })?;
    let parameters = result.parameters.into_iter().map(|p| (p.name, p.default, p.value)).collect();
    let warnings = result.warnings.iter().map(|warning| (warning.place.0, warning.message)).collect();
    Ok((ScriptValue::from_field(result.field, result.said), parameters, warnings))
}
