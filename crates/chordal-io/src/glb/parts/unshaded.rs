//! Primitives without normals beside others with normals: glTF shades their faces flat, each with its own
//! normal.
use super::{NORMAL, PartDraft, StreamSource};
use chordal::explicit::face_normal;
use std::ops::Range;

impl PartDraft<'_> {
    /// The count of numbers per vertex: its position and all attributes.
    pub(super) fn row_width(&self) -> usize {
        3 + self.plan.streams.iter().map(|planned| planned.width).sum::<usize>()
    }

    /// Whether the part has normals.
    pub(super) fn has_normals(&self) -> bool {
        self.normals().is_some()
    }

    fn normals(&self) -> Option<usize> {
        let is_normal =
            |source: &StreamSource<'_>| matches!(source, StreamSource::Attribute(name) if *name == NORMAL);
        self.plan.streams.iter().position(|planned| is_normal(&planned.source))
    }

    /// Gives the faces in these ranges separate corners with the normal of their face. Their old vertices are
    /// removed, unless other faces use them too.
    pub(super) fn shade_flat(&mut self, unshaded: &[Range<usize>]) {
        let Some(normals) = self.normals() else { return };
        let mut is_flat = vec![false; self.faces.len()];
        unshaded.iter().for_each(|range| is_flat[range.clone()].fill(true));
        let mut stays = vec![true; self.positions.len()];
        let mut mark = |flat: bool| {
            let faces = self.faces.iter().zip(&is_flat).filter(|(_, is_flat)| **is_flat == flat);
            faces.for_each(|(face, _)| face.iter().for_each(|row| stays[*row as usize] = !flat));
        };
        // In this order, so that a vertex of a flat face stays if another face uses it too.
        mark(true);
        mark(false);
        let rows: Vec<u32> = {
            // First the vertices that stay, then three for each flat face.
            let kept = (0..self.positions.len() as u32).filter(|row| stays[*row as usize]);
            let flat = self.faces.iter().zip(&is_flat).filter(|(_, is_flat)| **is_flat);
            kept.chain(flat.flat_map(|(face, _)| *face)).collect()
        };
        let positions = rows.iter().map(|row| self.positions[*row as usize]).collect();
        for (planned, values) in self.plan.streams.iter().zip(&mut self.streams) {
            let width = planned.width;
            let row = |row: &u32| values[*row as usize * width..][..width].iter().copied();
            *values = rows.iter().flat_map(row).collect();
        }
        let mut renumbered = vec![0; self.positions.len()];
        let mut n = 0;
        for (row, stays) in stays.iter().enumerate() {
            renumbered[row] = n;
            n += u32::from(*stays);
        }
        self.positions = positions;
        for (face, is_flat) in self.faces.iter_mut().zip(is_flat) {
            if !is_flat {
                *face = face.map(|row| renumbered[row as usize]);
                continue;
            }
            *face = [n, n + 1, n + 2];
            n += 3;
            // A face without area has no normal, and is not visible.
            let corners = face.map(|row| self.positions[row as usize]);
            let normal = face_normal(corners).unwrap_or([0.0, 0.0, 1.0]);
            face.iter()
                .for_each(|row| self.streams[normals][3 * *row as usize..][..3].copy_from_slice(&normal));
        }
    }
}
