//! Shapes along paths: tubes, and shapes of the plane that are swept.
use super::bind::BoundArgs;
use super::paths::{failed, polyline};
use super::{Arg, CallError, ScriptPath, Solid};
use chordal::convert::curve_to_field;
use chordal::explicit::{Curve, CurveSegment, Polyline};
use chordal::implicit::{Field, shapes};
use chordal::{Budget, Tolerance};

/// The most points of a path. Defined: what a script may hold anyway.
const MOST_POINTS: usize = 100_000;

/// The most points of a path whose parts are shapes of their own. Chosen: a coil of some turns.
const MOST_CAPSULES: usize = 513;

/// The straight lines that a shape runs along.
struct SweptLines {
    points: Vec<[f64; 3]>,
    is_closed: bool,
    /// How far they are off the path that they stand for.
    slack: f64,
}

pub(super) fn sweep(given: &BoundArgs) -> Result<Arg, CallError> {
    let lines = lines(given)?;
    match given.any(1) {
        // What is nearer to lines than a radius is as far off as these are.
        Arg::Number(radius) => Ok(with_slack(tube(given, &lines, *radius)?, lines.slack)),
        // A profile reaches out sideways, where frames turn otherwise along a path than along lines.
        Arg::Shape(profile) => {
            let slack = if lines.slack > 0.0 { f64::INFINITY } else { 0.0 };
            Ok(with_slack(swept(given, &lines, profile)?, slack))
        }
        other => Err(given.fault(&format!("needs a radius or a shape for 'profile', not {}", other.kind()))),
    }
}

fn with_slack(made: Arg, slack: f64) -> Arg {
    match made {
        Arg::Shape(solid) => Arg::Shape(Solid { field: solid.field.with_slack(slack), ..solid }),
        other => other,
    }
}

fn lines(given: &BoundArgs) -> Result<SweptLines, CallError> {
    let lines = match given.any(0) {
        Arg::Path(path) => match &**path {
            ScriptPath::Plane(curve) => {
                let (Polyline { points, closed, .. }, slack) = polyline(given, curve, 2)?;
                let points = points.iter().map(|[x, y]| [*x, *y, 0.0]).collect();
                SweptLines { points, is_closed: closed, slack }
            }
            ScriptPath::Space(curve) => {
                let (Polyline { points, closed, .. }, slack) = polyline(given, curve, 2)?;
                SweptLines { points, is_closed: closed, slack }
            }
        },
        _ if given.given(2).is_some() => {
            return Err(given.fault("along straight lines is exact, and has no tolerance"));
        }
        _ => SweptLines { points: given.points::<3>(0)?, is_closed: false, slack: 0.0 },
    };
    let n = lines.points.len();
    if (1..=MOST_POINTS).contains(&n) {
        Ok(lines)
    } else {
        Err(given.fault(&format!("needs 1 to {MOST_POINTS} points, not {n}")))
    }
}

/// All points nearer than a radius to lines.
fn tube(given: &BoundArgs, lines: &SweptLines, radius: f64) -> Result<Arg, CallError> {
    let mut points = lines.points.clone();
    if lines.is_closed {
        points.push(points[0]);
    }
    // As a union of its parts, whose creases are known; many are one leaf, which finds the nearest at once.
    if (2..=MOST_CAPSULES).contains(&points.len()) {
        let parts: Result<Vec<Field>, _> =
            points.windows(2).map(|two| shapes::capsule(two[0], two[1], radius)).collect();
        let n_parts = points.len() as u64;
        let made = given.shape_result(parts.map(|parts| Field::union_of(&parts)), &[])?;
        return Ok(match made {
            // Each capsule has some dozen terms.
            Arg::Shape(solid) => Arg::Shape(Solid { weight: 80 * n_parts, own: 80 * n_parts, ..solid }),
            other => other,
        });
    }
    let ends = [points[0]].into_iter().chain(points[1..].iter().copied());
    let lines = ends.zip(&points[1..]).map(|(a, b)| CurveSegment::Line([a, *b])).collect::<Vec<_>>();
    let curve = if lines.is_empty() { Curve::point(points[0]) } else { Curve::new(lines, false.into()) };
    let curve = curve.map_err(|why| given.fault(&format!("has no path: {why}")))?;
    // Straight lines are kept as they are, whatever the budget.
    let any = Tolerance::new(radius).map_err(|why| given.fault(&format!("needs a radius above 0: {why}")))?;
    let made = curve_to_field(&curve, radius, &Budget::length(any), given.job());
    given.shape_result(Ok(made.map_err(|failure| failed(given, &failure))?.shape), &[])
}

/// A shape of the plane along lines.
fn swept(given: &BoundArgs, lines: &SweptLines, profile: &Solid) -> Result<Arg, CallError> {
    // Each piece holds the shape three times: by itself and with both of its neighbours.
    let n_pieces = lines.points.len() as u64;
    let made = profile.field.swept_along(&lines.points, lines.is_closed);
    Ok(match given.weighted_shape_result(made, &[profile], 3 * n_pieces)? {
        // The planes and frames of a piece have some dozen terms.
        Arg::Shape(solid) => {
            let own = solid.own + 100 * n_pieces;
            Arg::Shape(Solid { weight: solid.weight.saturating_add(own), own, ..solid })
        }
        other => other,
    })
}
