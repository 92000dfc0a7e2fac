//! Drawings as lines and cubics, which SVG holds to the last digit.
use crate::MeshFailure;
use chordal::budget::{Bounded, Failure, RefusalCode};
use chordal::convert::curve_to_cubics;
use chordal::explicit::{Curve, CurveSegment};
use chordal::math::greater;
use chordal::{Bound, Job, Tolerance};
use chordal_io::Drawing;

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
