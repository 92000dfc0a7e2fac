//! `EdgeCollapser`: collapses edges, the cheapest first, as long as the surface stays manifold and no face
//! flips.
// Long because reasons stand beside the steps that they explain.
mod carried_values;
mod link_condition;
mod regions;
mod replay;

use super::attribute_guard::AttributeGuard;
use super::bucket_queue::BucketQueue;
use super::edge_guard::CollapseChange;
use super::error_monitor::ErrorMonitor;
use super::local_tolerance::LocalTolerance;
use super::quadric::Quadric;
use super::surface::{Compaction, HalfEdgeSurface, NONE};
use super::wedges::Wedges;
use crate::budget::Job;
use crate::explicit::{distance_sq_to_triangle, next_in_face, previous_in_face};
use crate::math::{Box3, cross, difference, dot, greater, lesser, prefetch, unit_and_length};
pub(super) use replay::PastCollapse;
use std::sync::Arc;

/// How a vertex may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CollapseVertexKind {
    /// A vertex inside the surface: moves anywhere.
    Smooth,
    /// A vertex on a feature line: moves along it.
    Feature,
    /// Fixed, since feature lines end or meet there.
    Corner,
    /// Fixed, since the mesh is not a manifold there.
    Locked,
}

/// When the collapses stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct StopCriterion<'a> {
    /// The number of faces at which they stop.
    pub faces: usize,
    /// The allowed distance from the original, by position.
    pub tolerance: &'a LocalTolerance,
    /// The largest mean distance from the planes of the original that a collapse may cause, as a fraction of
    /// the tolerance.
    pub share: Option<f64>,
}

#[derive(Clone)]
pub(super) struct EdgeCollapser {
    pub surface: HalfEdgeSurface,
    pub at: Vec<[f64; 3]>,
    pub quadric: Vec<Quadric>,
    pub kind: Vec<CollapseVertexKind>,
    /// By vertex: its original number; for a locked vertex, the number of its position.
    pub source_vertex: Vec<u32>,
    /// By original number: the first fan at the same position of the mesh.
    pub first_fan: Arc<[u32]>,
    /// Whether several vertices are at one position.
    pub has_fans: bool,
    /// By half-edge: whether its edge is on a feature line. A border always is a feature line.
    pub is_line: Vec<bool>,
    pub monitor: Option<ErrorMonitor>,
    pub wedges: Option<Wedges>,
    /// Keeps attributes within their limits; needs the monitor.
    pub attribute_guard: Option<AttributeGuard>,
    /// By vertex: whether it is at its original position.
    pub is_original: Vec<bool>,
    /// By vertex: an upper bound on the distance between it with its edges and the feature lines that it
    /// represents.
    feature_deviation: Vec<f64>,
    /// By vertex: the vertex into which it was collapsed, or itself.
    pub merged_into: Vec<u32>,
    /// The collapses that were carried out, if they are recorded.
    pub log: Option<Vec<PastCollapse>>,
    /// By face: the cost of the collapse that last changed it.
    pub face_cost: Vec<f32>,
    /// By vertex: whether it is fixed for now.
    pub is_held: Vec<bool>,
    /// By half-edge, for one of the two of an edge: a distance within which its collapse is refused as long
    /// as the faces around it do not change; 0 if none is known.
    refused_within: Vec<f32>,
    /// By half-edge: whether it is in the queue, for one of the two of an edge.
    is_queued: Vec<bool>,
    queue: BucketQueue,
    /// By original number: the round in which the position was visited.
    visited: Vec<u32>,
    round: u32,
    /// The faces around the edge after the collapse, without the two removed ones, counter-clockwise around
    /// the new point.
    after: Vec<(u32, [[f64; 3]; 3])>,
    /// The half-edges of these faces that are opposite the new point.
    opposite: Vec<u32>,
    /// The faces around the edge before the collapse, including the removed ones.
    before: Vec<u32>,
}

/// An edge collapse and its new point.
#[derive(Clone, Copy, Debug)]
struct EdgeCollapse {
    h: u32,
    to: [f64; 3],
    anchor: CollapseAnchor,
    cost: f32,
}

/// The fixed end of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CollapseAnchor {
    None,
    Start,
    End,
}

