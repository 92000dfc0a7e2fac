//! Whether faces that come would meet others: a tree of boxes that grows with the faces, and exact tests of triangles.
use super::{SurfaceImprover, area_normal};
use crate::check::triangles_meet as meet;
use glam::DVec3;

/// No node, no face.
const NONE: u32 = u32::MAX;
/// Faces in a leaf when a tree is built. Chosen: as many boxes as a node's test costs.
const LEAF: usize = 4;

#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: DVec3,
    max: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    #[inline]
    fn of(points: &[DVec3; 3]) -> Self {
        let [a, b, c] = *points;
        Self { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    #[inline]
    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    #[inline]
    fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    #[inline]
    fn holds(&self, other: &Self) -> bool {
        self.min.cmple(other.min).all() && other.max.cmple(self.max).all()
    }
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    parent: u32,
    /// The first of two children that are beside each other; [`NONE`] for a leaf.
    children: u32,
    /// The first face of a leaf.
    face: u32,
}

/// Boxes around faces, which only grow until the tree is built again.
#[derive(Clone, Debug, Default)]
pub(super) struct FaceTree {
    nodes: Vec<Node>,
    /// By face: its leaf, and the next face in it.
    leaf: Vec<u32>,
    next: Vec<u32>,
    n_built: usize,
}

impl FaceTree {
    fn build(faces: &mut [(u32, Bounds)], n_slots: usize) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            leaf: vec![NONE; n_slots],
            next: vec![NONE; n_slots],
            n_built: n_slots,
        };
        if faces.is_empty() {
            return tree;
        }
        let none = Node { bounds: Bounds::EMPTY, parent: NONE, children: NONE, face: NONE };
        tree.nodes.push(none);
        let mut open = vec![(0_u32, 0_usize, faces.len())];
        while let Some((node, from, to)) = open.pop() {
            let part = &mut faces[from..to];
            let bounds = part.iter().fold(Bounds::EMPTY, |b, (_, f)| b.union(*f));
            tree.nodes[node as usize].bounds = bounds;
            if part.len() <= LEAF {
                for (face, _) in part.iter() {
                    tree.leaf[*face as usize] = node;
                    tree.next[*face as usize] = tree.nodes[node as usize].face;
                    tree.nodes[node as usize].face = *face;
                }
                continue;
            }
            let size = bounds.max - bounds.min;
            let axis = (1..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
            let key = |(face, b): &(u32, Bounds)| (b.min[axis] + b.max[axis], *face);
            let middle = part.len() / 2;
            part.select_nth_unstable_by(middle, |a, b| {
                let ((x, f), (y, g)) = (key(a), key(b));
                x.total_cmp(&y).then(f.cmp(&g))
            });
            let first = tree.nodes.len() as u32;
            tree.nodes[node as usize].children = first;
            tree.nodes.extend([Node { parent: node, ..none }; 2]);
            open.push((first, from, from + middle));
            open.push((first + 1, from + middle, to));
        }
        tree
    }

    /// Makes room for a face where it has become larger.
    fn grow(&mut self, face: u32, bounds: Bounds) {
        let mut node = self.leaf[face as usize];
        while node != NONE {
            let at = &mut self.nodes[node as usize];
            if at.bounds.holds(&bounds) {
                break;
            }
            at.bounds = at.bounds.union(bounds);
            node = at.parent;
        }
    }

    /// Adds the next face beside another.
    fn add(&mut self, face: u32, beside: u32, bounds: Bounds) {
        let leaf = self.leaf[beside as usize];
        self.leaf.push(leaf);
        self.next.push(self.nodes[leaf as usize].face);
        self.nodes[leaf as usize].face = face;
        self.grow(face, bounds);
    }

    #[inline]
    fn each_near(&self, bounds: &Bounds, mut near: impl FnMut(u32)) {
        let mut open = [0_u32; 128];
        let mut n = usize::from(!self.nodes.is_empty());
        while n > 0 {
            n -= 1;
            let node = &self.nodes[open[n] as usize];
            if !node.bounds.meets(bounds) {
                continue;
            }
            if node.children == NONE {
                let mut face = node.face;
                while face != NONE {
                    near(face);
                    face = self.next[face as usize];
                }
            } else {
                // Halves of 2³² faces are fewer than 64 levels, each with one node waiting.
                open[n] = node.children;
                open[n + 1] = node.children + 1;
                n += 2;
            }
        }
    }
}

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

    /// After a face has moved.
    pub(super) fn grow_tree(&mut self, face: u32) {
        let bounds = Bounds::of(&self.points(face));
        self.tree.grow(face, bounds);
    }

    /// After the next face was made.
    pub(super) fn add_to_tree(&mut self, face: u32, beside: u32) {
        let bounds = Bounds::of(&self.points(face));
        self.tree.add(face, beside, bounds);
        if self.tree.leaf.len() > 2 * self.tree.n_built {
            self.rebuild_tree();
        }
    }

    /// Whether a face meets another.
    pub(super) fn face_crosses(&mut self, face: u32) -> bool {
        let new = [(self.surface.corners(face), self.points(face))];
        self.crosses(&new, &[face])
    }

    /// Whether triangles that come would meet faces that stay, or each other. Exact, but for neighbours whose normals are alike.
    pub(super) fn crosses(&mut self, new: &Triangles, gone: &[u32]) -> bool {
        self.counts.sheet_tests += 1;
        let refused = self.meets_any(new, gone);
        self.counts.sheet_refusals += usize::from(refused);
        refused
    }

    fn meets_any(&self, new: &Triangles, gone: &[u32]) -> bool {
        let bounds = |points: &[DVec3; 3]| Bounds::of(points);
        let whole = new.iter().fold(Bounds::EMPTY, |all, (_, points)| all.union(bounds(points)));
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
            let box_of_face = bounds(&points);
            if !box_of_face.meets(&whole) {
                return;
            }
            let mut passes = None;
            for (new_ids, new_points) in new {
                if !bounds(new_points).meets(&box_of_face) {
                    continue;
                }
                let is_beside = ids.iter().any(|v| new_ids.contains(v));
                if is_beside && along && *passes.get_or_insert_with(|| is_along(&points)) {
                    continue;
                }
                found |= triangles_meet([*new_ids, ids], [new_points, &points]);
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
