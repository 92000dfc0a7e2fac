//! The arrow from a field to triangles.
use super::fields::{Wanted, search};
use crate::budget::{Bounded, Budget, Code, Failure, Job, PixelBudget, Require, Tolerance};
use crate::explicit::Mesh;
use crate::implicit::Field;
use crate::math::{Box3, flushes_subnormals};

/// The surface of a field, the boundary of where it is negative, as triangles within a budget: marching cubes on a lattice
/// that is fine enough.
///
/// *What the bound covers.* The Hausdorff distance between all points of the triangles and all points of the field's
/// surface, proved by [`crate::check::field_deviation`] for the very numbers of the mesh, with [`Field::sign`] as the rule and
/// [`Field::bounds`] at its word. Sharp edges of the shape are bevelled by the cells, which the bound counts like everything else. Parts of the
/// surface that fall between the points of the lattice are found by the proof and make cells smaller until they
/// are met. Where a leaf of the field knows no ranges the budget's length is aimed at and the result measured; that needs
/// [`Require::Measured`].
///
/// The mesh is always closed, manifold and oriented outward. A length, pixels at a view, and a number of triangles can be asked for, also
/// together.
///
/// *Cost.* Proportional to the triangles and to the terms of the expression that matter in each brick of cells; the error falls
/// with the square of the cells' size where the shape is smooth, and with the size itself at sharp edges.
///
/// # Errors
/// [`Failure::Unmet`] with the best mesh; refusals with [`Code::Empty`] where the field is nowhere negative, [`Code::Unsupported`] without
/// finite bounds, [`Code::Budget`], [`Code::TooManyTriangles`] and [`Code::TooMuchMemory`] before the work, [`Code::LeafFailed`];
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::implicit::{Expr, Field};
/// use chordal::math::Box3;
/// use chordal::{Budget, Job, Tolerance, check, convert, explicit::Topology};
/// let [x, y, z] = Expr::axes();
/// let ball = Field::new((x.square() + y.square() + z.square()).sqrt() - 1.0)
///     .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let made = convert::field_to_mesh(&ball, &Budget::length(Tolerance::new(0.01)?), &Job::default())?;
/// assert!(made.bound.at_most().unwrap() <= 0.01);
/// assert!(check::validity(&made.shape, Topology::Indices).closed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sources: W. Lorensen, H. Cline, *Marching cubes*, 1987; pruning by ranges: T. Duff, *Interval arithmetic and recursive
/// subdivision for implicit functions and constructive solid geometry*, 1992.
pub fn field_to_mesh(field: &Field, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let bounds = field.bounds();
    if flushes_subnormals() {
        let message =
            "the floating-point environment flushes subnormal numbers, so that nothing can be proved";
        return Err(Failure::refused(Code::FlushesSubnormals, message));
    }
    if bounds.is_empty() {
        return Err(Failure::refused(
            Code::Empty,
            "there is no surface to mesh: the box of the shape is empty",
        ));
    }
    if !bounds.diagonal().is_finite() {
        let message = "the shape has no finite bounds: cut it off with a box";
        return Err(Failure::refused(Code::Unsupported, message));
    }
    if budget.angle_deg.is_some() {
        return Err(Failure::refused(Code::Unsupported, "an angle is no budget for fields in this version"));
    }
    let seen = match &budget.pixels {
        None => None,
        Some(px) => Some(length_on(&bounds, px)?),
    };
    let length = match (budget.length.map(Tolerance::get), seen) {
        (Some(a), Some(b)) => Some(if a < b { a } else { b }),
        (a, b) => a.or(b),
    };
    let length = match length.map(Tolerance::new) {
        None => None,
        Some(Ok(length)) => Some(length),
        Some(Err(_)) => return Err(Failure::refused(Code::Budget, "the budget in pixels leaves no length")),
    };
    let measured = budget.require == Require::Measured;
    let wanted = Wanted { length, triangles: budget.triangles, measured };
    let mut made = job.run(|| search(field, &wanted, job))?;
    if let (Some(px), Some(most)) = (budget.pixels, made.bound.at_most()) {
        made.bound.pixels = px.view.pixels_of(most, &made.shape.bounds().union(bounds));
    }
    Ok(made)
}

/// What a budget in pixels allows anywhere about the box: the mesh may stick out by as much.
fn length_on(bounds: &Box3, px: &PixelBudget) -> Result<f64, Failure<Mesh>> {
    let too_close = || {
        Failure::refused(
            Code::TooClose,
            "the shape comes so close to the eye that there is no bound in pixels",
        )
    };
    let alone = px.view.length_of(px.pixels, bounds).ok_or_else(too_close)?;
    let about = Box3 { min: bounds.min.map(|x| x - alone), max: bounds.max.map(|x| x + alone) };
    px.view.length_of(px.pixels, &about).ok_or_else(too_close)
}
