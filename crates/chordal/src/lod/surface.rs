//! `HalfEdgeSurface`: a half-edge mesh for edge collapses, with one triangle fan per vertex.
use crate::explicit::{
    DisjointSets, Mesh, Twin, Twins, distance_sq_to_triangle, next_in_face, previous_in_face,
};
use std::sync::{Mutex, PoisonError};

/// No half-edge, no vertex.
pub(super) const NONE: u32 = u32::MAX;
/// The most steps of a descent. Chosen: usually it takes fewer than three.
const MOST_STEPS: u32 = 64;

/// A surface in which the faces around every vertex are one fan, open or closed.
///
/// At other places of the mesh, vertices are split: one for each fan. These vertices are locked, so that
/// the original mesh can be restored there.
#[derive(Clone)]
pub(super) struct HalfEdgeSurface {
    /// By half-edge: its start vertex; [`NONE`] if its face was removed.
    pub start: Vec<u32>,
    /// By half-edge: its twin, [`NONE`] at a border.
    pub twin: Vec<u32>,
    /// By vertex: a half-edge that starts there, at a border the border half-edge; [`NONE`] if the vertex was
    /// removed.
    pub outgoing: Vec<u32>,
    /// The number of remaining faces.
    pub n_faces: usize,
}

/// A mesh after splitting it into manifold fans.
pub(super) struct ManifoldSplit {
    pub surface: HalfEdgeSurface,
    /// By vertex: the first one at the same position of the mesh.
    pub first_fan: Vec<u32>,
    /// By vertex: whether it is locked, because the mesh is not a manifold there.
    pub is_locked: Vec<bool>,
    /// By vertex: one of its rows of the mesh.
    pub row: Vec<u32>,
    /// Faces with two corners at one position, which were dropped.
    pub n_collapsed: usize,
}

impl HalfEdgeSurface {
    pub fn from_mesh(mesh: &Mesh, ids: Option<&[u32]>) -> ManifoldSplit {
        let twins = Twins::with_ids(mesh, ids);
        let n = 3 * mesh.faces().len();
        let id = |row: u32| ids.map_or(row, |ids| ids[row as usize]);
        let rows = mesh.faces().as_flattened();
        let (mut twin, mut start) = (vec![NONE; n], vec![NONE; n]);
        let mut tied = vec![false; mesh.positions().len()];
        let mut collapsed = 0;
        for h in 0..n as u32 {
            match twins.get(h) {
                Twin::Pair(other) => twin[h as usize] = other,
                Twin::Boundary => {}
                Twin::Collapsed => {
                    collapsed += usize::from(h % 3 == 0);
                    continue;
                }
                // The two ends of a non-manifold edge.
                Twin::Flipped(_) | Twin::NonManifold => {
                    tied[id(rows[h as usize]) as usize] = true;
                    tied[id(rows[next_in_face(h) as usize]) as usize] = true;
                }
            }
            start[h as usize] = h;
        }
        // One vertex for each fan, which joins corners across their outgoing half-edges.
        let mut fans = DisjointSets::new(n);
        for h in 0..n as u32 {
            if start[h as usize] != NONE && twin[h as usize] != NONE {
                // The corner across an outgoing half-edge is the start of the one after its twin.
                fans.union(h, next_in_face(twin[h as usize]));
            }
        }
        let mut surface = Self { start, twin, outgoing: Vec::new(), n_faces: mesh.faces().len() - collapsed };
        let (mut position, mut first_fan, mut row) = (Vec::new(), Vec::new(), Vec::new());
        let mut vertex_of = vec![NONE; n];
        let mut fan_of = vec![NONE; mesh.positions().len()];
        for h in 0..n as u32 {
            if surface.start[h as usize] == NONE {
                continue;
            }
            let root = fans.find(h) as usize;
            if vertex_of[root] == NONE {
                vertex_of[root] = position.len() as u32;
                let at = id(rows[h as usize]);
                // A second fan at one position.
                if fan_of[at as usize] == NONE {
                    fan_of[at as usize] = vertex_of[root];
                } else {
                    tied[at as usize] = true;
                }
                first_fan.push(fan_of[at as usize]);
                position.push(at);
                row.push(rows[h as usize]);
                surface.outgoing.push(h);
            }
            let v = vertex_of[root];
            surface.start[h as usize] = v;
            // At a border the outgoing half-edge has to be the one on it.
            if surface.twin[h as usize] == NONE {
                surface.outgoing[v as usize] = h;
            }
        }
        let is_tied = position.iter().map(|at: &u32| tied[*at as usize]).collect();
        ManifoldSplit { surface, first_fan, is_locked: is_tied, row, n_collapsed: collapsed }
    }

