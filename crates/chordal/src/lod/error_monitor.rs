//! `ErrorMonitor`: checks the distance between the surface and the original during simplification.
use super::edge_guard::{CollapseChange, EdgeVerdict, FarEdges, OriginalEdges};
use super::local_tolerance::LocalTolerance;
use super::samples::{NEAR, SamplesByFace};
use super::surface::{HalfEdgeSurface, NONE, RegionNumbers, SurfaceRegion};
use crate::budget::{Job, JobError, par_map};
use crate::check::{NearFaces, NearestFaces, ProximityChecker};
use crate::explicit::{Mesh, Topology, distance_sq_to_triangle, next_in_face};
use crate::math::{difference, dot, lesser};
use std::borrow::Cow;
use std::sync::Arc;

/// The original surface, sample points on it, and the check level of each sample.
///
/// A quick check tests points: the samples of the original that the faces hold, the new point, and the
/// middles of its edges. A thorough check proves for each new face, and for each face of the original there,
/// that the whole face is near. Neither replaces the proof of the whole mesh at the end.
#[derive(Clone)]
pub(super) struct ErrorMonitor {
    pub samples: SamplesByFace,
    /// The original, in local coordinates.
    original: ProximityChecker<'static>,
    /// The faces of the original around each of its vertices: `around[first[v]..first[v + 1]]`.
    faces_at_vertices: Arc<[u32]>,
    first: Arc<[u32]>,
    /// By face of the original: its vertices.
    corners: Arc<[[u32; 3]]>,
    edges: Arc<OriginalEdges>,
    /// By sample that is not a vertex: a half-edge of the original on which it lies.
    beside: Arc<[u32]>,
    /// By sample: the check level of changes of the faces that hold it; empty if all are sampled.
    pub check_levels: Vec<CheckLevel>,
    /// By face of the original: the last round in which it was visited.
    visited: Vec<u32>,
    round: u32,
    /// The edges of the original that do not stay close along the map, and the faces of the original to be
    /// checked.
    far: FarEdges,
    suspects: Vec<u32>,
}

/// How thoroughly changes around a sample are checked. The level is raised whenever the final proof
/// finds a deviation there that is too large. The last level cannot fail, since the surface does not change
/// there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CheckLevel {
    /// With a quick check.
    Sampled,
    /// With a thorough check if the cost of the change is at least this.
    ProvedFrom(f32),
    /// With a thorough check.
    Proved,
    /// No change is allowed.
    Frozen,
}

/// The largest cost of a change without a thorough check, as a fraction of the cost of the change that
/// deviated too much. Measured: the changes that led to such a deviation have equal costs up to a factor of
/// two.
const BEFORE: f32 = 0.25;

impl CheckLevel {
    /// The next level, after a change of the given cost deviated too much.
    pub fn escalate(self, cost: f32) -> Self {
        match self {
            Self::Sampled => Self::ProvedFrom(BEFORE * cost),
            Self::ProvedFrom(_) => Self::Proved,
            Self::Proved | Self::Frozen => Self::Frozen,
        }
    }

    /// The last level.
    pub fn freeze(self, _: f32) -> Self {
        Self::Frozen
    }

    /// The stricter of two levels.
    pub fn stricter(self, other: Self) -> Self {
        match (self, other) {
            (Self::ProvedFrom(a), Self::ProvedFrom(b)) => Self::ProvedFrom(lesser(a, b)),
            _ if self.rank() < other.rank() => other,
            _ => self,
        }
    }

    fn rank(self) -> u8 {
        match self {
            Self::Sampled => 0,
            Self::ProvedFrom(_) => 1,
            Self::Proved => 2,
            Self::Frozen => 3,
        }
    }
}

/// The vertices of the original that one face offers for a descent, and the most steps of a descent. Chosen:
/// larger values cost time, smaller ones end in a search of all faces more often.
const SOME: usize = 4;
const MOST_STEPS: u32 = 64;
/// Samples in one task. Chosen: a larger number leaves threads idle, a smaller one adds overhead.
const CHUNK: usize = 4096;
/// A face that holds this many vertices of the original needs no other samples. Chosen: larger values keep
/// more samples.
const ENOUGH: u32 = 8;
/// The number of rings of edges around a place too far from the original that are treated like it. Chosen:
/// larger values restrict more collapses.
const AROUND: u32 = 3;

