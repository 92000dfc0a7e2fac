//! Whether new faces would intersect others: exact tests of the triangles whose boxes meet.
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

    /// Rebuilds the tree if many of its faces are removed or new, since its boxes are loose then.
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

    /// Adds the newest face to the tree, beside another face.
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
            let triangle = [(self.surface.corners(*face), self.points(*face))];
            self.meets_any(&triangle, &[*face])
        };
        let of_chunk = |_, part: &&[u32]| part.iter().copied().filter(crosses).collect::<Vec<u32>>();
        par_map(self.job, &chunks, of_chunk).concat()
    }

    /// All faces that intersect others; `None` if their boxes would take too much memory.
    fn all_crossing(&self) -> Option<Vec<u32>> {
        let (surface, numbers) = self.mesh();
        let mesh = Mesh::by_construction(surface.positions, surface.faces);
        let boxes = PackedBoxes::new(&mesh, self.job).ok()?;
        let triangle = |slot: u32| {
            let face = boxes.faces()[slot as usize];
            (mesh.faces()[face as usize], mesh.corners(face as usize))
        };
        let parts = boxes.pairs(self.job, |crossing: &mut Vec<u32>, slots| {
            let [(a, p), (b, q)] = slots.map(triangle);
            if triangles_intersect([a, b], [p, q]) {
                crossing.extend(slots.map(|slot| numbers[boxes.faces()[slot as usize] as usize]));
            }
        });
        let mut crossing = parts?.concat();
        crossing.sort_unstable();
        crossing.dedup();
        Some(crossing)
    }

    /// Whether new triangles would intersect faces other than the removed ones, or each other. Exact.
    pub(super) fn crosses(&mut self, new: &IndexedTriangles, removed: &[u32]) -> bool {
        self.counts.sheet_tests += 1;
        let refused = self.meets_any(new, removed);
        self.counts.sheet_refusals += usize::from(refused);
        refused
    }

    fn meets_any(&self, new: &IndexedTriangles, removed: &[u32]) -> bool {
        let hull =
            new.iter().fold(FaceBox::EMPTY, |hull, (_, points)| hull.union(FaceBox::from_points(points)));
        let mut intersects = false;
        self.tree.for_each_near(&hull, |face| {
            if intersects || !self.surface.has_face(face) || removed.contains(&face) {
                return;
            }
            let (ids, points) = (self.surface.corners(face), self.points(face));
            let bounds = FaceBox::from_points(&points);
            for (new_ids, new_points) in new {
                intersects |= FaceBox::from_points(new_points).meets(&bounds)
                    && faces_intersect([*new_ids, ids], [new_points, &points]);
            }
        });
        intersects
            || new.iter().enumerate().any(|(k, (ids, points))| {
                new[..k].iter().any(|(other_ids, other)| faces_intersect([*ids, *other_ids], [points, other]))
            })
    }
}

fn faces_intersect(ids: [[u32; 3]; 2], [a, b]: [&[DVec3; 3]; 2]) -> bool {
    triangles_intersect(ids, [a.map(|p| p.to_array()), b.map(|p| p.to_array())])
}
