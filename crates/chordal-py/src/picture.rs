//! Pictures, from Python's arguments.
use crate::array::{Array, ArrayData};
use crate::source::Source;
use crate::spec::{GivenOptions, mismatch, request};
use crate::spelling::Keywords;
use crate::work::ProgressListener;
use crate::{failure, work};
use chordal::budget::View;
use chordal::budget::advice::Spell;
use chordal::render;
use chordal_io::PictureFormat;
use chordal_verbs::options::{PictureContent, PictureOptions};
use chordal_verbs::report::{Report, RunFacts};
use chordal_verbs::{RenderOutcome, render, render_against, render_comb};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use std::sync::Arc;

/// A picture with its facts.
struct ShownPicture {
    picture: render::Picture,
    /// The text fields of a picture file, by name.
    texts: Vec<(String, String)>,
    report: String,
    view: String,
    darkest: Option<f64>,
}

impl ShownPicture {
    fn from_outcome(outcome: RenderOutcome, name: Option<String>) -> Self {
        let run = RunFacts { verb: "render", input: name, ..RunFacts::default() };
        Self {
            texts: outcome.told().map(|(name, text)| (name.to_owned(), text)).into(),
            report: Report::new(outcome.certificate, run).to_value().to_string(),
            view: View::Camera(outcome.camera).to_string(),
            picture: outcome.picture,
            darkest: outcome.darkest,
        }
    }
}

/// Columns, rows, pixels, and the texts and numbers of a picture, from which [`Picture::of_state`] restores
/// it.
type PictureState<T> = ((u32, u32), T, Vec<(String, String)>, String, String, Option<f64>);

/// A picture with its certificate.
#[pyclass(frozen, module = "chordal._chordal")]
pub(crate) struct Picture {
    shown: Arc<ShownPicture>,
}

/// A picture of a shape, or of its distance from another one.
#[pyfunction]
pub(crate) fn picture(
    py: Python<'_>,
    source: &Source,
    against: Option<&Source>,
    options: GivenOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<Picture> {
    let request: PictureOptions = request(py, &options)?;
    let options = request.render_options().map_err(|why| mismatch(py, why))?;
    let (input, other) = (Arc::clone(source.input()), against.map(|other| Arc::clone(other.input())));
    let is_comb = request.content == PictureContent::Comb;
    let outcome = work::run(py, ProgressListener::new(progress, "render"), move |job| match other {
        Some(other) => render_against((*input).clone(), (*other).clone(), request.darkest, &options, job),
        None if is_comb => render_comb(&input, &options, job),
        None => render(&input, &options, request.tolerance, job),
    })?;
    let outcome = outcome.map_err(|error| source.raised().unwrap_or_else(|| failure::mesh(py, error)))?;
    let name = source.named_input().name;
    Ok(Picture { shown: Arc::new(ShownPicture::from_outcome(outcome.spelled(&Keywords), name)) })
}

#[pymethods]
impl Picture {
    /// Red, green, blue and alpha: rows from the top, pixels from the left.
    fn array(&self) -> Array {
        Array::new(&self.shown, |shown| {
            let picture = &shown.picture;
            ArrayData::from_bytes(&picture.rgba, vec![picture.height as usize, picture.width as usize, 4])
        })
    }

    /// The report of `chordal render`, as JSON.
    #[getter]
    fn report(&self) -> &str {
        &self.shown.report
    }

    /// The view as text.
    #[getter]
    fn view(&self) -> &str {
        &self.shown.view
    }

    /// The distance of the darkest colour, in a picture of distances.
    #[getter]
    fn darkest(&self) -> Option<f64> {
        self.shown.darkest
    }

    /// The state of the picture.
    fn state<'py>(&self, py: Python<'py>) -> PictureState<Bound<'py, PyBytes>> {
        let ShownPicture { picture, texts, report, view, darkest } = &*self.shown;
        let pixels = PyBytes::new(py, &picture.rgba);
        ((picture.width, picture.height), pixels, texts.clone(), report.clone(), view.clone(), *darkest)
    }

    /// The picture of a state.
    #[staticmethod]
    fn of_state(state: PictureState<PyBackedBytes>) -> PyResult<Self> {
        let ((width, height), pixels, texts, report, view, darkest) = state;
        let rgba = pixels.to_vec();
        if rgba.len() as u64 != 4 * u64::from(width) * u64::from(height) {
            return Err(failure::argument(
                "state",
                format!("{} bytes are not {width} × {height} pixels", rgba.len()),
            ));
        }
        let picture = render::Picture { width, height, rgba };
        Ok(Self { shown: Arc::new(ShownPicture { picture, texts, report, view, darkest }) })
    }

    /// The bytes of a picture file: "png", "jpg" or "webp".
    fn write<'py>(&self, py: Python<'py>, format: &str) -> PyResult<Bound<'py, PyBytes>> {
        let format = PictureFormat::from_extension(format)
            .ok_or_else(|| failure::argument("format", format!("'png', 'jpg' or 'webp', not '{format}'")))?;
        let shown = Arc::clone(&self.shown);
        let written = work::run(py, None, move |_| {
            let mut bytes = Vec::new();
            let texts: Vec<_> =
                shown.texts.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
            format.write(&shown.picture, &texts, &mut bytes).map(|()| bytes)
        })?;
        Ok(PyBytes::new(py, &written.map_err(|error| failure::write(py, &error))?))
    }
}
