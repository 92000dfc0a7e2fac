//! Where another sheet is nearer than the tolerance: there the aim is a share of that distance.
use super::face_tree::Bounds;
use super::{FaceLabel, SurfaceImprover, area_normal};
use crate::implicit::LeafError;

/// The aim as a share of the distance to the other sheet: copies of a surface displaced by as much must not meet.
const OF_WALL: f64 = 0.4;
/// Walls are left alone where the aim would be a smaller share of what it is elsewhere: sheets that touch would be split without end.
const LEAST: f64 = 1.0 / 32.0;
/// The cosine of normals that face away from each other.
const OPPOSITE: f64 = -0.5;

impl SurfaceImprover<'_, '_> {
    /// Lowers the aim at vertices where a sheet that faces the other way is near. Sheets that join in a crease are none: they come as near
    /// as one likes.
    pub(super) fn aim_at_walls(&mut self) -> Result<(), LeafError> {
        let joined = self.joined_labels();
        let reach = self.aim / OF_WALL;
        let (mut of, mut asks) = (Vec::new(), Vec::new());
        let mut labels = Vec::new();
        for v in (0..self.surface.vertex_slots() as u32).filter(|v| self.surface.has_vertex(*v)) {
            labels.clear();
            self.labels_across(v, (reach, &joined), &mut labels);
            for label in &labels {
                of.push(v);
                asks.push((*label, self.at(v)));
            }
        }
        let samples = self.sample(&asks)?;
        for (v, sample) in of.into_iter().zip(samples) {
            let faces_away = self.labels_of(v).iter().any(|on| on.normal.dot(sample.normal) < OPPOSITE);
            let aim = OF_WALL * sample.distance.abs();
            if faces_away && aim > LEAST * self.aim && aim < self.aim_at[v as usize] {
                self.aim_at[v as usize] = aim;
            }
        }
        Ok(())
    }

    /// Pairs of labels that meet in creases, sorted.
    fn joined_labels(&self) -> Vec<[FaceLabel; 2]> {
        let pair = |h: u32| {
            let (a, b) = (self.label_of(h), self.label_of(self.surface.twin(h)));
            if a < b { [a, b] } else { [b, a] }
        };
        let mut pairs: Vec<[FaceLabel; 2]> = self.edges().filter(|h| self.is_crease(*h)).map(pair).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// The primitives of faces within reach of a vertex that face the other way, and do not join its own in creases.
    fn labels_across(&self, v: u32, (reach, joined): (f64, &[[FaceLabel; 2]]), labels: &mut Vec<FaceLabel>) {
        let at = self.at(v);
        let on = self.labels_of(v);
        self.tree.each_near(&Bounds { min: at - reach, max: at + reach }, |face| {
            let label = self.label[face as usize];
            let normal = area_normal(self.points(face));
            let faces_away = on.iter().any(|on| on.normal.dot(normal) < OPPOSITE * normal.length());
            let is_joined = |other: FaceLabel| {
                let pair = if label < other { [label, other] } else { [other, label] };
                label == other || joined.binary_search(&pair).is_ok()
            };
            if faces_away && !labels.contains(&label) && !on.iter().any(|on| is_joined(on.label)) {
                labels.push(label);
            }
        });
    }
}
