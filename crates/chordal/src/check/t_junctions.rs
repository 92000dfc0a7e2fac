//! T-junctions: boundary vertices in the interior of a boundary edge.
use super::connectivity::MeshConnectivity;
use super::degenerate::is_collinear;
use super::finding::{Finding, MeshLocation, Witness, ends};
use super::point_tree::PointTree;
use crate::budget::Tolerance;
use crate::explicit::{Mesh, Topology, Twin, next_in_face, position_id_by_bits};
use glam::DVec3;
use std::collections::BTreeMap;

/// Finds the positions of boundary vertices that lie in the interior of a boundary edge of which they are no
/// end: the triangles on one side were split and those on the other were not. Each counts once, with the
/// first such edge.
///
/// Without `within`, *in the interior* is exact: on the line through the two ends, strictly between them.
/// That finds vertices inserted by halving an edge in place, and misses a vertex that rounding moved off the
/// line by its last bit. With a tolerance it means: the distance to the line is at most the tolerance, and
/// the projection onto it is farther than the tolerance from both ends. Lengths are rounded here, so a vertex
/// at the tolerance to the last bits may fall to either side.
///
/// n log n for n boundary edges, however many of them or of their ends coincide, unless different ones all
/// pass through one small region.
///
/// ```
/// use chordal::{Mesh, check::t_junctions, explicit::Topology};
/// let points = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, -1.0, 0.0]];
/// let mesh = Mesh::new(points, vec![[0, 1, 2], [0, 4, 3], [3, 4, 1]])?;
/// let found = t_junctions(&mesh, Topology::Indices, None);
/// assert_eq!((found.count, found.witnesses[0].at), (1, [1.0, 0.0, 0.0]));
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
#[must_use]
pub fn t_junctions(mesh: &Mesh, topology: Topology, within: Option<Tolerance>) -> Finding {
    MeshConnectivity::new(mesh, topology).t_junctions(within)
}

impl MeshConnectivity<'_> {
    /// Vertices in the interior of an edge: [`t_junctions`].
    #[must_use]
    pub fn t_junctions(&self, within: Option<Tolerance>) -> Finding {
        let mesh = self.mesh;
        // Grouped by the first of the rows at one point, so that many coincident rows are examined only once for
        // each edge.
        let mut edge_of: BTreeMap<u32, (Vec<u32>, u32)> = BTreeMap::new();
        vertices_in_edges(self, within, |rows, h| {
            edge_of.entry(rows[0]).or_insert_with(|| (rows.to_vec(), h));
        });
        let each = edge_of.into_values().flat_map(|(rows, h)| rows.into_iter().map(move |row| (row, h)));
        let mut each: Vec<(u32, u32)> = each.collect();
        // No two of these rows have the same id, so the order is unique.
        each.sort_unstable_by_key(|(row, _)| self.id(*row));
        let mut finding = Finding::default();
        for (row, h) in each {
            finding.add(|| Witness {
                place: MeshLocation::OnEdge { vertex: row, edge: ends(mesh, h), face: h / 3 },
                at: mesh.positions()[row as usize],
            });
        }
        finding
    }
}

/// Calls `visit` with the rows of vertices at one point, one for each of their positions, and a half-edge,
/// for every T-junction, edge by edge: a vertex in the interior of several edges is visited once for each.
pub(crate) fn vertices_in_edges(
    surface: &MeshConnectivity,
    within: Option<Tolerance>,
    mut visit: impl FnMut(&[u32], u32),
) {
    let mesh = surface.mesh;
    let boundary: Vec<u32> =
        (0..surface.twins.len() as u32).filter(|&h| surface.twins.get(h) == Twin::Boundary).collect();
    let rows = boundary_rows(surface, &boundary);
    let boundary_points = BoundaryPoints::new(mesh, &rows);
    let tree = PointTree::new(&boundary_points.points);
    for &h in &boundary {
        let edge = ends(mesh, h);
        let [a, b] = edge.map(|row| mesh.positions()[row as usize]);
        tree.near_segment([a, b], within.map_or(0.0, Tolerance::get), |i| {
            // The ends themselves are not inside, and neither are points with the same coordinates.
            if is_inside(boundary_points.points[i as usize], [a, b], within) {
                visit(boundary_points.rows_at(i), h);
            }
        });
    }
}

/// The points of boundary positions: positions with the same coordinates share one, so that a search near
/// thousands of them finds one point.
struct BoundaryPoints {
    points: Vec<[f64; 3]>,
    /// The start of the rows of each point, and the end of the last.
    first: Vec<u32>,
    rows: Vec<u32>,
}

