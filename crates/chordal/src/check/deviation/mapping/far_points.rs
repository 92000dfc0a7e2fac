//! `FarPoints`: candidates for the largest distance between two mapped surfaces, for its lower bound.
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
    /// A bound on its displacement by rounding.
    rounding: f64,
}

/// The most points. Chosen: the first is nearly always the farthest, except if many images slide along the
/// surface.
const MOST: usize = 64;

impl FarPoints {
    /// Adds a point with an upper bound on its distance if it is one of the farthest. `at` computes the point
    /// and a bound on its rounding.
    pub fn add(&mut self, up: f64, at: impl FnOnce() -> ([f64; 3], f64)) {
        let is_far = self.0.len() < MOST || self.0.last().is_some_and(|last| up > last.up);
        if is_far && up < f64::INFINITY {
            let index = self.0.partition_point(|known| known.up >= up);
            let (at, rounding) = at();
            self.0.insert(index, FarPoint { at, up, rounding });
            self.0.truncate(MOST);
        }
    }

    /// The farthest point by a lower bound on its distance. `down` computes the bounds, as long as one may
    /// exceed that of `start` and `enough` is not true of the best.
    pub fn farthest(
        &self,
        start: FarthestSample,
        enough: impl Fn(f64) -> bool,
        down: impl Fn([f64; 3], f64) -> f64,
    ) -> FarthestSample {
        let mut far = start;
        for point in &self.0 {
            // The points are sorted by their upper bounds, so those after this one are no farther.
            if point.up <= far.at_least || enough(far.at_least) {
                break;
            }
            let at_least = down(point.at, point.up);
            let at_least = if point.rounding == 0.0 { at_least } else { sub_down(at_least, point.rounding) };
            if at_least > far.at_least {
                far = FarthestSample { at: point.at, at_least };
            }
        }
        far
    }
}

/// Faces in one task.
const CHUNK: usize = 1 << 13;

/// A lower bound on the distance of a point from a surface, at most `up`: the least over all faces. For a few
/// points that is cheaper than building a tree.
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
        // The difference is rounded once, so it is compared with a number above the length.
        let distance = greater(low - q[k], q[k] - high);
        distance > length * (1.0 + 2.0 * f64::EPSILON) // derived: the product and the difference, rounded once each
    })
}
