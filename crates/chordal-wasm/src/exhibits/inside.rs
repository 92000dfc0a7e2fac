//! Point in triangle by three edge functions.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use chordal::explicit::Triangle;
use chordal::math::exact::{Orientation, PointInTriangle};
use serde_json::json;

/// Answers `{"corners": [[x, y] × 3], "point": [x, y]}`: the three edge functions, their exact signs, and the
/// position of the point.
pub(super) fn inside(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["corners", "point"])?;
    let corners = request.points::<2>("corners", [3, 3])?;
    let point = request.point::<2>("point")?;
    let [a, b, c] = [corners[0], corners[1], corners[2]];
    let triangle = Triangle { corners: [a, b, c] };
    let side = |from, to| match chordal::math::exact::orient2d(from, to, point) {
        Orientation::Front => "left",
        Orientation::Flat => "on",
        Orientation::Back => "right",
    };
    Ok(ExhibitAnswer::new(json!({
        "edge_functions": triangle.edge_functions(point),
        // Opposite to the corners, as the edge functions are.
        "sides": [side(b, c), side(c, a), side(a, b)],
        "position": match triangle.position(point) {
            PointInTriangle::Inside => "inside",
            PointInTriangle::Boundary => "boundary",
            PointInTriangle::Outside => "outside",
        },
        "signed_area": triangle.signed_area(),
    })))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_inside_where_all_three_have_one_sign_whichever_way_the_corners_run() {
        for (corners, sides) in [("[[0, 0], [4, 0], [0, 4]]", "left"), ("[[0, 0], [0, 4], [4, 0]]", "right")]
        {
            let question = format!(r#"{{"exhibit": "inside", "corners": {corners}, "point": [1, 1]}}"#);
            let facts = inside(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts;
            assert_eq!((&facts["position"], &facts["sides"]), (&json!("inside"), &json!(vec![sides; 3])));
        }
    }
}
