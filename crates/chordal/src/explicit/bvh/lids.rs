//! `Lids`: triangles that close an open mesh. The mesh with its lids winds around a point an integer number
//! of times, which a ray counts exactly; subtracting the lids gives the winding number of the mesh alone. A
//! mesh with few open edges has few lids, so its winding number costs about as much as that of a closed mesh.
//!
//! Source: the cone over a cycle has the cycle as its border, hence it forms a closed surface together with
//! any other surface of that border; the winding number is linear (A. Jacobson, L. Kavan, O. Sorkine-Hornung,
//! *Robust inside-outside segmentation using generalized winding numbers*, 2013).
use super::Bvh;
use super::WIDTH;
use super::winding::{ClusterMoments, WindingNumber, moments};
use crate::budget::Job;
use crate::explicit::{DisjointSets, Mesh, Topology};

/// The smallest number of faces per lid. Chosen: with fewer, the lids cost as much as the mesh.
const FACES_A_LID: usize = 4;

/// The lids with their tree.
#[derive(Clone, Debug)]
pub(super) struct Lids {
    bvh: Bvh,
    moments: Vec<[ClusterMoments; WIDTH]>,
}

impl Lids {
    /// Cones over the open edges, with an apex for each connected piece; `None` if there are too many.
    pub(super) fn new(mesh: &Mesh) -> Option<Self> {
        let edges = open_edges(mesh);
        let n_lids = edges.iter().fold(0_usize, |n, edge| n.saturating_add(edge.times as usize));
        if edges.is_empty() || n_lids > mesh.faces().len() / FACES_A_LID {
            return None;
        }
        // 1. Rows of the edges' ends, and their connected pieces.
        let mut rows: Vec<u32> = edges.iter().flat_map(|edge| edge.rows).collect();
        rows.sort_unstable();
        rows.dedup();
        let number = |row: u32| rows.partition_point(|other| *other < row) as u32;
        let mut joined = DisjointSets::new(rows.len());
        edges.iter().for_each(|edge| joined.union(number(edge.rows[0]), number(edge.rows[1])));
        let (piece, n_pieces) = joined.labels();
        // 2. An apex for each piece: the mean of its points.
        let mut positions: Vec<[f64; 3]> = rows.iter().map(|row| mesh.positions()[*row as usize]).collect();
        let mut sums = vec![([0.0; 3], 0.0); n_pieces];
        for (p, piece) in positions.iter().zip(&piece) {
            let (sum, n) = &mut sums[*piece as usize];
            (0..3).for_each(|k| sum[k] += p[k]);
            *n += 1.0;
        }
        positions.extend(sums.into_iter().map(|(sum, n)| sum.map(|x| x / n)));
        // 3. A lid runs along its edge in the opposite direction.
        let mut faces = Vec::with_capacity(n_lids);
        for edge in &edges {
            let [a, b] = edge.rows.map(number);
            let lid = [b, a, rows.len() as u32 + piece[a as usize]];
            faces.extend(std::iter::repeat_n(lid, edge.times as usize));
        }
        let lids = Mesh::new(positions, faces).ok()?;
        let bvh = Bvh::build(&lids, &Job::default()).ok()?;
        let moments = moments(&bvh);
        Some(Self { bvh, moments })
    }

    /// The winding number of the mesh around `p`, if the triangles of the mesh above `p` count `above`; with
    /// an error of at most `within`, unless roundings alone are more. `None` if `p` is on a lid.
    pub(super) fn winding_of_mesh(&self, p: [f64; 3], above: i32, within: f64) -> Option<WindingNumber> {
        let q = self.bvh.scaled_query(p)?;
        let closed = f64::from(above.checked_add(self.bvh.winding_above(q)?)?);
        let lids = self.bvh.winding_by(&self.moments, q, within);
        let value = closed - lids.value;
        // The difference is rounded by half a unit.
        Some(WindingNumber { value, off_at_most: lids.off_at_most + f64::EPSILON * value.abs() })
    }
}

/// An edge with more half-edges of a mesh, by position, in one direction than in the other.
pub(crate) struct OpenEdge {
    /// The rows of its ends, in the direction of more half-edges.
    pub rows: [u32; 2],
    /// The number of surplus half-edges.
    pub times: u32,
}

