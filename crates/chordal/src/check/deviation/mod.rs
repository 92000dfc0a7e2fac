//! `deviation`: the Hausdorff distance between two triangle meshes, certified from both sides.
mod clipper;
mod cover;
pub(super) mod distance;
mod distance_surface;
mod frame;
mod hausdorff;
mod mapping;
mod projection;
mod shared;
mod subtriangle;
mod violations;

use crate::budget::{Bound, Job, JobError, Message, Reference, Refusal, RefusalCode, Tolerance, par_map};
use crate::explicit::{Bvh, Mesh};
use crate::math::{Box3, add_up, flushes_subnormals, greater, sub_down};
use distance_surface::DistanceSurface;
use frame::DeviationFrame;
use hausdorff::{FarthestSample, HausdorffGoal, HausdorffQuery, LimitInterval, OneSidedSearch, search};
pub(crate) use mapping::{MappedPair, NearFaces, NearestFaces};
use shared::{SharedPositionIds, VertexDistances};
use std::borrow::Cow;
#[cfg(test)]
pub(crate) use violations::ToleranceViolation;
pub(crate) use violations::{
    ProximityChecker, RegionTolerance, ToleranceField, ViolationReport, tolerance_violations,
};

/// How close the two bounds of a deviation should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The upper bound exceeds the lower one by at most this share; ≥ 0. Default 0.1.
    pub relative: f64,
    /// An upper bound that exceeds the lower one by at most this length is accepted as well.
    pub absolute: Option<Tolerance>,
    /// Only decide whether the deviation is at most this, ignoring the other two, and stop as soon as that is
    /// known.
    pub max: Option<Tolerance>,
}

impl Default for Goal {
    fn default() -> Self {
        Self { relative: 0.1, absolute: None, max: None }
    }
}

/// The largest distance from the points of one surface to another: the one-sided Hausdorff distance,
/// enclosed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneSidedDistance {
    /// Lower bound: some point is at least this far.
    pub at_least: f64,
    /// Upper bound: no point is farther than this.
    pub at_most: f64,
    /// The farthest point found, rounded.
    pub from: [f64; 3],
    /// Its nearest point on the other surface, rounded.
    pub to: [f64; 3],
}

/// The deviation between two surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// The Hausdorff distance, proved, with the worst point on either surface.
    pub bound: Bound,
    /// From the points of the first surface to the second.
    pub forward: OneSidedDistance,
    /// From the points of the second surface to the first.
    pub backward: OneSidedDistance,
    /// Whether the goal was reached. The bounds hold even if it was not.
    pub reached: bool,
}

impl Deviation {
    /// The direction in which the worst pair was found.
    #[must_use]
    pub fn worst(&self) -> &OneSidedDistance {
        if self.backward.at_least > self.forward.at_least { &self.backward } else { &self.forward }
    }
}

/// The gap that rounding leaves between the two bounds of identical surfaces, relative to the diagonal.
const FLOOR: f64 = 14.0 * f64::EPSILON; // measured: covers clipped in rounded numbers reach 6 to 20

/// Encloses the Hausdorff distance between two meshes: the largest distance from any point of either surface
/// to the nearest point of the other, over all points and not only the vertices.
///
/// *What it covers.* Both bounds are proved, rounding included, for the exact triangles of both meshes,
/// whatever their topology: open, folded, without area, non-manifold. Vertices that no face uses are not part
/// of a surface. Attributes are not compared. With [`Goal::max`] the bounds may be far apart, but they show
/// on which side of it the distance is.
///
/// *Cost.* About 3 µs a vertex and direction on one core if the two are close together compared to their
/// triangles; more if they are far apart and curved. Memory: 300 bytes a triangle. The result does not
/// depend on the number of threads.
///
/// # Errors
/// [`JobError::Refused`] with [`RefusalCode::Empty`] if a mesh has no face, with [`RefusalCode::NotFinite`]
/// if an extent overflows, with the refusals of [`Bvh::build`], or if the processor flushes subnormals;
/// [`JobError::Cancelled`].
///
/// ```
/// use chordal::{Job, Mesh, check::{Goal, deviation}};
/// let square = |z: f64| vec![[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
/// let below = Mesh::new(square(0.0), vec![[0, 1, 2], [0, 2, 3]])?;
/// let above = Mesh::new(square(0.25), vec![[0, 1, 3], [1, 2, 3]])?; // cut along the other diagonal
/// let found = deviation(&below, &above, &Goal::default(), &Job::default())?;
/// assert!(found.bound.at_least() <= 0.25 && found.bound.at_most().unwrap() >= 0.25);
/// assert!(found.bound.at_most().unwrap() < 0.2501);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sources: R. Straub, *Exact computation of the Hausdorff distance between triangular meshes*, 2007, and L.
/// Kang, G. Bai, *Fast and accurate Hausdorff distance computation between triangle meshes*, 2018, for branch
/// and bound; covers by projection are our own, derived in `check/deviation/cover.rs`.
pub fn deviation(a: &Mesh, b: &Mesh, goal: &Goal, job: &Job) -> Result<Deviation, JobError> {
    job.run(|| {
        let pair = SurfacePair::from_meshes([a, b], job)?;
        let vertices = [0, 1].map(|which| pair.vertex_distances(which, job));
        let [a, b] = &pair.sides;
        let mut directions =
            [OneSidedSearch::new(a, b, &vertices[0]), OneSidedSearch::new(b, a, &vertices[1])];
        pair.search(&mut directions, &vertices, goal, job)
    })
}

