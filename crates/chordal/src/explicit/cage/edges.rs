//! The edges of a cage, numbered in the order of their first corners.
use super::Cage;

/// The edges of a cage, with the faces of each.
#[derive(Clone, Debug)]
pub(crate) struct CageEdges {
    /// The ends, the lower vertex first.
    pub ends: Vec<[u32; 2]>,
    /// For each corner the edge to the next corner of its face.
    pub of_corner: Vec<u32>,
    /// The end of each edge's faces in `faces`.
    face_ends: Vec<u32>,
    /// Faces, in ascending order within an edge.
    faces: Vec<u32>,
    /// Edges with more than two faces, or with two of opposite orientations.
    pub non_manifold: Vec<bool>,
    /// Edges sorted by their ends, for lookups.
    sorted: Vec<([u32; 2], u32)>,
}

impl CageEdges {
    pub fn new(cage: &Cage) -> Self {
        Self::with_classes(cage, |_| 0)
    }

    /// `class` tells apart edges that have the same two ends, as a round of Loop subdivision can produce: sides
    /// are one edge only if their corners have the same class.
    pub fn with_classes(cage: &Cage, class: impl Fn(u32) -> u32 + Copy) -> Self {
        let halves = CageHalfEdges::new(cage, class);
        // Edges are numbered in the order of the first corner.
        let mut counts = vec![0_u32; cage.corners.len()];
        halves.runs(class).for_each(|(_, run)| counts[run[0].1 as usize] = run.len() as u32);
        let mut number_of = vec![0; cage.corners.len()];
        let mut face_ends = Vec::with_capacity(cage.corners.len() / 2);
        let mut end = 0;
        for (number, count) in number_of.iter_mut().zip(counts).filter(|(_, count)| *count > 0) {
            *number = face_ends.len() as u32;
            end += count;
            face_ends.push(end);
        }
        let n = face_ends.len();
        let mut edges = Self {
            ends: vec![[0; 2]; n],
            of_corner: vec![0; cage.corners.len()],
            face_ends,
            faces: vec![0; cage.corners.len()],
            non_manifold: vec![false; n],
            sorted: Vec::with_capacity(n),
        };
        let face_of = face_of_corners(cage);
        for (low, run) in halves.runs(class) {
            let number = number_of[run[0].1 as usize];
            let first = edges.face_ends[number as usize] as usize - run.len();
            let mut n_up = 0;
            for (k, (_, corner, runs_up)) in run.iter().enumerate() {
                edges.of_corner[*corner as usize] = number;
                edges.faces[first + k] = face_of[*corner as usize];
                n_up += usize::from(*runs_up);
            }
            // Two faces that run along the edge in the same direction are wound against each other.
            edges.non_manifold[number as usize] = run.len() > 2 || run.len() == 2 && n_up != 1;
            edges.ends[number as usize] = [low, run[0].0];
            edges.sorted.push(([low, run[0].0], number));
        }
        edges
    }

    /// The faces of an edge.
    pub fn faces(&self, edge: usize) -> &[u32] {
        let start = if edge == 0 { 0 } else { self.face_ends[edge - 1] };
        &self.faces[start as usize..self.face_ends[edge] as usize]
    }

    /// The edge between two vertices; any one of them if there are several.
    pub fn between(&self, a: u32, b: u32) -> Option<u32> {
        let ends = if a < b { [a, b] } else { [b, a] };
        self.sorted.binary_search_by_key(&ends, |entry| entry.0).ok().map(|k| self.sorted[k].1)
    }

    /// The sharp edges by their ends, from the sharpness of each edge.
    pub fn sharp_edges(&self, sharpness: &[f64]) -> Vec<([u32; 2], f64)> {
        let edges = self.sorted.iter().map(|(ends, edge)| (*ends, sharpness[*edge as usize]));
        edges.filter(|(_, sharp)| *sharp > 0.0).collect()
    }
}

/// Half-edges by their lower vertex: the end of each vertex's list, and for each half-edge the other vertex,
/// its corner, and whether it runs from the lower vertex to the higher one; sorted in that order.
struct CageHalfEdges {
    row_ends: Vec<u32>,
    all: Vec<(u32, u32, bool)>,
}