/// The least cosine between the normals of a face before and after. Chosen: without a limit, thin parts fold.
const LEAST_TURN: f64 = 0.25;
/// How many entries ahead of the queue's front memory is prefetched: for indices, and for the data they lead
/// to. Chosen: without prefetching, a prototype of this loop took twice the time.
const FAR_AHEAD: usize = 12;
const NEAR_AHEAD: usize = 6;
/// The contribution of the square of an edge's length to its cost, as a fraction of its weight. Chosen: so
/// small that it decides only where planes do not.
const SHORT: f64 = 1e-9;

/// The divisor of a sum of squares with this weight: its power of 3/8. That is between the sum, for which a
/// large flat piece has a small error nowhere, and the mean, for which one far point among many near ones is
/// cheap. Measured on eight shapes, with seven counts of triangles each: the largest distance is 5 % less
/// than with the sum and no larger than with any other power; for lengths it makes no difference.
#[inline]
fn weight_divisor(weight: f32) -> f32 {
    let root = weight.sqrt().sqrt();
    let power = root * root.sqrt();
    if power > 0.0 { power } else { 1.0 }
}

impl EdgeCollapser {
    pub fn new(
        surface: HalfEdgeSurface,
        at: Vec<[f64; 3]>,
        kind: Vec<CollapseVertexKind>,
        is_line: Vec<bool>,
    ) -> Self {
        let (n, n_vertices) = (surface.start.len(), at.len());
        let mut engine = Self {
            surface,
            quadric: vec![Quadric::default(); n_vertices],
            at,
            kind,
            source_vertex: (0..n_vertices as u32).collect(),
            first_fan: (0..n_vertices as u32).collect(),
            has_fans: false,
            is_line,
            monitor: None,
            wedges: None,
            attribute_guard: None,
            is_original: vec![true; n_vertices],
            feature_deviation: vec![0.0; n_vertices],
            merged_into: (0..n_vertices as u32).collect(),
            log: None,
            face_cost: vec![0.0; n / 3],
            is_held: vec![false; n_vertices],
            refused_within: vec![0.0; n],
            is_queued: vec![false; n],
            queue: BucketQueue::new(),
            visited: vec![0; n_vertices],
            round: 0,
            after: Vec::new(),
            opposite: Vec::new(),
            before: Vec::new(),
        };
        engine.add_planes();
        engine
    }

    /// Adds the planes of all faces, and at feature lines the planes perpendicular to the faces beside them.
    fn add_planes(&mut self) {
        for face in 0..(self.surface.start.len() / 3) as u32 {
            if self.surface.corners(face)[0] != NONE {
                self.add_planes_of(face);
            }
        }
    }

    /// Adds the planes of a face, and the planes of its edges that are feature lines.
    fn add_planes_of(&mut self, face: u32) {
        let corners = self.surface.corners(face);
        let p = corners.map(|v| self.at[v as usize]);
        let (normal, doubled) = normal_and_area(p);
        if doubled.is_nan() || doubled <= 0.0 {
            return;
        }
        let plane = Quadric::from_plane(normal, p[0], doubled);
        for v in corners {
            self.quadric[v as usize].add(&plane);
        }
        for k in 0..3 {
            if !self.is_kept_line(3 * face + k as u32) {
                continue;
            }
            // The plane through the edge, upright on the face, keeps vertices on the line.
            let along = difference(p[(k + 1) % 3], p[k]);
            let (upright, size) = unit_and_length(cross(along, normal));
            if size > 0.0 {
                let plane = Quadric::from_plane(upright, p[k], LINE_WEIGHT * dot(along, along));
                self.quadric[corners[k] as usize].add(&plane);
                self.quadric[corners[(k + 1) % 3] as usize].add(&plane);
            }
        }
    }

    /// Whether the edge of `h` is on a border or on another feature line.
    #[inline]
    fn is_kept_line(&self, h: u32) -> bool {
        self.surface.twin[h as usize] == NONE || self.is_line[h as usize]
    }

