//! `MappedPair`: two surfaces of which it is known which parts stand for each other, and how far they are apart.
mod cells;
mod crossing;
mod far_points;
mod images;
mod nearby;
mod part;
mod paths;
mod surface;
#[cfg(test)]
mod tests;

use super::hausdorff::{FarthestSample, OneSidedSearch};
use super::violations::ViolationReport;
use super::{CommonFrame, Deviation, Goal, SurfacePair, two_sided};
use crate::budget::{Job, JobError};
use crate::explicit::{Bvh, Mesh, Topology, distance_sq_to_triangle};
use crate::math::{add_up, greater};
use cells::{SurfaceMapping, surface_mapping};
use far_points::distance_down_to_all;
use images::{VertexImage, largest_distance_sq, vertex_images};
use nearby::{NearbySearch, Side};
use part::NearbyPair;
use paths::edge_paths;
use std::borrow::Cow;
use surface::{FanSurface, NONE};

/// For each vertex of a mesh a face of another one that is near it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearFaces<'a> {
    /// By row: a face of the other mesh, or more than it has where none is known.
    pub by_row: &'a [u32],
    /// Which rows of the mesh are one position.
    pub topology: Topology,
}

/// For each vertex of a surface the face of another one that is nearest to it, as far as a descent from a face near it
/// tells.
pub(crate) struct NearestFaces {
    source: FanSurface,
    result: FanSurface,
    images: Vec<VertexImage>,
}

impl NearestFaces {
    /// From the faces `near` of `a`'s vertices.
    pub fn new(a: &Mesh, b: &Mesh, near: NearFaces<'_>, job: &Job) -> Self {
        let source = FanSurface::new(a, near.topology.ids(a).as_deref());
        let result = FanSurface::new(b, Topology::Indices.ids(b).as_deref());
        let images = vertex_images(&source, &result, (a.faces().as_flattened(), near.by_row), job);
        Self { source, result, images }
    }

    /// The face for the vertex at the start of a half-edge of `a`, and the squared distance, rounded.
    pub fn of_corner(&self, h: u32) -> Option<(u32, f64)> {
        Some(self.images[self.source.start(h) as usize])
            .filter(|image| image.face != NONE)
            .map(|image| (image.face, image.distance_sq))
    }

    /// The squared distance of a point from a face, rounded.
    pub fn distance_sq(&self, p: [f64; 3], face: u32) -> f64 {
        distance_sq_to_triangle(p, self.result.corners(face))
    }

    /// The same for a point, by a descent from a face.
    pub fn descend_from(&self, p: [f64; 3], face: u32) -> (u32, f64) {
        let image = VertexImage::on_face(p, face, &self.result).descend(p, &self.result);
        (image.face, image.distance_sq)
    }
}

