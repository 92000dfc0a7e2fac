//! What a page asks about two cubics: made to meet as smoothly as is wished, how they meet, and the comb of
//! their curvature.
use crate::curve_request::{CurveRequest, CurveRequestError, Leader};
use chordal::Bezier;
use chordal::check::curves::{Join, Tooth, curvature_comb, join};
use chordal::explicit::CurveSegment;
use chordal::explicit::parametric::Continuity;
use serde_json::{Value, json};

/// Teeth of the comb of each curve.
const TEETH: usize = 40;

/// Answers `{"first", "second", "smoothness", "leader", "scale"}`.
pub(crate) fn curve_join(bytes: &[u8]) -> Result<Value, CurveRequestError> {
    let asked = CurveRequest::parse(bytes, &["first", "second", "smoothness", "leader", "scale"])?;
    let curves = [asked.cubic("first")?, asked.cubic("second")?];
    let scale = asked.number("scale", [0.0, 1e3])?;
    let curves = match asked.smoothness("smoothness")? {
        Some(smoothness) => join_curves(curves, smoothness, asked.leader("leader")?),
        None => curves,
    };
    let [first, second] = curves.map(CurveSegment::Cubic);
    Ok(json!({
        "first": curves[0].control,
        "second": curves[1].control,
        "join": join_json(&join([&first, &second], [1.0; 2], 1)),
        "comb": curves.map(|curve| comb(curve, scale)),
    }))
}

/// The curve that does not lead is changed.
fn join_curves([first, second]: [Bezier<2>; 2], smoothness: Continuity, leader: Leader) -> [Bezier<2>; 2] {
    match leader {
        Leader::First => [first, second.continuing(&first, smoothness)],
        Leader::Second => [first.reversed().continuing(&second.reversed(), smoothness).reversed(), second],
    }
}

fn join_json(join: &Join<2>) -> Value {
    json!({
        "position_gap": join.position_gap,
        "angle_rad": join.angle_rad,
        "curvatures": join.curvatures,
        "curvature_gap": join.curvature_gap,
        "parametric": join.parametric,
        "geometric": join.geometric,
    })
}

fn comb(curve: Bezier<2>, scale: f64) -> Vec<Value> {
    let told =
        |tooth: &Tooth| json!({ "on_curve": tooth.on_curve, "tip": tooth.tip, "curvature": tooth.curvature });
    curvature_comb(&curve.into(), TEETH, scale).iter().flatten().map(told).collect()
}
