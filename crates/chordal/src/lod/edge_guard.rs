//! `OriginalEdges`: whether edges of the original stay close to the faces around a collapse.
use super::local_tolerance::LocalTolerance;
use super::samples::SamplesByFace;
use super::surface::{HalfEdgeSurface, NONE};
use crate::explicit::closest_on_segments;
use crate::math::dot;

/// The faces around an edge before and after its collapse.
#[derive(Clone, Copy)]
pub(super) struct CollapseChange<'a> {
    /// The faces that are removed or changed.
    pub before: &'a [u32],
    /// The changed faces, counter-clockwise around the new point, which is the first corner of each.
    pub after: &'a [(u32, [[f64; 3]; 3])],
    /// Their half-edges that are opposite the new point.
    pub opposite: &'a [u32],
    /// Whether they close around the new point.
    pub is_closed: bool,
    /// The new point, and the positions of all other vertices.
    pub to: [f64; 3],
    pub surface: &'a HalfEdgeSurface,
    pub at: &'a [[f64; 3]],
    /// The cost of the change.
    pub cost: f32,
}

/// The edges of the original, by vertex.
///
/// Faces hold the vertices of the original. If the ends of an edge are held by different faces, a walk leads
/// along the edge from one to the other, over the edges between them; if each of these comes close to the
/// edge, so do the faces between. The final proof maps both surfaces onto each other in the same way, so if
/// all collapses of a surface were allowed here, it usually needs no other proof.
pub(super) struct OriginalEdges {
    /// Neighbours of vertex v: `neighbours[first[v]..first[v + 1]]`.
    first: Vec<u32>,
    neighbours: Vec<u32>,
}

/// The verdict on the edges of the original around a collapse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EdgeVerdict {
    /// All stay close.
    Near,
    /// All that lead to faces next to the collapse stay close; some lead farther.
    Unknown,
    /// Some do not stay close.
    Far,
}

/// Edges of the original that do not stay close, and the faces around a collapse to which they lead.
#[derive(Clone, Default)]
pub(super) struct FarEdges {
    /// By the two vertices of each.
    pub edges: Vec<[u32; 2]>,
    /// By position around the new point: whether an edge leads across it.
    pub faces: Vec<bool>,
}

impl FarEdges {
    fn clear(&mut self, n_faces: usize) {
        self.edges.clear();
        self.faces.clear();
        self.faces.resize(n_faces, false);
    }

    /// Adds an edge that leads from one face to another, on the shorter way around the new point.
    fn add(&mut self, edge: [u32; 2], [from, to]: [usize; 2], is_closed: bool) {
        self.edges.push(edge);
        let n = self.faces.len();
        let (low, high) = if from < to { (from, to) } else { (to, from) };
        if is_closed && high - low > n - (high - low) {
            self.faces[high..].fill(true);
            self.faces[..=low].fill(true);
        } else {
            self.faces[low..=high].fill(true);
        }
    }
}

impl OriginalEdges {
    pub fn new(surface: &HalfEdgeSurface, n_vertices: usize) -> Self {
        let mut first = vec![0_u32; n_vertices + 1];
        let edges = || {
            let half_edges = (0..surface.start.len() as u32).filter(|h| surface.start[*h as usize] != NONE);
            half_edges.flat_map(|h| {
                let (u, v) = (surface.start[h as usize], surface.end(h));
                // An edge with a twin occurs once in each direction, a border edge in one.
                let back = (surface.twin[h as usize] == NONE).then_some((v, u));
                std::iter::once((u, v)).chain(back)
            })
        };
        edges().for_each(|(u, _)| first[u as usize + 1] += 1);
        for v in 0..n_vertices {
            first[v + 1] += first[v];
        }
        let mut free = first.clone();
        let mut neighbours = vec![0; first.last().map_or(0, |n| *n as usize)];
        for (u, v) in edges() {
            let slot = &mut free[u as usize];
            neighbours[*slot as usize] = v;
            *slot += 1;
        }
        Self { first, neighbours }
    }

