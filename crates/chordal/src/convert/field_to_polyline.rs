//! The arrow from a field of the plane to its level curve: `field_to_polyline`.
use super::budget_search::length_from_pixels;
use super::contours::{ContourGoal, outline_lines, search};
use crate::budget::{Bounded, Budget, Failure, Job, RefusalCode, RequiredEvidence, Tolerance};
use crate::explicit::Polyline;
use crate::implicit::Field;
use crate::math::{Box3, flushes_subnormals, lesser};

/// Traces the curve of a field in the plane z = 0, the boundary of the region where it is negative, within a budget.
/// The polylines are closed, with inside on their left.
///
/// If the curve consists of lines and circular arcs, as for rectangles, polygons, discs and their unions,
/// intersections and differences, the polylines are the outline itself: a segment for each side, with corners exact up
/// to rounding, and as many segments for an arc as its sagitta requires. All other curves are traced by marching
/// squares on a lattice that is fine enough; runs that are straight within the rest of the budget become one segment.
///
/// *What the bound covers.* The Hausdorff distance between all points of the lines and all points of the
/// curve, both ways, proved by interval evaluation for the exact numbers of the lines (`convert/contours/prove.rs`),
/// and for lines and arcs by their crossings (`plane_outline.rs`; if two shapes meet along a line, no gap is
/// left between them: [`Csg`](crate::implicit::csg::Csg)). Inside is decided by [`Field::sign`], and
/// [`Field::bounds`] is trusted. If a leaf has no interval evaluation, the budget is a target only, and the result is
/// measured; that needs [`RequiredEvidence::Measured`].
///
/// Lines have no loose ends: points outside of the field's bounds count as outside, so that a shape that the bounds
/// cut off is closed along their sides. The budget is a length, pixels at a view, a number of segments, or several
/// of these.
///
/// *Cost.* Proportional to the length of the curve over the size of the squares, times the terms of the
/// expression that are undecided there; for lines and arcs, to the cube of their number, which is 400 at most.
///
/// # Errors
/// [`Failure::Unmet`] with the best lines; refusals with [`RefusalCode::Empty`] if the field is nowhere
/// negative, [`RefusalCode::Unsupported`] without finite bounds along x and y or for an angle,
/// [`RefusalCode::Budget`], [`RefusalCode::TooMuchMemory`], [`RefusalCode::LeafFailed`];
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Budget, Job, Tolerance, convert::field_to_polyline, implicit::{Expr, Field}, math::Box3};
/// let [x, y, _] = Expr::axes();
/// let ring = ((x.square() + y.square()).sqrt() - 0.75).abs() - 0.125;
/// let ring = Field::new(ring).with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let bounded = field_to_polyline(&ring, &Budget::length(Tolerance::new(1e-3)?), &Job::default())?; // a thousandth
/// assert!(bounded.shape.len() == 2 && bounded.shape.iter().all(|line| line.closed));
/// assert!(bounded.bound.at_most().unwrap() <= 1e-3); // a thousandth
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sources: W. Lorensen, H. Cline, *Marching cubes*, 1987, one dimension down; pruning by ranges: T. Duff,
/// *Interval arithmetic and recursive subdivision for implicit functions and constructive solid
/// geometry*, 1992.
pub fn field_to_polyline(
    field: &Field,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Vec<Polyline<2>>>, Failure<Vec<Polyline<2>>>> {
    let refused = |code, message: &str| Err(Failure::refused(code, message));
    let Box3 { min, max } = field.bounds();
    let bounds = Box3 { min: [min[0], min[1], 0.0], max: [max[0], max[1], 0.0] };
    if flushes_subnormals() {
        return refused(
            RefusalCode::FlushesSubnormals,
            "the floating-point environment flushes subnormal numbers, so that nothing can be proved",
        );
    }
    if field.bounds().is_empty() || min[2] > 0.0 || max[2] < 0.0 {
        return refused(
            RefusalCode::Empty,
            "there is no curve: the box of the shape is empty, or does not reach z = 0",
        );
    }
    if !bounds.diagonal().is_finite() {
        return refused(
            RefusalCode::Unsupported,
            "the shape has no finite bounds along x and y: cut it off with a box",
        );
    }
    if budget.angle_deg.is_some() {
        return refused(RefusalCode::Unsupported, "an angle is no budget for fields in this version");
    }
    let from_pixels = budget.pixels.as_ref().map(|px| length_from_pixels(&bounds, px)).transpose()?;
    let length = match (budget.length.map(Tolerance::get), from_pixels) {
        (Some(a), Some(b)) => Some(lesser(a, b)),
        (a, b) => a.or(b),
    };
    let is_length = length.is_none_or(|length| length > 0.0);
    if length.is_none() && budget.segments.is_none() || !is_length {
        return refused(RefusalCode::Budget, "the budget leaves no length, and no number of segments");
    }
    let goal = ContourGoal {
        length,
        segments: budget.segments,
        measured: budget.require != RequiredEvidence::Proved,
    };
    let field = field.clone().known_bounds(bounds);
    let mut lines =
        job.run(|| outline_lines(&field, &goal, job).unwrap_or_else(|| search(&field, &goal, job)))?;
    if let (Some(px), Some(most)) = (budget.pixels, lines.bound.at_most()) {
        // The lines may leave the box by as much.
        let hull = Box3 { min: bounds.min.map(|x| x - most), max: bounds.max.map(|x| x + most) };
        lines.bound.pixels = px.view.pixels_of(most, &hull);
    }
    Ok(lines)
}
