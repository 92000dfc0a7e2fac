//! The arrow from bicubic Bézier patches to triangles: adaptive, crack-free by shared indices, proved.
use super::patches::allowance::TessellationFailure;
use super::patches::budget::mesh_within;
use super::patches::subpatch::BezierPatches;
use crate::budget::{Bounded, Budget, Failure, Job, RefusalCode};
use crate::explicit::{Mesh, Patch};
use crate::math::flushes_subnormals;

/// Meshes bicubic Bézier patches within a budget.
///
/// **Bound.** Two-sided Hausdorff distance between the union of the patches, taken exactly as given, and the
/// triangles, *proved*, rounding included (for the mathematics see `patches/derivative_bound.rs` and
/// `docs/patches_to_mesh.md`). `at_least` is the distance at one point of the surface. With a budget of pixels
/// the bound is also given in pixels at the view; it covers distances only, neither normals nor contours
/// inside the shape.
///
/// **Mesh.** Sides with equal control points (forwards or backwards) are one curve and share their vertices
/// by index, so there are no cracks and no T-junctions at any budget. A side that is one point becomes one
/// vertex and makes no degenerate triangle. Every vertex lies on the surface (up to rounding) and has the
/// surface's own unit normal. Where patches meet at an angle of 1° or more, vertices are split and tied by
/// [`Mesh::position_id`].
///
/// **Budgets.** A length, pixels at a view, a number of triangles, or several of these. If only a number of
/// triangles is given, lengths are tried on a ladder of 32 steps an octave and the best mesh is returned; more
/// triangles never give a larger bound.
///
/// **Cost.** O(triangles) time and about 100 bytes a triangle, on all threads of the job; the output is the same
/// on any number of threads, byte for byte.
///
/// # Errors
/// [`Failure::Refused`]: a budget without a limit, or with an angle ([`RefusalCode::Budget`],
/// [`RefusalCode::Unsupported`]), no patches, control points that are not finite or beyond 1e150, more
/// triangles or bytes than the job allows (refused before the work starts), a budget below rounding
/// ([`RefusalCode::BelowPrecision`]), an eye too close ([`RefusalCode::TooClose`]), an environment that
/// flushes subnormals. [`Failure::Unmet`] with the best mesh: the length or pixels need more triangles than
/// the budget allows. [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Budget, Job, Patch, Tolerance, convert};
/// let mut patch = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
/// patch.control[1][1][2] = 1.0;
/// let coarse = convert::patches_to_mesh(&[patch], &Budget::length(Tolerance::new(1e-2)?), &Job::default()).unwrap();
/// let fine = convert::patches_to_mesh(&[patch], &Budget::length(Tolerance::new(1e-4)?), &Job::default()).unwrap();
/// assert!(fine.bound.at_most().unwrap() <= 1e-4);
/// // A hundredth of the error costs up to a hundred times the triangles.
/// assert!(fine.shape.faces().len() > 30 * coarse.shape.faces().len());
/// # Ok::<(), chordal::budget::InvalidTolerance>(())
/// ```
///
/// Source: D. Filip, R. Magedson, R. Markot, *Surface algorithms using bounds on derivatives*, 1986,
/// extended.
pub fn patches_to_mesh(
    patches: &[Patch],
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Mesh>, TessellationFailure> {
    budget.check_for_surfaces().map_err(Failure::Refused)?;
    mesh_within(&checked_patches(patches)?, budget, job)
}

/// The patches as a surface. Refuses empty input, extreme coordinates, and environments that flush subnormals.
pub(super) fn checked_patches(patches: &[Patch]) -> Result<BezierPatches, TessellationFailure> {
    if patches.is_empty() {
        return Err(Failure::refused(RefusalCode::Empty, "there are no patches"));
    }
    if let Some(index) = patches.iter().position(|patch| !patch.is_finite()) {
        return Err(Failure::refused(
            RefusalCode::NotFinite,
            format!("patch {index} has a control point that is not finite"),
        ));
    }
    if let Some(index) = patches.iter().position(|patch| patch.size() > LARGEST) {
        let message = format!(
            "patch {index} has a coordinate beyond {LARGEST:e}, where squares leave the range of numbers"
        );
        return Err(Failure::refused(RefusalCode::NotFinite, message));
    }
    if flushes_subnormals() {
        let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
        return Err(Failure::refused(RefusalCode::FlushesSubnormals, message));
    }
    Ok(BezierPatches(patches.iter().map(positive_zeros).collect()))
}

/// Derivatives multiply coordinates by less than 1e3, and squares of those must stay below 1e308.
const LARGEST: f64 = 1e150;

/// Turns −0 into 0, since sides are matched by the bits of their control points.
fn positive_zeros(patch: &Patch) -> Patch {
    Patch { control: patch.control.map(|row| row.map(|p| p.map(|x| x + 0.0))) }
}
