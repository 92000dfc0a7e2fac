//! The arrow from outlines to solids: the filled areas, extruded from the plane z = 0 to a height.
use super::budget_search::length_within;
use super::outlines_to_mesh::ClosedOutlines;
use crate::budget::{Bounded, Budget, Failure, Job, RefusalCode};
use crate::explicit::{Mesh, Outline};

/// Beyond this, squares of differences leave the range of numbers, as in the plane.
pub(super) const LARGEST: f64 = 1e150;

/// Turns outlines into upright solids between the planes z = 0 and z = `height`: two caps with the triangles of
/// [`outlines_to_mesh`](super::outlines_to_mesh), and walls of two triangles a side between their boundaries.
///
/// **Bound.** Two-sided Hausdorff distance between the wall over each contour and the wall over the closed polyline
/// that replaces it, *proved*, rounding included: it is the distance of the two in the plane, since both are
/// extruded to the same height, which is exact. So a point inside only one of the two solids, the mesh and the exact
/// solid over the outline, is no farther than the bound from the wall over a contour.
///
/// **Triangles.** Each edge has two triangles, which run along it in opposite directions, and all face outwards.
/// Where an area touches itself in a point, the vertices there are doubled, so that each vertex has one fan of
/// triangles; by position four walls meet there. Solids of different outlines stay separate.
///
/// **Budgets.** As for [`outlines_to_mesh`](super::outlines_to_mesh); pixels are measured where the solid is nearest to
/// the eye.
///
/// # Errors
/// [`Failure::Refused`]: as for [`outlines_to_mesh`](super::outlines_to_mesh); a height that is not above 0 or
/// not below 1e150. [`Failure::Unmet`] with the best mesh; [`Failure::Cancelled`].
///
/// ```
/// use chordal::explicit::{Curve, CurveEnds, CurveSegment, FillRule, Outline};
/// use chordal::{Budget, Job, Tolerance, convert};
/// let corners = [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.0, 0.0]];
/// let sides = corners.windows(2).map(|ends| CurveSegment::Line([ends[0], ends[1]])).collect();
/// let outline = Outline { contours: vec![Curve::new(sides, CurveEnds::Closed)?], rule: FillRule::NonZero };
/// let budget = Budget::length(Tolerance::new(1e-3)?);
/// let wedge = convert::outlines_to_solid(&[outline], 3.0, &budget, &Job::default()).expect("reachable").shape;
/// assert_eq!(wedge.faces().len(), 8);
/// assert!((chordal::check::findings::measure(&wedge).signed_volume - 6.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn outlines_to_solid(
    outlines: &[Outline],
    height: f64,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    if !(height > 0.0 && height < LARGEST) {
        let message =
            format!("a solid over outlines has a height above 0 and below {LARGEST:e}, not {height}");
        return Err(Failure::refused(RefusalCode::Budget, message));
    }
    let outlines = ClosedOutlines::new(outlines, Some(height))?;
    let Some(px) = budget.pixels else { return outlines.mesh(budget, job) };
    // The walls may be nearer to the eye than the plane in which the curves are flattened.
    let length = length_within(budget, outlines.bounds(), "solid")?;
    let by_length = Budget { length, pixels: None, ..*budget };
    let in_pixels = |mut mesh: Bounded<Mesh>| {
        let most = mesh.bound.at_most();
        mesh.bound.pixels = most.and_then(|most| px.view.pixels_of(most, outlines.bounds()));
        mesh
    };
    match outlines.mesh(&by_length, job) {
        Ok(mesh) => Ok(in_pixels(mesh)),
        Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(in_pixels(*best)))),
        Err(other) => Err(other),
    }
}
