//! The arrow from a mask to the surface of a Gaussian over it: `mask_to_smooth_mesh`.
use super::cubes::gaussian::{smoothed_sides, weights};
use super::cubes::marching_cubes::refusal;
use super::cubes::rule::Polygonize;
use super::grid_to_mesh::{grid_to_mesh, grid_to_triangles};
use crate::budget::{Bounded, Failure, Job, JobError, RefusalCode};
use crate::check::{Goal, deviation};
use crate::explicit::Mesh;
use crate::implicit::{Grid, Samples, with_samples};
use crate::math::greater;

/// The surface of a smoothed mask.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothedMask {
    /// The triangles.
    pub mesh: Mesh,
    /// How many samples are inside before smoothing.
    pub inside: u64,
    /// How many samples change sides.
    pub changed: u64,
}

/// The largest standard deviation, in samples. Chosen: its weights reach 128 samples on either side.
const LARGEST: f64 = 32.0;

/// Polygonizes a mask after a Gaussian: the steps of voxels are rounded off, and so are edges and thin parts.
///
/// Each sample is 1 if it is inside by `rule` and 0 otherwise, and becomes the weighted mean of the samples around it, by a
/// Gaussian of standard deviation `sigma` along each index, in samples; 0 leaves an index alone. Beyond the border the last
/// sample is repeated. The surface is where the mean is ½, between samples by linear interpolation.
///
/// **Bound.** The two-sided Hausdorff distance between the mesh and the surface of the unsmoothed shape, which is the inside
/// of the interpolant of `grid` itself. *Proved* in two steps: to the unsmoothed mesh as for
/// [`grid_to_mesh`](super::grid_to_mesh()) without a budget, and from that mesh to this one as by
/// [`check::deviation`](crate::check::deviation()). If a part vanishes, the bound is as large as the distance from there to
/// the nearest remaining part.
///
/// **Mesh.** As for [`grid_to_mesh`](super::grid_to_mesh()): closed and manifold except at an open border.
///
/// **Cost.** 8σ + 1 products a sample and index, 8 bytes a sample; two polygonizations, and the distance between their
/// triangles: 10 to 50 µs a triangle. It runs on all threads of the job, with the same bytes on any number.
///
/// # Errors
/// [`Failure::Refused`]: a σ that is not between 0 and 32 ([`RefusalCode::Budget`]); nothing left inside
/// ([`RefusalCode::Empty`]); more bytes than the job allows; as for [`grid_to_mesh`](super::grid_to_mesh()).
/// [`Failure::Cancelled`].
///
/// ```
/// use chordal::convert::{Polygonize, lattices::mask_to_smooth_mesh};
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal::Job;
/// // A ball of voxels.
/// let inside = |at: i32| [at % 16, at / 16 % 16, at / 256].map(|i| (2 * i - 15).pow(2)).iter().sum::<i32>() < 100;
/// let mask = Samples::U8((0..16 * 16 * 16).map(|at| u8::from(inside(at))).collect());
/// let grid = Grid::new([16; 3], mask, Affine3::IDENTITY)?;
/// let bounded = mask_to_smooth_mesh(&grid, &Polygonize::above(0.5), [1.0; 3], &Job::default()).expect("a ball");
/// assert!(bounded.shape.changed < bounded.shape.inside / 4);
/// assert!(bounded.bound.at_most().unwrap() < 1.0);
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
///
/// Source of the bound's second step: the triangle inequality of the Hausdorff distance.
pub fn mask_to_smooth_mesh(
    grid: &Grid,
    rule: &Polygonize,
    sigma: [f64; 3],
    job: &Job,
) -> Result<Bounded<SmoothedMask>, Failure<Mesh>> {
    if !sigma.iter().all(|sigma| (0.0..=LARGEST).contains(sigma)) {
        let [x, y, z] = sigma;
        let message = format!("a Gaussian of {x}, {y} and {z} samples: each is between 0 and {LARGEST}");
        return Err(Failure::refused(RefusalCode::Budget, message));
    }
    let n = grid.samples().len() as u64;
    // Two lattices of f32, and a byte for the sides.
    if 9 * n > job.memory_limit {
        let message =
            format!("{n} samples need {} bytes to be smoothed; the limit is {}", 9 * n, job.memory_limit);
        return Err(Failure::refused(RefusalCode::TooMuchMemory, message));
    }
    let unsmoothed = grid_to_mesh(grid, rule, None, job)?;
    let (values, inside, changed) = job.run(|| smoothed_values(grid, rule, sigma, job))?;
    let smoothed = Grid::new(grid.size(), Samples::F32(values), *grid.affine());
    let smoothed = smoothed.map_err(|error| refusal(RefusalCode::Unsupported, error.to_string()))?;
    let smooth_rule = Polygonize {
        border: rule.border,
        margin: rule.margin,
        offset: rule.offset,
        ..Polygonize::above(0.5)
    };
    let triangles = grid_to_triangles::<f64>(&smoothed, &smooth_rule, job)?;
    if triangles.faces.is_empty() {
        let message = format!(
            "smoothed by {} samples nothing is left of the {inside} samples inside: the shape is too thin for that",
            sigma.into_iter().fold(0.0, |most, sigma| greater(sigma, most))
        );
        return Err(Failure::refused(RefusalCode::Empty, message));
    }
    let mesh = Mesh::by_construction(triangles.positions, triangles.faces);
    let moved = deviation(&unsmoothed.shape, &mesh, &Goal::default(), job)?;
    let bound = unsmoothed.bound.then(&moved.bound);
    Ok(Bounded { shape: SmoothedMask { mesh, inside, changed }, bound })
}

/// The smoothed values, the number of samples that are inside, and the number that change sides.
#[allow(clippy::useless_conversion, reason = "one body for every type of samples")]
fn smoothed_values(
    grid: &Grid,
    rule: &Polygonize,
    sigma: [f64; 3],
    job: &Job,
) -> Result<(Vec<f32>, u64, u64), JobError> {
    let weights = sigma.map(weights);
    with_samples!(grid.samples(), values => {
        let is_inside = |at: usize| rule.is_inside(f64::from(values[at]));
        let smoothed = smoothed_sides(is_inside, grid.size(), &weights, job)?;
        let (mut inside, mut changed) = (0, 0);
        for (at, value) in smoothed.iter().enumerate() {
            inside += u64::from(is_inside(at));
            changed += u64::from(is_inside(at) != (*value > 0.5));
        }
        Ok((smoothed, inside, changed))
    })
}