impl ErrorMonitor {
    /// Monitors a surface that is still the original. The sample points `more` lie between its vertices, each
    /// on a half-edge.
    pub fn new(
        surface: &HalfEdgeSurface,
        at: &[[f64; 3]],
        more: &[([f64; 3], u32)],
        job: &Job,
    ) -> Result<Self, JobError> {
        let n_faces = surface.start.len() / 3;
        let mut samples = SamplesByFace::new(n_faces);
        for (v, p) in at.iter().enumerate() {
            samples.add(*p, surface.outgoing[v] / 3);
        }
        more.iter().for_each(|(p, h)| samples.add(*p, *h / 3));
        let mut corners: Vec<[u32; 3]> = (0..n_faces as u32).map(|face| surface.corners(face)).collect();
        // Faces that were dropped before the start.
        corners.iter_mut().filter(|c| c[0] == NONE).for_each(|c| *c = [NONE; 3]);
        let (first, around) = faces_by_vertex(&corners, at.len());
        let faces = corners.iter().filter(|c| c[0] != NONE).copied().collect();
        let mesh = Mesh::by_construction(at.to_vec(), faces);
        let original = ProximityChecker::new(Cow::Owned(mesh), job)?;
        let visited = vec![0; n_faces];
        Ok(Self {
            samples,
            original,
            faces_at_vertices: around,
            first,
            corners: corners.into(),
            edges: Arc::new(OriginalEdges::new(surface, at.len())),
            beside: more.iter().map(|(_, h)| *h).collect(),
            check_levels: Vec::new(),
            visited,
            round: 0,
            far: FarEdges::default(),
            suspects: Vec::new(),
        })
    }

    /// Before a larger length: drops samples between vertices of the original where faces hold many vertices.
    pub fn thin_out(&mut self) {
        let n = self.first.len() - 1;
        let mut n_held = vec![0_u32; self.samples.n_faces()];
        for face in self.samples.holders().take(n).filter(|face| *face != NONE) {
            n_held[face as usize] += 1;
        }
        let is_few = |face: u32| face == NONE || n_held[face as usize] < ENOUGH;
        let is_kept: Vec<bool> =
            self.samples.holders().enumerate().map(|(sample, face)| sample < n || is_few(face)).collect();
        self.samples.retain(&is_kept);
        let beside = self.beside.iter().zip(&is_kept[n..]).filter(|(_, is_kept)| **is_kept);
        self.beside = beside.map(|(h, _)| *h).collect();
        self.check_levels.clear();
    }

    /// The vertices of a face of the original.
    pub fn original_corners(&self, face: u32) -> [u32; 3] {
        self.corners[face as usize]
    }

    /// The vertex of the original that a sample is, or the start of the edge on which it lies.
    pub fn vertex_beside(&self, sample: u32) -> u32 {
        match self.beside.get((sample as usize).wrapping_sub(self.first.len() - 1)) {
            None => sample,
            Some(h) => self.corners[*h as usize / 3][*h as usize % 3],
        }
    }

