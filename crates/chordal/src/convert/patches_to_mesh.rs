//! Bicubic Bézier patches to triangles: adaptive, crack-free by shared index, proved.
use crate::budget::{Bounded, Budget, Failure, Job};
use crate::explicit::{Mesh, Patch};

/// PLACEHOLDER
pub fn patches_to_mesh(
    patches: &[Patch],
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let _ = (patches, budget, job);
    Err(Failure::Cancelled)
}
