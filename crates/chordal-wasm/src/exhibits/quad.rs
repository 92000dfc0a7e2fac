//! A triangle is planar, a quad may bulge.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use chordal::explicit::polygons::{Diagonal, Quad};
use chordal::explicit::{Triangle, interpolate};
use serde_json::json;

/// Answers `{"corners": [[x, y, z] × 4]}`: the distance of the fourth corner from the plane of the others,
/// and the two surfaces that the corners may mean.
pub(super) fn quad(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["corners"])?;
    let corners = request.points::<3>("corners", [4, 4])?;
    let [a, b, c, d] = [corners[0], corners[1], corners[2], corners[3]];
    let quad = Quad { corners: [a, b, c, d] };
    let triangle = Triangle { corners: [a, b, c] };
    let middle = |from: [f64; 3], to: [f64; 3]| {
        let mut at = [0.0; 3];
        interpolate([&from, &to, &to], [0.5, 0.5, 0.0], &mut at);
        at
    };
    let middles = [middle(a, c), middle(b, d)];
    Ok(ExhibitAnswer::new(json!({
        "bulge": quad.bulge(),
        "is_flat": quad.is_flat(),
        "warp": quad.warp(),
        "bends_deg": quad.bends_rad().map(|bend| bend.map(f64::to_degrees)),
        "flattest": match quad.flattest() { Diagonal::First => "first", Diagonal::Second => "second" },
        "triangles": [Diagonal::First.triangles(), Diagonal::Second.triangles()],
        "middles": middles,
        // The height of the second diagonal's middle above the first one's.
        "middle_rise": middles[1][2] - middles[0][2],
        "corner_height": triangle.height_of(c),
    })))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(height: f64) -> serde_json::Value {
        let question = format!(
            r#"{{"exhibit": "quad", "corners": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, {height}]]}}"#
        );
        quad(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn three_corners_are_always_flat_and_four_only_where_the_fourth_lies_in_their_plane() {
        assert_eq!((&facts_of(0.0)["bulge"], &facts_of(0.0)["is_flat"]), (&json!(0.0), &json!(true)));
        let bent = facts_of(0.5);
        assert_eq!((&bent["bulge"], &bent["is_flat"]), (&json!(0.5), &json!(false)));
        assert_eq!((&bent["middle_rise"], &bent["corner_height"]), (&json!(0.25), &json!(0.0)));
    }
}
