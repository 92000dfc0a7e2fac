//! Whether faces that come would meet others: exact tests of triangles whose boxes meet.
use super::face_tree::{Bounds, FaceTree};
use super::{SurfaceImprover, area_normal};
use crate::check::triangles_meet as meet;
use glam::DVec3;

/// Triangles with the vertices of their corners.
pub(super) type Triangles = [([u32; 3], [DVec3; 3])];

/// Normals within this cosine of a common direction let neighbours pass: their shadows along it lie beside each other.
const ALONG: f64 = 0.3;

impl SurfaceImprover<'_, '_> {
    pub(super) fn rebuild_tree(&mut self) {
        let mut faces: Vec<(u32, Bounds)> = (0..self.surface.face_slots() as u32)
            .filter(|f| self.surface.has_face(*f))
            .map(|f| (f, Bounds::of(&self.points(f))))
            .collect();
        self.tree = FaceTree::build(&mut faces, self.surface.face_slots());
    }

    /// Builds the tree again where many of its faces are gone or new: its boxes say little then.
    pub(super) fn refresh_tree(&mut self) {
        let (now, then) = (self.surface.n_faces(), self.tree.n_built());
        if 4 * now < 3 * then || now > 2 * then {
            self.rebuild_tree();
        }
    }

    /// After a face has moved.
    pub(super) fn grow_tree(&mut self, face: u32) {
        let bounds = Bounds::of(&self.points(face));
        self.tree.update(face, &bounds);
    }

    /// After the next face was made.
    pub(super) fn add_to_tree(&mut self, face: u32, beside: u32) {
        let bounds = Bounds::of(&self.points(face));
        self.tree.add(beside, &bounds);
    }

    /// Whether a face meets another.
    pub(super) fn face_crosses(&mut self, face: u32) -> bool {
        let new = [(self.surface.corners(face), self.points(face))];
        self.crosses(&new, &[face])
    }

    /// Whether triangles that come would meet faces that stay, or each other. Exact, but for neighbours whose normals are alike.
    pub(super) fn crosses(&mut self, new: &Triangles, gone: &[u32]) -> bool {
        self.counts.sheet_tests += 1;
        self.stamp += 1;
        for v in new.iter().flat_map(|(ids, _)| ids) {
            // The vertex of a split has no number yet, and nothing else ends there.
            if let Some(mark) = self.mark.get_mut(*v as usize) {
                *mark = self.stamp;
            }
        }
        let refused = self.meets_any(new, gone);
        self.counts.sheet_refusals += usize::from(refused);
        refused
    }

    fn meets_any(&self, new: &Triangles, gone: &[u32]) -> bool {
        let boxes: Vec<Bounds> = new.iter().map(|(_, points)| Bounds::of(points)).collect();
        let whole = boxes.iter().fold(Bounds::EMPTY, |all, one| all.union(*one));
        let direction = new.iter().fold(DVec3::ZERO, |sum, (_, points)| sum + area_normal(*points));
        let direction = direction.normalize_or_zero();
        let is_along = |points: &[DVec3; 3]| {
            let normal = area_normal(*points);
            normal.dot(direction) > ALONG * normal.length()
        };
        let along = new.iter().all(|(_, points)| is_along(points));
        let mut found = false;
        self.tree.each_near(&whole, |face| {
            if found || !self.surface.has_face(face) || gone.contains(&face) {
                return;
            }
            let (ids, points) = (self.surface.corners(face), self.points(face));
            let is_beside = ids.iter().any(|v| self.mark[*v as usize] == self.stamp);
            if is_beside && along && is_along(&points) {
                return;
            }
            let bounds = Bounds::of(&points);
            for ((new_ids, new_points), new_bounds) in new.iter().zip(&boxes) {
                found |= new_bounds.meets(&bounds) && triangles_meet([*new_ids, ids], [new_points, &points]);
            }
        });
        if found || along {
            return found;
        }
        new.iter().enumerate().any(|(k, (ids, points))| {
            new[..k].iter().any(|(other_ids, other)| triangles_meet([*ids, *other_ids], [points, other]))
        })
    }
}

fn triangles_meet(ids: [[u32; 3]; 2], [a, b]: [&[DVec3; 3]; 2]) -> bool {
    meet(ids, [a.map(|p| p.to_array()), b.map(|p| p.to_array())])
}
