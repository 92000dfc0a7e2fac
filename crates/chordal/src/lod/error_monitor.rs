//! `ErrorMonitor`: checks during simplification how far the surface is from the original.
use super::local_tolerance::LocalTolerance;
use super::samples::SamplesByFace;
use super::surface::{HalfEdgeSurface, NONE};
use crate::budget::{Job, JobError};
use crate::check::ProximityChecker;
use crate::explicit::{Mesh, distance_sq_to_triangle};
use crate::math::{difference, dot, lesser};
use std::borrow::Cow;
use std::rc::Rc;

/// The original surface, sample points on it, and the check level of each sample.
///
/// A quick check tests points: the samples of the original that the faces hold, the new point, and the
/// middles of its edges. A thorough check proves for each new face, and for each face of the original there,
/// that the whole face is near. Neither replaces the proof of the whole mesh at the end.
#[derive(Clone)]
pub(super) struct ErrorMonitor {
    pub samples: SamplesByFace,
    /// The original, in local coordinates.
    original: Rc<ProximityChecker<'static>>,
    /// The faces of the original around each of its vertices: `around[first[v]..first[v + 1]]`.
    faces_at_vertices: Rc<[u32]>,
    first: Rc<[u32]>,
    /// By face of the original: its vertices.
    corners: Rc<[[u32; 3]]>,
    /// By sample: how thoroughly changes of the faces that hold it are checked.
    pub check_levels: Vec<CheckLevel>,
    /// By face of the original: the last round in which it was visited.
    visited: Vec<u32>,
    round: u32,
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
    /// The changed faces: the new point first.
    pub after: &'a [(u32, [[f64; 3]; 3])],
    /// The new point, and the positions of all others.
    pub to: [f64; 3],
    pub surface: &'a HalfEdgeSurface,
    pub at: &'a [[f64; 3]],
    /// The cost of the change.
    pub cost: f32,
}

impl ErrorMonitor {
    /// Monitors a surface that is still the original, with sample points `more` beside its vertices, each on
    /// a face.
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
        more.iter().for_each(|(p, face)| samples.add(*p, *face));
        let mut corners: Vec<[u32; 3]> = (0..n_faces as u32).map(|face| surface.corners(face)).collect();
        // Faces that were left out from the start.
        corners.iter_mut().filter(|c| c[0] == NONE).for_each(|c| *c = [NONE; 3]);
        let mut first = vec![0_u32; at.len() + 1];
        let there = || corners.iter().enumerate().filter(|(_, c)| c[0] != NONE);
        there().for_each(|(_, c)| c.iter().for_each(|v| first[*v as usize + 1] += 1));
        for v in 0..at.len() {
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
        let faces = there().map(|(_, c)| *c).collect();
        let mesh = Mesh::by_construction(at.to_vec(), faces);
        let judge = Rc::new(ProximityChecker::new(Cow::Owned(mesh), job)?);
        let seen = vec![0; n_faces];
        let care = vec![CheckLevel::Sampled; samples.at.len()];
        let (around, first, corners) = (around.into(), first.into(), corners.into());
        Ok(Self {
            samples,
            original: judge,
            faces_at_vertices: around,
            first,
            corners,
            check_levels: care,
            visited: seen,
            round: 0,
        })
    }

    /// The vertices of a face of the original.
    pub fn original_corners(&self, face: u32) -> [u32; 3] {
        self.corners[face as usize]
    }

    /// Whether a change keeps the surface close enough to the original, as far as a check tells. The new
    /// assignment of the samples is kept for [`SamplesByFace::commit`].
    pub fn allows(&mut self, change: CollapseChange<'_>, room: &LocalTolerance) -> bool {
        let care = self.check_level(change.before);
        if care == CheckLevel::Frozen {
            return false;
        }
        let here: Vec<u32> = self.vertices_held_by(change.before).collect();
        let middle = |[p, x, _]: [[f64; 3]; 3]| std::array::from_fn(|k| 0.5 * (p[k] + x[k]));
        let quick = self.is_near_original(change.to, &here, room)
            && self.samples.try_reassign(change.before, change.after, room)
            && change.after.iter().all(|(_, t)| self.is_near_original(middle(*t), &here, room));
        let is_close = match care {
            CheckLevel::Sampled => false,
            CheckLevel::ProvedFrom(cost) => change.cost >= cost,
            CheckLevel::Proved | CheckLevel::Frozen => true,
        };
        quick && (!is_close || self.proves(change, room))
    }

