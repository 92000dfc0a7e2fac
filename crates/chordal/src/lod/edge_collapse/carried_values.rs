//! The effect of a collapse on the values that corners carry, and whether these stay within their limits.
use super::super::attribute_guard::WedgesAfter;
use super::super::surface::{HalfEdgeSurface, NONE};
use super::super::wedges::{WedgeChange, WedgeTransfer, Wedges};
use super::{CollapseAnchor, CollapseVertexKind, EdgeCollapse, EdgeCollapser, StopCriterion};
use crate::explicit::{closest_on_triangle, distance_sq_to_triangle, next_in_face};
use crate::math::{difference, dot, lesser};

impl EdgeCollapser {
    /// The effect of a collapse on the values of the corners around its edge.
    pub(super) fn wedge_change(&self, collapse: &EdgeCollapse) -> Option<WedgeChange> {
        let wedges = self.wedges.as_ref()?;
        let (h, across) = (collapse.h, self.surface.twin[collapse.h as usize]);
        // Left and right of the edge, at its start and at its end.
        let mut at_start = [wedges.corner_row[h as usize], NONE];
        let mut at_end = [wedges.corner_row[next_in_face(h) as usize], NONE];
        if across != NONE {
            at_start[1] = wedges.corner_row[next_in_face(across) as usize];
            at_end[1] = wedges.corner_row[across as usize];
        }
        let goes_from_start = collapse.anchor != CollapseAnchor::Start;
        let rows = if collapse.anchor != CollapseAnchor::None {
            Vec::new()
        } else if self.kind[self.surface.start[h as usize] as usize] == CollapseVertexKind::Smooth {
            vec![(at_end[0], blend_nearest(wedges, &self.surface, &self.at, collapse, &self.before))]
        } else {
            let [p, r] = [self.surface.start[h as usize], self.surface.end(h)].map(|v| self.at[v as usize]);
            let along = difference(r, p);
            let t = dot(difference(collapse.to, p), along) / dot(along, along);
            let t = if t > 0.0 { lesser(t, 1.0) } else { 0.0 };
            (0..2)
                .filter(|side| at_end[*side] != NONE)
                .map(|side| (at_end[side], wedges.blend(&[(at_start[side], 1.0 - t), (at_end[side], t)])))
                .collect()
        };
        let [left, right] = if goes_from_start { at_end } else { at_start };
        Some(WedgeChange { rows, transfer: WedgeTransfer { h, at_start: goes_from_start, left, right } })
    }

    /// Whether attributes stay within their limits, as far as the vertices of the original show it.
    pub(super) fn keeps_attributes(&self, collapse: &EdgeCollapse, until: &StopCriterion<'_>) -> bool {
        let (Some(guard), Some(wedges), Some(watch)) = (&self.attribute_guard, &self.wedges, &self.monitor)
        else {
            return true;
        };
        let Some(change) = self.wedge_change(collapse) else { return true };
        let ends = [self.surface.start[collapse.h as usize], self.surface.end(collapse.h)];
        let change = WedgesAfter::new(wedges, &change, &self.surface, &self.is_line);
        let faces: Vec<_> = self.after.iter().map(|after| change.face(*after, ends, &self.surface)).collect();
        guard.allows(&watch.samples, &faces, until.tolerance)
    }
}

/// The values at the point of the faces before the collapse that is closest to the new point.
fn blend_nearest(
    wedges: &Wedges,
    surface: &HalfEdgeSurface,
    at: &[[f64; 3]],
    collapse: &EdgeCollapse,
    before: &[u32],
) -> Vec<f64> {
    let corners = |face: u32| surface.corners(face).map(|v| at[v as usize]);
    let nearest = before.iter().fold((f64::INFINITY, before[0]), |best, &face| {
        let d = distance_sq_to_triangle(collapse.to, corners(face));
        if d < best.0 { (d, face) } else { best }
    });
    let weights = closest_on_triangle(collapse.to, corners(nearest.1));
    let parts: [(u32, f64); 3] =
        std::array::from_fn(|k| (wedges.corner_row[3 * nearest.1 as usize + k], weights[k]));
    wedges.blend(&parts)
}