    /// The collapse of an edge, with its new point and cost; `None` if it is not allowed.
    #[inline]
    fn collapse_of(&self, h: u32) -> Option<EdgeCollapse> {
        let (a, b) = (self.surface.start[h as usize], self.surface.end(h));
        if self.is_held[a as usize] || self.is_held[b as usize] {
            return None;
        }
        let line = self.is_kept_line(h);
        let anchor = match (self.kind[a as usize], self.kind[b as usize]) {
            (
                CollapseVertexKind::Corner | CollapseVertexKind::Locked,
                CollapseVertexKind::Corner | CollapseVertexKind::Locked,
            ) => return None,
            (CollapseVertexKind::Smooth, CollapseVertexKind::Smooth) => CollapseAnchor::None,
            (CollapseVertexKind::Smooth, _) => CollapseAnchor::End,
            (_, CollapseVertexKind::Smooth) => CollapseAnchor::Start,
            // Vertices of two feature lines merge only along a line; otherwise the lines would be joined.
            _ if !line => return None,
            (CollapseVertexKind::Feature, CollapseVertexKind::Feature) => CollapseAnchor::None,
            (CollapseVertexKind::Feature, _) => CollapseAnchor::End,
            (_, CollapseVertexKind::Feature) => CollapseAnchor::Start,
        };
        let q = self.quadric[a as usize].plus(&self.quadric[b as usize]);
        let (p, r) = (self.at[a as usize], self.at[b as usize]);
        let along = difference(r, p);
        let square = dot(along, along);
        let (to, cost) = match anchor {
            CollapseAnchor::Start => (p, q.at(p)),
            CollapseAnchor::End => (r, q.at(r)),
            CollapseAnchor::None => {
                let middle = std::array::from_fn(|k| 0.5 * (p[k] + r[k]));
                let (to, cost) = q.minimizer(middle);
                let offset = difference(to, middle);
                // Planes that are almost parallel meet far away; there the middle is better.
                if dot(offset, offset) <= FAR * square { (to, cost) } else { (middle, q.at(middle)) }
            }
        };
        let weight = q.weight();
        let cost = (cost + SHORT * square * weight) as f32 / weight_divisor(weight as f32);
        Some(EdgeCollapse { h, to, anchor, cost })
    }

    /// Puts an edge into the queue; its cost is computed when it is popped. Edges around a collapse mostly
    /// are in the queue already, and their costs rise.
    #[inline]
    fn enqueue(&mut self, h: u32) {
        let twin = self.surface.twin[h as usize];
        if !self.is_queued[h as usize] && (twin == NONE || !self.is_queued[twin as usize]) {
            // `NONE` is the largest number, so a border edge keeps its only half-edge.
            let h = lesser(twin, h);
            self.is_queued[h as usize] = true;
            self.queue.push_now(h);
        }
    }

    /// Puts every edge into the queue by its cost, except those that are known to be refused.
    fn enqueue_all(&mut self, tolerance: &LocalTolerance) {
        self.queue = BucketQueue::new();
        self.is_queued.fill(false);
        for h in 0..self.surface.start.len() as u32 {
            if self.surface.start[h as usize] != NONE
                && h < self.surface.twin[h as usize]
                && !tolerance.is_less_than(self.refused_within[h as usize])
                && let Some(EdgeCollapse { cost, .. }) = self.collapse_of(h)
            {
                self.is_queued[h as usize] = true;
                self.queue.push(cost, h);
            }
        }
    }

    /// Collapses edges until there are few enough faces or no collapse is allowed. Returns `false` if the
    /// job was cancelled.
    pub fn run(&mut self, until: &StopCriterion<'_>, job: &Job) -> bool {
        self.enqueue_all(until.tolerance);
        self.empty_queue(until, job)
    }

