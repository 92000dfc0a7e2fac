//! The cross product of two edges: the normal of a triangle, and twice its area.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use chordal::explicit::Triangle;
use chordal::math::exact::{Orientation, orient3d};
use serde_json::json;

/// Answers `{"corners": [[x, y, z] × 3], "eye": [x, y, z]}`: the edges from the first corner, their cross
/// product, its half length, which is the area, and the side that the eye sees.
pub(super) fn cross(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["corners", "eye"])?;
    let corners = request.points::<3>("corners", [3, 3])?;
    let eye = request.point::<3>("eye")?;
    let [a, b, c] = [corners[0], corners[1], corners[2]];
    let triangle = Triangle { corners: [a, b, c] };
    let edge = |to: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| to[k] - a[k]) };
    let (area, normal) = (triangle.area(), triangle.normal());
    Ok(ExhibitAnswer::new(json!({
        "edges": [edge(b), edge(c)],
        "fourth": std::array::from_fn::<f64, 3, _>(|k| b[k] + edge(c)[k]),
        "normal": normal,
        "product": normal.map(|n| n.map(|x| 2.0 * area * x)),
        "area": area,
        "seen": match orient3d(a, b, c, eye) {
            Orientation::Front => "front",
            Orientation::Back => "back",
            Orientation::Flat => "edge",
        },
    })))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_product_turns_round_with_the_winding_and_its_half_length_is_the_area() {
        for (corners, z, seen) in [
            ([[0, 0, 0], [3, 0, 0], [1, 2, 0]], 6.0, "front"),
            ([[0, 0, 0], [1, 2, 0], [3, 0, 0]], -6.0, "back"),
        ] {
            let question = json!({ "exhibit": "cross", "corners": corners, "eye": [0, 0, 5] });
            let facts =
                cross(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts;
            assert_eq!((&facts["product"], &facts["area"]), (&json!([0.0, 0.0, z]), &json!(3.0)));
            assert_eq!(facts["seen"], json!(seen));
        }
    }

    #[test]
    fn edges_on_one_line_have_no_normal() {
        let question =
            json!({ "exhibit": "cross", "corners": [[0, 0, 0], [1, 1, 1], [3, 3, 3]], "eye": [0, 0, 5] });
        let facts = cross(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts;
        assert_eq!((&facts["product"], &facts["area"]), (&json!(null), &json!(0.0)));
    }
}
