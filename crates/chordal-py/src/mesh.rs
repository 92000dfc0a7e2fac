//! `Triangles`: a mesh with all that is known of it, and the way back to its source.
use crate::array::{Array, Holder};
use crate::{failure, work};
use chordal::{Job, Mesh};
use chordal_io::{Format, WriteError};
use chordal_verbs::report::{Report, Run};
use chordal_verbs::{BudgetSpec, Input, MeshFailure, MeshOutcome, mesh};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::borrow::Cow;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The format that a mesh in memory is made for: it keeps every digit and every vertex.
const IN_MEMORY: Format = Format::Ply;

/// What a mesh is made of.
#[derive(Clone)]
struct Order {
    input: Arc<Input>,
    name: Option<String>,
    spec: BudgetSpec,
}

/// What came of it.
#[derive(Clone)]
struct Made {
    outcome: Arc<MeshOutcome>,
    /// Why it misses the budget, in a sentence, if it does.
    unmet: Option<String>,
    took: Duration,
}

impl Order {
    /// Makes the mesh for a format.
    fn fill(&self, to: Format, job: &Job) -> Result<Made, MeshFailure> {
        let start = Instant::now();
        let (outcome, unmet) = match mesh(Input::clone(&self.input), &self.spec, to, job) {
            Ok(outcome) => (outcome, None),
            Err(failure) => match (failure.to_string(), failure) {
                (sentence, MeshFailure::Unmet(best)) => (*best, Some(sentence)),
                (_, failure) => return Err(failure),
            },
        };
        Ok(Made { outcome: Arc::new(outcome), unmet, took: start.elapsed() })
    }
}

/// A mesh with all that is known of it, and the way back to its source.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Triangles {
    order: Order,
    made: Made,
    rows: Arc<Rows>,
}

impl Triangles {
    /// Makes the mesh of a shape and its file's name.
    pub(crate) fn make(
        py: Python<'_>,
        (input, name): (Arc<Input>, Option<String>),
        spec: BudgetSpec,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        Self::filled(py, Order { input, name, spec }, IN_MEMORY, progress)
    }

    fn filled(py: Python<'_>, order: Order, to: Format, progress: Option<Py<PyAny>>) -> PyResult<Self> {
        let own = order.clone();
        let made = work::run(py, progress, move |job| {
            let made = own.fill(to, job)?;
            let rows = Rows::of(&made.outcome)?;
            Ok((made, rows))
        })?;
        let (made, rows) = made.map_err(|error| failure::mesh(py, &error))?;
        Ok(Self { order, made, rows: Arc::new(rows) })
    }
}

#[pymethods]
impl Triangles {
    /// n × 3 coordinates.
    #[getter]
    fn vertices(&self) -> Array {
        Array::new(Vertices(Arc::clone(&self.rows)))
    }

    /// m × 3 indices into the vertices.
    #[getter]
    fn faces(&self, py: Python<'_>) -> PyResult<Array> {
        let n_vertices = self.rows.vertices().len();
        if i32::try_from(n_vertices).is_err() {
            let message = format!("{n_vertices} vertices are more than 32-bit signed indices can name");
            return Err(failure::write(py, &WriteError::Unsupported(message)));
        }
        Ok(Array::new(Faces(Arc::clone(&self.rows))))
    }

    /// Why it misses its budget, in a sentence, if it does.
    #[getter]
    fn unmet(&self) -> Option<&str> {
        self.made.unmet.as_deref()
    }

    /// The report, as JSON.
    #[getter]
    fn report(&self) -> String {
        let Made { outcome, took, .. } = &self.made;
        let (input, seconds) = (self.order.name.clone(), Some(took.as_secs_f64()));
        let run = Run { verb: "mesh", input, seconds, ..Run::default() };
        Report::new(outcome.certificate.clone(), run).to_value().to_string()
    }

    /// The same shape within the same budget for a file of that format, whose rounding then counts.
    fn remake(&self, py: Python<'_>, format: &str) -> PyResult<Self> {
        let to: Format = format.parse().map_err(|error| failure::argument("format", error))?;
        let order = self.order.clone();
        if to == self.made.outcome.format {
            return Ok(Self { order, made: self.made.clone(), rows: Arc::clone(&self.rows) });
        }
        Self::filled(py, order, to, None)
    }

    /// The bytes of a file of the format that the mesh was made for.
    fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let outcome = Arc::clone(&self.made.outcome);
        let written = work::run(py, None, move |_| {
            let mut bytes = Vec::new();
            outcome.write(&mut bytes).map(|()| bytes)
        })?;
        Ok(PyBytes::new(py, &written.map_err(|error| failure::write(py, &error))?))
    }
}

/// The rows of a mesh.
enum Rows {
    /// Those of its only part.
    Only(Arc<MeshOutcome>),
    /// Those of all parts, one after the other.
    Joined { vertices: Vec<[f64; 3]>, faces: Vec<[u32; 3]> },
}

impl Rows {
    /// All that a scene shows, in its own space and the order of its tree, as the file of such a mesh has it.
    fn of(outcome: &Arc<MeshOutcome>) -> Result<Self, MeshFailure> {
        let Some(scene) = outcome.scene() else {
            return Ok(Self::Joined { vertices: Vec::new(), faces: Vec::new() });
        };
        let meshes = scene.world_meshes()?;
        if let ([(_, Cow::Borrowed(_))], [_]) = (&meshes[..], &scene.parts[..]) {
            return Ok(Self::Only(Arc::clone(outcome)));
        }
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for (_, mesh) in &meshes {
            // Where that is too many for an index, `faces` refuses, for it wants one bit less.
            let first = vertices.len() as u32;
            vertices.extend_from_slice(mesh.positions());
            faces.extend(mesh.faces().iter().map(|face| face.map(|index| first.saturating_add(index))));
        }
        Ok(Self::Joined { vertices, faces })
    }

    fn vertices(&self) -> &[[f64; 3]] {
        match self {
            Self::Only(outcome) => only(outcome).map_or(&[], Mesh::positions),
            Self::Joined { vertices, .. } => vertices,
        }
    }

    fn faces(&self) -> &[[u32; 3]] {
        match self {
            Self::Only(outcome) => only(outcome).map_or(&[], Mesh::faces),
            Self::Joined { faces, .. } => faces,
        }
    }
}

/// The mesh of a scene's first part.
fn only(outcome: &MeshOutcome) -> Option<&Mesh> {
    outcome.scene().and_then(|scene| scene.parts.first()).map(|part| &part.mesh)
}

struct Vertices(Arc<Rows>);

impl Holder for Vertices {
    fn start(&self) -> *const u8 {
        self.0.vertices().as_ptr().cast()
    }

    fn shape(&self) -> Vec<usize> {
        vec![self.0.vertices().len(), 3]
    }

    fn kind(&self) -> &'static str {
        "f8"
    }
}

/// Indices below 2³¹, whose bits are the same with a sign.
struct Faces(Arc<Rows>);

impl Holder for Faces {
    fn start(&self) -> *const u8 {
        self.0.faces().as_ptr().cast()
    }

    fn shape(&self) -> Vec<usize> {
        vec![self.0.faces().len(), 3]
    }

    fn kind(&self) -> &'static str {
        "i4"
    }
}
