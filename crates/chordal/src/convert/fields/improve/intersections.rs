//! Whether new faces would intersect others: exact triangle tests where boxes meet.
use super::SurfaceImprover;
use super::face_tree::{FaceBox, FaceTree};
use crate::budget::par_map;
use crate::check::triangles_intersect;
use crate::explicit::{Mesh, PackedBoxes};
use glam::DVec3;

/// Faces in one task.
const CHUNK: usize = 1024;

/// Triangles with the vertices of their corners.
pub(super) type IndexedTriangles = [([u32; 3], [DVec3; 3])];

impl SurfaceImprover<'_> {
    pub(super) fn rebuild_tree(&mut self) {
        let mut faces: Vec<(u32, FaceBox)> = (0..self.surface.face_slots() as u32)
            .filter(|f| self.surface.has_face(*f))
            .map(|f| (f, FaceBox::from_points(&self.points(f))))
            .collect();
        self.tree = FaceTree::build(&mut faces, self.surface.face_slots());
    }

    /// Rebuilds the tree where many of its faces are gone or new, since its boxes are loose then.
    pub(super) fn refresh_tree(&mut self) {
        let (now, then) = (self.surface.n_faces(), self.tree.n_built());
        if 4 * now < 3 * then || now > 2 * then {
            self.rebuild_tree();
        }
    }

    /// Updates the tree after a face has moved.
    pub(super) fn grow_tree(&mut self, face: u32) {
        let bounds = FaceBox::from_points(&self.points(face));
        self.tree.update(face, &bounds);
    }

    /// Updates the tree after the next face was made.
    pub(super) fn add_to_tree(&mut self, face: u32, beside: u32) {
        let bounds = FaceBox::from_points(&self.points(face));
        self.tree.add(beside, &bounds);
    }

    /// The faces of a list that intersect others.
    pub(super) fn find_crossing(&self, faces: &[u32]) -> Vec<u32> {
        if faces.len() > self.surface.n_faces() / 2
            && let Some(crossing) = self.all_crossing()
        {
            return crossing;
        }
        let chunks: Vec<&[u32]> = faces.chunks(CHUNK).collect();
        let crosses = |face: &u32| {
            let own = [(self.surface.corners(*face), self.points(*face))];
            self.meets_any(&own, &[*face])
        };
        let of_chunk = |_, part: &&[u32]| part.iter().copied().filter(crosses).collect::<Vec<u32>>();
        par_map(self.job, &chunks, of_chunk).concat()
    }

    /// All faces that intersect others; `None` where their boxes take more memory than there is.
    fn all_crossing(&self) -> Option<Vec<u32>> {
        let (surface, numbers) = self.mesh();
        let mesh = Mesh::by_construction(surface.positions, surface.faces);
        let boxes = PackedBoxes::new(&mesh, self.job).ok()?;
        let triangle = |slot: u32| {
            let face = boxes.faces()[slot as usize];
            (mesh.faces()[face as usize], mesh.corners(face as usize))
        };
        let found = boxes.pairs(self.job, |found: &mut Vec<u32>, slots| {
            let [(a, p), (b, q)] = slots.map(triangle);
            if triangles_intersect([a, b], [p, q]) {
                found.extend(slots.map(|slot| numbers[boxes.faces()[slot as usize] as usize]));
            }
        });
        let mut crossing = found?.concat();
        crossing.sort_unstable();
        crossing.dedup();
        Some(crossing)
    }

    /// Whether new triangles would intersect remaining faces, or each other. Exact.
    pub(super) fn crosses(&mut self, new: &IndexedTriangles, gone: &[u32]) -> bool {
        self.counts.sheet_tests += 1;
        let refused = self.meets_any(new, gone);
        self.counts.sheet_refusals += usize::from(refused);
        refused
    }

    fn meets_any(&self, new: &IndexedTriangles, gone: &[u32]) -> bool {
        let whole =
            new.iter().fold(FaceBox::EMPTY, |all, (_, points)| all.union(FaceBox::from_points(points)));
        let mut found = false;
        self.tree.for_each_near(&whole, |face| {
            if found || !self.surface.has_face(face) || gone.contains(&face) {
                return;
            }
            let (ids, points) = (self.surface.corners(face), self.points(face));
            let bounds = FaceBox::from_points(&points);
            for (new_ids, new_points) in new {
                found |= FaceBox::from_points(new_points).meets(&bounds)
                    && faces_intersect([*new_ids, ids], [new_points, &points]);
            }
        });
        found
            || new.iter().enumerate().any(|(k, (ids, points))| {
                new[..k].iter().any(|(other_ids, other)| faces_intersect([*ids, *other_ids], [points, other]))
            })
    }
}

fn faces_intersect(ids: [[u32; 3]; 2], [a, b]: [&[DVec3; 3]; 2]) -> bool {
    triangles_intersect(ids, [a.map(|p| p.to_array()), b.map(|p| p.to_array())])
}
