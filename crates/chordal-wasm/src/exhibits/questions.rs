//! The six questions at the end, each with a number that another exhibit's function computes.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use chordal::Bezier;
use chordal::check::curves::join;
use chordal::explicit::CurveSegment;
use serde_json::{Value, json};

/// Answers `{}`: a number or two for each question.
pub(super) fn questions(asked: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    asked.only(&[])?;
    let square = json!([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.9]]);
    let quad = facts(json!({ "exhibit": "quad", "corners": square }))?;
    let cube = facts(json!({ "exhibit": "normals", "shape": "cube", "crease_deg": 30 }))?;
    let round = facts(json!({ "exhibit": "normals", "shape": "cube", "crease_deg": 180 }))?;
    let ball = facts(json!({ "exhibit": "culling", "shape": "ball", "flipped": [], "eye": [3, -4, 2] }))?;
    let field = facts(json!({ "exhibit": "field", "point": [8.2, 5.9], "length": 0.02 }))?;
    let small = facts(json!({ "exhibit": "overshade", "side": 0.7 }))?;
    let large = facts(json!({ "exhibit": "overshade", "side": 16 }))?;
    // Two arcs of one direction and speed where they meet, of which the second bends the other way.
    let before = Bezier { control: [[0.0, 0.0], [1.0, 2.0], [3.0, 3.0], [5.0, 3.0]] };
    let after = Bezier { control: [[5.0, 3.0], [7.0, 3.0], [9.0, 4.0], [10.0, 6.0]] };
    let met = join([&CurveSegment::Cubic(before), &CurveSegment::Cubic(after)], [1.0; 2], 1);
    Ok(ExhibitAnswer::new(json!({
        "triangles": [quad["corner_height"], quad["bulge"]],
        "normals": [round["vertices"], cube["vertices"]],
        "winding": ball["back_share"],
        "joins": { "class": met.parametric, "curvatures": met.curvatures, "gap": met.curvature_gap },
        "fields": { "edges": field["mesh"]["edges"], "bound": field["mesh"]["bound"] },
        "cost": [large["ratio"], small["ratio"]],
    })))
}

fn facts(question: Value) -> Result<Value, String> {
    Ok(super::answered(question.to_string().as_bytes())?.facts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_question_has_its_number() {
        let facts = facts(json!({ "exhibit": "questions" })).unwrap();
        assert_eq!(facts["triangles"], json!([0.0, 0.9]));
        assert_eq!(facts["normals"], json!([8, 24]));
        assert!((0.4..0.65).contains(&facts["winding"].as_f64().unwrap()));
        assert_eq!(facts["joins"]["class"], 1);
        assert!(facts["joins"]["gap"].as_f64() > Some(0.1));
        assert!(facts["fields"]["edges"].as_u64().unwrap() > 20);
        assert!(facts["cost"][0].as_f64() < Some(1.5) && facts["cost"][1].as_f64() > Some(3.5));
    }
}
