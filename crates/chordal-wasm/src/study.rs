//! What a page asks about one cubic: its polylines at a number of segments, and how the error falls with that
//! number.
use crate::curve_request::{CurveRequest, CurveRequestError};
use chordal::budget::Bounded;
use chordal::check::curves::{Gap, largest_gap};
use chordal::convert::{curve_to_polyline, curve_to_polyline_evenly};
use chordal::explicit::{Curve, Polyline};
use chordal::{Bezier, Bound, Budget, Failure, Job, Tolerance};
use serde_json::{Value, json};

/// The most segments tried for a tolerance. Trying one after the other up to here is half a million chords.
const MOST_TRIED: u64 = 1024;
/// The parts of the curve whose ends are told, so that a page finds the parameter under a finger.
const RAIL: u64 = 96;
/// The range of pixels per unit, and of a tolerance in pixels.
const SCALES: [f64; 2] = [1e-3, 1e6]; // defined: far more than any screen shows

type ChainResult = Result<Bounded<Polyline<2>>, Failure<Polyline<2>>>;

/// How the segments of a chain are placed.
#[derive(Clone, Copy)]
enum ChainSpacing {
    Even,
    Fewest,
}

impl ChainSpacing {
    fn approximate(self, curve: &Curve<2>, budget: &Budget) -> ChainResult {
        match self {
            Self::Even => curve_to_polyline_evenly(curve, budget, &Job::default()),
            Self::Fewest => curve_to_polyline(curve, budget, &Job::default()),
        }
    }

    /// The chain of at most `n` segments, which a single piece always has.
    fn polyline(self, curve: &Curve<2>, n: u64) -> Result<Bounded<Polyline<2>>, CurveRequestError> {
        self.approximate(curve, &Budget::segments(n)).map_err(|failure| failure.to_string())
    }
}

/// Answers `{"control", "segments", "pixels_per_unit", "pixels", "t", "near"}`.
pub(crate) fn study(bytes: &[u8]) -> Result<Value, CurveRequestError> {
    let asked =
        CurveRequest::parse(bytes, &["control", "segments", "pixels_per_unit", "pixels", "t", "near"])?;
    let cubic = asked.cubic("control")?;
    let n = asked.segments("segments")?;
    let scale = asked.number("pixels_per_unit", SCALES)?;
    let pixels = asked.number("pixels", SCALES)?;
    let t = asked.number("t", [0.0, 1.0])?;
    let near = asked.number("near", SCALES)?;
    let curve = Curve::from(cubic);
    let told =
        |chain: ChainSpacing| chain.polyline(&curve, n).map(|made| chain_json(&cubic, &made, [scale, near]));
    // Rounded down, so that what meets the length meets the pixels.
    let length = Tolerance::new((pixels / scale).next_down()).map_err(|error| error.to_string())?;
    Ok(json!({
        "control": cubic.control,
        "even": told(ChainSpacing::Even)?,
        "fewest": told(ChainSpacing::Fewest)?,
        "needed": { "even": min_even_segments(&curve, length), "fewest": min_segments(&curve, length) },
        "construction": construction(&cubic, t),
    }))
}

/// Answers `{"control", "counts", "pixels_per_unit"}`.
pub(crate) fn ladder(bytes: &[u8]) -> Result<Value, CurveRequestError> {
    let asked = CurveRequest::parse(bytes, &["control", "counts", "pixels_per_unit"])?;
    let cubic = asked.cubic("control")?;
    let counts = asked.counts("counts")?;
    let scale = asked.number("pixels_per_unit", SCALES)?;
    let curve = Curve::from(cubic);
    let rungs = |chain: ChainSpacing| -> Result<Value, CurveRequestError> {
        let rung = |n: &u64| {
            let made = chain.polyline(&curve, *n)?;
            let gap = largest_gap(&curve, &made.shape).map_or(0.0, |gap| gap.distance);
            Ok(
                json!({ "segments": made.shape.n_segments(), "gap": in_pixels(gap, scale), "bound": bound_in_pixels(&made.bound, scale) }),
            )
        };
        counts.iter().map(rung).collect()
    };
    let rail = ChainSpacing::Even.polyline(&curve, RAIL)?.shape;
    Ok(json!({
        "control": cubic.control,
        "counts": counts,
        "even": rungs(ChainSpacing::Even)?,
        "fewest": rungs(ChainSpacing::Fewest)?,
        "rail": { "points": rail.points, "places": rail.places },
    }))
}

