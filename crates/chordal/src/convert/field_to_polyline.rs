//! The arrow from a field of the plane to its level curve: `field_to_polyline`.
use super::contours::{ContourGoal, outline_lines, search};
use super::length_from_pixels::length_from_pixels;
use crate::budget::{Bounded, Budget, Failure, Job, RefusalCode, RequiredEvidence, Tolerance};
use crate::explicit::Polyline;
use crate::implicit::Field;
use crate::math::{Box3, flushes_subnormals, lesser};

/// Traces the curve of a field in the plane z = 0, the boundary of where it is negative, within a budget. The
/// polylines are closed, with inside on their left.
///
/// Where the curve consists of lines and circular arcs, as that of rectangles, polygons, discs and their unions,
/// intersections and differences does, the lines are the outline itself: a segment for each side, with its corners up
/// to rounding, and as many for an arc as its sagitta asks for. Everything else is found by marching squares on a
/// lattice that is fine enough; what is straight up to the rest of the budget becomes one segment.
///
/// *What the bound covers.* The Hausdorff distance between all points of the lines and all points of the
/// curve, both ways, proved by ranges for the exact numbers of the lines (`convert/contours/prove.rs`), and
/// for lines and arcs by their crossings (`plane_outline.rs`; where two shapes meet along a line, nothing is
/// left between them: [`Csg`](crate::implicit::csg::Csg)). The rule is [`Field::sign`], and [`Field::bounds`]
/// is taken at its word. Where a leaf knows no ranges, the budget is aimed at and the result measured; that
/// needs [`RequiredEvidence::Measured`].
///
/// Lines never end: points outside of the field's bounds count as outside, so that the sides of a region
/// close a shape that it cuts off. The budget is a length, pixels at a view, a number of segments, or several
/// of them.
///
/// *Cost.* Proportional to the length of the curve over the size of squares, times the terms of the
/// expression that matter there; of lines and arcs, to the cube of their number, which is 400 at most.
///
/// # Errors
/// [`Failure::Unmet`] with the best lines; refusals with [`RefusalCode::Empty`] where the field is nowhere
/// negative, [`RefusalCode::Unsupported`] without finite bounds along x and y or for an angle,
/// [`RefusalCode::Budget`], [`RefusalCode::TooMuchMemory`], [`RefusalCode::LeafFailed`];
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Budget, Job, Tolerance, convert::field_to_polyline, implicit::{Expr, Field}, math::Box3};
/// let [x, y, _] = Expr::axes();
/// let ring = ((x.square() + y.square()).sqrt() - 0.75).abs() - 0.125;
/// let ring = Field::new(ring).with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let made = field_to_polyline(&ring, &Budget::length(Tolerance::new(1e-3)?), &Job::default())?; // a thousandth
/// assert!(made.shape.len() == 2 && made.shape.iter().all(|line| line.closed));
/// assert!(made.bound.at_most().unwrap() <= 1e-3); // a thousandth
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
    let seen = budget.pixels.as_ref().map(|px| length_from_pixels(&bounds, px)).transpose()?;
    let length = match (budget.length.map(Tolerance::get), seen) {
        (Some(a), Some(b)) => Some(lesser(a, b)),
        (a, b) => a.or(b),
    };
    let is_length = length.is_none_or(|length| length > 0.0);
    if length.is_none() && budget.segments.is_none() || !is_length {
        return refused(RefusalCode::Budget, "the budget leaves no length, and no number of segments");
    }
    let wanted = ContourGoal {
        length,
        segments: budget.segments,
        measured: budget.require != RequiredEvidence::Proved,
    };
    let field = field.clone().known_bounds(bounds);
    let mut made =
        job.run(|| outline_lines(&field, &wanted, job).unwrap_or_else(|| search(&field, &wanted, job)))?;
    if let (Some(px), Some(most)) = (budget.pixels, made.bound.at_most()) {
        let about = Box3 { min: bounds.min.map(|x| x - most), max: bounds.max.map(|x| x + most) };
        made.bound.pixels = px.view.pixels_of(most, &about);
    }
    Ok(made)
}