impl BoundaryPoints {
    fn new(mesh: &Mesh, rows: &[u32]) -> Self {
        let points_of_rows: Vec<[f64; 3]> = rows.iter().map(|&row| mesh.positions()[row as usize]).collect();
        let mut order: Vec<(u32, u32)> = position_id_by_bits(&points_of_rows).into_iter().zip(0..).collect();
        order.sort_unstable();
        let (mut points, mut first) = (Vec::new(), Vec::new());
        for (at, (point_id, i)) in order.iter().enumerate() {
            if point_id == i {
                points.push(points_of_rows[*i as usize]);
                first.push(at as u32);
            }
        }
        first.push(order.len() as u32);
        Self { points, first, rows: order.into_iter().map(|(_, i)| rows[i as usize]).collect() }
    }

    fn rows_at(&self, point: u32) -> &[u32] {
        &self.rows[self.first[point as usize] as usize..self.first[point as usize + 1] as usize]
    }
}

/// One row for each boundary position, in the order of the positions.
fn boundary_rows(surface: &MeshConnectivity, boundary: &[u32]) -> Vec<u32> {
    let both_ends = boundary.iter().flat_map(|&h| [h, next_in_face(h)]);
    let mut rows: Vec<(u32, u32)> = both_ends.map(|h| (surface.origin(h), surface.origin_row(h))).collect();
    rows.sort_unstable();
    rows.dedup_by_key(|(id, _)| *id);
    rows.into_iter().map(|(_, row)| row).collect()
}

fn is_inside(p: [f64; 3], [a, b]: [[f64; 3]; 2], within: Option<Tolerance>) -> bool {
    match within {
        None => is_between(p, [a, b]) && is_collinear(p, a, b),
        Some(tolerance) => is_near_middle(p, [a, b], tolerance.get()),
    }
}

/// Whether a point on the line through `a` and `b` lies strictly between them.
fn is_between(p: [f64; 3], [a, b]: [[f64; 3]; 2]) -> bool {
    let strictly = |k: usize| (a[k] < p[k] && p[k] < b[k]) || (b[k] < p[k] && p[k] < a[k]);
    (0..3).all(|k| strictly(k) || (a[k] == p[k] && p[k] == b[k])) && (0..3).any(strictly)
}

fn is_near_middle(p: [f64; 3], [a, b]: [[f64; 3]; 2], tolerance: f64) -> bool {
    let [p, a, b] = [p, a, b].map(DVec3::from);
    // In units of the tolerance, which is positive, so that no square of a length near it leaves the range of
    // f64.
    let (from_a, from_b, edge) = ((p - a) / tolerance, (p - b) / tolerance, (b - a) / tolerance);
    let along = edge / edge.abs().max_element();
    let along = along / along.length();
    // From the nearer end, so that a distant end does not cost digits.
    let (from_start, from_end) = (from_a.dot(along), -from_b.dot(along));
    let offset = if from_start < from_end { from_a - along * from_start } else { from_b + along * from_end };
    from_start > 1.0 && from_end > 1.0 && offset.length() <= 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles on one another, each with rows of its own, and a vertex of as many others in an edge of each.
    fn crowd(n: u32) -> Mesh {
        let corners =
            [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0], [2.0, -1.0, 0.0], [1.0, -1.0, 0.0]];
        let positions = (0..n).flat_map(|_| corners).collect();
        let faces = (0..n).flat_map(|i| [[6 * i, 6 * i + 1, 6 * i + 2], [6 * i + 3, 6 * i + 4, 6 * i + 5]]);
        Mesh::new(positions, faces.collect()).expect("valid")
    }

    #[test]
    fn a_crowd_of_vertices_is_visited_once_for_each_edge() {
        const N: u32 = 1000;
        let mesh = crowd(N);
        let surface = MeshConnectivity::new(&mesh, Topology::Indices);
        let (mut visits, mut rows_visited) = (0, 0);
        vertices_in_edges(&surface, None, |rows, _| {
            visits += 1;
            rows_visited += rows.len() as u64;
        });
        assert_eq!((visits, rows_visited), (N, u64::from(N * N)));
        let all: Vec<u32> = (0..6 * N).collect();
        assert_eq!(BoundaryPoints::new(&mesh, &all).points.len(), 6);
        let found = surface.t_junctions(None);
        assert_eq!(found.count, u64::from(N));
        let expected = |i: u32| MeshLocation::OnEdge { vertex: 6 * i + 3, edge: [0, 1], face: 0 };
        assert!((0..).zip(&found.witnesses).all(|(i, witness)| witness.place == expected(i)));
    }
}
