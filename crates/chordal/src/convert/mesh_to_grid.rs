//! The arrow from a mesh to a grid of distances.
use super::lattice::{BRICK, Lattice};
use super::mesh_leaf::{MeshLeaf, PreviousPoint};
use super::mesh_to_field::SolidReport;
use crate::budget::{Job, JobError, Refusal, RefusalCode, par_map_owned};
use crate::explicit::Mesh;
use crate::implicit::{Grid, Samples};

/// Distances to a mesh on a lattice, with a report whether the mesh is a solid.
#[derive(Clone, Debug)]
pub struct DistanceGrid {
    /// The samples, f64, negative inside.
    pub grid: Grid,
    /// Whether the mesh is a solid.
    pub solid: SolidReport,
    /// The number of samples whose value is a distance; the others say only that they are beyond the band,
    /// and on which side.
    pub n_within: u64,
    /// The largest distance that samples hold; ∞ where all are distances.
    pub band: f64,
}

/// Samples the distance to a mesh on a lattice of cubes, `cells` along the longest side of its box with a
/// margin around it. With a `band` of so many cells, only samples near the mesh are distances, and the others
/// ±band.
///
/// **Values.** As for [`mesh_to_field`](super::mesh_to_field()): the exact distance to the triangles but for
/// rounding (at most 1e-12 of the extent), never scaled, and a side that is exact for closed meshes. With a
/// band, samples farther from the mesh hold the band's width, with the sign of their side.
///
/// **Cost.** About 1 µs for each computed sample; a brick of 8³ samples beyond the band takes as long as one.
/// For meshes that are not closed, a winding number for every sample, 10 to 100 µs. 8 bytes a sample.
///
/// # Errors
/// [`JobError::Refused`] for a mesh without extent, no cells, a band that is not above 0, more samples than
/// the job's memory holds, and as for [`mesh_to_field`](super::mesh_to_field()); [`JobError::Cancelled`].
///
/// ```
/// use chordal::{Job, Mesh, convert::mesh_to_grid};
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let baked = mesh_to_grid(&Mesh::new(corners, faces).unwrap(), 16, Some(2.0), &Job::default())?;
/// assert!(baked.solid.is_solid());
/// assert_eq!((baked.grid.size(), baked.band), ([21; 3], 0.125));
/// assert_eq!(baked.grid.sample([4, 4, 0]), 0.125);
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
pub fn mesh_to_grid(
    mesh: &Mesh,
    cells: usize,
    band: Option<f64>,
    job: &Job,
) -> Result<DistanceGrid, JobError> {
    let refused = |code, message: String| JobError::Refused(Refusal::new(code, message));
    if let Some(width) = band.filter(|width| !(*width > 0.0 && *width <= 1e6)) {
        let message = format!("the band is {width} cells, and must be above 0 and at most 1e6");
        return Err(refused(RefusalCode::Budget, message));
    }
    let margin = band.map_or(3, |width| width.ceil() as usize);
    let lattice = Lattice::around(&mesh.bounds(), cells, margin).ok_or_else(|| {
        refused(
            RefusalCode::Empty,
            format!("there is no lattice with {cells} cells along the mesh's longest side"),
        )
    })?;
    let bytes = 8 * lattice.len() as u64;
    if bytes > job.memory_limit {
        let message =
            format!("{} samples need {bytes} bytes; the limit is {}", lattice.len(), job.memory_limit);
        return Err(refused(RefusalCode::TooMuchMemory, message));
    }
    let leaf = MeshLeaf::new(mesh, job)?;
    let solid = SolidReport::from_mesh(mesh, leaf.is_closed(), job)?;
    let step = lattice.affine.rows()[0][0];
    let band = band.map_or(f64::INFINITY, |width| width * step);
    let (samples, n_within) = mesh_on_lattice(&leaf, &lattice, band, job)?;
    let grid = Grid::new(lattice.size, Samples::F64(samples), lattice.affine)
        .map_err(|error| refused(RefusalCode::Empty, error.to_string()))?;
    Ok(DistanceGrid { grid, solid, n_within, band })
}

/// The samples by layers of bricks, and how many are distances.
fn mesh_on_lattice(
    leaf: &MeshLeaf,
    lattice: &Lattice,
    band: f64,
    job: &Job,
) -> Result<(Vec<f64>, u64), JobError> {
    let mut samples = vec![0.0; lattice.len()];
    let layer = lattice.size[0] * lattice.size[1] * BRICK;
    let tasks: Vec<(usize, &mut [f64])> = samples.chunks_mut(layer).enumerate().collect();
    let counts = par_map_owned(job, tasks, |(layer, out)| {
        let mut count = 0;
        let mut last = None;
        for brick in lattice.bricks(layer) {
            if job.is_cancelled() {
                break;
            }
            let mut baking = BrickSampler { leaf, lattice, band, out: &mut *out, last };
            count += baking.brick(brick);
            last = baking.last;
        }
        count
    });
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    Ok((samples, counts.into_iter().sum()))
}

/// One layer in progress.
struct BrickSampler<'a> {
    leaf: &'a MeshLeaf,
    lattice: &'a Lattice,
    band: f64,
    out: &'a mut [f64],
    last: Option<PreviousPoint>,
}

impl BrickSampler<'_> {
    /// Fills the samples of a brick; returns how many of them are distances.
    fn brick(&mut self, brick: [[usize; 3]; 2]) -> u64 {
        let [first, end] = brick;
        let hull = self.lattice.hull(brick);
        let radius = 0.5 * hull.diagonal();
        let Some(middle) = self.leaf.step(hull.centre(), self.last) else { return 0 };
        self.last = Some(middle);
        // A factor far above the rounding of the distance and of the radius.
        const SHARE: f64 = 1.0 + 1.0 / (1_u64 << 30) as f64;
        let is_far = middle.distance() > (self.band + radius) * SHARE;
        let one_side = self.leaf.is_closed();
        let mut count = 0;
        for k in first[2]..end[2] {
            for j in first[1]..end[1] {
                // Back and forth, so that consecutive samples are neighbours.
                let back = (j + k) % 2 == 1;
                for i in first[0]..end[0] {
                    let i = if back { first[0] + end[0] - 1 - i } else { i };
                    let row = self.lattice.row([i, j, k % BRICK]);
                    if is_far && one_side {
                        self.out[row] = if middle.value() < 0.0 { -self.band } else { self.band };
                        continue;
                    }
                    let p = self.lattice.at([i, j, k]);
                    if let Some(last) = self.last.filter(|last| one_side && last.is_beyond(p, self.band)) {
                        self.out[row] = if last.value() < 0.0 { -self.band } else { self.band };
                        continue;
                    }
                    let Some(here) = self.leaf.step(p, self.last) else { continue };
                    self.last = Some(here);
                    let value = here.value();
                    let within = here.distance() <= self.band;
                    count += u64::from(within);
                    self.out[row] = if within {
                        value
                    } else if value < 0.0 {
                        -self.band
                    } else {
                        self.band
                    };
                }
            }
        }
        count
    }
}