    /// Assigns every sample to the nearest face of the current surface, as far as a descent finds it: from
    /// the face that holds it or, if that is gone, from the face that `near` has for its vertex. If samples
    /// are too far from all faces, fails with their vertices of the original, and changes no assignment.
    pub fn assign_nearest(
        &mut self,
        surface: &HalfEdgeSurface,
        at: &[[f64; 3]],
        mut near: impl FnMut(u32) -> u32,
        (tolerance, job): (&LocalTolerance, &Job),
    ) -> Result<(), Vec<u32>> {
        let n = self.first.len() - 1;
        let faces_now = surface.faces();
        let mut number = vec![NONE; surface.start.len() / 3];
        faces_now.iter().enumerate().for_each(|(i, face)| number[*face as usize] = i as u32);
        let number_of = |face: u32| if face == NONE { NONE } else { number[face as usize] };
        let by_row: Vec<u32> = (0..n as u32)
            .map(|v| match number_of(self.samples.holder(v)) {
                NONE => number_of(near(v)),
                face => face,
            })
            .collect();
        // Dropped faces keep their numbers, with corners that span no area.
        let rows = |c: [u32; 3]| if c[0] == NONE { [0; 3] } else { c };
        let original = self.corners.iter().map(|c| rows(*c)).collect();
        let original = Mesh::by_construction(self.samples.points().take(n).collect(), original);
        let faces = faces_now.iter().map(|face| surface.corners(*face)).collect();
        let current = Mesh::by_construction(at.to_vec(), faces);
        let near = NearFaces { by_row: &by_row, topology: Topology::Indices };
        let nearest = NearestFaces::new(&original, &current, near, job);
        let corner_of = |v: u32| {
            let face = self.faces_at_vertices[self.first[v as usize] as usize];
            let k = self.corners[face as usize].iter().position(|c| *c == v);
            3 * face + k.unwrap_or(0) as u32
        };
        let all_samples: Vec<u32> = (0..self.samples.len() as u32).collect();
        let chunks: Vec<&[u32]> = all_samples.chunks(CHUNK).collect();
        let assigned = par_map(job, &chunks, |_, samples| {
            let (mut holders, mut far) = (Vec::with_capacity(samples.len()), Vec::new());
            let mut last = None;
            for sample in samples.iter().copied() {
                let at = self.samples.at(sample);
                let beside = self.beside.get((sample as usize).wrapping_sub(n));
                let nearest_face = match beside {
                    None => nearest.of_corner(corner_of(sample)),
                    Some(h) => {
                        // From the face of the previous sample or of an end; by descents from all of these if
                        // none is close.
                        let ends = [*h, next_in_face(*h)].map(|h| nearest.of_corner(h));
                        let from = || last.into_iter().chain(ends.into_iter().flatten());
                        let nearby = from().map(|(face, _)| (face, nearest.distance_sq(at, face)));
                        let is_close = |face: &(u32, f64)| tolerance.holds_sample(sample, face.1 * NEAR);
                        nearby.into_iter().find(is_close).or_else(|| {
                            let candidates = from().map(|(face, _)| nearest.descend_from(at, face));
                            candidates.min_by(|(_, a), (_, b)| a.total_cmp(b))
                        })
                    }
                };
                last = nearest_face;
                match nearest_face.filter(|(_, distance_sq)| tolerance.holds_sample(sample, *distance_sq)) {
                    Some((face, _)) => holders.push(faces_now[face as usize]),
                    None => {
                        far.push(beside.map_or(sample, |h| self.corners[*h as usize / 3][*h as usize % 3]))
                    }
                }
            }
            (holders, far)
        });
        let (holders, far): (Vec<Vec<u32>>, Vec<Vec<u32>>) = assigned.into_iter().unzip();
        let far = far.concat();
        if !far.is_empty() {
            return Err(far);
        }
        self.samples.assign(&holders.concat());
        Ok(())
    }

    /// The samples held by a face of the current surface or, if it holds none, by the faces around it.
    pub fn samples_near(&self, surface: &HalfEdgeSurface, face: u32) -> Vec<u32> {
        let held: Vec<u32> = self.samples.of_face(face).collect();
        if held.is_empty() { self.samples_around(surface, face) } else { held }
    }

    /// The samples held by a face of the current surface and by the faces around it.
    pub fn samples_around(&self, surface: &HalfEdgeSurface, face: u32) -> Vec<u32> {
        let around = surface.corners(face).into_iter().flat_map(|v| surface.one_ring(v));
        around.flat_map(|h| self.samples.of_face(h / 3)).collect()
    }

    /// Some vertices of the original, and those within [`AROUND`] edges of them.
    pub fn around(&self, mut vertices: Vec<u32>) -> Vec<u32> {
        for _ in 0..AROUND {
            let next: Vec<u32> = vertices.iter().flat_map(|v| self.edges.neighbours(*v)).copied().collect();
            vertices.extend(next);
            vertices.sort_unstable();
            vertices.dedup();
        }
        vertices
    }

