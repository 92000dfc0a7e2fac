//! Boxes with rounded edges and corners, balls, and capsules.
use super::arcs::{quarter, quarter_sides};
use super::{FormMesh, ROUNDING};
use crate::explicit::adjacency::{Twin, Twins, previous_in_face};
use crate::explicit::{Mesh, Topology};
use crate::math::{add_up, cross, difference, div_up, dot, length as norm, mul_up, sub_down, sub_up};
use std::collections::BTreeMap;

/// The most additional sides of a quarter that are tried, beyond those of a circle. Measured: the middle of an octant takes
/// half as many again.
const MOST_TRIALS: u32 = 1 << 14;

/// All points nearer than a radius to the box of these half sizes, some of which may be 0.
///
/// If there are flat or straight parts, vertices lie on the surface, so that these parts stay flush. The vertices of a ball
/// lie outside of it by as much as its triangles are inside.
pub(super) fn rounded_cuboid(half: [f64; 3], radius: f64, length: f64) -> Option<FormMesh> {
    let is_ball = half == [0.0; 3];
    let error_of = |n: u32| {
        let sagitta = octant_sagitta(n);
        // Vertices at 1 + d and the middles of triangles at (1 + d)(1 − s) are equally far from the sphere,
        // on both sides, with d = s / (2 − s).
        let distance = if is_ball { sagitta / (2.0 - sagitta) } else { sagitta };
        // Corners have to move farther until the middles of triangles are on the sphere ([`super::PROOF_MARGIN`]).
        mul_up(distance, div_up(1.0, sub_down(1.0, sagitta)))
    };
    // Triangles of an octant are up to √2 times as long as sides of a circle, and their error is up to twice as large; half
    // of that if corners lie outside.
    let mut n = quarter_sides(radius, if is_ball { length } else { 0.5 * length })?;
    let first = n;
    let mut error = error_of(n);
    while radius * error + ROUNDING * radius > length {
        n += 1;
        error = error_of(n);
        if n > first + MOST_TRIALS {
            return None;
        }
    }
    let sagitta = octant_sagitta(n);
    let vertex_radius = if is_ball { radius * (1.0 + sagitta / (2.0 - sagitta)) } else { radius };
    let mut builder = RoundedBuilder {
        half,
        radius: vertex_radius,
        n,
        quarter: quarter(n),
        rows: BTreeMap::new(),
        positions: Vec::new(),
    };
    let faces = builder.faces();
    Some(FormMesh { positions: builder.positions, faces, error: mul_up(radius, error) })
}

/// All points nearer than a radius to the segment between two points.
///
/// Its mesh is the convex hull of the mesh of a ball at both ends, which is the Minkowski sum of that mesh and the segment.
/// The distance of two convex solids is the largest difference of their support functions; the segment adds the same to
/// both, so the error of the capsule is that of its ball. Balls have the same orientation whatever the direction, so that
/// rods that end in one point share the triangles there, and cuts leave no slivers.
///
/// Source: R. Schneider, *Convex Bodies: The Brunn–Minkowski Theory*, 1993.
pub(super) fn capsule([a, b]: [[f64; 3]; 2], radius: f64, length: f64) -> Option<FormMesh> {
    let ball = rounded_cuboid([0.0; 3], radius, length)?;
    let error = ball.error;
    let ball = Mesh::new(ball.positions, ball.faces).ok()?;
    let twins = Twins::new(&ball, Topology::Indices);
    let along = difference(b, a);
    let ends = ball.faces().iter().enumerate().map(|(face, rows)| {
        let [p, q, r] = rows.map(|row| ball.positions()[row as usize]);
        let normal = cross(difference(q, p), difference(r, p));
        let is_convex = (0..3).all(|side| {
            let Twin::Pair(twin) = twins.get(3 * face as u32 + side) else { return false };
            let apex = ball.faces()[twin as usize / 3][previous_in_face(twin) as usize % 3];
            dot(normal, difference(ball.positions()[apex as usize], p)) < 0.0
        });
        is_convex.then_some(usize::from(dot(normal, along) >= 0.0))
    });
    // By face: its end of the segment. A ball that is not convex is refused, since the argument above needs convexity.
    let ends: Vec<usize> = ends.collect::<Option<_>>()?;
    let n = ball.positions().len();
    let mut rows = vec![[None; 2]; n];
    let mut positions = Vec::with_capacity(n);
    let mut at = |row: u32, end: usize| {
        *rows[row as usize][end].get_or_insert_with(|| {
            let (p, from) = (ball.positions()[row as usize], [a, b][end]);
            positions.push(std::array::from_fn(|k| from[k] + p[k]));
            positions.len() as u32 - 1
        })
    };
    let mut faces = Vec::with_capacity(ball.faces().len());
    for (face, corners) in ball.faces().iter().enumerate() {
        faces.push(corners.map(|row| at(row, ends[face])));
        for side in 0..3 {
            let Twin::Pair(twin) = twins.get(3 * face as u32 + side) else { return None };
            // Once for each side between both ends: from its face at the far end.
            if ends[face] == 1 && ends[twin as usize / 3] == 0 {
                let [p, q] = [side as usize, (side as usize + 1) % 3].map(|k| corners[k]);
                let [[p, far_p], [q, far_q]] = [p, q].map(|row| [at(row, 0), at(row, 1)]);
                faces.extend([[p, q, far_q], [p, far_q, far_p]]);
            }
        }
    }
    // Derived: for n faces, a side of a triangle is about 1/√n of the ball, with errors of some roundings of the ball, so a
    // face that is parallel to the segment within that angle may be at the wrong end.
    let tilt = 32.0 * f64::EPSILON * (ball.faces().len() as f64).sqrt();
    Some(FormMesh { positions, faces, error: add_up(error, mul_up(tilt, norm(along))) })
}