impl CageHalfEdges {
    fn new(cage: &Cage, class: impl Fn(u32) -> u32) -> Self {
        let corners = || cage.faces().flat_map(|face| (0..face.len()).map(move |k| (face, k)));
        let ends_of =
            |(face, k): (&[u32], usize)| (face[k], face[if k + 1 < face.len() { k + 1 } else { 0 }]);
        let low = corners().map(|corner| {
            let (a, b) = ends_of(corner);
            if a < b { (a, (b, true)) } else { (b, (a, false)) }
        });
        let pairs = low.enumerate().map(|(corner, (low, (high, up)))| (low, (high, corner as u32, up)));
        let (row_ends, mut all) = csr_lists(cage.positions.len(), pairs);
        let mut start = 0;
        for end in &row_ends {
            let order = |(high, corner, _): &(u32, u32, bool)| (*high, class(*corner), *corner);
            all[start..*end as usize].sort_unstable_by_key(order);
            start = *end as usize;
        }
        Self { row_ends, all }
    }

    /// The half-edges of each edge, with the lower of its ends, in ascending order.
    fn runs(&self, class: impl Fn(u32) -> u32 + Copy) -> impl Iterator<Item = (u32, &[(u32, u32, bool)])> {
        let runs_of = move |low: usize| {
            csr_row(&self.row_ends, &self.all, low)
                .chunk_by(move |a, b| a.0 == b.0 && class(a.1) == class(b.1))
        };
        (0..self.row_ends.len()).flat_map(move |low| runs_of(low).map(move |run| (low as u32, run)))
    }
}

/// The face of each corner.
fn face_of_corners(cage: &Cage) -> Vec<u32> {
    let mut faces = Vec::with_capacity(cage.corners.len());
    for (face, vertices) in cage.faces().enumerate() {
        faces.extend(vertices.iter().map(|_| face as u32));
    }
    faces
}

/// The edges and the faces around each vertex.
#[derive(Clone, Debug)]
pub(super) struct VertexIncidence {
    edge_ends: Vec<u32>,
    edges: Vec<u32>,
    face_ends: Vec<u32>,
    faces: Vec<u32>,
}

impl VertexIncidence {
    pub fn new(cage: &Cage, edges: &CageEdges) -> Self {
        let n = cage.positions.len();
        let of_edges = edges.ends.iter().enumerate().flat_map(|(e, ends)| ends.map(|v| (v, e as u32)));
        let of_faces =
            cage.faces().enumerate().flat_map(|(f, vertices)| vertices.iter().map(move |v| (*v, f as u32)));
        let (edge_ends, edges) = csr_lists(n, of_edges);
        let (face_ends, faces) = csr_lists(n, of_faces);
        Self { edge_ends, edges, face_ends, faces }
    }

    pub fn edges(&self, vertex: usize) -> &[u32] {
        csr_row(&self.edge_ends, &self.edges, vertex)
    }

    pub fn faces(&self, vertex: usize) -> &[u32] {
        csr_row(&self.face_ends, &self.faces, vertex)
    }
}

pub(super) fn csr_row<'a, T>(ends: &[u32], items: &'a [T], row: usize) -> &'a [T] {
    let start = if row == 0 { 0 } else { ends[row - 1] };
    &items[start as usize..ends[row] as usize]
}

/// Lists of the items of each of `n` owners, in input order (compressed rows): the end of each list, and all
/// items.
pub(super) fn csr_lists<T: Copy + Default>(
    n: usize,
    pairs: impl Iterator<Item = (u32, T)> + Clone,
) -> (Vec<u32>, Vec<T>) {
    let mut counts = vec![0_u32; n];
    pairs.clone().for_each(|(owner, _)| counts[owner as usize] += 1);
    let mut end = 0;
    let mut starts: Vec<u32> = Vec::with_capacity(n);
    for count in &counts {
        starts.push(end);
        end += count;
    }
    let mut items = vec![T::default(); end as usize];
    for (owner, item) in pairs {
        let slot = &mut starts[owner as usize];
        items[*slot as usize] = item;
        *slot += 1;
    }
    // Filling has moved each start to the end of its list.
    (starts, items)
}
