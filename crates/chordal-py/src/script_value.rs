//! `ScriptValue`: a shape or a formula of the language of shape scripts, as Python holds it.
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

/// A shape or a formula.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct ScriptValue {
    arg: Arg,
    /// The calls of the Python functions in it.
    calls: Vec<Arc<CallLog>>,
    /// Sentences about what it was made of.
    notes: Vec<String>,
}

/// What arguments bring along.
#[derive(Default)]
struct ArgOrigins {
    calls: Vec<Arc<CallLog>>,
    notes: Vec<String>,
}

/// What a call of the language gives back.
// It is handed over at once, and Python holds it elsewhere.
#[allow(clippy::large_enum_variant)]
#[derive(IntoPyObject)]
pub(crate) enum LanguageValue {
    Number(f64),
    ScriptValue(ScriptValue),
}

fn value_error(fault: CallError) -> PyErr {
    PyValueError::new_err(fault.0)
}

/// A value for the language; the functions that it rests on, and what was said of it, are added to `origins`.
fn arg_of(value: &Bound<'_, PyAny>, origins: &mut ArgOrigins, lists: u32) -> PyResult<Arg> {
    if let Ok(found) = value.cast::<ScriptValue>() {
        origins.calls.extend(found.get().calls.iter().cloned());
        origins.notes.extend(found.get().notes.iter().cloned());
        return Ok(found.get().arg.clone());
    }
    if let Ok(found) = value.cast::<Source>() {
        let path = path_of(found.get().shape()).map_err(PyValueError::new_err)?;
        return Ok(Arg::path(path));
    }
    if value.is_none() {
        return Ok(Arg::Nothing);
    }
    if value.is_instance_of::<PyBool>() {
        return Ok(Arg::Truth(value.is_truthy()?));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Arg::Text(text.to_string_lossy().into_owned()));
    }
    if (value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>()) && lists > 0 {
        let items = value.try_iter()?.map(|item| arg_of(&item?, origins, lists - 1));
        return Ok(Arg::List(items.collect::<PyResult<_>>()?));
    }
    match value.extract::<f64>() {
        Ok(number) => Ok(Arg::Number(number)),
        Err(_) => Ok(Arg::Other(format!("a {}", value.get_type().name()?))),
    }
}

impl ScriptValue {
    fn into_value(made: Arg, origins: ArgOrigins) -> PyResult<LanguageValue> {
        let ArgOrigins { mut calls, notes: all } = origins;
        let mut notes: Vec<String> = Vec::new();
        for note in all {
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
        calls.sort_by_key(|one| Arc::as_ptr(one) as usize);
        calls.dedup_by(|a, b| Arc::ptr_eq(a, b));
        match made {
            Arg::Number(value) => Ok(LanguageValue::Number(value)),
            arg => Ok(LanguageValue::ScriptValue(Self { arg, calls, notes })),
        }
    }

    /// A shape with sentences about what it was made of.
    pub(crate) fn from_field(field: Field, notes: Vec<String>) -> Self {
        Self { arg: Arg::shape(field), calls: Vec::new(), notes }
    }

    /// The path that it is.
    pub(crate) fn path(&self) -> Option<&ScriptPath> {
        if let Arg::Path(path) = &self.arg { Some(path) } else { None }
    }

    fn field(&self) -> PyResult<&Field> {
        match &self.arg {
            Arg::Shape(solid) => Ok(&solid.field),
            Arg::Path(_) => {
                Err(PyTypeError::new_err("this is a path; polygon() fills it, and sweep() follows it"))
            }
            _ => Err(PyTypeError::new_err("this is a formula; field() makes a shape of it")),
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

/// The exception of a Python function where there is one, else a leaf's own sentence.
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
    /// What a function of the language makes.
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
        let made = function.call_within(by_position, by_name, &job, &mut origins.notes);
        Self::into_value(made.map_err(value_error)?, origins)
    }

    /// What an operator makes; nothing where it has no meaning.
    #[staticmethod]
    fn operate(
        operator: &str,
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
    ) -> PyResult<Option<LanguageValue>> {
        let mut origins = ArgOrigins::default();
        let (a, b) = (arg_of(a, &mut origins, 0)?, arg_of(b, &mut origins, 0)?);
        match operate(operator, &a, &b) {
            Some(made) => Self::into_value(made.map_err(value_error)?, origins).map(Some),
            None => Ok(None),
        }
    }

    /// The coordinate of that number.
    #[staticmethod]
    fn axis(k: usize) -> PyResult<Self> {
        let found =
            Arg::axes().into_iter().nth(k).map(|(_, arg)| Self { arg, calls: Vec::new(), notes: Vec::new() });
        found.ok_or_else(|| PyValueError::new_err("there are three axes"))
    }

    /// The shape of a function from the bytes of points to the bytes of values, and one to those of
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
        // With a slope of at most 1 the value is never more than the distance.
        if lipschitz.is_some_and(|slope| slope <= 1.0) {
            field = field
                .with_distance(Distance { outside: DistanceQuality::Bound, inside: DistanceQuality::Bound });
        }
        Self { arg: Arg::shape(field), calls: vec![calls], notes: Vec::new() }
    }

    /// The same shape, with the promise that a box holds it.
    fn with_bounds(&self, bounds: [[f64; 3]; 2]) -> PyResult<Self> {
        let [min, max] = bounds;
        let field = self.field()?.clone().with_bounds(Box3 { min, max });
        Ok(Self { arg: Arg::shape(field), calls: self.calls.clone(), notes: self.notes.clone() })
    }

    /// Sentences about what it was made of.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Whether it is a shape and no formula.
    #[getter]
    fn is_shape(&self) -> bool {
        matches!(self.arg, Arg::Shape(_))
    }

    /// What the value is worth as a distance outside and inside.
    #[getter]
    fn distance(&self) -> PyResult<(&'static str, &'static str)> {
        let distance = self.field()?.distance();
        Ok((distance.outside.as_str(), distance.inside.as_str()))
    }

    /// What proofs about it are worth, and under which assumptions.
    #[getter]
    fn evidence(&self) -> PyResult<(&'static str, Vec<String>)> {
        let evidence = self.field()?.evidence();
        let kind = evidence.as_str();
        Ok((kind, if let Evidence::ProvedIf(sentences) = evidence { sentences } else { Vec::new() }))
    }

    /// A box that holds the shape.
    #[getter]
    fn bounds(&self) -> PyResult<[[f64; 3]; 2]> {
        let Box3 { min, max } = self.field()?.bounds();
        Ok([min, max])
    }

    /// The distinct terms of its expression.
    #[getter]
    fn terms(&self) -> PyResult<usize> {
        Ok(self.evaluable_field()?.tape().len())
    }

    /// The values at points: three coordinates a point in double precision, in the byte order of the machine.
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
            let done = field.tape().gradient_at(&points, &mut slopes);
            done.map(|()| bytes_of(slopes.into_iter().flat_map(|slope| slope.gradient)))
        })?;
        Ok(PyBytes::new(py, &gradients.map_err(|error| leaf_failure(&error, &self.calls))?))
    }

    /// An interval of the values in each box: six numbers a box, its least and its greatest corner, and two an interval.
    /// Without an end on either side where nothing is known.
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

    /// The shape as one that was read, cut off at a box.
    fn source(&self, region: Option<[[f64; 3]; 2]>) -> PyResult<Source> {
        self.source_in(region, Frame::default())
    }
}

