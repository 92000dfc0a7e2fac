//! Requests of a page about one cubic: its polylines with a number of segments, and the error by that number.
use crate::curve_request::{CurveRequest, CurveRequestError};
use chordal::budget::Bounded;
use chordal::check::curves::{Gap, largest_gap};
use chordal::convert::{curve_to_polyline, curve_to_polyline_evenly};
use chordal::explicit::{Curve, Polyline};
use chordal::{Bezier, Bound, Budget, Failure, Job, Tolerance};
use serde_json::{Value, json};

/// The most segments that are tried for a tolerance. Chosen: trying all numbers up to here takes half a
/// million chords.
const MOST_TRIED: u64 = 1024;
/// The number of parts of the curve whose ends the page gets, to find the parameter under a finger. Chosen:
/// fine enough for a finger.
const RAIL: u64 = 96;
/// The range of pixels per unit, and of a tolerance in pixels.
const SCALES: [f64; 2] = [1e-3, 1e6]; // defined: far more than any screen shows

type ChainResult = Result<Bounded<Polyline<2>>, Failure<Polyline<2>>>;

/// The spacing of the segments of a chain.
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

    /// The chain of at most `n` segments; a single piece always has one.
    fn polyline(self, curve: &Curve<2>, n: u64) -> Result<Bounded<Polyline<2>>, CurveRequestError> {
        self.approximate(curve, &Budget::segments(n)).map_err(|failure| failure.to_string())
    }
}

/// Answers `{"control", "segments", "other", "pixels_per_unit", "pixels", "t", "near"}`.
pub(crate) fn study(bytes: &[u8]) -> Result<Value, CurveRequestError> {
    let request = CurveRequest::parse(
        bytes,
        &["control", "segments", "other", "pixels_per_unit", "pixels", "t", "near"],
    )?;
    let cubic = request.cubic("control")?;
    let n = request.segments("segments")?;
    let other = request.segments("other")?;
    let scale = request.number("pixels_per_unit", SCALES)?;
    let pixels = request.number("pixels", SCALES)?;
    let t = request.number("t", [0.0, 1.0])?;
    let near = request.number("near", SCALES)?;
    let curve = Curve::from(cubic);
    let chain_facts = |chain: ChainSpacing, n: u64| {
        chain.polyline(&curve, n).map(|polyline| chain_json(&cubic, &polyline, [scale, near]))
    };
    // Rounded down, so that a chain within the length is within the pixels.
    let length = Tolerance::new((pixels / scale).next_down()).map_err(|error| error.to_string())?;
    let chains = |n: u64| -> Result<[Value; 2], CurveRequestError> {
        Ok([chain_facts(ChainSpacing::Even, n)?, chain_facts(ChainSpacing::Fewest, n)?])
    };
    let ([even, fewest], [other_even, other_fewest]) = (chains(n)?, chains(other)?);
    Ok(json!({
        "control": cubic.control,
        "other": {
            "segments": other,
            "times": { "even": times(&even, &other_even), "fewest": times(&fewest, &other_fewest) },
            "even": other_even,
            "fewest": other_fewest,
        },
        "even": even,
        "fewest": fewest,
        "needed": needed_json(&curve, &cubic, length, scale),
        "formula": formula_json(&cubic, length, n, scale),
        "construction": construction(&cubic, t),
    }))
}

/// The ratio of the larger of two gaps to the smaller; `None` if one of them is zero.
fn times(a: &Value, b: &Value) -> Option<f64> {
    let pixels = |chain: &Value| chain["gap"]["pixels"].as_f64().filter(|pixels| *pixels > 0.0);
    let (a, b) = (pixels(a)?, pixels(b)?);
    Some(if a > b { a / b } else { b / a })
}

/// The smallest numbers that are proved to be within the length. With equal steps a larger number may be
/// worse: then `even_fails` is the largest number that is not proved, with its gap, and `even_from` the one
/// from which all are.
fn needed_json(curve: &Curve<2>, cubic: &Bezier<2>, length: Tolerance, scale: f64) -> Value {
    let even = min_even_segments(curve, length);
    let enough = wang_segments(cubic, length);
    let fails = even
        .filter(|_| enough <= MOST_TRIED)
        .and_then(|first| (first + 1..=enough).rev().find(|n| !is_proved(curve, *n, length)));
    let gap = fails.and_then(|n| {
        let polyline = ChainSpacing::Even.polyline(curve, n).ok()?;
        largest_gap(curve, &polyline.shape).map(|gap| in_pixels(gap.distance, scale))
    });
    json!({
        "even": even,
        "even_fails": fails.map(|n| json!({ "segments": n, "pixels": gap })),
        "even_from": even.filter(|_| enough <= MOST_TRIED).map(|first| fails.map_or(first, |n| n + 1)),
        "fewest": min_segments(curve, length),
    })
}

