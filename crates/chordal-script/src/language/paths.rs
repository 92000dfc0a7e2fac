//! Paths: 2D and 3D curves, from which shapes are built.
use super::bind::{
    BoundArgs, Function, ParameterDefault, ParameterKind as Kind, counted_result, defaulting, optional,
    required,
};
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
            required("points").of(Kind::Points),
            defaulting("closed", ParameterDefault::False).of(Kind::Truth),
            defaulting("knots", ParameterDefault::Text("centripetal")).of(Kind::Text),
            defaulting("tangents", NOTHING).of(Kind::Points),
        ],
        about: "A smooth path through points of two or three numbers. It consists of cubics and is C2 with \
            respect to its knots, which are \"centripetal\", \"chordal\" or \"uniform\". Without tangents \
            its second derivatives are 0 at the ends; two tangents are its first derivatives there.",
        distance: "",
        make: |args| in_any_space(args, spline_of::<2>, spline_of::<3>),
    },
    Function {
        name: "bezier",
        parameters: &[required("control").of(Kind::Points)],
        about: "A chain of cubic Bézier curves: four control points, and three more for each further \
            curve.",
        distance: "",
        make: |args| in_any_space(args, bezier_of::<2>, bezier_of::<3>),
    },
    Function {
        name: "nurbs",
        parameters: &[
            required("control").of(Kind::Points),
            optional("degree", 3.0),
            defaulting("weights", NOTHING).of(Kind::Numbers),
            defaulting("knots", NOTHING).of(Kind::Numbers),
        ],
        about: "A rational B-spline with these control points. It starts at the first and ends at the last \
            of them, unless knots are given. The weights are 1 by default.",
        distance: "",
        make: |args| in_any_space(args, nurbs_of::<2>, nurbs_of::<3>),
    },
    Function {
        name: "arc",
        parameters: &[
            required("radius"),
            optional("start", 0.0),
            optional("degrees", 360.0),
            defaulting("center", NOTHING).of(Kind::Vector),
        ],
        about: "A circular arc in the plane, counter-clockwise from a start angle over an angle, both in \
            degrees; by default a full circle.",
        distance: "",
        make: arc,
    },
    Function {
        name: "fit",
        parameters: &[
            required("points").of(Kind::Points),
            required("tolerance"),
            defaulting("closed", ParameterDefault::False).of(Kind::Truth),
            optional("corners", 30.0),
        ],
        about: "A path of few cubics within the tolerance of every one of many points, with corners where \
            the points turn by more than the angle corners, in degrees.",
        distance: "",
        make: |args| in_any_space(args, fit_of::<2>, fit_of::<3>),
    },
];

/// Builds a path from the arguments of a call, whose points have `D` coordinates.
type PathMaker<const D: usize> = fn(&BoundArgs) -> Result<Curve<D>, CallError>;

fn in_any_space(args: &BoundArgs, plane: PathMaker<2>, space: PathMaker<3>) -> Result<Arg, CallError> {
    let path = if args.width(0)? == 2 { plane(args)?.into() } else { space(args)?.into() };
    Ok(Arg::path(path))
}

fn spline_of<const D: usize>(args: &BoundArgs) -> Result<Curve<D>, CallError> {
    let (points, is_closed) = (args.points::<D>(0)?, args.truth(1)?);
    let knots = match args.text(2)? {
        "centripetal" => Knots::Centripetal,
        "chordal" => Knots::Chordal,
        "uniform" => Knots::Uniform,
        other => {
            let shown: String = other.chars().take(40).collect();
            return Err(
                args.fault(&format!("needs 'centripetal', 'chordal' or 'uniform' knots, not '{shown}'"))
            );
        }
    };
    let ends = match (args.argument(3), is_closed) {
        (None, false) => SplineEnds::Natural,
        (None, true) => SplineEnds::Periodic,
        (Some(_), true) => {
            return Err(args.fault("takes tangents only for open paths: a closed one has no ends"));
        }
        (Some(_), false) => {
            let tangents = args.points::<D>(3)?;
            let n = tangents.len();
            let pair = tangents.try_into();
            SplineEnds::Clamped(pair.map_err(|_| args.fault(&format!("needs two tangents, not {n}")))?)
        }
    };
    spline::interpolating(&points, knots, ends)
        .map_err(|why| args.fault(&format!("cannot make a path: {why}")))
}

