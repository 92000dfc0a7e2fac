//! `SurfaceImprover`: turns a closed surface near that of a CSG tree into one of few triangles with vertices on it.
//!
//! Newton steps move vertices onto their primitives: onto creases if there are two, and onto corners if there are
//! three. Then edges are split, flipped and collapsed until every edge and face is within the aimed distance of its
//! primitive, by samples. Operations whose faces do not overlap are batched, so that all their samples are one call
//! of the evaluator.
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
use crate::implicit::{Csg, LeafError, PrimitiveEvaluator};
use crate::math::greater;
use face_tree::FaceTree;
use glam::DVec3;
use sample::PrimitiveSample;
use split::MOST_REPAIRS;

/// A primitive and its outer side: twice its number, plus one if it occurs as its complement.
pub(crate) type FaceLabel = u32;

/// A closed, oriented, embedded 2-manifold, each of whose faces belongs to a primitive.
#[derive(Clone, Debug, Default)]
pub(crate) struct LabelledSurface {
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    /// By face.
    pub labels: Vec<FaceLabel>,
}

/// The reason why a surface could not be improved.
#[derive(Debug)]
pub(crate) enum ImproveError {
    /// It is not a closed, oriented 2-manifold.
    NotManifold,
    Leaf(LeafError),
    /// It needs more triangles than this limit of the job.
    TooMany(u64),
    /// It needs about this many bytes, which is more than the job allows.
    TooLarge(u64),
    Cancelled,
}

impl From<LeafError> for ImproveError {
    fn from(error: LeafError) -> Self {
        Self::Leaf(error)
    }
}

/// The place of a vertex that could not reach its target, or of an edge that could not be split.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockedPlace {
    pub at: [f64; 3],
    /// The extent along each axis of the edges at the vertex, or of that edge.
    pub extent: [f64; 3],
}

/// One of the primitives of a vertex, with its distance and normal there.
#[derive(Clone, Copy, Debug)]
struct VertexConstraint {
    label: FaceLabel,
    /// The signed distance, positive outside, to first order.
    distance: f64,
    /// Outward.
    normal: DVec3,
}

/// The numbers of operations, for reports.
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
    /// The allowed error of edges and faces.
    aim: f64,
    surface: HalfEdges,
    /// By face.
    label: Vec<FaceLabel>,
    /// By vertex.
    position: Vec<DVec3>,
    /// By vertex: the allowed error of its faces.
    aim_at: Vec<f64>,
    /// By vertex: the start and the number of its constraints.
    run: Vec<(u32, u32)>,
    constraints: Vec<VertexConstraint>,
    /// By half-edge: the signed distance of its middle from the primitive of its face; NaN if not sampled.
    middle: Vec<f64>,
    /// By face: the signed distance of its centroid; NaN if not sampled.
    centre: Vec<f64>,
    /// By vertex: whether its collapse is to be tried.
    is_open: Vec<bool>,
    /// The largest error that collapses may leave, relative to the aim.
    limit: f64,
    /// By face: whether all its samples are within the aim.
    is_verified: Vec<bool>,
    /// Faces whose edges are candidates for flips.
    changed: Vec<u32>,
    /// By face: the round in which it was claimed.
    claimed_in: Vec<u32>,
    round: u32,
    tree: FaceTree,
    /// The most faces: the limit of the job, or the number at the start if that is larger, since collapses remove most.
    most_faces: u64,
    /// Whether blocked vertices may stop on the way to their targets.
    goes_by_parts: bool,
    /// Vertices that could not reach their targets at first.
    blocked: Vec<BlockedPlace>,
    /// The half-edges that the last round tried to split.
    stuck: Vec<u32>,
    pub counts: ImproveCounts,
}

