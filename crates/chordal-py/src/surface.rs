//! NURBS surfaces from Python's arguments.
use crate::path::{frame_in, numbers, path_of, source_with_digest};
use crate::source::Source;
use chordal::explicit::Curve;
use chordal::explicit::nurbs::{InvalidNurbs, KnotVector, NurbsCurve, NurbsSurface, TrimmedSurface};
use chordal_io::Frame;
use chordal_script::language::ScriptPath;
use chordal_verbs::Shape;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;

/// A surface by its control points.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct SurfaceArguments {
    /// The numbers of points along `u` and `v`.
    shape: [usize; 2],
    degrees: [usize; 2],
    /// The knot vectors, unless they are clamped and uniform.
    knots: Option<[Vec<f64>; 2]>,
    unit: Option<String>,
}

/// A surface from coordinates and weights, row by row, in double precision and native byte order.
#[pyfunction]
pub(crate) fn surface(
    control: PyBackedBytes,
    weights: PyBackedBytes,
    arguments: SurfaceArguments,
) -> PyResult<Source> {
    let frame = frame_in(arguments.unit.as_deref())?;
    let knots = [0, 1].map(|k| match &arguments.knots {
        Some(knots) => KnotVector::new(arguments.degrees[k], knots[k].clone()),
        None => KnotVector::clamped(arguments.degrees[k], arguments.shape[k]),
    });
    let surface = || {
        let [u, v] = knots;
        let points = numbers(&control).as_chunks::<3>().0.to_vec();
        NurbsSurface::new([u?, v?], points, numbers(&weights))
    };
    Ok(source_of(surface().map_err(value_error)?, frame))
}

/// The surface that a path of radius and height sweeps in a full turn around the z axis.
#[pyfunction]
pub(crate) fn revolved(source: &Source) -> PyResult<Source> {
    let ScriptPath::Plane(curve) = path_of(source.shape()).map_err(PyValueError::new_err)? else {
        let message = "expected a path in the plane, of radius and height, not one in space";
        return Err(PyValueError::new_err(message));
    };
    let surface = NurbsCurve::from_path(&curve).and_then(|profile| NurbsSurface::revolved(&profile));
    Ok(source_of(surface.map_err(value_error)?, source.frame()))
}

/// The surface that a path sweeps along a vector.
#[pyfunction]
pub(crate) fn extruded(source: &Source, along: [f64; 3]) -> PyResult<Source> {
    fn lifted(curve: &Curve<2>) -> Result<NurbsCurve<3>, InvalidNurbs> {
        let flat = NurbsCurve::from_path(curve)?;
        let control = flat.control().iter().map(|[x, y]| [*x, *y, 0.0]).collect();
        NurbsCurve::new(flat.knots().clone(), control, flat.weights().to_vec())
    }
    let curve = match path_of(source.shape()).map_err(PyValueError::new_err)? {
        ScriptPath::Plane(curve) => lifted(&curve),
        ScriptPath::Space(curve) => NurbsCurve::from_path(&curve),
    };
    let surface = curve.and_then(|curve| NurbsSurface::extruded(&curve, along));
    Ok(source_of(surface.map_err(value_error)?, source.frame()))
}

fn value_error(error: InvalidNurbs) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn source_of(surface: NurbsSurface, frame: Frame) -> Source {
    let bytes = format!("{surface:?}").into_bytes();
    source_with_digest(Shape::Surfaces { surfaces: vec![TrimmedSurface::from(surface)], frame }, &bytes)
}