    /// The vertices of the original that some faces hold.
    fn vertices_held_by<'s>(&'s self, faces: &'s [u32]) -> impl Iterator<Item = u32> + 's {
        let n = self.first.len() as u32 - 1;
        faces.iter().flat_map(|face| self.samples.of_face(*face)).filter(move |sample| *sample < n)
    }

    /// Whether a point is close enough to the original. The faces around the nearest of the vertices `here` mostly
    /// tell; only where they do not, all faces are searched.
    fn is_near_original(&self, q: [f64; 3], here: &[u32], room: &LocalTolerance) -> bool {
        let off = |v: &u32| {
            let off = difference(self.samples.at[*v as usize], q);
            dot(off, off)
        };
        let nearer = |best: (f64, u32), v: &u32| {
            let d = off(v);
            if d < best.0 { (d, *v) } else { best }
        };
        let (_, v) = here.iter().fold((f64::INFINITY, NONE), nearer);
        if v != NONE {
            for k in self.first[v as usize]..self.first[v as usize + 1] {
                let face = self.corners[self.faces_at_vertices[k as usize] as usize];
                let d = distance_sq_to_triangle(q, face.map(|v| self.samples.at[v as usize]));
                if room.holds(q, d) {
                    return true;
                }
            }
        }
        room.holds(q, self.original.distance_sq(q))
    }

    /// The strictest level of the samples of some faces.
    pub fn check_level(&self, faces: &[u32]) -> CheckLevel {
        let samples = faces.iter().flat_map(|face| self.samples.of_face(*face));
        samples.map(|s| self.check_levels[s as usize]).fold(CheckLevel::Sampled, CheckLevel::stricter)
    }

    /// The thorough check.
    fn proves(&mut self, change: CollapseChange<'_>, room: &LocalTolerance) -> bool {
        // 1. Points that are often too far off, which are cheaper than a proof.
        let here: Vec<u32> = self.vertices_held_by(change.before).collect();
        let near = |q: [f64; 3]| self.is_near_original(q, &here, room);
        let more = [[0.25, 0.75, 0.0], [0.75, 0.25, 0.0], [0.375, 0.375, 0.25], [0.0, 0.5, 0.5]];
        let point = |t: &[[f64; 3]; 3], w: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| w[0] * t[0][k] + w[1] * t[1][k] + w[2] * t[2][k])
        };
        if !change.after.iter().all(|(_, t)| more.iter().all(|w| near(point(t, *w)))) {
            return false;
        }
        // 2. All points of the new faces.
        if !change.after.iter().all(|(_, triangle)| self.original.is_within(*triangle, room)) {
            return false;
        }
        // 3. All points of the original's faces there.
        self.round += 1;
        let mut local: Option<ProximityChecker<'static>> = None;
        for i in 0..self.samples.reassignments().len() {
            let v = self.samples.reassignments()[i].0 as usize;
            if v + 1 >= self.first.len() {
                continue;
            }
            for k in self.first[v]..self.first[v + 1] {
                let face = self.faces_at_vertices[k as usize] as usize;
                if std::mem::replace(&mut self.visited[face], self.round) == self.round {
                    continue;
                }
                let corners = self.corners[face];
                // A face whose corners are near one face is near it as a whole.
                let held = corners.map(|v| self.samples.holder_after(v));
                if held[0] == held[1] && held[1] == held[2] {
                    continue;
                }
                let triangle = corners.map(|v| self.samples.at[v as usize]);
                if local.is_none() {
                    local = neighbourhood(change);
                }
                if !local.as_ref().is_some_and(|local| local.is_within(triangle, room)) {
                    return false;
                }
            }
        }
        true
    }
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
