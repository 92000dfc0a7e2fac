//! `ErrorMonitor`: checks during simplification how far the surface is from the original.
use super::edge_guard::{EdgeVerdict, FarEdges, OriginalEdges};
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
    /// By sample beside the vertices: a half-edge of the original on which it lies.
    beside: Arc<[u32]>,
    /// By sample: how thoroughly changes of the faces that hold it are checked; empty where all are sampled.
    pub check_levels: Vec<CheckLevel>,
    /// By face of the original: the last round in which it was visited.
    visited: Vec<u32>,
    round: u32,
    /// Edges of the original that do not stay close along the map, and faces of it to be checked.
    far: FarEdges,
    suspects: Vec<u32>,
}

/// How thoroughly changes around a sample are checked. The level is raised each time that the final proof
/// finds a deviation that is too large there. The last level cannot fail, since the surface does not change
/// there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CheckLevel {
    /// With a quick check.
    Sampled,
    /// With a thorough check where the cost of the change is at least this.
    ProvedFrom(f32),
    /// With a thorough check.
    Proved,
    /// Nothing changes.
    Frozen,
}

/// The largest cost of a change without a thorough check, as a fraction of the cost of the change that
/// deviated too much. Measured: the changes that led there cost as much up to a factor of two.
const BEFORE: f32 = 0.25;

impl CheckLevel {
    /// The next level after a change of that cost deviated too much.
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

/// The faces around an edge before and after its collapse.
#[derive(Clone, Copy)]
pub(super) struct CollapseChange<'a> {
    /// The faces that are removed or changed.
    pub before: &'a [u32],
    /// The changed faces: the new point first, counter-clockwise around it.
    pub after: &'a [(u32, [[f64; 3]; 3])],
    /// Their half-edges that are opposite the new point.
    pub opposite: &'a [u32],
    /// Whether they close around it.
    pub is_closed: bool,
    /// The new point, and the positions of all others.
    pub to: [f64; 3],
    pub surface: &'a HalfEdgeSurface,
    pub at: &'a [[f64; 3]],
    /// The cost of the change.
    pub cost: f32,
}

/// Vertices of the original that one face offers for a descent, and the steps of one. Chosen.
const SOME: usize = 4;
const MOST_STEPS: u32 = 64;
/// Samples that one thread looks at. Chosen.
const CHUNK: usize = 4096;
/// A face with this many vertices of the original needs no other samples. Chosen.
const ENOUGH: u32 = 8;
/// How many edges around a place that is too far from the original still have to do with it. Chosen.
const AROUND: u32 = 3;

