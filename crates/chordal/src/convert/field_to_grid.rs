//! The arrow from fields to grids of samples, in bricks that interval evaluation prunes.
use super::lattice::{BRICK, Lattice};
use crate::budget::{Job, JobError, Refusal, RefusalCode, par_map, par_map_owned};
use crate::implicit::{BrickSlab, Field, Grid, LeafError, Samples, SparseGrid, Tape};
use crate::math::{Box3, Interval};

/// Samples a field on a lattice. With a `band`, values beyond it are clamped to ±band.
///
/// **Values.** Those of [`Tape::at`] at the points that [`Lattice::at`] computes. With a band, a brick of 8³
/// samples whose range is beyond it is filled without evaluation. The range is proved, so no sample within
/// the band is missed. (The field's [`Distance`](crate::implicit::Distance) says whether a value within the
/// band is a distance.)
///
/// **Cost.** Near the surface, that of evaluating each sample; elsewhere, one interval evaluation a brick. 8 bytes a
/// sample.
///
/// # Errors
/// [`JobError::Refused`] if a leaf fails ([`RefusalCode::LeafFailed`], with its message), the band is not
/// a number above 0, or the samples are more than the job's memory holds; [`JobError::Cancelled`].
///
/// ```
/// use chordal::Job;
/// use chordal::convert::field_to_grid;
/// use chordal::convert::lattices::Lattice;
/// use chordal::implicit::shapes::sphere;
/// let ball = sphere(1.0)?;
/// let lattice = Lattice::around(&ball.bounds(), 32, 2).unwrap();
/// let grid = field_to_grid(&ball, &lattice, Some(0.25), &Job::default())?;
/// assert_eq!(grid.sample([18, 18, 18]), -0.25);
/// assert_eq!(grid.sample([0, 18, 18]), 0.125);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn field_to_grid(
    field: &Field,
    lattice: &Lattice,
    band: Option<f64>,
    job: &Job,
) -> Result<Grid, JobError> {
    check(lattice, band, job, 8 * lattice.len() as u64)?;
    let tape = field.tape();
    let mut samples = vec![0.0; lattice.len()];
    let layer = lattice.size[0] * lattice.size[1] * BRICK;
    let tasks: Vec<(usize, &mut [f64])> = samples.chunks_mut(layer.max(1)).enumerate().collect();
    debug_assert_eq!(tasks.len(), if lattice.is_empty() { 0 } else { lattice.layers() });
    let done = par_map_owned(job, tasks, |(number, out)| {
        if job.is_cancelled() { Ok(()) } else { fill_layer(&tape, lattice, band, number, out) }
    });
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    for result in done {
        result.map_err(|error| refusal(RefusalCode::LeafFailed, error.to_string()))?;
    }
    Grid::new(lattice.size, Samples::F64(samples), lattice.affine)
        .map_err(|error| refusal(RefusalCode::Empty, error.to_string()))
}

/// Like [`field_to_grid`], in bricks: bricks beyond the band, which has to be finite, are not stored.
///
/// The samples are those of [`field_to_grid`], bit for bit. Memory: that of the bricks, and eight planes for
/// each thread.
///
/// # Errors
/// As for [`field_to_grid`].
///
/// ```
/// use chordal::Job;
/// use chordal::convert::{field_to_grid, field_to_sparse_grid};
/// use chordal::convert::lattices::Lattice;
/// use chordal::implicit::shapes::sphere;
/// let ball = sphere(1.0)?;
/// let lattice = Lattice::around(&ball.bounds(), 100, 2).unwrap();
/// let sparse = field_to_sparse_grid(&ball, &lattice, 0.0625, &Job::default())?;
/// assert_eq!(sparse.to_dense(), field_to_grid(&ball, &lattice, Some(0.0625), &Job::default())?);
/// assert!(2 * sparse.bytes() < 8 * lattice.len() as u64);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn field_to_sparse_grid(
    field: &Field,
    lattice: &Lattice,
    band: f64,
    job: &Job,
) -> Result<SparseGrid, JobError> {
    let plane = lattice.size[0] * lattice.size[1];
    check(lattice, Some(band), job, 8 * (plane * BRICK) as u64)?;
    let tape = field.tape();
    let numbers: Vec<usize> = (0..lattice.layers()).collect();
    let done = par_map(job, &numbers, |_, number| {
        let planes = BRICK.min(lattice.size[2] - number * BRICK);
        let mut out = vec![0.0; if job.is_cancelled() { 0 } else { plane * planes }];
        if !out.is_empty() {
            fill_layer(&tape, lattice, Some(band), *number, &mut out)?;
        }
        Ok(BrickSlab::from_samples(&out, lattice.size, band))
    });
    sample_bricks(lattice, band, done, job)
}

