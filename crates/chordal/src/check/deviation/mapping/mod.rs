//! `MappedPair`: two surfaces with known correspondences between their parts, and the distance between them.
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

/// For each vertex of a mesh, a nearby face of another mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearFaces<'a> {
    /// By row: a face of the other mesh, or a number past its last face if none is known.
    pub by_row: &'a [u32],
    /// Which rows of the mesh share a position.
    pub topology: Topology,
}

/// For each vertex of a surface, the nearest face of another one, as far as a descent from a face near it
/// finds it.
pub(crate) struct NearestFaces {
    source: FanSurface,
    result: FanSurface,
    images: Vec<VertexImage>,
}

impl NearestFaces {
    /// From `near`, a face near each vertex of `a`.
    pub fn new(a: &Mesh, b: &Mesh, near: NearFaces<'_>, job: &Job) -> Self {
        let source = FanSurface::new(a, near.topology.ids(a).as_deref());
        let result = FanSurface::new(b, Topology::Indices.ids(b).as_deref());
        let images = vertex_images(&source, &result, (a.faces().as_flattened(), near.by_row), job);
        Self { source, result, images }
    }

    /// The face for the vertex at the start of a half-edge of `a`, and its squared distance, rounded.
    pub fn of_corner(&self, h: u32) -> Option<(u32, f64)> {
        Some(self.images[self.source.start(h) as usize])
            .filter(|image| image.face != NONE)
            .map(|image| (image.face, image.distance_sq))
    }

    /// The squared distance of a point from a face, rounded.
    pub fn distance_sq(&self, p: [f64; 3], face: u32) -> f64 {
        distance_sq_to_triangle(p, self.result.corners(face))
    }

    /// The nearest face to a point and its squared distance, by a descent from a face.
    pub fn descend_from(&self, p: [f64; 3], face: u32) -> (u32, f64) {
        let image = VertexImage::on_face(p, face, &self.result).descend(p, &self.result);
        (image.face, image.distance_sq)
    }
}

