//! Shapes along paths: tubes, and sweeps of 2D shapes.
use super::bind::BoundArgs;
use super::paths::{failed, polyline};
use super::{Arg, CallError, ScriptPath, Solid};
use chordal::convert::curve_to_field;
use chordal::explicit::{Curve, CurveSegment, Polyline};
use chordal::implicit::{Field, shapes};
use chordal::{Budget, Tolerance};

/// The most points of a path. Defined: the limits of a script hardly allow more.
const MOST_POINTS: usize = 100_000;

/// The most points of a tube that is a union of capsules. Chosen: enough for a coil of some turns; tubes with
/// more points are faster to evaluate and have no known creases.
const MOST_CAPSULES: usize = 513;

/// The polyline along which a shape is swept.
struct SweptLines {
    points: Vec<[f64; 3]>,
    is_closed: bool,
    /// Its largest distance from the path that it approximates.
    slack: f64,
}

pub(super) fn sweep(args: &BoundArgs) -> Result<Arg, CallError> {
    let lines = lines(args)?;
    match args.any(1) {
        // A tube around the polyline has the same error as the polyline.
        Arg::Number(radius) => Ok(with_slack(tube(args, &lines, *radius)?, lines.slack)),
        // A profile extends sideways, and its frame turns differently along the path than along the polyline:
        // the error has no known bound.
        Arg::Shape(profile) => {
            let slack = if lines.slack > 0.0 { f64::INFINITY } else { 0.0 };
            Ok(with_slack(swept(args, &lines, profile)?, slack))
        }
        other => Err(args.fault(&format!("needs a radius or a shape for 'profile', not {}", other.kind()))),
    }
}

fn with_slack(shape: Arg, slack: f64) -> Arg {
    match shape {
        Arg::Shape(solid) => Arg::Shape(Solid { field: solid.field.with_slack(slack), ..solid }),
        other => other,
    }
}

fn lines(args: &BoundArgs) -> Result<SweptLines, CallError> {
    let lines = match args.any(0) {
        Arg::Path(path) => match &**path {
            ScriptPath::Plane(curve) => {
                let (Polyline { points, closed, .. }, slack) = polyline(args, curve, 2)?;
                let points = points.iter().map(|[x, y]| [*x, *y, 0.0]).collect();
                SweptLines { points, is_closed: closed, slack }
            }
            ScriptPath::Space(curve) => {
                let (Polyline { points, closed, .. }, slack) = polyline(args, curve, 2)?;
                SweptLines { points, is_closed: closed, slack }
            }
        },
        _ if args.argument(2).is_some() => {
            return Err(args.fault("takes a tolerance only for paths: a sweep along straight lines is exact"));
        }
        _ => SweptLines { points: args.points::<3>(0)?, is_closed: false, slack: 0.0 },
    };
    let n = lines.points.len();
    if (1..=MOST_POINTS).contains(&n) {
        Ok(lines)
    } else {
        Err(args.fault(&format!("needs 1 to {MOST_POINTS} points, not {n}")))
    }
}

/// All points nearer than a radius to a polyline.
fn tube(args: &BoundArgs, lines: &SweptLines, radius: f64) -> Result<Arg, CallError> {
    let mut points = lines.points.clone();
    if lines.is_closed {
        points.push(points[0]);
    }
    // A union of capsules knows its creases. Many segments become a single leaf instead, which finds the
    // nearest one without evaluating all.
    if (2..=MOST_CAPSULES).contains(&points.len()) {
        let capsules: Result<Vec<Field>, _> =
            points.windows(2).map(|ends| shapes::capsule(ends[0], ends[1], radius)).collect();
        let n_capsules = points.len() as u64;
        let tube = args.shape_result(capsules.map(|capsules| Field::union_of(&capsules)), &[])?;
        return Ok(match tube {
            // Each capsule has some dozen terms.
            Arg::Shape(solid) => {
                Arg::Shape(Solid { weight: 80 * n_capsules, step_weight: 80 * n_capsules, ..solid })
            }
            other => other,
        });
    }
    let starts = [points[0]].into_iter().chain(points[1..].iter().copied());
    let lines = starts.zip(&points[1..]).map(|(a, b)| CurveSegment::Line([a, *b])).collect::<Vec<_>>();
    let curve = if lines.is_empty() { Curve::point(points[0]) } else { Curve::new(lines, false.into()) };
    let curve = curve.map_err(|why| args.fault(&format!("cannot make a path: {why}")))?;
    // Straight lines stay exact, so any budget will do.
    let tolerance =
        Tolerance::new(radius).map_err(|why| args.fault(&format!("needs a radius above 0: {why}")))?;
    let tube = curve_to_field(&curve, radius, &Budget::length(tolerance), args.job());
    args.shape_result(Ok(tube.map_err(|failure| failed(args, &failure))?.shape), &[])
}

/// A 2D shape swept along a polyline.
fn swept(args: &BoundArgs, lines: &SweptLines, profile: &Solid) -> Result<Arg, CallError> {
    // Each piece holds the shape three times: by itself and with both of its neighbours.
    let n_pieces = lines.points.len() as u64;
    let field = profile.field.swept_along(&lines.points, lines.is_closed);
    Ok(match args.weighted_shape_result(field, &[profile], 3 * n_pieces)? {
        // The planes and frames of a piece have some dozen terms.
        Arg::Shape(solid) => {
            let step_weight = solid.step_weight + 100 * n_pieces;
            Arg::Shape(Solid { weight: solid.weight.saturating_add(step_weight), step_weight, ..solid })
        }
        other => other,
    })
}
