//! Rounds of edge flips: for smaller errors, and for better angles if errors are small.
use super::{ImproveError, SurfaceImprover, area_normal, sides};
use crate::explicit::{next_in_face, previous_in_face};
use crate::math::{greater, lesser};
use glam::DVec3;

/// The most rounds. Chosen: each round flips most of the remaining edges.
const MOST_ROUNDS: usize = 6;

/// An edge with the gain of flipping it.
struct FlipEstimate {
    h: u32,
    gain: f64,
    /// Whether the flip replaces a triangle that stands on edge, or gains much: then samples need not
    /// confirm it.
    is_urgent: bool,
}

impl SurfaceImprover<'_> {
    pub(super) fn flip_all(&mut self) -> Result<(), ImproveError> {
        for _ in 0..MOST_ROUNDS {
            if self.job.is_finishing() {
                break;
            }
            let edges = self.changed_edges();
            if edges.is_empty() {
                break;
            }
            self.next_round()?;
            let mut flips: Vec<FlipEstimate> = edges.iter().filter_map(|h| self.estimate_flip(*h)).collect();
            flips.sort_unstable_by(|x, y| y.gain.total_cmp(&x.gain).then(x.h.cmp(&y.h)));
            flips.retain(|flip| {
                let is_claimed = self.claim_faces(&[flip.h / 3, self.surface.twin(flip.h) / 3]);
                if !is_claimed {
                    // Its faces are taken by a better flip: it is tried again in the next round.
                    self.changed.push(flip.h / 3);
                }
                is_claimed
            });
            self.flip_edges(&flips)?;
        }
        Ok(())
    }

    /// The edges of faces that changed since the last call.
    fn changed_edges(&mut self) -> Vec<u32> {
        let mut faces = std::mem::take(&mut self.changed);
        faces.sort_unstable();
        faces.dedup();
        let mut edges = Vec::with_capacity(2 * faces.len());
        for face in faces.into_iter().filter(|f| self.surface.has_face(*f)) {
            edges.extend(sides(3 * face).map(|h| {
                let t = self.surface.twin(h);
                lesser(h, t)
            }));
        }
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The flip of an edge, if estimates show a gain.
    fn estimate_flip(&self, h: u32) -> Option<FlipEstimate> {
        let t = self.surface.twin(h);
        let label = self.label_of(h);
        if label != self.label_of(t) {
            return None;
        }
        let (a, b, c, d) =
            (self.surface.start(h), self.surface.end(h), self.surface.apex(h), self.surface.apex(t));
        let [pa, pb, pc, pd] = [a, b, c, d].map(|v| self.at(v));
        let sampled = self.middle[h as usize];
        let old = if sampled.is_nan() { self.estimate(a, b, label).abs() } else { sampled.abs() };
        let new = self.estimate(c, d, label).abs();
        let before = worse(quality([pa, pb, pc]), quality([pb, pa, pd]));
        let after = worse(quality([pa, pd, pc]), quality([pd, pb, pc]));
        let normal = self.constraint(a, label)?.normal + self.constraint(b, label)?.normal;
        let normal = normal.normalize_or_zero();
        let fits =
            |triangles: [[DVec3; 3]; 2]| triangles.iter().all(|points| self.faces_along(*points, normal));
        let aim = self.aim_of([a, b, c, d]);
        let small = 0.25 * aim; // Below this, angles decide.
        // A triangle that stands on edge is worse than any error.
        let rights_triangle = !fits([[pa, pb, pc], [pb, pa, pd]]);
        let gain = if rights_triangle {
            1.0 + old / aim
        } else if old > small || new > small {
            // Thin triangles are accepted if the error falls clearly.
            if !(new < 0.9 * old && after > 0.0) {
                return None;
            }
            (old - new) / aim
        } else {
            if !(after > 1.05 * before) {
                return None;
            }
            0.1 * (after - before)
        };
        let fits = fits([[pa, pd, pc], [pd, pb, pc]]);
        (fits && self.surface.can_flip(h)).then_some(FlipEstimate {
            h,
            gain,
            is_urgent: rights_triangle || gain > 1.0,
        })
    }

    /// Samples flips, and performs those that are confirmed.
    fn flip_edges(&mut self, flips: &[FlipEstimate]) -> Result<(), ImproveError> {
        let mut queries = Vec::with_capacity(3 * flips.len());
        for FlipEstimate { h, .. } in flips {
            let label = self.label_of(*h);
            let [a, b, c, d] = self.diamond(*h).map(|v| self.at(v));
            queries.extend([(label, 0.5 * (c + d)), (label, (a + d + c) / 3.0), (label, (d + b + c) / 3.0)]);
        }
        let samples = self.sample(&queries)?;
        // Flips of one round have no face in common, so that samples stay valid; but another flip may have
        // made the edge c–d already, which `can_flip` finds.
        for (FlipEstimate { h, is_urgent, .. }, samples) in flips.iter().zip(samples.chunks(3)) {
            let t = self.surface.twin(*h);
            let label = self.label_of(*h);
            let [a, b, c, d] = self.diamond(*h);
            let middles = [next_in_face(*h), previous_in_face(*h), next_in_face(t), previous_in_face(t)]
                .map(|side| self.middle_of(side));
            let [bc, ca, ad, db] = middles;
            let middle = samples[0].distance;
            let new = self.flipped_triangles(*h);
            let faces = new.map(|(face, _)| face);
            let errors = [
                self.distances(faces[0], label, [ad, middle, ca], samples[1].distance).largest(),
                self.distances(faces[1], label, [db, bc, middle], samples[2].distance).largest(),
            ];
            let (before, after) = (
                greater(self.face_distances(*h / 3).largest(), self.face_distances(t / 3).largest()),
                greater(errors[0], errors[1]),
            );
            let improves = *is_urgent || after <= 0.25 * self.aim_of([a, b, c, d]) || after < before;
            let fits = self.faces_along(new[0].1, samples[1].normal)
                && self.faces_along(new[1].1, samples[2].normal);
            if !(improves && fits && self.surface.can_flip(*h)) {
                continue;
            }
            if self.crosses(&new, &[*h / 3, t / 3]) {
                continue;
            }
            // As stored, not as estimated: unsampled middles stay unsampled.
            let kept = [next_in_face(*h), previous_in_face(*h), next_in_face(t), previous_in_face(t)]
                .map(|side| self.middle[side as usize]);
            self.surface.flip(*h);
            // After the flip the half-edge's face is d→c→a, and the twin's c→d→b.
            let slots = [
                (*h, middle),
                (next_in_face(*h), kept[1]),
                (previous_in_face(*h), kept[2]),
                (t, middle),
                (next_in_face(t), kept[3]),
                (previous_in_face(t), kept[0]),
            ];
            slots.into_iter().for_each(|(side, distance)| self.middle[side as usize] = distance);
            self.centre[*h as usize / 3] = samples[1].distance;
            self.centre[t as usize / 3] = samples[2].distance;
            for face in [*h / 3, t / 3] {
                self.grow_tree(face);
                self.open_around(face);
            }
            self.counts.flips += 1;
        }
        Ok(())
    }

    /// The two faces after a flip.
    pub(super) fn flipped_triangles(&self, h: u32) -> [([u32; 3], [DVec3; 3]); 2] {
        let [a, b, c, d] = self.diamond(h);
        [[a, d, c], [d, b, c]].map(|face| (face, face.map(|v| self.at(v))))
    }

    /// The ends of an edge, and the apexes of its two faces.
    fn diamond(&self, h: u32) -> [u32; 4] {
        //      c
        //    /   \
        //   a —h→ b
        //    \   /
        //      d
        let t = self.surface.twin(h);
        [self.surface.start(h), self.surface.end(h), self.surface.apex(h), self.surface.apex(t)]
    }
}

/// `4√3 · area / (sum of the squared edges)`: 1 for three equal edges, 0 for collinear corners.
fn quality(points: [DVec3; 3]) -> f64 {
    let [a, b, c] = points;
    let sum = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
    let size = 2.0 * 3.0_f64.sqrt() * area_normal(points).length();
    if sum > 0.0 { size / sum } else { 0.0 }
}

fn worse(a: f64, b: f64) -> f64 {
    lesser(a, b)
}
