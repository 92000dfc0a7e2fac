//! Many rays or points at once: the same answers as one by one, on all threads.
use super::{Bvh, Closest, Hit, Ray};
use crate::budget::{Job, par_map};

/// Queries in a task: at about a microsecond each, worth its start.
const TASK: usize = 1024;

impl Bvh {
    /// [`Bvh::first_hit`] for many rays, in order, on the threads of `job`: the same answers to the last bit.
    #[must_use]
    pub fn first_hits(&self, rays: &[Ray], job: &Job) -> Vec<Option<Hit>> {
        let chunks: Vec<&[Ray]> = rays.chunks(TASK).collect();
        par_map(job, &chunks, |_, chunk| chunk.iter().map(|ray| self.first_hit(ray)).collect::<Vec<_>>())
            .concat()
    }

    /// [`Bvh::closest_point`] for many points, in order, on the threads of `job`: the same answers to the last bit.
    #[must_use]
    pub fn closest_points(&self, points: &[[f64; 3]], job: &Job) -> Vec<Option<Closest>> {
        let chunks: Vec<&[[f64; 3]]> = points.chunks(TASK).collect();
        par_map(job, &chunks, |_, chunk| chunk.iter().map(|p| self.closest_point(*p)).collect::<Vec<_>>())
            .concat()
    }
}