/// The allowed error of edges and faces, relative to the tolerance: the rest is for errors that samples miss.
/// Measured: with it, proofs end after 0 to 2 rounds of splits on most models.
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
            run: Vec::with_capacity(raw.positions.len()),
            constraints: Vec::with_capacity(raw.positions.len() + raw.positions.len() / 2),
            middle: vec![f64::NAN; 3 * n_faces],
            centre: vec![f64::NAN; n_faces],
            is_open: vec![true; raw.positions.len()],
            limit: 1.0,
            is_verified: vec![false; n_faces],
            changed: Vec::new(),
            claimed_in: vec![0; n_faces],
            round: 0,
            tree: FaceTree::default(),
            goes_by_parts: false,
            most_faces: greater(raw.faces.len() as u64, job.triangle_limit),
            blocked: Vec::new(),
            stuck: Vec::new(),
            counts: ImproveCounts::default(),
        };
        let mut labels = Vec::new();
        for v in 0..raw.positions.len() as u32 {
            labels.clear();
            labels.extend(this.surface.one_ring(v).map(|h| this.label[h as usize / 3]));
            let run = this.new_run(&mut labels);
            this.run.push(run);
        }
        this.place_vertices()?;
        this.weld()?;
        Ok(this)
    }

    /// Returns the evaluator.
    pub fn into_evaluator(self) -> PrimitiveEvaluator<'a> {
        self.evaluator
    }

    /// The evaluations so far, in points.
    pub fn work(&self) -> u64 {
        self.evaluator.work()
    }

    /// The tree of its primitives.
    pub fn csg(&self) -> &'a Csg {
        self.evaluator.csg()
    }

    /// Splits until every edge and face is within the aim, except for blocked ones, whose places are returned.
    pub fn refine(&mut self) -> Result<Vec<BlockedPlace>, ImproveError> {
        self.aim_at_walls()?;
        self.split_far(MOST_REPAIRS)?;
        // `edge_excess` is never NaN. That of a face may be, and then counts as far.
        let is_far = |h: u32| self.edge_excess(h) > 1.0 || !(self.face_excess(h / 3) <= 1.0);
        let remaining = self.stuck.iter().filter(|h| self.surface.has_face(**h / 3) && is_far(**h));
        let place = |h: &u32| {
            let [a, b] = [self.surface.start(*h), self.surface.end(*h)];
            let extent = (self.at(b) - self.at(a)).abs().to_array();
            BlockedPlace { at: self.middle_point(a, b).to_array(), extent }
        };
        Ok(remaining.map(place).collect())
    }

    /// Splits, flips and collapses the result of [`Self::refine`] until every edge and face is within the aim
    /// and few faces remain.
    pub fn improve(&mut self) -> Result<(), ImproveError> {
        self.remove_unsettled()?;
        let mut last = self.surface.n_faces();
        for cycle in 0..MOST_CYCLES {
            self.job.report(Progress { stage: "improve", done: cycle as u64, total: MOST_CYCLES as u64 });
            self.split_far(MOST_REPAIRS)?;
            self.collapse_all(None)?;
            self.flip_all()?;
            let now = self.surface.n_faces();
            // A cycle that removes less than 3 % of the faces is the last, since further ones gain less.
            if cycle > 0 && now * 100 > last * 97 || self.job.is_finishing() {
                break;
            }
            last = now;
        }
        // So far, errors were those at corners, middles and centroids. These checks take nine more samples of
        // each face.
        for _ in 0..MOST_CHECKS {
            self.split_far(MOST_REPAIRS)?;
            if self.job.is_finishing() || self.split_edges_of_refuted()? == 0 {
                break;
            }
            self.flip_all()?;
        }
        Ok(())
    }

    /// Splits faces, given by the numbers from [`Self::mesh`], and the surroundings as far as needed. Returns how many
    /// were split. Faces whose edges are too short, or that other sheets block, are not.
    pub fn split_faces(&mut self, faces: &[u32]) -> Result<usize, ImproveError> {
        self.next_round()?;
        let remaining: Vec<u32> = faces.iter().copied().filter(|f| self.surface.has_face(*f)).collect();
        let edges: Vec<u32> = remaining.iter().flat_map(|f| sides(3 * *f)).collect();
        self.sample_middles(&edges)?;
        let worst: Vec<u32> = remaining.iter().map(|f| self.worst_side(*f)).collect();
        self.goes_by_parts = true;
        let n = self.split_edges(&worst)?;
        self.goes_by_parts = false;
        self.flip_all()?;
        // Without repairs, which could destroy faces that are already proved.
        self.split_far(0)?;
        let unsettled = self.unsettled();
        self.settle(&unsettled)?;
        Ok(n)
    }

    /// The numbers of all vertices.
    pub fn vertices(&self) -> Vec<u32> {
        (0..self.surface.vertex_slots() as u32).filter(|v| self.surface.has_vertex(*v)).collect()
    }

    pub fn position(&self, v: u32) -> [f64; 3] {
        self.at(v).to_array()
    }

    /// The place of a vertex, with the extent of its edges.
    pub fn place_of(&self, v: u32) -> BlockedPlace {
        BlockedPlace { at: self.position(v), extent: self.extent_around(v, &self.position) }
    }

    /// The numbers of all faces.
    pub fn faces(&self) -> Vec<u32> {
        (0..self.surface.face_slots() as u32).filter(|f| self.surface.has_face(*f)).collect()
    }

    pub fn middle_of_face(&self, face: u32) -> [f64; 3] {
        let [a, b, c] = self.surface.corners(face).map(|v| self.at(v));
        ((a + b + c) / 3.0).to_array()
    }

    /// The place of a face, with its extent.
    pub fn place_of_face(&self, face: u32) -> BlockedPlace {
        let [a, b, c] = self.surface.corners(face).map(|v| self.at(v));
        let extent = (a.max(b).max(c) - a.min(b).min(c)).to_array();
        BlockedPlace { at: self.middle_of_face(face), extent }
    }

    /// The allowed error of edges and faces.
    pub fn aim(&self) -> f64 {
        self.aim
    }

    /// Vertices that could not reach their targets at first.
    pub fn blocked(&self) -> &[BlockedPlace] {
        &self.blocked
    }

    /// The number of vertices that are not on their primitives, because others block them or their Newton steps do not
    /// converge.
    pub fn n_unsettled(&self) -> usize {
        self.unsettled().len()
    }

    /// The position of the first of these vertices.
    pub fn first_unsettled(&self) -> Option<[f64; 3]> {
        self.unsettled().first().map(|v| self.at(*v).to_array())
    }

    pub fn n_faces(&self) -> usize {
        self.surface.n_faces()
    }

    /// The surface, with vertices and faces in the order of their creation, and by face the number of its half-edge
    /// face.
    pub fn mesh(&self) -> (LabelledSurface, Vec<u32>) {
        let mut number = vec![u32::MAX; self.position.len()];
        let mut positions = Vec::new();
        for (v, (number, at)) in number.iter_mut().zip(&self.position).enumerate() {
            if self.surface.has_vertex(v as u32) {
                *number = positions.len() as u32;
                positions.push(at.to_array());
            }
        }
        let remaining: Vec<u32> =
            (0..self.surface.face_slots() as u32).filter(|f| self.surface.has_face(*f)).collect();
        let faces = remaining.iter().map(|f| self.surface.corners(*f).map(|v| number[v as usize])).collect();
        let labels = remaining.iter().map(|f| self.label[*f as usize]).collect();
        (LabelledSurface { positions, faces, labels }, remaining)
    }

    /// Adds unmeasured constraints for a vertex on these primitives.
    fn new_run(&mut self, labels: &mut Vec<FaceLabel>) -> (u32, u32) {
        labels.sort_unstable();
        labels.dedup();
        let run = (self.constraints.len() as u32, labels.len() as u32);
        let at =
            |label: &FaceLabel| VertexConstraint { label: *label, distance: f64::NAN, normal: DVec3::ZERO };
        self.constraints.extend(labels.iter().map(at));
        run
    }

    /// The constraints of a vertex, one for each of its primitives.
    #[inline]
    fn constraints_of(&self, v: u32) -> &[VertexConstraint] {
        let (first, n) = self.run[v as usize];
        &self.constraints[first as usize..(first + n) as usize]
    }

    fn constraints_of_mut(&mut self, v: u32) -> &mut [VertexConstraint] {
        let (first, n) = self.run[v as usize];
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

    /// Begins a round, in which no face is claimed yet.
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

    /// Claims the faces of a list, if none is claimed in this round yet.
    fn claim_faces(&mut self, faces: &[u32]) -> bool {
        let are_free = faces.iter().all(|f| self.claimed_in[*f as usize] != self.round);
        if are_free {
            faces.iter().for_each(|f| self.claimed_in[*f as usize] = self.round);
        }
        are_free
    }

    /// Marks a changed face and its vertices for flips, collapses and checks.
    fn open_around(&mut self, face: u32) {
        self.changed.push(face);
        self.is_verified[face as usize] = false;
        for v in self.surface.corners(face) {
            self.is_open[v as usize] = true;
        }
    }

    /// Samples the primitives of these labels.
    fn sample(&mut self, queries: &[(FaceLabel, DVec3)]) -> Result<Vec<PrimitiveSample>, LeafError> {
        sample::sample(&mut self.evaluator, queries)
    }
}

/// The approximate bytes of a face here: half-edges with their middles, half a vertex with its constraints, its
/// entries in the tree and in lists.
const BYTES_A_FACE: u64 = 320;
/// The most rounds of checks by all samples. Chosen: the proof finds the errors that remain.
const MOST_CHECKS: usize = 12;
/// The most cycles of splits, flips and collapses. Chosen: the first two do nearly all of the work.
const MOST_CYCLES: usize = 4;

/// Twice the area of a triangle times its normal.
#[inline]
fn area_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// The half-edges of a face, starting from one of them.
#[inline]
fn sides(h: u32) -> [u32; 3] {
    [h, next_in_face(h), previous_in_face(h)]
}

#[cfg(test)]
mod tests;