    /// The edges between some vertices, with new numbers: `local` has the new number by the old one.
    pub fn some(&self, vertices: &[u32], local: &[u32]) -> Self {
        let mut some = Self { first: vec![0], neighbours: Vec::new() };
        for v in vertices {
            let near = self.neighbours(*v).iter().map(|u| local[*u as usize]);
            some.neighbours.extend(near.filter(|u| *u != NONE));
            some.first.push(some.neighbours.len() as u32);
        }
        some
    }

    /// The vertices with which `v` shares an edge.
    #[inline]
    pub fn neighbours(&self, v: u32) -> &[u32] {
        &self.neighbours[self.first[v as usize] as usize..self.first[v as usize + 1] as usize]
    }

    /// Checks the edges of the vertices that the faces around a collapse would hold, as just recorded in
    /// `samples`. Edges that do not stay close are added to `far`.
    pub fn verdict(
        &self,
        samples: &SamplesByFace,
        change: &CollapseChange<'_>,
        tolerance: &LocalTolerance,
        far: &mut FarEdges,
    ) -> EdgeVerdict {
        far.clear(change.after.len());
        let n = self.first.len() as u32 - 1;
        let position_of = |face: u32| change.after.iter().position(|(f, _)| *f == face);
        let mut verdict = EdgeVerdict::Near;
        for &(v, face) in samples.reassignments() {
            // Only vertices of the original have edges.
            if v >= n {
                continue;
            }
            let Some(from) = position_of(face) else { continue };
            for &u in self.neighbours(v) {
                let edge = [v, u].map(|v| samples.at(v));
                let to = match samples.pending_holder(u) {
                    // Each edge is checked from one end only.
                    Some(_) if u < v => continue,
                    // One triangle holds both ends and is convex: no point of the edge is farther from it
                    // than they are.
                    Some(face) if face == change.after[from].0 => continue,
                    Some(face) => position_of(face),
                    None => {
                        let outside = samples.holder(u);
                        let across = |h: &u32| {
                            let t = change.surface.twin[*h as usize];
                            t != NONE && t / 3 == outside
                        };
                        let to = change.opposite.iter().position(across);
                        let side = |k: usize| [change.after[k].1[1], change.after[k].1[2]];
                        if let Some(k) = to
                            && !is_close(edge, side(k), tolerance)
                        {
                            far.add([v, u], [from, k], change.is_closed);
                            continue;
                        }
                        to
                    }
                };
                match to {
                    Some(to) if !turns_close(edge, [from, to], change, tolerance) => {
                        far.add([v, u], [from, to], change.is_closed);
                    }
                    Some(_) => {}
                    None => verdict = EdgeVerdict::Unknown,
                }
            }
        }
        if far.edges.is_empty() { verdict } else { EdgeVerdict::Far }
    }
}

/// Whether two segments come close to each other.
#[inline]
fn is_close(edge: [[f64; 3]; 2], other: [[f64; 3]; 2], tolerance: &LocalTolerance) -> bool {
    let [t, s] = closest_on_segments(edge, other, 0.0);
    let on =
        |[a, b]: [[f64; 3]; 2], t: f64| -> [f64; 3] { std::array::from_fn(|k| a[k] + t * (b[k] - a[k])) };
    let (p, q) = (on(edge, t), on(other, s));
    let offset: [f64; 3] = std::array::from_fn(|k| p[k] - q[k]);
    tolerance.holds(p, dot(offset, offset))
}

/// Whether an edge of the original comes close to all edges between two faces around the new point, in one of
/// the two directions around it.
fn turns_close(
    edge: [[f64; 3]; 2],
    [from, to]: [usize; 2],
    change: &CollapseChange<'_>,
    tolerance: &LocalTolerance,
) -> bool {
    let n = change.after.len();
    // Between a face and the next one.
    let is_near = |k: usize| is_close(edge, [change.to, change.after[k % n].1[2]], tolerance);
    // From the one face to the other on one side of the new point or on the other side, which only a closed
    // fan has.
    let (low, high) = if from < to { (from, to) } else { (to, from) };
    (low..high).all(is_near) || (change.is_closed && (high..low + n).all(is_near))
}
