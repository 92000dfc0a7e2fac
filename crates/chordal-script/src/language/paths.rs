//! Paths: curves of the plane and of space, which shapes are made of.
use super::bind::{BoundArgs, Function, ParameterDefault, counted_result, defaulting, optional, required};
use super::{Arg, CallError, ScriptPath};
use chordal::budget::{Bounded, Failure};
use chordal::convert::splines::{Corners, SplineFit, points_to_spline};
use chordal::convert::{contours_to_field, curve_to_polyline, outline_to_field};
use chordal::explicit::nurbs::{KnotVector, NurbsCurve};
use chordal::explicit::spline::{self, Knots, SplineEnds};
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment, FillRule, Outline, Polyline};
use chordal::implicit::{Distance, shapes};
use chordal::math::greater;
use chordal::{Bezier, Budget, Tolerance};

const NOTHING: ParameterDefault = ParameterDefault::Nothing;

/// Functions that make paths.
pub(super) const PATHS: &[Function] = &[
    Function {
        name: "spline",
        parameters: &[
            required("points"),
            defaulting("closed", ParameterDefault::False),
            defaulting("knots", ParameterDefault::Text("centripetal")),
            defaulting("tangents", NOTHING),
        ],
        about: "The smooth path through points of two or three numbers: cubics, with equal second derivatives where they \
            meet (C2 by its knots, which are \"centripetal\", \"chordal\" or \"uniform\"). Without tangents it does not \
            bend at its ends; two tangents are its derivatives there.",
        distance: "",
        make: |given| in_any_space(given, spline_of::<2>, spline_of::<3>),
    },
    Function {
        name: "bezier",
        parameters: &[required("control")],
        about: "Cubic Bézier curves, one after the other: four control points, and three for each one more.",
        distance: "",
        make: |given| in_any_space(given, bezier_of::<2>, bezier_of::<3>),
    },
    Function {
        name: "nurbs",
        parameters: &[
            required("control"),
            optional("degree", 3.0),
            defaulting("weights", NOTHING),
            defaulting("knots", NOTHING),
        ],
        about: "The rational B-spline with these control points, which starts and ends at the first and the last of them \
            unless it has knots of its own. Weights are 1 unless said.",
        distance: "",
        make: |given| in_any_space(given, nurbs_of::<2>, nurbs_of::<3>),
    },
    Function {
        name: "arc",
        parameters: &[
            required("radius"),
            optional("start", 0.0),
            optional("degrees", 360.0),
            defaulting("center", NOTHING),
        ],
        about: "An arc of a circle of the plane, counter-clockwise over an angle from a start, both in degrees; a whole \
            circle unless said.",
        distance: "",
        make: arc,
    },
    Function {
        name: "fit",
        parameters: &[
            required("points"),
            required("tolerance"),
            defaulting("closed", ParameterDefault::False),
            optional("corners", 30.0),
        ],
        about: "A path of few cubics that passes every one of many points within a tolerance, with corners where points turn \
            by more than an angle in degrees.",
        distance: "",
        make: |given| in_any_space(given, fit_of::<2>, fit_of::<3>),
    },
];

/// What makes a path of the points of an argument.
type PathMaker<const D: usize> = fn(&BoundArgs) -> Result<Curve<D>, CallError>;

fn in_any_space(given: &BoundArgs, plane: PathMaker<2>, space: PathMaker<3>) -> Result<Arg, CallError> {
    let made = if given.width(0)? == 2 { plane(given)?.into() } else { space(given)?.into() };
    Ok(Arg::path(made))
}

fn spline_of<const D: usize>(given: &BoundArgs) -> Result<Curve<D>, CallError> {
    let (points, is_closed) = (given.points::<D>(0)?, given.truth(1)?);
    let knots = match given.text(2)? {
        "centripetal" => Knots::Centripetal,
        "chordal" => Knots::Chordal,
        "uniform" => Knots::Uniform,
        other => {
            let shown: String = other.chars().take(40).collect();
            return Err(
                given.fault(&format!("needs 'centripetal', 'chordal' or 'uniform' knots, not '{shown}'"))
            );
        }
    };
    let ends = match (given.given(3), is_closed) {
        (None, false) => SplineEnds::Natural,
        (None, true) => SplineEnds::Periodic,
        (Some(_), true) => return Err(given.fault("of a closed path has no ends for tangents")),
        (Some(_), false) => {
            let tangents = given.points::<D>(3)?;
            let n = tangents.len();
            let both = tangents.try_into();
            SplineEnds::Clamped(both.map_err(|_| given.fault(&format!("needs two tangents, not {n}")))?)
        }
    };
    spline::interpolating(&points, knots, ends).map_err(|why| given.fault(&format!("has no path: {why}")))
}