/// Joins the layers to one grid, in order.
fn sample_bricks(
    lattice: &Lattice,
    band: f64,
    layers: Vec<Result<BrickSlab, LeafError>>,
    job: &Job,
) -> Result<SparseGrid, JobError> {
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    let mut grid = SparseGrid::empty(lattice.size, lattice.affine, band);
    for layer in layers {
        grid.push(layer.map_err(|error| refusal(RefusalCode::LeafFailed, error.to_string()))?);
    }
    Ok(grid)
}

fn refusal(code: RefusalCode, message: String) -> JobError {
    JobError::Refused(Refusal::new(code, message))
}

/// Refuses a band that is not above 0, and samples that exceed the memory limit.
fn check(lattice: &Lattice, band: Option<f64>, job: &Job, bytes: u64) -> Result<(), JobError> {
    if let Some(width) = band.filter(|width| width.is_nan() || *width <= 0.0) {
        return Err(refusal(RefusalCode::Budget, format!("the band is {width}, and must be above 0")));
    }
    if bytes > job.memory_limit {
        let message =
            format!("{} samples need {bytes} bytes; the limit is {}", lattice.len(), job.memory_limit);
        return Err(refusal(RefusalCode::TooMuchMemory, message));
    }
    Ok(())
}

fn fill_layer(
    tape: &Tape,
    lattice: &Lattice,
    band: Option<f64>,
    number: usize,
    out: &mut [f64],
) -> Result<(), LeafError> {
    let bricks: Vec<[[usize; 3]; 2]> = lattice.bricks(number).collect();
    let hulls: Vec<Box3> = bricks.iter().map(|brick| lattice.hull(*brick)).collect();
    let mut ranges = vec![Interval::ENTIRE; bricks.len()];
    if band.is_some() {
        tape.over(&hulls, &mut ranges)?;
    }
    let mut rows = Vec::new();
    let mut points = Vec::new();
    for (brick, range) in bricks.iter().zip(&ranges) {
        let beyond = band.and_then(|band| {
            // A range may not cover points without a value, which are outside; such bricks are evaluated.
            let is_total = range.is_defined() && !range.is_empty();
            if is_total && range.lo() > band {
                Some(band)
            } else if is_total && range.hi() < -band {
                Some(-band)
            } else {
                None
            }
        });
        let [first, end] = *brick;
        for k in first[2]..end[2] {
            for j in first[1]..end[1] {
                for i in first[0]..end[0] {
                    // The output is one layer of bricks.
                    let row = lattice.row([i, j, k % BRICK]);
                    if let Some(value) = beyond {
                        out[row] = value;
                    } else {
                        rows.push(row);
                        points.push(lattice.at([i, j, k]));
                    }
                }
            }
        }
    }
    let mut values = vec![0.0; points.len()];
    tape.at(&points, &mut values)?;
    for (row, value) in rows.into_iter().zip(values) {
        out[row] = match band {
            Some(band) if value > band => band,
            Some(band) if value < -band => -band,
            _ => value,
        };
    }
    Ok(())
}