/// The direction of a point of the octant's triangular lattice, whose indices add up to n. On the sides of the octant,
/// directions are the corners of a quarter circle.
fn direction(quarter: &[[f64; 2]], index: [u32; 3]) -> [f64; 3] {
    // The sine of each share of a right angle.
    let sines = index.map(|k| quarter[k as usize][1]);
    if index.contains(&0) {
        return sines;
    }
    let size = norm(sines);
    sines.map(|x| x / size)
}

/// The largest depth below the unit sphere of the triangles of an octant with corners on it, rounded up. Every ray from the
/// middle meets a triangle, at a distance between that of the triangle's plane and 1.
fn octant_sagitta(n: u32) -> f64 {
    let quarter = quarter(n);
    let mut least = 1.0;
    for face in octant_faces(n) {
        let [a, b, c] = face.map(|index| direction(&quarter, index));
        let normal = cross(difference(b, a), difference(c, a));
        let height = dot(normal, a) / norm(normal);
        least = if height < least { height } else { least };
    }
    // Derived: corners have errors of 8 u; a plane through corners of n sides a quarter tilts by that over their distance,
    // which is above 1/n, and over the triangle's size this gives the same error again.
    let rounding = 256.0 * f64::EPSILON;
    sub_up(1.0, least) + rounding
}

/// The triangles of an octant, counter-clockwise as seen from outside, by indices along x, y and z that add up to n.
fn octant_faces(n: u32) -> impl Iterator<Item = [[u32; 3]; 3]> {
    (0..n).flat_map(move |i| {
        (0..n - i).flat_map(move |j| {
            let k = n - 1 - i - j;
            let up = [[i + 1, j, k], [i, j + 1, k], [i, j, k + 1]];
            let down = (k > 0).then(|| [[i + 1, j + 1, k - 1], [i, j + 1, k], [i + 1, j, k]]);
            std::iter::once(up).chain(down)
        })
    })
}

struct RoundedBuilder {
    half: [f64; 3],
    radius: f64,
    n: u32,
    quarter: Vec<[f64; 2]>,
    /// Rows by the bits of their coordinates: corners coincide if the box has no size along an axis.
    rows: BTreeMap<[u64; 3], u32>,
    positions: Vec<[f64; 3]>,
}

impl RoundedBuilder {
    /// The vertex of an octant's lattice point; the octant's signs are bits, set for plus.
    fn row(&mut self, octant: usize, index: [u32; 3]) -> u32 {
        let towards = direction(&self.quarter, index);
        let p: [f64; 3] = std::array::from_fn(|k| {
            let sign = if octant >> k & 1 == 1 { 1.0 } else { -1.0 };
            sign * (self.half[k] + self.radius * towards[k]) + 0.0
        });
        *self.rows.entry(p.map(f64::to_bits)).or_insert_with(|| {
            self.positions.push(p);
            self.positions.len() as u32 - 1
        })
    }

    fn faces(&mut self) -> Vec<[u32; 3]> {
        let n = self.n;
        let mut faces = Vec::new();
        for octant in 0..8_usize {
            // An odd number of minus signs mirrors the octant.
            let is_mirrored = octant.count_ones() % 2 == 0;
            for face in octant_faces(n) {
                let [a, b, c] = face.map(|index| self.row(octant, index));
                faces.push(if is_mirrored { [a, c, b] } else { [a, b, c] });
            }
        }
        // Strips along each axis, between octants that differ only in the sign of that axis.
        let half = self.half;
        for axis in (0..3).filter(|axis| half[*axis] > 0.0) {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            for low in (0..8_usize).filter(|octant| octant >> axis & 1 == 0) {
                let high = low | 1 << axis;
                let is_mirrored = (low >> next & 1) + (low >> last & 1) == 1;
                for k in 0..n {
                    let index = |k: u32| {
                        let mut index = [0; 3];
                        (index[next], index[last]) = (n - k, k);
                        index
                    };
                    let [a, b] = [k, k + 1].map(|k| self.row(low, index(k)));
                    let [c, d] = [k, k + 1].map(|k| self.row(high, index(k)));
                    let two = [[a, d, b], [a, c, d]];
                    faces.extend(two.map(|[a, b, c]| if is_mirrored { [a, b, c] } else { [a, c, b] }));
                }
            }
        }
        // Flat sides.
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            if self.half[next] == 0.0 || self.half[last] == 0.0 {
                continue;
            }
            for side in 0..2_usize {
                let mut index = [0; 3];
                index[axis] = n;
                let corner = |builder: &mut Self, a: usize, b: usize| {
                    builder.row(side << axis | a << next | b << last, index)
                };
                let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(u, v)| corner(self, u, v));
                faces.extend(if side == 1 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
        faces
    }
}
