//! Rounds of edge splits: they add vertices on the primitives where edges or faces are too far from these.
use super::newton::{ProjectionBatch, SETTLED};
use super::{FaceLabel, ImproveError, SurfaceImprover, VertexConstraint, area_normal, sides};
use crate::explicit::{next_in_face, previous_in_face};
use crate::math::lesser;
use glam::DVec3;

/// The most rounds. Chosen: each halves edges, and quarters the error.
const MOST_ROUNDS: usize = 40;
/// The most repairs in one call. Chosen: later ones gain little.
pub(super) const MOST_REPAIRS: usize = 3;
/// The error that the collapses of a repair may leave, relative to the largest one. Chosen: a gain smaller than that would
/// be undone by the following splits.
const REPAIRED: f64 = 0.7;
/// They may leave at most this many times the aim. Chosen: with more, whole parts would vanish.
const MOST_EXCESS: f64 = 2.0;
/// The most sides flipped for one split. Chosen: along a crease, many slivers lie side by side.
const MOST_FLIPS: usize = 12;
/// Edges shorter than this fraction of the aim are not split. Chosen: the tolerance needs nothing that small.
const SHORTEST: f64 = 0.25;

impl SurfaceImprover<'_> {
    /// Splits edges, then faces, until no error is above the aim. If all splits are blocked, a repair makes
    /// space for them, at most `most_repairs` times.
    pub(super) fn split_far(&mut self, most_repairs: usize) -> Result<(), ImproveError> {
        let mut n_repairs = 0;
        for _ in 0..MOST_ROUNDS {
            self.next_round()?;
            if self.job.is_finishing() {
                self.stuck.clear();
                break;
            }
            let mut far = self.far_edges()?;
            // Faces only after all edges, whose splits change them.
            if far.is_empty() {
                far = self.edges_of_far_faces()?;
            }
            if far.is_empty() {
                self.stuck.clear();
                break;
            }
            if self.split_edges(&far)? == 0 {
                n_repairs += 1;
                if n_repairs > most_repairs {
                    self.stuck = far;
                    break;
                }
                self.repair(&far)?;
            }
            self.flip_all()?;
            self.stuck = far;
        }
        Ok(())
    }

    /// If splits would fold the surface, some triangles stand on edge. Flips and collapses that reduce the
    /// error, even if not to the aim, remove them.
    fn repair(&mut self, far: &[u32]) -> Result<(), ImproveError> {
        let excess = far.iter().fold(1.0, |most, h| {
            let this_excess = self.edge_excess(*h);
            if this_excess > most && this_excess.is_finite() { this_excess } else { most }
        });
        for h in far {
            self.changed.extend([*h / 3, self.surface.twin(*h) / 3]);
        }
        self.flip_all()?;
        // Only vertices nearby may collapse: elsewhere the following splits would restore the triangles at once.
        let mut is_near = vec![false; self.is_open.len()];
        for h in far.iter().filter(|h| self.surface.has_face(**h / 3)) {
            for face in [*h / 3, self.surface.twin(*h) / 3] {
                for v in self.surface.corners(face) {
                    self.surface.one_ring(v).for_each(|h| is_near[self.surface.end(h) as usize] = true);
                }
            }
        }
        self.is_open.copy_from_slice(&is_near);
        let limit = REPAIRED * excess;
        self.limit = lesser(limit, MOST_EXCESS);
        let result = self.collapse_all(Some(&is_near));
        self.limit = 1.0;
        // Estimates under the larger limit do not hold for the aim, so all vertices are tried again.
        self.is_open.fill(true);
        result
    }

    /// Edges with an error above the aim, the worst first. Edges whose estimate is above half of the aim are sampled.
    fn far_edges(&mut self) -> Result<Vec<u32>, ImproveError> {
        let close: Vec<u32> = self.edges().filter(|h| self.edge_excess(*h) > 0.5).collect();
        self.sample_middles(&close)?;
        let mut far: Vec<(f64, u32)> =
            close.into_iter().map(|h| (self.edge_excess(h), h)).filter(|(excess, _)| *excess > 1.0).collect();
        far.sort_unstable_by(|(x, h), (y, g)| y.total_cmp(x).then(h.cmp(g)));
        Ok(far.into_iter().map(|(_, h)| h).collect())
    }

    /// The longest edges of faces with an error above the aim.
    fn edges_of_far_faces(&mut self) -> Result<Vec<u32>, ImproveError> {
        let faces = (0..self.surface.face_slots() as u32).filter(|f| self.surface.has_face(*f));
        // NaN counts as far.
        let close: Vec<u32> = faces.filter(|f| !(self.face_excess(*f) <= 0.5)).collect();
        self.sample_centres(&close)?;
        let mut far: Vec<(f64, u32)> = close
            .into_iter()
            .map(|f| (self.face_excess(f), f))
            .filter(|(excess, _)| !(*excess <= 1.0))
            .collect();
        far.sort_unstable_by(|(x, f), (y, g)| y.total_cmp(x).then(f.cmp(g)));
        Ok(far.into_iter().map(|(_, f)| self.longest_side(f)).collect())
    }

    /// Splits faces with an error above the aim at a sample.
    pub(super) fn split_edges_of_refuted(&mut self) -> Result<usize, ImproveError> {
        self.next_round()?;
        let unverified: Vec<u32> = (0..self.surface.face_slots() as u32)
            .filter(|f| self.surface.has_face(*f) && !self.is_verified[*f as usize])
            .collect();
        let refuted = self.find_refuted(&unverified)?;
        let edges: Vec<u32> = refuted.into_iter().map(|f| self.longest_side(f)).collect();
        self.split_edges(&edges)
    }

    /// The crease edge with the largest error if that is not small, otherwise the longest edge.
    pub(super) fn worst_side(&self, face: u32) -> u32 {
        // Below this a crease does not make proofs fail. Measured.
        const CLEARLY: f64 = 0.2;
        let excess = |h: u32| if self.is_crease(h) { self.edge_excess(h) } else { 0.0 };
        let [a, b, c] = sides(3 * face);
        let worst = [b, c].into_iter().fold(a, |worst, h| if excess(h) > excess(worst) { h } else { worst });
        if excess(worst) > CLEARLY { worst } else { self.longest_side(face) }
    }

    fn longest_side(&self, face: u32) -> u32 {
        let length =
            |h: u32| (self.at(self.surface.end(h)) - self.at(self.surface.start(h))).length_squared();
        let [a, b, c] = sides(3 * face);
        [b, c].into_iter().fold(a, |best, h| if length(h) > length(best) { h } else { best })
    }

    /// Splits the edges of a list whose faces do not overlap, and whose new vertex has a target. Returns their number.
    pub(super) fn split_edges(&mut self, list: &[u32]) -> Result<usize, ImproveError> {
        let mut targets = ProjectionBatch::default();
        let mut chosen = Vec::new();
        for h in list.iter().copied() {
            let t = self.surface.twin(h);
            let (a, b) = (self.surface.start(h), self.surface.end(h));
            let too_short = (self.at(b) - self.at(a)).length() < SHORTEST * self.aim_of([a, b]);
            if too_short || !self.claim_faces(&[h / 3, t / 3]) {
                continue;
            }
            let labels = [self.label_of(h), self.label_of(t)];
            let both = if labels[0] == labels[1] { &labels[..1] } else { &labels[..] };
            targets.push(self.middle_point(a, b), both.iter().copied());
            chosen.push(h);
        }
        targets.project(&mut self.evaluator, self.tol)?;
        // A new round, in which only faces that change are claimed: a split may need to flip faces of an edge
        // that is still to be split.
        self.round += 1;
        let (mut n_splits, mut stopped) = (0, Vec::new());
        for (k, h) in chosen.into_iter().enumerate() {
            if !self.claim_faces(&[h / 3, self.surface.twin(h) / 3]) {
                continue;
            }
            let (a, b) = (self.surface.start(h), self.surface.end(h));
            let (middle, to) = (self.middle_point(a, b), targets.at[k]);
            // A target farther away is on another part of the surface.
            let reach = 0.7 * (self.at(b) - self.at(a)).length();
            // A split is useless if its vertex does not reach the primitives.
            let aim = self.aim_of([a, b]);
            let is_placed = targets.constraints_of(k).iter().all(|on| on.distance.abs() <= SETTLED * aim);
            if !is_placed || (to - middle).length() > reach {
                continue;
            }
            let on = targets.constraints_of(k);
            if let Some(flips) = self.split_flips(h, to, on) {
                self.split(h, to, &targets, k, &flips);
                n_splits += 1;
            } else if let Some((to, flips)) = self.partial_split(h, [middle, to], on) {
                self.split(h, to, &targets, k, &flips);
                stopped.push(self.surface.vertex_slots() as u32 - 1);
                n_splits += 1;
            }
        }
        self.measure_vertices(&stopped)?;
        self.counts.splits += n_splits;
        Ok(n_splits)
    }

    /// The sides, by their ends, that have to be flipped in this order if an edge is split at a point; `None` if the edge
    /// cannot be split there.
    ///
    /// The new vertex z is joined to all sides of the edge's two faces. If such a face would be folded, because z is
    /// beyond the side, the face across the side is removed as well, and its other sides are joined to z instead:
    ///
    /// ```text
    ///       apex               apex
    ///      /    \             / |  \        z is beyond the side x–y: the side is flipped,
    ///     /   z  \           /  z   \       and z is joined to x–apex and apex–y.
    ///    x ------ y    →    x -' `-- y
    ///     \      /           \      /
    /// ```
    fn split_flips(&mut self, h: u32, to: DVec3, on: &[VertexConstraint]) -> Option<Vec<[u32; 2]>> {
        // The new vertex has the next number.
        let (z, t) = (self.surface.vertex_slots() as u32, self.surface.twin(h));
        let ends = [self.surface.start(h), self.surface.end(h)];
        let mut rim = vec![ends[0], ends[1], self.surface.apex(h), self.surface.apex(t)];
        let mut sides = vec![next_in_face(t), previous_in_face(t), next_in_face(h), previous_in_face(h)];
        let (mut new, mut removed, mut flips) = (Vec::new(), vec![h / 3, t / 3], Vec::new());
        while let Some(side) = sides.pop() {
            let (x, y) = (self.surface.start(side), self.surface.end(side));
            let points = [self.at(x), self.at(y), to];
            if self.keeps_orientation(points, side, on) {
                new.push(([x, y, z], points));
                continue;
            }
            let across = self.surface.twin(side);
            let (beyond, apex) = (across / 3, self.surface.apex(across));
            // A face across a crease has another primitive than its new vertex; an apex on the rim would
            // occur twice around z.
            let is_blocked = self.is_crease(side) || self.claimed_in[beyond as usize] == self.round;
            if is_blocked || flips.len() == MOST_FLIPS || rim.contains(&apex) {
                return None;
            }
            rim.push(apex);
            removed.push(beyond);
            flips.push([x, y]);
            sides.extend([previous_in_face(across), next_in_face(across)]);
        }
        // The first two are claimed already.
        let is_free = !self.crosses(&new, &removed) && self.claim_faces(&removed[2..]);
        is_free.then_some(flips)
    }

    /// Whether a new face at a side is oriented like its primitive at the new vertex. If the old face is not, because it
    /// was turned over before or is too coarse, the new face must at least keep its orientation.
    fn keeps_orientation(&self, points: [DVec3; 3], side: u32, on: &[VertexConstraint]) -> bool {
        let (area, old) = (area_normal(points), area_normal(self.points(side / 3)));
        let label = self.label_of(side);
        let normal = on.iter().find(|on| on.label == label).map_or(DVec3::ZERO, |on| on.normal);
        area.dot(normal) > 0.0 || area.dot(old) > 0.0 && !(old.dot(normal) > 0.0)
    }

    /// The farthest point on the way to its target that a new vertex can reach if another sheet blocks it. That sheet may
    /// have to move the same way, so the vertex reaches its target later.
    fn partial_split(
        &mut self,
        h: u32,
        [from, to]: [DVec3; 2],
        on: &[VertexConstraint],
    ) -> Option<(DVec3, Vec<[u32; 2]>)> {
        if !self.goes_by_parts {
            return None;
        }
        let at = |share: f64| from + share * (to - from);
        [0.5, 0.25, 0.0]
            .into_iter()
            .find_map(|share| self.split_flips(h, at(share), on).map(|flips| (at(share), flips)))
    }

    /// Flips the edge between two vertices unconditionally.
    fn flip_side(&mut self, [x, y]: [u32; 2]) {
        let Some(side) = self.surface.between(x, y) else { return };
        let faces = [side / 3, self.surface.twin(side) / 3];
        self.surface.flip(side);
        for face in faces {
            self.forget(face);
            self.grow_tree(face);
            self.open_around(face);
        }
        self.counts.flips += 1;
    }

    fn split(&mut self, h: u32, to: DVec3, targets: &ProjectionBatch, k: usize, flips: &[[u32; 2]]) {
        let t = self.surface.twin(h);
        let (f, g) = (h / 3, t / 3);
        self.surface.split(h);
        self.position.push(to);
        let constraints = targets.constraints_of(k);
        self.run.push((self.constraints.len() as u32, constraints.len() as u32));
        self.constraints.extend_from_slice(constraints);
        self.is_open.push(true);
        let aim = self.aim_of([self.surface.start(h), self.surface.start(t)]);
        self.aim_at.push(aim);
        let new = self.label.len() as u32;
        let labels: [FaceLabel; 2] = [self.label[f as usize], self.label[g as usize]];
        self.label.extend(labels);
        self.centre.extend([f64::NAN; 2]);
        self.claimed_in.extend([self.round; 2]);
        self.is_verified.extend([false; 2]);
        // The sides that do not change keep their samples.
        let (hn, tn) = (next_in_face(h), next_in_face(t));
        let (beyond_f, beyond_g) = (self.middle[hn as usize], self.middle[tn as usize]);
        self.middle.extend([f64::NAN, beyond_f, f64::NAN, f64::NAN, beyond_g, f64::NAN]);
        for side in [h, hn, t, tn] {
            self.middle[side as usize] = f64::NAN;
        }
        self.centre[f as usize] = f64::NAN;
        self.centre[g as usize] = f64::NAN;
        self.add_to_tree(new, f);
        self.add_to_tree(new + 1, g);
        for face in [f, g, new, new + 1] {
            self.grow_tree(face);
            self.open_around(face);
        }
        flips.iter().for_each(|ends| self.flip_side(*ends));
    }
}
