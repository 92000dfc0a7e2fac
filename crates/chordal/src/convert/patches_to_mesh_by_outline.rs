//! The arrow from patches to triangles for one eye: finest where the outline is.
use super::patches::allowance::{Allowance, OutlineAllowance, TessellationFailure};
use super::patches::mesher::PatchMesher;
use super::patches::subpatch::PatchSurface;
use super::patches_to_mesh::checked_patches;
use crate::budget::{Bounded, Budget, Failure, Job, RefusalCode, Tolerance};
use crate::explicit::{Mesh, Patch};

/// How much more error a surface may have where an eye sees no outline of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineLimit {
    /// The eye.
    pub eye: [f64; 3],
    /// The factor of the budget away from the outline, finite and at least 1.
    pub elsewhere: f64,
}

/// A mesh that is finest along the outline.
#[derive(Clone, Debug)]
pub struct OutlineMesh {
    /// The mesh. Its bound holds everywhere: as a length and, if the budget has a view, in pixels.
    pub mesh: Bounded<Mesh>,
    /// The largest proved length of the tiles that may contain the outline; 0 if none can.
    pub outline_at_most: f64,
    /// Their pixels, if the budget has a view.
    pub outline_pixels: Option<f64>,
}

/// Meshes bicubic Bézier patches within a budget where the outline may be, and within a multiple of it where it cannot
/// be.
///
/// The outline is where the line of sight touches the surface, against the background or against parts behind it. A
/// piece of the surface has no outline if all of its normals point towards the eye, or all away from it. There a
/// chord is off along the line of sight more than across it, so the error shows in the shading only.
///
/// **Bound.** *Proved*, as for [`patches_to_mesh`](super::patches_to_mesh()): everywhere, and separately for the tiles
/// that may contain the outline, which meet the budget. That a piece has no outline is decided by the cross products
/// of differences of its control points, which enclose its normals. Boundaries of the surface and creases between
/// patches are not looked for.
///
/// **Cost.** As for `patches_to_mesh`. Free of cracks: neighbouring tiles share the vertices on their border.
///
/// # Errors
/// Those of `patches_to_mesh`; [`Failure::Refused`] for a factor below 1, and for a budget with a number of triangles or
/// an angle ([`RefusalCode::Budget`], [`RefusalCode::Unsupported`]).
///
/// ```
/// use chordal::convert::outlines::{OutlineLimit, patches_to_mesh_by_outline};
/// use chordal::{Budget, Job, Patch, Tolerance};
/// let mut dome = Patch::flat([0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
/// for (i, j) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
///     dome.control[i][j][2] = 3.0;
/// }
/// let budget = Budget::length(Tolerance::new(0.001)?);
/// let mesh = |elsewhere| {
///     let limit = OutlineLimit { eye: [1.5, -9.0, 1.2], elsewhere };
///     patches_to_mesh_by_outline(&[dome], &budget, &limit, &Job::default()).unwrap()
/// };
/// let [all, outline] = [mesh(1.0), mesh(8.0)];
/// assert!(outline.outline_at_most <= 0.001 && outline.mesh.bound.at_most().unwrap() <= 0.008);
/// assert!(outline.mesh.shape.faces().len() < all.mesh.shape.faces().len());
/// # Ok::<(), chordal::budget::InvalidTolerance>(())
/// ```
pub fn patches_to_mesh_by_outline(
    patches: &[Patch],
    budget: &Budget,
    limit: &OutlineLimit,
    job: &Job,
) -> Result<OutlineMesh, TessellationFailure> {
    budget.check_for_surfaces().map_err(Failure::Refused)?;
    let OutlineLimit { eye, elsewhere } = *limit;
    if !(elsewhere.is_finite() && elsewhere >= 1.0 && eye.iter().all(|x| x.is_finite())) {
        let message = format!(
            "the factor away from the outline is a finite number of at least 1, and the eye has finite coordinates, \
             not {elsewhere} and {eye:?}"
        );
        return Err(Failure::refused(RefusalCode::Budget, message));
    }
    if budget.triangles.is_some() || budget.angle_deg.is_some() {
        let message = "the outline is kept within pixels and lengths, not a number of triangles or an angle";
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    let sheets = checked_patches(patches)?;
    let outline = OutlineAllowance { eye, elsewhere };
    let allowance = Allowance {
        length: budget.length.map(Tolerance::get),
        pixels: budget.pixels.map(|px| (px.pixels, px.view.lens())),
        normal_deviation: None,
        share: 1.0,
        outline: Some(outline),
    };
    job.run(|| {
        let adjacency = sheets.adjacency();
        let mesher = PatchMesher::new(&sheets, &adjacency, job);
        let mut proved = mesher.prove(mesher.plan_within_limits(&allowance)?, &allowance)?;
        let mesh = mesher.finish(&mut proved, &allowance);
        let lens = allowance.pixels.map(|(_, lens)| lens);
        let (outline_at_most, outline_pixels) = proved.error_at_outline(&outline, lens.as_ref());
        Ok(OutlineMesh { mesh, outline_at_most, outline_pixels })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::View;
    use crate::budget::Pixels;
    use crate::check::validity;
    use crate::explicit::Topology;

    /// A bump over a square, as four patches.
    fn bump() -> Vec<Patch> {
        let mut whole = Patch::flat([-3.0, -3.0, 0.0], [6.0, 0.0, 0.0], [0.0, 6.0, 0.0]);
        for (i, j) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
            whole.control[i][j][2] = 5.0;
        }
        whole.halves_u().iter().flat_map(Patch::halves_v).collect()
    }

    #[test]
    fn the_outline_keeps_its_pixels_and_no_triangle_elsewhere_is_off_by_more_than_the_factor() {
        for eye in [[0.0, -14.0, 1.0], [9.0, -9.0, 2.0], [-3.0, -12.0, 6.0], [1.0, 1.0, 14.0]] {
            let [x, y, z] = eye;
            let view: View = format!("1280x720 fov=45 eye={x},{y},{z} target=0,0,1").parse().unwrap();
            let budget = Budget::pixels(Pixels::new(0.5).unwrap(), view);
            let mesh = |elsewhere| {
                let limit = OutlineLimit { eye, elsewhere };
                patches_to_mesh_by_outline(&bump(), &budget, &limit, &Job::default()).unwrap()
            };
            let [plain, free] = [mesh(1.0), mesh(16.0)];
            assert!(plain.mesh.bound.pixels.unwrap() <= 0.5);
            assert!(free.outline_pixels.unwrap() <= 0.5 && free.mesh.bound.pixels.unwrap() <= 8.0, "{eye:?}");
            assert!(free.mesh.shape.faces().len() < plain.mesh.shape.faces().len(), "{eye:?}");
            // Four sides of one square, and no crack within.
            let counts = validity(&free.mesh.shape, Topology::Positions);
            assert_eq!((counts.components, counts.boundary_loops), (1, 1), "{eye:?}");
        }
    }

    #[test]
    fn a_part_is_clear_only_if_no_normal_is_across_the_line_of_sight() {
        for eye in [[0.0, -14.0, 1.0], [9.0, -9.0, 2.0], [0.5, 0.5, 12.0], [3.0, 0.0, -7.0]] {
            let outline = OutlineAllowance { eye, elsewhere: 2.0 };
            let mut n_clear = 0;
            for (i, j) in (0..8).flat_map(|i| (0..8).map(move |j| (f64::from(i), f64::from(j)))) {
                let whole = &bump()[0];
                let part = whole.part([i / 8.0, (i + 1.0) / 8.0], [j / 8.0, (j + 1.0) / 8.0]);
                if !outline.is_clear(&part, 0.0) {
                    continue;
                }
                n_clear += 1;
                let mut sides = [false; 2];
                let grid =
                    (0..=9).flat_map(|k| (0..=9).map(move |l| (f64::from(k) / 9.0, f64::from(l) / 9.0)));
                for (u, v) in grid {
                    let (at, normal) = (part.at(u, v), part.normal(u, v).unwrap());
                    let toward: f64 = (0..3).map(|c| normal[c] * (eye[c] - at[c])).sum();
                    sides[usize::from(toward > 0.0)] = true;
                }
                assert_ne!(sides, [true; 2], "{eye:?} {i} {j}");
            }
            assert!(n_clear > 20, "{eye:?}: {n_clear}");
        }
    }

    #[test]
    fn factors_below_one_and_budgets_of_triangles_are_refused() {
        let refused = |budget: &Budget, elsewhere| {
            let limit = OutlineLimit { eye: [0.0, -14.0, 1.0], elsewhere };
            patches_to_mesh_by_outline(&bump(), budget, &limit, &Job::default()).is_err()
        };
        let length = Budget::length(Tolerance::new(0.1).unwrap());
        assert!(!refused(&length, 1.0) && refused(&Budget::triangles(100), 2.0));
        for factor in [0.5, f64::NAN, f64::INFINITY] {
            assert!(refused(&length, factor));
        }
    }
}