    #[inline]
    pub fn end(&self, h: u32) -> u32 {
        self.start[next_in_face(h) as usize]
    }

    #[inline]
    pub fn is_border(&self, v: u32) -> bool {
        self.twin[self.outgoing[v as usize] as usize] == NONE
    }

    /// The half-edges that start at a vertex, counter-clockwise, one for each face of its fan.
    #[inline]
    pub fn one_ring(&self, v: u32) -> OneRingHalfEdges<'_> {
        let first = self.outgoing[v as usize];
        OneRingHalfEdges { surface: self, first, next: first }
    }

    /// The half-edges that start at the ends of an edge, one for each face there except for the edge's two,
    /// counter-clockwise around the vertex that the edge becomes. Its ends are not both on a border, unless
    /// the edge is.
    pub fn around_edge(&self, h: u32) -> impl Iterator<Item = u32> + '_ {
        let across = self.twin[h as usize];
        let [a, b] = [self.start[h as usize], self.end(h)].map(|v| self.outgoing[v as usize]);
        let after = |side: u32| self.twin[previous_in_face(side) as usize];
        //   after(h) \   / at_end          h runs from a to b; its own face is above it. The half-edges at a
        //             a→b                  run from after(h) to at_start, those at b from after(across) to
        //   at_start /   \ after(across)   at_end.
        //
        // Up to a given half-edge, exclusive, or to the border.
        let runs = if across == NONE {
            [(b, next_in_face(h)), (after(h), NONE), (NONE, NONE)]
        } else {
            let (at_start, at_end) = (next_in_face(across), next_in_face(h));
            match [a, b].map(|outgoing| self.twin[outgoing as usize] == NONE) {
                [true, _] => [(a, at_start), (after(across), at_end), (after(h), NONE)],
                [_, true] => [(b, at_end), (after(h), at_start), (after(across), NONE)],
                _ => [(after(h), at_start), (after(across), at_end), (NONE, NONE)],
            }
        };
        runs.into_iter().flat_map(move |(first, end)| {
            let up_to_end = move |g: u32| (g != NONE && g != end).then_some(g);
            std::iter::successors(up_to_end(first), move |g| {
                up_to_end(self.twin[previous_in_face(*g) as usize])
            })
        })
    }

    /// The face nearest to a point, as far as a descent finds it from a given face, and its squared distance.
    pub fn descend(&self, from: u32, p: [f64; 3], at: &[[f64; 3]]) -> (u32, f64) {
        let distance_sq = |face: u32| distance_sq_to_triangle(p, self.corners(face).map(|v| at[v as usize]));
        let mut best = (from, distance_sq(from));
        for _ in 0..MOST_STEPS {
            let current = best.0;
            for face in self.corners(current).into_iter().flat_map(|v| self.one_ring(v)).map(|h| h / 3) {
                let d = distance_sq(face);
                if d < best.1 {
                    best = (face, d);
                }
            }
            if best.0 == current {
                break;
            }
        }
        best
    }

    /// The remaining faces.
    pub fn faces(&self) -> Vec<u32> {
        (0..(self.start.len() / 3) as u32).filter(|face| self.corners(*face)[0] != NONE).collect()
    }

    /// The vertices of a face.
    #[inline]
    pub fn corners(&self, face: u32) -> [u32; 3] {
        let at = 3 * face as usize;
        [self.start[at], self.start[at + 1], self.start[at + 2]]
    }

    /// Collapses the edge of `h` to its end: its start, its face and the face across are removed. The caller
    /// has checked that the result is a valid surface.
    pub fn collapse(&mut self, h: u32) {
        let (a, b) = (self.start[h as usize], self.end(h));
        let across = self.twin[h as usize];
        let kept_twin = self.twin[previous_in_face(h) as usize];
        // The half-edge that b keeps: the border half-edge, or any. If that is in a removed face, a neighbour
        // replaces it.
        let mut keep = match (self.is_border(a), self.is_border(b)) {
            (_, true) => self.outgoing[b as usize],
            (true, false) => self.outgoing[a as usize],
            (false, false) => kept_twin,
        };
        if keep / 3 == h / 3 {
            keep = kept_twin;
        } else if across != NONE && keep / 3 == across / 3 {
            keep = self.twin[previous_in_face(across) as usize];
        }
        let first = self.outgoing[a as usize];
        // From the border half-edge, if there is one, so that one direction visits the whole fan.
        let mut fan = first;
        while fan != NONE {
            self.start[fan as usize] = b;
            fan = self.twin[previous_in_face(fan) as usize];
            fan = if fan == first { NONE } else { fan };
        }
        for side in [h, across] {
            if side != NONE {
                self.collapse_face(side);
            }
        }
        self.outgoing[a as usize] = NONE;
        self.outgoing[b as usize] = keep;
    }

    /// Removes a face of a component that is removed completely.
    pub fn remove_face(&mut self, face: u32) {
        for h in 3 * face as usize..3 * face as usize + 3 {
            self.outgoing[self.start[h] as usize] = NONE;
        }
        for h in 3 * face as usize..3 * face as usize + 3 {
            self.start[h] = NONE;
            self.twin[h] = NONE;
        }
        self.n_faces -= 1;
    }

    /// Drops removed faces and vertices; the others keep their order.
    pub fn compact(&mut self) -> Compaction {
        let faces = self.faces();
        let vertices: Vec<u32> =
            (0..self.outgoing.len() as u32).filter(|v| self.outgoing[*v as usize] != NONE).collect();
        let mut new_face = vec![NONE; self.start.len() / 3];
        faces.iter().zip(0..).for_each(|(old, new)| new_face[*old as usize] = new);
        let mut new_vertex = vec![NONE; self.outgoing.len()];
        vertices.iter().zip(0..).for_each(|(old, new)| new_vertex[*old as usize] = new);
        let compaction = Compaction { faces, vertices, new_face, new_vertex };
        self.start = compaction.half_edges(&self.start).map(|v| compaction.new_vertex[v as usize]).collect();
        self.twin = compaction.half_edges(&self.twin).map(|h| compaction.half_edge(h)).collect();
        self.outgoing = compaction.vertices(&self.outgoing).map(|h| compaction.half_edge(h)).collect();
        compaction
    }

    /// The same surface with the numbers from before [`Self::compact`].
    pub fn before(&self, compaction: &Compaction) -> Self {
        let by_half_edge = |values: &[u32], old: &dyn Fn(u32) -> u32| {
            let rows: Vec<[u32; 3]> = values.as_chunks::<3>().0.iter().map(|row| row.map(old)).collect();
            compaction.by_old_face(&rows, [NONE; 3]).into_flattened()
        };
        let outgoing: Vec<u32> = self.outgoing.iter().map(|h| compaction.old_half_edge(*h)).collect();
        Self {
            start: by_half_edge(&self.start, &|v| compaction.old_vertex(v)),
            twin: by_half_edge(&self.twin, &|h| compaction.old_half_edge(h)),
            outgoing: compaction.by_old_vertex(&outgoing, NONE),
            n_faces: self.n_faces,
        }
    }

    /// Removes the face of `side`, whose ends are one vertex now, and joins the twins of its other two edges.
    fn collapse_face(&mut self, side: u32) {
        let (next, previous) = (next_in_face(side), previous_in_face(side));
        let apex = self.start[previous as usize];
        let (x, y) = (self.twin[next as usize], self.twin[previous as usize]);
        // x starts at the apex, y ends there; the other ends of both are one vertex.
        if x != NONE {
            self.twin[x as usize] = y;
        }
        if y != NONE {
            self.twin[y as usize] = x;
        }
        // The outgoing half-edge of the apex inside this face is its third edge; if it was the outgoing one,
        // x is now.
        if self.outgoing[apex as usize] == previous {
            self.outgoing[apex as usize] = x;
        }
        let first = 3 * (side / 3);
        for h in first..first + 3 {
            self.start[h as usize] = NONE;
            self.twin[h as usize] = NONE;
        }
        self.n_faces -= 1;
    }
}