fn bezier_of<const D: usize>(args: &BoundArgs) -> Result<Curve<D>, CallError> {
    let points = args.points::<D>(0)?;
    if points.len() < 4 || points.len() % 3 != 1 {
        return Err(
            args.fault(&format!("needs 4 points, or 3n + 1 for a chain of n curves, not {}", points.len()))
        );
    }
    let cubic = |at: usize| Bezier { control: [points[at], points[at + 1], points[at + 2], points[at + 3]] };
    let cubics = (0..points.len() - 1).step_by(3).map(|at| CurveSegment::Cubic(cubic(at)));
    Curve::new(cubics.collect(), CurveEnds::Open)
        .map_err(|why| args.fault(&format!("cannot make a path: {why}")))
}

fn nurbs_of<const D: usize>(args: &BoundArgs) -> Result<Curve<D>, CallError> {
    let (control, degree) = (args.points::<D>(0)?, args.count(1)? as usize);
    let weights = match args.argument(2) {
        Some(_) => args.number_list(2)?,
        None => vec![1.0; control.len()],
    };
    let knots = match args.argument(3) {
        Some(_) => KnotVector::new(degree, args.number_list(3)?),
        None => KnotVector::clamped(degree, control.len()),
    };
    let no_path = |why: String| args.fault(&format!("cannot make a path: {why}"));
    let curve = knots.and_then(|knots| NurbsCurve::new(knots, control, weights));
    curve.map_err(|why| no_path(why.to_string()))?.to_curve().map_err(|why| no_path(why.to_string()))
}

fn arc(args: &BoundArgs) -> Result<Arg, CallError> {
    let (radius, [start, angle]) = (args.number(0)?, args.numbers::<2>(1)?);
    let centre = if args.argument(3).is_some() { args.point::<2>(3)? } else { [0.0; 2] };
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(args.fault(&format!("needs a radius above 0, not {radius}")));
    }
    if angle == 0.0 || !(-360.0..=360.0).contains(&angle) || !(-360.0..=360.0).contains(&start) {
        return Err(args.fault(&format!(
            "needs 'start' and 'degrees' between -360 and 360, and 'degrees' other than 0, not {start} and {angle}"
        )));
    }
    let is_circle = angle.abs() == 360.0;
    let arc = Arc::new(centre, [[radius, 0.0], [0.0, radius]], start.to_radians(), angle.to_radians());
    let no_path = |why: String| args.fault(&format!("cannot make a path: {why}"));
    let arc = arc.map_err(|why| no_path(why.to_string()))?;
    // Ends at multiples of 90 degrees are set exactly: rounding would move them off, say, the axis of a
    // profile.
    let mut exact_ends = [start, start + angle]
        .map(quarter_turn)
        .map(|direction| direction.map(|[x, y]| [centre[0] + radius * x, centre[1] + radius * y]));
    // Its ends are one point, bit for bit: rounded angles would leave a gap.
    if is_circle {
        exact_ends[1] = Some(exact_ends[0].unwrap_or(arc.ends()[0]));
    }
    let ends = [0, 1].map(|k| exact_ends[k].unwrap_or(arc.ends()[k]));
    let arc = arc.with_ends(ends);
    let ends = CurveEnds::from(is_circle);
    let curve = Curve::new(vec![CurveSegment::Arc(arc)], ends).map_err(|why| no_path(why.to_string()))?;
    Ok(Arg::path(curve.into()))
}

/// The direction at an angle that is a multiple of 90 degrees.
fn quarter_turn(degrees: f64) -> Option<[f64; 2]> {
    // By sine and cosine, such a direction would miss its axis by a rounding.
    match degrees.rem_euclid(360.0) {
        0.0 => Some([1.0, 0.0]),
        90.0 => Some([0.0, 1.0]),
        180.0 => Some([-1.0, 0.0]),
        270.0 => Some([0.0, -1.0]),
        _ => None,
    }
}

