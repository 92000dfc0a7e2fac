//! The arrow from a mesh to a grid of distances, dense or in bricks.
use super::lattice::{BRICK, Lattice};
use super::mesh_leaf::{MeshLeaf, PreviousPoint};
use super::mesh_to_field::SolidReport;
use crate::budget::{Job, JobError, Refusal, RefusalCode, par_map, par_map_owned};
use crate::explicit::Mesh;
use crate::implicit::{BrickSlab, Grid, Samples, SparseGrid};
use crate::math::Box3;
use std::sync::atomic::{AtomicU64, Ordering};

/// Distances to a mesh on a lattice, with a report on whether the mesh is a solid.
#[derive(Clone, Debug)]
pub struct DistanceGrid<G = Grid> {
    /// The samples, f64, negative inside.
    pub grid: G,
    /// Whether the mesh is a solid.
    pub solid: SolidReport,
    /// The number of samples whose value is a distance; the others are ±band: beyond the band, with the sign of
    /// their side.
    pub n_within: u64,
    /// The largest distance that samples hold; ∞ if all are distances.
    pub band: f64,
}

/// Samples the distance to a mesh on a lattice of cubes, `cells` along the longest side of its box with a
/// margin around it. With a `band`, a number of cells, only samples near the mesh are distances; the others are
/// ±band.
///
/// **Values.** As for [`mesh_to_field`](super::mesh_to_field()): the exact distance to the triangles up to
/// rounding (at most 1e-12 of the extent), never scaled, and a side that is exact for closed meshes. With a
/// band, samples farther from the mesh hold the band's width, with the sign of their side.
///
/// **Cost.** About 1 µs for each computed sample; a brick of 8³ samples beyond the band costs as much as one sample.
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
    let lattice = Lattice::for_distances(&mesh.bounds(), cells, band)?;
    check_memory(8 * lattice.len() as u64, lattice.len(), job)?;
    DistanceBaker::new(mesh, job)?.grid(cells, band, job)
}

/// Like [`mesh_to_grid`], in bricks: bricks beyond the band are not stored.
///
/// The samples are those of [`mesh_to_grid`], bit for bit. Memory: that of the bricks, and eight planes for
/// each thread.
///
/// # Errors
/// As for [`mesh_to_grid`].
///
/// ```
/// use chordal::{Job, Mesh, convert::{mesh_to_grid, mesh_to_sparse_grid}};
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let (mesh, job) = (Mesh::new(corners, faces).unwrap(), Job::default());
/// let sparse = mesh_to_sparse_grid(&mesh, 100, 2.0, &job)?;
/// assert_eq!(sparse.grid.to_dense(), mesh_to_grid(&mesh, 100, Some(2.0), &job)?.grid);
/// assert!(2 * sparse.grid.bytes() < 8 * 105_u64.pow(3));
/// # Ok::<(), chordal::budget::JobError>(())
/// ```
pub fn mesh_to_sparse_grid(
    mesh: &Mesh,
    cells: usize,
    band: f64,
    job: &Job,
) -> Result<DistanceGrid<SparseGrid>, JobError> {
    DistanceBaker::new(mesh, job)?.sparse_grid(cells, band, job)
}

/// A mesh prepared for sampling on several lattices, as by [`mesh_to_grid`] and [`mesh_to_sparse_grid`].
#[derive(Clone, Debug)]
pub struct DistanceBaker {
    leaf: MeshLeaf,
    bounds: Box3,
    solid: SolidReport,
}

impl DistanceBaker {
    /// Builds the trees, and checks whether the mesh is a solid.
    ///
    /// # Errors
    /// As for [`mesh_to_field`](super::mesh_to_field()).
    pub fn new(mesh: &Mesh, job: &Job) -> Result<Self, JobError> {
        let leaf = MeshLeaf::new(mesh, job)?;
        let solid = SolidReport::from_mesh(mesh, leaf.is_closed(), job)?;
        Ok(Self { leaf, bounds: mesh.bounds(), solid })
    }

    /// Whether the mesh is a solid.
    #[must_use]
    pub fn solid(&self) -> &SolidReport {
        &self.solid
    }

    /// The samples, as by [`mesh_to_grid`].
    ///
    /// # Errors
    /// As for [`mesh_to_grid`].
    pub fn grid(&self, cells: usize, band: Option<f64>, job: &Job) -> Result<DistanceGrid, JobError> {
        let lattice = Lattice::for_distances(&self.bounds, cells, band)?;
        check_memory(8 * lattice.len() as u64, lattice.len(), job)?;
        let band = band.map_or(f64::INFINITY, |width| width * lattice.spacing());
        let mut samples = vec![0.0; lattice.len()];
        let layer = lattice.size[0] * lattice.size[1] * BRICK;
        let tasks: Vec<(usize, &mut [f64])> = samples.chunks_mut(layer).enumerate().collect();
        let counts =
            par_map_owned(job, tasks, |(layer, out)| self.fill_layer(&lattice, (layer, out), band, job));
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let grid = Grid::new(lattice.size, Samples::F64(samples), lattice.affine)
            .map_err(|error| JobError::Refused(Refusal::new(RefusalCode::Empty, error.to_string())))?;
        Ok(DistanceGrid { grid, solid: self.solid.clone(), n_within: counts.into_iter().sum(), band })
    }

