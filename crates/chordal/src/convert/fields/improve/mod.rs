//! `SurfaceImprover`: from a closed surface near that of a CSG tree to one on it, of few triangles.
//!
//! Vertices move onto their primitives by Newton steps, onto creases where two meet and onto corners where
//! three do. Then edges are split, flipped and collapsed until every edge and face lies within the aimed
//! distance of its primitive, by samples. Operations whose faces do not overlap are taken together, so that
//! all their samples are one call of the primitives.
#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "what is no number counts as too far")]
#![allow(clippy::needless_range_loop, reason = "positions in a ring name its edges and its faces alike")]
mod collapse;
mod error;
mod face_tree;
mod flip;
mod intersections;
mod newton;
mod sample;
mod split;
mod thin_walls;
mod weld;

use crate::budget::{Job, Progress};
use crate::explicit::{HalfEdges, next_in_face, previous_in_face};
use crate::implicit::{LeafError, PrimitiveEvaluator};
use face_tree::FaceTree;
use glam::DVec3;
use sample::PrimitiveSample;
use split::MOST_REPAIRS;

/// A primitive and the side of it that is outside: twice its number, plus one where it stands as its complement.
pub(crate) type FaceLabel = u32;

/// A closed, oriented, embedded 2-manifold whose faces each belong to a primitive.
#[derive(Clone, Debug, Default)]
pub(crate) struct LabelledSurface {
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    /// By face.
    pub labels: Vec<FaceLabel>,
}

/// Why a surface was not improved.
#[derive(Debug)]
pub(crate) enum ImproveError {
    /// It is no closed, oriented 2-manifold.
    NotManifold,
    Leaf(LeafError),
    /// More triangles than these, which the job allows.
    TooMany(u64),
    /// More bytes than the job allows, for about so many.
    TooLarge(u64),
    Cancelled,
}

impl From<LeafError> for ImproveError {
    fn from(error: LeafError) -> Self {
        Self::Leaf(error)
    }
}

/// Where the surface has no room: a vertex that could not go to its place, or an edge that could not be split.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockedPlace {
    pub at: [f64; 3],
    /// The longest edge about the vertex, or the length of the edge.
    pub size: f64,
}

/// A vertex on one of its primitives.
#[derive(Clone, Copy, Debug)]
struct VertexConstraint {
    label: FaceLabel,
    /// The signed distance from it, positive outside, to first order.
    distance: f64,
    /// Outward.
    normal: DVec3,
}

/// What was done, for reports.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ImproveCounts {
    pub splits: usize,
    pub flips: usize,
    pub collapses: usize,
    pub sheet_tests: usize,
    pub sheet_refusals: usize,
}

/// See the [module](self).
pub(crate) struct SurfaceImprover<'a> {
    evaluator: PrimitiveEvaluator<'a>,
    job: &'a Job,
    tol: f64,
    /// What edges and faces may be off.
    aim: f64,
    surface: HalfEdges,
    /// By face.
    label: Vec<FaceLabel>,
    /// By vertex.
    position: Vec<DVec3>,
    /// By vertex: what its faces may be off.
    aim_at: Vec<f64>,
    /// By vertex: where its labels begin, and how many there are.
    place: Vec<(u32, u32)>,
    constraints: Vec<VertexConstraint>,
    /// By half-edge: the signed distance of its middle from the primitive of its face; NaN where it was not
    /// sampled.
    middle: Vec<f64>,
    /// By face: the same for its centroid.
    centre: Vec<f64>,
    /// By vertex: whether its collapse is to be tried.
    is_open: Vec<bool>,
    /// What collapses may leave, over the aim.
    limit: f64,
    /// By face: whether all samples of it are within the aim.
    is_verified: Vec<bool>,
    /// Faces whose edges may want to be flipped.
    changed: Vec<u32>,
    /// By face: the round in which it was taken.
    claimed_in: Vec<u32>,
    round: u32,
    tree: FaceTree,
    /// The limit of the job, or what there is at first, of which collapses leave few.
    most_faces: u64,
    /// Whether vertices that others are in the way of may stop before.
    goes_by_parts: bool,
    /// Vertices that could not go to their places at first.
    blocked: Vec<BlockedPlace>,
    /// By half-edge: those that the last round of splits was for.
    stuck: Vec<u32>,
    pub counts: ImproveCounts,
}

/// What edges and faces may be off, as a share of the tolerance: the rest is for what samples miss. Measured:
/// with it proofs end after 0 to 2 rounds of splits on most models.
const AIM: f64 = 0.85;

