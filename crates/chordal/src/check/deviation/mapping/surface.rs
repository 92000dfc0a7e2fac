//! `FanSurface`: a triangle mesh as half-edges, with one vertex for each fan of faces.
use crate::explicit::{Mesh, Twin, Twins, next_in_face, previous_in_face};

/// No half-edge, no face.
pub(super) const NONE: u32 = u32::MAX;
/// The most faces around one vertex that are looked at. Chosen: faces that need more are left to the search.
pub(super) const MOST_AROUND: usize = 64;

/// A triangle mesh in which faces are neighbours if exactly two of them share an edge and are wound alike. If
/// several fans of faces meet at one position, each has a vertex of its own.
pub(super) struct FanSurface {
    /// By half-edge: its start vertex.
    start: Vec<u32>,
    /// By half-edge: its twin, or [`NONE`].
    twin: Vec<u32>,
    /// By vertex: a half-edge that starts there, for an open fan the one from which its ring begins.
    outgoing: Vec<u32>,
    at: Vec<[f64; 3]>,
}

impl FanSurface {
    /// `ids` come from [`crate::explicit::Topology::ids`].
    pub fn new(mesh: &Mesh, ids: Option<&[u32]>) -> Self {
        let twins = Twins::with_ids(mesh, ids);
        let n = 3 * mesh.faces().len();
        let twin: Vec<u32> = (0..n as u32)
            .map(|h| match twins.get(h) {
                Twin::Pair(other) => other,
                _ => NONE,
            })
            .collect();
        let mut this = Self { start: vec![NONE; n], twin, outgoing: Vec::new(), at: Vec::new() };
        for h in 0..n as u32 {
            if this.start[h as usize] == NONE {
                this.add_fan(h, mesh);
            }
        }
        this
    }

    /// Adds the vertex at the start of a half-edge.
    fn add_fan(&mut self, h: u32, mesh: &Mesh) {
        // Go clockwise to the border, or once around.
        // From the half-edge at the border, a walk the other way reaches the whole fan.
        let mut first = h;
        while self.twin[first as usize] != NONE {
            first = next_in_face(self.twin[first as usize]);
            if first == h {
                break;
            }
        }
        let v = self.outgoing.len() as u32;
        let row = mesh.faces().as_flattened()[first as usize];
        self.outgoing.push(first);
        self.at.push(mesh.positions()[row as usize]);
        let mut g = first;
        while g != NONE {
            self.start[g as usize] = v;
            g = self.twin[previous_in_face(g) as usize];
            g = if g == first { NONE } else { g };
        }
    }

    pub fn n_vertices(&self) -> usize {
        self.at.len()
    }

    pub fn n_faces(&self) -> usize {
        self.start.len() / 3
    }

    #[inline]
    pub fn at(&self, v: u32) -> [f64; 3] {
        self.at[v as usize]
    }

    #[inline]
    pub fn start(&self, h: u32) -> u32 {
        self.start[h as usize]
    }

    #[inline]
    pub fn end(&self, h: u32) -> u32 {
        self.start[next_in_face(h) as usize]
    }

    #[inline]
    pub fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }

    #[inline]
    pub fn outgoing(&self, v: u32) -> u32 {
        self.outgoing[v as usize]
    }

    /// Whether the faces around a vertex do not close.
    #[inline]
    pub fn is_open(&self, v: u32) -> bool {
        self.twin[self.outgoing[v as usize] as usize] == NONE
    }

    #[inline]
    pub fn vertices(&self, face: u32) -> [u32; 3] {
        let h = 3 * face as usize;
        [self.start[h], self.start[h + 1], self.start[h + 2]]
    }

    #[inline]
    pub fn corners(&self, face: u32) -> [[f64; 3]; 3] {
        self.vertices(face).map(|v| self.at[v as usize])
    }

    /// The half-edges that start at a vertex, counter-clockwise, one for each face of its fan.
    #[inline]
    pub fn ring(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.outgoing[v as usize];
        std::iter::successors(Some(first), move |h| {
            let next = self.twin[previous_in_face(*h) as usize];
            (next != NONE && next != first).then_some(next)
        })
    }

    /// The half-edge of a face whose twin is in another face.
    #[inline]
    pub fn between(&self, face: u32, other: u32) -> Option<u32> {
        (3 * face..3 * face + 3).find(|h| {
            let t = self.twin[*h as usize];
            t != NONE && t / 3 == other
        })
    }

    /// The one of the two half-edges of an edge that represents it.
    #[inline]
    pub fn edge(&self, h: u32) -> u32 {
        let t = self.twin[h as usize];
        if t < h { t } else { h }
    }
}