impl ScriptValue {
    /// Evaluates on this thread where points are few and no Python function may take its time.
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

/// The box that a field is cut off at, where it is.
#[pyfunction]
pub(crate) fn region_of(source: &Source) -> Option<[[f64; 3]; 2]> {
    let Shape::Field(implicit) = source.shape() else { return None };
    implicit.region.map(|Box3 { min, max }| [min, max])
}

/// The value of a field that was read, or none for other shapes.
#[pyfunction]
pub(crate) fn field_of(source: &Source) -> Option<ScriptValue> {
    let Shape::Field(implicit) = source.shape() else { return None };
    Some(ScriptValue { arg: Arg::shape(implicit.field.clone()), calls: source.calls(), notes: Vec::new() })
}

/// The signed distance to triangles, as a value and as a shape that was read.
#[pyfunction]
pub(crate) fn mesh_field(py: Python<'_>, source: &Source) -> PyResult<(ScriptValue, Source)> {
    let Shape::Scene(scene) = source.shape() else {
        return Err(failure::internal(py, "these are no triangles"));
    };
    let (scene, frame) = (scene.clone(), source.frame());
    let made = work::run(py, None, move |job| scene_to_field(scene, job))?;
    let made = made.map_err(|error| failure::mesh(py, error.into()))?;
    let notes = made.notes.into_iter().map(|(_, note)| note).collect();
    let value = ScriptValue::from_field(made.field, notes);
    let shape = value.source_in(None, frame)?;
    Ok((value, shape))
}

/// A sentence as a warning of the input, as a script's report has it.
fn warning_of(note: &str) -> Warning {
    Warning { code: "script-said", count: 1, place: FileLocation::File, message: note.to_owned().into() }
}

/// Every function of the language: its name, how it is called, what it makes, and what the value is worth.
#[pyfunction]
pub(crate) fn language() -> Vec<(&'static str, String, &'static str, &'static str)> {
    functions().map(|f| (f.name, f.usage(), f.about, f.distance)).collect()
}

/// The name of a parameter, its default, and what it is.
type ParameterSetting = (String, f64, f64);

/// The line of a script that a warning is of, and what it says.
type LineWarning = (u64, &'static str);

/// What a shape script makes, with its parameters and warnings.
#[pyfunction]
pub(crate) fn script(
    py: Python<'_>,
    text: String,
    set: Vec<(String, f64)>,
) -> PyResult<(ScriptValue, Vec<ParameterSetting>, Vec<LineWarning>)> {
    let options = chordal_script::RunOptions { set: set.into_iter().collect(), ..Default::default() };
    let made = work::run(py, None, move |job| chordal_script::run(&text, &options, job))?;
    let made = made.map_err(|error| {
        let place = error.place.map_or(chordal_io::FileLocation::File, |(line, column)| {
            chordal_io::FileLocation::LineColumn { line, column }
        });
        failure::read(py, chordal_io::ReadError::new(error.code, place, error.message), None)
    })?;
    let parameters = made.parameters.into_iter().map(|p| (p.name, p.default, p.value)).collect();
    let warnings = made.warnings.iter().map(|warning| (warning.place.0, warning.message)).collect();
    Ok((ScriptValue::from_field(made.field, made.said), parameters, warnings))
}
