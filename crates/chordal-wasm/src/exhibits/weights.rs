//! The barycentric probe: three weights interpolate the values of three corners; four corners have no such
//! weights.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use chordal::explicit::polygons::Diagonal;
use chordal::explicit::{Triangle, interpolate};
use chordal::math::exact::{PointInTriangle, triangle_contains};
use serde_json::{Value, json};

/// Answers `{"corners": [[x, y] × 3 or 4], "colors": [[r, g, b] × 3 or 4], "point": [x, y]}`: the weights and
/// the colour; for four corners, along either diagonal.
pub(super) fn weights(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["corners", "colors", "point"])?;
    let corners = request.points::<2>("corners", [3, 4])?;
    let colors = request.points::<3>("colors", [corners.len(); 2])?;
    let point = request.point::<2>("point")?;
    let blend = |rows: [u32; 3]| -> Value {
        let triangle = Triangle { corners: rows.map(|row| corners[row as usize]) };
        let Some(weights) = triangle.barycentric(point) else { return Value::Null };
        let mut color = [0.0; 3];
        interpolate(rows.map(|row| &colors[row as usize][..]), weights, &mut color);
        json!({
            "rows": rows, "weights": weights, "sum": weights.iter().sum::<f64>(), "color": color,
            "smallest": weights.into_iter().fold(f64::INFINITY, |least, w| if w < least { w } else { least }),
            "is_inside": triangle.position(point) != PointInTriangle::Outside,
        })
    };
    if corners.len() == 3 {
        return Ok(ExhibitAnswer::new(json!({ "blends": [blend([0, 1, 2])], "color_gap": null })));
    }
    // For a diagonal, the half of the quad that contains the point; the first half if neither does.
    let half = |diagonal: Diagonal| {
        let halves = diagonal.triangles();
        let holds = |rows: &[u32; 3]| {
            triangle_contains(rows.map(|row| corners[row as usize]), point) != PointInTriangle::Outside
        };
        halves.into_iter().find(holds).unwrap_or(halves[0])
    };
    let blends = [blend(half(Diagonal::First)), blend(half(Diagonal::Second))];
    let color = |blend: &Value, k: usize| blend["color"][k].as_f64();
    // The largest difference in a channel between the two answers.
    let gap = (0..3).filter_map(|k| Some((color(&blends[0], k)? - color(&blends[1], k)?).abs()));
    let gap = gap.fold(0.0, |most, gap| if gap > most { gap } else { most });
    Ok(ExhibitAnswer::new(json!({ "blends": blends, "color_gap": gap })))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(question: &str) -> Value {
        weights(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn the_weights_sum_to_one_and_blend_the_colours() {
        let facts = facts_of(
            r#"{"exhibit": "weights", "corners": [[0, 0], [4, 0], [0, 4]], "point": [1, 2],
                "colors": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}"#,
        );
        assert_eq!(facts["blends"][0]["weights"], json!([0.25, 0.25, 0.5]));
        assert_eq!(facts["blends"][0]["color"], json!([0.25, 0.25, 0.5]));
        assert_eq!(facts["blends"][0]["sum"], json!(1.0));
        assert_eq!(facts["blends"][0]["smallest"], json!(0.25));
    }

    #[test]
    fn the_smallest_weight_is_zero_on_an_edge_and_negative_outside() {
        for (point, smallest) in [([1, 0], 0.0), ([2, 2], 0.0), ([0, 0], 0.0), ([4, 4], -1.0), ([1, 1], 0.25)]
        {
            let question = json!({
                "exhibit": "weights", "corners": [[0, 0], [4, 0], [0, 4]], "point": point,
                "colors": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            });
            let facts = facts_of(&question.to_string());
            assert_eq!(facts["blends"][0]["smallest"], json!(smallest), "{point:?}");
            assert_eq!(facts["blends"][0]["is_inside"], json!(smallest >= 0.0), "{point:?}");
            assert_eq!(facts["blends"][0]["sum"], json!(1.0));
        }
    }

    #[test]
    fn four_corners_have_two_answers() {
        let facts = facts_of(
            r#"{"exhibit": "weights", "corners": [[0, 0], [4, 0], [4, 4], [0, 4]], "point": [2, 2],
                "colors": [[1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0]]}"#,
        );
        assert_eq!(facts["blends"][0]["color"], json!([1.0, 0.0, 0.0]));
        assert_eq!(facts["blends"][1]["color"], json!([0.0, 1.0, 0.0]));
        assert_eq!(facts["color_gap"], json!(1.0));
    }
}
