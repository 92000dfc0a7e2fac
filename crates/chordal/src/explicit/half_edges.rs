//! `HalfEdges`: a closed surface of triangles whose edges can be split, flipped and collapsed.
use super::{next_in_face, previous_in_face};

/// No half-edge, no vertex.
const NONE: u32 = u32::MAX;

/// A closed, oriented 2-manifold of triangles as half-edges, three for each face in a row.
///
/// Faces and vertices keep their numbers; those that are gone leave holes. Source: K. Weiler, *Edge-based data structures for solid
/// modeling in curved-surface environments*, 1985; the link condition: T. Dey et al., *Topology preserving edge contraction*, 1999.
#[derive(Clone, Debug)]
pub(crate) struct HalfEdges {
    /// By half-edge: the vertex that it starts from; [`NONE`] for the three of a face that is gone.
    start: Vec<u32>,
    twin: Vec<u32>,
    /// By vertex: a half-edge that starts there; [`NONE`] for a vertex that is gone or has no face.
    out: Vec<u32>,
    n_faces: usize,
}

impl HalfEdges {
    /// `None` where the faces are no closed, oriented 2-manifold.
    pub fn of(faces: &[[u32; 3]], n_vertices: usize) -> Option<Self> {
        let start: Vec<u32> = faces.as_flattened().to_vec();
        // Half-edges by their start: buckets as in a counting sort.
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
            let mut found = back.iter().filter(|t| end(**t) == a);
            match (found.next(), found.next()) {
                (Some(t), None) if a != b => twin[h as usize] = *t,
                _ => return None,
            }
        }
        let mut out = vec![NONE; n_vertices];
        (0..start.len()).rev().for_each(|h| out[start[h] as usize] = h as u32);
        let surface = Self { n_faces: faces.len(), start, twin, out };
        // Twins are mutual; and all faces of a vertex are one fan.
        let mutual = (0..surface.twin.len()).all(|h| surface.twin[surface.twin[h] as usize] as usize == h);
        let one_fan = |v: usize| {
            let degree = (first[v + 1] - first[v]) as usize;
            degree == 0 || surface.around(v as u32).take(degree + 1).count() == degree
        };
        (mutual && (0..n_vertices).all(one_fan)).then_some(surface)
    }

    /// Numbers of vertices, gone ones included.
    pub fn vertex_slots(&self) -> usize {
        self.out.len()
    }

    /// Numbers of faces, gone ones included.
    pub fn face_slots(&self) -> usize {
        self.start.len() / 3
    }

    /// Faces that are there.
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

    /// The vertex of the half-edge's face across from it.
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

    /// The half-edges that start at a vertex, counter-clockwise, one for each of its faces.
    #[inline]
    pub fn around(&self, v: u32) -> Around<'_> {
        let first = self.out[v as usize];
        Around { surface: self, first, next: first }
    }

    /// The half-edge from one vertex to another.
    pub fn between(&self, from: u32, to: u32) -> Option<u32> {
        self.around(from).find(|h| self.end(*h) == to)
    }

    /// Puts a new vertex on an edge; the half-edge and its twin then end there. Gives the vertex; two faces are new, the last two: the one
    /// that was cut off the half-edge's face, then that of the twin's.
    pub fn split(&mut self, h: u32) -> u32 {
        let t = self.twin(h);
        let (hn, tn) = (next_in_face(h), next_in_face(t));
        let (a, b, c, d) = (self.start(h), self.start(t), self.apex(h), self.apex(t));
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
        if self.out[a as usize] == tn {
            self.out[a as usize] = g + 1;
        }
        if self.out[b as usize] == hn {
            self.out[b as usize] = f + 1;
        }
        self.n_faces += 2;
        z
    }

    /// Whether an edge can be flipped: its apexes are not joined by an edge yet.
    pub fn may_flip(&self, h: u32) -> bool {
        let (c, d) = (self.apex(h), self.apex(self.twin(h)));
        c != d && self.between(c, d).is_none()
    }

    /// Turns an edge to join the two apexes: the half-edge then runs from the twin's apex to its own.
    pub fn flip(&mut self, h: u32) {
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

    /// The link condition: whether shrinking an edge to a point leaves the surface what it is.
    pub fn may_collapse(&self, h: u32) -> bool {
        let (a, b) = (self.start(h), self.end(h));
        let (mut n_common, mut n_around) = (0, 0);
        // The rings are small but for the ends of fans in flat places.
        for side in self.around(a) {
            let v = self.end(side);
            n_around += 1;
            n_common += usize::from(self.between(b, v).is_some());
        }
        let n_union = n_around + self.around(b).count() - n_common;
        n_common == 2 && n_union > 4
    }

    /// Shrinks an edge to its end: its start and its two faces are gone.
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
        let keep = self.twin(previous_in_face(h));
        self.drop_face(h);
        self.drop_face(across);
        self.out[a as usize] = NONE;
        self.out[b as usize] = keep;
    }

    /// Takes away the face of `side`, whose ends are one vertex now, and joins what was on its other two edges.
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