/// The coordinate frame in which two meshes are compared.
#[derive(Clone, Copy)]
struct CommonFrame {
    frame: DeviationFrame,
    /// The diagonal of the box around both, in the frame.
    diagonal: f64,
    /// An upper bound on the sum of the displacements of both surfaces by the frame's rounding, in the frame.
    /// A face that both meshes contain is displaced alike in both.
    displacement: f64,
    /// The largest coordinate of both meshes, in the frame.
    reach: f64,
}

impl CommonFrame {
    /// The frame, and both meshes in it.
    fn around<'a>(meshes: [&'a Mesh; 2]) -> Result<(Self, [Cow<'a, Mesh>; 2]), JobError> {
        if flushes_subnormals() {
            let message =
                "the floating-point environment flushes subnormal numbers, so that nothing can be proved";
            return refused(RefusalCode::FlushesSubnormals, message);
        }
        for (which, mesh) in ["first", "second"].iter().zip(meshes) {
            if mesh.faces().is_empty() {
                let message = format!("the {which} mesh has no triangle, so nothing is near it");
                return refused(RefusalCode::Empty, message);
            }
        }
        let [a, b] = meshes;
        let overflows = || refused(RefusalCode::NotFinite, "the extent of the two meshes overflows");
        // A vertex without a face is no part of the surface, however far away.
        let bounds = used_bounds(a).union(used_bounds(b));
        if bounds.diagonal() == f64::INFINITY {
            return overflows();
        }
        let frame = DeviationFrame::around(&bounds);
        let (Some((local_a, a_moved)), Some((local_b, b_moved))) = (frame.local(a), frame.local(b)) else {
            return overflows();
        };
        // Exactly 0 in the frame of the world, where add_up would make it the smallest number.
        let displacement = if a_moved + b_moved == 0.0 { 0.0 } else { add_up(a_moved, b_moved) };
        let reach = Box3::from_points(local_a.positions().iter().chain(local_b.positions()));
        let reach = reach.min.iter().chain(&reach.max).fold(0.0, |most, x| greater(most, x.abs()));
        let diagonal = used_bounds(&local_a).union(used_bounds(&local_b)).diagonal();
        Ok((Self { frame, diagonal, displacement, reach }, [local_a, local_b]))
    }

    /// A world-space length as a limit in the frame.
    fn limit(&self, length: f64) -> LimitInterval {
        LimitInterval::around(self.frame.local_length(length), self.displacement)
    }

    /// Rounding decides about lengths below this one.
    fn floor(&self) -> f64 {
        FLOOR * self.diagonal
    }

    /// A goal in the frame.
    fn goal(&self, goal: &Goal) -> HausdorffGoal {
        HausdorffGoal {
            relative: greater(goal.relative, 0.0),
            absolute: goal.absolute.map_or(0.0, |length| self.frame.local_length(length.get())),
            floor: self.floor(),
            max: goal.max.map(|length| self.limit(length.get())),
        }
    }

    /// The result of one direction in world space. `moved` bounds how far rounding displaced both surfaces
    /// together.
    fn one_sided(
        &self,
        far: FarthestSample,
        (at_most, displacement): (f64, f64),
        to: [f64; 3],
    ) -> OneSidedDistance {
        let least = if displacement == 0.0 { far.at_least } else { sub_down(far.at_least, displacement) };
        let most = greater(at_most, far.at_least);
        let most = if displacement == 0.0 { most } else { add_up(most, displacement) };
        OneSidedDistance {
            at_least: self.frame.length_down(greater(least, 0.0)),
            at_most: self.frame.length_up(most),
            from: self.frame.world(far.at),
            to: self.frame.world(to),
        }
    }
}

/// Two surfaces in one frame, ready for comparison.
struct SurfacePair<'a> {
    common_frame: CommonFrame,
    position_ids: SharedPositionIds,
    sides: [DistanceSurface<'a>; 2],
}