    /// The same for the edges in the queue, and those that are added meanwhile.
    pub fn empty_queue(&mut self, until: &StopCriterion<'_>, job: &Job) -> bool {
        let mut steps = 0_u32;
        while self.surface.n_faces > until.faces {
            let Some(h) = self.queue.pop() else { break };
            self.fetch_ahead();
            self.is_queued[h as usize] = false;
            if self.surface.start[h as usize] == NONE {
                continue;
            }
            // Two edges that were merged may both have been in the queue.
            let twin = self.surface.twin[h as usize];
            if twin != NONE && self.is_queued[twin as usize] {
                continue;
            }
            let h = lesser(twin, h);
            let Some(collapse) = self.collapse_of(h) else { continue };
            // Costs rise while an edge waits, so its place in the queue may be out of date: it goes back
            // until its present cost is due.
            if self.queue.is_later(collapse.cost) {
                self.is_queued[h as usize] = true;
                self.queue.push(collapse.cost, h);
                continue;
            }
            steps = steps.wrapping_add(1);
            // Checked about once a millisecond.
            if steps.is_multiple_of(1024) && job.is_cancelled() {
                return false;
            }
            self.monitor.iter_mut().for_each(|monitor| monitor.samples.failed_at_sq = 0.0);
            // In this order: `flips_no_face` collects the faces that the later tests look at, and attributes
            // are compared for the samples that the test of the tolerance has assigned to these.
            if until.share.is_none_or(|share| self.is_slight(&collapse, share, until.tolerance))
                && self.satisfies_link_condition(h)
                && self.flips_no_face(&collapse)
                && self.stays_within_tolerance(&collapse, until)
                && self.keeps_attributes(&collapse, until)
            {
                self.apply(&collapse);
            } else {
                // Still 0 if it was refused for another reason than a distance.
                let distance_sq = self.monitor.as_ref().map_or(0.0, |monitor| monitor.samples.failed_at_sq);
                self.refused_within[h as usize] = distance_sq.sqrt() as f32;
            }
        }
        true
    }

    /// Drops removed faces and vertices; the others keep their order.
    pub fn compact(&mut self) -> Compaction {
        let compaction = self.surface.compact();
        self.at = compaction.vertices(&self.at).collect();
        self.quadric = compaction.vertices(&self.quadric).collect();
        self.kind = compaction.vertices(&self.kind).collect();
        self.source_vertex = compaction.vertices(&self.source_vertex).collect();
        self.is_original = compaction.vertices(&self.is_original).collect();
        self.feature_deviation = compaction.vertices(&self.feature_deviation).collect();
        let (n_vertices, n) = (self.at.len(), self.surface.start.len());
        self.merged_into = (0..n_vertices as u32).collect();
        self.is_held = vec![false; n_vertices];
        self.is_line = compaction.half_edges(&self.is_line).collect();
        self.is_queued = vec![false; n];
        self.refused_within = compaction.half_edges(&self.refused_within).collect();
        self.queue = BucketQueue::new();
        self.face_cost = compaction.faces(&self.face_cost).collect();
        self.monitor.iter_mut().for_each(|monitor| monitor.samples.compact(&compaction));
        self.wedges.iter_mut().for_each(|wedges| wedges.compact(&compaction));
        compaction
    }

    /// Whether the mean distance of the new point from planes of the original is below a fraction of the
    /// tolerance.
    fn is_slight(&self, collapse: &EdgeCollapse, share: f64, tolerance: &LocalTolerance) -> bool {
        let ends = [self.surface.start[collapse.h as usize], self.surface.end(collapse.h)];
        let [a, b] = ends.map(|v| &self.quadric[v as usize]);
        let sum = a.plus(b);
        tolerance.holds(collapse.to, sum.at(collapse.to) / (sum.weight() * share * share))
    }

    /// Prefetches the memory of edges that are popped soon, in two steps, since the second one needs the
    /// first.
    #[inline]
    fn fetch_ahead(&self) {
        if let Some(h) = self.queue.ahead(FAR_AHEAD) {
            prefetch(&self.surface.start, h as usize);
            prefetch(&self.surface.twin, h as usize);
        }
        if let Some(h) = self.queue.ahead(NEAR_AHEAD) {
            let (a, b) = (self.surface.start[h as usize], self.surface.end(h));
            for v in [a, b] {
                if v != NONE {
                    prefetch(&self.quadric, v as usize);
                    prefetch(&self.at, v as usize);
                    prefetch(&self.surface.outgoing, v as usize);
                }
            }
        }
    }

