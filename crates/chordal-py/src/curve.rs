//! `Paths`: curves by their control points. `Lines`: the polylines that come of them.
use crate::array::{Array, Holder};
use crate::spec::{Wanted, parse_spacing, parsed};
use crate::{failure, work};
use chordal::budget::{Bounded, Budget, Code, Failure, InvalidLength, Length, Refusal, Unit};
use chordal::convert::{Spacing, curves_to_polylines};
use chordal::explicit::{Curve, Piece, Polyline};
use chordal::math::Box3;
use chordal::{Bezier, Job};
use chordal_verbs::BudgetSpec;
use chordal_verbs::report::{BoundFacts, BudgetFacts};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use serde_json::json;
use std::sync::Arc;

/// Curves by their control points, in the plane or in space.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Paths {
    curves: Arc<Dimension>,
    metres_per_unit: Option<f64>,
}

enum Dimension {
    Plane(Vec<Curve<2>>),
    Space(Vec<Curve<3>>),
}

#[pymethods]
impl Paths {
    /// `shape` is the number of curves, of control points of each (3n + 1 for n pieces), and of coordinates (2 or 3);
    /// `numbers` are all coordinates in that order, in double precision and the byte order of the machine.
    #[new]
    fn new(
        py: Python<'_>,
        numbers: PyBackedBytes,
        shape: (usize, usize, usize),
        unit: Option<&str>,
    ) -> PyResult<Self> {
        let metres_per_unit = parsed::<Unit>("unit", unit)?.map(Unit::metres);
        let (_, n_points, n_coordinates) = shape;
        let made = work::run(py, None, move |_| match n_coordinates {
            2 => chains(&numbers, n_points).map(Dimension::Plane),
            3 => chains(&numbers, n_points).map(Dimension::Space),
            n => Err(format!("points have 2 or 3 coordinates, not {n}")),
        })?;
        let curves = Arc::new(made.map_err(PyValueError::new_err)?);
        Ok(Self { curves, metres_per_unit })
    }

    /// The curves as polylines within a budget. The ends of segments are placed "fewest" or "even".
    fn flatten(
        &self,
        py: Python<'_>,
        wanted: Wanted,
        spacing: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Lines> {
        let spacing = parse_spacing(spacing)?;
        let asked = Asked { spec: wanted.spec(py)?, spacing, metres_per_unit: self.metres_per_unit };
        let curves = Arc::clone(&self.curves);
        let made = work::run(py, progress, move |job| match &*curves {
            Dimension::Plane(curves) => Lines::of(curves, &asked, job),
            Dimension::Space(curves) => Lines::of(curves, &asked, job),
        })?;
        made.map_err(|failed| failed.raise(py))
    }
}

/// One chain of cubics for each `n_points` points.
fn chains<const D: usize>(numbers: &[u8], n_points: usize) -> Result<Vec<Curve<D>>, String> {
    const WIDTH: usize = size_of::<f64>();
    let (numbers, rest) = numbers.as_chunks::<WIDTH>();
    let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect();
    let (points, odd) = numbers.as_chunks::<D>();
    let whole = n_points > 3 && n_points % 3 == 1 && points.len().is_multiple_of(n_points);
    if !(whole && rest.is_empty() && odd.is_empty()) {
        return Err(format!(
            "{n_points} control points a curve are not 3n + 1, or there are too few numbers"
        ));
    }
    points
        .chunks(n_points)
        .map(|chain| Curve::new(cubics(chain), false).map_err(|error| error.to_string()))
        .collect()
}

/// Neighbours share a point.
fn cubics<const D: usize>(chain: &[[f64; D]]) -> Vec<Piece<D>> {
    let control = |at: usize| [chain[at], chain[at + 1], chain[at + 2], chain[at + 3]];
    (0..chain.len() - 1).step_by(3).map(|at| Piece::Cubic(Bezier { control: control(at) })).collect()
}

/// Polylines, one after the other.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Lines {
    rows: Arc<Rows>,
    report: String,
    unmet: Option<String>,
}

/// The numbers of polylines.
struct Rows {
    /// All coordinates.
    points: Vec<f64>,
    /// Coordinates of a point.
    width: usize,
    /// For each polyline the index of its first point, and the number of all points at the end.
    starts: Vec<i64>,
    /// For each point its parameter on its curve.
    places: Vec<f64>,
}

/// Why there are none.
enum Failed {
    Length(InvalidLength),
    Refused(Refusal),
    Cancelled,
}

impl Failed {
    fn raise(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Length(error) => failure::budget(py, &error.to_string()),
            Self::Refused(refusal) => failure::refused(py, &refusal),
            // Whoever cancels has left by then with an exception of their own.
            Self::Cancelled => failure::internal(py, "cancelled"),
        }
    }
}

