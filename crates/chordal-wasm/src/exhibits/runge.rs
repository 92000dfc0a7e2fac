//! One polynomial through many points, and a spline: how far each moves elsewhere if one point moves.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use chordal::explicit::parametric::Polynomial;
use chordal::explicit::spline;
use serde_json::{Value, json};

/// The range of the number of points.
const COUNTS: [f64; 2] = [5.0, 15.0];
/// The number of equal steps at which the curves are compared. Chosen: dense enough to catch the largest
/// difference.
const STEPS: u32 = 600;

/// Runge's function, on [−1, 1].
fn runge_function(x: f64) -> f64 {
    1.0 / (1.0 + 25.0 * x * x)
}

/// Both curves through the same points, at equal steps.
struct SampledCurves {
    polynomial: Vec<[f64; 2]>,
    spline: Vec<[f64; 2]>,
}

/// Answers `{"count": 11, "row": 5, "lift": 0.2}`: the polynomial and the natural spline through `count`
/// points of Runge's function, one of which is lifted; the error of each without the lift, and its movement
/// by the lift beyond the two neighbours of the point.
pub(super) fn runge(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["count", "row", "lift"])?;
    let count = request.number("count", COUNTS)? as u32;
    let row = request.number("row", [0.0, f64::from(count) - 1.0])? as u32;
    let lift = request.number("lift", [-2.0, 2.0])?;
    let nodes: Vec<f64> = (0..count).map(|i| 2.0 * f64::from(i) / f64::from(count - 1) - 1.0).collect();
    let points: Vec<[f64; 2]> = nodes.iter().map(|x| [*x, runge_function(*x)]).collect();
    let mut moved = points.clone();
    moved[row as usize][1] += lift;
    let (before, after) = (through(&nodes, &points)?, through(&nodes, &moved)?);
    let function: Vec<[f64; 2]> = places().map(|x| [x, runge_function(x)]).collect();
    // Only places beyond the two neighbours of the lifted point count as movement elsewhere.
    let is_beyond_neighbours = |x: f64| (x - nodes[row as usize]).abs() >= 2.0 / f64::from(count - 1);
    let is_anywhere = |_: f64| true;
    let mut answer = ExhibitAnswer::default();
    let mut samples = |curve: &[[f64; 2]]| answer.floats(curve.as_flattened());
    let curves = json!({
        "function": samples(&function),
        "polynomial_before": samples(&before.polynomial),
        "polynomial": samples(&after.polynomial),
        "spline_before": samples(&before.spline),
        "spline": samples(&after.spline),
    });
    answer.facts = json!({
        "points": moved,
        "curves": curves,
        "degree": count - 1,
        "moves": {
            "polynomial": widest(&before.polynomial, &after.polynomial, is_beyond_neighbours),
            "spline": widest(&before.spline, &after.spline, is_beyond_neighbours),
        },
        "misses": {
            "polynomial": widest(&before.polynomial, &function, is_anywhere),
            "spline": widest(&before.spline, &function, is_anywhere),
        },
    });
    Ok(answer)
}

fn places() -> impl Iterator<Item = f64> {
    (0..=STEPS).map(|i| 2.0 * f64::from(i) / f64::from(STEPS) - 1.0)
}

fn through(nodes: &[f64], points: &[[f64; 2]]) -> Result<SampledCurves, String> {
    let polynomial = Polynomial::through(nodes, points).map_err(|error| error.to_string())?;
    let smooth = spline::natural(points).map_err(|error| error.to_string())?;
    // The points have equal steps in x, so the parameter of the spline is linear in x.
    let parameter = |x: f64| 0.5 * (x + 1.0) * (nodes.len() - 1) as f64;
    Ok(SampledCurves {
        polynomial: places().map(|x| polynomial.at(x)).collect(),
        spline: places().map(|x| [x, smooth.at(parameter(x))[1]]).collect(),
    })
}

/// The largest difference in height, and its place.
fn widest(a: &[[f64; 2]], b: &[[f64; 2]], counts: impl Fn(f64) -> bool) -> Value {
    let mut largest = (0.0, 0.0);
    for ([x, y], [_, z]) in a.iter().zip(b).filter(|([x, _], _)| counts(*x)) {
        if (y - z).abs() > largest.0 {
            largest = ((y - z).abs(), *x);
        }
    }
    json!({ "by": largest.0, "at": largest.1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(count: u32, lift: f64) -> Value {
        let question =
            format!(r#"{{"exhibit": "runge", "count": {count}, "row": {}, "lift": {lift}}}"#, count / 2);
        runge(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn the_polynomial_moves_everywhere_and_the_spline_hardly_at_all() {
        let by = |facts: &Value, what: &str, of: &str| facts[what][of]["by"].as_f64().unwrap();
        let still = facts_of(11, 0.0);
        assert_eq!((by(&still, "moves", "polynomial"), by(&still, "moves", "spline")), (0.0, 0.0));
        // C. Runge's own example: 1.92 at 11 points.
        assert!((by(&still, "misses", "polynomial") - 1.916).abs() < 2e-3);
        assert!(by(&still, "misses", "spline") < 0.023);
        let [one, two] = [facts_of(11, 0.2), facts_of(11, 0.4)];
        assert!((by(&two, "moves", "polynomial") / by(&one, "moves", "polynomial") - 2.0).abs() < 1e-9);
        assert!(by(&one, "moves", "polynomial") > 0.5 && by(&one, "moves", "spline") < 0.05);
        // More points make one of them worse.
        assert!(by(&facts_of(15, 0.2), "moves", "polynomial") > 3.0 * by(&one, "moves", "polynomial"));
        assert!(by(&facts_of(15, 0.2), "moves", "spline") < 0.05);
    }
}
