//! Curves into polylines within a budget, for formats that hold polylines.
use crate::mesh::{Made, MeshOutcome, NOT_MET, on_screen, within};
use crate::report::{BoundFacts, BudgetFacts, Certificate, LineFacts, Output};
use crate::{BudgetSpec, MeshFailure};
use chordal::budget::{Bounded, Budget, Failure};
use chordal::convert;
use chordal::explicit::{Curve, Polyline};
use chordal::math::Box3;
use chordal::{Bound, Job};
use chordal_io::{Curves, Drawing, Drawn, Format, Polylines};

/// What polylines are made for.
pub(crate) struct Asked<'a> {
    pub spec: &'a BudgetSpec,
    pub budget: Budget,
    pub to: Format,
    /// A box around the curves.
    pub place: Box3,
}

/// Curves of the plane.
pub(crate) fn of_drawing(
    drawing: Drawing,
    asked: &Asked,
    certificate: Certificate,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let (drawn, bound) = cut(drawing, asked, job)?;
    finish(Polylines::Plane(drawn), bound, asked, certificate)
}

/// Curves of space, which SVG cannot hold.
pub(crate) fn of_curves(
    curves: Curves,
    asked: &Asked,
    certificate: Certificate,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    if asked.to == Format::Svg {
        return Err(MeshFailure::Usage(
            "these curves are in space, which svg cannot hold: write .json".to_owned(),
        ));
    }
    let (drawn, bound) = cut(curves, asked, job)?;
    finish(Polylines::Space(drawn), bound, asked, certificate)
}

fn cut<const D: usize>(
    drawn: Drawn<Curve<D>>,
    asked: &Asked,
    job: &Job,
) -> Result<(Drawn<Polyline<D>>, Bound), MeshFailure> {
    let made = match convert::curves_to_polylines(&drawn.lines, &asked.budget, job, asked.spec.spacing) {
        Ok(made) => made,
        Err(Failure::Unmet(best)) => *best,
        Err(Failure::Refused(refusal)) => return Err(MeshFailure::Refused(refusal)),
        Err(Failure::Cancelled) => return Err(MeshFailure::Cancelled),
    };
    let Bounded { shape, bound } = made;
    Ok((drawn.with_lines(shape), bound))
}

fn finish(
    polylines: Polylines,
    mut bound: Bound,
    asked: &Asked,
    mut certificate: Certificate,
) -> Result<MeshOutcome, MeshFailure> {
    bound.pixels = on_screen(&asked.budget, &bound, &asked.place);
    certificate.budget = Some(BudgetFacts::of(&asked.budget));
    certificate.bound = Some(BoundFacts::of(&bound));
    let facts = LineFacts::of(&polylines);
    certificate.output = Some(Output::Polylines(facts));
    let met = within(bound.at_most(), asked.budget.length.map(|length| length.get()))
        && within(bound.pixels, asked.budget.pixels.map(|px| px.pixels.get()))
        && asked.budget.segments.is_none_or(|most| facts.segments <= most);
    if !met {
        certificate.notes.push(NOT_MET.to_owned());
    }
    let outcome = MeshOutcome { made: Made::Polylines(polylines), format: asked.to, bound, certificate };
    if met { Ok(outcome) } else { Err(MeshFailure::Unmet(Box::new(outcome))) }
}
