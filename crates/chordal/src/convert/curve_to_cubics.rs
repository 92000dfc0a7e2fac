//! The arrow from curves to lines and cubic Bézier curves, for formats that have no other curves.
use super::curves::flatten::refuse_extremes;
use super::curves::piece::rounding;
use super::fitting::{arc_cubics, rational_cubics};
use crate::budget::{Bound, Bounded, Failure, Job, Reference, RefusalCode, Tolerance};
use crate::explicit::{Curve, CurveSegment};
use crate::math::{add_up, greater, sub_down};
use rational_cubics::SpanFailure;

/// Bytes a piece, for the job's limit: twice those of a cubic in space.
const BYTES_PER_PIECE: u64 = 256;

/// Turns a path into few lines and cubic Bézier curves within a distance.
///
/// **Bound.** Two-sided Hausdorff distance between the path, taken exactly as given, and the new one, *proved*, rounding
/// and [`Curve::slack`] included. `at_least` is 0.
///
/// **Path.** Lines and cubics stay as they are, bit for bit; a path without arcs and rational pieces comes back unchanged.
/// The ends of the old pieces stay, bit for bit, and so do corners. A cubic has the directions of the path at its ends, so
/// that smooth joins (G1) stay smooth, up to rounding; but at a cusp of a rational piece two cubics may meet in a kink.
///
/// **Cost.** The error falls with the sixth power of the number of pieces. A cubic of a rational piece takes a few
/// fits and bounds, a cubic of an arc a sine and a cosine.
///
/// # Errors
/// [`Failure::Refused`]: a number that is not finite, a coordinate beyond 1e150, a weight beyond 1e30 or its inverse, a
/// length below rounding, more pieces than the job allows, an environment that flushes subnormals.
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::explicit::nurbs::NurbsCurve;
/// use chordal::{Job, Tolerance, convert};
/// let circle = NurbsCurve::circle([0.0, 0.0], [[1.0, 0.0], [0.0, 1.0]])?.to_curve()?;
/// let cubics = |length| {
///     convert::curve_to_cubics(&circle, Tolerance::new(length).unwrap(), &Job::default()).unwrap()
/// };
/// assert_eq!(cubics(2.6e-4).shape.segments().len(), 4);
/// assert!(cubics(1e-9).bound.at_most().unwrap() <= 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sources: M. Goldapp, *Approximation of circular arcs by cubic polynomials*, 1991; C. de Boor, K. Höllig, M. Sabin,
/// *High accuracy geometric Hermite interpolation*, 1987. The bound is Chordal's own (`convert/fitting/rational_error.rs`).
pub fn curve_to_cubics<const D: usize>(
    curve: &Curve<D>,
    length: Tolerance,
    job: &Job,
) -> Result<Bounded<Curve<D>>, Failure<Curve<D>>> {
    refuse_extremes(curve, 0)?;
    let mut pieces = Vec::new();
    let mut at_most = curve.slack();
    for (index, piece) in curve.segments().iter().enumerate() {
        if job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        let limit = job.triangle_limit.min(job.memory_limit / BYTES_PER_PIECE);
        let remaining = limit.saturating_sub(pieces.len() as u64);
        let too_many = || {
            let message =
                format!("piece {index} of the path would be the first beyond the limit of {limit} cubics");
            Failure::refused(RefusalCode::TooManyTriangles, message)
        };
        let below = |least: f64| {
            let message = format!(
                "the tolerance {:e} is less than the possible rounding error {least:.3e} of piece {index} of the path",
                length.get()
            );
            Failure::refused(RefusalCode::BelowPrecision, message)
        };
        let spent = match piece {
            CurveSegment::Arc(arc) => add_up(curve.slack(), add_up(arc.slack(), rounding(piece))),
            _ => curve.slack(),
        };
        // One step less, because adding `spent` below rounds up again.
        let allowed = sub_down(length.get().next_down(), spent);
        match piece {
            CurveSegment::Line(_) | CurveSegment::Cubic(_) => pieces.push(piece.clone()),
            CurveSegment::Rational(rational) if rational.degree() == 1 => {
                // Of degree 1 it is a segment, whatever its weights: they only move the parameter.
                pieces.push(CurveSegment::Line(rational.ends()));
                let lost = add_up(curve.slack(), rounding(piece));
                at_most = greater(lost, at_most);
            }
            CurveSegment::Arc(arc) => {
                if allowed <= 0.0 {
                    return Err(below(spent));
                }
                let (n, distance) = arc_cubics::count(arc, allowed);
                if n > remaining as f64 {
                    return Err(too_many());
                }
                pieces.extend(arc_cubics::cubics(arc, n as usize).into_iter().map(CurveSegment::Cubic));
                at_most = greater(add_up(distance, spent), at_most);
            }
            CurveSegment::Rational(rational) => {
                let fitted = if allowed > 0.0 {
                    rational_cubics::cubics(rational, allowed, remaining, || job.is_cancelled())
                } else {
                    Err(SpanFailure::BelowPrecision)
                };
                let fitted = fitted.map_err(|error| match error {
                    SpanFailure::TooMany => too_many(),
                    SpanFailure::BelowPrecision => below(add_up(spent, rounding(piece))),
                    SpanFailure::Cancelled => Failure::Cancelled,
                })?;
                pieces.extend(fitted.cubics.into_iter().map(CurveSegment::Cubic));
                at_most = greater(add_up(fitted.at_most, spent), at_most);
            }
        }
    }
    let path = if pieces.is_empty() {
        Curve::point(curve.start())
    } else {
        Curve::new(pieces, curve.is_closed().into())
    };
    match path {
        Ok(shape) if at_most <= length.get() => {
            Ok(Bounded { shape, bound: Bound::proved(0.0, at_most, Reference::Curves) })
        }
        Ok(_) => {
            let message = format!(
                "the tolerance {:e} is less than the rounding already in the path, {at_most:.3e}",
                length.get()
            );
            Err(Failure::refused(RefusalCode::BelowPrecision, message))
        }
        Err(error) => Err(Failure::refused(RefusalCode::NotFinite, error.to_string())),
    }
}
