//! Triangles whose limit surface is one polynomial: six triangles around each corner, or fewer if a border or
//! an infinitely sharp line cuts the others off.
//!
//! Loop's rules for six triangles around a vertex are those of the quartic box spline. They hold along a
//! border as well, with points beyond it that complete parallelograms: with `p = a + b − c` for each triangle
//! `a, b, c` whose side `a, b` is on the border, the rules for smooth vertices and edges are those for
//! creases. The same holds at a corner of one triangle, with the points opposite to its neighbours.
//!
//! Source: M.-J. Lai, *Fortran subroutines for B-nets of box splines on three- and four-directional meshes*,
//! 1992, for the control points; J. Schweitzer, *Analysis and application of subdivision surfaces*, 1996, for
//! the points beyond borders.
use super::super::INFINITELY_SHARP;
use super::super::vertex_rule::{CagePoint, plus};
use super::face_one_ring::{CageTopology, FaceOneRing};
use super::quartic::Quartic;

/// The lattice points that determine a triangle between `(0, 0)`, `(1, 0)` and `(0, 1)`.
const LATTICE: [[i32; 2]; 12] =
    [[0, 0], [1, 0], [0, 1], [1, 1], [-1, 1], [1, -1], [-1, 0], [0, -1], [2, -1], [2, 0], [0, 2], [-1, 2]];

/// The six directions of the lattice, counter-clockwise.
const DIRECTIONS: [[i32; 2]; 6] = [[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]];

/// Weights of points in the control point of `λ₀ⁱλ₁ʲλ₂ᵏ`, in 24ths: that of the corner 0.
fn own(i: usize, j: usize, k: usize) -> f64 {
    let (low, high) = if j < k { (j, k) } else { (k, j) };
    match (i, low, high) {
        (4, ..) | (3, ..) => 12.0,
        (2, 1, 1) => 10.0,
        (2, ..) => 8.0,
        (1, 0, 3) => 4.0,
        (1, ..) => 6.0,
        (_, 0, 4) => 2.0,
        (_, 1, 3) => 3.0,
        _ => 4.0,
    }
}

/// The weight of the point across the side between the corners 1 and 2.
fn across(i: usize, j: usize, k: usize) -> f64 {
    let (low, high) = if j < k { (j, k) } else { (k, j) };
    match (i, low, high) {
        (0, 0, 4) => 2.0,
        (0, 1, 3) => 3.0,
        (0, 2, 2) => 4.0,
        (1, ..) => 1.0,
        _ => 0.0,
    }
}

/// The weight of a point beyond a corner, opposite to another corner, by the exponents of the corner and of
/// the third one.
fn beyond(corner: usize, third: usize) -> f64 {
    match (corner, third) {
        (4, 0) => 2.0,
        (3, 1) => 1.0,
        _ => 0.0,
    }
}

impl FaceOneRing {
    /// The polynomial of its triangle's limit surface, if it is one polynomial.
    pub(super) fn quartic(&self) -> Option<Quartic> {
        let p = self.lattice(&self.topology())?;
        let mut control = [[0.0; 3]; 15];
        let mut index = 0;
        for k in 0..5_usize {
            for j in 0..5 - k {
                let i = 4 - j - k;
                let shares = [
                    own(i, j, k),
                    own(j, k, i),
                    own(k, i, j),
                    across(i, j, k),
                    across(j, k, i),
                    across(k, i, j),
                    beyond(i, k),
                    beyond(i, j),
                    beyond(j, i),
                    beyond(j, k),
                    beyond(k, j),
                    beyond(k, i),
                ];
                let sum = p.iter().zip(shares).fold([0.0; 3], |sum, (p, share)| plus(sum, share, *p));
                control[index] = sum.map(|x| x / 24.0);
                index += 1;
            }
        }
        Some(Quartic { control })
    }

    /// The points of the lattice; those beyond cuts are reconstructed.
    fn lattice(&self, parts: &CageTopology) -> Option<[CagePoint; 12]> {
        let mut points: [Option<CagePoint>; 12] = [None; 12];
        // The vertices of the triangle, and for each the direction of its first edge.
        for (k, direction) in [0, 2, 4].into_iter().enumerate() {
            let around = self.one_ring_of_six(parts, k)?;
            let corner_point = &mut points[k];
            *corner_point = corner_point.or(Some(self.cage().positions[self.cage().corners[k] as usize]));
            for (turn, point) in around.into_iter().enumerate() {
                let step = DIRECTIONS[(direction + turn) % 6];
                let at = [0, 1].map(|i| LATTICE[k][i] + step[i]);
                let index = LATTICE.iter().position(|point| *point == at)?;
                points[index] = points[index].or(Some(point));
            }
        }
        let mut lattice_points = [[0.0; 3]; 12];
        for (target, point) in lattice_points.iter_mut().zip(points) {
            *target = point?;
        }
        Some(lattice_points)
    }

