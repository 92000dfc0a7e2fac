//! Fields to grids of samples, by bricks that ranges prune.
use super::lattice::{BRICK, Lattice};
use crate::budget::{Code, Job, Refusal, Stopped, par_map_owned};
use crate::implicit::{Field, Grid, LeafError, Samples, Tape};
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
    let refused = |code, message: String| Stopped::Refused(Refusal { code, message });
    if let Some(width) = band.filter(|width| width.is_nan() || *width <= 0.0) {
        return Err(refused(Code::Budget, format!("the band is {width}, and must be above 0")));
    }
    let bytes = 8 * lattice.len() as u64;
    if bytes > job.memory_limit {
        let message =
            format!("{} samples need {bytes} bytes; the limit is {}", lattice.len(), job.memory_limit);
        return Err(refused(Code::TooMuchMemory, message));
    }
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