fn construction(cubic: &Bezier<2>, t: f64) -> Value {
    let levels = cubic.de_casteljau(t);
    json!({ "t": t, "first": levels.first, "second": levels.second, "point": levels.point })
}

/// A chain with what was lost, measured and proved, and the curve `near` the gap for a magnifying glass.
/// Where the curve is a point there is no gap.
fn chain_json(cubic: &Bezier<2>, made: &Bounded<Polyline<2>>, [scale, near]: [f64; 2]) -> Value {
    // Of a curve that is one point, only rounding would be measured.
    let found = if cubic.is_point() { None } else { largest_gap(&Curve::from(*cubic), &made.shape) };
    let gap = found.map(|Gap { distance, place, on_curve, on_polyline }| {
        json!({
            "distance": distance, "pixels": in_pixels(distance, scale), "place": place,
            "on_curve": on_curve, "on_polyline": on_polyline, "near": part_near(cubic, place, near).control,
        })
    });
    json!({
        "points": made.shape.points,
        "places": made.shape.places,
        "segments": made.shape.n_segments(),
        "gap": gap,
        "bound": {
            "at_least": made.bound.at_least(), "at_most": made.bound.at_most(),
            "pixels": bound_in_pixels(&made.bound, scale), "evidence": made.bound.evidence().as_str(),
        },
    })
}

/// The part of the curve within about `reach` units of a parameter, by the speed there.
fn part_near(cubic: &Bezier<2>, place: f64, reach: f64) -> Bezier<2> {
    let [dx, dy] = cubic.tangent(place);
    let step = reach / (dx * dx + dy * dy).sqrt();
    // Where the curve stands still the step is infinite and the part is all of it.
    let (from, to) = (place - step, place + step);
    cubic.part(if from > 0.0 { from } else { 0.0 }, if to < 1.0 { to } else { 1.0 })
}

fn in_pixels(distance: f64, scale: f64) -> f64 {
    distance * scale
}

/// The proved bound in pixels, never too small.
fn bound_in_pixels(bound: &Bound, scale: f64) -> Option<f64> {
    bound.at_most().map(|most| if most > 0.0 { (most * scale).next_up() } else { 0.0 })
}

/// The smallest number of equal steps that is proved to keep the length; none where [`MOST_TRIED`] do not.
fn min_even_segments(curve: &Curve<2>, length: Tolerance) -> Option<u64> {
    (1..=MOST_TRIED).find(|n| {
        let made = ChainSpacing::Even.approximate(curve, &Budget::segments(*n));
        made.is_ok_and(|made| made.bound.at_most().is_some_and(|most| most <= length.get()))
    })
}

