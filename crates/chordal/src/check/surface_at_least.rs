//! The largest distance from sample points to a mesh, bounded from below: the `at_least` of a `Bound`.
//!
//! # Why the bound holds
//! A candidate for the closest point bounds a distance from *above*. From below, a direction does: all of a
//! triangle lies on the near side of the plane with normal `n` through its corner `v` with the least
//! `n·(p − v)`, hence
//!
//! `distance(p, triangle) ≥ min over the corners of n·(p − v) / |n|` for **any** `n ≠ 0`,
//!
//! with equality where `n` points from the closest point of the triangle to `p`. So the directions below may
//! be rounded, and found in any way that usually finds good ones; only one formula needs care. With
//! `u = 2⁻⁵³` the sum of the three products takes four roundings a term: the difference, the product, two
//! sums. Hence, with the computed sum `s` and the computed sum `a` of the same terms without signs,
//!
//! `|s − n·(p − v)| ≤ ((1 + u)⁴ − 1)/(1 − u)⁴·a + what underflows < 5u·a + 2⁻¹⁰⁷⁰`,
//!
//! which `6u·a + 2⁻¹⁰²²` covers together with the rounding of that product and sum. An overflow makes the
//! result zero.
use crate::budget::over_chunks;
use crate::explicit::Mesh;
use crate::math::{Box3, add_down, add_up, div_down, greater, lesser, mul_down, mul_up, sqrt_up, sub_down};
use glam::DVec3;

/// Consecutive triangles with one box. Measured on a torus of a million triangles in the order of its grid:
/// 32 to 128 differ by a tenth.
const CHUNK: usize = 64;

/// The largest of the distances from the `points` to `mesh`, bounded from below including all rounding, and
/// the index of the point where it is attained. `None` without points or without triangles.
///
/// If the points, taken exactly, are on the true surface, the mesh deviates by at least this.
///
/// One pass over the triangles for their boxes and one over the boxes for each point: meant for a handful of
/// points, and triangles in an order in which most neighbours are close. Then about 5 ns a triangle for 16
/// points on one core; in random order 0.3 µs, since every triangle is tested for every point.
///
/// ```
/// use chordal::{Mesh, check::surface_at_least};
/// let corners = vec![[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
/// let mesh = Mesh::new(corners, vec![[0, 1, 2]])?;
/// let (off, point) = surface_at_least(&[[1.0, 1.0, 0.25], [1.0, 1.0, -0.5]], &mesh).unwrap();
/// assert!(point == 1 && off <= 0.5 && off > 0.499_999_999_999);
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
#[must_use]
pub fn surface_at_least(points: &[[f64; 3]], mesh: &Mesh) -> Option<(f64, usize)> {
    if mesh.faces().is_empty() {
        return None;
    }
    let boxes = chunk_boxes(mesh);
    let mut best = None;
    for (number, point) in points.iter().enumerate() {
        let largest = best.map_or(-1.0, |(distance, _)| distance);
        let distance = PointDistanceSearch { point: *point, mesh, boxes: &boxes, largest }.run();
        if distance > largest {
            best = Some((distance, number));
        }
    }
    best
}

/// The box of each chunk of triangles.
fn chunk_boxes(mesh: &Mesh) -> Vec<Box3> {
    // Many boxes a task, so that scheduling costs nothing.
    let parts = over_chunks(mesh.faces(), 256 * CHUNK, |_, faces| {
        let of_chunk = |chunk: &[[u32; 3]]| {
            Box3::from_points(chunk.as_flattened().iter().map(|&row| &mesh.positions()[row as usize]))
        };
        faces.chunks(CHUNK).map(of_chunk).collect::<Vec<_>>()
    });
    parts.concat()
}

/// The search for the distance of one point.
struct PointDistanceSearch<'a> {
    point: [f64; 3],
    mesh: &'a Mesh,
    boxes: &'a [Box3],
    /// The distance of another point: distances below it are of no use.
    largest: f64,
}

impl PointDistanceSearch<'_> {
    /// A lower bound on the distance to the mesh; any number up to `largest` if the bound is no more than
    /// that.
    fn run(&self) -> f64 {
        let squares: Vec<f64> = self.boxes.iter().map(|b| box_distance_sq(self.point, b)).collect();
        // The chunk with the nearest box goes first: its bound is likely to exclude most of the
        // others.
        let nearest = (0..squares.len()).fold(0, |near, i| if squares[i] < squares[near] { i } else { near });
        let mut distance = self.over_chunk(nearest, f64::INFINITY);
        for (chunk, &square) in squares.iter().enumerate() {
            if distance <= self.largest {
                return distance;
            }
            // A chunk farther than `distance` is skipped, since `distance` bounds the distance to it as well.
            if square < mul_up(distance, distance) {
                distance = self.over_chunk(chunk, distance);
            }
        }
        distance
    }

    /// The minimum of `distance` and the bounds for the triangles of one chunk.
    fn over_chunk(&self, chunk: usize, mut distance: f64) -> f64 {
        let faces = self.mesh.faces();
        let start = chunk * CHUNK;
        for face in start..faces.len().min(start + CHUNK) {
            let corners = self.mesh.corners(face);
            if box_distance_sq(self.point, &Box3::from_points(&corners)) < mul_up(distance, distance) {
                let bound = triangle_at_least(self.point, corners);
                distance = lesser(bound, distance);
            }
        }
        distance
    }
}

