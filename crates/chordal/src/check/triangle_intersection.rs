//! Exact triangle–triangle intersection, disregarding common corners and edges.
use super::exact_point::{self, on_lattice};
use crate::math::{Orientation, orient2d, orient3d};
use Orientation::{Back, Flat, Front};
use glam::DVec3;

type TriangleCorners<P = [f64; 3]> = [P; 3];

/// Points with exact predicates: by coordinates, or by integers if the coordinates span few digits.
trait ExactPoint: Copy {
    /// The side of the plane through three points on which the last one lies.
    fn orient3d(plane: [Self; 3], p: Self) -> Orientation;
    /// The side of the line through two points on which the last one lies, projected along an axis.
    fn orient2d(points: [Self; 3], axes: (usize, usize)) -> Orientation;
}

impl ExactPoint for [f64; 3] {
    fn orient3d(plane: [Self; 3], p: Self) -> Orientation {
        let [a, b, c] = plane;
        PlaneFilter::through(&plane).clear_side(p).unwrap_or_else(|| orient3d(a, b, c, p))
    }

    fn orient2d(points: [Self; 3], (x, y): (usize, usize)) -> Orientation {
        let [a, b, c] = points.map(|p| [p[x], p[y]]);
        orient2d(a, b, c)
    }
}

impl ExactPoint for exact_point::LatticePoint {
    fn orient3d(plane: [Self; 3], p: Self) -> Orientation {
        exact_point::lattice_orient3d(plane, p)
    }

    fn orient2d(points: [Self; 3], axes: (usize, usize)) -> Orientation {
        exact_point::lattice_orient2d(points, axes)
    }
}

/// Whether two triangles with area share a point that is not on a common corner or edge. Corners are common
/// if their `ids` are equal. Exact.
///
/// The intersection is convex, and if it is more than allowed, it reaches a side of one of the triangles:
/// hence testing sides against triangles suffices. With one common corner, only the opposite sides are
/// tested: a common segment that starts in the corner continues until it leaves one of the triangles through
/// that side. With two common corners, the triangles lie in one plane, both on the same side of the common
/// edge. With three they are the same, which is a separate finding.
#[inline]
pub(crate) fn triangles_intersect(ids: [[u32; 3]; 2], corners: [TriangleCorners; 2]) -> bool {
    intersect_by_corner(ids, |triangle, corner| corners[triangle][corner])
}

/// The same; `at` gives the coordinates of a corner, and is called once for each corner, in the order of the
/// case.
#[inline]
pub(super) fn intersect_by_corner(ids: [[u32; 3]; 2], at: impl Fn(usize, usize) -> [f64; 3]) -> bool {
    // Bit 3i + j is set if corner i of the first is corner j of the second: one branch decides among the
    // cases.
    let mut same = 0_u32;
    for i in 0..3 {
        for j in 0..3 {
            same |= u32::from(ids[0][i] == ids[1][j]) << (3 * i + j);
        }
    }
    let lowest = |bits: u32| (bits.trailing_zeros() as usize / 3 % 3, bits.trailing_zeros() as usize % 3);
    // Rotations that bring a corner to the front and keep the orientation.
    const FROM: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
    let from = |triangle: usize, [p, q, r]: [usize; 3]| [at(triangle, p), at(triangle, q), at(triangle, r)];
    match same.count_ones() {
        0 => disjoint_intersect(&from(0, FROM[0]), &from(1, FROM[0])),
        1 => {
            let (i, j) = lowest(same);
            vertex_sharing_intersect(&from(0, FROM[i]), &from(1, FROM[j]))
        }
        2 => {
            // The third corner of each: the numbers 0, 1, 2 add up to 3.
            let ((i, j), (k, l)) = (lowest(same), lowest(same & (same - 1)));
            edge_sharing_intersect(from(0, [i, k, 3 - i - k]), at(1, 3 - j - l))
        }
        // The same three corners: a duplicate, which is another finding.
        _ => false,
    }
}

