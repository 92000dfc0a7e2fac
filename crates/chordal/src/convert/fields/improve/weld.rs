//! Merges vertices. If primitives abut or touch, cells have ledges between them, which Newton steps turn into faces
//! without width: the ends of their short edges are merged. Vertices that cannot reach their targets are merged into
//! neighbours.
use super::collapse::VertexStar;
use super::newton::SETTLED;
use super::{FaceLabel, ImproveError, SurfaceImprover, area_normal};
use crate::implicit::LeafError;
use crate::math::greater;
use glam::DVec3;

/// Edges below this fraction of the tolerance count as having no length. Chosen: far above the errors of Newton steps, and
/// too small to affect a proof.
const NO_LENGTH: f64 = 1e-6;
/// If more vertices than this are unsettled, none is merged. Chosen: then the function has poles or is noise, and merging
/// gains nothing; there are at most 178 on a gyroid in a cube.
const MOST_UNSETTLED: usize = 1024;
/// The most rounds. Chosen: each handles the edges that the last one exposed.
const MOST_ROUNDS: usize = 8;

impl SurfaceImprover<'_> {
    /// Collapses edges without length, whatever the primitives of their ends, unless a face would turn or
    /// cross another.
    pub(super) fn weld(&mut self) -> Result<(), ImproveError> {
        let mut star = VertexStar::default();
        for _ in 0..MOST_ROUNDS {
            self.next_round()?;
            let short: Vec<u32> = self.edges().filter(|h| self.has_no_length(*h)).collect();
            let mut welded = Vec::new();
            for h in short {
                if !self.surface.has_face(h / 3) {
                    continue;
                }
                // The removed vertex should be on fewer primitives.
                let both = [h, self.surface.twin(h)];
                let n_labels = both.map(|h| self.constraints_of(self.surface.start(h)).len());
                let order = if n_labels[0] > n_labels[1] { [1, 0] } else { [0, 1] };
                welded.extend(order.into_iter().find_map(|k| self.weld_edge(both[k], &mut star)));
            }
            if welded.is_empty() {
                break;
            }
            self.measure_merged(welded)?;
        }
        Ok(())
    }

    /// Samples the vertices of a list that still exist.
    fn measure_merged(&mut self, mut merged: Vec<u32>) -> Result<(), LeafError> {
        merged.retain(|v| self.surface.has_vertex(*v));
        merged.sort_unstable();
        merged.dedup();
        self.measure_vertices(&merged)
    }

    fn has_no_length(&self, h: u32) -> bool {
        let length = (self.at(self.surface.end(h)) - self.at(self.surface.start(h))).length();
        length <= NO_LENGTH * self.tol
    }

    /// Collapses a half-edge's start into its end, if allowed, and returns the end. The end then has the primitives of all
    /// faces around it as constraints, and has to be measured.
    fn weld_edge(&mut self, h: u32, star: &mut VertexStar) -> Option<u32> {
        if !self.has_no_length(h) || !self.surface.can_collapse(h) {
            return None;
        }
        self.gather_star(h, star);
        if !self.keeps_directions(star) || self.would_intersect(star) {
            return None;
        }
        Some(self.merge(h))
    }

    /// Collapses a half-edge's start into its end, and returns the end, which has to be measured.
    fn merge(&mut self, h: u32) -> u32 {
        let [v, t] = [self.surface.end(h), self.surface.twin(h)];
        [h, t].iter().for_each(|h| self.tree.remove(*h / 3));
        self.surface.collapse(h);
        let mut labels = Vec::new();
        let faces: Vec<u32> = self.surface.one_ring(v).map(|h| h / 3).collect();
        for face in faces {
            labels.push(self.label[face as usize]);
            self.forget(face);
            self.grow_tree(face);
            self.open_around(face);
        }
        self.run[v as usize] = self.new_run(&mut labels);
        self.counts.collapses += 1;
        v
    }

    /// Merges vertices that cannot reach their targets into a neighbour that is on the primitives of all faces that it would
    /// get, as where primitives coincide. Then the other vertices may be able to move.
    pub(super) fn remove_unsettled(&mut self) -> Result<(), ImproveError> {
        let mut star = VertexStar::default();
        for _ in 0..MOST_ROUNDS {
            let unsettled = self.unsettled();
            if unsettled.len() > MOST_UNSETTLED {
                break;
            }
            self.next_round()?;
            let mut merged = Vec::new();
            for v in unsettled {
                if !self.surface.has_vertex(v) {
                    continue;
                }
                let mut candidates: Vec<u32> = self.surface.one_ring(v).collect();
                let length = |h: &u32| (self.at(self.surface.end(*h)) - self.at(v)).length_squared();
                // A stable sort: equally long edges stay in the order of the ring.
                candidates.sort_by(|a, b| length(a).total_cmp(&length(b)));
                for h in candidates {
                    if self.surface.can_collapse(h) {
                        self.gather_star(h, &mut star);
                        if self.is_on_all(&star)? && !self.would_intersect(&star) {
                            merged.push(self.merge(h));
                            break;
                        }
                    }
                }
            }
            if merged.is_empty() {
                break;
            }
            self.measure_merged(merged)?;
            let unsettled_now = self.unsettled();
            self.settle(&unsettled_now)?;
        }
        Ok(())
    }

    /// Whether the vertex into which a star collapses is on the primitives of all faces that remain, and none of
    /// these would turn away from its primitive.
    fn is_on_all(&mut self, star: &VertexStar) -> Result<bool, ImproveError> {
        let n = star.ring.len();
        let to = self.at(star.ring[0]);
        let labels: Vec<FaceLabel> = star.sides[1..n - 1].iter().map(|h| self.label_of(*h)).collect();
        let queries: Vec<_> = labels.into_iter().map(|label| (label, to)).collect();
        let samples = self.sample(&queries)?;
        Ok((1..n - 1).zip(samples).all(|(i, sample)| {
            let points = [star.ring[0], star.ring[i], star.ring[i + 1]].map(|v| self.at(v));
            sample.distance.abs() <= SETTLED * self.aim && self.faces_along(points, sample.normal)
        }))
    }

    /// Whether no face that has a width turns by more than 60°, and no other face gets a width.
    fn keeps_directions(&self, star: &VertexStar) -> bool {
        (1..star.ring.len() - 1).all(|i| {
            let before = self.points(star.sides[i] / 3);
            let after = [star.ring[0], star.ring[i], star.ring[i + 1]].map(|v| self.at(v));
            let (old, new) = (area_normal(before), area_normal(after));
            let longest = [0, 1, 2].map(|k| (before[(k + 1) % 3] - before[k]).length());
            let longest = longest.into_iter().fold(0.0, |m, x| greater(x, m));
            // The vector area has twice the length of the area: the longest side times the height above it.
            let has_width = |area: DVec3| area.length() > 4.0 * NO_LENGTH * self.tol * longest;
            if has_width(old) { old.dot(new) > 0.5 * old.length() * new.length() } else { !has_width(new) }
        })
    }
}