fn bezier_of<const D: usize>(given: &BoundArgs) -> Result<Curve<D>, CallError> {
    let points = given.points::<D>(0)?;
    if points.len() < 4 || points.len() % 3 != 1 {
        return Err(
            given.fault(&format!("needs 4 points, or 3n + 1 for n curves in a row, not {}", points.len()))
        );
    }
    let cubic = |at: usize| Bezier { control: [points[at], points[at + 1], points[at + 2], points[at + 3]] };
    let cubics = (0..points.len() - 1).step_by(3).map(|at| CurveSegment::Cubic(cubic(at)));
    Curve::new(cubics.collect(), CurveEnds::Open).map_err(|why| given.fault(&format!("has no path: {why}")))
}

fn nurbs_of<const D: usize>(given: &BoundArgs) -> Result<Curve<D>, CallError> {
    let (control, degree) = (given.points::<D>(0)?, given.count(1)? as usize);
    let weights = match given.given(2) {
        Some(_) => given.number_list(2)?,
        None => vec![1.0; control.len()],
    };
    let knots = match given.given(3) {
        Some(_) => KnotVector::new(degree, given.number_list(3)?),
        None => KnotVector::clamped(degree, control.len()),
    };
    let no_path = |why: String| given.fault(&format!("has no path: {why}"));
    let made = knots.and_then(|knots| NurbsCurve::new(knots, control, weights));
    made.map_err(|why| no_path(why.to_string()))?.to_curve().map_err(|why| no_path(why.to_string()))
}

fn arc(given: &BoundArgs) -> Result<Arg, CallError> {
    let (radius, [start, angle]) = (given.number(0)?, given.numbers::<2>(1)?);
    let centre = if given.given(3).is_some() { given.point::<2>(3)? } else { [0.0; 2] };
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(given.fault(&format!("needs a radius above 0, not {radius}")));
    }
    if angle == 0.0 || !(-360.0..=360.0).contains(&angle) || !(-360.0..=360.0).contains(&start) {
        return Err(given.fault(&format!(
            "needs a start and an angle between -360 and 360 degrees, and an angle other than 0, not {start} and {angle}"
        )));
    }
    let is_whole = angle.abs() == 360.0;
    let made = Arc::new(centre, [[radius, 0.0], [0.0, radius]], start.to_radians(), angle.to_radians());
    let no_path = |why: String| given.fault(&format!("has no path: {why}"));
    let arc = made.map_err(|why| no_path(why.to_string()))?;
    // Quarters of a turn end where they do, and not a rounding beside it: on the axis of a profile, say.
    let mut at = [start, start + angle]
        .map(quarter_turn)
        .map(|known| known.map(|[x, y]| [centre[0] + radius * x, centre[1] + radius * y]));
    if is_whole {
        at[1] = Some(at[0].unwrap_or(arc.ends()[0]));
    }
    let ends = [0, 1].map(|k| at[k].unwrap_or(arc.ends()[k]));
    let arc = arc.with_ends(ends);
    let ends = CurveEnds::from(is_whole);
    let curve = Curve::new(vec![CurveSegment::Arc(arc)], ends).map_err(|why| no_path(why.to_string()))?;
    Ok(Arg::path(curve.into()))
}

/// The direction of a whole number of quarters of a turn.
fn quarter_turn(degrees: f64) -> Option<[f64; 2]> {
    match degrees.rem_euclid(360.0) {
        0.0 => Some([1.0, 0.0]),
        90.0 => Some([0.0, 1.0]),
        180.0 => Some([-1.0, 0.0]),
        270.0 => Some([0.0, -1.0]),
        _ => None,
    }
}

