//! Paths for Python: paths of the script language, points on paths, and cubics that approximate paths or
//! points.
use crate::script_value::ScriptValue;
use crate::source::Source;
use crate::spec::parse_argument;
use crate::{failure, work};
use chordal::budget::{Bounded, Failure, Unit};
use chordal::convert::curve_to_cubics;
use chordal::convert::splines::{Corners, SplineFit, points_to_spline};
use chordal::explicit::{Curve, CurveEnds};
use chordal::{Bound, Job, Tolerance};
use chordal_io::{DrawingElement, Format, Frame, PathSet};
use chordal_script::language::ScriptPath;
use chordal_verbs::report::BoundFacts;
use chordal_verbs::{Input, Shape, drawing_to_field, sha256};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

/// The path of a shape that is a single path.
///
/// # Errors
/// A sentence, if the shape is no path or several.
pub(crate) fn path_of(shape: &Shape) -> Result<ScriptPath, String> {
    let many = |n: usize| format!("expected one curve as a path, not {n}");
    match shape {
        Shape::Drawing(drawing) => match &drawing.lines[..] {
            [line] => Ok(line.clone().into()),
            lines => Err(many(lines.len())),
        },
        Shape::Curves(curves) => match &curves.lines[..] {
            [line] => Ok(line.clone().into()),
            lines => Err(many(lines.len())),
        },
        other => Err(format!("expected a curve as a path, not {}", other.kind())),
    }
}

fn path_set<const D: usize>(lines: Vec<Curve<D>>, frame: Frame) -> PathSet<Curve<D>> {
    let n = lines.len();
    let element =
        |source| DrawingElement { kind: "curve", source, filled: true, ..DrawingElement::default() };
    let elements = (0..n as u64).map(element).collect();
    PathSet { lines, owners: (0..n as u32).collect(), elements, frame, ..PathSet::default() }
}

/// A path as a source. Its digest is that of its control points and weights, printed with all digits.
fn source_of(path: ScriptPath, frame: Frame) -> Source {
    let bytes = format!("{path:?}").into_bytes();
    let shape = match path {
        ScriptPath::Plane(curve) => Shape::Drawing(path_set(vec![curve], frame)),
        ScriptPath::Space(curve) => Shape::Curves(path_set(vec![curve], frame)),
    };
    source_with_digest(shape, &bytes)
}

/// A shape without a file; its digest is that of `bytes`.
pub(crate) fn source_with_digest(shape: Shape, bytes: &[u8]) -> Source {
    let (n_bytes, digest) = (bytes.len() as u64, sha256(bytes).into());
    let input = Input { n_bytes, digest, ..Input::made(shape, Format::Json) };
    Source::from_input(input, Vec::new())
}

/// The frame of coordinates in a unit.
pub(crate) fn frame_in(unit: Option<&str>) -> PyResult<Frame> {
    let metres_per_unit = parse_argument::<Unit>("unit", unit)?.map(Unit::metres);
    Ok(Frame { up: None, metres_per_unit, ..Frame::default() })
}

/// Numbers in double precision and native byte order.
pub(crate) fn numbers(bytes: &[u8]) -> Vec<f64> {
    let (rows, _) = bytes.as_chunks::<{ size_of::<f64>() }>();
    rows.iter().map(|row| f64::from_ne_bytes(*row)).collect()
}

fn bytes_of<const D: usize>(points: &[[f64; D]]) -> Vec<u8> {
    points.as_flattened().iter().flat_map(|x| x.to_ne_bytes()).collect()
}

/// A bound as JSON, as in reports.
fn facts(py: Python<'_>, bound: &Bound) -> PyResult<String> {
    serde_json::to_string(&BoundFacts::new(bound)).map_err(|error| failure::internal(py, &error.to_string()))
}

/// A path of the script language as a source.
#[pyfunction]
pub(crate) fn path_source(value: &ScriptValue, unit: Option<&str>) -> PyResult<Source> {
    let path = value.path().ok_or_else(|| PyValueError::new_err("this is not a path"))?;
    Ok(source_of(path.clone(), frame_in(unit)?))
}

/// The number of curves, of all pieces, and of coordinates; and whether it is a single closed curve.
#[pyfunction]
pub(crate) fn path_facts(source: &Source) -> PyResult<(usize, usize, usize, bool)> {
    fn facts_of<const D: usize>(paths: &PathSet<Curve<D>>) -> (usize, usize, usize, bool) {
        let n_pieces = paths.lines.iter().map(|line| line.segments().len()).sum();
        (paths.lines.len(), n_pieces, D, matches!(&paths.lines[..], [line] if line.is_closed()))
    }
    match source.shape() {
        Shape::Drawing(drawing) => Ok(facts_of(drawing)),
        Shape::Curves(curves) => Ok(facts_of(curves)),
        other => Err(PyValueError::new_err(format!("{} are no curves", other.kind()))),
    }
}

/// Points of a path, or its derivatives of order 1 or 2 by the parameter of each piece. A place is the index
/// of the piece plus the parameter in it. All numbers are in double precision and native byte order.
#[pyfunction]
pub(crate) fn path_at<'py>(
    py: Python<'py>,
    source: &Source,
    places: PyBackedBytes,
    order: usize,
) -> PyResult<pyo3::Bound<'py, PyBytes>> {
    fn evaluated<const D: usize>(curve: &Curve<D>, places: &[f64], order: usize) -> Vec<u8> {
        let at = |s: &f64| match (order, curve.locate(*s)) {
            (1, Some((piece, t))) => curve.segments()[piece].tangent(t),
            (2, Some((piece, t))) => curve.segments()[piece].second_derivative(t),
            (0, _) => curve.at(*s),
            // A path that is a single point does not move.
            _ => [0.0; D],
        };
        bytes_of(&places.iter().map(at).collect::<Vec<_>>())
    }
    let path = path_of(source.shape()).map_err(PyValueError::new_err)?;
    let places = numbers(&places);
    let is_few = places.len() <= work::FEW_POINTS;
    let evaluate = move || match path {
        ScriptPath::Plane(curve) => evaluated(&curve, &places, order),
        ScriptPath::Space(curve) => evaluated(&curve, &places, order),
    };
    let bytes =
        if is_few { work::run_briefly(py, evaluate)? } else { work::run(py, None, move |_| evaluate())? };
    Ok(PyBytes::new(py, &bytes))
}

