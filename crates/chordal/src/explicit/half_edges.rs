//! `HalfEdges`: a closed triangle surface with edge split, flip and collapse.
use super::{next_in_face, previous_in_face};

/// Marks a missing half-edge or vertex.
const NONE: u32 = u32::MAX;

/// A closed, oriented 2-manifold of triangles as half-edges, three consecutive ones per face.
///
/// Faces and vertices keep their indices; removed ones leave unused slots. Source: K. Weiler, *Edge-based
/// data structures for solid modeling in curved-surface environments*, 1985; the link condition: T. Dey et
/// al., *Topology preserving edge contraction*, 1999.
#[derive(Clone, Debug)]
pub(crate) struct HalfEdges {
    /// For each half-edge its start vertex; [`NONE`] for the three of a removed face.
    start: Vec<u32>,
    twin: Vec<u32>,
    /// For each vertex a half-edge that starts there; [`NONE`] for a vertex that is removed or has no face.
    out: Vec<u32>,
    n_faces: usize,
}

impl HalfEdges {
    /// `None` if the faces do not form a closed, oriented 2-manifold.
    pub fn from_faces(faces: &[[u32; 3]], n_vertices: usize) -> Option<Self> {
        let start: Vec<u32> = faces.as_flattened().to_vec();
        // Sort half-edges by start vertex into buckets, as in a counting sort.
        let mut first = vec![0_u32; n_vertices + 1];
        for v in &start {
            *first.get_mut(*v as usize + 1)? += 1;
        }
        (0..n_vertices).for_each(|v| first[v + 1] += first[v]);
        let mut free = first.clone();
        let mut leaving = vec![0_u32; start.len()];
        for (h, v) in start.iter().enumerate() {
            leaving[free[*v as usize] as usize] = h as u32;
            free[*v as usize] += 1;
        }
        let end = |h: u32| start[next_in_face(h) as usize];
        let mut twin = vec![NONE; start.len()];
        for h in 0..start.len() as u32 {
            let (a, b) = (start[h as usize], end(h));
            let back = &leaving[first[b as usize] as usize..first[b as usize + 1] as usize];
            let mut matches = back.iter().filter(|t| end(**t) == a);
            match (matches.next(), matches.next()) {
                (Some(t), None) if a != b => twin[h as usize] = *t,
                _ => return None,
            }
        }
        let mut out = vec![NONE; n_vertices];
        // Backwards, so that the first half-edge of each vertex stays.
        (0..start.len()).rev().for_each(|h| out[start[h] as usize] = h as u32);
        let surface = Self { n_faces: faces.len(), start, twin, out };
        // Check that twins are mutual, and that all faces of a vertex form one fan.
        let mutual = (0..surface.twin.len()).all(|h| surface.twin[surface.twin[h] as usize] as usize == h);
        let one_fan = |v: usize| {
            // The walk around a vertex comes back after the faces of one fan; with a second fan it
            // comes back too early.
            let degree = (first[v + 1] - first[v]) as usize;
            degree == 0 || surface.one_ring(v as u32).take(degree + 1).count() == degree
        };
        (mutual && (0..n_vertices).all(one_fan)).then_some(surface)
    }

    /// The number of vertex indices, removed vertices included.
    pub fn vertex_slots(&self) -> usize {
        self.out.len()
    }

    /// The number of face indices, removed faces included.
    pub fn face_slots(&self) -> usize {
        self.start.len() / 3
    }

    /// The number of faces, without removed ones.
    pub fn n_faces(&self) -> usize {
        self.n_faces
    }

    #[inline]
    pub fn has_face(&self, face: u32) -> bool {
        self.start[3 * face as usize] != NONE
    }

    #[inline]
    pub fn has_vertex(&self, v: u32) -> bool {
        self.out[v as usize] != NONE
    }

    #[inline]
    pub fn start(&self, h: u32) -> u32 {
        self.start[h as usize]
    }

    #[inline]
    pub fn end(&self, h: u32) -> u32 {
        self.start[next_in_face(h) as usize]
    }

    /// The vertex of the half-edge's face opposite to it.
    #[inline]
    pub fn apex(&self, h: u32) -> u32 {
        self.start[previous_in_face(h) as usize]
    }

