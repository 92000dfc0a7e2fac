//! `snap_with_bound`: rounds a mesh to the positions of a format, with a bound that covers the rounding.
use crate::MeshFailure;
use crate::format_rounding::RoundingTarget;
use chordal::budget::{Bound, Bounded, PixelBudget, Reference};
use chordal::explicit::Topology;
use chordal::{Job, Mesh, mend};

/// Rounds a mesh to the precision of a format, or to a lattice, and adds the displacement to the bound.
///
/// Pixels add as lengths do: a point of the true shape moves on the screen to its point of the mesh, and from there to the
/// rounded point. Faces that rounding left without area are dropped, and their neighbours keep the surface closed; if a
/// face covers points that no other face is near, all of them stay. Sheets that are nearer to each other than the format's
/// digits can represent are kept apart by the last digit, so that a manifold stays a manifold.
pub(crate) fn snap_with_bound(
    mesh: &Mesh,
    bound: Bound,
    to: RoundingTarget,
    pixels: Option<PixelBudget>,
    job: &Job,
) -> Result<Bounded<Mesh>, MeshFailure> {
    let snapped = to.snap_apart(mesh)?;
    if snapped.moved_at_most == 0.0 {
        return Ok(Bounded { shape: snapped.mesh, bound });
    }
    let mut cleaned = mend::drop_degenerate(&snapped.mesh, Topology::Positions, job)?;
    // A face flattened by rounding is no farther from its neighbours than it moved; a face that is had no area before.
    if cleaned.bound.at_most().is_none_or(|most| most > snapped.moved_at_most) {
        cleaned.bound = Bound::exact(Reference::InputTriangles);
        cleaned.mesh = snapped.mesh;
    }
    let step = Bound::proved(0.0, snapped.moved_at_most, Reference::InputTriangles).then(&cleaned.bound);
    let moved_at_most = step.at_most().unwrap_or(f64::INFINITY);
    let moved_px = pixels.and_then(|px| px.view.pixels_of(moved_at_most, &mesh.bounds()));
    let mut chain = bound.then(&step);
    // The rounding of normals is negligible at realistic angles.
    chain.angle_deg = bound.angle_deg;
    let two_steps = |px: PixelBudget| px.view.pixels_of_two_steps(bound.pixels?, moved_px?);
    chain.pixels = pixels.and_then(two_steps);
    Ok(Bounded { shape: cleaned.mesh, bound: chain })
}