/// A mesh and another one that stands for it piece by piece, as a simplified one does.
///
/// Both surfaces are mapped onto each other, which bounds most faces without a search: `cells.rs` has the proof. The
/// faces that are near are not trusted: a wrong one costs time.
///
/// Cost: 0.4 µs a triangle of the first mesh on one core; 130 bytes a triangle.
pub(crate) struct MappedPair<'a> {
    meshes: [&'a Mesh; 2],
    local: [Cow<'a, Mesh>; 2],
    shared: CommonFrame,
    source: FanSurface,
    result: FanSurface,
    images: Vec<VertexImage>,
    mapping: SurfaceMapping,
}

/// How far walks may be beyond the farthest vertex before others are tried. Chosen: as [`Goal::relative`].
const PATH_SLACK: f64 = 1.1;
/// The share of the length that is asked for within which walks are close enough. Chosen: with what a frame rounds off,
/// they are still within the length.
const NEARLY: f64 = 0.95;
/// So few faces without a bound are looked at alone before everything is searched. Chosen.
const FEW: usize = 256;
/// Beyond this share of faces without a bound all of them are searched at once. Chosen.
const MOST_ALONE: usize = 4;

impl<'a> MappedPair<'a> {
    /// Maps `a` onto `b`. Walks that stay within `asked`, a length that may be 0, are not improved.
    ///
    /// # Errors
    /// As for [`super::deviation`].
    pub fn new(
        a: &'a Mesh,
        b: &'a Mesh,
        (near, asked): (NearFaces<'_>, f64),
        job: &Job,
    ) -> Result<Self, JobError> {
        job.run(|| {
            let meshes = [a, b];
            let (shared, local) = CommonFrame::around(meshes)?;
            // From the original meshes: positions that the frame rounds to the same number need not be equal.
            let source = FanSurface::new(&local[0], near.topology.ids(a).as_deref());
            let result = FanSurface::new(&local[1], Topology::Indices.ids(b).as_deref());
            let rows = a.faces().as_flattened();
            let images = vertex_images(&source, &result, (rows, near.by_row), job);
            let enough = greater(PATH_SLACK * largest_distance_sq(&images).sqrt(), shared.floor());
            let enough = greater(enough, NEARLY * shared.frame.local_length(asked));
            let paths = edge_paths(&source, &result, &images, (enough, job));
            let mapping = surface_mapping(&source, &result, &images, (&paths, job));
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            Ok(Self { meshes, local, shared, source, result, images, mapping })
        })
    }

    /// The distance of both, as by [`super::deviation`]; `known` is an upper bound on it, which may be infinite.
    ///
    /// # Errors
    /// As for [`super::deviation`].
    pub fn deviation(&self, known: f64, goal: &Goal, job: &Job) -> Result<Deviation, JobError> {
        job.run(|| {
            // The lower end: the vertices that are the farthest from their images.
            let tree = Bvh::build(&self.local[1], job)?;
            let [from_source, from_result] = &self.mapping.farthest;
            let wanted = self.shared.goal(goal);
            let most = [&self.mapping.forward, &self.mapping.backward].map(|up| largest_known(up));
            let most = greater(most[0], most[1]);
            let enough = |least: f64| wanted.sufficient_distance(least) >= most;
            let none = FarthestSample { at: self.source.at(0), at_least: 0.0 };
            let down = |at, _| tree.closest_distance_down(at).unwrap_or(0.0);
            let far = from_source.farthest(none, |_| false, down);
            let to = tree.closest_point(far.at).map_or(far.at, |closest| closest.point);
            let down = |at, up| distance_down_to_all(&self.source, at, up, job);
            let from = FarthestSample { at: to, at_least: 0.0 };
            let back = if enough(far.at_least) { from } else { from_result.farthest(from, enough, down) };
            let enough = wanted.sufficient_distance(greater(far.at_least, back.at_least));
            let done = |up: [f64; 2]| {
                let forward = self.shared.one_sided(far, (up[0], self.shared.moved), to);
                let backward = self.shared.one_sided(back, (up[1], self.shared.moved), self.nearest(back.at));
                let bound = two_sided(&forward, &backward);
                Deviation { bound, forward, backward, reached: true }
            };
            // Exact, but for what underflows, which is rounded up.
            let known = self.shared.frame.local_length(known);
            if known <= enough {
                return Ok(done([known; 2]));
            }
            let settled = self.settle(enough, job);
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            if settled.iter().all(|settled| settled.open.is_empty()) {
                return Ok(done(settled.map(|settled| settled.up)));
            }
            if settled.iter().all(|settled| settled.open.len() <= FEW) {
                let open = settled.each_ref().map(|settled| settled.open.as_slice());
                let found = NearbyPair::new(self, open, (enough, job))?.violations(enough, job);
                if job.is_cancelled() {
                    return Err(JobError::Cancelled);
                }
                if found.is_empty() {
                    let up = self.shared.frame.local_length(found.at_most);
                    return Ok(done(settled.map(|settled| greater(settled.up, up))));
                }
            }
            self.search(settled, [far, back], (goal, job))
        })
    }

    /// Searches the faces that are open.
    fn search(
        &self,
        settled: [Settled; 2],
        far: [FarthestSample; 2],
        (goal, job): (&Goal, &Job),
    ) -> Result<Deviation, JobError> {
        let pair = SurfacePair::from_meshes(self.meshes, job)?;
        let [first, second] = &pair.sides;
        let up = [0, 1].map(|k| (settled[k].up, settled[k].n > 0));
        let vertices = pair.vertices_of(settled.map(|settled| settled.open), job);
        let mut both = [
            OneSidedSearch::new(first, second, &vertices[0]),
            OneSidedSearch::new(second, first, &vertices[1]),
        ];
        for ((direction, far), (up, is_bounded)) in both.iter_mut().zip(far).zip(up) {
            direction.settled = greater(direction.settled, up);
            // Also where none of its faces is left to be searched.
            direction.is_displaced |= is_bounded;
            if far.at_least > direction.farthest.at_least {
                direction.farthest = far;
                direction.is_displaced = true;
            }
        }
        pair.search(&mut both, &vertices, goal, job)
    }

    /// The nearest point of the source, rounded.
    fn nearest(&self, at: [f64; 3]) -> [f64; 3] {
        let nearer = |best: (f64, u32), face: u32| {
            let d = distance_sq_to_triangle(at, self.source.corners(face));
            if d < best.0 { (d, face) } else { best }
        };
        let (_, face) = (0..self.source.n_faces() as u32).fold((f64::INFINITY, 0), nearer);
        VertexImage::on_face(at, face, &self.source).at
    }

    /// Faces that are farther away than a length, or may be, as by [`super::tolerance_violations`].
    pub fn violations(&self, length: f64, job: &Job) -> Result<ViolationReport, JobError> {
        job.run(|| {
            let enough = self.shared.limit(length).within();
            let settled = self.settle(enough, job);
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            let moved = self.shared.moved;
            // A limit below what the frame rounds settles nothing; then faces that both share are within it.
            let most = settled.iter().filter(|settled| settled.n > 0).fold(0.0, |most, settled| {
                greater(most, if moved > 0.0 { add_up(settled.up, moved) } else { settled.up })
            });
            let most = self.shared.frame.length_up(most);
            let mut found = ViolationReport { violations: Default::default(), at_most: 0.0, pixels: 0.0 };
            if settled.iter().any(|settled| !settled.open.is_empty()) {
                let open = settled.each_ref().map(|settled| settled.open.as_slice());
                found = NearbyPair::new(self, open, (enough, job))?.violations(enough, job);
                if job.is_cancelled() {
                    return Err(JobError::Cancelled);
                }
            }
            Ok(ViolationReport { at_most: greater(found.at_most, most), ..found })
        })
    }

    /// The faces of either surface that are not known to be within a distance of the frame, and how far the others
    /// are.
    fn settle(&self, enough: f64, job: &Job) -> [Settled; 2] {
        let SurfaceMapping { forward, backward, .. } = &self.mapping;
        let mut nearby = None;
        [(forward, Side::Source), (backward, Side::Result)].map(|(up, side)| {
            let open: Vec<u32> = (0..up.len() as u32).filter(|face| up[*face as usize] > enough).collect();
            let within = up.iter().filter(|up| **up <= enough);
            let most = within.fold(0.0, |most, up| greater(most, *up));
            let mut settled = Settled { up: most, n: up.len() - open.len(), open };
            if settled.open.is_empty() || settled.open.len() > up.len() / MOST_ALONE {
                return settled;
            }
            let nearby =
                nearby.get_or_insert_with(|| NearbySearch::new(&self.source, &self.result, &self.images));
            let bounds = nearby.bounds(&settled.open, side, (enough, job));
            let known = bounds.iter().filter_map(|up| *up);
            settled.up = known.fold(settled.up, greater);
            let open = settled.open.iter().zip(&bounds).filter(|(_, up)| up.is_none());
            settled.open = open.map(|(face, _)| *face).collect();
            settled.n = up.len() - settled.open.len();
            settled
        })
    }
}

/// What is known of the faces of one surface.
struct Settled {
    /// The largest distance of those that are within what was asked.
    up: f64,
    /// How many those are.
    n: usize,
    /// The others.
    open: Vec<u32>,
}

/// The largest of the bounds that are known.
fn largest_known(up: &[f64]) -> f64 {
    up.iter().filter(|up| **up < f64::INFINITY).fold(0.0, |most, up| greater(most, *up))
}
