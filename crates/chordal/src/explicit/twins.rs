//! `Twins`: for every half-edge its twin along the same edge in the neighbouring triangle.
use super::{Mesh, Topology};
use crate::math::lesser;

/// The neighbour across a half-edge.
///
/// Half-edge `3·face + k` runs from corner `k` of the face to corner `k + 1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twin {
    /// The only other half-edge of the edge, in the opposite direction: both triangles have the same
    /// orientation.
    Pair(u32),
    /// The only other half-edge of the edge, in the same direction: the two triangles have opposite
    /// orientations.
    Flipped(u32),
    /// No other half-edge: the half-edge is on the boundary.
    Boundary,
    /// Two or more other half-edges; [`Twins::non_manifold_edges`] lists them.
    NonManifold,
    /// The half-edge belongs to a triangle with two corners at one position. Such a triangle covers a segment
    /// or a point, so it is ignored: its neighbours are each other's twins.
    Collapsed,
}

/// The twins of all half-edges of a mesh.
///
/// ```
/// use chordal::Mesh;
/// use chordal::explicit::Topology;
/// use chordal::explicit::adjacency::{Twin, Twins};
/// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]])?;
/// let twins = Twins::new(&mesh, Topology::Indices);
/// assert_eq!(twins.get(2), Twin::Pair(3)); // 2 → 0 in the first face, 0 → 2 in the second
/// assert_eq!(twins.get(0), Twin::Boundary);
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Twins {
    /// A half-edge, with the top bit set when it has the same direction, or one of the states below.
    raw: Vec<u32>,
    /// The half-edges of the edges with three or more, edge by edge.
    non_manifold: Vec<u32>,
    /// The end of each of those edges in `non_manifold`.
    non_manifold_ends: Vec<u32>,
}

const SAME_WAY: u32 = 1 << 31;
const BOUNDARY: u32 = u32::MAX;
const NON_MANIFOLD: u32 = u32::MAX - 1;
const COLLAPSED: u32 = u32::MAX - 2;

/// The half-edge after `half_edge` in its face.
#[inline]
#[must_use]
pub fn next_in_face(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 { half_edge - 2 } else { half_edge + 1 }
}

/// The half-edge before `half_edge` in its face.
#[inline]
#[must_use]
pub fn previous_in_face(half_edge: u32) -> u32 {
    if half_edge.is_multiple_of(3) { half_edge + 2 } else { half_edge - 1 }
}

impl Twins {
    /// Matches the half-edges of `mesh`; `topology` decides which rows are one position.
    ///
    /// Linear time and memory (a sort in the buckets of vertices with many edges): about 45 bytes per
    /// triangle at the peak, 12 afterwards.
    #[must_use]
    pub fn new(mesh: &Mesh, topology: Topology) -> Self {
        Self::with_ids(mesh, topology.ids(mesh).as_deref())
    }

    /// The same for given ids, as from [`Topology::ids`]: for each row an id below the number of rows.
    #[must_use]
    pub fn with_ids(mesh: &Mesh, ids: Option<&[u32]>) -> Self {
        let (faces, n) = (mesh.faces(), mesh.positions().len());
        match ids {
            None => Self::match_edges(faces, n, |index| index),
            Some(ids) => Self::match_edges(faces, n, |index| ids[index as usize]),
        }
    }

    fn match_edges(faces: &[[u32; 3]], n_rows: usize, id: impl Fn(u32) -> u32) -> Self {
        let buckets = HalfEdgeBuckets::fill(faces, n_rows, id);
        let mut twins = Self {
            raw: vec![COLLAPSED; 3 * faces.len()],
            non_manifold: Vec::new(),
            non_manifold_ends: Vec::new(),
        };
        buckets.match_all(&mut twins);
        twins
    }

    /// The neighbour across `half_edge`.
    ///
    /// # Panics
    /// When there is no such half-edge.
    #[inline]
    #[must_use]
    pub fn get(&self, half_edge: u32) -> Twin {
        match self.raw[half_edge as usize] {
            BOUNDARY => Twin::Boundary,
            NON_MANIFOLD => Twin::NonManifold,
            COLLAPSED => Twin::Collapsed,
            raw if raw & SAME_WAY == 0 => Twin::Pair(raw),
            raw => Twin::Flipped(raw ^ SAME_WAY),
        }
    }

    /// Whether two sides of a face may have the same neighbour. False is certain; true is rare, and may be
    /// wrong.
    #[inline]
    pub(crate) fn may_share_two_sides(&self, face: u32) -> bool {
        let at = 3 * face as usize;
        let [a, b, c] = [self.raw[at], self.raw[at + 1], self.raw[at + 2]];
        let no_single_twin = (a >= COLLAPSED) | (b >= COLLAPSED) | (c >= COLLAPSED);
        let [a, b, c] = [a, b, c].map(|raw| (raw & !SAME_WAY) / 3);
        no_single_twin | (a == b) | (b == c) | (c == a)
    }

    /// The number of half-edges, three per face.
    #[must_use]
    pub fn len(&self) -> usize {
        self.raw.len()
    }

