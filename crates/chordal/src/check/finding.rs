//! `Finding`: how often something was met in a mesh, and the first places where.
use crate::explicit::{Mesh, next_in_face};

/// The witnesses that a finding keeps at most; it counts all.
pub const MAX_WITNESSES: usize = 10;

/// Where in a mesh something was met; all numbers are rows of its arrays.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// A row of the positions.
    Vertex(u32),
    /// An edge by its two rows in the positions, as the first of the faces has them, and all faces along it.
    Edge {
        /// From, to.
        vertices: [u32; 2],
        /// The faces along it, ascending.
        faces: Vec<u32>,
    },
    /// A face.
    Face(u32),
    /// A face and an earlier one that has the same vertices.
    Repeated {
        /// The later face.
        face: u32,
        /// The earlier face.
        of: u32,
    },
    /// A row of the positions and an earlier one at the same place.
    RepeatedVertex {
        /// The later row.
        vertex: u32,
        /// The earlier row.
        of: u32,
    },
    /// Two faces that meet where they should not, the lower number first.
    Faces([u32; 2]),
    /// A vertex in the middle of an edge that it does not belong to.
    OnEdge {
        /// The row of the vertex.
        vertex: u32,
        /// The rows of the edge.
        edge: [u32; 2],
        /// The face of the edge.
        face: u32,
    },
}

/// One place where something was met.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    /// Which vertex, edge or face.
    pub place: Place,
    /// A point there: the vertex, the middle of the edge, the centre of the face.
    pub at: [f64; 3],
}

/// How often something was met, and the first [`MAX_WITNESSES`] places in the order of the faces or vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Finding {
    /// How often.
    pub count: u64,
    /// The first places.
    pub witnesses: Vec<Witness>,
}

impl Finding {
    /// Whether it was never met.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.count == 0
    }

    /// Counts one more; asks for its witness only while there is room.
    pub(crate) fn add(&mut self, witness: impl FnOnce() -> Witness) {
        self.count += 1;
        if self.witnesses.len() < MAX_WITNESSES {
            self.witnesses.push(witness());
        }
    }

    /// Appends what a later part of the mesh found.
    pub(super) fn append(&mut self, mut later: Self) {
        self.count += later.count;
        later.witnesses.truncate(MAX_WITNESSES - self.witnesses.len());
        self.witnesses.append(&mut later.witnesses);
    }
}

impl Witness {
    pub(crate) fn vertex(mesh: &Mesh, vertex: u32) -> Self {
        Self { place: Place::Vertex(vertex), at: mesh.positions()[vertex as usize] }
    }

    pub(crate) fn face(mesh: &Mesh, face: u32) -> Self {
        Self { place: Place::Face(face), at: centre(mesh, face) }
    }

    pub(super) fn repeated_vertex(mesh: &Mesh, vertex: u32, of: u32) -> Self {
        Self { place: Place::RepeatedVertex { vertex, of }, at: mesh.positions()[vertex as usize] }
    }

    pub(crate) fn repeated(mesh: &Mesh, face: u32, of: u32) -> Self {
        Self { place: Place::Repeated { face, of }, at: centre(mesh, face) }
    }

    /// The edge with these half-edges.
    pub(crate) fn edge(mesh: &Mesh, half_edges: &[u32]) -> Self {
        let mut faces: Vec<u32> = half_edges.iter().map(|h| h / 3).collect();
        faces.sort_unstable();
        let first = half_edges.iter().copied().min().unwrap_or(0);
        let vertices = ends(mesh, first);
        let [a, b] = vertices.map(|i| mesh.positions()[i as usize]);
        Self { place: Place::Edge { vertices, faces }, at: std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k]) }
    }
}

/// The rows between which a half-edge runs.
pub(super) fn ends(mesh: &Mesh, half_edge: u32) -> [u32; 2] {
    let face = mesh.faces()[half_edge as usize / 3];
    [half_edge, next_in_face(half_edge)].map(|h| face[h as usize % 3])
}

pub(super) fn centre(mesh: &Mesh, face: u32) -> [f64; 3] {
    let [a, b, c] = mesh.corners(face as usize);
    // Divided first: the sum of three large coordinates may not be a number any more.
    std::array::from_fn(|k| a[k] / 3.0 + b[k] / 3.0 + c[k] / 3.0)
}