impl<'a> SurfaceImprover<'a> {
    pub fn new(
        raw: &LabelledSurface,
        evaluator: PrimitiveEvaluator<'a>,
        tol: f64,
        job: &'a Job,
    ) -> Result<Self, ImproveError> {
        let surface =
            HalfEdges::from_faces(&raw.faces, raw.positions.len()).ok_or(ImproveError::NotManifold)?;
        let n_faces = raw.faces.len();
        let mut this = Self {
            evaluator,
            job,
            tol,
            aim: AIM * tol,
            surface,
            label: raw.labels.clone(),
            position: raw.positions.iter().map(|p| DVec3::from(*p)).collect(),
            aim_at: vec![AIM * tol; raw.positions.len()],
            place: Vec::with_capacity(raw.positions.len()),
            constraints: Vec::with_capacity(raw.positions.len() + raw.positions.len() / 2),
            middle: vec![f64::NAN; 3 * n_faces],
            centre: vec![f64::NAN; n_faces],
            is_open: vec![true; raw.positions.len()],
            limit: 1.0,
            is_verified: vec![false; n_faces],
            changed: (0..n_faces as u32).collect(),
            claimed_in: vec![0; n_faces],
            round: 0,
            tree: FaceTree::default(),
            goes_by_parts: false,
            most_faces: if raw.faces.len() as u64 > job.triangle_limit {
                raw.faces.len() as u64
            } else {
                job.triangle_limit
            },
            blocked: Vec::new(),
            stuck: Vec::new(),
            counts: ImproveCounts::default(),
        };
        let mut labels = Vec::new();
        for v in 0..raw.positions.len() as u32 {
            labels.clear();
            labels.extend(this.surface.one_ring(v).map(|h| this.label[h as usize / 3]));
            let place = this.new_place(&mut labels);
            this.place.push(place);
        }
        this.place_vertices()?;
        this.weld()?;
        Ok(this)
    }

