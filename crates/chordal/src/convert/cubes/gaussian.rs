//! A Gaussian over the sides of the samples of a lattice: the share of inside samples around each.
use crate::budget::{Job, JobError, par_map};
use crate::math::elementary::exp;

/// The weights of a Gaussian end at this many standard deviations. Chosen: 6e-5 of the weight is farther away.
const REACH: f64 = 4.0;

/// The weights of a sample and of the samples at each distance from it; their sum is 1.
pub(in crate::convert) fn weights(sigma: f64) -> Vec<f64> {
    let reach = (REACH * sigma).ceil() as usize;
    let weight = |distance: usize| match distance {
        0 => 1.0,
        _ => exp(-0.5 * (distance as f64 / sigma) * (distance as f64 / sigma)),
    };
    let all: Vec<f64> = (0..=reach).map(weight).collect();
    let sum = all[0] + 2.0 * all[1..].iter().sum::<f64>();
    all.iter().map(|weight| weight / sum).collect()
}

/// The weighted means of `n` samples along an axis; the last sample is repeated beyond each end.
fn filtered(weights: &[f64], n: usize, value: impl Fn(usize) -> f32, mut out: impl FnMut(usize, f32)) {
    for at in 0..n {
        // Sums of f64 in one order, so that the result is the same everywhere.
        let mut sum = weights[0] * f64::from(value(at));
        for (distance, weight) in weights.iter().enumerate().skip(1) {
            let (low, high) = (at.saturating_sub(distance), (at + distance).min(n - 1));
            sum += weight * (f64::from(value(low)) + f64::from(value(high)));
        }
        out(at, sum as f32);
    }
}

/// The means of 1 for samples inside and 0 for others, by the weights along each index; the first index runs fastest.
pub(in crate::convert) fn smoothed_sides(
    is_inside: impl Fn(usize) -> bool + Sync,
    [nx, ny, nz]: [usize; 3],
    weights: &[Vec<f64>; 3],
    job: &Job,
) -> Result<Vec<f32>, JobError> {
    let planes: Vec<usize> = (0..nz).collect();
    // 1. Along the first two indices, plane by plane.
    let across = par_map(job, &planes, |_, k| {
        if job.is_cancelled() {
            return Vec::new();
        }
        let first = k * nx * ny;
        let mut along: Vec<f32> = Vec::with_capacity(nx * ny);
        for j in 0..ny {
            let side = |i: usize| f32::from(u8::from(is_inside(first + j * nx + i)));
            filtered(&weights[0], nx, side, |_, value| along.push(value));
        }
        let mut plane = vec![0.0_f32; nx * ny];
        for i in 0..nx {
            filtered(&weights[1], ny, |j| along[i + nx * j], |j, value| plane[i + nx * j] = value);
        }
        plane
    });
    if job.is_cancelled() {
        return Err(JobError::Cancelled);
    }
    // 2. Along the last index.
    let smoothed = par_map(job, &planes, |_, k| {
        let mut sums: Vec<f64> = across[*k].iter().map(|value| weights[2][0] * f64::from(*value)).collect();
        for (distance, weight) in weights[2].iter().enumerate().skip(1) {
            let (low, high) = (&across[k.saturating_sub(distance)], &across[(k + distance).min(nz - 1)]);
            for ((sum, low), high) in sums.iter_mut().zip(low).zip(high) {
                *sum += weight * (f64::from(*low) + f64::from(*high));
            }
        }
        sums.into_iter().map(|sum| sum as f32).collect::<Vec<f32>>()
    });
    Ok(smoothed.concat())
}
