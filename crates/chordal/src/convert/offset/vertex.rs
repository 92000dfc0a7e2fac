//! Where a cell's vertex goes: onto the crease or corner in which the planes around it meet, or onto the smooth surface.
//!
//! Source: T. Ju, F. Losasso, S. Schaefer, J. Warren, *Dual Contouring of Hermite Data*, 2002, for the quadratic error
//! function and the directions without information that are left out of it.
use super::distance::{Hint, OffsetDistance, Plane, along};
use crate::math::{difference, dot, greater};

/// Eigenvalues below this share of the largest carry no position. Chosen: planes that differ by 16 degrees meet in a line.
const FLAT: f64 = 0.02;
/// Sweeps of Jacobi's method: three rotations each; four reach rounding for symmetric 3 × 3 matrices.
const SWEEPS: usize = 5;
/// Planes closer together than this, by cosine, are one smooth part.
const CREASE: f64 = 0.9;
/// The way from the meeting point to the planes' points at which planes are sampled again: near it they are those that
/// meet there, and not those of a curved part beside it.
const SHARES: [f64; 2] = [0.3, 0.05];
/// A meeting point may be outside of its cell by this share of the cell's size: it is moved back. Chosen.
const MARGIN: f64 = 0.05;
/// Vertices stay this far from the sides of their cell, as a share of its size, so that triangles of different cells do not
/// touch. Chosen.
pub(super) const INSET: f64 = 0.005;
/// Steps onto a smooth surface. The second is for feet that the first step's normal missed.
const STEPS: usize = 2;

/// A vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedVertex {
    pub at: [f64; 3],
    /// Whether planes meet there in a crease or a corner.
    pub is_crease: bool,
    /// Whether it was found within the cell; otherwise the cell should be cut.
    pub is_sure: bool,
}

/// The point nearest to `mean` that minimizes the squared distances to all planes.
pub(super) fn meeting_point(planes: &[Plane], mean: [f64; 3]) -> [f64; 3] {
    let mut a = [[0.0; 3]; 3];
    let mut b = [0.0; 3];
    for plane in planes {
        let n = plane.normal;
        let height = dot(n, difference(plane.at, mean));
        for i in 0..3 {
            b[i] += n[i] * height;
            for j in 0..3 {
                a[i][j] += n[i] * n[j];
            }
        }
    }
    let axes = eigenvectors(&mut a);
    let most = (0..3).fold(0.0, |most, k| greater(a[k][k], most));
    let mut meeting = mean;
    for k in 0..3 {
        if a[k][k] > FLAT * most {
            let axis = axes.map(|row| row[k]);
            meeting = along(meeting, dot(axis, b) / a[k][k], axis);
        }
    }
    meeting
}

/// Makes a symmetric matrix diagonal by Jacobi's rotations; the columns of the result are its axes.
fn eigenvectors(a: &mut [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let ratio = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let tangent = ratio.signum() / (ratio.abs() + (ratio * ratio + 1.0).sqrt());
            let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sine = tangent * cosine;
            let rotate =
                |x: &mut [f64; 3]| (x[p], x[q]) = (cosine * x[p] - sine * x[q], sine * x[p] + cosine * x[q]);
            a.iter_mut().for_each(rotate);
            let rows = [a[p], a[q]];
            a[p] = std::array::from_fn(|k| cosine * rows[0][k] - sine * rows[1][k]);
            a[q] = std::array::from_fn(|k| sine * rows[0][k] + cosine * rows[1][k]);
            axes.iter_mut().for_each(rotate);
        }
    }
    axes
}

/// The vertex of a part of the surface in a cell, from the planes where it crosses the cell's edges.
pub(super) fn place(distance: &OffsetDistance, planes: &[Plane], [low, high]: [[f64; 3]; 2]) -> PlacedVertex {
    let n = planes.len() as f64;
    let mean: [f64; 3] = std::array::from_fn(|k| planes.iter().map(|p| p.at[k]).sum::<f64>() / n);
    let is_near_cell = |p: [f64; 3]| {
        (0..3).all(|k| {
            let margin = MARGIN * (high[k] - low[k]);
            p[k] >= low[k] - margin && p[k] <= high[k] + margin
        })
    };
    let clamped = |p: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|k| {
            let inset = INSET * (high[k] - low[k]);
            p[k].clamp(low[k] + inset, high[k] - inset)
        })
    };
    let mut hint = Hint::default();
    let mut plane_at = |p: [f64; 3]| distance.at(p, &mut hint).plane();
    let is_crease = (1..planes.len())
        .any(|i| planes[..i].iter().any(|other| dot(planes[i].normal, other.normal) < CREASE));
    if is_crease {
        let mut meeting = meeting_point(planes, mean);
        let mut is_sure = is_near_cell(meeting);
        for share in SHARES {
            if !is_sure {
                break;
            }
            let near: Vec<Plane> =
                planes.iter().map(|p| plane_at(along(meeting, share, difference(p.at, meeting)))).collect();
            let nearer = meeting_point(&near, meeting);
            is_sure = is_near_cell(nearer);
            if is_sure {
                meeting = nearer;
            }
        }
        if is_sure {
            return PlacedVertex { at: clamped(meeting), is_crease, is_sure };
        }
    }
    let mut at = clamped(mean);
    for _ in 0..STEPS {
        at = clamped(plane_at(at).at);
    }
    PlacedVertex { at, is_crease: false, is_sure: !is_crease }
}