/// See [`HalfEdges::around`].
pub(crate) struct Around<'a> {
    surface: &'a HalfEdges,
    first: u32,
    next: u32,
}

impl Iterator for Around<'_> {
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

    const OCTAHEDRON: [[u32; 3]; 8] =
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

    fn random(state: &mut u64) -> u64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *state >> 33
    }

    /// Everything that holds for a closed surface, from the faces alone.
    fn check(surface: &HalfEdges) {
        let faces: Vec<[u32; 3]> = (0..surface.face_slots() as u32)
            .filter(|f| surface.has_face(*f))
            .map(|f| surface.corners(f))
            .collect();
        assert_eq!(faces.len(), surface.n_faces());
        let again = HalfEdges::of(&faces, surface.vertex_slots()).expect("a closed manifold");
        let n_vertices = (0..surface.vertex_slots() as u32).filter(|v| surface.has_vertex(*v)).count();
        assert_eq!(n_vertices + faces.len() - 3 * faces.len() / 2, 2, "a sphere");
        for v in 0..surface.vertex_slots() as u32 {
            assert_eq!(surface.has_vertex(v), again.has_vertex(v));
            assert!(surface.around(v).all(|h| surface.start(h) == v));
            assert_eq!(surface.around(v).count(), again.around(v).count());
        }
    }

    #[test]
    fn random_operations_leave_a_sphere() {
        let mut surface = HalfEdges::of(&OCTAHEDRON, 6).unwrap();
        check(&surface);
        let mut state = 5;
        let mut done = [0; 3];
        for step in 0..3000 {
            let h = random(&mut state) as u32 % (3 * surface.face_slots() as u32);
            if !surface.has_face(h / 3) {
                continue;
            }
            match random(&mut state) % 3 {
                0 if surface.n_faces() < 200 => {
                    let (a, b, z) = (surface.start(h), surface.end(h), surface.split(h));
                    assert_eq!([surface.start(h), surface.end(h)], [a, z]);
                    assert!(surface.between(z, b).is_some());
                    done[0] += 1;
                }
                1 if surface.may_flip(h) => {
                    let ends = [surface.apex(surface.twin(h)), surface.apex(h)];
                    surface.flip(h);
                    assert_eq!([surface.start(h), surface.end(h)], ends);
                    done[1] += 1;
                }
                2 if surface.may_collapse(h) => {
                    surface.collapse(h);
                    done[2] += 1;
                }
                _ => {}
            }
            if step % 7 == 0 {
                check(&surface);
            }
        }
        assert!(done.iter().all(|n| *n > 200), "{done:?}");
    }

    #[test]
    fn what_is_no_closed_manifold_is_refused() {
        assert!(HalfEdges::of(&OCTAHEDRON[1..], 6).is_none(), "open");
        let mut turned = OCTAHEDRON;
        turned[0] = [0, 4, 2];
        assert!(HalfEdges::of(&turned, 6).is_none(), "a face turned over");
        let two: Vec<[u32; 3]> = OCTAHEDRON
            .into_iter()
            .chain(OCTAHEDRON.map(|f| f.map(|v| if v == 0 { 0 } else { v + 5 })))
            .collect();
        assert!(HalfEdges::of(&two, 11).is_none(), "two fans about one vertex");
        assert!(HalfEdges::of(&[[0, 1, 9]], 3).is_none(), "an index beyond the vertices");
    }
}