fn fit_of<const D: usize>(given: &BoundArgs) -> Result<Curve<D>, CallError> {
    let (points, is_closed, deg) = (given.points::<D>(0)?, given.truth(2)?, given.number(3)?);
    let fit = SplineFit { length: tolerance(given, given.number(1)?)?, corners: Corners::Sharper { deg } };
    let made = points_to_spline(&points, is_closed.into(), &fit, given.job());
    let Bounded { shape, bound } = made.map_err(|failure| failed(given, &failure))?;
    if let Some(most) = bound.at_most() {
        given.note(&format!("the path passes the points within {most:.3e} (proved)"));
    }
    Ok(shape)
}

fn tolerance(given: &BoundArgs, length: f64) -> Result<Tolerance, CallError> {
    Tolerance::new(length).map_err(|why| given.fault(&format!("needs a tolerance: {why}")))
}

/// What went wrong in an arrow.
pub(super) fn failed<T>(given: &BoundArgs, failure: &Failure<T>) -> CallError {
    match failure {
        Failure::Unmet(_) => given.fault("does not reach its tolerance"),
        Failure::Refused(why) => given.fault(&format!("is refused: {}", why.message)),
        Failure::Cancelled => given.fault("is cancelled"),
    }
}

/// The budget of a path: the argument at index `k`, or a share of the diagonal of the path's box.
fn budget<const D: usize>(given: &BoundArgs, curve: &Curve<D>, k: usize) -> Result<Budget, CallError> {
    let length = match given.given(k) {
        Some(_) => given.number(k)?,
        None => {
            let [low, high] = curve.bounds();
            let square = (0..D).fold(0.0, |sum, k| sum + (high[k] - low[k]) * (high[k] - low[k]));
            // Chosen: 85 sides for a circle. A path that is a point has no lines at all.
            greater(square.sqrt(), f64::MIN_POSITIVE) / 4096.0
        }
    };
    Ok(Budget::length(tolerance(given, length)?))
}

/// Says how far polylines are off the paths that they stand for.
fn note_bound(given: &BoundArgs, at_most: f64) {
    if at_most > 0.0 {
        given.note(&format!("its path is straight lines within {at_most:.3e} (proved)"));
    }
}

/// The straight lines that stand for a path, within the tolerance at index `k`, and how far they are off it.
pub(super) fn polyline<const D: usize>(
    given: &BoundArgs,
    curve: &Curve<D>,
    k: usize,
) -> Result<(Polyline<D>, f64), CallError> {
    let made = curve_to_polyline(curve, &budget(given, curve, k)?, given.job());
    let Bounded { shape, bound } = made.map_err(|failure| failed(given, &failure))?;
    let slack = bound.at_most().unwrap_or(f64::INFINITY);
    note_bound(given, slack);
    Ok((shape, slack))
}

/// The polygon of corners, or what a path encloses.
pub(super) fn polygon(given: &BoundArgs) -> Result<Arg, CallError> {
    if !matches!(given.any(0), Arg::Path(_)) {
        if given.given(1).is_some() {
            return Err(given.fault("of corners is exact, and has no tolerance"));
        }
        let corners = given.points(0)?;
        let plain = shapes::polygon(&corners);
        if !plain.as_ref().is_ok_and(|field| field.distance() != Distance::EXACT) {
            return given.shape_result(plain, &[]);
        }
        // Its sides cross or touch.
        let made = contours_to_field(&[corners], FillRule::EvenOdd, given.job());
        let Bounded { shape, bound } = made.map_err(|failure| failed(given, &failure))?;
        let slack = bound.at_most().unwrap_or(f64::INFINITY);
        given.note(&format!(
            "its sides cross or touch, and it is taken as cut there, which moved it by {slack:.1e} at most"
        ));
        return counted_result(given, Ok(shape.with_slack(slack)), &[]);
    }
    let path = given.path(0)?;
    let ScriptPath::Plane(curve) = &*path else {
        return Err(given.fault("needs a path of the plane, not one of space"));
    };
    let budget = budget(given, curve, 1)?;
    let outline = Outline { contours: vec![curve.clone()], rule: FillRule::EvenOdd };
    let made = outline_to_field(&outline, &budget, given.job());
    let Bounded { shape, bound } = made.map_err(|failure| failed(given, &failure))?;
    let slack = bound.at_most().unwrap_or(f64::INFINITY);
    note_bound(given, slack);
    counted_result(given, Ok(shape.with_slack(slack)), &[])
}