    #[inline]
    pub fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }

    #[inline]
    pub fn corners(&self, face: u32) -> [u32; 3] {
        let at = 3 * face as usize;
        [self.start[at], self.start[at + 1], self.start[at + 2]]
    }

    /// The half-edges that start at a vertex, counter-clockwise, one per face.
    #[inline]
    pub fn one_ring(&self, v: u32) -> OneRingIter<'_> {
        let first = self.out[v as usize];
        OneRingIter { surface: self, first, next: first }
    }

    /// The half-edge from one vertex to another.
    pub fn between(&self, from: u32, to: u32) -> Option<u32> {
        self.one_ring(from).find(|h| self.end(*h) == to)
    }

    /// Splits an edge at a new vertex, where the half-edge and its twin then end. Returns the vertex. The
    /// last two faces are new: first the one cut off the half-edge's face, then the one cut off its twin's.
    pub fn split(&mut self, h: u32) -> u32 {
        let t = self.twin(h);
        let (hn, tn) = (next_in_face(h), next_in_face(t));
        let (a, b, c, d) = (self.start(h), self.start(t), self.apex(h), self.apex(t));
        //         c                   c
        //       ╱   ╲               ╱ │ ╲        h: a → b becomes a → z
        //      a ─ h → b    ⇒      a ─ z ─ b     t: b → a becomes b → z
        //       ╲   ╱               ╲ │ ╱        new: f = z b c, g = z a d
        //         d                   d
        let z = self.out.len() as u32;
        let f = self.start.len() as u32;
        let g = f + 3;
        let (beyond_f, beyond_g) = (self.twin(hn), self.twin(tn));
        self.start.extend([z, b, c, z, a, d]);
        self.twin.extend([t, beyond_f, hn, h, beyond_g, tn]);
        self.join(f + 1, beyond_f);
        self.join(g + 1, beyond_g);
        self.join(f + 2, hn);
        self.join(g + 2, tn);
        self.join(h, g);
        self.join(t, f);
        self.start[hn as usize] = z;
        self.start[tn as usize] = z;
        self.out.push(f);
        // These two now start at z, so their old starts need another half-edge.
        if self.out[a as usize] == tn {
            self.out[a as usize] = g + 1;
        }
        if self.out[b as usize] == hn {
            self.out[b as usize] = f + 1;
        }
        self.n_faces += 2;
        z
    }

    /// Whether an edge can be flipped: no edge joins its apexes yet.
    pub fn can_flip(&self, h: u32) -> bool {
        let (c, d) = (self.apex(h), self.apex(self.twin(h)));
        c != d && self.between(c, d).is_none()
    }

    /// Flips an edge to join the two apexes: the half-edge then runs from the twin's apex to its own.
    pub fn flip(&mut self, h: u32) {
        //       c              c
        //      / \            /|\
        //     / h \          / | \
        //    a-----b   →    a h|t b      h then runs from d to c, t from c to d.
        //     \ t /          \ | /
        //      \ /            \|/
        //       d              d
        let t = self.twin(h);
        let (hn, hp, tn, tp) = (next_in_face(h), previous_in_face(h), next_in_face(t), previous_in_face(t));
        let (a, b, c, d) = (self.start(h), self.start(t), self.start(hp), self.start(tp));
        let beyond = [hn, hp, tn, tp].map(|side| self.twin(side));
        let starts = [(h, d), (hn, c), (hp, a), (t, c), (tn, d), (tp, b)];
        starts.into_iter().for_each(|(side, v)| self.start[side as usize] = v);
        // The sides were b→c, c→a, a→d and d→b.
        self.join(hn, beyond[1]);
        self.join(hp, beyond[2]);
        self.join(tn, beyond[3]);
        self.join(tp, beyond[0]);
        let outs = [(a, hp), (b, tp), (c, hn), (d, tn)];
        outs.into_iter().for_each(|(v, side)| self.out[v as usize] = side);
    }

    /// The link condition: whether collapsing an edge preserves the topology of the surface.
    pub fn can_collapse(&self, h: u32) -> bool {
        let (a, b) = (self.start(h), self.end(h));
        let (mut n_common, mut n_around) = (0, 0);
        // Linear search: one-rings are small, except at the centres of large fans in flat regions.
        for side in self.one_ring(a) {
            let v = self.end(side);
            n_around += 1;
            n_common += usize::from(self.between(b, v).is_some());
        }
        // With a third common neighbour besides the apexes, an edge would get more than two faces.
        // If there are only four vertices, the surface is a tetrahedron, and two faces back to back
        // would remain.
        let n_union = n_around + self.one_ring(b).count() - n_common;
        n_common == 2 && n_union > 4
    }

    /// Collapses an edge to its end vertex. Its start vertex and its two faces are removed.
    pub fn collapse(&mut self, h: u32) {
        let (a, b) = (self.start(h), self.end(h));
        let across = self.twin(h);
        let mut fan = h;
        loop {
            let next = self.twin(previous_in_face(fan));
            self.start[fan as usize] = b;
            fan = next;
            if fan == h {
                break;
            }
        }
        // The other side of the first face survives and starts at the merged vertex; the edge that
        // is stored for `b` may belong to a removed face.
        let keep = self.twin(previous_in_face(h));
        self.drop_face(h);
        self.drop_face(across);
        self.out[a as usize] = NONE;
        self.out[b as usize] = keep;
    }

    /// Removes the face of `side`, whose two ends have become one vertex, and makes the twins of its other
    /// two edges each other's twins.
    fn drop_face(&mut self, side: u32) {
        let (next, previous) = (next_in_face(side), previous_in_face(side));
        let apex = self.start(previous);
        let (x, y) = (self.twin(next), self.twin(previous));
        self.join(x, y);
        // x starts at the apex.
        self.out[apex as usize] = x;
        let first = 3 * (side / 3);
        (first..first + 3).for_each(|h| {
            self.start[h as usize] = NONE;
            self.twin[h as usize] = NONE;
        });
        self.n_faces -= 1;
    }

    #[inline]
    fn join(&mut self, h: u32, t: u32) {
        self.twin[h as usize] = t;
        self.twin[t as usize] = h;
    }
}

