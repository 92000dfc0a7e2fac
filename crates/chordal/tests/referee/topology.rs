//! What hangs together: edges, boundary loops, T-junctions and degenerate triangles of a mesh, counted from
//! scratch.
use chordal::Mesh;
use chordal_testkit::sampler::{Point, cross, distance, dot, norm, sub};
use std::collections::{BTreeMap, BTreeSet};

/// A mesh by distinct positions.
pub struct Topology {
    pub positions: Vec<Point>,
    pub faces: Vec<[u32; 3]>,
    /// Each undirected edge with the number of faces on it.
    edges: Vec<([u32; 2], usize)>,
}

impl Topology {
    /// Of a library mesh, its vertices tied by position id.
    pub fn of(mesh: &Mesh) -> Self {
        let tied = |face: &[u32; 3]| face.map(|i| mesh.position_of(i));
        Self::new(mesh.positions().to_vec(), mesh.faces().iter().map(tied).collect())
    }

    pub fn new(positions: Vec<Point>, faces: Vec<[u32; 3]>) -> Self {
        let sides = faces.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
        let mut all: Vec<[u32; 2]> = sides.map(|[s, e]| [s.min(e), s.max(e)]).collect();
        all.sort_unstable();
        let edges = all.chunk_by(|a, b| a == b).map(|same| (same[0], same.len())).collect();
        Self { positions, faces, edges }
    }

    /// Edges with exactly one face.
    pub fn boundary(&self) -> Vec<[u32; 2]> {
        self.edges.iter().filter(|(_, n)| *n == 1).map(|(edge, _)| *edge).collect()
    }

    /// The number of closed loops of the boundary, or why it is not made of such.
    pub fn boundary_loops(&self) -> Result<usize, String> {
        let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for [a, b] in self.boundary() {
            next.entry(a).or_default().push(b);
            next.entry(b).or_default().push(a);
        }
        if let Some((at, ends)) = next.iter().find(|(_, ends)| ends.len() != 2) {
            return Err(format!("{} boundary edges meet at vertex {at}", ends.len()));
        }
        let mut seen = BTreeSet::new();
        let mut loops = 0;
        for &start in next.keys() {
            let mut at = start;
            loops += usize::from(!seen.contains(&at));
            while seen.insert(at) {
                at = next[&at].iter().copied().find(|n| !seen.contains(n)).unwrap_or(start);
            }
        }
        Ok(loops)
    }

    /// Edges with more than two faces.
    pub fn crowded_edges(&self) -> usize {
        self.edges.iter().filter(|(_, n)| *n > 2).count()
    }

    /// Faces that name a vertex twice, have two corners in one place, or no area.
    pub fn degenerate_faces(&self) -> usize {
        let flat = |[a, b, c]: &[u32; 3]| {
            let [p, q, r] = [a, b, c].map(|i| self.positions[*i as usize]);
            let (u, v) = (sub(q, p), sub(r, p));
            p == q || q == r || r == p || norm(cross(u, v)) == 0.0
        };
        self.faces.iter().filter(|f| flat(f)).count()
    }

    /// Vertices of the boundary that lie in the interior of another boundary edge, closer to it than `near`.
    pub fn t_junctions(&self, near: f64) -> usize {
        let boundary = self.boundary();
        let mut points: Vec<u32> = boundary.iter().flatten().copied().collect();
        points.sort_unstable();
        points.dedup();
        // Sorted along x, so that an edge looks only at the points beside it.
        let x = |i: u32| self.positions[i as usize][0];
        points.sort_by(|a, b| x(*a).total_cmp(&x(*b)));
        let on = |[a, b]: &[u32; 2]| {
            let (low, high) = (x(*a).min(x(*b)) - near, x(*a).max(x(*b)) + near);
            let first = points.partition_point(|p| x(*p) < low);
            let beside = points[first..].iter().take_while(|p| x(**p) <= high);
            beside.filter(|p| *p != a && *p != b && self.is_between(**p, [*a, *b], near)).count()
        };
        boundary.iter().map(on).sum()
    }

    fn is_between(&self, p: u32, edge: [u32; 2], near: f64) -> bool {
        let [p, a, b] = [p, edge[0], edge[1]].map(|i| self.positions[i as usize]);
        let along = sub(b, a);
        let t = dot(sub(p, a), along) / dot(along, along);
        let foot = std::array::from_fn(|k| a[k] + t * along[k]);
        t > 0.0 && t < 1.0 && distance(p, foot) <= near
    }
}
