//! Requests of a page about two cubics: joining them with a given continuity, their join, and the comb of
//! their curvature.
use crate::curve_request::{CurveRequest, CurveRequestError, Leader};
use chordal::Bezier;
use chordal::check::curves::{Join, Tooth, curvature_comb, join};
use chordal::explicit::CurveSegment;
use chordal::explicit::parametric::Continuity;
use serde_json::{Value, json};

/// The number of teeth of each comb. Chosen: dense enough to look like a curve.
const TEETH: usize = 40;

/// Answers `{"first", "second", "smoothness", "leader", "scale"}`.
pub(crate) fn curve_join(bytes: &[u8]) -> Result<Value, CurveRequestError> {
    let request = CurveRequest::parse(bytes, &["first", "second", "smoothness", "leader", "scale"])?;
    let curves = [request.cubic("first")?, request.cubic("second")?];
    let scale = request.number("scale", [0.0, 1e3])?;
    let curves = match request.smoothness("smoothness")? {
        Some(smoothness) => join_curves(curves, smoothness, request.leader("leader")?),
        None => curves,
    };
    let [first, second] = curves.map(CurveSegment::Cubic);
    Ok(json!({
        "first": curves[0].control,
        "second": curves[1].control,
        "join": join_json(&join([&first, &second], [1.0; 2], 1), curves),
        "comb": curves.map(|curve| comb(curve, scale)),
    }))
}

/// Changes the curve that does not lead.
fn join_curves([first, second]: [Bezier<2>; 2], smoothness: Continuity, leader: Leader) -> [Bezier<2>; 2] {
    match leader {
        Leader::First => [first, second.continuing(&first, smoothness)],
        Leader::Second => [first.reversed().continuing(&second.reversed(), smoothness).reversed(), second],
    }
}

fn join_json(join: &Join<2>, [before, after]: [Bezier<2>; 2]) -> Value {
    // Taken from combs of two teeth: their curvature has a sign, that of a join has none.
    let signed = |curve: Bezier<2>, t: f64| {
        curvature_comb(&curve.into(), 1, 0.0)
            .concat()
            .iter()
            .find(|tooth| tooth.place == t)
            .map(|tooth| tooth.curvature)
    };
    json!({
        "position_gap": join.position_gap,
        "angle_rad": join.angle_rad,
        "curvatures": [signed(before, 1.0), signed(after, 0.0)],
        "curvature_gap": join.curvature_gap,
        "parametric": join.parametric,
        "geometric": join.geometric,
    })
}

fn comb(curve: Bezier<2>, scale: f64) -> Vec<Value> {
    let tooth_json =
        |tooth: &Tooth| json!({ "on_curve": tooth.on_curve, "tip": tooth.tip, "curvature": tooth.curvature });
    curvature_comb(&curve.into(), TEETH, scale).iter().flatten().map(tooth_json).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined(first: &str, second: &str) -> Value {
        let rest = r#""smoothness": "none", "leader": "first", "scale": 1"#;
        curve_join(format!(r#"{{"first": {first}, "second": {second}, {rest}}}"#).as_bytes()).unwrap()["join"]
            .take()
    }

    #[test]
    fn curvatures_have_the_sign_of_the_turn() {
        // A left turn, then its image turned about the joint: an S, with one direction and opposite
        // curvatures.
        let right = "[[2, 2], [2, 3], [3, 4], [4, 4]]";
        let join = joined("[[0, 0], [1, 0], [2, 1], [2, 2]]", right);
        // 2/3 of the third control point's distance from the tangent over the square of the second one's.
        assert_eq!(join["curvatures"], json!([2.0 / 3.0, -2.0 / 3.0]));
        assert_eq!((join["geometric"].as_u64(), join["curvature_gap"].as_f64()), (Some(1), Some(4.0 / 3.0)));
        // A curve has no curvature at a point of zero speed.
        assert_eq!(joined("[[0, 0], [1, 0], [2, 2], [2, 2]]", right)["curvatures"][0], Value::Null);
    }
}