impl ErrorMonitor {
    /// Monitors a surface that is still the original, with sample points `more` beside its vertices, each on
    /// a half-edge.
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
        // Faces that were left out from the start.
        corners.iter_mut().filter(|c| c[0] == NONE).for_each(|c| *c = [NONE; 3]);
        let (first, around) = faces_by_vertex(&corners, at.len());
        let faces = corners.iter().filter(|c| c[0] != NONE).copied().collect();
        let mesh = Mesh::by_construction(at.to_vec(), faces);
        let judge = ProximityChecker::new(Cow::Owned(mesh), job)?;
        let seen = vec![0; n_faces];
        Ok(Self {
            samples,
            original: judge,
            faces_at_vertices: around,
            first,
            corners: corners.into(),
            edges: Arc::new(OriginalEdges::new(surface, at.len())),
            beside: more.iter().map(|(_, h)| *h).collect(),
            check_levels: Vec::new(),
            visited: seen,
            round: 0,
            far: FarEdges::default(),
            suspects: Vec::new(),
        })
    }

    /// Forgets samples between vertices of the original where faces hold many of these, before a larger length.
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

    /// The vertex of the original at which a sample is, or from which the edge leads on which it is.
    pub fn vertex_beside(&self, sample: u32) -> u32 {
        match self.beside.get((sample as usize).wrapping_sub(self.first.len() - 1)) {
            None => sample,
            Some(h) => self.corners[*h as usize / 3][*h as usize % 3],
        }
    }

    /// Gives every sample the face of the current surface that is nearest to it, as far as a descent tells: from the one
    /// that holds it or, where that is gone, from one that `near` knows of its vertex. Fails with the vertices of the
    /// original at which some are too far, and leaves all as they are then.
    pub fn assign_nearest(
        &mut self,
        surface: &HalfEdgeSurface,
        at: &[[f64; 3]],
        mut near: impl FnMut(u32) -> u32,
        (room, job): (&LocalTolerance, &Job),
    ) -> Result<(), Vec<u32>> {
        let n = self.first.len() - 1;
        let there = surface.faces();
        let mut number = vec![NONE; surface.start.len() / 3];
        there.iter().enumerate().for_each(|(i, face)| number[*face as usize] = i as u32);
        let known = |face: u32| if face == NONE { NONE } else { number[face as usize] };
        let by_row: Vec<u32> = (0..n as u32)
            .map(|v| match known(self.samples.holder(v)) {
                NONE => known(near(v)),
                face => face,
            })
            .collect();
        let rows = |c: [u32; 3]| if c[0] == NONE { [0; 3] } else { c };
        let original = self.corners.iter().map(|c| rows(*c)).collect();
        let original = Mesh::by_construction(self.samples.points().take(n).collect(), original);
        let faces = there.iter().map(|face| surface.corners(*face)).collect();
        let current = Mesh::by_construction(at.to_vec(), faces);
        let near = NearFaces { by_row: &by_row, topology: Topology::Indices };
        let nearest = NearestFaces::new(&original, &current, near, job);
        let corner_of = |v: u32| {
            let face = self.faces_at_vertices[self.first[v as usize] as usize];
            let k = self.corners[face as usize].iter().position(|c| *c == v);
            3 * face + k.unwrap_or(0) as u32
        };
        let all: Vec<u32> = (0..self.samples.len() as u32).collect();
        let chunks: Vec<&[u32]> = all.chunks(CHUNK).collect();
        let found = par_map(job, &chunks, |_, samples| {
            let (mut holders, mut far) = (Vec::with_capacity(samples.len()), Vec::new());
            let mut last = None;
            for sample in samples.iter().copied() {
                let at = self.samples.at(sample);
                let beside = self.beside.get((sample as usize).wrapping_sub(n));
                let found = match beside {
                    None => nearest.of_corner(corner_of(sample)),
                    Some(h) => {
                        // Where the sample before is, or an end; from all of these, where none is close.
                        let ends = [*h, next_in_face(*h)].map(|h| nearest.of_corner(h));
                        let from = || last.into_iter().chain(ends.into_iter().flatten());
                        let here = from().map(|(face, _)| (face, nearest.distance_sq(at, face)));
                        let is_close = |found: &(u32, f64)| room.holds_sample(sample, found.1 * NEAR);
                        here.into_iter().find(is_close).or_else(|| {
                            let found = from().map(|(face, _)| nearest.descend_from(at, face));
                            found.min_by(|(_, a), (_, b)| a.total_cmp(b))
                        })
                    }
                };
                last = found;
                match found.filter(|(_, distance_sq)| room.holds_sample(sample, *distance_sq)) {
                    Some((face, _)) => holders.push(there[face as usize]),
                    None => {
                        far.push(beside.map_or(sample, |h| self.corners[*h as usize / 3][*h as usize % 3]))
                    }
                }
            }
            (holders, far)
        });
        let (holders, far): (Vec<Vec<u32>>, Vec<Vec<u32>>) = found.into_iter().unzip();
        let far = far.concat();
        if !far.is_empty() {
            return Err(far);
        }
        self.samples.assign(&holders.concat());
        Ok(())
    }

    /// The samples that a face of the current surface holds or, where it holds none, those of the faces around it.
    pub fn samples_near(&self, surface: &HalfEdgeSurface, face: u32) -> Vec<u32> {
        let here: Vec<u32> = self.samples.of_face(face).collect();
        if here.is_empty() { self.samples_around(surface, face) } else { here }
    }

    /// The samples that a face of the current surface and those around it hold.
    pub fn samples_around(&self, surface: &HalfEdgeSurface, face: u32) -> Vec<u32> {
        let around = surface.corners(face).into_iter().flat_map(|v| surface.one_ring(v));
        around.flat_map(|h| self.samples.of_face(h / 3)).collect()
    }

    /// The vertices of the original that a few edges lead to from some, with these.
    pub fn around(&self, mut vertices: Vec<u32>) -> Vec<u32> {
        for _ in 0..AROUND {
            let next: Vec<u32> = vertices.iter().flat_map(|v| self.edges.neighbours(*v)).copied().collect();
            vertices.extend(next);
            vertices.sort_unstable();
            vertices.dedup();
        }
        vertices
    }

    /// Whether a change keeps the surface close enough to the original, as far as a check tells. The new
    /// assignment of the samples is kept for [`SamplesByFace::commit`].
    pub fn allows(&mut self, change: CollapseChange<'_>, room: &LocalTolerance) -> bool {
        let care = self.check_level(change.before);
        if care == CheckLevel::Frozen {
            return false;
        }
        let middle = |[p, x, _]: [[f64; 3]; 3]| std::array::from_fn(|k| 0.5 * (p[k] + x[k]));
        // Most collapses that are refused take a sample too far.
        let quick = self.samples.try_reassign(change.before, change.after, room)
            && self.is_near_original(change.to, change.before, room)
            && match self.edges_verdict(&change, room) {
                EdgeVerdict::Near => true,
                EdgeVerdict::Unknown => {
                    change.after.iter().all(|(_, t)| self.is_near_original(middle(*t), change.before, room))
                }
                // A map goes over edges, and what is too far along them may still be near another part.
                EdgeVerdict::Far => {
                    change.after.iter().all(|(_, t)| self.is_near_original(middle(*t), change.before, room))
                        && self.proves_along_edges(change, room)
                }
            };
        let is_close = match care {
            CheckLevel::Sampled => false,
            CheckLevel::ProvedFrom(cost) => change.cost >= cost,
            CheckLevel::Proved | CheckLevel::Frozen => true,
        };
        quick && (!is_close || self.proves(change, room))
    }

    /// How edges of the original stay close to the faces around a change; those that do not are in `far` then.
    fn edges_verdict(&mut self, change: &CollapseChange<'_>, room: &LocalTolerance) -> EdgeVerdict {
        let Self { edges, samples, far, .. } = self;
        edges.verdict(samples, change, room, far)
    }

    /// Whether a point is close enough to the original. The faces around the vertex that is nearest to it, as far as a
    /// descent from one of those that some faces hold finds it, mostly tell; only where they do not, all are searched.
    fn is_near_original(&self, q: [f64; 3], held_by: &[u32], room: &LocalTolerance) -> bool {
        let n = self.first.len() as u32 - 1;
        let off = |v: u32| {
            let off = difference(self.samples.at(v), q);
            dot(off, off)
        };
        let mut best = (f64::INFINITY, NONE);
        let offer = |best: &mut (f64, u32), v: u32| {
            let d = off(v);
            if d < best.0 {
                *best = (d, v);
            }
        };
        for face in held_by {
            let some = self.samples.of_face(*face).filter(|v| *v < n).take(SOME);
            some.for_each(|v| offer(&mut best, v));
        }
        for _ in 0..MOST_STEPS {
            let here = best.1;
            if here == NONE || room.holds(q, best.0) {
                break;
            }
            self.edges.neighbours(here).iter().for_each(|v| offer(&mut best, *v));
            if best.1 == here {
                break;
            }
        }
        let (distance_sq, v) = best;
        if v != NONE {
            if room.holds(q, distance_sq) {
                return true;
            }
            for k in self.first[v as usize]..self.first[v as usize + 1] {
                let face = self.corners[self.faces_at_vertices[k as usize] as usize];
                let d = distance_sq_to_triangle(q, face.map(|v| self.samples.at(v)));
                if room.holds(q, d) {
                    return true;
                }
            }
        }
        room.holds(q, self.original.distance_sq(q))
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
    fn proves(&mut self, change: CollapseChange<'_>, room: &LocalTolerance) -> bool {
        let faces = change.after.iter().map(|(_, triangle)| *triangle);
        self.new_faces_are_near(faces, change.before, room) && {
            self.round += 1;
            self.suspects.clear();
            for (v, _) in self.samples.reassignments() {
                let v = *v as usize;
                if v + 1 < self.first.len() {
                    let there = self.first[v] as usize..self.first[v + 1] as usize;
                    self.suspects.extend(&self.faces_at_vertices[there]);
                }
            }
            self.suspects_are_near(change, room)
        }
    }

    /// The same for the faces of the original at edges that do not stay close along the map.
    fn proves_along_edges(&mut self, change: CollapseChange<'_>, room: &LocalTolerance) -> bool {
        self.round += 1;
        self.suspects.clear();
        for [v, u] in &self.far.edges {
            let there = self.first[*v as usize] as usize..self.first[*v as usize + 1] as usize;
            let faces = self.faces_at_vertices[there].iter();
            self.suspects.extend(faces.filter(|face| self.corners[**face as usize].contains(u)));
        }
        self.suspects_are_near(change, room) && {
            // The map proves the others.
            let far = change.after.iter().zip(&self.far.faces).filter(|(_, is_far)| **is_far);
            self.new_faces_are_near(far.map(|((_, triangle), _)| *triangle), change.before, room)
        }
    }

    /// Whether all points of new faces are near the original.
    fn new_faces_are_near(
        &self,
        faces: impl Iterator<Item = [[f64; 3]; 3]> + Clone,
        before: &[u32],
        room: &LocalTolerance,
    ) -> bool {
        // 1. Points that are often too far off, which are cheaper than a proof.
        let near = |q: [f64; 3]| self.is_near_original(q, before, room);
        let more = [[0.25, 0.75, 0.0], [0.75, 0.25, 0.0], [0.375, 0.375, 0.25], [0.0, 0.5, 0.5]];
        let point = |t: [[f64; 3]; 3], w: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| w[0] * t[0][k] + w[1] * t[1][k] + w[2] * t[2][k])
        };
        if !faces.clone().all(|t| more.iter().all(|w| near(point(t, *w)))) {
            return false;
        }
        // 2. All of them.
        faces.into_iter().all(|triangle| self.original.is_within(triangle, room))
    }

    /// Whether all points of some faces of the original are near the faces around a change.
    fn suspects_are_near(&mut self, change: CollapseChange<'_>, room: &LocalTolerance) -> bool {
        let mut local: Option<ProximityChecker<'static>> = None;
        for face in &self.suspects {
            let face = *face as usize;
            if std::mem::replace(&mut self.visited[face], self.round) == self.round {
                continue;
            }
            let corners = self.corners[face];
            // A face whose corners are near one face is near it as a whole.
            let held = corners.map(|v| self.samples.holder_after(v));
            if held[0] == held[1] && held[1] == held[2] {
                continue;
            }
            let triangle = corners.map(|v| self.samples.at(v));
            if local.is_none() {
                local = neighbourhood(change);
            }
            if !local.as_ref().is_some_and(|local| local.is_within(triangle, room)) {
                return false;
            }
        }
        true
    }
}