    /// Whether a change keeps the surface close enough to the original, as far as its check level can tell.
    /// The new assignment of the samples is pending until [`SamplesByFace::commit`].
    pub fn allows(&mut self, change: CollapseChange<'_>, tolerance: &LocalTolerance) -> bool {
        let level = self.check_level(change.before);
        if level == CheckLevel::Frozen {
            return false;
        }
        let middle = |[p, x, _]: [[f64; 3]; 3]| std::array::from_fn(|k| 0.5 * (p[k] + x[k]));
        // Samples come first, since they refuse most of the collapses that are refused.
        let quick = self.samples.try_reassign(change.before, change.after, tolerance)
            && self.is_near_original(change.to, change.before, tolerance)
            && match self.edges_verdict(&change, tolerance) {
                EdgeVerdict::Near => true,
                EdgeVerdict::Unknown => change
                    .after
                    .iter()
                    .all(|(_, t)| self.is_near_original(middle(*t), change.before, tolerance)),
                // The map is defined along edges; faces too far along it may still be near another part of
                // the surface.
                EdgeVerdict::Far => {
                    change
                        .after
                        .iter()
                        .all(|(_, t)| self.is_near_original(middle(*t), change.before, tolerance))
                        && self.proves_along_edges(change, tolerance)
                }
            };
        let needs_proof = match level {
            CheckLevel::Sampled => false,
            CheckLevel::ProvedFrom(cost) => change.cost >= cost,
            CheckLevel::Proved | CheckLevel::Frozen => true,
        };
        quick && (!needs_proof || self.proves(change, tolerance))
    }

    /// Whether edges of the original stay close to the faces around a change; those that do not are collected
    /// in `far`.
    fn edges_verdict(&mut self, change: &CollapseChange<'_>, tolerance: &LocalTolerance) -> EdgeVerdict {
        let Self { edges, samples, far, .. } = self;
        edges.verdict(samples, change, tolerance, far)
    }

    /// Whether a point is close enough to the original. Usually the faces around the nearest vertex suffice,
    /// which a descent finds from vertices held by the given faces; only if they do not, all faces are
    /// searched.
    fn is_near_original(&self, q: [f64; 3], held_by: &[u32], tolerance: &LocalTolerance) -> bool {
        let n = self.first.len() as u32 - 1;
        let distance_sq_to = |v: u32| {
            let d = difference(self.samples.at(v), q);
            dot(d, d)
        };
        let mut best = (f64::INFINITY, NONE);
        let offer = |best: &mut (f64, u32), v: u32| {
            let d = distance_sq_to(v);
            if d < best.0 {
                *best = (d, v);
            }
        };
        // Only vertices of the original have neighbours to go on to.
        for face in held_by {
            let some = self.samples.of_face(*face).filter(|v| *v < n).take(SOME);
            some.for_each(|v| offer(&mut best, v));
        }
        for _ in 0..MOST_STEPS {
            let nearest = best.1;
            if nearest == NONE || tolerance.holds(q, best.0) {
                break;
            }
            self.edges.neighbours(nearest).iter().for_each(|v| offer(&mut best, *v));
            if best.1 == nearest {
                break;
            }
        }
        let (distance_sq, v) = best;
        if v != NONE {
            if tolerance.holds(q, distance_sq) {
                return true;
            }
            // The nearest point of the original may be inside of a face at the nearest vertex.
            for k in self.first[v as usize]..self.first[v as usize + 1] {
                let face = self.corners[self.faces_at_vertices[k as usize] as usize];
                let d = distance_sq_to_triangle(q, face.map(|v| self.samples.at(v)));
                if tolerance.holds(q, d) {
                    return true;
                }
            }
        }
        // A descent may end at the wrong part of the surface; only the search of all faces refuses.
        tolerance.holds(q, self.original.distance_sq(q))
    }

    /// The levels of all samples.
    pub fn all_check_levels(&self) -> Vec<CheckLevel> {
        let mut levels = self.check_levels.clone();
        levels.resize(self.samples.len(), CheckLevel::Sampled);
        levels
    }

