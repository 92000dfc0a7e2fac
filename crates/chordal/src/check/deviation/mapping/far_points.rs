//! `FarPoints`: where two mapped surfaces may be the farthest apart, for the lower end of the bound.
use super::super::hausdorff::FarthestSample;
use super::surface::FanSurface;
use crate::budget::{Job, par_map};
use crate::explicit::distance_to_triangle_down;
use crate::math::{greater, lesser, sub_down};

/// A few points with upper bounds on their distances, the farthest first.
#[derive(Default)]
pub(super) struct FarPoints(Vec<FarPoint>);

#[derive(Clone, Copy)]
struct FarPoint {
    at: [f64; 3],
    up: f64,
    /// How far it may be off by rounding.
    off: f64,
}

/// The most of them. Chosen: the first is nearly always the farthest, except where many images slide along the surface.
const MOST: usize = 64;

impl FarPoints {
    /// Adds a point with an upper bound on its distance if it is one of the farthest. `at` says where it is, and how
    /// far that may be off.
    pub fn add(&mut self, up: f64, at: impl FnOnce() -> ([f64; 3], f64)) {
        let is_far = self.0.len() < MOST || self.0.last().is_some_and(|last| up > last.up);
        if is_far && up < f64::INFINITY {
            let place = self.0.partition_point(|known| known.up >= up);
            let (at, off) = at();
            self.0.insert(place, FarPoint { at, up, off });
            self.0.truncate(MOST);
        }
    }

    /// The farthest by a lower bound on the distance, which is asked for as long as it may rise above `known` and is
    /// not `enough`.
    pub fn farthest(
        &self,
        known: FarthestSample,
        enough: impl Fn(f64) -> bool,
        down: impl Fn([f64; 3], f64) -> f64,
    ) -> FarthestSample {
        let mut far = known;
        for point in &self.0 {
            if point.up <= far.at_least || enough(far.at_least) {
                break;
            }
            let at_least = down(point.at, point.up);
            let at_least = if point.off == 0.0 { at_least } else { sub_down(at_least, point.off) };
            if at_least > far.at_least {
                far = FarthestSample { at: point.at, at_least };
            }
        }
        far
    }
}

/// Faces in one task.
const CHUNK: usize = 1 << 13;

/// A lower bound on the distance of a point from a surface, at most `up`: the least over all faces. For a few points
/// that is less than a tree costs.
pub(super) fn distance_down_to_all(surface: &FanSurface, q: [f64; 3], up: f64, job: &Job) -> f64 {
    let faces: Vec<u32> = (0..surface.n_faces() as u32).step_by(CHUNK).collect();
    let least = par_map(job, &faces, |_, first| {
        let end = lesser(*first as usize + CHUNK, surface.n_faces()) as u32;
        (*first..end).fold(up, |least, face| {
            let corners = surface.corners(face);
            if is_beyond(q, corners, least) {
                return least;
            }
            let down = distance_to_triangle_down(q, corners, least);
            lesser(least, down)
        })
    });
    least.into_iter().fold(up, lesser)
}

/// Whether the box around a triangle is surely farther away than a length.
#[inline]
fn is_beyond(q: [f64; 3], [a, b, c]: [[f64; 3]; 3], length: f64) -> bool {
    (0..3).any(|k| {
        let (low, high) = if a[k] < b[k] { (a[k], b[k]) } else { (b[k], a[k]) };
        let (low, high) = (lesser(c[k], low), greater(c[k], high));
        // Rounded once, so that it is compared with a number above the length.
        let off = greater(low - q[k], q[k] - high);
        off > length * (1.0 + 2.0 * f64::EPSILON) // derived: the product and the difference, rounded once each
    })
}
