//! Drawings and space curves in the forms that files hold: as lines and cubics in SVG, and as polylines, with notes on
//! what those do not hold.
use crate::MeshFailure;
use chordal::budget::advice::Message;
use chordal::budget::{Bounded, Failure, RefusalCode};
use chordal::convert::curve_to_cubics;
use chordal::explicit::{Curve, CurveSegment, FillRule, Polyline};
use chordal::math::greater;
use chordal::{Bound, Job, Tolerance};
use chordal_io::{Axis, Drawing, Format, PathSet};
use std::collections::BTreeSet;

/// The drawing as lines and cubics, its bound, and the numbers of both. Arcs and rational pieces become cubics within a
/// length.
///
/// # Errors
/// If there are arcs or rational pieces and no length; as for [`curve_to_cubics`].
pub(crate) fn cubic_paths(
    drawing: Drawing,
    length: Option<Tolerance>,
    job: &Job,
) -> Result<(Drawing, Bound, [usize; 2]), MeshFailure> {
    let mut lines: Vec<Curve<2>> = Vec::with_capacity(drawing.lines.len());
    let mut at_most = 0.0;
    for curve in &drawing.lines {
        if curve.segments().iter().all(is_plain) {
            lines.push(curve.clone());
            at_most = greater(curve.slack(), at_most);
            continue;
        }
        let Some(length) = length else {
            let message = "svg holds lines and cubics: arcs and rational curves become cubics within a length, and there is none";
            return Err(MeshFailure::Usage(message.into()));
        };
        let Bounded { shape, bound } =
            curve_to_cubics(curve, length, job).map_err(|failure| match failure {
                Failure::Refused(refusal) => MeshFailure::Refused(refusal),
                Failure::Cancelled => MeshFailure::Cancelled,
                Failure::Unmet(_) => {
                    MeshFailure::refused(RefusalCode::BelowPrecision, "the length is not reached")
                }
            })?;
        at_most = greater(bound.at_most().unwrap_or(f64::INFINITY), at_most);
        lines.push(shape);
    }
    let pieces = lines.iter().flat_map(Curve::segments);
    let (straight, cubic): (Vec<_>, Vec<_>) =
        pieces.partition(|piece| matches!(piece, CurveSegment::Line(_)));
    let counts = [straight.len(), cubic.len()];
    let reference = chordal::budget::Reference::Curves;
    let bound = if at_most == 0.0 { Bound::exact(reference) } else { Bound::proved(0.0, at_most, reference) };
    Ok((drawing.with_lines(lines), bound, counts))
}

fn is_plain(piece: &CurveSegment<2>) -> bool {
    matches!(piece, CurveSegment::Line(_) | CurveSegment::Cubic(_))
}

/// Straight curves as polylines, with the largest distance of the exact curves from them; `None` if a piece is bent.
pub(crate) fn straight_lines<const D: usize>(curves: &[Curve<D>]) -> Option<(Vec<Polyline<D>>, f64)> {
    let slack = curves.iter().fold(0.0, |most, curve| greater(curve.slack(), most));
    let lines: Option<Vec<_>> = curves.iter().map(straight_line).collect();
    Some((lines?, slack))
}

fn straight_line<const D: usize>(curve: &Curve<D>) -> Option<Polyline<D>> {
    let mut points = vec![curve.start()];
    for piece in curve.segments() {
        let CurveSegment::Line([_, end]) = piece else { return None };
        points.push(*end);
    }
    if curve.is_closed() && points.len() > 1 {
        // The end of the last piece is the start.
        points.pop();
    }
    Some(Polyline { points, places: Vec::new(), closed: curve.is_closed() })
}

/// Notes on the data of elements that a file of polylines does not hold.
pub(crate) fn line_losses<T>(drawn: &PathSet<T>, to: Format) -> Vec<Message> {
    let mut lost = Vec::new();
    let mut count = |n: usize, what: &str| {
        if n > 0 {
            lost.push(Message::from(format!("{to} {what} ({n}x)")));
        }
    };
    let elements = &drawn.elements;
    if !to.holds_elements() {
        count(elements.iter().filter(|e| !e.name.is_empty()).count(), "is written without names of elements");
        let even_odd = |e: &&chordal_io::DrawingElement| e.rule == FillRule::EvenOdd;
        count(elements.iter().filter(even_odd).count(), "is written without the rule evenodd");
        count(elements.iter().filter(|e| !e.filled).count(), "does not say that an element is not filled");
        count(usize::from(drawn.view_box.is_some()), "holds no box of view");
        count(usize::from(drawn.y_down), "does not say that y grows downwards");
        count(usize::from(drawn.frame.metres_per_unit.is_some()), "is written without the unit");
    }
    if to.holds_elements() {
        let named: Vec<&str> = elements.iter().map(|e| &*e.name).filter(|name| !name.is_empty()).collect();
        let distinct: BTreeSet<&&str> = named.iter().collect();
        count(named.len() - distinct.len(), "allows a name once: that of further elements was left out");
        count(usize::from(!drawn.y_down), "shows y growing downwards: the numbers are as they were");
    }
    let up = drawn.frame.up.map(Axis::letter);
    lost.extend(up.map(|up| format!("{to} does not say which axis is up: it is {up}").into()));
    lost
}