    /// Whether there is no half-edge.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.raw.is_empty()
    }

    /// The edges with three or more half-edges, each as its half-edges in ascending order.
    pub fn non_manifold_edges(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(&0).chain(&self.non_manifold_ends);
        starts
            .zip(&self.non_manifold_ends)
            .map(|(&start, &end)| &self.non_manifold[start as usize..end as usize])
    }

    /// Records the half-edges of one edge: those from its lower to its higher position, and those in the
    /// other direction.
    fn record(&mut self, up: &[u64], down: &[u64]) {
        match (up, down) {
            (&[a], &[b]) => self.pair(half_edge(a), half_edge(b), 0),
            (&[a, b], &[]) | (&[], &[a, b]) => self.pair(half_edge(a), half_edge(b), SAME_WAY),
            (&[a], &[]) | (&[], &[a]) => self.raw[half_edge(a) as usize] = BOUNDARY,
            _ => {
                let start = self.non_manifold.len();
                self.non_manifold.extend(up.iter().chain(down).map(|&entry| half_edge(entry)));
                self.non_manifold[start..].sort_unstable();
                self.non_manifold_ends.push(self.non_manifold.len() as u32);
                for &h in &self.non_manifold[start..] {
                    self.raw[h as usize] = NON_MANIFOLD;
                }
            }
        }
    }

    fn pair(&mut self, a: u32, b: u32, flag: u32) {
        self.raw[a as usize] = b | flag;
        self.raw[b as usize] = a | flag;
    }
}

/// The half-edges in one bucket per position: that of their lower end.
///
/// An entry is the higher end in the upper 32 bits and the half-edge in the lower. A bucket is filled from
/// the front with half-edges that run up, from lower to higher end, and from the back with those that run
/// down.
struct HalfEdgeBuckets {
    entries: Vec<u64>,
    /// The start of each bucket, followed by the end of the last.
    start: Vec<u32>,
    /// For each bucket the start of the half-edges that run down.
    middle: Vec<u32>,
}

/// The half-edge of an entry.
#[inline]
fn half_edge(entry: u64) -> u32 {
    entry as u32
}

/// The higher end of an entry.
#[inline]
fn higher_end(entry: u64) -> u32 {
    (entry >> 32) as u32
}

impl HalfEdgeBuckets {
    fn fill(faces: &[[u32; 3]], n_rows: usize, id: impl Fn(u32) -> u32) -> Self {
        let proper = |face: &[u32; 3]| {
            let [a, b, c] = face.map(&id);
            (a != b && b != c && c != a).then_some([a, b, c])
        };
        // 1. Count the half-edges with each position as lower end.
        let mut start = vec![0_u32; n_rows + 1];
        for [a, b, c] in faces.iter().filter_map(proper) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                start[lesser(from, to) as usize] += 1;
            }
        }
        // 2. Turn counts into offsets.
        let mut end = 0;
        for count in &mut start {
            let begin = end;
            end += *count;
            *count = begin;
        }
        // 3. Write each half-edge to its bucket.
        let mut entries = vec![0_u64; end as usize];
        // Within the bucket of a lower end, half-edges that run upwards are filled in from the
        // front, those that run downwards from the back. Both end in the middle, so the direction
        // takes no bit.
        let mut front = start[..n_rows].to_vec();
        let mut back = start[1..].to_vec();
        for (face_idx, face) in faces.iter().enumerate() {
            let Some([a, b, c]) = proper(face) else { continue };
            for (k, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
                let h = (3 * face_idx + k) as u64;
                if from < to {
                    let slot = &mut front[from as usize];
                    entries[*slot as usize] = u64::from(to) << 32 | h;
                    *slot += 1;
                } else {
                    let slot = &mut back[to as usize];
                    *slot -= 1;
                    entries[*slot as usize] = u64::from(from) << 32 | h;
                }
            }
        }
        Self { entries, start, middle: front }
    }

    fn match_all(mut self, twins: &mut Twins) {
        for (bucket, &middle) in self.middle.iter().enumerate() {
            let (start, end) = (self.start[bucket] as usize, self.start[bucket + 1] as usize);
            let (up, down) = self.entries[start..end].split_at_mut(middle as usize - start);
            sort(up);
            sort(down);
            match_bucket(up, down, twins);
        }
    }
}

/// Merges the two sorted lists of a bucket, one edge at a time.
fn match_bucket(mut up: &[u64], mut down: &[u64], twins: &mut Twins) {
    while let Some(&first) = up.first().into_iter().chain(down.first()).min() {
        // The lists are sorted, with the higher end in the leading bits: the smaller of the two
        // first entries belongs to the next edge.
        let edge = higher_end(first);
        let of_edge = |list: &[u64]| list.iter().take_while(|&&entry| higher_end(entry) == edge).count();
        let (n_up, n_down) = (of_edge(up), of_edge(down));
        twins.record(&up[..n_up], &down[..n_down]);
        (up, down) = (&up[n_up..], &down[n_down..]);
    }
}

/// Sorts a list that usually has three entries.
#[inline]
fn sort(list: &mut [u64]) {
    // Longer lists are faster with the general sort; measured, flat between 12 and 24.
    if list.len() > 16 {
        return list.sort_unstable();
    }
    for i in 1..list.len() {
        let entry = list[i];
        let mut j = i;
        while j > 0 && list[j - 1] > entry {
            list[j] = list[j - 1];
            j -= 1;
        }
        list[j] = entry;
    }
}