/// The smallest number of segments that is proved to keep the length, wherever they are put.
fn min_segments(curve: &Curve<2>, length: Tolerance) -> Option<u64> {
    let budget = Budget { segments: Some(MOST_TRIED), ..Budget::length(length) };
    let mut fewest = ChainSpacing::Fewest.approximate(curve, &budget).ok()?.shape.n_segments() as u64;
    // The arrow promises nearly the fewest; whether one less will do is quickly tried.
    while fewest > 1 {
        let fewer = Budget { segments: Some(fewest - 1), ..budget };
        match ChainSpacing::Fewest.approximate(curve, &fewer) {
            Ok(made) => fewest = made.shape.n_segments() as u64,
            Err(_) => break,
        }
    }
    Some(fewest)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARCH: &str = r#""control": [[0, 0], [0, 1], [1, 1], [1, 0]], "pixels_per_unit": 100"#;

    fn asked(rest: &str) -> Result<Value, CurveRequestError> {
        study(format!("{{{ARCH}, {rest}}}").as_bytes())
    }

    #[test]
    fn tells_what_the_library_says_digit_for_digit() {
        let told = asked(r#""segments": 7, "pixels": 0.5, "t": 0.25, "near": 0.1"#).unwrap();
        let arch = Curve::from(Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] });
        for (name, made) in [
            ("even", curve_to_polyline_evenly(&arch, &Budget::segments(7), &Job::default()).unwrap()),
            ("fewest", curve_to_polyline(&arch, &Budget::segments(7), &Job::default()).unwrap()),
        ] {
            let chain = &told[name];
            assert_eq!(chain["points"], json!(made.shape.points));
            assert_eq!(chain["bound"]["at_most"], json!(made.bound.at_most()));
            let gap = largest_gap(&arch, &made.shape).unwrap();
            assert_eq!(chain["gap"]["distance"], json!(gap.distance));
            assert_eq!(chain["gap"]["pixels"], json!(gap.distance * 100.0));
        }
    }

    #[test]
    fn what_is_needed_is_proved_to_be_enough() {
        let told = asked(r#""segments": 1, "pixels": 0.5, "t": 0.5, "near": 0.1"#).unwrap();
        for name in ["even", "fewest"] {
            let n = told["needed"][name].as_u64().unwrap();
            let again = asked(&format!(r#""segments": {n}, "pixels": 0.5, "t": 0.5, "near": 0.1"#)).unwrap();
            assert!(again[name]["bound"]["pixels"].as_f64().unwrap() <= 0.5, "{name}: {n}");
        }
    }

    #[test]
    fn the_part_near_the_gap_is_the_curve_s_own() {
        let cubic = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
        let part = part_near(&cubic, 0.5, 0.15);
        // The speed in the middle is 3/2, so the part runs from 0.4 to 0.6.
        let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs();
        assert!(apart(part.at(0.0), cubic.at(0.4)) + apart(part.at(1.0), cubic.at(0.6)) < 1e-12);
        let still = Bezier { control: [[1.0, 1.0]; 4] };
        assert_eq!(part_near(&still, 0.5, 0.1), still);
    }

    #[test]
    fn questions_that_make_no_sense_are_refused_in_a_sentence() {
        for (question, part) in [
            ("", "JSON"),
            ("{", "JSON"),
            ("null", "object"),
            (r#"{"colour": 1}"#, "colour"),
            (r#"{"control": [[0, 0], [1, 1], [2, 2], [1e9, 0]]}"#, "control"),
            (r#"{"control": [[0, 0], [1, 1], [2, 2]]}"#, "four points"),
        ] {
            let error = study(question.as_bytes()).unwrap_err();
            assert!(error.contains(part) && !error.contains('\n'), "{question}: {error}");
        }
        // A number beyond all others is no JSON, or no coordinate, as the parser was built.
        assert!(study(br#"{"control": [[0, 0], [1, 1], [2, 2], [1e999, 0]]}"#).is_err());
        let deep = "[".repeat(100_000);
        assert!(study(deep.as_bytes()).is_err() && ladder(deep.as_bytes()).is_err());
        for (rest, part) in [
            (r#""segments": 0, "pixels": 1, "t": 0, "near": 1"#, "segments"),
            (r#""segments": 5000, "pixels": 1, "t": 0, "near": 1"#, "4096"),
            (r#""segments": 1, "pixels": 0, "t": 0, "near": 1"#, "pixels"),
            (r#""segments": 1, "pixels": 1, "t": 1.5, "near": 1"#, "t is a number"),
            (r#""segments": 1, "pixels": 1, "t": 0"#, "near"),
        ] {
            let error = asked(rest).unwrap_err();
            assert!(error.contains(part), "{rest}: {error}");
        }
    }
}
