//! Where another sheet is nearer than the tolerance: there the aim is a share of that distance.
use super::face_tree::Bounds;
use super::{FaceLabel, SurfaceImprover, VertexLabel, area_normal};
use crate::budget::par_map;
use crate::implicit::LeafError;

/// The aim as a share of the distance to the other sheet: copies of a surface displaced by as much must not meet.
const OF_WALL: f64 = 0.4;
/// Walls are left alone where the aim would be a smaller share of what it is elsewhere: sheets that touch
/// would be split without end.
const LEAST: f64 = 1.0 / 32.0;
/// Vertices in one task.
const CHUNK: usize = 1024;
/// The cosine of normals that face away from each other.
const OPPOSITE: f64 = -0.5;

impl SurfaceImprover<'_> {
    /// Lowers the aim at vertices where a sheet that faces the other way is near. Sheets that join in a
    /// crease are none: they come as near as one likes.
    pub(super) fn aim_at_walls(&mut self) -> Result<(), LeafError> {
        let joined = self.joined_labels();
        let reach = self.aim / OF_WALL;
        let vertices: Vec<u32> =
            (0..self.surface.vertex_slots() as u32).filter(|v| self.surface.has_vertex(*v)).collect();
        let chunks: Vec<&[u32]> = vertices.chunks(CHUNK).collect();
        let across = par_map(self.job, &chunks, |_, part| {
            let of = |v: &u32| {
                let v = *v;
                self.labels_across(v, reach, &joined).into_iter().map(move |label| (v, label))
            };
            part.iter().flat_map(of).collect::<Vec<(u32, FaceLabel)>>()
        })
        .concat();
        let asks: Vec<_> = across.iter().map(|(v, label)| (*label, self.at(*v))).collect();
        let samples = self.sample(&asks)?;
        for ((v, _), sample) in across.into_iter().zip(samples) {
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

    /// The primitives of faces within reach of a vertex that face the other way, and do not join its own in
    /// creases.
    fn labels_across(&self, v: u32, reach: f64, joined: &[[FaceLabel; 2]]) -> Vec<FaceLabel> {
        let mut labels = Vec::new();
        let at = self.at(v);
        let on = self.labels_of(v);
        // Labels that join its own, and need not be looked at again.
        let mut beside: Vec<FaceLabel> = on.iter().map(|on| on.label).collect();
        self.tree.each_near(&Bounds { min: at - reach, max: at + reach }, |face| {
            let label = self.label[face as usize];
            if beside.contains(&label) || labels.contains(&label) {
                return;
            }
            let joins = |on: &VertexLabel| {
                let other = on.label;
                let pair = if label < other { [label, other] } else { [other, label] };
                joined.binary_search(&pair).is_ok()
            };
            if on.iter().any(joins) {
                beside.push(label);
                return;
            }
            let normal = area_normal(self.points(face));
            if on.iter().any(|on| on.normal.dot(normal) < OPPOSITE * normal.length()) {
                labels.push(label);
            }
        });
        labels
    }
}
