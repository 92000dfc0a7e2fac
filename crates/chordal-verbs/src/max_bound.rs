//! `max_bound`: the bound of a scene from the bounds of its parts.
use crate::MeshFailure;
use crate::placements::scaled_up;
use chordal::budget::{Bound, Metric, Reference, RefusalCode};
use chordal::math::greater;

/// The larger of two bounds, of which the second is in the coordinates of a part.
pub(crate) fn max_bound(all: Bound, part: &Bound, stretch: f64) -> Result<Bound, MeshFailure> {
    let one_sided = [&all, part].iter().any(|bound| bound.metric == Metric::OneSided);
    let at_most = all.at_most().zip(part.at_most()).map(|(all, part)| {
        let part = scaled_up(part, stretch);
        greater(all, part)
    });
    if at_most.is_some_and(|most| !most.is_finite()) {
        return Err(MeshFailure::refused(
            RefusalCode::NotFinite,
            "the transforms of the scene take its coordinates out of range",
        ));
    }
    let evidence = all.evidence().weaker(part.evidence());
    let mut wider = Bound::with_evidence(0.0, at_most, evidence, Reference::InputTriangles);
    wider.metric = if one_sided { Metric::OneSided } else { Metric::Hausdorff };
    Ok(wider)
}
