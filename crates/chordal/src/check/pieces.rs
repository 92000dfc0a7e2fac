//! What the edges tell: how many there are of each kind, the connected pieces, and whether they have two sides.
use super::finding::{Finding, Witness};
use super::surface::Surface;
use crate::explicit::{Sets, Twin};

/// The counts over all edges and faces.
#[derive(Default)]
pub(super) struct Pieces {
    /// Faces with three different positions.
    pub faces: u64,
    pub edges: u64,
    /// Sets of faces that hang together by edges.
    pub components: u64,
    pub boundary_edges: Finding,
    pub non_manifold_edges: Finding,
    pub inconsistent_edges: Finding,
    pub collapsed_faces: Finding,
    pub orientable: bool,
}

impl Pieces {
    pub fn count(surface: &Surface) -> Self {
        let Surface { mesh, twins, .. } = surface;
        let mut pieces = Self::default();
        let mut sets = Sets::new(surface.n_faces() as usize);
        for face in 0..surface.n_faces() {
            let Some(half_edges) = surface.half_edges(face) else {
                pieces.collapsed_faces.add(|| Witness::face(mesh, face));
                continue;
            };
            pieces.faces += 1;
            for h in half_edges {
                match twins.get(h) {
                    Twin::Pair(t) | Twin::Flipped(t) if t < h => {}
                    Twin::Pair(t) => {
                        pieces.edges += 1;
                        sets.join(face, t / 3);
                    }
                    Twin::Flipped(t) => {
                        pieces.edges += 1;
                        sets.join(face, t / 3);
                        pieces.inconsistent_edges.add(|| Witness::edge(mesh, &[h, t]));
                    }
                    Twin::Boundary => {
                        pieces.edges += 1;
                        pieces.boundary_edges.add(|| Witness::edge(mesh, &[h]));
                    }
                    Twin::Crowded | Twin::Collapsed => {}
                }
            }
        }
        for edge in twins.crowded_edges() {
            pieces.edges += 1;
            edge.windows(2).for_each(|pair| sets.join(pair[0] / 3, pair[1] / 3));
            pieces.non_manifold_edges.add(|| Witness::edge(mesh, edge));
        }
        pieces.components = pieces.faces - sets.joined();
        pieces.orientable = pieces.inconsistent_edges.is_none() || has_two_sides(surface);
        pieces
    }
}

/// The faces that hang together by edges.
pub(super) fn joined_faces(surface: &Surface) -> Sets {
    let mut sets = Sets::new(surface.n_faces() as usize);
    for h in 0..surface.twins.len() as u32 {
        if let Twin::Pair(t) | Twin::Flipped(t) = surface.twins.get(h)
            && h < t
        {
            sets.join(h / 3, t / 3);
        }
    }
    for edge in surface.twins.crowded_edges() {
        edge.windows(2).for_each(|pair| sets.join(pair[0] / 3, pair[1] / 3));
    }
    sets
}

/// Whether all faces could be wound so that every edge with two faces is run through both ways.
fn has_two_sides(surface: &Surface) -> bool {
    let mut all = true;
    find_one_sided(surface, |_| all = false);
    all
}

/// Calls `each` with a face of every piece that cannot be wound so, as a Möbius strip. Pieces are those that hang
/// together by edges with two faces.
pub(super) fn find_one_sided(surface: &Surface, mut each: impl FnMut(u32)) {
    #[derive(Clone, Copy, PartialEq)]
    enum Side {
        Unknown,
        Kept,
        Turned,
    }
    let turn = |side: Side| if side == Side::Kept { Side::Turned } else { Side::Kept };
    let mut sides = vec![Side::Unknown; surface.n_faces() as usize];
    let mut stack = Vec::new();
    for start in 0..surface.n_faces() {
        if sides[start as usize] != Side::Unknown {
            continue;
        }
        sides[start as usize] = Side::Kept;
        stack.push(start);
        let mut contradicted = false;
        while let Some(face) = stack.pop() {
            let side = sides[face as usize];
            for h in 3 * face..3 * face + 3 {
                let (neighbour, wanted) = match surface.twins.get(h) {
                    Twin::Pair(t) => (t / 3, side),
                    Twin::Flipped(t) => (t / 3, turn(side)),
                    _ => continue,
                };
                let known = &mut sides[neighbour as usize];
                if *known == Side::Unknown {
                    *known = wanted;
                    stack.push(neighbour);
                } else if *known != wanted {
                    contradicted = true;
                }
            }
        }
        if contradicted {
            each(start);
        }
    }
}
