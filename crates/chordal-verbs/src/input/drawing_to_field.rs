//! The filled regions of a drawing as a field, for scripts and Python.
use super::drawing_regions::FilledRegions;
use chordal::budget::Failure;
use chordal::convert::outline_to_field;
use chordal::implicit::Field;
use chordal::math::greater;
use chordal::{Budget, Job, Tolerance};
use chordal_io::Drawing;

/// The filled regions of a drawing, with y up, as one shape of the plane: the distance to polygons within a length of its
/// curves, which is its slack ([`Field::slack`]). Returns sentences with it that state the error of the polygons.
///
/// # Errors
/// A sentence: if nothing is filled, or the curves are not replaced within the length.
pub fn drawing_to_field(
    drawing: &Drawing,
    tolerance: Tolerance,
    job: &Job,
) -> Result<(Field, Vec<String>), String> {
    let mut notes = Vec::new();
    let filled = FilledRegions::from_drawing(drawing, &mut notes)
        .map_err(|_| "it fills nothing: lines alone have no inside".to_owned())?;
    let budget = Budget::length(tolerance);
    let (mut shapes, mut worst) = (Vec::new(), 0.0);
    for outline in &filled.outlines {
        let field = outline_to_field(outline, &budget, job).map_err(|failure| match failure {
            Failure::Refused(refusal) => refusal.message.to_string(),
            _ => format!("its curves are not replaced by polygons within {}", tolerance.get()),
        })?;
        let error = field.bound.at_most().ok_or("its polygons have no bound")?;
        worst = greater(worst, error);
        shapes.push(field.shape.with_slack(error));
    }
    let mut sentences = Vec::new();
    if worst > 0.0 {
        sentences.push(format!("its curves are polygons within {worst:.3e} (proved)"));
    }
    Ok((Field::union_of(&shapes), sentences))
}
