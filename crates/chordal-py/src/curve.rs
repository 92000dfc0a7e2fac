//! Curves from control points of Python.
use chordal::Bezier;
use chordal::explicit::{Curve, CurveEnds, CurveSegment};
use chordal_io::{DrawingElement, Format, Frame, PathSet};
use chordal_verbs::{Input, Shape, sha256};

/// Curves of `n_points` control points each (3n + 1 for n pieces) with `width` coordinates (2 or 3), all in a
/// row, in double precision and native byte order.
///
/// The result equals that of a JSON file with the same numbers, but the digest is that of the numbers.
///
/// # Errors
/// A sentence, if the numbers are no such curves.
pub(crate) fn curves(numbers: &[u8], n_points: usize, width: usize, frame: Frame) -> Result<Input, String> {
    let shape = match width {
        2 => Shape::Drawing(chains(numbers, n_points, frame)?),
        3 => Shape::Curves(chains(numbers, n_points, frame)?),
        n => return Err(format!("points have 2 or 3 coordinates, not {n}")),
    };
    let n_bytes = numbers.len() as u64;
    Ok(Input { n_bytes, digest: sha256(numbers).into(), ..Input::made(shape, Format::Json) })
}

/// One chain of cubics for each `n_points` points.
fn chains<const D: usize>(
    numbers: &[u8],
    n_points: usize,
    frame: Frame,
) -> Result<PathSet<Curve<D>>, String> {
    const WIDTH: usize = size_of::<f64>();
    let (numbers, rest_of_number) = numbers.as_chunks::<WIDTH>();
    let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect();
    let (points, rest_of_point) = numbers.as_chunks::<D>();
    let fits = n_points > 3 && n_points % 3 == 1 && points.len().is_multiple_of(n_points);
    if !(fits && rest_of_number.is_empty() && rest_of_point.is_empty()) {
        return Err(format!(
            "{n_points} control points a curve are not 3n + 1, or there are too few numbers"
        ));
    }
    let chain = |chain| Curve::new(cubics(chain), CurveEnds::Open).map_err(|error| error.to_string());
    let lines: Vec<_> = points.chunks(n_points).map(chain).collect::<Result<_, _>>()?;
    let n = u32::try_from(lines.len()).map_err(|_| format!("{} curves are too many", lines.len()))?;
    let element =
        |source| DrawingElement { kind: "curve", source, filled: true, ..DrawingElement::default() };
    let elements = (0..u64::from(n)).map(element).collect();
    Ok(PathSet { lines, owners: (0..n).collect(), elements, frame, ..PathSet::default() })
}

/// The cubics of a chain; neighbours share a point.
fn cubics<const D: usize>(chain: &[[f64; D]]) -> Vec<CurveSegment<D>> {
    let control = |at: usize| [chain[at], chain[at + 1], chain[at + 2], chain[at + 3]];
    (0..chain.len() - 1).step_by(3).map(|at| CurveSegment::Cubic(Bezier { control: control(at) })).collect()
}
