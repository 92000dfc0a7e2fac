//! The arrow from an outline to a field of the plane.
use super::curves::flatten::Spacing;
use super::{contours_to_field, curves_to_polylines};
use crate::budget::{Bounded, Budget, Failure, Job};
use crate::explicit::{Outline, Polyline};
use crate::implicit::Field;

/// The area that an outline encloses, as a field of the plane, endless along z: [`Field::extruded`] gives it a
/// height, [`Field::revolved`] turns it about an axis.
///
/// **Bound.** Two-sided Hausdorff distance between each contour and the closed polygon that replaces it,
/// *proved*, rounding included. So the field's shape and the outline's differ only at points no farther than
/// the bound from a contour. Contours that consist of straight lines have the bound 0.
///
/// **Value.** The exact distance to the polygons; polygons that are no border (inside another of the same direction) are
/// left out. If polygons cross or overlap, the filled area is computed first, and the bound includes the error of that:
/// see [`contours_to_field`](super::contours_to_field).
///
/// **Budgets.** A length, pixels at a view, a number of segments. **Cost.** That of the polylines, and O(n log n);
/// then O(log n) a point.
///
/// # Errors
/// [`Failure::Refused`]: as for [`curves_to_polylines`]; if the contours enclose nothing.
/// [`Failure::Unmet`] with the best field; [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Bezier, Budget, Job, Tolerance, convert::outline_to_field};
/// use chordal::explicit::{FillRule, Outline};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let outline = Outline { contours: vec![arch.into()], rule: FillRule::NonZero };
/// let budget = Budget::length(Tolerance::new(1e-3).unwrap());
/// let bounded = outline_to_field(&outline, &budget, &Job::default()).unwrap();
/// let solid = bounded.shape.extruded(0.5).unwrap();
/// let depth = -solid.expr().at([0.5, 0.5, 0.0]).unwrap();
/// assert!((depth - 0.25).abs() < 1e-3);
/// ```
pub fn outline_to_field(
    outline: &Outline,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Field>, Failure<Field>> {
    match curves_to_polylines(&outline.contours, budget, job, Spacing::Fewest) {
        Ok(polylines) => field(polylines, outline, job),
        Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(field(*best, outline, job)?))),
        Err(Failure::Refused(refusal)) => Err(Failure::Refused(refusal)),
        Err(Failure::Cancelled) => Err(Failure::Cancelled),
    }
}

fn field(
    polylines: Bounded<Vec<Polyline<2>>>,
    outline: &Outline,
    job: &Job,
) -> Result<Bounded<Field>, Failure<Field>> {
    let points: Vec<Vec<[f64; 2]>> = polylines.shape.iter().map(|polyline| polyline.points.clone()).collect();
    let resolved = contours_to_field(&points, outline.rule, job)?;
    let bound = polylines.bound.then(&resolved.bound);
    Ok(Bounded { shape: resolved.shape, bound })
}