/// The case of no common corner.
fn disjoint_intersect(a: &TriangleCorners, b: &TriangleCorners) -> bool {
    // Rounded filters decide nearly all pairs. If both are certain, so are the signs, and the rest
    // needs no exact plane.
    let of_b = PlaneFilter::through(a).clear_sides(b);
    if of_b.is_some_and(|sides| strictly_one_side(&sides)) {
        return false;
    }
    let of_a = PlaneFilter::through(b).clear_sides(a);
    if of_a.is_some_and(|sides| strictly_one_side(&sides)) {
        return false;
    }
    if let (Some(of_a), Some(of_b)) = (of_a, of_b) {
        return sides_meet([a, b], [of_a, of_b]);
    }
    fn exactly<P: ExactPoint>(a: &TriangleCorners<P>, b: &TriangleCorners<P>) -> bool {
        let of_b = [P::orient3d(*a, b[0]), P::orient3d(*a, b[1]), P::orient3d(*a, b[2])];
        if strictly_one_side(&of_b) {
            return false;
        }
        let of_a = [P::orient3d(*b, a[0]), P::orient3d(*b, a[1]), P::orient3d(*b, a[2])];
        !strictly_one_side(&of_a) && sides_meet([a, b], [of_a, of_b])
    }
    // Coordinates with few digits, as in most files, need integers only; the general predicates
    // cost several times as much.
    match on_lattice([a[0], a[1], a[2], b[0], b[1], b[2]]) {
        Some([a, b, c, d, e, f]) => exactly(&[a, b, c], &[d, e, f]),
        None => exactly(a, b),
    }
}

/// The case in which only the first corner is common.
fn vertex_sharing_intersect(a: &TriangleCorners, b: &TriangleCorners) -> bool {
    let clear_sides = |plane: &TriangleCorners, p, q| {
        let plane = PlaneFilter::through(plane);
        plane.clear_side(p).zip(plane.clear_side(q))
    };
    // The common corner lies in both planes, so the other two decide: strictly on one side, the
    // triangles have only that corner in common.
    let of_b = clear_sides(a, b[1], b[2]);
    if of_b.is_some_and(|(first, second)| first == second) {
        return false;
    }
    let of_a = clear_sides(b, a[1], a[2]);
    if of_a.is_some_and(|(first, second)| first == second) {
        return false;
    }
    if of_a.is_some() && of_b.is_some() {
        // Both opposite sides cross the other triangle's plane.
        return pierces([a[1], a[2]], b) || pierces([b[1], b[2]], a);
    }
    fn exactly<P: ExactPoint>(a: &TriangleCorners<P>, b: &TriangleCorners<P>) -> bool {
        let part = |of: [Orientation; 2]| of[0] == of[1] && of[0] != Flat;
        let of_b = [P::orient3d(*a, b[1]), P::orient3d(*a, b[2])];
        if part(of_b) {
            return false;
        }
        let of_a = [P::orient3d(*b, a[1]), P::orient3d(*b, a[2])];
        !part(of_a) && (segment_meets([a[1], a[2]], of_a, b) || segment_meets([b[1], b[2]], of_b, a))
    }
    match on_lattice([a[0], a[1], a[2], b[1], b[2]]) {
        Some([v, p, q, r, s]) => exactly(&[v, p, q], &[v, r, s]),
        None => exactly(a, b),
    }
}

/// The case of a common edge `u v`: whether the two apexes lie on the same side of it in one plane.
fn edge_sharing_intersect([u, v, a]: TriangleCorners, b: [f64; 3]) -> bool {
    fn exactly<P: ExactPoint>([u, v, a]: [P; 3], b: P) -> bool {
        if P::orient3d([u, v, a], b) != Flat {
            return false;
        }
        // Projects along an axis in which the plane is not edge-on.
        let mut turns =
            AXES.into_iter().map(|axes| (P::orient2d([u, v, a], axes), P::orient2d([u, v, b], axes)));
        turns.find(|(of_a, _)| *of_a != Flat).is_some_and(|(of_a, of_b)| of_a == of_b)
    }
    if PlaneFilter::through(&[u, v, a]).clear_side(b).is_some() {
        return false;
    }
    match on_lattice([u, v, a, b]) {
        Some([u, v, a, b]) => exactly([u, v, a], b),
        None => exactly([u, v, a], b),
    }
}

const AXES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// Whether three points lie strictly on one side.
#[inline]
fn strictly_one_side(sides: &[Orientation; 3]) -> bool {
    sides[0] != Flat && sides[0] == sides[1] && sides[1] == sides[2]
}

