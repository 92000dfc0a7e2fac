//! The arrow from an outline to a field of the plane.
use super::curves::flatten::Spacing;
use super::{contours_to_field, curves_to_polylines};
use crate::budget::{Bounded, Budget, Failure, Job};
use crate::explicit::{Outline, Polyline};
use crate::implicit::Field;

/// Makes a field of the plane from what an outline encloses, endless along z: [`Field::extruded`] gives it a
/// height, [`Field::revolved`] turns it.
///
/// **Bound.** Two-sided Hausdorff distance between each contour and the closed polygon that replaces it,
/// *proved*, rounding included. So the field's shape and the outline's differ only at points no farther than
/// the bound from a contour. Contours of straight lines alone have the bound 0.
///
/// **Value.** The exact distance to the polygons; those that bound nothing (one in another of the same direction) are left
/// out. Where polygons cross or overlap, what they fill is found first, and the bound counts what that costs: see
/// [`contours_to_field`](super::contours_to_field).
///
/// **Budgets.** A length, pixels at a view, a number of segments. **Cost.** The polylines, and O(n log n);
/// O(log n) a point.
///
/// # Errors
/// [`Failure::Refused`]: as for [`curves_to_polylines`]; when the contours enclose nothing.
/// [`Failure::Unmet`] with the best; [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Bezier, Budget, Job, Tolerance, convert::outline_to_field};
/// use chordal::explicit::{FillRule, Outline};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let outline = Outline { contours: vec![arch.into()], rule: FillRule::NonZero };
/// let budget = Budget::length(Tolerance::new(1e-3).unwrap());
/// let made = outline_to_field(&outline, &budget, &Job::default()).unwrap();
/// let solid = made.shape.extruded(0.5).unwrap();
/// let depth = -solid.expr().at([0.5, 0.5, 0.0]).unwrap();
/// assert!((depth - 0.25).abs() < 1e-3);
/// ```
pub fn outline_to_field(
    outline: &Outline,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Field>, Failure<Field>> {
    match curves_to_polylines(&outline.contours, budget, job, Spacing::Fewest) {
        Ok(made) => field(made, outline, job),
        Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(field(*best, outline, job)?))),
        Err(Failure::Refused(refusal)) => Err(Failure::Refused(refusal)),
        Err(Failure::Cancelled) => Err(Failure::Cancelled),
    }
}

fn field(
    made: Bounded<Vec<Polyline<2>>>,
    outline: &Outline,
    job: &Job,
) -> Result<Bounded<Field>, Failure<Field>> {
    let points: Vec<Vec<[f64; 2]>> = made.shape.iter().map(|polyline| polyline.points.clone()).collect();
    let resolved = contours_to_field(&points, outline.rule, job)?;
    let bound = made.bound.then(&resolved.bound);
    Ok(Bounded { shape: resolved.shape, bound })
}
