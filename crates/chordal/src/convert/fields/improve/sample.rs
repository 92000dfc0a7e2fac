//! Samples of primitives: signed distances to first order, and normals.
use super::FaceLabel;
use crate::implicit::{LeafError, PrimitiveEvaluator};
use glam::DVec3;

/// A primitive at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct PrimitiveSample {
    /// The value over the length of the gradient, positive outside; NaN if it is unknown.
    pub distance: f64,
    /// Outward; zero without a gradient.
    pub normal: DVec3,
}

pub(super) fn sample(
    evaluator: &mut PrimitiveEvaluator,
    queries: &[(FaceLabel, DVec3)],
) -> Result<Vec<PrimitiveSample>, LeafError> {
    let unlabelled: Vec<(u32, [f64; 3])> =
        queries.iter().map(|(label, at)| (label / 2, at.to_array())).collect();
    let slopes = evaluator.duals(&unlabelled)?;
    let labelled = |((label, _), slope): (&(FaceLabel, DVec3), &crate::implicit::Dual<f64>)| {
        let sign = if label % 2 == 1 { -1.0 } else { 1.0 };
        let gradient = sign * DVec3::from(slope.gradient);
        let size = gradient.length();
        let value = sign * slope.value;
        if size > 0.0 && size.is_finite() {
            PrimitiveSample { distance: value / size, normal: gradient / size }
        } else {
            // Without a gradient, the point is on the surface, or its distance is unknown.
            PrimitiveSample { distance: if value == 0.0 { 0.0 } else { f64::NAN }, normal: DVec3::ZERO }
        }
    };
    Ok(queries.iter().zip(&slopes).map(labelled).collect())
}
