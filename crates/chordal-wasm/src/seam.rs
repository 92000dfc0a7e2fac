//! What a page asks about two cubics that meet: made to meet smoothly, and with the comb of their curvature.
use crate::question::{Leader, Question, Wrong};
use chordal::check::{Tooth, curvature_comb};
use chordal::explicit::{Curve, Piece};
use serde_json::{Value, json};

/// Teeth of the comb of each curve.
const TEETH: usize = 48;

/// Answers `{"first", "second", "smoothness", "leader", "scale"}`.
pub(crate) fn seam(bytes: &[u8]) -> Result<Value, Wrong> {
    let asked = Question::parse(bytes, &["first", "second", "smoothness", "leader", "scale"])?;
    let (first, second) = (asked.cubic("first")?, asked.cubic("second")?);
    let smoothness = asked.smoothness("smoothness")?;
    let scale = asked.number("scale", [0.0, 1e3])?;
    let (first, second) = match asked.leader("leader")? {
        Leader::First => (first, second.continuing(&first, smoothness)),
        Leader::Second => (first.reversed().continuing(&second.reversed(), smoothness).reversed(), second),
    };
    let curve = Curve::new(vec![Piece::Cubic(first), Piece::Cubic(second)], false)
        .map_err(|error| error.to_string())?;
    let comb = curvature_comb(&curve, TEETH, scale);
    let comb: Vec<Vec<Value>> = comb.iter().map(|teeth| teeth.iter().map(told).collect()).collect();
    Ok(json!({ "first": first.control, "second": second.control, "comb": comb }))
}

fn told(tooth: &Tooth) -> Value {
    json!({ "on_curve": tooth.on_curve, "tip": tooth.tip, "curvature": tooth.curvature })
}