/// A mesh and another one that replaces it piece by piece, as a simplified mesh does.
///
/// Both surfaces are mapped onto each other, which bounds most faces without a search: `cells.rs` has the
/// proof. The nearby faces are hints: a wrong one costs time, never the proof.
///
/// Cost: 0.4 µs a triangle of the first mesh on one core; 130 bytes a triangle.
pub(crate) struct MappedPair<'a> {
    meshes: [&'a Mesh; 2],
    local: [Cow<'a, Mesh>; 2],
    common_frame: CommonFrame,
    source: FanSurface,
    result: FanSurface,
    images: Vec<VertexImage>,
    mapping: SurfaceMapping,
}

/// Walks up to this multiple of the farthest vertex's distance are accepted. Chosen: as [`Goal::relative`].
const PATH_SLACK: f64 = 1.1;
/// The share of the wanted length within which walks are close enough. Chosen: together with the rounding of
/// the frame they are still within the length.
const NEARLY: f64 = 0.95;
/// Up to so many faces without a bound are compared on their own before everything is searched. Chosen: a
/// larger value tries this for more pairs, and loses the time if a violation remains.
const FEW: usize = 256;
/// If more than one in so many faces has no bound, all of them are searched at once. Chosen: a larger value
/// searches among nearby faces less often.
const MOST_ALONE: usize = 4;

impl<'a> MappedPair<'a> {
    /// Maps `a` onto `b`. Walks that stay within `length`, which may be 0, are not improved.
    ///
    /// # Errors
    /// As for [`super::deviation`].
    pub fn new(
        a: &'a Mesh,
        b: &'a Mesh,
        (near, length): (NearFaces<'_>, f64),
        job: &Job,
    ) -> Result<Self, JobError> {
        job.run(|| {
            let meshes = [a, b];
            let (common_frame, local) = CommonFrame::around(meshes)?;
            // From the original meshes: positions that the frame rounds to the same number need not be equal.
            let source = FanSurface::new(&local[0], near.topology.ids(a).as_deref());
            let result = FanSurface::new(&local[1], Topology::Indices.ids(b).as_deref());
            let rows = a.faces().as_flattened();
            let images = vertex_images(&source, &result, (rows, near.by_row), job);
            // No image is nearer than its vertex allows, so a walk that stays about as near as the
            // farthest vertex does not widen the bound. Below the floor or the wanted length
            // nothing is gained either.
            let enough = greater(PATH_SLACK * largest_distance_sq(&images).sqrt(), common_frame.floor());
            let enough = greater(enough, NEARLY * common_frame.frame.local_length(length));
            let paths = edge_paths(&source, &result, &images, (enough, job));
            let mapping = surface_mapping(&source, &result, &images, (&paths, job));
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            Ok(Self { meshes, local, common_frame, source, result, images, mapping })
        })
    }

    /// The distance between both, as by [`super::deviation`]; `known_bound` is an upper bound on it, which
    /// may be infinite.
    ///
    /// # Errors
    /// As for [`super::deviation`].
    pub fn deviation(&self, known_bound: f64, goal: &Goal, job: &Job) -> Result<Deviation, JobError> {
        job.run(|| {
            // The lower bound: the vertices that are the farthest from their images.
            let tree = Bvh::build(&self.local[1], job)?;
            let [from_source, from_result] = &self.mapping.farthest;
            let wanted = self.common_frame.goal(goal);
            let most = [&self.mapping.forward, &self.mapping.backward].map(|up| largest_known(up));
            let most = greater(most[0], most[1]);
            let enough = |least: f64| wanted.sufficient_distance(least) >= most;
            let none = FarthestSample { at: self.source.at(0), at_least: 0.0 };
            let down = |at, _| tree.closest_distance_down(at).unwrap_or(0.0);
            // From the source every candidate is tried, since the tree answers at once. The other
            // way each candidate is a pass over all faces, so it stops as soon as the goal is met.
            let far = from_source.farthest(none, |_| false, down);
            let to = tree.closest_point(far.at).map_or(far.at, |closest| closest.point);
            let down = |at, up| distance_down_to_all(&self.source, at, up, job);
            let from = FarthestSample { at: to, at_least: 0.0 };
            let back = if enough(far.at_least) { from } else { from_result.farthest(from, enough, down) };
            let enough = wanted.sufficient_distance(greater(far.at_least, back.at_least));
            let result_of = |up: [f64; 2]| {
                let forward = self.common_frame.one_sided(far, (up[0], self.common_frame.displacement), to);
                let backward = self.common_frame.one_sided(
                    back,
                    (up[1], self.common_frame.displacement),
                    self.nearest(back.at),
                );
                let bound = two_sided(&forward, &backward);
                Deviation { bound, forward, backward, reached: true }
            };
            // Scaling is exact except for underflow, which is rounded up.
            let known_bound = self.common_frame.frame.local_length(known_bound);
            if known_bound <= enough {
                return Ok(result_of([known_bound; 2]));
            }
            let settled = self.settle(enough, job);
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            if settled.iter().all(|settled| settled.open.is_empty()) {
                return Ok(result_of(settled.map(|settled| settled.up)));
            }
            // A few faces are decided against the parts around them. That only counts if all of
            // them are within the length: a violation would need its exact distance, and so the
            // search.
            if settled.iter().all(|settled| settled.open.len() <= FEW) {
                let open = settled.each_ref().map(|settled| settled.open.as_slice());
                let report = NearbyPair::new(self, open, (enough, job))?.violations(enough, job);
                if job.is_cancelled() {
                    return Err(JobError::Cancelled);
                }
                if report.is_empty() {
                    let up = self.common_frame.frame.local_length(report.at_most);
                    return Ok(result_of(settled.map(|settled| greater(settled.up, up))));
                }
            }
            self.search(settled, [far, back], (goal, job))
        })
    }

    /// Searches the faces without a bound.
    fn search(
        &self,
        settled: [Settled; 2],
        far: [FarthestSample; 2],
        (goal, job): (&Goal, &Job),
    ) -> Result<Deviation, JobError> {
        let pair = SurfacePair::from_meshes(self.meshes, job)?;
        let [first, second] = &pair.sides;
        // Bounds that the cells have proved go on counting; the search starts with the faces that
        // are left.
        let up = [0, 1].map(|k| (settled[k].up, settled[k].n > 0));
        let vertices = pair.vertices_of(settled.map(|settled| settled.open), job);
        let mut directions = [
            OneSidedSearch::new(first, second, &vertices[0]),
            OneSidedSearch::new(second, first, &vertices[1]),
        ];
        for ((direction, far), (up, is_bounded)) in directions.iter_mut().zip(far).zip(up) {
            direction.settled = greater(direction.settled, up);
            // A side may have bounded faces although none of its faces is left to be searched.
            direction.is_displaced |= is_bounded;
            if far.at_least > direction.farthest.at_least {
                direction.farthest = far;
                direction.is_displaced = true;
            }
        }
        pair.search(&mut directions, &vertices, goal, job)
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
            let enough = self.common_frame.limit(length).within();
            let settled = self.settle(enough, job);
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            let displacement = self.common_frame.displacement;
            // If the limit is below the rounding of the frame, no face is settled; faces that both share are
            // within it.
            let most = settled.iter().filter(|settled| settled.n > 0).fold(0.0, |most, settled| {
                greater(most, if displacement > 0.0 { add_up(settled.up, displacement) } else { settled.up })
            });
            let most = self.common_frame.frame.length_up(most);
            let mut report = ViolationReport { violations: Default::default(), at_most: 0.0, pixels: 0.0 };
            if settled.iter().any(|settled| !settled.open.is_empty()) {
                let open = settled.each_ref().map(|settled| settled.open.as_slice());
                report = NearbyPair::new(self, open, (enough, job))?.violations(enough, job);
                if job.is_cancelled() {
                    return Err(JobError::Cancelled);
                }
            }
            Ok(ViolationReport { at_most: greater(report.at_most, most), ..report })
        })
    }

    /// The faces of either surface that are not proved to be within a distance of the frame, and a bound for
    /// all others.
    fn settle(&self, enough: f64, job: &Job) -> [Settled; 2] {
        let SurfaceMapping { forward, backward, .. } = &self.mapping;
        let mut nearby = None;
        [(forward, Side::Source), (backward, Side::Result)].map(|(bounds, side)| {
            let open: Vec<u32> =
                (0..bounds.len() as u32).filter(|face| bounds[*face as usize] > enough).collect();
            let within = bounds.iter().filter(|up| **up <= enough);
            let most = within.fold(0.0, |most, up| greater(most, *up));
            let mut settled = Settled { up: most, n: bounds.len() - open.len(), open };
            // Looking around each face on its own pays only if few are open.
            if settled.open.is_empty() || settled.open.len() > bounds.len() / MOST_ALONE {
                return settled;
            }
            let nearby =
                nearby.get_or_insert_with(|| NearbySearch::new(&self.source, &self.result, &self.images));
            let nearby_bounds = nearby.bounds(&settled.open, side, (enough, job));
            let known = nearby_bounds.iter().filter_map(|up| *up);
            settled.up = known.fold(settled.up, greater);
            let open = settled.open.iter().zip(&nearby_bounds).filter(|(_, up)| up.is_none());
            settled.open = open.map(|(face, _)| *face).collect();
            settled.n = bounds.len() - settled.open.len();
            settled
        })
    }
}

/// The faces of one surface, by whether they are within the wanted distance.
struct Settled {
    /// The largest bound of the faces within that distance.
    up: f64,
    /// The number of those faces.
    n: usize,
    /// The faces without such a bound.
    open: Vec<u32>,
}

/// The largest of the finite bounds.
fn largest_known(up: &[f64]) -> f64 {
    up.iter().filter(|up| **up < f64::INFINITY).fold(0.0, |most, up| greater(most, *up))
}