    /// The strictest level of the samples of some faces.
    pub fn check_level(&self, faces: &[u32]) -> CheckLevel {
        if self.check_levels.is_empty() {
            return CheckLevel::Sampled;
        }
        let samples = faces.iter().flat_map(|face| self.samples.of_face(*face));
        samples.map(|s| self.check_levels[s as usize]).fold(CheckLevel::Sampled, CheckLevel::stricter)
    }

    /// The thorough check.
    fn proves(&mut self, change: CollapseChange<'_>, tolerance: &LocalTolerance) -> bool {
        let faces = change.after.iter().map(|(_, triangle)| *triangle);
        self.new_faces_are_near(faces, change.before, tolerance) && {
            self.round += 1;
            self.suspects.clear();
            for (v, _) in self.samples.reassignments() {
                let v = *v as usize;
                if v + 1 < self.first.len() {
                    let faces_of_v = self.first[v] as usize..self.first[v + 1] as usize;
                    self.suspects.extend(&self.faces_at_vertices[faces_of_v]);
                }
            }
            self.suspects_are_near(change, tolerance)
        }
    }

    /// The same for the faces of the original at edges that do not stay close along the map.
    fn proves_along_edges(&mut self, change: CollapseChange<'_>, tolerance: &LocalTolerance) -> bool {
        self.round += 1;
        self.suspects.clear();
        for [v, u] in &self.far.edges {
            let faces_of_v = self.first[*v as usize] as usize..self.first[*v as usize + 1] as usize;
            let faces = self.faces_at_vertices[faces_of_v].iter();
            self.suspects.extend(faces.filter(|face| self.corners[**face as usize].contains(u)));
        }
        self.suspects_are_near(change, tolerance) && {
            // All other new faces are proved by the map.
            let far = change.after.iter().zip(&self.far.faces).filter(|(_, is_far)| **is_far);
            self.new_faces_are_near(far.map(|((_, triangle), _)| *triangle), change.before, tolerance)
        }
    }

    /// Whether all points of new faces are near the original.
    fn new_faces_are_near(
        &self,
        faces: impl Iterator<Item = [[f64; 3]; 3]> + Clone,
        before: &[u32],
        tolerance: &LocalTolerance,
    ) -> bool {
        // 1. A few points that are often too far, which are cheaper to check than whole faces.
        let near = |q: [f64; 3]| self.is_near_original(q, before, tolerance);
        let more = [[0.25, 0.75, 0.0], [0.75, 0.25, 0.0], [0.375, 0.375, 0.25], [0.0, 0.5, 0.5]];
        let point = |t: [[f64; 3]; 3], w: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| w[0] * t[0][k] + w[1] * t[1][k] + w[2] * t[2][k])
        };
        if !faces.clone().all(|t| more.iter().all(|w| near(point(t, *w)))) {
            return false;
        }
        // 2. The whole faces.
        faces.into_iter().all(|triangle| self.original.is_within(triangle, tolerance))
    }

    /// Whether all points of some faces of the original are near the faces around a change.
    fn suspects_are_near(&mut self, change: CollapseChange<'_>, tolerance: &LocalTolerance) -> bool {
        let mut local: Option<ProximityChecker<'static>> = None;
        for face in &self.suspects {
            let face = *face as usize;
            // Faces around several vertices are listed more than once.
            if std::mem::replace(&mut self.visited[face], self.round) == self.round {
                continue;
            }
            let corners = self.corners[face];
            // If one face holds all corners, each is near it, so the whole face is.
            let holders = corners.map(|v| self.samples.holder_after(v));
            if holders[0] == holders[1] && holders[1] == holders[2] {
                continue;
            }
            let triangle = corners.map(|v| self.samples.at(v));
            if local.is_none() {
                local = neighbourhood(change);
            }
            if !local.as_ref().is_some_and(|local| local.is_within(triangle, tolerance)) {
                return false;
            }
        }
        true
    }
}

