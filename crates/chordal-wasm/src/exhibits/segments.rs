//! A curve in equal steps: its largest gap, what twice as many steps leave of it, and how many a pixel takes.
use super::answer::ExhibitAnswer;
use super::plane::or_text;
use super::request::ExhibitRequest;
use chordal::check::curves::{Gap, largest_gap};
use chordal::convert::{curve_to_polyline, curve_to_polyline_evenly};
use chordal::explicit::{Curve, Polyline};
use chordal::{Bezier, Budget, Job, Tolerance};
use serde_json::json;

/// The range of the segments.
const COUNTS: [f64; 2] = [1.0, 64.0]; // defined: what the slider offers
/// The range of the allowed length, in units of the figure.
const LENGTHS: [f64; 2] = [1e-3, 1.0]; // defined: from a sixteenth of a pixel to 60 pixels

/// Answers `{"control": [[x, y] × 4], "count": 8, "length": 0.01}`: the chain of that many equal steps, its
/// gap and that of twice as many, and the numbers of segments within the length.
pub(super) fn segments(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["control", "count", "length"])?;
    let control = request.points::<2>("control", [4, 4])?;
    let count = request.number("count", COUNTS)?.round() as u64;
    let length = or_text(Tolerance::new(request.number("length", LENGTHS)?))?;
    let curve = Curve::from(Bezier { control: [control[0], control[1], control[2], control[3]] });
    let job = Job::default();
    let even = |budget: &Budget| or_text(curve_to_polyline_evenly(&curve, budget, &job));
    let (chain, twice) = (even(&Budget::segments(count))?, even(&Budget::segments(2 * count))?);
    let [gap, next] = [&chain.shape, &twice.shape].map(|chain: &Polyline<2>| largest_gap(&curve, chain));
    let budget = Budget::length(length);
    let fewest = or_text(curve_to_polyline(&curve, &budget, &job))?.shape;
    let size = |gap: &Option<Gap<2>>| gap.map(|gap| gap.distance);
    Ok(ExhibitAnswer::new(json!({
        "points": chain.shape.points,
        "gap": size(&gap),
        "on_curve": gap.map(|gap| gap.on_curve),
        "on_chain": gap.map(|gap| gap.on_polyline),
        "next_gap": size(&next),
        "times": size(&gap).zip(size(&next)).filter(|(_, next)| *next > 0.0).map(|(gap, next)| gap / next),
        "bound": chain.bound.at_most(),
        "evenly": even(&budget)?.shape.n_segments(),
        "fewest": fewest.n_segments(),
        "fewest_points": fewest.points,
    })))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_segments_leave_a_quarter_of_the_gap_and_fewer_are_enough_if_they_follow_the_bend() {
        let question = br#"{"exhibit": "segments", "control": [[0, 0], [2, 6], [6, 6], [8, 0]], "count": 16, "length": 0.01}"#;
        let facts = segments(&ExhibitRequest::parse(question).unwrap().1).unwrap().facts;
        let number = |name: &str| facts[name].as_f64().unwrap();
        assert!((number("times") - 4.0).abs() < 0.05 && number("gap") <= number("bound"), "{facts}");
        assert!(number("fewest") <= number("evenly"), "{facts}");
        assert_eq!(facts["points"].as_array().unwrap().len(), 17);
    }
}