/// Whether a side of one of two triangles meets the other, given on which sides of the other's plane the
/// corners lie.
fn sides_meet<P: ExactPoint>([a, b]: [&TriangleCorners<P>; 2], [of_a, of_b]: [[Orientation; 3]; 2]) -> bool {
    AXES.iter().any(|&(i, j)| segment_meets([a[i], a[j]], [of_a[i], of_a[j]], b))
        || AXES.iter().any(|&(i, j)| segment_meets([b[i], b[j]], [of_b[i], of_b[j]], a))
}

/// Whether a closed segment meets a closed triangle with area, given on which sides of the plane its ends
/// lie.
fn segment_meets<P: ExactPoint>(
    [p, q]: [P; 2],
    sides: [Orientation; 2],
    triangle: &TriangleCorners<P>,
) -> bool {
    match sides {
        [Front, Front] | [Back, Back] => false,
        [Flat, Flat] => flat_segment_meets([p, q], triangle),
        [Flat, _] => contains(triangle, p),
        [_, Flat] => contains(triangle, q),
        [Front, Back] | [Back, Front] => pierces([p, q], triangle),
    }
}

/// Whether two orientations are strictly opposite.
#[inline]
fn opposite(a: Orientation, b: Orientation) -> bool {
    a != Flat && a == b.flipped()
}

/// Whether a segment whose ends lie on opposite sides of the plane pierces the triangle: it passes all sides
/// with the same orientation.
fn pierces<P: ExactPoint>([p, q]: [P; 2], [a, b, c]: &TriangleCorners<P>) -> bool {
    let (first, second) = (P::orient3d([p, q, *a], *b), P::orient3d([p, q, *b], *c));
    if opposite(first, second) {
        return false;
    }
    let third = P::orient3d([p, q, *c], *a);
    !opposite(first, third) && !opposite(second, third)
}

/// Axes along which the projection of a triangle with area has area.
#[inline]
fn clear_axes<P: ExactPoint>(triangle: &TriangleCorners<P>) -> (usize, usize) {
    AXES.into_iter().find(|axes| P::orient2d(*triangle, *axes) != Flat).unwrap_or(AXES[0])
}

/// Whether a point in the plane of a triangle lies on it, including its sides: no two sides see it with
/// opposite orientations.
fn contains<P: ExactPoint>(triangle: &TriangleCorners<P>, p: P) -> bool {
    holds(triangle, p, clear_axes(triangle))
}

#[inline]
fn holds<P: ExactPoint>([a, b, c]: &TriangleCorners<P>, p: P, axes: (usize, usize)) -> bool {
    let turns =
        [P::orient2d([*a, *b, p], axes), P::orient2d([*b, *c, p], axes), P::orient2d([*c, *a, p], axes)];
    !(turns.contains(&Front) && turns.contains(&Back))
}

/// Whether a segment in the triangle's plane meets the triangle.
fn flat_segment_meets<P: ExactPoint>([p, q]: [P; 2], triangle: &TriangleCorners<P>) -> bool {
    let axes = clear_axes(triangle);
    // For neighbours in a flat region the whole triangle lies on one side of the segment's line.
    let [a, b, c] = *triangle;
    let turns = [P::orient2d([p, q, a], axes), P::orient2d([p, q, b], axes), P::orient2d([p, q, c], axes)];
    if strictly_one_side(&turns) {
        return false;
    }
    if holds(triangle, p, axes) || holds(triangle, q, axes) {
        return true;
    }
    // Both ends are outside, so the segment meets the triangle only if it crosses a side or passes through a
    // corner.
    // A side in the segment's line is left to the two others: if the segment covers it, it passes
    // through their corners.
    AXES.into_iter().any(|(i, j)| {
        let parts = |[r, s]: [Orientation; 2]| r != s || r == Flat;
        let in_one_line = turns[i] == Flat && turns[j] == Flat;
        !in_one_line && parts([turns[i], turns[j]]) && {
            let side = |r: P| P::orient2d([triangle[i], triangle[j], r], axes);
            parts([side(p), side(q)])
        }
    })
}

/// A floating-point filter: a rounded plane that decides sides if they are certain.
struct PlaneFilter {
    at: DVec3,
    normal: DVec3,
    /// The sizes of the products that make up the normal.
    size: DVec3,
}

