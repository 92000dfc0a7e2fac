//! Curves into polylines within a budget, for formats that hold polylines.
use super::field::endless;
use super::field::slack::{NOT_COUNTED, SlackRequest};
use super::request::MeshRequest;
use crate::ImplicitShape;
use crate::MeshFailure;
use crate::formats::extensions_where;
use crate::outcome::MeshOutcome;
use crate::output::finish::finish_polylines;
use crate::report::Certificate;
use chordal::budget::{Bounded, Failure, RefusalCode};
use chordal::convert;
use chordal::explicit::{Curve, Polyline};
use chordal::math::Box3;
use chordal::{Bound, Job};
use chordal_io::{Curves, Drawing, DrawingElement, Format, PathSet, Polylines};

/// Flattens plane curves.
pub(crate) fn flatten_drawing(
    drawing: Drawing,
    request: &MeshRequest,
    certificate: Certificate,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let (drawn, bound) = cut(drawing, request, job)?;
    finish_polylines(Polylines::Plane(drawn), bound, request, certificate)
}

/// Flattens space curves, which SVG cannot hold.
pub(crate) fn flatten_curves(
    curves: Curves,
    request: &MeshRequest,
    certificate: Certificate,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let to = request.to;
    if !to.holds_space_curves() {
        let names = extensions_where(Format::holds_space_curves, "or");
        let message = format!("these curves are in space, which {to} cannot hold: write {names}");
        return Err(MeshFailure::Usage(message.into()));
    }
    let (drawn, bound) = cut(curves, request, job)?;
    finish_polylines(Polylines::Space(drawn), bound, request, certificate)
}

/// Flattens the zero contour of a plane field.
pub(crate) fn contour_field(
    implicit: &ImplicitShape,
    request: &MeshRequest,
    mut certificate: Certificate,
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let field = implicit.clip_to_region();
    let Box3 { min, max } = field.bounds();
    // The field does not depend on z, along which it has no end.
    if !(0..2).all(|k| min[k].is_finite() && max[k].is_finite()) {
        return Err(MeshFailure::refused(RefusalCode::Unsupported, endless()));
    }
    let slack = SlackRequest::new(&field, request)?;
    let converted =
        convert::field_to_polyline(&field, &slack.inner.budget, job).or_else(Failure::best_effort)?;
    let (bound, note) = slack.count(converted.bound);
    certificate.warned.extend(note.clone().filter(|note| note.starts_with(NOT_COUNTED)));
    certificate.notes.extend(note);
    if let Some(region) = implicit.region {
        let [low, high] = [region.min, region.max].map(|corner| [corner[0], corner[1]]);
        certificate.notes.push(
            format!("the shape is cut off at the rectangle from {low:?} to {high:?}, and closed there")
                .into(),
        );
    }
    // Negating y, which is exact, keeps the drawing upright.
    let y_down = request.to.is_y_down();
    let mut lines = converted.shape;
    if y_down {
        lines.iter_mut().flat_map(|line| &mut line.points).for_each(|point| point[1] = -point[1]);
        certificate.notes.push(format!("y is negated, for it grows downwards in {}", request.to).into());
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
    finish_polylines(
        Polylines::Plane(drawn),
        bound,
        &MeshRequest::new(request.budget, request.to, place),
        certificate,
    )
}

fn cut<const D: usize>(
    drawn: PathSet<Curve<D>>,
    request: &MeshRequest,
    job: &Job,
) -> Result<(PathSet<Polyline<D>>, Bound), MeshFailure> {
    let flattened = convert::curves_to_polylines(&drawn.lines, &request.budget, job, request.spacing)
        .or_else(Failure::best_effort)?;
    let Bounded { shape, bound } = flattened;
    Ok((drawn.with_lines(shape), bound))
}
