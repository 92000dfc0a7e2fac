//! `FaceTree`: a bounding volume hierarchy of faces with eight children a node, updated as faces change.
use glam::DVec3;

/// No node, no face.
const NONE: u32 = u32::MAX;
/// The bit that marks a child as a node; otherwise it is a face.
const NODE: u32 = 1 << 31;
/// Children of a node. Chosen: their boxes are compared at once, in SIMD registers.
const WIDE: usize = 8;
/// The size of the stack of a traversal, of which each level needs seven. Chosen: nine levels hold 10⁸ faces.
const STACK: usize = 64;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceBox {
    pub min: DVec3,
    pub max: DVec3,
}

impl FaceBox {
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    #[inline]
    pub fn from_points(points: &[DVec3; 3]) -> Self {
        let [a, b, c] = *points;
        Self { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    #[inline]
    pub fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}

/// A box in the frame of the tree, rounded outward. Its ends are stored as
/// `[min x, min y, min z, −max x, −max y, −max z]`, so that all of them grow downward.
type PackedBox = [f32; 6];

const NOTHING: PackedBox = [f32::INFINITY; 6];

#[derive(Clone, Debug)]
struct FaceTreeNode {
    /// By end, then by child.
    ends: [[f32; WIDE]; 6],
    children: [u32; WIDE],
    /// The node above, and which of its children this is.
    parent: (u32, u32),
}

impl FaceTreeNode {
    fn new(parent: (u32, u32)) -> Self {
        Self { ends: [[f32::INFINITY; WIDE]; 6], children: [NONE; WIDE], parent }
    }

    fn set(&mut self, k: usize, ends: &PackedBox) {
        (0..6).for_each(|e| self.ends[e][k] = ends[e]);
    }

    /// Grows the box of a child; returns whether it has changed.
    fn grow(&mut self, k: usize, ends: &PackedBox) -> bool {
        let mut grew = false;
        for e in 0..6 {
            if ends[e] < self.ends[e][k] {
                self.ends[e][k] = ends[e];
                grew = true;
            }
        }
        grew
    }
}

/// See the [module](self). Boxes of nodes only grow until the tree is rebuilt.
#[derive(Clone, Debug, Default)]
pub(super) struct FaceTree {
    nodes: Vec<FaceTreeNode>,
    /// By face: its node, and its child number there.
    slot_of: Vec<(u32, u32)>,
    origin: DVec3,
    scale: f64,
    n_built: usize,
}

impl FaceTree {
    /// Builds a tree of faces with their boxes; other slots up to `n_slots` are empty.
    pub fn build(faces: &mut [(u32, FaceBox)], n_slots: usize) -> Self {
        let hull = faces.iter().fold(FaceBox::EMPTY, |hull, (_, bounds)| hull.union(*bounds));
        let size = (hull.max - hull.min).max_element();
        let mut tree = Self {
            nodes: Vec::with_capacity(faces.len() / 4 + 1),
            slot_of: vec![(NONE, 0); n_slots],
            origin: if faces.is_empty() { DVec3::ZERO } else { hull.min },
            scale: if size > 0.0 { 1.0 / size } else { 1.0 },
            n_built: faces.len(),
        };
        tree.nodes.push(FaceTreeNode::new((NONE, 0)));
        let mut pending = vec![(0_u32, 0_usize, faces.len())];
        while let Some((node, from, to)) = pending.pop() {
            if to - from <= WIDE {
                for (k, (face, bounds)) in faces[from..to].iter().enumerate() {
                    let ends = tree.ends(bounds);
                    let parent = &mut tree.nodes[node as usize];
                    parent.set(k, &ends);
                    parent.children[k] = *face;
                    tree.slot_of[*face as usize] = (node, k as u32);
                }
                continue;
            }
            // Three levels of halving: cut 4, then 2 and 6, then the odd ones.
            let mut cuts = [from, 0, 0, 0, 0, 0, 0, 0, to];
            for step in [WIDE, WIDE / 2, WIDE / 4] {
                for k in (0..WIDE).step_by(step) {
                    cuts[k + step / 2] = halve(&mut faces[cuts[k]..cuts[k + step]]) + cuts[k];
                }
            }
            for k in 0..WIDE {
                let (from, to) = (cuts[k], cuts[k + 1]);
                let child = tree.nodes.len() as u32;
                tree.nodes.push(FaceTreeNode::new((node, k as u32)));
                let bounds =
                    faces[from..to].iter().fold(FaceBox::EMPTY, |hull, (_, bounds)| hull.union(*bounds));
                let ends = tree.ends(&bounds);
                let parent = &mut tree.nodes[node as usize];
                parent.set(k, &ends);
                parent.children[k] = NODE | child;
                pending.push((child, from, to));
            }
        }
        tree
    }

    /// The number of faces when it was built.
    pub fn n_built(&self) -> usize {
        self.n_built
    }

    #[inline]
    fn ends(&self, bounds: &FaceBox) -> PackedBox {
        // Ends are moved outward by more than their rounding to f32, 2⁻²⁴, and the rounding of the frame, since
        // coordinates in the frame are about 1 or less.
        const OUTWARD: f64 = 1.0 / (1 << 22) as f64;
        let low = (bounds.min - self.origin) * self.scale;
        let high = (bounds.max - self.origin) * self.scale;
        let end = |x: f64| (x - OUTWARD * (1.0 + x.abs())) as f32;
        [end(low.x), end(low.y), end(low.z), end(-high.x), end(-high.y), end(-high.z)]
    }

    /// Updates the box of a changed face.
    pub fn update(&mut self, face: u32, bounds: &FaceBox) {
        let (node, k) = self.slot_of[face as usize];
        let ends = self.ends(bounds);
        let at = &mut self.nodes[node as usize];
        at.set(k as usize, &ends);
        self.grow(at_parent(&self.nodes, node), &ends);
    }

    fn grow(&mut self, mut at: (u32, u32), ends: &PackedBox) {
        while at.0 != NONE && self.nodes[at.0 as usize].grow(at.1 as usize, ends) {
            at = self.nodes[at.0 as usize].parent;
        }
    }

    /// Removes a face.
    pub fn remove(&mut self, face: u32) {
        // The face keeps its slot, whose empty box meets nothing.
        let (node, k) = self.slot_of[face as usize];
        self.nodes[node as usize].set(k as usize, &NOTHING);
    }

    /// Adds the face with the next number beside another face.
    pub fn add(&mut self, beside: u32, bounds: &FaceBox) {
        let face = self.slot_of.len() as u32;
        let (node, k) = self.slot_of[beside as usize];
        let ends = self.ends(bounds);
        let free = self.nodes[node as usize].children.iter().position(|child| *child == NONE);
        let slot_of = if let Some(free) = free {
            (node, free as u32)
        } else {
            // The node is full: both faces go into a new node in place of `beside`.
            let child = self.nodes.len() as u32;
            let mut new = FaceTreeNode::new((node, k));
            let at = &mut self.nodes[node as usize];
            (0..6).for_each(|e| new.ends[e][0] = at.ends[e][k as usize]);
            new.children[0] = beside;
            at.children[k as usize] = NODE | child;
            self.nodes.push(new);
            self.slot_of[beside as usize] = (child, 0);
            (child, 1)
        };
        self.slot_of.push(slot_of);
        let at = &mut self.nodes[slot_of.0 as usize];
        at.children[slot_of.1 as usize] = face;
        at.set(slot_of.1 as usize, &ends);
        self.grow(at_parent(&self.nodes, slot_of.0), &ends);
    }

    /// Visits the faces whose boxes may meet a box.
    #[inline]
    pub fn for_each_near(&self, bounds: &FaceBox, mut near: impl FnMut(u32)) {
        let [a, b, c, d, e, f] = self.ends(bounds);
        // Each low end against the other's high end.
        let against = [-d, -e, -f, -a, -b, -c];
        // Nodes that do not fit on the stack go to the heap; this happens if splits have made the tree deep.
        let (mut stack, mut n_stack, mut overflow) =
            ([0_u32; STACK], usize::from(!self.nodes.is_empty()), Vec::new());
        loop {
            let number = if n_stack > 0 {
                n_stack -= 1;
                stack[n_stack]
            } else if let Some(number) = overflow.pop() {
                number
            } else {
                break;
            };
            let node = &self.nodes[number as usize];
            let mut meets = [true; WIDE];
            for (ends, against) in node.ends.iter().zip(against) {
                for k in 0..WIDE {
                    meets[k] &= ends[k] <= against;
                }
            }
            for k in 0..WIDE {
                if meets[k] {
                    let child = node.children[k];
                    // `NONE` has the bit of a node, too.
                    if child & NODE == 0 {
                        near(child);
                    } else if child != NONE && n_stack < STACK {
                        stack[n_stack] = child & !NODE;
                        n_stack += 1;
                    } else if child != NONE {
                        overflow.push(child & !NODE);
                    }
                }
            }
        }
    }
}

fn at_parent(nodes: &[FaceTreeNode], node: u32) -> (u32, u32) {
    nodes[node as usize].parent
}

/// Partitions boxes at the median of the longest axis; returns its index.
fn halve(faces: &mut [(u32, FaceBox)]) -> usize {
    let middle = faces.len() / 2;
    if faces.len() < 2 {
        return middle;
    }
    let empty = FaceBox::EMPTY;
    let centres = faces.iter().fold(empty, |all, (_, b)| {
        let centre = 0.5 * b.min + 0.5 * b.max;
        all.union(FaceBox { min: centre, max: centre })
    });
    let size = centres.max - centres.min;
    let axis = (1..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    // No two keys are equal, so that the halves do not depend on the selection.
    faces.select_nth_unstable_by(middle, |(f, a), (g, b)| {
        (a.min[axis] + a.max[axis]).total_cmp(&(b.min[axis] + b.max[axis])).then(f.cmp(g))
    });
    middle
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn finds_what_looking_at_all_finds() {
        let mut random = Random::new(9);
        let mut any = |size: f64| {
            let corner = DVec3::from([0; 3].map(|_| random.unit())) * 1e6;
            FaceBox { min: corner, max: corner + size * 1e6 * DVec3::from([0; 3].map(|_| random.unit())) }
        };
        let mut boxes: Vec<Option<FaceBox>> = (0..500).map(|_| Some(any(0.05))).collect();
        let mut faces: Vec<(u32, FaceBox)> = (0..500).map(|f| (f, boxes[f as usize].unwrap())).collect();
        let mut tree = FaceTree::build(&mut faces, 500);
        for step in 0..3000_usize {
            let face = step * 7919 % boxes.len();
            match step % 5 {
                0 => {
                    boxes.push(Some(any(0.1)));
                    let beside = if boxes[face].is_some() { face } else { boxes.len() - 2 };
                    tree.add(beside as u32, &boxes.last().unwrap().unwrap());
                }
                1 if boxes[face].is_some() && step % 3 == 0 => {
                    boxes[face] = None;
                    tree.remove(face as u32);
                }
                2 if boxes[face].is_some() => {
                    boxes[face] = Some(any(0.2));
                    tree.update(face as u32, &boxes[face].unwrap());
                }
                _ => {
                    let query = any(0.3);
                    let mut found = Vec::new();
                    tree.for_each_near(&query, |f| {
                        if boxes[f as usize].is_some_and(|b| b.meets(&query)) {
                            found.push(f as usize);
                        }
                    });
                    found.sort_unstable();
                    let numbered = boxes.iter().enumerate();
                    let expected: Vec<usize> = numbered
                        .filter(|(_, b)| b.is_some_and(|b| b.meets(&query)))
                        .map(|(f, _)| f)
                        .collect();
                    assert_eq!(found, expected);
                }
            }
        }
    }
}