impl PlaneFilter {
    #[inline]
    fn through(corners: &TriangleCorners) -> Self {
        let [a, b, c] = [DVec3::from(corners[0]), DVec3::from(corners[1]), DVec3::from(corners[2])];
        let (u, v) = (b - a, c - a);
        let (x, y) = (u.abs(), v.abs());
        let size = DVec3::new(x.y * y.z + x.z * y.y, x.z * y.x + x.x * y.z, x.x * y.y + x.y * y.x);
        Self { at: a, normal: u.cross(v), size }
    }

    /// The side on which a point lies, never [`Flat`]; `None` if rounding leaves it undecided.
    #[inline]
    fn clear_side(&self, p: [f64; 3]) -> Option<Orientation> {
        let to = DVec3::from(p) - self.at;
        let (height, size) = (self.normal.dot(to), self.size.dot(to.abs()));
        // With u = 2⁻⁵³: differences are off by u each, products and sums of the normal by 2u more, those of
        // the height by 3u: at most 8u of the products' sizes, whose own sum is low by as little. Twice that
        // is 8ε.
        let slack = 8.0 * f64::EPSILON * size;
        // Underflow loses less than 2⁻¹⁰⁷⁴ a product, and a product of the normal is then multiplied by less
        // than 1e200: together far below the least slack, 1e-115. Where a size is outside this range or NaN,
        // the side stays undecided.
        const CLEAR: std::ops::Range<f64> = 1e-100..1e270;
        let clear = CLEAR.contains(&size) && height.abs() > slack && to.abs().max_element() < 1e200;
        clear.then_some(if height > 0.0 { Front } else { Back })
    }

    #[inline]
    fn clear_sides(&self, [a, b, c]: &TriangleCorners) -> Option<[Orientation; 3]> {
        Some([self.clear_side(*a)?, self.clear_side(*b)?, self.clear_side(*c)?])
    }
}

/// A rounded point that two triangles share besides their common corners: the mean of the points at which a
/// side of one meets the other. `None` if rounding finds none.
pub(super) fn common_point(ids: [[u32; 3]; 2], [a, b]: [TriangleCorners; 2]) -> Option<[f64; 3]> {
    let mut points: Vec<DVec3> = Vec::new();
    for (triangle, triangle_ids, other, other_ids) in [(&a, ids[0], &b, ids[1]), (&b, ids[1], &a, ids[0])] {
        let plane = PlaneFilter::through(other);
        let sides = triangle.map(|p| ExactPoint::orient3d(*other, p));
        for i in 0..3 {
            let j = (i + 1) % 3;
            // A corner in the other's plane; a common corner is no crossing.
            if sides[i] == Flat && !other_ids.contains(&triangle_ids[i]) && contains(other, triangle[i]) {
                points.push(triangle[i].into());
            }
            let segment = [triangle[i], triangle[j]];
            match [sides[i], sides[j]] {
                [Front, Back] | [Back, Front] if pierces(segment, other) => {
                    let [p, q] = segment.map(DVec3::from);
                    let [from, to] = [p, q].map(|r| plane.normal.dot(r - plane.at).abs());
                    // The signs are exact, the distances rounded: both may have become 0.
                    let t = if from + to > 0.0 { from / (from + to) } else { 0.5 };
                    points.push(p * (1.0 - t) + q * t);
                }
                [Flat, Flat] => points.extend(crossings(segment, other)),
                _ => {}
            }
        }
    }
    let share = 1.0 / points.len() as f64;
    let middle = points.iter().fold(DVec3::ZERO, |sum, place| sum + *place * share);
    (!points.is_empty() && middle.is_finite()).then(|| middle.to_array())
}

/// The points at which a segment crosses the sides of a triangle in its plane, rounded; without corners.
fn crossings(segment: [[f64; 3]; 2], triangle: &TriangleCorners) -> Vec<DVec3> {
    let normal = PlaneFilter::through(triangle).normal;
    let [p, q] = segment.map(DVec3::from);
    let crossing_points = (0..3).filter_map(|k| {
        let [r, s] = [triangle[k], triangle[(k + 1) % 3]].map(DVec3::from);
        let across = normal.cross(s - r);
        let (from, to) = (across.dot(p - r), across.dot(q - r));
        let along = normal.cross(q - p);
        let (low, high) = (along.dot(r - p), along.dot(s - p));
        let crosses = from * to < 0.0 && low * high < 0.0;
        crosses.then(|| p + (q - p) * (from / (from - to)))
    });
    crossing_points.collect()
}
