//! `DistanceSurface`: one of two surfaces, with its distance queries and their answers.
use super::distance::distance_up;
use crate::budget::{Job, JobError};
use crate::explicit::{Bvh, Mesh, Topology, Twins};
use std::borrow::Cow;

/// A point of one surface with a nearby face of the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct DistanceSample {
    pub at: [f64; 3],
    /// An upper bound on the distance to the other surface.
    pub up: f64,
    /// The nearest face of the other surface, up to rounding.
    pub face: u32,
}

/// A surface in the common frame, its bounding volume hierarchy, and its adjacency by bit-identical
/// positions.
pub(super) struct DistanceSurface<'a> {
    mesh: Cow<'a, Mesh>,
    bvh: Bvh,
    twins: Twins,
}

impl<'a> DistanceSurface<'a> {
    pub fn new(mesh: Cow<'a, Mesh>, job: &Job) -> Result<Self, JobError> {
        let bvh = Bvh::build(&mesh, job)?;
        let twins = Twins::new(&mesh, Topology::Positions);
        Ok(Self { mesh, bvh, twins })
    }

    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    pub fn twins(&self) -> &Twins {
        &self.twins
    }

    /// An upper bound on the distance of a point to this surface, and the face to which it is measured.
    pub fn sample(&self, at: [f64; 3]) -> DistanceSample {
        match self.bvh.closest_point(at) {
            Some(closest) => {
                let up = distance_up(at, &self.mesh.corners(closest.face as usize));
                DistanceSample { at, up, face: closest.face }
            }
            // Nothing is known if the surface has no faces or the point is not finite.
            None => DistanceSample { at, up: f64::INFINITY, face: 0 },
        }
    }

    /// The squared distance of a point to this surface, up to rounding.
    pub fn distance_sq(&self, at: [f64; 3]) -> f64 {
        self.bvh.closest_point(at).map_or(f64::INFINITY, |closest| closest.distance_sq)
    }

    /// A lower bound on the distance of a point to this surface.
    pub fn distance_down(&self, at: [f64; 3]) -> f64 {
        self.bvh.closest_distance_down(at).unwrap_or(0.0)
    }

    /// The nearest point of this surface, rounded.
    pub fn nearest(&self, at: [f64; 3]) -> [f64; 3] {
        self.bvh.closest_point(at).map_or(at, |closest| closest.point)
    }
}