    /// The six points around a corner of its triangle, counter-clockwise from the end of the edge that starts
    /// at the corner.
    fn one_ring_of_six(&self, parts: &CageTopology, corner: usize) -> Option<[CagePoint; 6]> {
        let cage = self.cage();
        let vertex = cage.corners[corner];
        let vertex_sharpness = parts.sharp.vertices[vertex as usize];
        let around = parts.incidence.edges(vertex as usize);
        let sharpness = |edge: u32| parts.sharp.edges[edge as usize];
        let is_cut = |edge: u32| sharpness(edge) >= INFINITELY_SHARP;
        // A sharpness that ends after some rounds makes the surface piecewise.
        let ends = |x: f64| x > 0.0 && x < INFINITELY_SHARP;
        if ends(vertex_sharpness) || around.iter().any(|edge| ends(sharpness(*edge))) {
            return None;
        }
        let n_cut = around.iter().filter(|edge| is_cut(**edge)).count();
        // The edges of a face that leave the vertex and arrive at it, and the vertices at their other ends.
        let sides = |face: u32| {
            let vertices = cage.face(face as usize);
            let k = vertices.iter().position(|v| *v == vertex)?;
            let begin = cage.begin(face as usize);
            let edge = |k: usize| parts.edges.of_corner[begin + k % 3];
            Some(([edge(k), edge(k + 2)], [vertices[(k + 1) % 3], vertices[(k + 2) % 3]]))
        };
        let next = |face: u32, edge: u32| {
            let on = parts.edges.faces(edge as usize);
            (on.len() == 2).then(|| if on[0] == face { on[1] } else { on[0] })
        };
        let at = |v: u32| cage.positions[v as usize];
        // Walk forwards until the ring closes or is cut, then backwards.
        let mut ring: [Option<CagePoint>; 6] = [None; 6];
        let (edges, neighbours) = sides(0)?;
        (ring[0], ring[1]) = (Some(at(neighbours[0])), Some(at(neighbours[1])));
        let (mut face, mut edge, mut last) = (0, edges[1], 1);
        let is_closed = loop {
            if is_cut(edge) {
                break false;
            }
            face = next(face, edge)?;
            let (edges, neighbours) = sides(face)?;
            // The neighbour runs along the edge in the same direction: not one orientation.
            if edges[0] != edge {
                return None;
            }
            if face == 0 {
                break true;
            }
            last += 1;
            // The last face leads back to the first neighbour.
            if last > 6 {
                return None;
            }
            if last < 6 {
                ring[last] = Some(at(neighbours[1]));
            }
            edge = edges[1];
        };
        if is_closed {
            let is_regular = last == 6 && n_cut == 0 && vertex_sharpness == 0.0 && around.len() == 6;
            return if is_regular { all_of(ring) } else { None };
        }
        let end = edge;
        let (mut face, mut edge, mut first) = (0, edges[0], 0);
        while !is_cut(edge) {
            face = next(face, edge)?;
            let (edges, neighbours) = sides(face)?;
            first += 1;
            if edges[1] != edge || last + first > 3 {
                return None;
            }
            ring[6 - first] = Some(at(neighbours[0]));
            edge = edges[0];
        }
        let here = at(vertex);
        let is_corner = vertex_sharpness >= INFINITELY_SHARP || n_cut > 2;
        // Counted from the cut at which the ring starts.
        let point = |k: usize| ring[(k + 6 - first) % 6];
        // Completes a parallelogram, or reflects in the vertex.
        let mirror = |a: CagePoint, b: CagePoint| [0, 1, 2].map(|k| (here[k] + a[k]) - b[k]);
        let mirrored: Vec<CagePoint> = match (last + first, is_corner) {
            // From one cut to the other. If a cut leads back to itself, the vertex is on a crease that
            // continues elsewhere.
            (3, false) if n_cut == 2 && edge != end => {
                vec![mirror(point(3)?, point(2)?), mirror(point(0)?, point(1)?)]
            }
            (1, true) => {
                let (a, b) = (point(0)?, point(1)?);
                vec![mirror(b, a), mirror(here, a), mirror(here, b), mirror(a, b)]
            }
            _ => return None,
        };
        let n_known = 6 - mirrored.len();
        for (k, point) in mirrored.into_iter().enumerate() {
            ring[(n_known + k + 6 - first) % 6] = Some(point);
        }
        all_of(ring)
    }
}

fn all_of(points: [Option<CagePoint>; 6]) -> Option<[CagePoint; 6]> {
    let mut found_points = [[0.0; 3]; 6];
    for (target, point) in found_points.iter_mut().zip(points) {
        *target = point?;
    }
    Some(found_points)
}