impl<'a> SurfacePair<'a> {
    fn from_meshes(meshes: [&'a Mesh; 2], job: &Job) -> Result<Self, JobError> {
        let (common_frame, [a, b]) = CommonFrame::around(meshes)?;
        // From the original meshes: positions that the frame rounds to the same number need not be equal.
        let position_ids = SharedPositionIds::from_meshes(meshes);
        let sides = [DistanceSurface::new(a, job)?, DistanceSurface::new(b, job)?];
        Ok(Self { common_frame, position_ids, sides })
    }

    /// Searches both directions until the goal is met or cannot be improved further.
    fn search(
        &self,
        directions: &mut [OneSidedSearch<'_>; 2],
        vertices: &[VertexDistances; 2],
        goal: &Goal,
        job: &Job,
    ) -> Result<Deviation, JobError> {
        let query = HausdorffQuery { goal: self.common_frame.goal(goal), reach: self.common_frame.reach };
        let reached = search(directions, vertices, &query, job);
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let [forward, backward] = [0, 1].map(|k| {
            let displacement = if directions[k].is_displaced { self.common_frame.displacement } else { 0.0 };
            let far = directions[k].farthest;
            let to = self.sides[1 - k].nearest(far.at);
            self.common_frame.one_sided(far, (directions[k].at_most(), displacement), to)
        });
        let bound = two_sided(&forward, &backward);
        // Rounding on the way back to world space may undo a decision made in the frame.
        let decided = goal.max.is_none_or(|max| {
            bound.at_least() > max.get() || bound.at_most().is_some_and(|most| most <= max.get())
        });
        Ok(Deviation { bound, forward, backward, reached: reached && decided })
    }

    /// The distance samples of the vertices of some faces of each side.
    fn vertices_of(&self, faces: [Vec<u32>; 2], job: &Job) -> [VertexDistances; 2] {
        let [a, b] = &self.sides;
        let [faces_a, faces_b] = faces;
        [(0, faces_a), (1, faces_b)]
            .map(|faces| VertexDistances::of_faces(&self.position_ids, [a, b], faces, job))
    }

    /// The distance samples of all vertices of one side.
    fn vertex_distances(&self, side: usize, job: &Job) -> VertexDistances {
        let [a, b] = &self.sides;
        VertexDistances::measure(&self.position_ids, [a, b], side, job)
    }
}

/// The distance of every vertex of `mesh` to the surface of `against`, rounded up by a few units in the last
/// place; for colouring vertices by error. Between vertices the distance may be larger: [`deviation`] bounds
/// it.
///
/// Cost: 2 to 4 µs a vertex on one core, and the bounding volume hierarchy over `against`.
///
/// # Errors
/// As for [`deviation`].
///
/// ```
/// use chordal::{Job, Mesh, check::vertex_deviation};
/// let flat = Mesh::new(vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]])?;
/// let bent = Mesh::new(vec![[1.0, 1.0, 0.5], [1.0, 2.0, 0.0], [2.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let off = vertex_deviation(&bent, &flat, &Job::default())?;
/// assert!((off[0] - 0.5).abs() < 1e-12 && off[1] < 1e-12 && off[2] < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn vertex_deviation(mesh: &Mesh, against: &Mesh, job: &Job) -> Result<Vec<f64>, JobError> {
    if against.faces().is_empty() {
        return refused(RefusalCode::Empty, "the mesh has no triangle, so nothing is near it");
    }
    let bvh = Bvh::build(against, job)?;
    let chunks: Vec<&[[f64; 3]]> = mesh.positions().chunks(shared::CHUNK).collect();
    let parts = par_map(job, &chunks, |_, points| {
        let up = |p: &[f64; 3]| bvh.closest_distance_up(*p).unwrap_or(f64::INFINITY);
        if job.is_cancelled() { Vec::new() } else { points.iter().map(up).collect::<Vec<_>>() }
    });
    if job.is_cancelled() { Err(JobError::Cancelled) } else { Ok(parts.concat()) }
}

pub(super) fn refused<T>(code: RefusalCode, message: impl Into<Message>) -> Result<T, JobError> {
    Err(JobError::Refused(Refusal::new(code, message)))
}

/// The bounding box of the vertices that faces use.
fn used_bounds(mesh: &Mesh) -> Box3 {
    Box3::from_points(mesh.faces().as_flattened().iter().map(|&row| &mesh.positions()[row as usize]))
}

pub(super) fn two_sided(forward: &OneSidedDistance, backward: &OneSidedDistance) -> Bound {
    let at_least = greater(forward.at_least, backward.at_least);
    let at_most = greater(forward.at_most, backward.at_most);
    let mut bound = Bound::proved(at_least, at_most, Reference::InputTriangles);
    bound.at = Some(if backward.at_least > forward.at_least { backward.from } else { forward.from });
    bound
}