/// Some faces of a surface, with separate numbers.
pub(super) struct SurfaceRegion {
    /// By number in the region: the number in the whole surface, ascending.
    pub faces: Vec<u32>,
    pub vertices: Vec<u32>,
}

impl SurfaceRegion {
    /// The half-edges by their numbers in the whole surface, in the order of the region.
    pub fn half_edges(&self) -> impl Iterator<Item = u32> {
        self.faces.iter().flat_map(|face| [0, 1, 2].map(|k| 3 * face + k))
    }

    /// The number of a half-edge in the whole surface.
    pub fn half_edge(&self, h: u32) -> u32 {
        3 * self.faces[h as usize / 3] + h % 3
    }
}

/// Tables of numbers within a region, one for each active thread.
pub(super) struct RegionNumbers {
    size: usize,
    free: Mutex<Vec<Vec<u32>>>,
}

impl RegionNumbers {
    /// Tables for numbers of the whole surface below `size`.
    pub fn new(size: usize) -> Self {
        Self { size, free: Mutex::default() }
    }

    /// Calls `work` with a table in which each member has its index among the members, and all other numbers
    /// have [`NONE`].
    pub fn of<T>(&self, members: &[u32], work: impl FnOnce(&[u32]) -> T) -> T {
        // The lock is held only to take a table and to return it.
        let free = || self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let free_table = free().pop();
        let mut table = free_table.unwrap_or_else(|| vec![NONE; self.size]);
        members.iter().zip(0..).for_each(|(member, index)| table[*member as usize] = index);
        let result = work(&table);
        // Only the members are reset, since the table is as large as the whole surface.
        members.iter().for_each(|member| table[*member as usize] = NONE);
        free().push(table);
        result
    }
}