/// The squared distance from a point to a box, bounded from below; 0 for a point that is not finite.
fn box_distance_sq(p: [f64; 3], bounds: &Box3) -> f64 {
    let outside = |k: usize| {
        let (below, above) = (sub_down(bounds.min[k], p[k]), sub_down(p[k], bounds.max[k]));
        let most = greater(below, above);
        greater(most, 0.0)
    };
    let square = |x: f64| mul_down(x, x);
    let sum = add_down(add_down(square(outside(0)), square(outside(1))), square(outside(2)));
    greater(sum, 0.0)
}

/// The distance from a point to a triangle, bounded from below: the best of four directions, from the plane
/// and from the closest point of each side. One of them belongs to the closest point of the triangle.
pub(crate) fn triangle_at_least(p: [f64; 3], corners: [[f64; 3]; 3]) -> f64 {
    let from = corners.map(|v| DVec3::from(p) - DVec3::from(v));
    // In units of the farthest corner's distance, so that products of directions stay in the range of f64.
    let size = from.iter().fold(0.0, |most, w| greater(w.abs().max_element(), most));
    if !(size > 0.0 && size < f64::INFINITY) {
        return 0.0;
    }
    let from = from.map(|w| w / size);
    let sides = [from[0] - from[1], from[1] - from[2], from[2] - from[0]];
    let directions = [
        plane_direction(from[0], sides),
        side_direction(from[0], sides[0]),
        side_direction(from[1], sides[1]),
        side_direction(from[2], sides[2]),
    ];
    directions.iter().fold(0.0, |best, &n| {
        let bound = support(n, p, corners);
        greater(bound, best)
    })
}

/// The normal of the triangle, towards the point at `from` relative to its first corner.
fn plane_direction(from: DVec3, sides: [DVec3; 3]) -> DVec3 {
    let squares = sides.map(DVec3::length_squared);
    let longest = (1..3).fold(0, |most, k| if squares[k] > squares[most] { k } else { most });
    // From the two shorter sides, then made perpendicular to the longest, along which a tilt costs most.
    let normal = across(sides[(longest + 1) % 3].cross(sides[(longest + 2) % 3]), sides[longest]);
    if normal.dot(from) < 0.0 { -normal } else { normal }
}

/// The direction from the closest point of a side to the point at `from` relative to its first corner.
fn side_direction(from: DVec3, side: DVec3) -> DVec3 {
    let t = from.dot(side) / side.length_squared();
    if t > 0.0 && t < 1.0 {
        // Done twice: the first step leaves an error of the size of `from`, the second one of the size of the
        // result.
        across(across(from, side), side)
    } else if t >= 1.0 {
        from - side
    } else {
        from
    }
}

/// The component of `n` perpendicular to `side`.
fn across(n: DVec3, side: DVec3) -> DVec3 {
    n - side * (n.dot(side) / side.length_squared())
}

/// `min over the corners of n·(p − v)/|n|`, bounded from below as described in the module; 0 if that is
/// less or `n` is no direction.
fn support(n: DVec3, p: [f64; 3], corners: [[f64; 3]; 3]) -> f64 {
    let largest = n.abs().max_element();
    if !(largest > 0.0 && largest < f64::INFINITY) {
        return 0.0;
    }
    let n = (n / largest).to_array();
    let along = |v: [f64; 3]| {
        let term: [f64; 3] = std::array::from_fn(|k| n[k] * (p[k] - v[k]));
        let sum = (term[0] + term[1]) + term[2];
        let size = (term[0].abs() + term[1].abs()) + term[2].abs();
        // 6u = 3·ε; see the module.
        let bound = sub_down(sum, 3.0 * f64::EPSILON * size + f64::MIN_POSITIVE);
        if bound.is_finite() { bound } else { f64::NEG_INFINITY }
    };
    let least = corners.into_iter().map(along).fold(f64::INFINITY, |least, s| lesser(s, least));
    let length = sqrt_up(add_up(add_up(mul_up(n[0], n[0]), mul_up(n[1], n[1])), mul_up(n[2], n[2])));
    let bound = div_down(least, length);
    if bound > 0.0 && bound < f64::INFINITY { bound } else { 0.0 }
}