    /// Collects the faces around the edge and returns whether none of them would flip.
    fn flips_no_face(&mut self, collapse: &EdgeCollapse) -> bool {
        let Self { surface, at, before, after, opposite, .. } = self;
        let across = surface.twin[collapse.h as usize];
        before.clear();
        after.clear();
        opposite.clear();
        before.push(collapse.h / 3);
        if across != NONE {
            before.push(across / 3);
        }
        for g in surface.around_edge(collapse.h) {
            let (face, side) = (g / 3, next_in_face(g));
            let old = at[surface.start[g as usize] as usize];
            let [x, y] = [side, next_in_face(side)].map(|h| at[surface.start[h as usize] as usize]);
            let along = difference(y, x);
            let normal = cross(difference(x, old), along);
            let now = cross(difference(x, collapse.to), along);
            // Squares instead of roots, where the cosine is positive.
            let together = dot(normal, now);
            let (bb, nn) = (dot(normal, normal), dot(now, now));
            // A face without area has no normal to flip.
            if bb > 0.0 && (together <= 0.0 || together * together < LEAST_TURN * LEAST_TURN * bb * nn) {
                return false;
            }
            if nn <= 0.0 {
                return false;
            }
            after.push((face, [collapse.to, x, y]));
            opposite.push(side);
            before.push(face);
        }
        true
    }

    /// An upper bound on the distance of the feature lines that an edge's ends represent from the new point
    /// and its edges: their earlier distance, and the distance of the ends from the new edges. At a border
    /// the check of the surface's distance covers that.
    fn feature_deviation(&self, collapse: &EdgeCollapse) -> f64 {
        let h = collapse.h;
        let across = self.surface.twin[h as usize];
        if across == NONE || !self.is_line[h as usize] {
            return 0.0;
        }
        let ends = [self.surface.start[h as usize], self.surface.end(h)];
        let mut most = 0.0;
        let mut next = Vec::new();
        for v in ends {
            most = greater(self.feature_deviation[v as usize], most);
            for g in self.surface.one_ring(v) {
                let arrives = previous_in_face(g);
                let leaves = (self.is_kept_line(g)).then(|| self.surface.end(g));
                let open = self.surface.twin[arrives as usize] == NONE;
                let last = open.then(|| self.surface.start[arrives as usize]);
                next.extend(leaves.into_iter().chain(last).filter(|w| !ends.contains(w)));
            }
        }
        let distance_to = |v: u32| {
            let p = self.at[v as usize];
            // A triangle with two equal corners is a segment.
            let to = |w: &u32| distance_sq_to_triangle(p, [collapse.to, self.at[*w as usize], collapse.to]);
            let start = difference(p, collapse.to);
            next.iter().map(to).fold(dot(start, start), |least, x| lesser(x, least))
        };
        // Each end has to be near some part of the new line; the earlier deviation adds to that.
        let step = ends.map(distance_to);
        most + (greater(step[0], step[1])).sqrt()
    }

    /// The box around the faces that change, before and after.
    fn changed_box(&self, collapse: &EdgeCollapse) -> Box3 {
        let corners = self.before.iter().flat_map(|face| self.surface.corners(*face));
        Box3::from_points(corners.map(|v| &self.at[v as usize]).chain([&collapse.to]))
    }

    /// Whether the surface stays within the tolerance of the original, as far as the monitor checks it.
    fn stays_within_tolerance(&mut self, collapse: &EdgeCollapse, until: &StopCriterion<'_>) -> bool {
        if until.tolerance.is_finite()
            && !until.tolerance.holds_in_box(|| self.changed_box(collapse), self.feature_deviation(collapse))
        {
            return false;
        }
        let Some(watch) = &mut self.monitor else { return true };
        let surface = &self.surface;
        let ends = [surface.start[collapse.h as usize], surface.end(collapse.h)];
        watch.allows(
            CollapseChange {
                before: &self.before,
                after: &self.after,
                opposite: &self.opposite,
                is_closed: !ends.into_iter().any(|v| surface.is_border(v)),
                to: collapse.to,
                surface: &self.surface,
                at: &self.at,
                cost: collapse.cost,
            },
            until.tolerance,
        )
    }

    /// Carries out a collapse, and puts the edges around it into the queue.
    fn apply(&mut self, collapse: &EdgeCollapse) {
        let b = self.carry_out(collapse);
        let first = self.surface.outgoing[b as usize];
        let mut g = first;
        // Counter-clockwise from the border half-edge, if there is one, so that one pass visits all edges.
        loop {
            self.enqueue(g);
            self.forget_refusals(self.surface.end(g));
            let arrives = previous_in_face(g);
            g = self.surface.twin[arrives as usize];
            if g == NONE {
                self.enqueue(arrives);
                self.forget_refusals(self.surface.start[arrives as usize]);
                break;
            }
            if g == first {
                break;
            }
        }
    }

