//! The arrow from a curve to a field: the tube around it.
use super::curve_to_polyline;
use super::mesh_leaf::MeshLeaf;
use crate::budget::{Bounded, Budget, Failure, Job, JobError, RefusalCode};
use crate::explicit::{Curve, Mesh, Polyline};
use crate::implicit::{Distance, DistanceQuality, Expr, Field};
use crate::math::{Box3, add_up, sub_down};
use std::sync::Arc;

/// Builds the tube of a radius around a curve: all points nearer to the curve than the radius. A plane curve gives
/// a band of the plane, endless along z.
///
/// **Bound.** Two-sided Hausdorff distance between the curve and the polyline that replaces it, *proved*,
/// rounding included. Tubes of one radius around both are no farther apart.
///
/// **Value.** Outside, the exact distance to the polyline's tube; inside, a bound of it, since parts of a tube may
/// overlap. The error is a few roundings of the curve's extent.
///
/// **Budgets.** A length, pixels at a view, a number of segments. **Cost.** That of the polyline and of a tree of
/// boxes over it; O(log n) a point.
///
/// # Errors
/// [`Failure::Refused`]: a radius that is not a finite number above 0; as for [`curve_to_polyline`].
/// [`Failure::Unmet`] with the best field; [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Bezier, Budget, Job, Tolerance, convert::curve_to_field};
/// let arch = Bezier { control: [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]] };
/// let budget = Budget::length(Tolerance::new(1e-4).unwrap());
/// let tube = curve_to_field(&arch.into(), 0.125, &budget, &Job::default()).unwrap().shape;
/// let above = tube.expr().at([0.5, 0.75, 1.0]).unwrap();
/// assert!((above - 0.875).abs() < 1e-4);
/// ```
pub fn curve_to_field<const D: usize>(
    curve: &Curve<D>,
    radius: f64,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Field>, Failure<Field>> {
    if !(radius > 0.0 && radius.is_finite()) {
        let message = format!("a tube's radius is {radius}, and must be a finite number above 0");
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    match curve_to_polyline(curve, budget, job) {
        Ok(polyline) => field(polyline, radius, job),
        Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(field(*best, radius, job)?))),
        Err(Failure::Refused(refusal)) => Err(Failure::Refused(refusal)),
        Err(Failure::Cancelled) => Err(Failure::Cancelled),
    }
}

fn field<const D: usize>(
    flattened: Bounded<Polyline<D>>,
    radius: f64,
    job: &Job,
) -> Result<Bounded<Field>, Failure<Field>> {
    let polyline = &flattened.shape;
    let embedded = |p: &[f64; D]| std::array::from_fn(|k| if k < D { p[k] } else { 0.0 });
    let positions: Vec<[f64; 3]> = polyline.points.iter().map(embedded).collect();
    let n = positions.len() as u32;
    // A triangle with two equal corners is a segment, and one with three a point.
    let faces = if n == 1 {
        vec![[0; 3]]
    } else {
        (0..polyline.n_segments() as u32).map(|k| [k, (k + 1) % n, (k + 1) % n]).collect()
    };
    let mesh = Mesh::new(positions, faces)
        .map_err(|error| Failure::refused(RefusalCode::TooManyTriangles, error.to_string()))?;
    let leaf = MeshLeaf::unsigned(&mesh, job).map_err(|error| match error {
        JobError::Refused(refusal) => Failure::Refused(refusal),
        JobError::Cancelled => Failure::Cancelled,
    })?;
    let Box3 { min, max } = mesh.bounds();
    let mut bounds = Box3 { min: min.map(|x| sub_down(x, radius)), max: max.map(|x| add_up(x, radius)) };
    let mut coordinates = Expr::axes();
    if D < 3 {
        // A field of the plane is the same at every z.
        coordinates[2] = Expr::constant(0.0);
        (bounds.min[2], bounds.max[2]) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    let field = Field::new(Expr::leaf(Arc::new(leaf), coordinates) - radius)
        .known_distance(Distance { outside: DistanceQuality::Exact, inside: DistanceQuality::Bound })
        .known_bounds(bounds);
    Ok(flattened.map(|_| field))
}
