//! The arrow from patches to triangles for one camera: finest where the outline is.
use super::patches::allowance::{Allowance, OutlineAllowance, TessellationFailure};
use super::patches::mesher::PatchMesher;
use super::patches::subpatch::PatchSurface;
use super::patches_to_mesh::checked_patches;
use crate::budget::{Bounded, Failure, Job, Pixels, RefusalCode};
use crate::budget::{Camera, Projection, View};
use crate::explicit::{Mesh, Patch};

/// A mesh that is finest along the outline.
#[derive(Clone, Debug)]
pub struct OutlineMesh {
    /// The mesh. Its bound holds everywhere: as a length and in pixels, also where the outline is not.
    pub mesh: Bounded<Mesh>,
    /// The bound in pixels of the tiles that may contain the outline; `None` if the eye is too close for one. It
    /// is 0 if no tile can.
    pub outline_pixels: Option<f64>,
}

/// Meshes bicubic Bézier patches for a camera, within `pixels` where the outline may be, and within `elsewhere` times
/// as many where it cannot be.
///
/// The outline is where the line of sight touches the surface, against the background or against parts behind it. A
/// piece of the surface has no outline if all of its normals point towards the eye, or all away from it. There a
/// chord is off along the line of sight more than across it, so the error shows in the shading only.
///
/// **Bound.** *Proved*, as for [`patches_to_mesh`](super::patches_to_mesh()): a length everywhere, its pixels
/// everywhere, and separately the pixels of the tiles that may contain the outline. That a piece has no outline is
/// decided by the cross products of differences of its control points, which enclose its normals. Boundaries of the
/// surface and creases between patches are not looked for.
///
/// **Cost.** As for `patches_to_mesh`. Free of cracks: neighbouring tiles share the vertices on their border.
///
/// # Errors
/// Those of `patches_to_mesh`; [`Failure::Refused`] for a factor that is not a finite number of at least 1, and for
/// parallel rays ([`RefusalCode::Budget`], [`RefusalCode::Unsupported`]).
///
/// ```
/// use chordal::budget::Pixels;
/// use chordal::convert::outlines::patches_to_mesh_by_outline;
/// use chordal::{Job, Patch, View};
/// let mut dome = Patch::flat([0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
/// for (i, j) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
///     dome.control[i][j][2] = 3.0;
/// }
/// let View::Camera(camera) = "1280x720 fov=45 eye=1.5,-9,1.2 target=1.5,1.5,0.5".parse()? else { unreachable!() };
/// let mesh = |factor| patches_to_mesh_by_outline(&[dome], &camera, (Pixels::new(0.5).unwrap(), factor), &Job::default()).unwrap();
/// let [all, outline] = [mesh(1.0), mesh(8.0)];
/// assert!(outline.outline_pixels.unwrap() <= 0.5 && outline.mesh.bound.pixels.unwrap() <= 4.0);
/// assert!(outline.mesh.shape.faces().len() < all.mesh.shape.faces().len());
/// # Ok::<(), chordal::budget::camera::InvalidView>(())
/// ```
pub fn patches_to_mesh_by_outline(
    patches: &[Patch],
    camera: &Camera,
    (pixels, elsewhere): (Pixels, f64),
    job: &Job,
) -> Result<OutlineMesh, TessellationFailure> {
    if !(elsewhere.is_finite() && elsewhere >= 1.0) {
        let message = format!(
            "the factor of the error away from the outline is a finite number of at least 1, not {elsewhere}"
        );
        return Err(Failure::refused(RefusalCode::Budget, message));
    }
    if matches!(camera.projection, Projection::Orthographic { .. }) {
        let message = "the outline is looked for from an eye, not along parallel rays";
        return Err(Failure::refused(RefusalCode::Unsupported, message));
    }
    let view = View::Camera(*camera)
        .checked()
        .map_err(|error| Failure::refused(RefusalCode::Budget, error.to_string()))?;
    let sheets = checked_patches(patches)?;
    let lens = view.lens();
    let outline = OutlineAllowance { eye: camera.eye, elsewhere };
    let allowance = Allowance {
        length: None,
        pixels: Some((pixels, lens)),
        normal_deviation: None,
        share: 1.0,
        outline: Some(outline),
    };
    job.run(|| {
        let adjacency = sheets.adjacency();
        let mesher = PatchMesher::new(&sheets, &adjacency, job);
        let mut proved = mesher.prove(mesher.plan_within_limits(&allowance)?, &allowance)?;
        let mesh = mesher.finish(&mut proved, &allowance);
        let outline_pixels = proved.pixels_at_outline(&outline, &lens);
        Ok(OutlineMesh { mesh, outline_pixels })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
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

    fn camera(view: &str) -> Camera {
        let View::Camera(camera) = view.parse().unwrap() else { panic!("{view}") };
        camera
    }

    #[test]
    fn the_outline_keeps_its_pixels_and_no_triangle_elsewhere_is_off_by_more_than_the_factor() {
        let (half, job) = (Pixels::new(0.5).unwrap(), Job::default());
        for eye in ["0,-14,1", "9,-9,2", "-3,-12,6", "1,1,14"] {
            let camera = camera(&format!("1280x720 fov=45 eye={eye} target=0,0,1"));
            let mesh = |factor| patches_to_mesh_by_outline(&bump(), &camera, (half, factor), &job).unwrap();
            let [plain, free] = [mesh(1.0), mesh(16.0)];
            assert!(plain.mesh.bound.pixels.unwrap() <= 0.5);
            assert!(free.outline_pixels.unwrap() <= 0.5 && free.mesh.bound.pixels.unwrap() <= 8.0, "{eye}");
            assert!(free.mesh.shape.faces().len() < plain.mesh.shape.faces().len(), "{eye}");
            // Four sides of one square, and no crack within.
            let counts = validity(&free.mesh.shape, Topology::Positions);
            assert_eq!((counts.components, counts.boundary_loops), (1, 1), "{eye}");
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
                if !outline.is_clear(&part) {
                    continue;
                }
                n_clear += 1;
                let mut sides = [false; 2];
                for (k, l) in
                    (0..=9).flat_map(|k| (0..=9).map(move |l| (f64::from(k) / 9.0, f64::from(l) / 9.0)))
                {
                    let (at, normal) = (part.at(k, l), part.normal(k, l).unwrap());
                    let toward: f64 = (0..3).map(|c| normal[c] * (eye[c] - at[c])).sum();
                    sides[usize::from(toward > 0.0)] = true;
                }
                assert_ne!(sides, [true; 2], "{eye:?} {i} {j}");
            }
            assert!(n_clear > 20, "{eye:?}: {n_clear}");
        }
    }

    #[test]
    fn parallel_rays_and_factors_below_one_are_refused() {
        let px = Pixels::new(1.0).unwrap();
        let refused = |view: &str, factor| {
            patches_to_mesh_by_outline(&bump(), &camera(view), (px, factor), &Job::default()).is_err()
        };
        assert!(refused("64x64 height=9 eye=0,-14,1 target=0,0,1", 2.0));
        for factor in [0.5, f64::NAN, f64::INFINITY] {
            assert!(refused("64x64 fov=45 eye=0,-14,1 target=0,0,1", factor));
        }
    }
}