/// The formula for equal steps (G. Wang, 1984): the chord of a step `h` is no farther from its curve than `h²
/// / 8` times the largest second derivative, which a cubic has at an end.
fn formula_json(cubic: &Bezier<2>, length: Tolerance, n: u64, scale: f64) -> Value {
    let bend = largest_second_derivative(cubic);
    let gap = bend / (8.0 * (n * n) as f64);
    json!({
        "bend": bend, "length": length.get(), "segments": wang_segments(cubic, length),
        "gap": gap, "pixels": in_pixels(gap, scale),
    })
}

fn largest_second_derivative(cubic: &Bezier<2>) -> f64 {
    let [start, end] = [0.0, 1.0].map(|t| {
        let [x, y] = cubic.second_derivative(t);
        (x * x + y * y).sqrt()
    });
    if end > start { end } else { start }
}

/// The number of equal steps from which every number is within the length, up to the rounding of the formula,
/// for which any larger number has a margin.
fn wang_segments(cubic: &Bezier<2>, length: Tolerance) -> u64 {
    let steps = (largest_second_derivative(cubic) / (8.0 * length.get())).sqrt();
    // A cast from float to integer saturates.
    (steps.ceil() as u64).max(1)
}

/// Answers `{"control", "counts", "pixels_per_unit"}`.
pub(crate) fn ladder(bytes: &[u8]) -> Result<Value, CurveRequestError> {
    let request = CurveRequest::parse(bytes, &["control", "counts", "pixels_per_unit"])?;
    let cubic = request.cubic("control")?;
    let counts = request.counts("counts")?;
    let scale = request.number("pixels_per_unit", SCALES)?;
    let curve = Curve::from(cubic);
    let rungs = |chain: ChainSpacing| -> Result<Value, CurveRequestError> {
        let rung = |n: &u64| {
            let polyline = chain.polyline(&curve, *n)?;
            let gap = largest_gap(&curve, &polyline.shape).map_or(0.0, |gap| gap.distance);
            Ok(
                json!({ "segments": polyline.shape.n_segments(), "gap": in_pixels(gap, scale), "bound": bound_in_pixels(&polyline.bound, scale) }),
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

/// A chain with its measured gap and its proved bound, and the curve `near` the gap for a magnifying glass.
/// There is no gap if the curve is a point.
fn chain_json(cubic: &Bezier<2>, chain: &Bounded<Polyline<2>>, [scale, near]: [f64; 2]) -> Value {
    // For a curve that is a point, only rounding would be measured.
    let largest = if cubic.is_point() { None } else { largest_gap(&Curve::from(*cubic), &chain.shape) };
    let gap = largest.map(|Gap { distance, place, on_curve, on_polyline }| {
        json!({
            "distance": distance, "pixels": in_pixels(distance, scale), "place": place,
            "on_curve": on_curve, "on_polyline": on_polyline, "near": part_near(cubic, place, near).control,
        })
    });
    json!({
        "points": chain.shape.points,
        "places": chain.shape.places,
        "segments": chain.shape.n_segments(),
        "gap": gap,
        "bound": {
            "at_least": chain.bound.at_least(), "at_most": chain.bound.at_most(),
            "pixels": bound_in_pixels(&chain.bound, scale), "evidence": chain.bound.evidence().as_str(),
        },
    })
}

/// The part of the curve within about `reach` units of a parameter, estimated by the speed there.
fn part_near(cubic: &Bezier<2>, place: f64, reach: f64) -> Bezier<2> {
    let [dx, dy] = cubic.tangent(place);
    let step = reach / (dx * dx + dy * dy).sqrt();
    // If the speed is zero, the step is infinite and the part is the whole curve.
    let (from, to) = (place - step, place + step);
    cubic.part(if from > 0.0 { from } else { 0.0 }, if to < 1.0 { to } else { 1.0 })
}

fn in_pixels(distance: f64, scale: f64) -> f64 {
    distance * scale
}

/// The proved bound in pixels, rounded up.
fn bound_in_pixels(bound: &Bound, scale: f64) -> Option<f64> {
    bound.at_most().map(|most| if most > 0.0 { (most * scale).next_up() } else { 0.0 })
}

/// Whether `n` equal steps are proved to be within the length.
fn is_proved(curve: &Curve<2>, n: u64, length: Tolerance) -> bool {
    let chain = ChainSpacing::Even.approximate(curve, &Budget::segments(n));
    chain.is_ok_and(|chain| chain.bound.at_most().is_some_and(|most| most <= length.get()))
}

/// The smallest number of equal steps that is proved to be within the length; `None` if it exceeds
/// [`MOST_TRIED`].
fn min_even_segments(curve: &Curve<2>, length: Tolerance) -> Option<u64> {
    (1..=MOST_TRIED).find(|n| is_proved(curve, *n, length))
}

/// The smallest number of segments, placed freely, whose chain is proved to be within the length. It counts
/// the chain for that number alone, as it is shown; with the length as a second limit, one segment less may
/// suffice.
fn min_segments(curve: &Curve<2>, length: Tolerance) -> Option<u64> {
    let budget = Budget { segments: Some(MOST_TRIED), ..Budget::length(length) };
    let most = ChainSpacing::Fewest.approximate(curve, &budget).ok()?.shape.n_segments() as u64;
    let is_within = |n: u64| {
        let chain = ChainSpacing::Fewest.approximate(curve, &Budget::segments(n));
        chain.is_ok_and(|chain| chain.bound.at_most().is_some_and(|most| most <= length.get()))
    };
    // The arrow makes nearly the fewest, so the search ends soon.
    let enough = (most..=MOST_TRIED).find(|n| is_within(*n))?;
    (1..enough).rev().take_while(|n| is_within(*n)).last().or(Some(enough))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARCH: &str = r#""control": [[0, 0], [0, 1], [1, 1], [1, 0]], "pixels_per_unit": 100"#;

    fn study_arch(rest: &str) -> Result<Value, CurveRequestError> {
        let other = if rest.contains("other") { "" } else { r#""other": 2, "# };
        study(format!("{{{ARCH}, {other}{rest}}}").as_bytes())
    }

    #[test]
    fn tells_what_the_library_says_digit_for_digit() {
        let answer = study_arch(r#""segments": 7, "pixels": 0.5, "t": 0.25, "near": 0.1"#).unwrap();
        let arch = Curve::from(Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] });
        for (name, polyline) in [
            ("even", curve_to_polyline_evenly(&arch, &Budget::segments(7), &Job::default()).unwrap()),
            ("fewest", curve_to_polyline(&arch, &Budget::segments(7), &Job::default()).unwrap()),
        ] {
            let chain = &answer[name];
            assert_eq!(chain["points"], json!(polyline.shape.points));
            assert_eq!(chain["bound"]["at_most"], json!(polyline.bound.at_most()));
            let gap = largest_gap(&arch, &polyline.shape).unwrap();
            assert_eq!(chain["gap"]["distance"], json!(gap.distance));
            assert_eq!(chain["gap"]["pixels"], json!(gap.distance * 100.0));
        }
    }

    #[test]
    fn what_is_needed_is_proved_to_be_enough() {
        let answer = study_arch(r#""segments": 1, "pixels": 0.5, "t": 0.5, "near": 0.1"#).unwrap();
        for name in ["even", "fewest"] {
            let n = answer["needed"][name].as_u64().unwrap();
            let again =
                study_arch(&format!(r#""segments": {n}, "pixels": 0.5, "t": 0.5, "near": 0.1"#)).unwrap();
            assert!(again[name]["bound"]["pixels"].as_f64().unwrap() <= 0.5, "{name}: {n}");
        }
    }

    #[test]
    fn twice_the_segments_are_told_beside_with_how_many_times_less_is_lost() {
        let answer = study_arch(r#""segments": 32, "other": 64, "pixels": 1, "t": 0, "near": 1"#).unwrap();
        let again = study_arch(r#""segments": 64, "other": 32, "pixels": 1, "t": 0, "near": 1"#).unwrap();
        for name in ["even", "fewest"] {
            assert_eq!(answer["other"][name], again[name]);
            assert_eq!(answer[name], again["other"][name]);
            let times = answer["other"]["times"][name].as_f64().unwrap();
            let pixels = |chain: &Value| chain["gap"]["pixels"].as_f64().unwrap();
            assert_eq!(times, pixels(&answer[name]) / pixels(&answer["other"][name]));
            assert_eq!(answer["other"]["times"][name], again["other"]["times"][name]);
        }
        // By equal steps an arch loses h² / 8 of its second derivative's share across the chord: in the
        // limit, exactly.
        assert!((answer["other"]["times"]["even"].as_f64().unwrap() - 4.0).abs() < 0.02);
        let point = r#""control": [[1, 1], [1, 1], [1, 1], [1, 1]], "segments": 1, "other": 2"#;
        let rest = r#""pixels_per_unit": 1, "pixels": 1, "t": 0, "near": 1"#;
        let still = study(format!("{{{point}, {rest}}}").as_bytes()).unwrap();
        assert!(still["other"]["times"]["even"].is_null());
    }

    /// The curve that the page shows first, at the scale of a figure 720 pixels wide.
    fn shown(segments: u64) -> Value {
        let control = r#""control": [[1, 0.8], [2.2, 5.8], [3, 5], [9.4, 2]]"#;
        let rest =
            r#""other": 1, "pixels_per_unit": 66.66666666666667, "pixels": 0.5, "t": 0.4, "near": 0.2"#;
        study(format!("{{{control}, \"segments\": {segments}, {rest}}}").as_bytes()).unwrap()
    }

    #[test]
    fn a_larger_number_of_equal_steps_may_fail_and_then_it_is_named() {
        // A hairpin: one vertex more moves all of them away from its tip.
        let hairpin = |segments: u64| {
            let control = r#""control": [[8.4, 5.6], [0.2, 3], [2.6, 3.5], [6.5, 4.3]]"#;
            let rest =
                r#""other": 1, "pixels_per_unit": 66.66666666666667, "pixels": 0.5, "t": 0, "near": 1"#;
            study(format!("{{{control}, \"segments\": {segments}, {rest}}}").as_bytes()).unwrap()
        };
        let answer = hairpin(1);
        let needed = &answer["needed"];
        let number = |name: &str| needed[name].as_u64().unwrap();
        let (first, from) = (number("even"), number("even_from"));
        let fails = needed["even_fails"]["segments"].as_u64().unwrap();
        assert_eq!((first, fails, from), (22, 23, 24));
        let most = |n: u64| hairpin(n)["even"]["bound"]["pixels"].as_f64().unwrap();
        assert!(most(first) <= 0.5 && most(first - 1) > 0.5);
        assert_eq!(needed["even_fails"]["pixels"], hairpin(fails)["even"]["gap"]["pixels"]);
        assert!(needed["even_fails"]["pixels"].as_f64().unwrap() > 0.5);
        for n in from..=2 * answer["formula"]["segments"].as_u64().unwrap() {
            assert!(most(n) <= 0.5, "{n}");
        }
        // The curve that is shown first has no such number.
        assert_eq!(shown(1)["needed"]["even_fails"], Value::Null);
        assert_eq!(shown(1)["needed"]["even_from"], shown(1)["needed"]["even"]);
    }

    #[test]
    fn the_formula_is_never_exceeded_and_reached_where_the_second_derivative_is_across_and_constant() {
        for n in 1..40 {
            let answer = shown(n);
            let formula = answer["formula"]["pixels"].as_f64().unwrap();
            assert!(answer["even"]["gap"]["pixels"].as_f64().unwrap() <= formula, "{n}");
        }
        // A parabola over its chord, as a cubic: y'' = −8 everywhere.
        let parabola = r#""control": [[0, 0], [1, 1.3333333333333333], [2, 1.3333333333333333], [3, 0]]"#;
        let rest = r#""segments": 1, "other": 2, "pixels_per_unit": 1, "pixels": 0.0099, "t": 0, "near": 1"#;
        let answer = study(format!("{{{parabola}, {rest}}}").as_bytes()).unwrap();
        for (what, value) in [
            (&answer["formula"]["gap"], 1.0),
            (&answer["even"]["gap"]["distance"], 1.0),
            (&answer["formula"]["bend"], 8.0),
        ] {
            assert!((what.as_f64().unwrap() - value).abs() < 1e-12, "{answer}");
        }
        // 1 / n² ≤ 0.0099.
        assert_eq!(answer["formula"]["segments"], json!(11));
    }

    #[test]
    fn the_chain_that_is_shown_for_the_number_needed_keeps_the_length_and_one_less_does_not() {
        let control = r#""control": [[1, 0.8], [2.2, 5.8], [3, 5], [9.4, 2]]"#;
        for pixels in [1.0, 0.5, 0.25] {
            for width in (300..900).step_by(37) {
                let at = |n: u64| {
                    let scale = f64::from(width) / 10.8;
                    let rest =
                        format!(r#""pixels_per_unit": {scale}, "pixels": {pixels}, "t": 0, "near": 1"#);
                    study(format!(r#"{{{control}, "segments": {n}, "other": 1, {rest}}}"#).as_bytes())
                        .unwrap()
                };
                let needed = &at(1)["needed"];
                for name in ["even", "fewest"] {
                    let n = needed[name].as_u64().unwrap();
                    let most = |n: u64| at(n)[name]["bound"]["pixels"].as_f64().unwrap();
                    assert!(most(n) <= pixels && most(n - 1) > pixels, "{name}: {n}, {pixels}, {width}");
                }
            }
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
            (r#""segments": 1, "other": 0, "pixels": 1, "t": 0, "near": 1"#, "other"),
        ] {
            let error = study_arch(rest).unwrap_err();
            assert!(error.contains(part), "{rest}: {error}");
        }
    }
}