impl ErrorMonitor {
    /// A monitor of the samples that the faces of a region hold, and their numbers in the whole surface.
    /// Samples around these are known only by their positions; edges that lead to them are not followed.
    pub fn region(&self, region: &SurfaceRegion, numbers: &RegionNumbers) -> (Self, Vec<u32>) {
        let n = self.first.len() - 1;
        let mut held: Vec<u32> = region.faces.iter().flat_map(|face| self.samples.of_face(*face)).collect();
        held.sort_unstable();
        // Vertices of the original are the first samples.
        let n_held = held.partition_point(|sample| (*sample as usize) < n);
        let around = |v: u32| {
            &self.faces_at_vertices[self.first[v as usize] as usize..self.first[v as usize + 1] as usize]
        };
        let mut faces: Vec<u32> = held[..n_held].iter().flat_map(|v| around(*v)).copied().collect();
        faces.sort_unstable();
        faces.dedup();
        // The other corners of these faces come along, so that their triangles are known.
        let mut samples: Vec<u32> = faces.iter().flat_map(|face| self.corners[*face as usize]).collect();
        samples.extend(&held);
        samples.sort_unstable();
        samples.dedup();
        let n_vertices = samples.partition_point(|sample| (*sample as usize) < n);
        let holders: Vec<u32> = numbers.of(&region.faces, |local| {
            let holder = |sample: &u32| match self.samples.holder(*sample) {
                NONE => NONE,
                face => local[face as usize],
            };
            samples.iter().map(holder).collect()
        });
        let (corners, edges): (Vec<[u32; 3]>, OriginalEdges) = numbers.of(&samples[..n_vertices], |local| {
            let corners = |face: &u32| self.corners[*face as usize].map(|v| local[v as usize]);
            (faces.iter().map(corners).collect(), self.edges.some(&samples[..n_vertices], local))
        });
        let (first, faces_at_vertices) = faces_by_vertex(&corners, n_vertices);
        let monitor = Self {
            samples: self.samples.some(&samples, &holders, region.faces.len()),
            original: self.original.clone(),
            faces_at_vertices,
            first,
            edges: Arc::new(edges),
            beside: Arc::default(),
            check_levels: Vec::new(),
            visited: vec![0; corners.len()],
            corners: corners.into(),
            round: 0,
            far: FarEdges::default(),
            suspects: Vec::new(),
        };
        (monitor, samples)
    }
}

/// The faces around each vertex in one list, and the start of each vertex in it; faces without vertices are
/// left out.
fn faces_by_vertex(corners: &[[u32; 3]], n_vertices: usize) -> (Arc<[u32]>, Arc<[u32]>) {
    let mut first = vec![0_u32; n_vertices + 1];
    // A counting sort by vertex.
    let corners_of_faces = || corners.iter().enumerate().filter(|(_, c)| c[0] != NONE);
    corners_of_faces().for_each(|(_, c)| c.iter().for_each(|v| first[*v as usize + 1] += 1));
    for v in 0..n_vertices {
        first[v + 1] += first[v];
    }
    let mut end = first.clone();
    let mut around = vec![0; first.last().map_or(0, |n| *n as usize)];
    for (face, c) in corners_of_faces() {
        for v in c {
            around[end[*v as usize] as usize] = face as u32;
            end[*v as usize] += 1;
        }
    }
    (first.into(), around.into())
}

/// The faces after a change and those around them.
fn neighbourhood(change: CollapseChange<'_>) -> Option<ProximityChecker<'static>> {
    let CollapseChange { before, after, surface, at, .. } = change;
    let mut faces: Vec<u32> = before
        .iter()
        .flat_map(|face| surface.corners(*face))
        .flat_map(|v| surface.one_ring(v).map(|h| h / 3))
        .collect();
    faces.sort_unstable();
    faces.dedup();
    let around = faces.iter().filter(|face| !before.contains(face));
    let around = around.map(|face| surface.corners(*face).map(|v| at[v as usize]));
    let positions: Vec<[f64; 3]> = after.iter().map(|(_, t)| *t).chain(around).flatten().collect();
    let rows: Vec<u32> = (0..positions.len() as u32).collect();
    let faces = rows.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    let mesh = Mesh::by_construction(positions, faces);
    ProximityChecker::from_small_mesh(mesh)
}