impl ErrorMonitor {
    /// A monitor of the samples that faces of a region hold, and the numbers of its samples in the whole. Others around these
    /// are known by where they are; edges that lead to them are not followed.
    pub fn region(&self, region: &SurfaceRegion, numbers: &RegionNumbers) -> (Self, Vec<u32>) {
        let n = self.first.len() - 1;
        let mut held: Vec<u32> = region.faces.iter().flat_map(|face| self.samples.of_face(*face)).collect();
        held.sort_unstable();
        let n_held = held.partition_point(|sample| (*sample as usize) < n);
        let around = |v: u32| {
            &self.faces_at_vertices[self.first[v as usize] as usize..self.first[v as usize + 1] as usize]
        };
        let mut faces: Vec<u32> = held[..n_held].iter().flat_map(|v| around(*v)).copied().collect();
        faces.sort_unstable();
        faces.dedup();
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

/// Where the faces around each vertex begin, and these; faces without vertices are around none.
fn faces_by_vertex(corners: &[[u32; 3]], n_vertices: usize) -> (Arc<[u32]>, Arc<[u32]>) {
    let mut first = vec![0_u32; n_vertices + 1];
    let there = || corners.iter().enumerate().filter(|(_, c)| c[0] != NONE);
    there().for_each(|(_, c)| c.iter().for_each(|v| first[*v as usize + 1] += 1));
    for v in 0..n_vertices {
        first[v + 1] += first[v];
    }
    let mut end = first.clone();
    let mut around = vec![0; first.last().map_or(0, |n| *n as usize)];
    for (face, c) in there() {
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
