//! `ErrorMonitor`: keeps an eye on how far a surface that shrinks is from the original.
use super::local_tolerance::LocalTolerance;
use super::samples::SamplesByFace;
use super::surface::{HalfEdgeSurface, NONE};
use crate::budget::{Job, JobError};
use crate::check::ProximityChecker;
use crate::explicit::Mesh;
use std::borrow::Cow;
use std::rc::Rc;

/// The original, points of it, and how closely each place is looked at.
///
/// A quick look asks about points: those of the original that faces answer for, the new point, and the middles of its
/// edges. A close look proves for each new face, and for each face of the original there, that all of it is near.
/// Neither replaces the proof for the whole at the end.
#[derive(Clone)]
pub(super) struct ErrorMonitor {
    pub samples: SamplesByFace,
    /// The original, in the coordinates of the engine.
    original: Rc<ProximityChecker<'static>>,
    /// The faces of the original around each of its vertices: `around[first[v]..first[v + 1]]`.
    faces_at_vertices: Rc<[u32]>,
    first: Rc<[u32]>,
    /// By face of the original: its vertices.
    corners: Rc<[[u32; 3]]>,
    /// By sample: how closely changes of the faces that hold it are looked at.
    pub check_levels: Vec<CheckLevel>,
    /// Marks of faces of the original that were looked at in this round.
    visited: Vec<u32>,
    round: u32,
}

/// How closely changes are looked at around a sample. Each time that the proof at the end found the surface too far there
/// the next one is taken; the last one cannot fail, since there the surface stays what it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CheckLevel {
    /// With a quick look.
    Sampled,
    /// With a close look where the change costs so much or more.
    ProvedFrom(f32),
    /// With a close look.
    Proved,
    /// Nothing changes.
    Frozen,
}

/// What a change may cost without a close look, as a share of what that cost which went too far. Measured: the changes
/// that led there cost as much up to a factor of two.
const BEFORE: f32 = 0.25;

impl CheckLevel {
    /// What comes next after a change of that cost went too far.
    pub fn escalate(self, cost: f32) -> Self {
        match self {
            Self::Sampled => Self::ProvedFrom(BEFORE * cost),
            Self::ProvedFrom(_) => Self::Proved,
            Self::Proved | Self::Frozen => Self::Frozen,
        }
    }

    /// The last.
    pub fn freeze(self, _: f32) -> Self {
        Self::Frozen
    }

    /// The more careful of two.
    pub fn stricter(self, other: Self) -> Self {
        match (self, other) {
            (Self::ProvedFrom(a), Self::ProvedFrom(b)) => Self::ProvedFrom(if a < b { a } else { b }),
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

/// Faces around an edge in question.
#[derive(Clone, Copy)]
pub(super) struct CollapseChange<'a> {
    /// Those that go or change.
    pub before: &'a [u32],
    /// What they become: the new point first.
    pub after: &'a [(u32, [[f64; 3]; 3])],
    /// Where the new point is, and where everything else is.
    pub to: [f64; 3],
    pub surface: &'a HalfEdgeSurface,
    pub at: &'a [[f64; 3]],
    /// What the change costs.
    pub cost: f32,
}

impl ErrorMonitor {
    /// Watches a surface that is still the original, with points `more` beside its vertices, each on a face.
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

    /// Whether a change keeps the surface near enough to the original, as far as a look tells; what it finds out of
    /// the samples is kept for [`SamplesByFace::commit`].
    pub fn allows(&mut self, change: CollapseChange<'_>, room: &LocalTolerance) -> bool {
        let care = self.check_level(change.before);
        if care == CheckLevel::Frozen {
            return false;
        }
        let near = |q: [f64; 3]| room.holds(q, self.original.distance_sq(q));
        let quick = near(change.to)
            && self.samples.try_reassign(change.before, change.after, room)
            && change.after.iter().all(|(_, [p, x, _])| near(std::array::from_fn(|k| 0.5 * (p[k] + x[k]))));
        let is_close = match care {
            CheckLevel::Sampled => false,
            CheckLevel::ProvedFrom(cost) => change.cost >= cost,
            CheckLevel::Proved | CheckLevel::Frozen => true,
        };
        quick && (!is_close || self.proves(change, room))
    }

    /// The most care that a sample of some faces asks for.
    pub fn check_level(&self, faces: &[u32]) -> CheckLevel {
        let samples = faces.iter().flat_map(|face| self.samples.of_face(*face));
        samples.map(|s| self.check_levels[s as usize]).fold(CheckLevel::Sampled, CheckLevel::stricter)
    }

    /// The close look.
    fn proves(&mut self, change: CollapseChange<'_>, room: &LocalTolerance) -> bool {
        // 1. Points where it is often too far, which cost less than a proof.
        let near = |q: [f64; 3]| room.holds(q, self.original.distance_sq(q));
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
                // Whose corners are near one face is near it altogether.
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
