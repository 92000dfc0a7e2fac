//! `Outcome`: triangles or polylines with their certificate, and the order that made them.
use crate::array::Array;
use crate::python_leaf::CallLog;
use crate::rows::{PolylineRows, TriangleRows};
use crate::source::Source;
use crate::spec::{GivenOptions, Patience, request};
use crate::spelling::Keywords;
use crate::work::ProgressListener;
use crate::{failure, work};
use chordal::Job;
use chordal::budget::advice::Spell;
use chordal_cli::spelling::CommandLine;
use chordal_io::{FileSet, Format, Scene};
use chordal_verbs::options::OutputOptions;
use chordal_verbs::report::{Certificate, Report, RunFacts};
use chordal_verbs::{
    BooleanOperand, BudgetSpec, Input, MendSpec, MeshFailure, MeshOutcome, OutputForm, Shape, Tessellation,
    mend, mesh, mesh_boolean, sha256, time_limit,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// An input and the task to run on it.
#[derive(Clone)]
pub(crate) struct MeshOrder {
    pub input: Arc<Input>,
    /// The file that it was read from.
    pub name: Option<String>,
    pub task: MeshTask,
    /// The calls of the Python functions in the input.
    pub calls: Vec<Arc<CallLog>>,
}

/// The task for an input.
#[derive(Clone)]
pub(crate) enum MeshTask {
    Mesh(BudgetSpec, Patience),
    /// A Boolean with other solids, from left to right.
    Combine(Vec<BooleanOperand>, BudgetSpec, Patience),
    Mend(MendSpec),
}

impl MeshTask {
    /// The verb in a report.
    fn verb(&self) -> &'static str {
        match self {
            Self::Mesh(..) | Self::Combine(..) => "mesh",
            Self::Mend(_) => "mend",
        }
    }

    /// The name of the first stage of progress.
    fn name(&self) -> &'static str {
        match self {
            Self::Combine(..) => "combine",
            other => other.verb(),
        }
    }

    /// The limits of the work on a field.
    fn patience(&self) -> Patience {
        match self {
            Self::Mesh(_, patience) | Self::Combine(_, _, patience) => *patience,
            Self::Mend(_) => Patience::default(),
        }
    }

    /// The time after which the best result so far is taken.
    fn time_limit(&self, shape: &Shape) -> Option<Duration> {
        let Patience { within, proof } = self.patience();
        match self {
            Self::Mesh(spec, _) | Self::Combine(_, spec, _) => time_limit(shape, within, spec.require, proof),
            Self::Mend(_) => None,
        }
    }

    fn apply(&self, input: Input, to: OutputForm, job: &Job) -> Result<MeshOutcome, MeshFailure> {
        match self {
            Self::Mesh(spec, _) => mesh(input, spec, to, job),
            Self::Combine(others, spec, _) => mesh_boolean(input, others.clone(), spec, to, job),
            Self::Mend(spec) => mend(input, spec, to, job),
        }
    }
}

/// The result of an order.
#[derive(Clone)]
struct MeshRun {
    outcome: Arc<MeshOutcome>,
    /// The certificate in the spelling of Python; the file has that of the command.
    certificate: Certificate,
    rows: OutcomeRows,
    /// Why it misses the budget, if it does.
    unmet: Option<String>,
    duration: Duration,
    /// The points at which Python functions were evaluated meanwhile, if there are such functions.
    evaluations: Option<u64>,
}

/// The arrays for Python.
#[derive(Clone)]
enum OutcomeRows {
    Triangles(Arc<TriangleRows>),
    Lines(Arc<PolylineRows>),
}

impl MeshOrder {
    fn run(&self, to: OutputForm, job: &Job) -> Result<MeshRun, MeshFailure> {
        let start = Instant::now();
        let mut job = job.clone();
        job.proof_effort = self.task.patience().proof;
        let n_points = || self.calls.iter().map(|calls| calls.points()).sum::<u64>();
        // The logs belong to the functions of the shape, and count the points of its earlier meshes as
        // well.
        let n_before = n_points();
        let result = self.task.apply(Input::clone(&self.input), to, &job);
        let (outcome, unmet) = match result {
            Ok(outcome) => (outcome, None),
            Err(failure) => match (failure.to_string(), failure) {
                (sentence, MeshFailure::Unmet(best)) => (*best, Some(sentence)),
                (_, failure) => return Err(failure),
            },
        };
        let duration = start.elapsed();
        let evaluations = (!self.calls.is_empty()).then(|| n_points() - n_before);
        let certificate = outcome.certificate.clone().spelled(&Keywords);
        // The file says it in the words of the command, so that its bytes are the same wherever it is
        // made.
        let outcome = Arc::new(outcome.spelled(&CommandLine));
        let rows = match &outcome.made {
            Tessellation::Triangles(_) => {
                OutcomeRows::Triangles(Arc::new(TriangleRows::from_outcome(&outcome)?))
            }
            Tessellation::Polylines(lines) => {
                OutcomeRows::Lines(Arc::new(PolylineRows::from_polylines(lines)))
            }
        };
        Ok(MeshRun { outcome, certificate, rows, unmet, duration, evaluations })
    }
}

/// Triangles or polylines with their certificate, and the order that made them.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Outcome {
    order: MeshOrder,
    /// The form of the file that it was made for.
    form: OutputForm,
    run: MeshRun,
}

