//! The last step of the verbs: checks a result as its format holds it, and completes the report.
use crate::file_rows::to_file_rows;
use crate::report::{BoundFacts, BudgetFacts, Certificate, CountedTriangles, Output, PolylineFacts};
use crate::request::MeshRequest;
use crate::{MeshFailure, MeshOutcome, Tessellation, flatten};
use chordal::Job;
use chordal::budget::advice::Message;
use chordal::budget::{Bound, Budget, JobError, PixelBudget, View};
use chordal::check;
use chordal::check::shading::MicroTriangles;
use chordal_io::{Polylines, Scene, losses};

const NOT_MET: &str = "the budget was not met: this is the best that was reached";

/// Checks triangles as the format holds them, as the last step of a verb.
///
/// # Errors
/// When the budget is not met, with the outcome all the same; when the format cannot hold them.
pub(crate) fn finish_triangles(
    scene: Scene,
    mut bound: Bound,
    asked: &MeshRequest,
    mut certificate: Certificate,
) -> Result<MeshOutcome, MeshFailure> {
    let to = asked.to;
    certificate.notes.extend(losses(&scene, to)?.iter().map(|lost| lost.to_string().into()));
    let scene = to_file_rows(scene, to)?;
    bound.pixels = asked.pixels_of(&bound);
    certificate.bound = Some(BoundFacts::new(&bound));
    let counted = CountedTriangles::from_scene(&scene, to)?;
    let triangles = counted.output.triangles;
    certificate.output = Some(Output::Triangles(counted.output));
    certificate.valid = Some(counted.valid);
    let budget = &asked.budget;
    let met = asked.lengths_are_met(&bound)
        && bound.angle_deg.zip(budget.angle_deg).is_none_or(|(found, asked)| found <= asked)
        && budget.triangles.is_none_or(|most| triangles <= most);
    if !met {
        certificate.notes.push(NOT_MET.into());
    }
    let outcome = MeshOutcome { made: Tessellation::Triangles(scene), format: to, bound, certificate };
    if met { Ok(outcome) } else { Err(MeshFailure::Unmet(Box::new(outcome))) }
}

/// Checks polylines, as the last step of a verb.
pub(crate) fn finish_polylines(
    polylines: Polylines,
    mut bound: Bound,
    asked: &MeshRequest,
    mut certificate: Certificate,
) -> Result<MeshOutcome, MeshFailure> {
    bound.pixels = asked.pixels_of(&bound);
    certificate.budget = Some(BudgetFacts::new(&asked.budget));
    certificate.bound = Some(BoundFacts::new(&bound));
    let facts = PolylineFacts::from_polylines(&polylines);
    certificate.output = Some(Output::Polylines(facts));
    let met =
        asked.lengths_are_met(&bound) && asked.budget.segments.is_none_or(|most| facts.segments <= most);
    if !met {
        certificate.notes.push(NOT_MET.into());
    }
    let outcome =
        MeshOutcome { made: Tessellation::Polylines(polylines), format: asked.to, bound, certificate };
    if met { Ok(outcome) } else { Err(MeshFailure::Unmet(Box::new(outcome))) }
}

/// A note where most triangles are smaller than a pixel at the budget's view: more than half, since every
/// mesh has some at its poles and seams.
pub(crate) fn too_fine_note(
    scene: &Scene,
    budget: &Budget,
    job: &Job,
) -> Result<Option<Message>, MeshFailure> {
    let Some(PixelBudget { view, .. }) = budget.pixels else { return Ok(None) };
    // A scene that cannot be merged, or is too large to check, gets no note.
    let Ok(mesh) = flatten::one_mesh(scene) else { return Ok(None) };
    let found = match check::shading::micro_triangles(&mesh, &view, job) {
        Ok(found) => found,
        Err(JobError::Cancelled) => return Err(MeshFailure::Cancelled),
        Err(JobError::Refused(_)) => return Ok(None),
    };
    let MicroTriangles { n_micro, n_triangles } = found;
    let most = n_micro > n_triangles / 2;
    let (of, at) = match view {
        View::Camera(_) => ("triangles in view", "there"),
        View::MinDistance(_) => ("triangles", "even where the eye is nearest and faces them"),
    };
    Ok(most.then(|| {
        format!(
            "{n_micro} of {n_triangles} {of} are smaller than a pixel {at}: more than the screen can show"
        )
        .into()
    }))
}
