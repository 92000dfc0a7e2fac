//! Whether two triangles meet anywhere but in the corners that they share, exactly.
use super::winding::contains;
use crate::math::{Orientation, Position, orient2d, orient3d, triangle_contains};
use Orientation::{Back, Flat, Front};
use glam::DVec3;

type Corners = [[f64; 3]; 3];

/// Whether two triangles that have an area share a point that is not on a corner or side that both have. Corners are
/// the same where their `ids` are. Exact.
///
/// What they share is convex, and where it is more than what it may be it reaches a side of one of them: hence sides
/// against triangles is all that has to be looked at. With one common corner, only the sides across from it: a common
/// segment that begins in the corner goes on until it leaves one of the triangles through that side. With two, the
/// triangles lie in one plane, both on the same side of the common edge. With three they are the same, which has a
/// finding of its own.
pub(super) fn meet(ids: [[u32; 3]; 2], [a, b]: [Corners; 2]) -> bool {
    let mut shared = [(0, 0); 3];
    let mut n = 0;
    for i in 0..3 {
        for j in 0..3 {
            if ids[0][i] == ids[1][j] {
                shared[n] = (i, j);
                n += 1;
            }
        }
    }
    let from = |corners: &Corners, k: usize| [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
    match n {
        0 => apart_meet(&a, &b),
        1 => {
            let (i, j) = shared[0];
            hinged_meet(&from(&a, i), &from(&b, j))
        }
        2 => {
            let (apex_a, apex_b) = (3 - shared[0].0 - shared[1].0, 3 - shared[0].1 - shared[1].1);
            let edge = shared[..2].iter().map(|(i, _)| a[*i]);
            let mut edge = edge.chain([a[apex_a]]);
            match [edge.next(), edge.next(), edge.next()] {
                [Some(u), Some(v), Some(apex)] => is_folded([u, v, apex], b[apex_b]),
                _ => false,
            }
        }
        _ => false,
    }
}

/// Without a common corner.
fn apart_meet(a: &Corners, b: &Corners) -> bool {
    let sides_of_b = Plane::of(a).sides(a, b);
    if parted(&sides_of_b) {
        return false;
    }
    let sides_of_a = Plane::of(b).sides(b, a);
    if parted(&sides_of_a) {
        return false;
    }
    let edges = [(0, 1), (1, 2), (2, 0)];
    edges.iter().any(|&(i, j)| segment_meets([a[i], a[j]], [sides_of_a[i], sides_of_a[j]], b))
        || edges.iter().any(|&(i, j)| segment_meets([b[i], b[j]], [sides_of_b[i], sides_of_b[j]], a))
}

/// With the first corner in common and no other.
fn hinged_meet(a: &Corners, b: &Corners) -> bool {
    let plane = Plane::of(a);
    let of_b = [plane.side(a, b[1]), plane.side(a, b[2])];
    if of_b[0] == of_b[1] && of_b[0] != Flat {
        return false;
    }
    let plane = Plane::of(b);
    let of_a = [plane.side(b, a[1]), plane.side(b, a[2])];
    if of_a[0] == of_a[1] && of_a[0] != Flat {
        return false;
    }
    segment_meets([a[1], a[2]], of_a, b) || segment_meets([b[1], b[2]], of_b, a)
}

/// With the edge `u v` in common: whether the two apexes lie on the same side of it in one plane.
fn is_folded([u, v, a]: Corners, b: [f64; 3]) -> bool {
    if Plane::of(&[u, v, a]).side(&[u, v, a], b) != Flat {
        return false;
    }
    let turn = |p: [f64; 3], (x, y): (usize, usize)| orient2d([u[x], u[y]], [v[x], v[y]], [p[x], p[y]]);
    // Along an axis in which the plane is not seen edge-on.
    [(0, 1), (1, 2), (2, 0)]
        .into_iter()
        .map(|axes| (turn(a, axes), turn(b, axes)))
        .find(|(of_a, _)| *of_a != Flat)
        .is_some_and(|(of_a, of_b)| of_a == of_b)
}

/// Whether three points lie on one side, strictly.
fn parted(sides: &[Orientation; 3]) -> bool {
    sides[0] != Flat && sides[0] == sides[1] && sides[1] == sides[2]
}

/// Whether a closed segment meets a closed triangle with an area, from the sides of its ends.
fn segment_meets([p, q]: [[f64; 3]; 2], sides: [Orientation; 2], triangle: &Corners) -> bool {
    match sides {
        [Front, Front] | [Back, Back] => false,
        [Flat, Flat] => flat_segment_meets([p, q], triangle),
        [Flat, _] => contains(*triangle, p),
        [_, Flat] => contains(*triangle, q),
        [Front, Back] | [Back, Front] => pierces([p, q], triangle),
    }
}

/// Whether a segment with its ends on either side of a triangle goes through it: it passes all sides alike.
fn pierces([p, q]: [[f64; 3]; 2], [a, b, c]: &Corners) -> bool {
    let first = side([p, q, *a], *b);
    let second = side([p, q, *b], *c);
    if first == second.flipped() && first != Flat {
        return false;
    }
    let third = side([p, q, *c], *a);
    let opposite = |one: Orientation, other: Orientation| one == other.flipped() && one != Flat;
    !opposite(first, third) && !opposite(second, third)
}

/// The same for a segment in the triangle's plane.
fn flat_segment_meets([p, q]: [[f64; 3]; 2], triangle: &Corners) -> bool {
    let seen = |(x, y): (usize, usize)| triangle.map(|r| [r[x], r[y]]);
    let axes = [(0, 1), (1, 2), (2, 0)];
    let clear = axes.into_iter().find(|axes| {
        let [a, b, c] = seen(*axes);
        orient2d(a, b, c) != Flat
    });
    let Some((x, y)) = clear else { return false };
    let corners = seen((x, y));
    let (p, q) = ([p[x], p[y]], [q[x], q[y]]);
    if [p, q].iter().any(|r| triangle_contains(corners, *r) != Position::Outside) {
        return true;
    }
    // Both ends are outside: it meets the triangle where it crosses a side or passes through a corner.
    let turns = corners.map(|r| orient2d(p, q, r));
    [(0, 1), (1, 2), (2, 0)].into_iter().any(|(i, j)| {
        let parts = |[r, s]: [Orientation; 2]| r != s || r == Flat;
        let of_ends = [orient2d(corners[i], corners[j], p), orient2d(corners[i], corners[j], q)];
        let in_one_line = turns[i] == Flat && turns[j] == Flat;
        !in_one_line && parts([turns[i], turns[j]]) && parts(of_ends)
    })
}

/// On which side of the plane through three points another one lies, exactly: [`orient3d`] behind a filter that needs
/// no look at the range of the numbers.
fn side(corners: Corners, p: [f64; 3]) -> Orientation {
    Plane::of(&corners).side(&corners, p)
}

/// A plane in floating point, to tell sides where they are clear.
struct Plane {
    at: DVec3,
    normal: DVec3,
    /// The sizes of the products of which the normal is made.
    size: DVec3,
}

impl Plane {
    #[inline]
    fn of(corners: &Corners) -> Self {
        let [a, b, c] = corners.map(DVec3::from);
        let (u, v) = (b - a, c - a);
        let (x, y) = (u.abs(), v.abs());
        let size = DVec3::new(x.y * y.z + x.z * y.y, x.z * y.x + x.x * y.z, x.x * y.y + x.y * y.x);
        Self { at: a, normal: u.cross(v), size }
    }

    #[inline]
    fn side(&self, corners: &Corners, p: [f64; 3]) -> Orientation {
        let to = DVec3::from(p) - self.at;
        let (height, size) = (self.normal.dot(to), self.size.dot(to.abs()));
        // With u = 2⁻⁵³: differences are off by u each, products and sums of the normal by 2u more, those of the height
        // by 3u: at most 8u of the products' sizes, whose own sum is low by as little. 2ε = 4u of slack each way.
        let slack = 8.0 * f64::EPSILON * size;
        // What underflows loses less than 2⁻¹⁰⁷⁴ a product, and a product of the normal is then multiplied by less than
        // 1e200: together far below the least slack, 1e-115. Where a size is beyond that, or no number, exact
        // arithmetic decides.
        const CLEAR: std::ops::Range<f64> = 1e-100..1e270;
        if CLEAR.contains(&size) && height.abs() > slack && to.abs().max_element() < 1e200 {
            return if height > 0.0 { Front } else { Back };
        }
        // In a plane across an axis, as the sides of boxes are.
        let [a, b, c] = corners;
        if (0..3).any(|k| a[k] == b[k] && b[k] == c[k] && c[k] == p[k]) {
            return Flat;
        }
        orient3d(*a, *b, *c, p)
    }

    #[inline]
    fn sides(&self, corners: &Corners, points: &Corners) -> [Orientation; 3] {
        [self.side(corners, points[0]), self.side(corners, points[1]), self.side(corners, points[2])]
    }
}

/// A point, rounded, that two triangles share beside their common corners: the middle of the places where a side of one
/// meets the other. `None` where rounding finds none.
pub(super) fn common_point(ids: [[u32; 3]; 2], [a, b]: [Corners; 2]) -> Option<[f64; 3]> {
    let mut places: Vec<DVec3> = Vec::new();
    for (one, one_ids, other, other_ids) in [(&a, ids[0], &b, ids[1]), (&b, ids[1], &a, ids[0])] {
        let plane = Plane::of(other);
        let sides = plane.sides(other, one);
        for i in 0..3 {
            let j = (i + 1) % 3;
            if sides[i] == Flat && !other_ids.contains(&one_ids[i]) && contains(*other, one[i]) {
                places.push(one[i].into());
            }
            let segment = [one[i], one[j]];
            match [sides[i], sides[j]] {
                [Front, Back] | [Back, Front] if pierces(segment, other) => {
                    let [p, q] = segment.map(DVec3::from);
                    let [from, to] = [p, q].map(|r| plane.normal.dot(r - plane.at).abs());
                    let t = if from + to > 0.0 { from / (from + to) } else { 0.5 };
                    places.push(p * (1.0 - t) + q * t);
                }
                [Flat, Flat] => places.extend(crossings(segment, other)),
                _ => {}
            }
        }
    }
    let share = 1.0 / places.len() as f64;
    let middle = places.iter().fold(DVec3::ZERO, |sum, place| sum + *place * share);
    (!places.is_empty() && middle.is_finite()).then(|| middle.to_array())
}

/// Where a segment crosses the sides of a triangle in its plane, rounded; not at corners.
fn crossings(segment: [[f64; 3]; 2], triangle: &Corners) -> Vec<DVec3> {
    let normal = Plane::of(triangle).normal;
    let [p, q] = segment.map(DVec3::from);
    let found = (0..3).filter_map(|k| {
        let [r, s] = [triangle[k], triangle[(k + 1) % 3]].map(DVec3::from);
        let across = normal.cross(s - r);
        let (from, to) = (across.dot(p - r), across.dot(q - r));
        let along = normal.cross(q - p);
        let (low, high) = (along.dot(r - p), along.dot(s - p));
        let crosses = from * to < 0.0 && low * high < 0.0;
        crosses.then(|| p + (q - p) * (from / (from - to)))
    });
    found.collect()
}
