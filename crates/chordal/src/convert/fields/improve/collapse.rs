//! Rounds of edge collapses: vertices are removed if all changed edges and faces stay within the aim.
use super::sample::PrimitiveSample;
use super::{FaceLabel, ImproveError, SurfaceImprover, area_normal};
use crate::budget::par_map;
use crate::explicit::{next_in_face, previous_in_face};
use crate::math::greater;
use glam::DVec3;

/// The most rounds. Chosen: an independent set has at least a tenth of the vertices, so that this is far more than
/// any surface takes.
const MOST_ROUNDS: usize = 400;
/// Vertices with more faces are not removed. Chosen: an estimate visits all faces for each of the vertex's edges.
const MOST_FACES: usize = 64;
/// A crease counts as closed if the angle between its faces is below a quarter of that between its primitives. The
/// number is for squares of angles.
const CLOSED: f64 = 1.0 / 16.0;
/// Vertices in one task.
const CHUNK: usize = 1024;
/// Costs below this fraction of the aim count as equal, and the shorter edge is taken. Chosen: so small a difference
/// does not count beside the aim.
const ALIKE: f64 = 0.05;

/// A vertex with the half-edge along which it collapses.
#[derive(Clone, Copy, Debug)]
struct CollapseEstimate {
    h: u32,
    cost: f64,
    length: f64,
}

/// The star of a vertex `v` that collapses along a half-edge into `ring[0]`: `sides[i]` runs from `v` to `ring[i]`.
///
/// ```text
///   ring[2] ---- ring[1]       The faces of sides[0] and of sides[n − 1] vanish; the face of sides[i]
///      | \  [1]  / |           becomes (ring[0], ring[i], ring[i + 1]), for i from 1 to n − 2.
///      |   \   /   |
///      |     v --- ring[0]     The edges from ring[0] to ring[2] … ring[n − 2] are new ("spokes");
///      |   /   \   |           those to ring[1] and ring[n − 1] exist already.
///   ring[3] ---- ring[4]
/// ```
#[derive(Default)]
pub(super) struct VertexStar {
    pub sides: Vec<u32>,
    pub ring: Vec<u32>,
}