/// The edges at which a mesh is not closed, by position. They form cycles. O(n log n).
pub(crate) fn open_edges(mesh: &Mesh) -> Vec<OpenEdge> {
    let Some(ids) = Topology::Positions.ids(mesh) else { return Vec::new() };
    let mut halves: Vec<(u32, u32, i32)> = Vec::with_capacity(3 * mesh.faces().len());
    for face in mesh.faces() {
        for k in 0..3 {
            let (a, b) = (ids[face[k] as usize], ids[face[(k + 1) % 3] as usize]);
            if a != b {
                halves.push(if a < b { (a, b, 1) } else { (b, a, -1) });
            }
        }
    }
    halves.sort_unstable();
    let mut row_of = vec![u32::MAX; mesh.positions().len()];
    for (row, id) in ids.iter().enumerate().rev() {
        row_of[*id as usize] = row as u32;
    }
    let mut edges = Vec::new();
    for same in halves.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        // Faces that run along an edge in opposite directions cancel, so an edge with four faces may be closed, and
        // one with three never is.
        let net: i32 = same.iter().map(|half| half.2).sum();
        if net != 0 {
            let [a, b] = [same[0].0, same[0].1].map(|id| row_of[id as usize]);
            edges.push(OpenEdge { rows: if net > 0 { [a, b] } else { [b, a] }, times: net.unsigned_abs() });
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of rings without its top and bottom rows, and with a hole in its side.
    fn broken_ball() -> Mesh {
        const N: u32 = 24;
        let corner = |i: u32, j: u32| {
            let (a, b) = (f64::from(i) / f64::from(N), f64::from(j) / f64::from(2 * N));
            let (a, b) = (a * std::f64::consts::PI, b * std::f64::consts::TAU);
            [libm::sin(a) * libm::cos(b), libm::sin(a) * libm::sin(b), libm::cos(a)]
        };
        let row = |i: u32, j: u32| 2 * N * i + j % (2 * N);
        let positions = (0..=N).flat_map(|i| (0..2 * N).map(move |j| corner(i, j))).collect();
        let faces = (1..N - 1).flat_map(|i| (0..2 * N).map(move |j| (i, j)));
        let faces = faces.filter(|(i, j)| !(8..11).contains(i) || !(3..6).contains(j)).flat_map(|(i, j)| {
            [[row(i, j), row(i + 1, j), row(i + 1, j + 1)], [row(i, j), row(i + 1, j + 1), row(i, j + 1)]]
        });
        Mesh::new(positions, faces.collect()).unwrap()
    }

    #[test]
    fn the_winding_number_with_lids_is_that_of_the_triangles() {
        let mesh = broken_ball();
        let bvh = Bvh::build(&mesh, &Job::default()).unwrap();
        let lids = Lids::new(&mesh).unwrap();
        let mut counts = [0; 2];
        for step in 0..4000_u32 {
            let at = |n: u32| f64::from(step * n % 4001) / 2000.0 - 1.0;
            let p = [1.3 * at(1), 1.3 * at(37), 1.3 * at(1013)];
            let plain = bvh.winding_number_plain(p).unwrap();
            let above = bvh.winding_above(bvh.scaled_query(p).unwrap()).unwrap();
            for within in [1.0 / 16.0, 1e-9] {
                let Some(winding) = lids.winding_of_mesh(p, above, within) else { continue };
                assert!(winding.off_at_most <= within, "{p:?}: {winding:?}");
                let difference = (winding.value - plain.value).abs();
                assert!(
                    difference <= winding.off_at_most + plain.off_at_most,
                    "{p:?}: {winding:?} {plain:?}"
                );
                counts[usize::from(plain.value > 0.5)] += 1;
            }
        }
        assert!(counts[0] > 3000 && counts[1] > 1000, "{counts:?}");
    }

    #[test]
    fn a_soup_has_no_lids() {
        let positions = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
        assert!(Lids::new(&Mesh::new(positions, vec![[0, 1, 2]; 8]).unwrap()).is_none());
    }
}