/// Iterator of [`HalfEdges::one_ring`].
pub(crate) struct OneRingIter<'a> {
    surface: &'a HalfEdges,
    first: u32,
    next: u32,
}

impl Iterator for OneRingIter<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.next == NONE {
            return None;
        }
        let h = self.next;
        let t = self.surface.twin[previous_in_face(h) as usize];
        self.next = if t == self.first { NONE } else { t };
        Some(h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    const OCTAHEDRON: [[u32; 3]; 8] =
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

    /// Checks all invariants of a closed surface from the faces alone.
    fn check(surface: &HalfEdges) {
        let faces: Vec<[u32; 3]> = (0..surface.face_slots() as u32)
            .filter(|f| surface.has_face(*f))
            .map(|f| surface.corners(f))
            .collect();
        assert_eq!(faces.len(), surface.n_faces());
        let again = HalfEdges::from_faces(&faces, surface.vertex_slots()).expect("a closed manifold");
        let n_vertices = (0..surface.vertex_slots() as u32).filter(|v| surface.has_vertex(*v)).count();
        assert_eq!(n_vertices + faces.len() - 3 * faces.len() / 2, 2, "a sphere");
        for v in 0..surface.vertex_slots() as u32 {
            assert_eq!(surface.has_vertex(v), again.has_vertex(v));
            assert!(surface.one_ring(v).all(|h| surface.start(h) == v));
            assert_eq!(surface.one_ring(v).count(), again.one_ring(v).count());
        }
    }

    #[test]
    fn random_operations_leave_a_sphere() {
        let mut surface = HalfEdges::from_faces(&OCTAHEDRON, 6).unwrap();
        check(&surface);
        let mut random = Random::new(5);
        let mut counts = [0; 3];
        for step in 0..3000 {
            let h = random.below(3 * surface.face_slots()) as u32;
            if !surface.has_face(h / 3) {
                continue;
            }
            match random.below(3) {
                0 if surface.n_faces() < 200 => {
                    let (a, b, z) = (surface.start(h), surface.end(h), surface.split(h));
                    assert_eq!([surface.start(h), surface.end(h)], [a, z]);
                    assert!(surface.between(z, b).is_some());
                    counts[0] += 1;
                }
                1 if surface.can_flip(h) => {
                    let ends = [surface.apex(surface.twin(h)), surface.apex(h)];
                    surface.flip(h);
                    assert_eq!([surface.start(h), surface.end(h)], ends);
                    counts[1] += 1;
                }
                2 if surface.can_collapse(h) => {
                    surface.collapse(h);
                    counts[2] += 1;
                }
                _ => {}
            }
            if step % 7 == 0 {
                check(&surface);
            }
        }
        assert!(counts.iter().all(|n| *n > 200), "{counts:?}");
    }

    #[test]
    fn a_surface_that_is_no_closed_manifold_is_refused() {
        assert!(HalfEdges::from_faces(&OCTAHEDRON[1..], 6).is_none(), "open");
        let mut turned = OCTAHEDRON;
        turned[0] = [0, 4, 2];
        assert!(HalfEdges::from_faces(&turned, 6).is_none(), "a face turned over");
        let two: Vec<[u32; 3]> = OCTAHEDRON
            .into_iter()
            .chain(OCTAHEDRON.map(|f| f.map(|v| if v == 0 { 0 } else { v + 5 })))
            .collect();
        assert!(HalfEdges::from_faces(&two, 11).is_none(), "two fans about one vertex");
        assert!(HalfEdges::from_faces(&[[0, 1, 9]], 3).is_none(), "an index beyond the vertices");
    }
}
