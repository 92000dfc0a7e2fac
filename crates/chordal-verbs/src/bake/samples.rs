//! `BakedSamples`: distances on a lattice, dense or in bricks, and bounds for their errors.
use crate::MeshFailure;
use chordal::budget::{JobError, Refusal, RefusalCode, par_map};
use chordal::convert::lattices::Lattice;
use chordal::explicit::query::Bvh;
use chordal::implicit::evaluation::{SampleGrid, Tape};
use chordal::implicit::leaves::LeafError;
use chordal::implicit::{Affine3, Field, Grid, SparseGrid};
use chordal::math::{Box3, Interval, add_up, greater, mul_up, sub_up};
use chordal::{Job, Mesh};
use std::sync::Arc;

/// Samples on a lattice.
#[derive(Clone, Debug)]
pub(crate) enum BakedSamples {
    /// All samples.
    Dense(Arc<Grid>),
    /// The samples of the bricks that a band reaches.
    Sparse(Arc<SparseGrid>),
}

impl SampleGrid for BakedSamples {
    fn size(&self) -> [usize; 3] {
        match self {
            Self::Dense(grid) => grid.size(),
            Self::Sparse(grid) => grid.size(),
        }
    }

    fn affine(&self) -> &Affine3 {
        match self {
            Self::Dense(grid) => grid.affine(),
            Self::Sparse(grid) => grid.affine(),
        }
    }

    #[inline]
    fn sample(&self, index: [usize; 3]) -> f64 {
        match self {
            Self::Dense(grid) => grid.sample(index),
            Self::Sparse(grid) => grid.sample(index),
        }
    }

    fn is_stored(&self, index: [usize; 3]) -> bool {
        match self {
            Self::Dense(_) => true,
            Self::Sparse(grid) => grid.is_stored(index),
        }
    }
}

/// The largest error of samples that are distances to triangles: each is compared with a lower and an upper bound of the
/// distance, rounding included.
pub(crate) fn off_at_most<G: SampleGrid>(
    mesh: &Mesh,
    (grid, band): (&G, f64),
    job: &Job,
) -> Result<f64, MeshFailure> {
    let bvh = Bvh::build(mesh, job).map_err(MeshFailure::from)?;
    let error_of = |samples: &[([f64; 3], f64)]| {
        let mut hint = 0;
        let errors = samples.iter().map(|(p, value)| {
            // Without triangles the distance is unbounded.
            let [down, up] =
                bvh.closest_distance_ends(*p, &mut hint).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            greater(sub_up(value.abs(), down), sub_up(up, value.abs()))
        });
        Ok(errors.fold(0.0, greater))
    };
    Ok(largest(grid, band, &error_of, job)?)
}

/// The largest error of samples of a field whose value is the distance: each is compared with the field's range at its
/// point.
pub(super) fn error_from_field<G: SampleGrid>(
    field: &Field,
    (grid, band): (&G, f64),
    job: &Job,
) -> Result<f64, MeshFailure> {
    let tape = field.tape();
    Ok(largest(grid, band, &|samples| error_from_tape(&tape, samples), job)?)
}

fn error_from_tape(tape: &Tape, samples: &[([f64; 3], f64)]) -> Result<f64, LeafError> {
    let points: Vec<Box3> = samples.iter().map(|(p, _)| Box3 { min: *p, max: *p }).collect();
    let mut ranges = vec![Interval::ENTIRE; points.len()];
    tape.over(&points, &mut ranges)?;
    let errors = ranges.iter().zip(samples).map(|(range, (_, value))| {
        if !range.is_defined() || range.is_empty() {
            return f64::INFINITY;
        }
        greater(sub_up(*value, range.lo()), sub_up(range.hi(), *value))
    });
    Ok(errors.fold(0.0, greater))
}

/// A function from the points and values of a brick to their largest error.
type BrickJudge<'a> = dyn Fn(&[([f64; 3], f64)]) -> Result<f64, LeafError> + Sync + 'a;

/// The largest result of `judge` for the samples below the band, brick by brick.
fn largest<G: SampleGrid>(grid: &G, band: f64, judge: &BrickJudge<'_>, job: &Job) -> Result<f64, JobError> {
    let lattice = Lattice { size: grid.size(), affine: *grid.affine() };
    let layers: Vec<usize> = (0..lattice.layers()).collect();
    let layer_errors = par_map(job, &layers, |_, layer| {
        let (mut most, mut samples) = (0.0, Vec::new());
        for [first, end] in lattice.bricks(*layer) {
            if job.is_cancelled() {
                break;
            }
            // A brick is stored as a whole: the samples of any other are the background, which is no distance.
            if !grid.is_stored(first) {
                continue;
            }
            for k in first[2]..end[2] {
                for j in first[1]..end[1] {
                    for i in first[0]..end[0] {
                        let value = grid.sample([i, j, k]);
                        if value.abs() < band {
                            samples.push((lattice.at([i, j, k]), value));
                        }
                    }
                }
            }
            // Several bricks at once, so that the overhead of a call does not count.
            if samples.len() >= BATCH {
                most = greater(most, judge(&samples)?);
                samples.clear();
            }
        }
        Ok(greater(most, judge(&samples)?))
    });
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    layer_errors.into_iter().try_fold(0.0, |most, error| match error {
        Ok(error) => Ok(greater(most, error)),
        Err(LeafError { message, .. }) => {
            Err(JobError::Refused(Refusal::new(RefusalCode::LeafFailed, message)))
        }
    })
}

/// Samples that are judged at once. Chosen: some bricks of 512.
const BATCH: usize = 2048;

/// A bound for the difference between the interpolant of distances and the distance, at any point of a cell, if the error
/// of no sample exceeds `sample_error`.
///
/// Derived: a signed distance changes by no more than the point moves. With the weights w of the corners c of the
/// cell, |Σ w·v(c) − d(p)| ≤ Σ w·(|v(c) − d(c)| + |c − p|), and Σ w·|c − p| ≤ √(Σ w·|c − p|²), which is at most half
/// the diagonal of the cell. The rounding of the samples' places counts as an error of the samples.
pub(crate) fn interpolant_error<G: SampleGrid>(grid: &G, sample_error: f64) -> f64 {
    /// √3/2, rounded up.
    const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_7;
    let (rows, size) = (grid.affine().rows(), grid.size());
    let (mut spacing, mut reach) = (0.0, 0.0);
    for k in 0..3 {
        spacing = greater(rows[k][k].abs(), spacing);
        reach = greater(rows[k][k].abs() * size[k] as f64 + rows[k][3].abs(), reach);
    }
    // Two roundings along each axis, of coordinates up to `reach`.
    let position_error = 4.0 * f64::EPSILON * reach;
    add_up(mul_up(HALF_DIAGONAL, spacing), add_up(sample_error, position_error))
}
