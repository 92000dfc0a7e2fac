//! Topology of the edges: the counts of each kind, the connected components, and orientability.
use super::connectivity::MeshConnectivity;
use super::finding::{Finding, Witness};
use crate::explicit::{DisjointSets, Twin};

/// The counts over all edges and faces.
#[derive(Default)]
pub(super) struct EdgeTopology {
    /// Faces with three different positions.
    pub faces: u64,
    pub edges: u64,
    /// Sets of faces connected by edges.
    pub components: u64,
    pub boundary_edges: Finding,
    pub non_manifold_edges: Finding,
    pub inconsistent_edges: Finding,
    pub collapsed_faces: Finding,
    pub orientable: bool,
}

impl EdgeTopology {
    pub fn count(surface: &MeshConnectivity) -> Self {
        let MeshConnectivity { mesh, twins, .. } = surface;
        let mut pieces = Self::default();
        let mut sets = DisjointSets::new(surface.n_faces() as usize);
        for face in 0..surface.n_faces() {
            let Some(half_edges) = surface.half_edges(face) else {
                pieces.collapsed_faces.add(|| Witness::face(mesh, face));
                continue;
            };
            pieces.faces += 1;
            for h in half_edges {
                match twins.get(h) {
                    // An edge with two faces is counted at the lower of its half-edges.
                    Twin::Pair(t) | Twin::Flipped(t) if t < h => {}
                    Twin::Pair(t) => {
                        pieces.edges += 1;
                        sets.union(face, t / 3);
                    }
                    Twin::Flipped(t) => {
                        pieces.edges += 1;
                        sets.union(face, t / 3);
                        pieces.inconsistent_edges.add(|| Witness::edge(mesh, &[h, t]));
                    }
                    Twin::Boundary => {
                        pieces.edges += 1;
                        pieces.boundary_edges.add(|| Witness::edge(mesh, &[h]));
                    }
                    Twin::NonManifold | Twin::Collapsed => {}
                }
            }
        }
        for edge in twins.non_manifold_edges() {
            pieces.edges += 1;
            // The faces around it are one component, whether or not they are wound alike.
            edge.windows(2).for_each(|pair| sets.union(pair[0] / 3, pair[1] / 3));
            pieces.non_manifold_edges.add(|| Witness::edge(mesh, edge));
        }
        // Each union of two different sets leaves one component less.
        pieces.components = pieces.faces - sets.n_unions();
        // A surface wound alike everywhere is an orientation of itself.
        pieces.orientable = pieces.inconsistent_edges.is_none() || is_orientable(surface);
        pieces
    }
}

/// The sets of faces connected by edges.
pub(super) fn connected_faces(surface: &MeshConnectivity) -> DisjointSets {
    let mut sets = DisjointSets::new(surface.n_faces() as usize);
    for h in 0..surface.twins.len() as u32 {
        if let Twin::Pair(t) | Twin::Flipped(t) = surface.twins.get(h)
            && h < t
        {
            sets.union(h / 3, t / 3);
        }
    }
    for edge in surface.twins.non_manifold_edges() {
        edge.windows(2).for_each(|pair| sets.union(pair[0] / 3, pair[1] / 3));
    }
    sets
}

/// Whether all faces could be wound so that every edge with two faces is traversed in both directions.
fn is_orientable(surface: &MeshConnectivity) -> bool {
    let mut is_orientable = true;
    find_non_orientable(surface, |_| is_orientable = false);
    is_orientable
}

/// Calls `each` with a face of every component that is not orientable, such as a Möbius strip. Here only
/// edges with two faces connect a component.
pub(super) fn find_non_orientable(surface: &MeshConnectivity, mut each: impl FnMut(u32)) {
    #[derive(Clone, Copy, PartialEq)]
    enum FaceFlip {
        Unknown,
        Kept,
        Turned,
    }
    let turn = |side: FaceFlip| if side == FaceFlip::Kept { FaceFlip::Turned } else { FaceFlip::Kept };
    let mut sides = vec![FaceFlip::Unknown; surface.n_faces() as usize];
    let mut stack = Vec::new();
    for start in 0..surface.n_faces() {
        if sides[start as usize] != FaceFlip::Unknown {
            continue;
        }
        sides[start as usize] = FaceFlip::Kept;
        stack.push(start);
        // The search goes on after a contradiction: all faces of the component have to be visited,
        // or they would be found as another one.
        let mut contradicted = false;
        while let Some(face) = stack.pop() {
            let side = sides[face as usize];
            for h in 3 * face..3 * face + 3 {
                let (neighbour, wanted) = match surface.twins.get(h) {
                    Twin::Pair(t) => (t / 3, side),
                    Twin::Flipped(t) => (t / 3, turn(side)),
                    _ => continue,
                };
                let flip = &mut sides[neighbour as usize];
                if *flip == FaceFlip::Unknown {
                    *flip = wanted;
                    stack.push(neighbour);
                } else if *flip != wanted {
                    contradicted = true;
                }
            }
        }
        if contradicted {
            each(start);
        }
    }
}