impl SurfaceImprover<'_> {
    /// Collapses until no vertex can be removed, or none of those marked in `among`.
    pub(super) fn collapse_all(&mut self, among: Option<&[bool]>) -> Result<(), ImproveError> {
        let mut star = VertexStar::default();
        let mut estimates: Vec<CollapseEstimate> = Vec::new();
        for _ in 0..MOST_ROUNDS {
            self.next_round()?;
            if self.job.is_finishing() {
                break;
            }
            // Estimates of the last round whose surroundings are unchanged stay valid.
            estimates.retain(|estimate| {
                self.surface.has_face(estimate.h / 3)
                    && !self.is_open[self.surface.start(estimate.h) as usize]
            });
            estimates.extend(self.estimated_collapses(among));
            // The estimates kept from the last round are sorted already; bits of non-negative numbers sort like the numbers.
            estimates
                .sort_by_key(|estimate| (estimate.cost.to_bits(), estimate.length.to_bits(), estimate.h));
            let mut faces = Vec::new();
            let (mut chosen, mut rest) = (Vec::new(), Vec::new());
            for estimate in estimates.drain(..) {
                // A collapse changes only the faces around its start, so that chosen collapses are
                // independent.
                faces.clear();
                faces.extend(self.surface.one_ring(self.surface.start(estimate.h)).map(|h| h / 3));
                if self.claim_faces(&faces) { chosen.push(estimate) } else { rest.push(estimate) }
            }
            if chosen.is_empty() {
                break;
            }
            self.collapse_edges(&chosen, &mut star)?;
            estimates = rest;
        }
        Ok(())
    }

    /// The best collapses of all open vertices, which are then no longer open.
    fn estimated_collapses(&mut self, among: Option<&[bool]>) -> Vec<CollapseEstimate> {
        let n = self.surface.vertex_slots() as u32;
        let may_collapse = |v: u32| among.is_none_or(|among| among[v as usize]);
        let open: Vec<u32> = (0..n)
            .filter(|v| std::mem::take(&mut self.is_open[*v as usize]))
            .filter(|v| self.surface.has_vertex(*v) && may_collapse(*v))
            .collect();
        let chunks: Vec<&[u32]> = open.chunks(CHUNK).collect();
        let view = &*self;
        let estimates = par_map(self.job, &chunks, |_, part| {
            let mut star = VertexStar::default();
            part.iter().filter_map(|v| view.best_collapse(*v, &mut star)).collect::<Vec<_>>()
        });
        estimates.concat()
    }

    pub(super) fn gather_star(&self, h: u32, star: &mut VertexStar) {
        star.sides.clear();
        star.ring.clear();
        let mut side = h;
        loop {
            star.sides.push(side);
            star.ring.push(self.surface.end(side));
            side = self.surface.twin(previous_in_face(side));
            if side == h {
                break;
            }
        }
    }

    /// The best collapse of a vertex, by estimates.
    fn best_collapse(&self, v: u32, star: &mut VertexStar) -> Option<CollapseEstimate> {
        let labels = self.constraints_of(v);
        if labels.len() > 2 {
            return None;
        }
        let mut n_creases = 0;
        let mut n_faces = 0;
        for h in self.surface.one_ring(v) {
            n_creases += usize::from(self.is_crease(h));
            n_faces += 1;
        }
        // On two primitives, a vertex is within a crease if exactly two of its edges are on it. Otherwise
        // creases end or branch at the vertex, which has to stay.
        if n_faces > MOST_FACES || n_creases != if labels.len() == 2 { 2 } else { 0 } {
            return None;
        }
        let mut best: Option<CollapseEstimate> = None;
        for h in self.surface.one_ring(v) {
            if n_creases == 2 && !self.is_crease(h) {
                continue;
            }
            self.gather_star(h, star);
            let most = best.as_ref().map_or(self.limit, |estimate| estimate.cost);
            let Some(cost) = self.estimated_cost(star, most) else { continue };
            let length = (self.at(star.ring[0]) - self.at(v)).length_squared();
            let is_better = best.as_ref().is_none_or(|estimate| {
                cost < estimate.cost || cost == estimate.cost && length < estimate.length
            });
            if is_better {
                best = Some(CollapseEstimate { h, cost, length });
            }
        }
        best
    }

    /// The estimated error of the new edges, relative to the aim; `None` if it is more than `most`.
    fn estimated_cost(&self, star: &VertexStar, most: f64) -> Option<f64> {
        let (ring, n) = (&star.ring, star.ring.len());
        let b = ring[0];
        let mut cost = ALIKE;
        // The faces after the collapse are a fan around the vertex that stays; the edges inside of the fan
        // are new.
        for i in 1..n - 1 {
            let label = self.label_of(star.sides[i]);
            let points = [b, ring[i], ring[i + 1]].map(|v| self.at(v));
            let normal = self.constraint(b, label)?.normal
                + self.constraint(ring[i], label)?.normal
                + self.constraint(ring[i + 1], label)?.normal;
            if !self.faces_along(points, normal.normalize_or_zero()) {
                return None;
            }
            if i + 1 < n - 1 {
                let after = self.label_of(star.sides[i + 1]);
                let distance = self.estimate(b, ring[i + 1], label);
                let excess = if label == after {
                    distance.abs() / self.aim_of([b, ring[i + 1]])
                } else {
                    let other = self.estimate(b, ring[i + 1], after);
                    self.crease_excess([b, ring[i + 1]], [label, after], [distance, other])
                };
                if !(excess <= most) {
                    return None;
                }
                cost = greater(excess, cost);
            }
        }
        Some(cost)
    }

    /// Samples collapses, and performs those that stay within the aim.
    fn collapse_edges(
        &mut self,
        estimates: &[CollapseEstimate],
        star: &mut VertexStar,
    ) -> Result<(), ImproveError> {
        let mut queries: Vec<(FaceLabel, DVec3)> = Vec::new();
        for estimate in estimates {
            self.gather_star(estimate.h, star);
            self.for_each_sample_point(star, |label, at| queries.push((label, at)));
        }
        let samples = self.sample(&queries)?;
        let mut from = 0;
        for estimate in estimates {
            // Chosen stars have no face in common, so that earlier collapses in this loop leave these samples
            // valid. They may change the neighbourhood, though, so that a collapse would no longer keep the
            // surface manifold.
            self.gather_star(estimate.h, star);
            let mut n = 0;
            self.for_each_sample_point(star, |_, _| n += 1);
            let samples = &samples[from..from + n];
            from += n;
            if self.surface.can_collapse(estimate.h)
                && self.is_within_aim(star, samples)
                && !self.closes_crease(star)
                && !self.would_intersect(star)
            {
                self.collapse(star, samples);
            }
        }
        Ok(())
    }

    /// The sample points of a collapse: the centroid of each remaining face, then the middles of new edges,
    /// for both sides of a crease.
    fn for_each_sample_point(&self, star: &VertexStar, mut ask: impl FnMut(FaceLabel, DVec3)) {
        let (ring, n) = (&star.ring, star.ring.len());
        let b = self.at(ring[0]);
        for i in 1..n - 1 {
            let centroid = (b + self.at(ring[i]) + self.at(ring[i + 1])) / 3.0;
            ask(self.label_of(star.sides[i]), centroid);
        }
        for i in 2..n - 1 {
            let (before, after) = (self.label_of(star.sides[i - 1]), self.label_of(star.sides[i]));
            let middle = 0.5 * (b + self.at(ring[i]));
            ask(before, middle);
            if before != after {
                ask(after, middle);
            }
        }
        for (i, label) in self.sides_that_change(star).into_iter().flatten() {
            ask(label, 0.5 * (b + self.at(ring[i])));
        }
    }

    /// The edges from `ring[0]` to `ring[1]` and to `ring[n − 1]` exist already. If the removed face at such an edge has
    /// another label than the face that takes its place, the edge becomes a crease or ceases to be one. Returns
    /// the index in the ring, and the new label.
    fn sides_that_change(&self, star: &VertexStar) -> [Option<(usize, FaceLabel)>; 2] {
        let n = star.ring.len();
        let label = |i: usize| self.label_of(star.sides[i]);
        [
            (label(0) != label(1)).then(|| (1, label(1))),
            (label(n - 1) != label(n - 2)).then(|| (n - 1, label(n - 2))),
        ]
    }

    /// The outer half-edges of the two removed faces, opposite the removed vertex.
    fn outer(&self, star: &VertexStar) -> [u32; 2] {
        let t = self.surface.twin(star.sides[0]);
        [next_in_face(star.sides[0]), previous_in_face(t)].map(|h| self.surface.twin(h))
    }

    /// By index in the ring: the signed distances of the spoke's middle from the primitives of the faces before and after
    /// it.
    fn spoke_distances(&self, star: &VertexStar, samples: &[PrimitiveSample]) -> Vec<[f64; 2]> {
        let n = star.ring.len();
        let mut spokes = vec![[f64::NAN; 2]; n];
        let t = self.surface.twin(star.sides[0]);
        // The first and the last spoke are existing edges.
        let first = self.middle_of(next_in_face(star.sides[0]));
        let last = self.middle_of(previous_in_face(t));
        let outer = self.outer(star).map(|h| self.middle_of(h));
        spokes[1] = [outer[0], first];
        spokes[n - 1] = [last, outer[1]];
        // Samples are in the order of `for_each_sample_point`: first n − 2 centroids.
        let mut next = n - 2;
        for i in 2..n - 1 {
            let is_crease = self.label_of(star.sides[i - 1]) != self.label_of(star.sides[i]);
            spokes[i] = [samples[next].distance, samples[next + usize::from(is_crease)].distance];
            next += 1 + usize::from(is_crease);
        }
        for (k, (i, _)) in self.sides_that_change(star).into_iter().flatten().enumerate() {
            // At `ring[1]` the face with the new label comes after the spoke, at `ring[n − 1]` before it.
            spokes[i][usize::from(i == 1)] = samples[next + k].distance;
        }
        spokes
    }

    /// Whether all new edges and faces are within the aim, and the faces are oriented like their primitives.
    fn is_within_aim(&self, star: &VertexStar, samples: &[PrimitiveSample]) -> bool {
        let (ring, n) = (&star.ring, star.ring.len());
        let b = ring[0];
        let spokes = self.spoke_distances(star, samples);
        for i in 1..n - 1 {
            let label = self.label_of(star.sides[i]);
            let corners = [b, ring[i], ring[i + 1]];
            let sample = samples[i - 1];
            let middles = [spokes[i][1], self.middle_of(next_in_face(star.sides[i])), spokes[i + 1][0]];
            let distances = self.distances(corners, label, middles, sample.distance);
            if !(distances.largest() <= self.limit * self.aim_of(corners))
                || !self.faces_along(corners.map(|v| self.at(v)), sample.normal)
            {
                return false;
            }
        }
        let outer = self.outer(star).map(|h| self.label_of(h));
        (1..n).all(|i| {
            let mut labels = [self.label_of(star.sides[i - 1]), self.label_of(star.sides[i])];
            // There the outer neighbour of the removed face takes its place.
            if i == 1 {
                labels[0] = outer[0];
            }
            if i == n - 1 {
                labels[1] = outer[1];
            }
            labels[0] == labels[1] || self.crease_excess([b, ring[i]], labels, spokes[i]) <= self.limit
        })
    }

    /// Whether faces would coincide at a crease, as where the solid is thinner than the edges are long.
    fn closes_crease(&self, star: &VertexStar) -> bool {
        let (ring, n) = (&star.ring, star.ring.len());
        let b = ring[0];
        let new = |i: usize| {
            let points = [b, ring[i], ring[i + 1]].map(|v| self.at(v));
            (self.label_of(star.sides[i]), area_normal(points).normalize_or_zero())
        };
        let old = |h: u32| (self.label_of(h), area_normal(self.points(h / 3)).normalize_or_zero());
        let is_closed = |x: (FaceLabel, DVec3), y: (FaceLabel, DVec3), v: u32| {
            let (Some(p), Some(q)) = (self.constraint(v, x.0), self.constraint(v, y.0)) else { return false };
            // For normals that are nearly opposite, 1 + cosine is half the square of the angle between the
            // faces.
            x.0 != y.0 && 1.0 + x.1.dot(y.1) < CLOSED * (1.0 + p.normal.dot(q.normal))
        };
        let outer = self.outer(star);
        (1..n - 1).any(|i| {
            let beyond = self.surface.twin(next_in_face(star.sides[i]));
            is_closed(new(i), old(beyond), ring[i]) || i + 1 < n - 1 && is_closed(new(i), new(i + 1), b)
        }) || is_closed(old(outer[0]), new(1), b)
            || is_closed(new(n - 2), old(outer[1]), b)
    }

    pub(super) fn would_intersect(&mut self, star: &VertexStar) -> bool {
        let (ring, n) = (&star.ring, star.ring.len());
        let new: Vec<([u32; 3], [DVec3; 3])> = (1..n - 1)
            .map(|i| [ring[0], ring[i], ring[i + 1]])
            .map(|face| (face, face.map(|v| self.at(v))))
            .collect();
        let gone: Vec<u32> = star.sides.iter().map(|h| h / 3).collect();
        self.crosses(&new, &gone)
    }

    fn collapse(&mut self, star: &VertexStar, samples: &[PrimitiveSample]) {
        let n = star.ring.len();
        let t = self.surface.twin(star.sides[0]);
        let mut spokes = self.spoke_distances(star, samples);
        // Existing edges that are unsampled stay unsampled.
        let changes = self.sides_that_change(star);
        if changes[0].is_none() {
            spokes[1][1] = self.middle[next_in_face(star.sides[0]) as usize];
        }
        if changes[1].is_none() {
            spokes[n - 1][0] = self.middle[previous_in_face(t) as usize];
        }
        [star.sides[0], t].iter().for_each(|h| self.tree.remove(*h / 3));
        self.surface.collapse(star.sides[0]);
        for i in 1..n - 1 {
            let side = star.sides[i];
            self.middle[side as usize] = spokes[i][1];
            self.middle[previous_in_face(side) as usize] = spokes[i + 1][0];
            self.centre[side as usize / 3] = samples[i - 1].distance;
            self.grow_tree(side / 3);
            self.open_around(side / 3);
        }
        self.counts.collapses += 1;
    }
}
