//! The four Bernstein weights and the convex hull: de Casteljau's construction at one parameter.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use chordal::Bezier;
use chordal::explicit::parametric::bernstein as weights_at;
use chordal::math::exact::{PointInTriangle, triangle_contains};
use serde_json::{Value, json};

/// The range of the parameter. Chosen: a tenth beyond both ends, where weights are negative and the
/// construction is still in the picture.
const RANGE: [f64; 2] = [-0.1, 1.1];
/// The steps of the graphs of the weights. Chosen: each is 0.02 wide.
const STEPS: u32 = 60;

/// Answers `{"control": [[x, y] × 4], "t": 0.4}`: the weights, the levels of the construction, both parts,
/// and whether the point lies in the hull.
pub(super) fn bernstein(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["control", "t"])?;
    let control = request.points::<2>("control", [4, 4])?;
    let curve = Bezier { control: [control[0], control[1], control[2], control[3]] };
    let t = request.number("t", RANGE)?;
    let weights = weights_at(t);
    let levels = curve.de_casteljau(t);
    let graphs: Vec<[f64; 4]> = (0..=STEPS)
        .map(|i| weights_at(RANGE[0] + (RANGE[1] - RANGE[0]) * f64::from(i) / f64::from(STEPS)))
        .collect();
    let mut answer = ExhibitAnswer::default();
    let graphs: Vec<Value> =
        (0..4).map(|k| answer.floats(&graphs.iter().map(|weights| weights[k]).collect::<Vec<_>>())).collect();
    answer.facts = json!({
        "weights": weights,
        "sum": weights.iter().sum::<f64>(),
        "smallest": weights.iter().fold(f64::INFINITY, |least, w| if *w < least { *w } else { least }),
        "first": levels.first,
        "second": levels.second,
        "point": levels.point,
        "tangent": curve.tangent(t),
        "parts": curve.split(t).map(|part| part.control),
        "is_in_hull": is_in_hull(curve.control, levels.point),
        "range": RANGE,
        "graphs": graphs,
    });
    Ok(answer)
}

/// Whether a point is in the hull of four points, which is the union of the triangles of any three of them
/// (C. Carathéodory, 1911).
fn is_in_hull(control: [[f64; 2]; 4], point: [f64; 2]) -> bool {
    [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]
        .into_iter()
        .any(|rows| triangle_contains(rows.map(|row: usize| control[row]), point) != PointInTriangle::Outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_at(t: f64) -> Value {
        let question =
            format!(r#"{{"exhibit": "bernstein", "control": [[0, 0], [0, 4], [4, 4], [4, 0]], "t": {t}}}"#);
        bernstein(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn between_the_ends_no_weight_is_negative_and_the_point_stays_in_the_hull() {
        for i in 0..=100 {
            let facts = facts_at(f64::from(i) / 100.0);
            assert!(
                facts["smallest"].as_f64().unwrap() >= 0.0 && facts["is_in_hull"] == json!(true),
                "{facts}"
            );
            assert!((facts["sum"].as_f64().unwrap() - 1.0).abs() <= f64::EPSILON);
        }
        assert_eq!(facts_at(0.5)["point"], json!([2.0, 3.0]));
        assert_eq!(facts_at(0.5)["weights"], json!([0.125, 0.375, 0.375, 0.125]));
        // Beyond the ends one is negative, and the sum is still one.
        for t in [-0.1, -0.05, 1.05, 1.1] {
            let facts = facts_at(t);
            assert!(
                facts["smallest"].as_f64().unwrap() < 0.0 && facts["is_in_hull"] == json!(false),
                "{facts}"
            );
            assert!((facts["sum"].as_f64().unwrap() - 1.0).abs() <= 4.0 * f64::EPSILON);
        }
    }
}