/// The failure of an arrow as an exception.
pub(crate) fn arrow_failure<T>(py: Python<'_>, failure: Failure<T>) -> PyErr {
    match failure {
        Failure::Refused(why) => failure::refused_error(py, why),
        Failure::Unmet(_) => failure::internal(py, "an unexpected best result"),
        Failure::Cancelled => failure::internal(py, "an unexpected cancellation"),
    }
}

/// The length of an argument.
fn length(py: Python<'_>, name: &str, length: f64) -> PyResult<Tolerance> {
    Tolerance::new(length).map_err(|error| failure::budget(py, &format!("{name}: {error}")))
}

/// The same curves as lines and cubics within a length, and the bound as JSON.
#[pyfunction]
pub(crate) fn to_cubics(py: Python<'_>, source: &Source, tol: f64) -> PyResult<(Source, String)> {
    fn approximated<const D: usize>(
        paths: PathSet<Curve<D>>,
        tol: Tolerance,
        job: &Job,
    ) -> Result<(PathSet<Curve<D>>, Bound), Failure<Curve<D>>> {
        let (mut lines, mut worst) = (Vec::with_capacity(paths.lines.len()), None::<Bound>);
        for line in &paths.lines {
            let Bounded { shape, bound } = curve_to_cubics(line, tol, job)?;
            lines.push(shape);
            if worst.as_ref().is_none_or(|known| known.at_most() < bound.at_most()) {
                worst = Some(bound);
            }
        }
        Ok((
            paths.with_lines(lines),
            worst.unwrap_or_else(|| Bound::exact(chordal::budget::Reference::Curves)),
        ))
    }
    let tol = length(py, "tol", tol)?;
    let (shape, bound) = match source.shape().clone() {
        Shape::Drawing(drawing) => {
            let cubics = work::run(py, None, move |job| approximated(drawing, tol, job))?;
            let (drawing, bound) = cubics.map_err(|failure| arrow_failure(py, failure))?;
            (Shape::Drawing(drawing), bound)
        }
        Shape::Curves(curves) => {
            let cubics = work::run(py, None, move |job| approximated(curves, tol, job))?;
            let (curves, bound) = cubics.map_err(|failure| arrow_failure(py, failure))?;
            (Shape::Curves(curves), bound)
        }
        other => return Err(PyValueError::new_err(format!("{} are no curves", other.kind()))),
    };
    let bytes = format!("{shape:?}").into_bytes();
    Ok((source_with_digest(shape, &bytes), facts(py, &bound)?))
}

/// The options of a fit.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct FitArguments {
    width: usize,
    tolerance: f64,
    closed: bool,
    corners: f64,
    unit: Option<String>,
}

/// A path of few cubics near points of `width` coordinates in a row, and the bound as JSON.
#[pyfunction]
pub(crate) fn fit(
    py: Python<'_>,
    points: PyBackedBytes,
    arguments: FitArguments,
) -> PyResult<(Source, String)> {
    fn fitted<const D: usize>(
        points: &[f64],
        (ends, fit): (CurveEnds, &SplineFit),
        job: &Job,
    ) -> Result<(ScriptPath, Bound), Failure<Curve<D>>>
    where
        ScriptPath: From<Curve<D>>,
    {
        let spline = points_to_spline(points.as_chunks::<D>().0, ends, fit, job)?;
        Ok((spline.shape.into(), spline.bound))
    }
    let FitArguments { width, tolerance, closed, corners, unit } = arguments;
    let frame = frame_in(unit.as_deref())?;
    let fit =
        SplineFit { length: length(py, "tolerance", tolerance)?, corners: Corners::Sharper { deg: corners } };
    let ends = CurveEnds::from(closed);
    let (path, bound) = if width == 2 {
        let spline = work::run(py, None, move |job| fitted::<2>(&numbers(&points), (ends, &fit), job))?;
        spline.map_err(|failure| arrow_failure(py, failure))?
    } else {
        let spline = work::run(py, None, move |job| fitted::<3>(&numbers(&points), (ends, &fit), job))?;
        spline.map_err(|failure| arrow_failure(py, failure))?
    };
    Ok((source_of(path, frame), facts(py, &bound)?))
}

/// The area of a drawing as a field: the distance to polygons that approximate it within a length.
#[pyfunction]
pub(crate) fn drawing_field(
    py: Python<'_>,
    source: &Source,
    name: &str,
    tolerance: f64,
) -> PyResult<ScriptValue> {
    let Shape::Drawing(drawing) = source.shape().clone() else {
        return Err(PyValueError::new_err(format!("{name}: {} are no drawing", source.shape().kind())));
    };
    let tolerance = length(py, "tolerance", tolerance)?;
    let result = work::run(py, None, move |job| drawing_to_field(&drawing, tolerance, job))?;
    let (field, sentences) = result.map_err(|why| failure::argument(name, why))?;
    let notes = sentences.into_iter().map(|sentence| format!("{name}: {sentence}")).collect();
    Ok(ScriptValue::from_field(field, notes))
}
