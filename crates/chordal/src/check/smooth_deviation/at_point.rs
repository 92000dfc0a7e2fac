//! `patch_deviation_at`, `cage_deviation_at`: lower bounds on the deviation of a mesh from a smooth surface,
//! from one point.
use super::{SmoothReference, SmoothSampler, SmoothShape, invalid_cage};
use crate::budget::{Job, JobError};
use crate::explicit::{Bvh, Cage, Mesh, Patch, SurfaceTree};

/// Lower bounds on the distance from a mesh to patches, and from these to the mesh, from a point near either:
/// `[from the mesh, from the patches]`, each 0 if the point proves nothing.
///
/// *What they cover.* Both are proved, rounding included, for any point: the distance of the point from the
/// one, less that from the other; from the patches it is the distance of their point nearest to the given
/// one.
///
/// *Cost.* The trees over both and three queries.
///
/// # Errors
/// As for [`Bvh::build`] and [`SurfaceTree::from_patches`].
///
/// ```
/// use chordal::{Job, Mesh, Patch, check::patch_deviation_at};
/// let flat = Patch::flat([0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
/// let above = Mesh::new(vec![[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 3.0, 1.0]], vec![[0, 1, 2]])?;
/// let [forward, _] = patch_deviation_at(&above, &[flat], [1.0; 3], &Job::default())?;
/// assert!(forward <= 1.0 && forward > 0.999_999);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn patch_deviation_at(
    mesh: &Mesh,
    patches: &[Patch],
    p: [f64; 3],
    job: &Job,
) -> Result<[f64; 2], JobError> {
    let tree = SurfaceTree::from_patches(patches, job)?;
    seen_at(mesh, &SmoothReference { shape: SmoothShape::Patches(patches), tree }, p, job)
}

/// The same for the limit surface of a cage: `[from the mesh, from the limit surface]`.
///
/// # Errors
/// As for [`cage_deviation`](super::cage_deviation).
///
/// ```
/// use chordal::{Job, Mesh, check::cage_deviation_at, explicit::Cage};
/// let flat = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let cage = Cage::new(flat.to_vec(), [&[0_u32, 1, 2, 3][..]])?;
/// let above = Mesh::new(flat.map(|[x, y, _]| [x, y, 1.0]).to_vec(), vec![[0, 1, 2], [0, 2, 3]])?;
/// let [forward, _] = cage_deviation_at(&above, &cage, [0.5, 0.5, 1.0], &Job::default())?;
/// assert!(forward <= 1.0 && forward > 0.999_999);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cage_deviation_at(mesh: &Mesh, cage: &Cage, p: [f64; 3], job: &Job) -> Result<[f64; 2], JobError> {
    let limit = cage.limit().or_else(invalid_cage)?;
    let tree = SurfaceTree::from_limit(&limit, job)?;
    seen_at(mesh, &SmoothReference { shape: SmoothShape::Cage(cage), tree }, p, job)
}

fn seen_at(mesh: &Mesh, smooth: &SmoothReference<'_>, p: [f64; 3], job: &Job) -> Result<[f64; 2], JobError> {
    job.run(|| {
        if mesh.faces().is_empty() || !p.iter().all(|x| x.is_finite()) {
            return Ok([0.0; 2]);
        }
        let bvh = Bvh::build(mesh, job)?;
        let sampler = SmoothSampler { smooth, bvh: &bvh };
        let lower_bounds = [sampler.forward_at(p, None), sampler.backward_at(p)];
        Ok(lower_bounds.map(|bound| bound.map_or(0.0, |bound| bound.at_least)))
    })
}