    /// What it was asked with.
    pub fn into_evaluator(self) -> PrimitiveEvaluator<'a> {
        self.evaluator
    }

    /// Splits until every edge and face is within the aim, but for those without room: where these are.
    pub fn refine(&mut self) -> Result<Vec<BlockedPlace>, ImproveError> {
        self.aim_at_walls()?;
        self.split_far(MOST_REPAIRS)?;
        let is_far = |h: u32| self.edge_excess(h) > 1.0 || !(self.face_excess(h / 3) <= 1.0);
        let there = self.stuck.iter().filter(|h| self.surface.has_face(**h / 3) && is_far(**h));
        let place = |h: &u32| {
            let [a, b] = [self.surface.start(*h), self.surface.end(*h)];
            BlockedPlace { at: self.middle_point(a, b).to_array(), size: (self.at(b) - self.at(a)).length() }
        };
        Ok(there.map(place).collect())
    }

    /// Splits, flips and collapses what [`Self::refine`] made until every edge and face is within the aim and few
    /// are left.
    pub fn improve(&mut self) -> Result<(), ImproveError> {
        let mut last = self.surface.n_faces();
        for cycle in 0..MOST_CYCLES {
            self.job.report(Progress { stage: "improve", done: cycle as u64, total: MOST_CYCLES as u64 });
            self.split_far(MOST_REPAIRS)?;
            self.collapse_all()?;
            self.flip_all()?;
            let now = self.surface.n_faces();
            // Less than 3 % in a cycle: the next ones bring less.
            if cycle > 0 && now * 100 > last * 97 {
                break;
            }
            last = now;
        }
        for _ in 0..MOST_CHECKS {
            self.split_far(MOST_REPAIRS)?;
            if self.split_edges_of_refuted()? == 0 {
                break;
            }
            self.flip_all()?;
        }
        Ok(())
    }

    /// Splits faces, by the numbers that [`Self::mesh`] gives with them, and puts right what is around them.
    /// Gives how many were split: none where their edges are as short as any may be, or where other sheets
    /// are in the way.
    pub fn split_faces(&mut self, faces: &[u32]) -> Result<usize, ImproveError> {
        self.next_round()?;
        let there: Vec<u32> = faces.iter().copied().filter(|f| self.surface.has_face(*f)).collect();
        let edges: Vec<u32> = there.iter().flat_map(|f| sides(3 * *f)).collect();
        self.sample_middles(&edges)?;
        let worst: Vec<u32> = there.iter().map(|f| self.worst_side(*f)).collect();
        self.goes_by_parts = true;
        let n = self.split_edges(&worst)?;
        self.goes_by_parts = false;
        self.flip_all()?;
        // A repair may take away what the proof has already.
        self.split_far(0)?;
        let off = self.unsettled();
        self.settle(&off)?;
        Ok(n)
    }

    /// Vertices that could not go to their place, at first.
    pub fn blocked(&self) -> &[BlockedPlace] {
        &self.blocked
    }

    /// How many vertices are off their primitives, since others are in the way or steps to them do not end.
    pub fn n_unsettled(&self) -> usize {
        self.unsettled().len()
    }

    /// One of them.
    pub fn first_unsettled(&self) -> Option<[f64; 3]> {
        self.unsettled().first().map(|v| self.at(*v).to_array())
    }

    pub fn n_faces(&self) -> usize {
        self.surface.n_faces()
    }

    /// The surface with vertices and faces in the order in which they were made, and the face's number here
    /// of each.
    pub fn mesh(&self) -> (LabelledSurface, Vec<u32>) {
        let mut number = vec![u32::MAX; self.position.len()];
        let mut positions = Vec::new();
        for (v, (number, at)) in number.iter_mut().zip(&self.position).enumerate() {
            if self.surface.has_vertex(v as u32) {
                *number = positions.len() as u32;
                positions.push(at.to_array());
            }
        }
        let there: Vec<u32> =
            (0..self.surface.face_slots() as u32).filter(|f| self.surface.has_face(*f)).collect();
        let faces = there.iter().map(|f| self.surface.corners(*f).map(|v| number[v as usize])).collect();
        let labels = there.iter().map(|f| self.label[*f as usize]).collect();
        (LabelledSurface { positions, faces, labels }, there)
    }

    /// A place for a vertex on these primitives, which is not measured yet.
    fn new_place(&mut self, labels: &mut Vec<FaceLabel>) -> (u32, u32) {
        labels.sort_unstable();
        labels.dedup();
        let place = (self.constraints.len() as u32, labels.len() as u32);
        let at =
            |label: &FaceLabel| VertexConstraint { label: *label, distance: f64::NAN, normal: DVec3::ZERO };
        self.constraints.extend(labels.iter().map(at));
        place
    }

    /// A vertex on each of its primitives.
    #[inline]
    fn constraints_of(&self, v: u32) -> &[VertexConstraint] {
        let (first, n) = self.place[v as usize];
        &self.constraints[first as usize..(first + n) as usize]
    }

    fn constraints_of_mut(&mut self, v: u32) -> &mut [VertexConstraint] {
        let (first, n) = self.place[v as usize];
        &mut self.constraints[first as usize..(first + n) as usize]
    }

    #[inline]
    fn at(&self, v: u32) -> DVec3 {
        self.position[v as usize]
    }

    #[inline]
    fn label_of(&self, h: u32) -> FaceLabel {
        self.label[h as usize / 3]
    }

    /// Whether the faces of an edge belong to different primitives.
    #[inline]
    fn is_crease(&self, h: u32) -> bool {
        self.label_of(h) != self.label_of(self.surface.twin(h))
    }

    #[inline]
    fn points(&self, face: u32) -> [DVec3; 3] {
        self.surface.corners(face).map(|v| self.at(v))
    }

    /// One of each pair of half-edges.
    fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        let n = 3 * self.surface.face_slots() as u32;
        (0..n).filter(|h| self.surface.has_face(*h / 3) && *h < self.surface.twin(*h))
    }

    /// A new round, in which no face is taken.
    fn next_round(&mut self) -> Result<(), ImproveError> {
        self.round += 1;
        self.refresh_tree();
        let n_slots = self.surface.face_slots() as u64;
        if self.job.is_cancelled() {
            Err(ImproveError::Cancelled)
        } else if self.surface.n_faces() as u64 > self.most_faces {
            Err(ImproveError::TooMany(self.most_faces))
        } else if n_slots > self.job.memory_limit / BYTES_A_FACE {
            Err(ImproveError::TooLarge(n_slots * BYTES_A_FACE))
        } else {
            Ok(())
        }
    }

    /// Whether no face of a list is taken in this round; then it takes them.
    fn claim_faces(&mut self, faces: &[u32]) -> bool {
        let free = faces.iter().all(|f| self.claimed_in[*f as usize] != self.round);
        if free {
            faces.iter().for_each(|f| self.claimed_in[*f as usize] = self.round);
        }
        free
    }

    /// Opens what may be done about a face that has changed.
    fn open_around(&mut self, face: u32) {
        self.changed.push(face);
        self.is_verified[face as usize] = false;
        for v in self.surface.corners(face) {
            self.is_open[v as usize] = true;
        }
    }

    /// Samples of the primitives with these labels.
    fn sample(&mut self, asks: &[(FaceLabel, DVec3)]) -> Result<Vec<PrimitiveSample>, LeafError> {
        sample::sample(&mut self.evaluator, asks)
    }
}

/// Bytes that a face takes here, about: half-edges with their middles, half a vertex with its labels, its
/// place in the tree and in lists.
const BYTES_A_FACE: u64 = 320;
/// Checks by all samples at most; what is off then is named by the proof.
const MOST_CHECKS: usize = 12;
/// Cycles of splits, flips and collapses at most; the first two do nearly all.
const MOST_CYCLES: usize = 4;

/// Twice the area of a triangle times its normal.
#[inline]
fn area_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// The half-edges of a face, from one of them on.
#[inline]
fn sides(h: u32) -> [u32; 3] {
    [h, next_in_face(h), previous_in_face(h)]
}

#[cfg(test)]
mod tests;