    /// Carries out a collapse; returns the remaining vertex.
    fn carry_out(&mut self, collapse: &EdgeCollapse) -> u32 {
        let h = collapse.h;
        let (a, b) = (self.surface.start[h as usize], self.surface.end(h));
        self.log.iter_mut().for_each(|log| log.push(PastCollapse { collapse: *collapse, ends: [a, b] }));
        // Before the surface changes, since the change of the values is found by the faces of the edge.
        if let Some(change) = self.wedge_change(collapse)
            && let Some(wedges) = &mut self.wedges
        {
            change.rows.iter().for_each(|(wedge, values)| wedges.set_row(*wedge, values));
            wedges.transfer(&self.surface, &self.is_line, &change.transfer);
        }
        if let Some(watch) = &mut self.monitor {
            watch.samples.commit(&self.before);
        }
        for g in self.surface.around_edge(h) {
            self.face_cost[g as usize / 3] = collapse.cost;
        }
        self.feature_deviation[b as usize] = self.feature_deviation(collapse);
        let sum = self.quadric[a as usize];
        self.quadric[b as usize].add(&sum);
        // With the anchor `End`, `b` stays what it was; with `Start` it becomes `a`; anywhere else it is no
        // vertex of the original.
        if collapse.anchor != CollapseAnchor::End {
            let from_start = collapse.anchor == CollapseAnchor::Start;
            self.is_original[b as usize] = from_start && self.is_original[a as usize];
            if from_start {
                self.kind[b as usize] = self.kind[a as usize];
                self.source_vertex[b as usize] = self.source_vertex[a as usize];
            }
        }
        self.at[b as usize] = collapse.to;
        let across = self.surface.twin[h as usize];
        // Of each pair of merged edges, the result is a feature line if either was.
        for side in [h, across] {
            if side == NONE {
                continue;
            }
            let [x, y] = [next_in_face(side), previous_in_face(side)].map(|g| self.surface.twin[g as usize]);
            let line =
                self.is_line[next_in_face(side) as usize] || self.is_line[previous_in_face(side) as usize];
            for t in [x, y] {
                if t != NONE {
                    self.is_line[t as usize] = line;
                }
            }
        }
        self.surface.collapse(h);
        self.merged_into[a as usize] = b;
        b
    }

    /// Forgets refusals around a vertex whose faces have changed.
    #[inline]
    fn forget_refusals(&mut self, v: u32) {
        if self.monitor.is_some() {
            for h in self.surface.one_ring(v) {
                self.refused_within[h as usize] = 0.0;
                self.refused_within[previous_in_face(h) as usize] = 0.0;
            }
        }
    }
}

/// The vertex that now represents an original one; `merged_into` says into which each was collapsed.
pub(super) fn representative(merged_into: &mut [u32], mut v: u32) -> u32 {
    loop {
        let up = merged_into[v as usize];
        if up == v {
            return v;
        }
        // Halve the path for later queries.
        merged_into[v as usize] = merged_into[up as usize];
        v = up;
    }
}

/// A face at the vertex that now represents `v`; [`NONE`] if there is none.
pub(super) fn face_standing_for(surface: &HalfEdgeSurface, merged_into: &mut [u32], v: u32) -> u32 {
    if v == NONE {
        return NONE;
    }
    match surface.outgoing[representative(merged_into, v) as usize] {
        NONE => NONE,
        h => h / 3,
    }
}

/// The weight of planes along feature lines, times the square of an edge's length. Chosen: more than the
/// weight of a face with that edge.
const LINE_WEIGHT: f64 = 2.0;
/// The largest distance of the new point from the middle of an edge, as a multiple of its length, squared.
const FAR: f64 = 4.0;

/// The unit normal of a triangle and twice its area.
#[inline]
fn normal_and_area(p: [[f64; 3]; 3]) -> ([f64; 3], f64) {
    unit_and_length(cross(difference(p[1], p[0]), difference(p[2], p[0])))
}