impl Lines {
    fn of<const D: usize>(curves: &[Curve<D>], asked: &Asked, job: &Job) -> Result<Self, Failed> {
        let budget = asked.budget(curves)?;
        let (made, unmet) = match curves_to_polylines(curves, &budget, job, asked.spacing) {
            Ok(made) => (made, None),
            Err(failure) => match (failure.to_string(), failure) {
                (sentence, Failure::Unmet(best)) => (*best, Some(sentence)),
                (_, Failure::Refused(refusal)) => return Err(Failed::Refused(refusal)),
                (_, Failure::Cancelled) => return Err(Failed::Cancelled),
            },
        };
        let Bounded { shape, bound } = made;
        let n_segments: usize = shape.iter().map(Polyline::n_segments).sum();
        let rows = Rows::of(&shape);
        let report = json!({
            "budget": BudgetFacts::of(&budget),
            "bound": BoundFacts::of(&bound),
            "output": { "polylines": shape.len(), "points": rows.places.len(), "segments": n_segments },
        });
        Ok(Self { rows: Arc::new(rows), report: report.to_string(), unmet })
    }
}

/// What a caller wants of some curves.
struct Asked {
    spec: BudgetSpec,
    spacing: Spacing,
    metres_per_unit: Option<f64>,
}

impl Asked {
    fn budget<const D: usize>(&self, curves: &[Curve<D>]) -> Result<Budget, Failed> {
        let BudgetSpec { length, pixels, triangles: segments, .. } = self.spec;
        let mut budget = Budget { pixels, segments, ..Budget::default() };
        if let Some(length) = length {
            let share = matches!(length, Length::Percent(_));
            let diagonal = if share { diagonal(curves) } else { 0.0 };
            if share && diagonal <= 0.0 {
                let message =
                    format!("the curves have no size, so {length} of it is no length: give one in units");
                return Err(Failed::Refused(Refusal { code: Code::Empty, message }));
            }
            budget.length = Some(length.resolve(diagonal, self.metres_per_unit).map_err(Failed::Length)?);
        }
        Ok(budget)
    }
}

impl Rows {
    fn of<const D: usize>(all: &[Polyline<D>]) -> Self {
        let n_points = all.iter().map(|line| line.points.len()).sum();
        let mut rows = Self {
            points: Vec::with_capacity(n_points * D),
            width: D,
            starts: Vec::with_capacity(all.len() + 1),
            places: Vec::with_capacity(n_points),
        };
        for line in all {
            rows.starts.push(rows.places.len() as i64);
            rows.points.extend_from_slice(line.points.as_flattened());
            rows.places.extend_from_slice(&line.places);
        }
        rows.starts.push(rows.places.len() as i64);
        rows
    }
}

#[pymethods]
impl Lines {
    /// n × 2 or n × 3 coordinates.
    #[getter]
    fn points(&self) -> Array {
        Array::new(Points(Arc::clone(&self.rows)))
    }

    /// For each polyline the index of its first point, and the number of all points at the end.
    #[getter]
    fn starts(&self) -> Array {
        Array::new(Starts(Arc::clone(&self.rows)))
    }

    /// For each point its parameter on its curve.
    #[getter]
    fn places(&self) -> Array {
        Array::new(Places(Arc::clone(&self.rows)))
    }

    /// Why they miss their budget, in a sentence, if they do.
    #[getter]
    fn unmet(&self) -> Option<&str> {
        self.unmet.as_deref()
    }

    /// The report, as JSON.
    #[getter]
    fn report(&self) -> &str {
        &self.report
    }
}

struct Points(Arc<Rows>);

impl Holder for Points {
    fn start(&self) -> *const u8 {
        self.0.points.as_ptr().cast()
    }

    fn shape(&self) -> Vec<usize> {
        vec![self.0.places.len(), self.0.width]
    }

    fn kind(&self) -> &'static str {
        "f8"
    }
}

struct Starts(Arc<Rows>);

impl Holder for Starts {
    fn start(&self) -> *const u8 {
        self.0.starts.as_ptr().cast()
    }

    fn shape(&self) -> Vec<usize> {
        vec![self.0.starts.len()]
    }

    fn kind(&self) -> &'static str {
        "i8"
    }
}

struct Places(Arc<Rows>);

impl Holder for Places {
    fn start(&self) -> *const u8 {
        self.0.places.as_ptr().cast()
    }

    fn shape(&self) -> Vec<usize> {
        vec![self.0.places.len()]
    }

    fn kind(&self) -> &'static str {
        "f8"
    }
}

/// Points looked at on a piece.
const SAMPLES: u32 = 16;

/// The diagonal of the box of points on the curves, from below: a sample only makes it smaller, and what rounding may
/// have added is taken off.
fn diagonal<const D: usize>(curves: &[Curve<D>]) -> f64 {
    let samples = curves.iter().flat_map(|curve| {
        let last = u32::try_from(curve.pieces().len()).unwrap_or(u32::MAX).saturating_mul(SAMPLES);
        (0..=last).map(|i| curve.at(f64::from(i) / f64::from(SAMPLES)))
    });
    let in_space = |p: [f64; D]| std::array::from_fn(|k| p.get(k).copied().unwrap_or(0.0));
    let known = samples.fold(Box3::EMPTY, |known, point| known.with(in_space(point)));
    let reach = known.min.iter().chain(&known.max).fold(0.0, |most: f64, x| most.max(x.abs()));
    // Six coordinates are off by less than 8 half steps each, and the length by less than 8 of its own, which is less
    // than four times the reach.
    known.diagonal() - 64.0 * f64::EPSILON * reach
}
