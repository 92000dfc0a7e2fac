//! Rounds of edge splits: new vertices on the primitives where edges or faces are too far from them.
use super::newton::{SETTLED, Targets};
use super::{FaceLabel, SurfaceImprover, Unimproved, VertexLabel, area_normal, sides};
use crate::explicit::{next_in_face, previous_in_face};
use glam::DVec3;

/// Rounds at most: edges get half as long in each, and the error a quarter.
const MOST_ROUNDS: usize = 40;
/// Repairs at most in one go.
pub(super) const MOST_REPAIRS: usize = 3;
/// What a repair leaves is off by this share of what was. Chosen: less would be undone by the splits that follow.
const REPAIRED: f64 = 0.7;
/// And by no more than this many times the aim: beyond, whole parts would go. Chosen.
const MOST_OFF: f64 = 2.0;
/// Sides that are flipped at most for one split.
const MOST_FLIPS: usize = 4;
/// Edges shorter than this share of the aim are not split. Chosen: nothing of the surface that the tolerance
/// asks for is that small.
const SHORTEST: f64 = 0.25;

impl SurfaceImprover<'_> {
    /// Splits edges, then faces, until none is off by more than the aim.
    /// Where there is no room for splits, repairs make some, so often.
    pub(super) fn split_far(&mut self, most_repairs: usize) -> Result<(), Unimproved> {
        let mut n_repairs = 0;
        for _ in 0..MOST_ROUNDS {
            self.next_round()?;
            let mut far = self.far_edges()?;
            if far.is_empty() {
                far = self.edges_of_far_faces()?;
            }
            if far.is_empty() {
                break;
            }
            if self.split_edges(far.clone())? == 0 {
                n_repairs += 1;
                if n_repairs > most_repairs {
                    break;
                }
                self.repair(&far)?;
            }
            self.flip_all()?;
        }
        Ok(())
    }

    /// Where splits would fold the surface its triangles stand on edge: flips and collapses that make it
    /// better, if not good, take them away.
    fn repair(&mut self, far: &[u32]) -> Result<(), Unimproved> {
        let excess = far.iter().fold(1.0, |most, h| {
            let one = self.edge_excess(*h);
            if one > most && one.is_finite() { one } else { most }
        });
        for h in far {
            self.changed.extend([*h / 3, self.surface.twin(*h) / 3]);
        }
        self.flip_all()?;
        self.is_open.fill(false);
        for h in far {
            if !self.surface.has_face(*h / 3) {
                continue;
            }
            for face in [*h / 3, self.surface.twin(*h) / 3] {
                self.open_around(face);
            }
        }
        let limit = REPAIRED * excess;
        self.limit = if limit < MOST_OFF { limit } else { MOST_OFF };
        let done = self.collapse_all();
        self.limit = 1.0;
        self.is_open.fill(true);
        done
    }

    /// Edges that are too far off, worst first. What is near the limit by its estimate is sampled.
    fn far_edges(&mut self) -> Result<Vec<u32>, Unimproved> {
        let close: Vec<u32> = self.edges().filter(|h| self.edge_excess(*h) > 0.5).collect();
        self.sample_middles(&close)?;
        let mut far: Vec<(f64, u32)> =
            close.into_iter().map(|h| (self.edge_excess(h), h)).filter(|(excess, _)| *excess > 1.0).collect();
        far.sort_unstable_by(|(x, h), (y, g)| y.total_cmp(x).then(h.cmp(g)));
        Ok(far.into_iter().map(|(_, h)| h).collect())
    }

    /// The longest edges of faces that are too far off.
    fn edges_of_far_faces(&mut self) -> Result<Vec<u32>, Unimproved> {
        let faces = (0..self.surface.face_slots() as u32).filter(|f| self.surface.has_face(*f));
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

    /// Splits faces that are off at one of the samples inside of them.
    pub(super) fn split_edges_of_refuted(&mut self) -> Result<usize, Unimproved> {
        self.next_round()?;
        let open: Vec<u32> = (0..self.surface.face_slots() as u32)
            .filter(|f| self.surface.has_face(*f) && !self.is_verified[*f as usize])
            .collect();
        let refuted = self.refuted(&open)?;
        let edges = refuted.into_iter().map(|f| self.longest_side(f)).collect();
        self.split_edges(edges)
    }

    /// The crease edge that is most off where one is clearly, else the longest edge.
    pub(super) fn worst_side(&self, face: u32) -> u32 {
        // Below that a crease is not what a proof fails at. Measured.
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

    /// Splits those of a list whose faces do not overlap, and for which there is a place.
    pub(super) fn split_edges(&mut self, list: Vec<u32>) -> Result<usize, Unimproved> {
        let mut targets = Targets::default();
        let mut chosen = Vec::new();
        for h in list {
            let t = self.surface.twin(h);
            let (a, b) = (self.surface.start(h), self.surface.end(h));
            let too_short = (self.at(b) - self.at(a)).length() < SHORTEST * self.aim_of([a, b]);
            if too_short || !self.take(&[h / 3, t / 3]) {
                continue;
            }
            let labels = [self.label_of(h), self.label_of(t)];
            let both = if labels[0] == labels[1] { &labels[..1] } else { &labels[..] };
            targets.push(self.middle_point(a, b), both.iter().copied());
            chosen.push(h);
        }
        targets.project(&mut self.evaluator, self.tol)?;
        let (mut n, mut on_the_way) = (0, Vec::new());
        for (k, h) in chosen.into_iter().enumerate() {
            let (a, b) = (self.surface.start(h), self.surface.end(h));
            let (middle, to) = (self.middle_point(a, b), targets.at[k]);
            // Beyond that it is another part of the surface.
            let reach = 0.7 * (self.at(b) - self.at(a)).length();
            // Where there is no such place a split brings nothing.
            let aim = self.aim_of([a, b]);
            let is_placed = targets.labels_of(k).iter().all(|on| on.distance.abs() <= SETTLED * aim);
            if !is_placed || (to - middle).length() > reach {
                continue;
            }
            let on = targets.labels_of(k);
            if self.may_split(h, to, on) {
                self.split(h, (to, &targets, k));
                n += 1;
            } else if let Some(side) = self.may_split_beyond(h, to, on) {
                self.split(h, (to, &targets, k));
                self.flip_side(side);
                n += 1;
            } else if let Some(h) = self.make_room(h, to, on) {
                self.split(h, (to, &targets, k));
                n += 1;
            } else if let Some(to) = self.on_the_way(h, [middle, to], on) {
                self.split(h, (to, &targets, k));
                on_the_way.push(self.surface.vertex_slots() as u32 - 1);
                n += 1;
            }
        }
        self.measure_vertices(&on_the_way)?;
        self.counts.splits += n;
        Ok(n)
    }

    fn new_faces(&self, h: u32, to: DVec3) -> [([u32; 3], [DVec3; 3]); 4] {
        // The new vertex has the next number.
        let z = self.surface.vertex_slots() as u32;
        let t = self.surface.twin(h);
        let (a, b) = (self.surface.start(h), self.surface.end(h));
        let (c, d) = (self.surface.apex(h), self.surface.apex(t));
        let at = |v: u32| if v == z { to } else { self.at(v) };
        [[a, z, c], [z, b, c], [b, z, d], [z, a, d]].map(|face| (face, face.map(at)))
    }

    /// No fold, no other sheet.
    fn may_split(&mut self, h: u32, to: DVec3, on: &[VertexLabel]) -> bool {
        self.folded(h, to, on).is_none() && self.splits_apart(h, to)
    }

    /// Whether the new faces of a split meet no other sheet.
    fn splits_apart(&mut self, h: u32, to: DVec3) -> bool {
        let new = self.new_faces(h, to);
        !self.crosses(&new, &[h / 3, self.surface.twin(h) / 3])
    }

    /// The side across which a split would fold one of the new faces.
    fn folded(&self, h: u32, to: DVec3, on: &[VertexLabel]) -> Option<u32> {
        let t = self.surface.twin(h);
        let sides = [previous_in_face(h), next_in_face(h), previous_in_face(t), next_in_face(t)];
        let folds = |((_, points), side): &(([u32; 3], [DVec3; 3]), u32)| {
            let (area, old) = (area_normal(*points), area_normal(self.points(side / 3)));
            let label = self.label_of(*side);
            let normal = on.iter().find(|on| on.label == label).map_or(DVec3::ZERO, |on| on.normal);
            // A face that was turned over before may be put right.
            !(area.dot(old) > 0.0 || area.dot(normal) > 0.0)
        };
        self.new_faces(h, to).into_iter().zip(sides).find(folds).map(|(_, side)| side)
    }

    /// How far a new vertex can go where another sheet is in the way, which may have to go the same way: the
    /// rest comes when that has gone.
    fn on_the_way(&mut self, h: u32, [from, to]: [DVec3; 2], on: &[VertexLabel]) -> Option<DVec3> {
        if !self.goes_by_parts {
            return None;
        }
        [0.5, 0.25, 0.0]
            .into_iter()
            .map(|part| from + part * (to - from))
            .find(|at| self.may_split(h, *at, on))
    }

    /// Whether an edge can be split at a place beyond one side of its faces, in the triangle there, if that
    /// side is flipped afterwards: its ends.
    fn may_split_beyond(&mut self, h: u32, to: DVec3, on: &[VertexLabel]) -> Option<[u32; 2]> {
        let side = self.folded(h, to, on)?;
        let across = self.surface.twin(side);
        let (x, y, e) = (self.surface.start(side), self.surface.end(side), self.surface.apex(across));
        if self.is_crease(side) || self.taken[across as usize / 3] == self.round {
            return None;
        }
        let z = self.surface.vertex_slots() as u32;
        let at = |v: u32| if v == z { to } else { self.at(v) };
        let beyond = [[z, x, e], [e, y, z]].map(|face| (face, face.map(at)));
        let folded = self.new_faces(h, to);
        let kept = folded.iter().filter(|(face, _)| !(face.contains(&x) && face.contains(&y)));
        let (mut new, mut stands) = (beyond.to_vec(), true);
        let normal_of = |face: u32| area_normal(self.points(face));
        let t = self.surface.twin(h);
        for one in kept {
            let old = if one.0.contains(&self.surface.apex(h)) { h / 3 } else { t / 3 };
            stands &= area_normal(one.1).dot(normal_of(old)) > 0.0;
            new.push(*one);
        }
        let normal = normal_of(across / 3);
        stands &= beyond.iter().all(|(_, points)| area_normal(*points).dot(normal) > 0.0);
        let is_free = stands
            && new.len() == 5
            && !self.crosses(&new, &[h / 3, t / 3, across / 3])
            && self.take(&[across / 3]);
        is_free.then_some([x, y])
    }

    /// Flips the edge between two vertices, whatever comes of it.
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

    /// Flips the sides beyond which a new vertex is, so that the edge can be split: a crease beside an edge
    /// that runs along it has no room. The edge afterwards, if it now can be.
    fn make_room(&mut self, mut h: u32, to: DVec3, on: &[VertexLabel]) -> Option<u32> {
        let (a, b) = (self.surface.start(h), self.surface.end(h));
        for _ in 0..MOST_FLIPS {
            let Some(side) = self.folded(h, to, on) else { return self.splits_apart(h, to).then_some(h) };
            let beyond = self.surface.twin(side) / 3;
            if self.is_crease(side) || !self.surface.may_flip(side) || !self.take(&[beyond]) {
                return None;
            }
            let faces = self.flipped(side);
            let stands = |points: [DVec3; 3]| {
                let area = area_normal(points);
                area.dot(area_normal(self.points(side / 3))) > 0.0
                    && area.dot(area_normal(self.points(beyond))) > 0.0
            };
            if !faces.iter().all(|(_, points)| stands(*points)) || self.crosses(&faces, &[side / 3, beyond]) {
                return None;
            }
            self.flip_side([self.surface.start(side), self.surface.end(side)]);
            h = self.surface.between(a, b)?;
            let faces = [h / 3, self.surface.twin(h) / 3];
            faces.iter().for_each(|face| self.taken[*face as usize] = self.round);
        }
        None
    }

    fn split(&mut self, h: u32, (to, targets, k): (DVec3, &Targets, usize)) {
        let t = self.surface.twin(h);
        let (f, g) = (h / 3, t / 3);
        self.surface.split(h);
        self.position.push(to);
        let on = targets.labels_of(k);
        self.place.push((self.vertex_label.len() as u32, on.len() as u32));
        self.vertex_label.extend_from_slice(on);
        self.is_open.push(true);
        let aim = self.aim_of([self.surface.start(h), self.surface.start(t)]);
        self.aim_at.push(aim);
        let new = self.label.len() as u32;
        let labels: [FaceLabel; 2] = [self.label[f as usize], self.label[g as usize]];
        self.label.extend(labels);
        self.centre.extend([f64::NAN; 2]);
        self.taken.extend([self.round; 2]);
        self.is_verified.extend([false; 2]);
        // The sides away from the edge stay what they are.
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
    }
}