    /// The samples in bricks, as by [`mesh_to_sparse_grid`].
    ///
    /// # Errors
    /// As for [`mesh_to_sparse_grid`].
    pub fn sparse_grid(
        &self,
        cells: usize,
        band: f64,
        job: &Job,
    ) -> Result<DistanceGrid<SparseGrid>, JobError> {
        let lattice = Lattice::for_distances(&self.bounds, cells, Some(band))?;
        let plane = lattice.size[0] * lattice.size[1];
        check_memory(8 * (plane * BRICK) as u64, plane * BRICK, job)?;
        let band = band * lattice.spacing();
        let (numbers, stored): (Vec<usize>, AtomicU64) = ((0..lattice.layers()).collect(), AtomicU64::new(0));
        let layers = par_map(job, &numbers, |_, number| {
            // Too much already: the result is refused below, whatever the other layers are.
            if stored.load(Ordering::Relaxed) > job.memory_limit {
                return (BrickSlab::from_samples(&[], lattice.size, band), 0);
            }
            let planes = BRICK.min(lattice.size[2] - number * BRICK);
            let mut out = vec![0.0; plane * planes];
            let count = self.fill_layer(&lattice, (*number, &mut out), band, job);
            let slab = BrickSlab::from_samples(&out, lattice.size, band);
            stored.fetch_add(slab.bytes(), Ordering::Relaxed);
            (slab, count)
        });
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        if stored.into_inner() > job.memory_limit {
            let message =
                format!("the bricks of the band need more than {} bytes, the limit", job.memory_limit);
            return Err(JobError::Refused(Refusal::new(RefusalCode::TooMuchMemory, message)));
        }
        let (mut grid, mut n_within) = (SparseGrid::empty(lattice.size, lattice.affine, band), 0);
        for (slab, count) in layers {
            grid.push(slab);
            n_within += count;
        }
        Ok(DistanceGrid { grid, solid: self.solid.clone(), n_within, band })
    }

    /// Fills one layer of bricks; returns the number of samples that are distances.
    fn fill_layer(&self, lattice: &Lattice, (layer, out): (usize, &mut [f64]), band: f64, job: &Job) -> u64 {
        let mut count = 0;
        let mut last = None;
        for brick in lattice.bricks(layer) {
            if job.is_cancelled() {
                break;
            }
            let mut baking = BrickSampler { leaf: &self.leaf, lattice, band, out: &mut *out, last };
            count += baking.brick(brick);
            last = baking.last;
        }
        count
    }
}

fn check_memory(bytes: u64, samples: usize, job: &Job) -> Result<(), JobError> {
    if bytes > job.memory_limit {
        let message = format!("{samples} samples need {bytes} bytes; the limit is {}", job.memory_limit);
        return Err(JobError::Refused(Refusal::new(RefusalCode::TooMuchMemory, message)));
    }
    Ok(())
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
    /// Fills the samples of a brick; returns the number of samples that are distances.
    fn brick(&mut self, brick: [[usize; 3]; 2]) -> u64 {
        let [first, end] = brick;
        let hull = self.lattice.hull(brick);
        let radius = 0.5 * hull.diagonal();
        // A factor far above the rounding of distances and of the radius.
        const SHARE: f64 = 1.0 + 1.0 / (1_u64 << 30) as f64;
        // Triangles beyond these are not searched, since a search takes longer the farther the nearest one is.
        let [reach, brick_reach] = [self.band * SHARE, (self.band + radius) * SHARE];
        let Some(middle) = self.leaf.step_within(hull.centre(), self.last, brick_reach * SHARE) else {
            return 0;
        };
        self.last = Some(middle);
        let is_far = middle.distance() > brick_reach;
        let is_closed = self.leaf.is_closed();
        let mut count = 0;
        for k in first[2]..end[2] {
            for j in first[1]..end[1] {
                // Back and forth, so that consecutive samples are neighbours.
                let back = (j + k) % 2 == 1;
                for i in first[0]..end[0] {
                    let i = if back { first[0] + end[0] - 1 - i } else { i };
                    let row = self.lattice.row([i, j, k % BRICK]);
                    // All samples are beyond the band, on the side of the middle.
                    if is_far && is_closed {
                        self.out[row] = if middle.value() < 0.0 { -self.band } else { self.band };
                        continue;
                    }
                    let p = self.lattice.at([i, j, k]);
                    if let Some(last) = self.last.filter(|last| is_closed && last.is_beyond(p, self.band)) {
                        self.out[row] = if last.value() < 0.0 { -self.band } else { self.band };
                        continue;
                    }
                    let Some(here) = self.leaf.step_within(p, self.last, reach) else { continue };
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