fn fit_of<const D: usize>(args: &BoundArgs) -> Result<Curve<D>, CallError> {
    let (points, is_closed, deg) = (args.points::<D>(0)?, args.truth(2)?, args.number(3)?);
    let fit = SplineFit { length: tolerance(args, args.number(1)?)?, corners: Corners::Sharper { deg } };
    let spline = points_to_spline(&points, is_closed.into(), &fit, args.job());
    let Bounded { shape, bound } = spline.map_err(|failure| failed(args, &failure))?;
    if let Some(most) = bound.at_most() {
        args.note(&format!("the path is within {most:.3e} of every point (proved)"));
    }
    Ok(shape)
}

fn tolerance(args: &BoundArgs, length: f64) -> Result<Tolerance, CallError> {
    Tolerance::new(length).map_err(|why| args.fault(&format!("cannot use this tolerance: {why}")))
}

/// The error of a call whose arrow failed.
pub(super) fn failed<T>(args: &BoundArgs, failure: &Failure<T>) -> CallError {
    match failure {
        Failure::Unmet(_) => args.fault("did not reach its tolerance"),
        Failure::Refused(why) => args.fault(&format!("refuses this input: {}", why.message)),
        Failure::Cancelled => args.fault("was cancelled"),
    }
}

/// The budget of a path: the argument at index `k`, or a share of the diagonal of the path's box.
fn budget<const D: usize>(args: &BoundArgs, curve: &Curve<D>, k: usize) -> Result<Budget, CallError> {
    let length = match args.argument(k) {
        Some(_) => args.number(k)?,
        None => {
            let [low, high] = curve.bounds();
            let square = (0..D).fold(0.0, |sum, k| sum + (high[k] - low[k]) * (high[k] - low[k]));
            // Chosen: a circle becomes 85 sides. The minimum is for a path that is a single point.
            greater(square.sqrt(), f64::MIN_POSITIVE) / 4096.0
        }
    };
    Ok(Budget::length(tolerance(args, length)?))
}

/// Adds a note about the distance between a path and its polyline.
fn note_bound(args: &BoundArgs, at_most: f64) {
    if at_most > 0.0 {
        args.note(&format!("its path is replaced by straight lines within {at_most:.3e} (proved)"));
    }
}

/// The polyline of a path within the tolerance at index `k`, and its largest distance from the path.
pub(super) fn polyline<const D: usize>(
    args: &BoundArgs,
    curve: &Curve<D>,
    k: usize,
) -> Result<(Polyline<D>, f64), CallError> {
    let polyline = curve_to_polyline(curve, &budget(args, curve, k)?, args.job());
    let Bounded { shape, bound } = polyline.map_err(|failure| failed(args, &failure))?;
    let slack = bound.at_most().unwrap_or(f64::INFINITY);
    note_bound(args, slack);
    Ok((shape, slack))
}

/// The polygon with the given corners, or the region that a path encloses.
pub(super) fn polygon(args: &BoundArgs) -> Result<Arg, CallError> {
    if !matches!(args.any(0), Arg::Path(_)) {
        if args.argument(1).is_some() {
            return Err(args.fault("takes a tolerance only for paths: a polygon with given corners is exact"));
        }
        let corners = args.points(0)?;
        let polygon = shapes::polygon(&corners);
        if !polygon.as_ref().is_ok_and(|field| field.distance() != Distance::EXACT) {
            return args.shape_result(polygon, &[]);
        }
        // Its value is no exact distance since its sides cross or touch: cut there, they form simple
        // contours.
        let contours = contours_to_field(&[corners], FillRule::EvenOdd, args.job());
        let Bounded { shape, bound } = contours.map_err(|failure| failed(args, &failure))?;
        let slack = bound.at_most().unwrap_or(f64::INFINITY);
        args.note(&format!(
            "its sides cross or touch; they are cut there, which moves them by {slack:.1e} at most"
        ));
        return counted_result(args, Ok(shape.with_slack(slack)), &[]);
    }
    let path = args.path(0)?;
    let ScriptPath::Plane(curve) = &*path else {
        return Err(args.fault("needs a 2D path, not a 3D path"));
    };
    let budget = budget(args, curve, 1)?;
    let outline = Outline { contours: vec![curve.clone()], rule: FillRule::EvenOdd };
    let region = outline_to_field(&outline, &budget, args.job());
    let Bounded { shape, bound } = region.map_err(|failure| failed(args, &failure))?;
    let slack = bound.at_most().unwrap_or(f64::INFINITY);
    note_bound(args, slack);
    counted_result(args, Ok(shape.with_slack(slack)), &[])
}
