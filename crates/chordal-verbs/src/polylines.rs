//! Curves into polylines within a budget, for formats that hold polylines.
use crate::failure::best_of;
use crate::implicit::{ENDLESS, ImplicitShape};
use crate::mesh::{MeshOutcome, NOT_MET, Tessellation, lengths_are_met, on_screen, refusal};
use crate::report::{BoundFacts, BudgetFacts, Certificate, Output, PolylineFacts};
use crate::{BudgetSpec, MeshFailure};
use chordal::budget::{Bounded, Budget, RefusalCode};
use chordal::convert;
use chordal::explicit::{Curve, Polyline};
use chordal::math::Box3;
use chordal::{Bound, Job};
use chordal_io::{Curves, Drawing, DrawingElement, Format, PathSet, Polylines};

/// What polylines are made for.
pub(crate) struct MeshRequest<'a> {
    pub spec: &'a BudgetSpec,
    pub budget: Budget,
    pub to: Format,
    /// A box around the curves.
    pub place: Box3,
}

/// Curves of the plane.
pub(crate) fn flatten_drawing(
    drawing: Drawing,
    asked: &MeshRequest,
    certificate: Certificate,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let (drawn, bound) = cut(drawing, asked, job)?;
    finish(Polylines::Plane(drawn), bound, asked, certificate)
}

/// Curves of space, which SVG cannot hold.
pub(crate) fn flatten_curves(
    curves: Curves,
    asked: &MeshRequest,
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

/// The curve of a field of the plane.
pub(crate) fn contour_field(
    implicit: &ImplicitShape,
    asked: &MeshRequest,
    mut certificate: Certificate,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let field = implicit.clip_to_region();
    let Box3 { min, max } = field.bounds();
    if !(0..2).all(|k| min[k].is_finite() && max[k].is_finite()) {
        return Err(refusal(RefusalCode::Unsupported, ENDLESS));
    }
    let made = best_of(convert::field_to_polyline(&field, &asked.budget, job))?;
    if let Some(region) = implicit.region {
        let [low, high] = [region.min, region.max].map(|corner| [corner[0], corner[1]]);
        certificate.notes.push(format!(
            "the shape is cut off at the rectangle from {low:?} to {high:?}, and closed there"
        ));
    }
    // SVG's y grows downwards: the drawing stands upright where y is negated, which is exact.
    let y_down = asked.to == Format::Svg;
    let mut lines = made.shape;
    if y_down {
        lines.iter_mut().flat_map(|line| &mut line.points).for_each(|point| point[1] = -point[1]);
        certificate.notes.push("y is negated, for it grows downwards in svg".to_owned());
    }
    let element = DrawingElement { kind: "field", filled: true, ..DrawingElement::default() };
    let drawn = PathSet {
        owners: vec![0; lines.len()],
        lines,
        elements: vec![element],
        view_box: None,
        y_down,
        frame: implicit.frame,
        certificate: None,
    };
    let place = Box3 { min: [min[0], min[1], 0.0], max: [max[0], max[1], 0.0] };
    let MeshRequest { spec, budget, to, .. } = *asked;
    finish(Polylines::Plane(drawn), made.bound, &MeshRequest { spec, budget, to, place }, certificate)
}

fn cut<const D: usize>(
    drawn: PathSet<Curve<D>>,
    asked: &MeshRequest,
    job: &Job,
) -> Result<(PathSet<Polyline<D>>, Bound), MeshFailure> {
    let made = best_of(convert::curves_to_polylines(&drawn.lines, &asked.budget, job, asked.spec.spacing))?;
    let Bounded { shape, bound } = made;
    Ok((drawn.with_lines(shape), bound))
}

fn finish(
    polylines: Polylines,
    mut bound: Bound,
    asked: &MeshRequest,
    mut certificate: Certificate,
) -> Result<MeshOutcome, MeshFailure> {
    bound.pixels = on_screen(&asked.budget, &bound, &asked.place);
    certificate.budget = Some(BudgetFacts::new(&asked.budget));
    certificate.bound = Some(BoundFacts::new(&bound));
    let facts = PolylineFacts::from_polylines(&polylines);
    certificate.output = Some(Output::Polylines(facts));
    let met = lengths_are_met(&asked.budget, &bound, &asked.place)
        && asked.budget.segments.is_none_or(|most| facts.segments <= most);
    if !met {
        certificate.notes.push(NOT_MET.to_owned());
    }
    let outcome =
        MeshOutcome { made: Tessellation::Polylines(polylines), format: asked.to, bound, certificate };
    if met { Ok(outcome) } else { Err(MeshFailure::Unmet(Box::new(outcome))) }
}