impl Outcome {
    /// Runs an order for a form of file.
    pub(crate) fn new(
        py: Python<'_>,
        order: MeshOrder,
        form: OutputForm,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let job_order = order.clone();
        let listener = ProgressListener::new(progress, order.task.name());
        let limit = order.task.time_limit(&order.input.shape);
        let run = work::run_within(py, listener, limit, move |job| job_order.run(form, job))?;
        let run = run.map_err(|error| failure::mesh(py, error))?;
        Ok(Self { order, form, run })
    }
}

#[pymethods]
impl Outcome {
    /// Why it misses its budget, if it does.
    #[getter]
    fn unmet(&self) -> Option<&str> {
        self.run.unmet.as_deref()
    }

    /// The report, as JSON.
    #[getter]
    fn report(&self) -> String {
        let MeshRun { certificate, duration, evaluations, .. } = &self.run;
        let (input, seconds) = (self.order.name.clone(), Some(duration.as_secs_f64()));
        let run = RunFacts {
            verb: self.order.task.verb(),
            input,
            seconds,
            evaluations: *evaluations,
            ..RunFacts::default()
        };
        Report::new(certificate.clone(), run).to_value().to_string()
    }

    /// An array by its name: "vertices" and "faces" of triangles; "points", "places", "starts", "closed" and
    /// "sources" of polylines.
    fn array(&self, py: Python<'_>, name: &str) -> PyResult<Array> {
        let array = match &self.run.rows {
            OutcomeRows::Triangles(rows) => rows.array(name),
            OutcomeRows::Lines(rows) => PolylineRows::array(rows, name),
        };
        array.ok_or_else(|| failure::internal(py, &format!("there are no {name}, or too many")))
    }

    /// The triangles as a shape, as if read from their file: with the certificate, so that later results
    /// include their error.
    fn source(&self, py: Python<'_>) -> PyResult<Source> {
        let outcome = Arc::clone(&self.run.outcome);
        let input = work::run(py, None, move |_| {
            let certificate = Some(outcome.certificate.to_value());
            let scene = Scene { certificate, ..outcome.scene()?.clone() };
            let mut bytes = Vec::new();
            outcome.write(&mut bytes).ok()?;
            let (n_bytes, digest) = (bytes.len() as u64, sha256(&bytes).into());
            Some(Input { n_bytes, digest, ..Input::made(Shape::Scene(scene), outcome.format) })
        })?;
        let input = input.ok_or_else(|| failure::internal(py, "there are no triangles"))?;
        Ok(Source::from_input(input, Vec::new()))
    }

    /// The same shape within the same budget for another format, whose rounding counts towards the budget. A
    /// glTF may be quantized, and compressed by a codec.
    fn remake(
        &self,
        py: Python<'_>,
        format: &str,
        options: GivenOptions,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let (form, options) = form_of(py, format, &options)?;
        let mut made = if form == self.form {
            Self { order: self.order.clone(), form, run: self.run.clone() }
        } else {
            Self::new(py, self.order.clone(), form, progress)?
        };
        if options.leaves_out_sources {
            options.strip(&mut made.run.certificate);
            options.strip(&mut Arc::make_mut(&mut made.run.outcome).certificate);
        }
        Ok(made)
    }

    /// The bytes of a file of the format that it was made for.
    fn write<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let outcome = Arc::clone(&self.run.outcome);
        let written = work::run(py, None, move |_| {
            let mut bytes = Vec::new();
            outcome.write(&mut bytes).map(|()| bytes)
        })?;
        Ok(PyBytes::new(py, &written.map_err(|error| failure::write(py, &error))?))
    }

    /// Whether the file references other files, as an OBJ its materials.
    #[getter]
    fn names_files(&self) -> bool {
        self.run.outcome.names_files()
    }

    /// The file as of [`Self::write`], but with references to other files, and the names and bytes of these.
    /// The names begin with `stem`.
    fn write_files<'py>(&self, py: Python<'py>, stem: String) -> PyResult<FileBytes<'py>> {
        let outcome = Arc::clone(&self.run.outcome);
        let written =
            work::run(py, None, move |_| outcome.write_files(&stem).map(|files| files.into_owned()))?;
        Ok(file_bytes(py, written.map_err(|error| failure::write(py, &error))?))
    }
}

/// A format with the options of its file, and all of these options.
pub(crate) fn form_of(
    py: Python<'_>,
    format: &str,
    options: &GivenOptions,
) -> PyResult<(OutputForm, OutputOptions)> {
    let to: Format = format.parse().map_err(|error| failure::argument("format", error))?;
    let options: OutputOptions = request(py, options)?;
    let form = options.form(to).map_err(|why| PyValueError::new_err(why.spelled(&Keywords).to_string()))?;
    Ok((form, options))
}

/// A file and the files that it references, for Python.
pub(crate) fn file_bytes<'py>(py: Python<'py>, files: FileSet<'_>) -> FileBytes<'py> {
    let beside = files.beside.iter().map(|file| (file.name.clone(), PyBytes::new(py, &file.bytes)));
    (PyBytes::new(py, &files.document), beside.collect())
}

/// The bytes of a file, and of the files that it references with their names.
pub(crate) type FileBytes<'py> = (Bound<'py, PyBytes>, Vec<(String, Bound<'py, PyBytes>)>);