/// The remaining parts of a surface, and their new numbers.
pub(super) struct Compaction {
    /// By new number: the old one.
    faces: Vec<u32>,
    vertices: Vec<u32>,
    /// By old number: the new one, or [`NONE`].
    pub new_face: Vec<u32>,
    pub new_vertex: Vec<u32>,
}

impl Compaction {
    /// The values of the remaining faces.
    pub fn faces<T: Copy>(&self, values: &[T]) -> impl Iterator<Item = T> {
        self.faces.iter().map(|face| values[*face as usize])
    }

    /// The values of the remaining vertices.
    pub fn vertices<T: Copy>(&self, values: &[T]) -> impl Iterator<Item = T> {
        self.vertices.iter().map(|v| values[*v as usize])
    }

    /// The values of the remaining half-edges.
    pub fn half_edges<T: Copy>(&self, values: &[T]) -> impl Iterator<Item = T> {
        self.faces.iter().flat_map(|face| [0, 1, 2].map(|k| values[3 * *face as usize + k]))
    }

    /// Values by the old numbers of faces, from values by the new ones.
    pub fn by_old_face<T: Copy>(&self, values: &[T], missing: T) -> Vec<T> {
        by_old_number(&self.faces, self.new_face.len(), values, missing)
    }

    /// Values by the old numbers of vertices, from values by the new ones.
    pub fn by_old_vertex<T: Copy>(&self, values: &[T], missing: T) -> Vec<T> {
        by_old_number(&self.vertices, self.new_vertex.len(), values, missing)
    }

    /// The old number of a face; [`NONE`] for none.
    pub fn old_face(&self, face: u32) -> u32 {
        if face == NONE { NONE } else { self.faces[face as usize] }
    }

    /// The old number of a vertex; [`NONE`] for none.
    pub fn old_vertex(&self, v: u32) -> u32 {
        if v == NONE { NONE } else { self.vertices[v as usize] }
    }

    /// The old number of a half-edge; [`NONE`] for none.
    pub fn old_half_edge(&self, h: u32) -> u32 {
        if h == NONE { NONE } else { 3 * self.faces[h as usize / 3] + h % 3 }
    }

    /// The new number of a remaining half-edge; [`NONE`] for none.
    fn half_edge(&self, h: u32) -> u32 {
        if h == NONE { NONE } else { 3 * self.new_face[h as usize / 3] + h % 3 }
    }
}

fn by_old_number<T: Copy>(old: &[u32], n: usize, values: &[T], missing: T) -> Vec<T> {
    let mut by_old = vec![missing; n];
    old.iter().zip(values).for_each(|(i, value)| by_old[*i as usize] = *value);
    by_old
}

/// See [`HalfEdgeSurface::one_ring`].
pub(super) struct OneRingHalfEdges<'a> {
    surface: &'a HalfEdgeSurface,
    first: u32,
    next: u32,
}

impl Iterator for OneRingHalfEdges<'_> {
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
