//! `Finding`: the number of occurrences of a property in a mesh, and the first of them.
use crate::explicit::{Mesh, next_in_face};

/// The largest number of witnesses that a finding keeps; it counts all occurrences.
pub const MAX_WITNESSES: usize = 10;

/// The location of an occurrence in a mesh; all numbers are rows of the mesh's arrays.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshLocation {
    /// A row of the positions.
    Vertex(u32),
    /// An edge: the two rows of its positions, in the order of its first face, and all faces along it.
    Edge {
        /// From, to.
        vertices: [u32; 2],
        /// The faces along it, ascending.
        faces: Vec<u32>,
    },
    /// A face.
    Face(u32),
    /// A face with the same vertices as an earlier one.
    Repeated {
        /// The later face.
        face: u32,
        /// The earlier face.
        of: u32,
    },
    /// A row of the positions with the same coordinates as an earlier one.
    RepeatedVertex {
        /// The later row.
        vertex: u32,
        /// The earlier row.
        of: u32,
    },
    /// Two faces that intersect where they should not, the lower number first.
    Faces([u32; 2]),
    /// A vertex in the interior of an edge of which it is no end.
    OnEdge {
        /// The row of the vertex.
        vertex: u32,
        /// The rows of the edge.
        edge: [u32; 2],
        /// The face of the edge.
        face: u32,
    },
}

/// One occurrence.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    /// The vertex, edge or face.
    pub place: MeshLocation,
    /// A point of the location: the vertex, the midpoint of the edge, the centre of the face.
    pub at: [f64; 3],
}

/// The number of occurrences of a property, and the first [`MAX_WITNESSES`] of them in the order of the faces
/// or vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Finding {
    /// The number of occurrences.
    pub count: u64,
    /// The first occurrences.
    pub witnesses: Vec<Witness>,
}

impl Finding {
    /// Whether there is no occurrence.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.count == 0
    }

    /// Counts one more; evaluates `witness` only if fewer than [`MAX_WITNESSES`] are kept.
    pub(crate) fn add(&mut self, witness: impl FnOnce() -> Witness) {
        self.count += 1;
        if self.witnesses.len() < MAX_WITNESSES {
            self.witnesses.push(witness());
        }
    }

    /// Appends the finding of a later part of the mesh.
    pub(crate) fn append(&mut self, mut later: Self) {
        self.count += later.count;
        later.witnesses.truncate(MAX_WITNESSES - self.witnesses.len());
        self.witnesses.append(&mut later.witnesses);
    }
}

impl Witness {
    pub(crate) fn vertex(mesh: &Mesh, vertex: u32) -> Self {
        Self { place: MeshLocation::Vertex(vertex), at: mesh.positions()[vertex as usize] }
    }

    pub(crate) fn face(mesh: &Mesh, face: u32) -> Self {
        Self { place: MeshLocation::Face(face), at: centre(mesh, face) }
    }

    pub(super) fn repeated_vertex(mesh: &Mesh, vertex: u32, of: u32) -> Self {
        Self { place: MeshLocation::RepeatedVertex { vertex, of }, at: mesh.positions()[vertex as usize] }
    }

    pub(crate) fn repeated(mesh: &Mesh, face: u32, of: u32) -> Self {
        Self { place: MeshLocation::Repeated { face, of }, at: centre(mesh, face) }
    }

    /// The edge that consists of these half-edges.
    pub(crate) fn edge(mesh: &Mesh, half_edges: &[u32]) -> Self {
        let mut faces: Vec<u32> = half_edges.iter().map(|h| h / 3).collect();
        faces.sort_unstable();
        let first = half_edges.iter().copied().min().unwrap_or(0);
        let vertices = ends(mesh, first);
        let [a, b] = vertices.map(|i| mesh.positions()[i as usize]);
        Self {
            place: MeshLocation::Edge { vertices, faces },
            at: std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k]),
        }
    }
}

/// The rows at the two ends of a half-edge.
pub(super) fn ends(mesh: &Mesh, half_edge: u32) -> [u32; 2] {
    let face = mesh.faces()[half_edge as usize / 3];
    [half_edge, next_in_face(half_edge)].map(|h| face[h as usize % 3])
}

pub(super) fn centre(mesh: &Mesh, face: u32) -> [f64; 3] {
    let [a, b, c] = mesh.corners(face as usize);
    // Divided first, since the sum of three large coordinates may overflow.
    std::array::from_fn(|k| a[k] / 3.0 + b[k] / 3.0 + c[k] / 3.0)
}
