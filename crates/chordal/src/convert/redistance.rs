//! The arrow from a field to a field whose value is a true distance.
use super::field_to_mesh::field_to_mesh;
use super::mesh_to_field::mesh_standing_for;
use crate::budget::{Bounded, Budget, Failure, Job, Tolerance};
use crate::explicit::Mesh;
use crate::implicit::{DistanceQuality, Field};

/// Makes the value of a field a true distance again. After a union, the value inside is the distance to the nearest
/// surface of any part, even if another part covers it; after an intersection or a difference the value is wrong
/// outside in the same way, and after blends everywhere. Operations that need a distance ([`Field::offset`],
/// [`Field::shell`]) would then move the surface too little, or too much.
///
/// **Value.** The surface is meshed within the tolerance, and the value is the distance to those triangles,
/// negative inside. So it is within the bound of the distance to the field's own surface, plus rounding, and
/// the side is the same at every point farther than the bound from that surface.
///
/// **Bound.** That of the triangles ([`field_to_mesh`]). It stays with the field: shapes derived from it are
/// [`ProvedIf`](crate::budget::Evidence::ProvedIf) the triangles are taken for the shape, and that condition names
/// the bound. If the field is meshed by itself, moved, turned or scaled, the bounds add.
///
/// **Cost.** That of the mesh; then about 1 µs a point, as for any mesh.
///
/// # Errors
/// As for [`field_to_mesh`].
///
/// ```
/// use chordal::implicit::shapes::cuboid;
/// use chordal::{Job, Tolerance, convert::redistance};
/// // Two halves of a bar. In its middle the value is 0, though the surface is 1 away.
/// let half = |at: f64| cuboid([4.0, 2.0, 2.0])?.moved([at, 0.0, 0.0]);
/// let bar = half(-2.0)?.union(&half(2.0)?);
/// assert_eq!(bar.expr().at([0.0; 3])?, 0.0);
/// let bounded = redistance(&bar, Tolerance::new(0.01)?, &Job::default()).expect("it is meshed");
/// let most = bounded.bound.at_most().unwrap();
/// assert!(most <= 0.01 && (bounded.shape.expr().at([0.0; 3])? + 1.0).abs() <= most + 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn redistance(field: &Field, tolerance: Tolerance, job: &Job) -> Result<Bounded<Field>, Failure<Mesh>> {
    let mesh = field_to_mesh(field, &Budget::length(tolerance), job)?;
    let solid = mesh_standing_for(&mesh.shape, Some(mesh.bound.clone()), job)?;
    // A mesh of a field is closed; if it touches itself, its inner walls are thinner than rounding.
    debug_assert!(solid.field.distance().weakest() != DistanceQuality::Sign);
    // The triangles approximate the field, which may itself approximate another shape.
    let shape = solid.field.with_slack(if field.slack() > 0.0 { f64::INFINITY } else { 0.0 });
    Ok(Bounded { shape, bound: mesh.bound })
}
