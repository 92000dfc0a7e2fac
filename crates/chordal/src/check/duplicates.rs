//! Faces with the same three positions as an earlier one, and positions with the same coordinates as an
//! earlier one.
use super::connectivity::MeshConnectivity;
use super::finding::{Finding, Witness};
use crate::explicit::{Mesh, Topology, Twin, next_in_face};

/// The connectivity of a mesh by its indices and by bit-identical positions.
pub struct ConnectivityPair<'a> {
    /// By indices.
    pub by_indices: MeshConnectivity<'a>,
    /// By positions; `None` if that is the same because no two positions have the same coordinates.
    pub by_positions: Option<MeshConnectivity<'a>>,
    /// Positions by index with the same coordinates as an earlier one, with `−0.0` equal to `0.0`.
    pub duplicate_vertices: Finding,
}

impl<'a> MeshConnectivity<'a> {
    /// Both connectivities of `mesh`, at the cost of one if they are the same.
    #[must_use]
    pub fn by_indices_and_positions(mesh: &'a Mesh) -> ConnectivityPair<'a> {
        let by_bits = Topology::Positions.ids(mesh);
        let duplicate_vertices = duplicate_positions(mesh, by_bits.as_deref().unwrap_or_default());
        let differ = !duplicate_vertices.is_none();
        ConnectivityPair {
            by_indices: Self::new(mesh, Topology::Indices),
            by_positions: differ.then(|| Self::with_ids(mesh, Topology::Positions, by_bits)),
            duplicate_vertices,
        }
    }
}

/// A face that repeats an earlier one; ordered by face.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct DuplicateFace {
    face: u32,
    original: u32,
    opposite: bool,
}

/// The faces that repeat the positions of an earlier one: all of them, and those with the opposite winding.
pub(super) fn find_duplicates(surface: &MeshConnectivity) -> (Finding, Finding) {
    let mut repeats = Vec::new();
    for face in (0..surface.n_faces()).filter(|face| surface.twins.may_share_two_sides(*face)) {
        // Two faces with the same corners are each other's neighbours at all sides that no further face has.
        // Edges with more faces are looked at below.
        for h in surface.half_edges(face).into_iter().flatten() {
            let (t, opposite) = match surface.twins.get(h) {
                Twin::Pair(t) => (t, true),
                Twin::Flipped(t) => (t, false),
                _ => continue,
            };
            // From the later of the two faces only. The second side is asked first, since it rules
            // out nearly all pairs without a look at their corners.
            let twice = t < h && may_share(surface.twins.get(next_in_face(h)), t / 3);
            if twice && surface.apex(h) == surface.apex(t) && is_lowest_edge(surface, h) {
                repeats.push(DuplicateFace { face, original: t / 3, opposite });
            }
        }
    }
    for edge in surface.twins.non_manifold_edges() {
        repeats_along(surface, edge, &mut repeats);
    }
    repeats.sort_unstable();
    let (mut duplicates, mut opposite) = (Finding::default(), Finding::default());
    for repeat in repeats {
        let witness = || Witness::repeated(surface.mesh, repeat.face, repeat.original);
        duplicates.add(witness);
        if repeat.opposite {
            opposite.add(witness);
        }
    }
    (duplicates, opposite)
}

/// Finds the positions by index that have the same coordinates as an earlier one, with `−0.0` equal to `0.0`:
/// vertex welding would merge these. Each counts once, with the first row at that point.
///
/// About 25 ns a row.
///
/// ```
/// use chordal::{Mesh, check::duplicate_vertices};
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
/// let mesh = Mesh::new(points, vec![[0, 1, 2], [0, 2, 3]])?;
/// assert_eq!(duplicate_vertices(&mesh).count, 1);
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
#[must_use]
pub fn duplicate_vertices(mesh: &Mesh) -> Finding {
    duplicate_positions(mesh, Topology::Positions.ids(mesh).as_deref().unwrap_or_default())
}

/// The same, given the first row at the point of each row.
pub(super) fn duplicate_positions(mesh: &Mesh, first_there: &[u32]) -> Finding {
    let mut is_visited = vec![false; if mesh.position_id().is_some() { first_there.len() } else { 0 }];
    let mut repeated = Finding::default();
    for (row, &first) in first_there.iter().enumerate() {
        let row = row as u32;
        let is_new = mesh.position_id().is_none_or(|ids| {
            let is_visited = &mut is_visited[ids[row as usize] as usize];
            !std::mem::replace(is_visited, true)
        });
        if is_new && first != row {
            repeated.add(|| Witness::repeated_vertex(mesh, row, first));
        }
    }
    repeated
}

/// Whether `face` may be the face across an edge. Tested first, since two faces that share one edge rarely
/// share another.
#[inline]
fn may_share(across: Twin, face: u32) -> bool {
    match across {
        Twin::Pair(t) | Twin::Flipped(t) => t / 3 == face,
        Twin::NonManifold => true,
        Twin::Boundary | Twin::Collapsed => false,
    }
}

/// Whether a half-edge joins the two lower positions of its face: two faces with the same positions share all
/// three edges, and must be found at only one of them.
fn is_lowest_edge(surface: &MeshConnectivity, h: u32) -> bool {
    let apex = surface.apex(h);
    surface.origin(h) < apex && surface.origin(next_in_face(h)) < apex
}

/// The faces along one edge whose apex is that of an earlier face along it.
fn repeats_along(surface: &MeshConnectivity, edge: &[u32], repeats: &mut Vec<DuplicateFace>) {
    let mut by_apex: Vec<(u32, u32)> =
        edge.iter().filter(|&&h| is_lowest_edge(surface, h)).map(|&h| (surface.apex(h), h)).collect();
    by_apex.sort_unstable();
    for same in by_apex.chunk_by(|a, b| a.0 == b.0) {
        let (_, first) = same[0];
        repeats.extend(same[1..].iter().map(|&(_, h)| DuplicateFace {
            face: h / 3,
            original: first / 3,
            opposite: surface.origin(h) != surface.origin(first),
        }));
    }
}
