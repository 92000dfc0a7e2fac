//! Trimming loops of a surface, in JSON.
use super::spline_numbers::{numbers, whole_degree};
use super::{check_rows, width};
use crate::grow::push;
use crate::json::JsonReader;
use crate::warnings::Warnings;
use crate::{Limits, ReadError};
use chordal::explicit::nurbs::{KnotVector, NurbsCurve};
use chordal::explicit::{Curve, CurveEnds, CurveSegment};
use chordal::math::greater;

/// The default degree of a curve: a polygon. Chosen: most hand-written loops are polygons.
const STRAIGHT: f64 = 1.0;
/// The largest gap between two curves of a loop, relative to the loop's size, that is closed by a straight
/// line. Chosen: a larger one is a mistake; at the pole of a sphere, where parameters mean little, CAD
/// programs leave 6 %.
const GAP: f64 = 0.25;

/// Reads a list of loops, each a list of curves.
pub(super) fn trim_loops(
    json: &mut JsonReader,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Vec<Curve<2>>, ReadError> {
    let mut loops = Vec::new();
    json.array(|json, index| {
        check_rows(json, "loops", index, limits)?;
        let place = json.place();
        let mut curves = Vec::new();
        json.array(|json, k| {
            check_rows(json, "curves", k, limits)?;
            let curve = trim_curve(json, limits, warnings)?;
            push(&mut curves, curve)
        })?;
        let wrong = |message: String| ReadError::new("invalid-trim", place, message);
        let path = joined(&curves).map_err(wrong)?;
        push(&mut loops, path)
    })?;
    Ok(loops)
}

/// One curve in the parameter plane.
fn trim_curve(
    json: &mut JsonReader,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Curve<2>, ReadError> {
    let (mut degree, mut knots, mut weights) = (STRAIGHT, None, None);
    let mut control: Vec<[f64; 2]> = Vec::new();
    let place = json.place();
    json.object(|json, key| {
        match key {
            "degree" => degree = json.number()?,
            "knots" => knots = Some(numbers(json, limits)?),
            "weights" => weights = Some(numbers(json, limits)?),
            "control" => {
                json.array(|json, i| {
                    check_rows(json, "points", i, limits)?;
                    let coordinates = numbers(json, limits)?;
                    let n = coordinates.len() as u64;
                    let point =
                        <[f64; 2]>::try_from(coordinates).map_err(|_| width(json, n, "numbers", 2))?;
                    push(&mut control, point)
                })?;
            }
            _ => {
                super::unknown(json, key, warnings);
                json.skip()?;
            }
        }
        Ok(())
    })?;
    let wrong = |message: String| ReadError::new("invalid-trim", place.clone(), message);
    let degree = whole_degree(degree).map_err(wrong)?;
    let knots = match knots {
        Some(knots) => KnotVector::new(degree, knots),
        None => KnotVector::clamped(degree, control.len()),
    };
    let weights = weights.unwrap_or_else(|| vec![1.0; control.len()]);
    let spline = knots.and_then(|knots| NurbsCurve::new(knots, control, weights));
    let path = spline.map_err(|error| wrong(error.to_string()))?.to_curve();
    path.map_err(|error| wrong(error.to_string()))
}

/// The curves joined to one closed path; gaps from rounding are closed by straight lines.
fn joined(curves: &[Curve<2>]) -> Result<Curve<2>, String> {
    let (Some(first), Some(_)) = (curves.first(), curves.last()) else {
        return Err("a trim loop needs a curve".to_owned());
    };
    let mut size = 0.0;
    for k in 0..2 {
        let bounds = curves.iter().map(Curve::bounds);
        let (low, high) = bounds.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [from, to]| {
            (chordal::math::lesser(from[k], low), greater(to[k], high))
        });
        size = greater(high - low, size);
    }
    let mut segments: Vec<CurveSegment<2>> = Vec::new();
    let (mut slack, mut at) = (0.0, first.start());
    let close = |segments: &mut Vec<CurveSegment<2>>, at: [f64; 2], to: [f64; 2], index: usize| {
        let gap = greater((to[0] - at[0]).abs(), (to[1] - at[1]).abs());
        if gap > GAP * size {
            return Err(format!(
                "curve {index} of a trim loop does not start where the one before it ends: there are {gap:e} between"
            ));
        }
        if gap > 0.0 {
            segments.push(CurveSegment::Line([at, to]));
        }
        Ok(())
    };
    for (index, curve) in curves.iter().enumerate() {
        close(&mut segments, at, curve.start(), index)?;
        segments.extend(curve.segments().iter().cloned());
        slack = greater(curve.slack(), slack);
        at = curve.end();
    }
    close(&mut segments, at, first.start(), 0)?;
    let path = Curve::new(segments, CurveEnds::Closed).map_err(|error| error.to_string())?;
    Ok(path.with_slack(slack))
}
