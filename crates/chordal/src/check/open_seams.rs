//! Open seams: boundaries that nearly coincide.
use super::connectivity::MeshConnectivity;
use super::finding::{Finding, Witness};
use super::point_tree::PointTree;
use crate::explicit::{Twin, next_in_face, position_id_by_bits};
use crate::math::{Box3, greater, lesser};
use std::collections::BTreeMap;

/// Boundary vertices that nearly coincide with others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OpenSeams {
    /// The vertices, each position once.
    pub vertices: Finding,
    /// The largest distance of one of them from its nearest, rounded up; 0 if there are none. Welding within
    /// it closes the seams.
    pub gap: f64,
}

/// A seam is open by at most this share of the shortest boundary edges at both of its vertices. Chosen:
/// a mesh resolves intended gaps with edges that are not a thousand times as long.
const SHARE_OF_EDGE: f64 = 1.0 / 1024.0;
/// It is also open by at most this share of the diagonal of the box around the mesh. Chosen: 15 µm a metre is
/// less than scanners and printers resolve, and much more than the rounding of single precision.
const SHARE_OF_BOX: f64 = 1.0 / 65_536.0;

/// A position on the boundary.
struct BoundaryVertex {
    row: u32,
    /// The shortest boundary edge there.
    shortest: f64,
}

impl MeshConnectivity<'_> {
    /// Boundary vertices that nearly coincide with others: within a 1024th of the boundary edges there, and a 65,536th
    /// of the diagonal of the mesh's box. n log n for n of them.
    #[must_use]
    pub fn open_seams(&self) -> OpenSeams {
        let mesh = self.mesh;
        let at = |row: u32| mesh.positions()[row as usize];
        let mut boundary: BTreeMap<u32, BoundaryVertex> = BTreeMap::new();
        for h in 0..3 * self.n_faces() {
            if self.twins.get(h) != Twin::Boundary {
                continue;
            }
            let rows = [h, next_in_face(h)].map(|h| self.origin_row(h));
            // The shortest boundary edge at a vertex tells how fine the mesh is there, and with it
            // which gaps are intended.
            let length = distance_up(at(rows[0]), at(rows[1]));
            for row in rows {
                let vertex =
                    boundary.entry(self.id(row)).or_insert(BoundaryVertex { row, shortest: f64::INFINITY });
                vertex.shortest = lesser(length, vertex.shortest);
            }
        }
        let vertices: Vec<BoundaryVertex> = boundary.into_values().collect();
        let points: Vec<[f64; 3]> = vertices.iter().map(|vertex| at(vertex.row)).collect();
        let (distinct, longest) = distinct_places(&points, &vertices);
        let tree = PointTree::new(&distinct);
        let most = SHARE_OF_BOX * mesh.bounds().diagonal();
        let mut seams = OpenSeams::default();
        for (vertex, p) in vertices.iter().zip(&points) {
            // Fine enough for this vertex; `longest` asks the same of the vertices at the other point.
            let within = lesser(SHARE_OF_EDGE * vertex.shortest, most);
            let mut nearest = f64::INFINITY;
            tree.near_segment([*p, *p], within, |j| {
                let j = j as usize;
                let apart = distance_up(*p, distinct[j]);
                // Equal positions are another defect, with another repair.
                if apart > 0.0 && apart <= within && apart <= SHARE_OF_EDGE * longest[j] {
                    nearest = lesser(apart, nearest);
                }
            });
            if nearest < f64::INFINITY {
                seams.gap = greater(nearest, seams.gap);
                seams.vertices.add(|| Witness::vertex(mesh, vertex.row));
            }
        }
        seams
    }
}

/// The points of vertices, and for each the longest of their shortest edges. Vertices at one position are one
/// point of the tree, so that thousands of them are found as one.
fn distinct_places(points: &[[f64; 3]], vertices: &[BoundaryVertex]) -> (Vec<[f64; 3]>, Vec<f64>) {
    let point_ids = position_id_by_bits(points);
    let (mut distinct, mut longest) = (Vec::new(), Vec::<f64>::new());
    let mut number = vec![0_usize; points.len()];
    for (i, (point_id, vertex)) in point_ids.iter().zip(vertices).enumerate() {
        // The id is the index of the first point at the position, so that one has its number by
        // now.
        if *point_id as usize == i {
            number[i] = distinct.len();
            distinct.push(points[i]);
            longest.push(vertex.shortest);
        } else {
            let longest = &mut longest[number[*point_id as usize]];
            *longest = greater(vertex.shortest, *longest);
        }
    }
    (distinct, longest)
}

/// An upper bound on the distance of two points; 0 if they are equal.
fn distance_up(a: [f64; 3], b: [f64; 3]) -> f64 {
    if a == b {
        return 0.0;
    }
    let side = std::array::from_fn(|k| (a[k] - b[k]).abs().next_up());
    Box3 { min: [0.0; 3], max: side }.diagonal()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::{Mesh, Topology};

    fn found(mesh: &Mesh) -> OpenSeams {
        MeshConnectivity::new(mesh, Topology::Positions).open_seams()
    }

    /// A strip of n squares bent to a tube, whose last column is off its first by `gap`.
    fn tube(n: u32, gap: f64) -> Mesh {
        let angle = |i: u32| 2.0 * std::f64::consts::PI * f64::from(i) / f64::from(n);
        let column = |i: u32| {
            let (sin, cos) = if i == n { (0.0, 1.0) } else { angle(i).sin_cos() };
            let off = if i == n { gap } else { 0.0 };
            [0.0, 1.0].map(|z| [cos, sin - off, z])
        };
        let cell = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]];
        Mesh::new((0..=n).flat_map(column).collect(), (0..n).flat_map(cell).collect()).expect("a tube")
    }

    #[test]
    fn vertices_at_one_place_are_searched_as_one() {
        let vertices = [1.0, 3.0, 2.0, 5.0].map(|shortest| BoundaryVertex { row: 0, shortest });
        let points = [[0.0; 3], [-0.0, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0]];
        let (distinct, longest) = distinct_places(&points, &vertices);
        assert_eq!((distinct, longest), (vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![3.0, 5.0]));
    }

    #[test]
    fn a_seam_that_is_open_by_a_rounding_is_found_with_its_gap() {
        for gap in [2.4e-16, 1e-9, 1e-5] {
            let seam = found(&tube(32, gap));
            assert_eq!(seam.vertices.count, 4, "{gap}");
            assert!(seam.gap >= gap && seam.gap < gap * 1.5, "{gap}: {}", seam.gap);
        }
    }

    #[test]
    fn what_is_closed_or_apart_on_purpose_is_none() {
        for gap in [0.0, 1e-3, 0.1] {
            assert_eq!(found(&tube(32, gap)), OpenSeams::default(), "{gap}");
        }
        // Fine edges beside a gap that they resolve.
        assert_eq!(found(&tube(100_000, 1e-6)), OpenSeams::default());
        // The range of numbers.
        for scale in [1e-300, 1e300] {
            let mesh = tube(8, 1e-9);
            let scaled = mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect();
            assert_eq!(found(&mesh.with_positions(scaled).expect("finite")).vertices.count, 4, "{scale}");
        }
    }
}
