//! Fields to grids of samples, by bricks that ranges prune.
use super::lattice::{BRICK, Lattice};
use crate::budget::{Code, Job, Refusal, Stopped, par_map, par_map_owned};
use crate::implicit::{Field, Grid, Layer, LeafError, Samples, SparseGrid, Tape};
use crate::math::{Box3, Interval};

/// Samples a field on a lattice. With a `band`, values beyond it are only as good as their side: ±band.
///
/// **Values.** Those that [`Tape::at`] has at the places that [`Lattice::at`] computes. With a band, a brick of 8³ samples
/// in which the range of the value is beyond it is filled without evaluation; the range is proved, so no sample within
/// the band is missed. (Whether a value within the band is a distance, the field's
/// [`Distance`](crate::implicit::Distance) says.)
///
/// **Cost.** Near the surface that of evaluation; elsewhere that of a range a brick. 8 bytes a sample.
///
/// # Errors
/// [`Stopped::Refused`] when a leaf fails ([`Code::LeafFailed`], with its sentence), the band is not a number above 0, or the samples are more
/// than the job's memory holds; [`Stopped::Cancelled`].
///
/// ```
/// use chordal::{Job, convert::{Lattice, field_to_grid}, implicit::shapes::sphere};
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
) -> Result<Grid, Stopped> {
    check(lattice, band, job, 8 * lattice.len() as u64)?;
    let tape = field.tape();
    let mut samples = vec![0.0; lattice.len()];
    let layer = lattice.size[0] * lattice.size[1] * BRICK;
    let tasks: Vec<(usize, &mut [f64])> = samples.chunks_mut(layer.max(1)).enumerate().collect();
    debug_assert_eq!(tasks.len(), if lattice.is_empty() { 0 } else { lattice.layers() });
    let done = par_map_owned(job, tasks, |(number, out)| {
        if job.is_cancelled() { Ok(()) } else { fill_layer(&tape, lattice, band, (number, out)) }
    });
    if job.is_cancelled() {
        return Err(Stopped::Cancelled);
    }
    for result in done {
        result.map_err(|error| refused(Code::LeafFailed, error.to_string()))?;
    }
    Grid::new(lattice.size, Samples::F64(samples), lattice.affine)
        .map_err(|error| refused(Code::Empty, error.to_string()))
}

/// [`field_to_grid`] in bricks: those that lie beyond the band, which has to be finite, are not stored.
///
/// The samples are those of [`field_to_grid`], bit for bit. Memory: that of the bricks, and eight planes for each thread.
///
/// # Errors
/// As for [`field_to_grid`].
///
/// ```
/// use chordal::{Job, convert::{Lattice, field_to_grid, field_to_sparse_grid}, implicit::shapes::sphere};
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
) -> Result<SparseGrid, Stopped> {
    let plane = lattice.size[0] * lattice.size[1];
    check(lattice, Some(band), job, 8 * (plane * BRICK) as u64)?;
    let tape = field.tape();
    let numbers: Vec<usize> = (0..lattice.layers()).collect();
    let done = par_map(job, &numbers, |_, number| {
        let planes = BRICK.min(lattice.size[2] - number * BRICK);
        let mut out = vec![0.0; if job.is_cancelled() { 0 } else { plane * planes }];
        if !out.is_empty() {
            fill_layer(&tape, lattice, Some(band), (*number, &mut out))?;
        }
        Ok(Layer::of(&out, lattice.size, band))
    });
    in_bricks(lattice, band, done, job)
}

/// Layers one after the other.
fn in_bricks(
    lattice: &Lattice,
    band: f64,
    layers: Vec<Result<Layer, LeafError>>,
    job: &Job,
) -> Result<SparseGrid, Stopped> {
    if job.is_cancelled() {
        return Err(Stopped::Cancelled);
    }
    let mut grid = SparseGrid::empty(lattice.size, lattice.affine, band);
    for layer in layers {
        grid.push(layer.map_err(|error| refused(Code::LeafFailed, error.to_string()))?);
    }
    Ok(grid)
}

fn refused(code: Code, message: String) -> Stopped {
    Stopped::Refused(Refusal { code, message })
}

/// Refuses a band that is none, and what does not fit.
fn check(lattice: &Lattice, band: Option<f64>, job: &Job, bytes: u64) -> Result<(), Stopped> {
    if let Some(width) = band.filter(|width| width.is_nan() || *width <= 0.0) {
        return Err(refused(Code::Budget, format!("the band is {width}, and must be above 0")));
    }
    if bytes > job.memory_limit {
        let message =
            format!("{} samples need {bytes} bytes; the limit is {}", lattice.len(), job.memory_limit);
        return Err(refused(Code::TooMuchMemory, message));
    }
    Ok(())
}

fn fill_layer(
    tape: &Tape,
    lattice: &Lattice,
    band: Option<f64>,
    (number, out): (usize, &mut [f64]),
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
            // A range may leave out points without a value, which are outside; they are looked at.
            let known = range.is_defined() && !range.is_empty();
            if known && range.lo() > band {
                Some(band)
            } else if known && range.hi() < -band {
                Some(-band)
            } else {
                None
            }
        });
        let [first, end] = *brick;
        for k in first[2]..end[2] {
            for j in first[1]..end[1] {
                for i in first[0]..end[0] {
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
