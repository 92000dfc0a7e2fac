//! Whether two triangles meet anywhere but in the corners that they share, exactly.
use super::lattice::{self, on_lattice};
use crate::math::{Orientation, orient2d, orient3d};
use Orientation::{Back, Flat, Front};
use glam::DVec3;

type Corners<P = [f64; 3]> = [P; 3];

/// Points with exact predicates: by coordinates, or by whole numbers where those span few digits.
trait Exact: Copy {
    /// On which side of the plane through three points the last one lies.
    fn side(plane: [Self; 3], p: Self) -> Orientation;
    /// On which side of the line through two points the last one lies, seen along an axis.
    fn turn(points: [Self; 3], axes: (usize, usize)) -> Orientation;
}

impl Exact for [f64; 3] {
    fn side(plane: [Self; 3], p: Self) -> Orientation {
        let [a, b, c] = plane;
        Plane::of(&plane).clear_side(p).unwrap_or_else(|| orient3d(a, b, c, p))
    }

    fn turn(points: [Self; 3], (x, y): (usize, usize)) -> Orientation {
        let [a, b, c] = points.map(|p| [p[x], p[y]]);
        orient2d(a, b, c)
    }
}

impl Exact for lattice::Point {
    fn side(plane: [Self; 3], p: Self) -> Orientation {
        lattice::side(plane, p)
    }

    fn turn(points: [Self; 3], axes: (usize, usize)) -> Orientation {
        lattice::turn(points, axes)
    }
}

/// Whether two triangles that have an area share a point that is not on a corner or side that both have. Corners are
/// the same where their `ids` are. Exact.
///
/// What they share is convex, and where it is more than what it may be it reaches a side of one of them: hence sides
/// against triangles is all that has to be looked at. With one common corner, only the sides across from it: a common
/// segment that begins in the corner goes on until it leaves one of the triangles through that side. With two, the
/// triangles lie in one plane, both on the same side of the common edge. With three they are the same, which has a
/// finding of its own.
#[inline]
pub(crate) fn meet(ids: [[u32; 3]; 2], [a, b]: [Corners; 2]) -> bool {
    let (mut n, mut of_a, mut of_b) = (0, [0; 3], [0; 3]);
    for i in 0..3 {
        for j in 0..3 {
            if ids[0][i] == ids[1][j] {
                (of_a[n], of_b[n]) = (i, j);
                n += 1;
            }
        }
    }
    let from = |corners: &Corners, k: usize| [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
    match n {
        0 => apart_meet(&a, &b),
        1 => hinged_meet(&from(&a, of_a[0]), &from(&b, of_b[0])),
        2 => {
            let (apex_a, apex_b) = (3 - of_a[0] - of_a[1], 3 - of_b[0] - of_b[1]);
            folded_meet([a[of_a[0]], a[of_a[1]], a[apex_a]], b[apex_b])
        }
        _ => false,
    }
}

/// Without a common corner.
fn apart_meet(a: &Corners, b: &Corners) -> bool {
    let of_b = Plane::of(a).clear_sides(b);
    if of_b.is_some_and(|sides| parted(&sides)) {
        return false;
    }
    let of_a = Plane::of(b).clear_sides(a);
    if of_a.is_some_and(|sides| parted(&sides)) {
        return false;
    }
    if let (Some(of_a), Some(of_b)) = (of_a, of_b) {
        return sides_meet([a, b], [of_a, of_b]);
    }
    fn exactly<P: Exact>(a: &Corners<P>, b: &Corners<P>) -> bool {
        let of_b = [P::side(*a, b[0]), P::side(*a, b[1]), P::side(*a, b[2])];
        if parted(&of_b) {
            return false;
        }
        let of_a = [P::side(*b, a[0]), P::side(*b, a[1]), P::side(*b, a[2])];
        !parted(&of_a) && sides_meet([a, b], [of_a, of_b])
    }
    match on_lattice([a[0], a[1], a[2], b[0], b[1], b[2]]) {
        Some([a, b, c, d, e, f]) => exactly(&[a, b, c], &[d, e, f]),
        None => exactly(a, b),
    }
}

/// With the first corner in common and no other.
fn hinged_meet(a: &Corners, b: &Corners) -> bool {
    let clear_sides = |plane: &Corners, p, q| {
        let plane = Plane::of(plane);
        plane.clear_side(p).zip(plane.clear_side(q))
    };
    let of_b = clear_sides(a, b[1], b[2]);
    if of_b.is_some_and(|(one, other)| one == other) {
        return false;
    }
    let of_a = clear_sides(b, a[1], a[2]);
    if of_a.is_some_and(|(one, other)| one == other) {
        return false;
    }
    if of_a.is_some() && of_b.is_some() {
        // Both sides across go through the other's plane.
        return pierces([a[1], a[2]], b) || pierces([b[1], b[2]], a);
    }
    fn exactly<P: Exact>(a: &Corners<P>, b: &Corners<P>) -> bool {
        let part = |of: [Orientation; 2]| of[0] == of[1] && of[0] != Flat;
        let of_b = [P::side(*a, b[1]), P::side(*a, b[2])];
        if part(of_b) {
            return false;
        }
        let of_a = [P::side(*b, a[1]), P::side(*b, a[2])];
        !part(of_a) && (segment_meets([a[1], a[2]], of_a, b) || segment_meets([b[1], b[2]], of_b, a))
    }
    match on_lattice([a[0], a[1], a[2], b[1], b[2]]) {
        Some([v, p, q, r, s]) => exactly(&[v, p, q], &[v, r, s]),
        None => exactly(a, b),
    }
}

/// With the edge `u v` in common: whether the two apexes lie on the same side of it in one plane.
fn folded_meet([u, v, a]: Corners, b: [f64; 3]) -> bool {
    fn exactly<P: Exact>([u, v, a]: [P; 3], b: P) -> bool {
        if P::side([u, v, a], b) != Flat {
            return false;
        }
        // Along an axis in which the plane is not seen edge-on.
        let mut turns = AXES.into_iter().map(|axes| (P::turn([u, v, a], axes), P::turn([u, v, b], axes)));
        turns.find(|(of_a, _)| *of_a != Flat).is_some_and(|(of_a, of_b)| of_a == of_b)
    }
    if Plane::of(&[u, v, a]).clear_side(b).is_some() {
        return false;
    }
    match on_lattice([u, v, a, b]) {
        Some([u, v, a, b]) => exactly([u, v, a], b),
        None => exactly([u, v, a], b),
    }
}

const AXES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// Whether three points lie on one side, strictly.
#[inline]
fn parted(sides: &[Orientation; 3]) -> bool {
    sides[0] != Flat && sides[0] == sides[1] && sides[1] == sides[2]
}

/// Whether a side of one of two triangles meets the other, from the sides of the other's plane on which corners lie.
fn sides_meet<P: Exact>([a, b]: [&Corners<P>; 2], [of_a, of_b]: [[Orientation; 3]; 2]) -> bool {
    AXES.iter().any(|&(i, j)| segment_meets([a[i], a[j]], [of_a[i], of_a[j]], b))
        || AXES.iter().any(|&(i, j)| segment_meets([b[i], b[j]], [of_b[i], of_b[j]], a))
}

/// Whether a closed segment meets a closed triangle with an area, from the sides of its ends.
fn segment_meets<P: Exact>([p, q]: [P; 2], sides: [Orientation; 2], triangle: &Corners<P>) -> bool {
    match sides {
        [Front, Front] | [Back, Back] => false,
        [Flat, Flat] => flat_segment_meets([p, q], triangle),
        [Flat, _] => contains(triangle, p),
        [_, Flat] => contains(triangle, q),
        [Front, Back] | [Back, Front] => pierces([p, q], triangle),
    }
}

/// Whether two sides are strictly opposite.
#[inline]
fn opposite(one: Orientation, other: Orientation) -> bool {
    one != Flat && one == other.flipped()
}

/// Whether a segment with its ends on either side of a triangle goes through it: it passes all sides alike.
fn pierces<P: Exact>([p, q]: [P; 2], [a, b, c]: &Corners<P>) -> bool {
    let (first, second) = (P::side([p, q, *a], *b), P::side([p, q, *b], *c));
    if opposite(first, second) {
        return false;
    }
    let third = P::side([p, q, *c], *a);
    !opposite(first, third) && !opposite(second, third)
}

/// Axes in which a triangle with an area is seen as one.
#[inline]
fn clear_axes<P: Exact>(triangle: &Corners<P>) -> (usize, usize) {
    AXES.into_iter().find(|axes| P::turn(*triangle, *axes) != Flat).unwrap_or(AXES[0])
}

/// Whether a point in the plane of a triangle lies on it, its sides included: it is on no two sides' outer sides.
fn contains<P: Exact>(triangle: &Corners<P>, p: P) -> bool {
    holds(triangle, p, clear_axes(triangle))
}

#[inline]
fn holds<P: Exact>([a, b, c]: &Corners<P>, p: P, axes: (usize, usize)) -> bool {
    let turns = [P::turn([*a, *b, p], axes), P::turn([*b, *c, p], axes), P::turn([*c, *a, p], axes)];
    !(turns.contains(&Front) && turns.contains(&Back))
}

/// The same for a segment in the triangle's plane.
fn flat_segment_meets<P: Exact>([p, q]: [P; 2], triangle: &Corners<P>) -> bool {
    let axes = clear_axes(triangle);
    // All of the triangle on one side of the segment's line is what neighbours in a flat place look like.
    let [a, b, c] = *triangle;
    let turns = [P::turn([p, q, a], axes), P::turn([p, q, b], axes), P::turn([p, q, c], axes)];
    if parted(&turns) {
        return false;
    }
    if holds(triangle, p, axes) || holds(triangle, q, axes) {
        return true;
    }
    // Both ends are outside: it meets the triangle where it crosses a side or passes through a corner.
    AXES.into_iter().any(|(i, j)| {
        let parts = |[r, s]: [Orientation; 2]| r != s || r == Flat;
        let in_one_line = turns[i] == Flat && turns[j] == Flat;
        !in_one_line && parts([turns[i], turns[j]]) && {
            let side = |r: P| P::turn([triangle[i], triangle[j], r], axes);
            parts([side(p), side(q)])
        }
    })
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
        let [a, b, c] = [DVec3::from(corners[0]), DVec3::from(corners[1]), DVec3::from(corners[2])];
        let (u, v) = (b - a, c - a);
        let (x, y) = (u.abs(), v.abs());
        let size = DVec3::new(x.y * y.z + x.z * y.y, x.z * y.x + x.x * y.z, x.x * y.y + x.y * y.x);
        Self { at: a, normal: u.cross(v), size }
    }

    /// On which side a point lies, never [`Flat`]; `None` where rounding leaves it open.
    #[inline]
    fn clear_side(&self, p: [f64; 3]) -> Option<Orientation> {
        let to = DVec3::from(p) - self.at;
        let (height, size) = (self.normal.dot(to), self.size.dot(to.abs()));
        // With u = 2⁻⁵³: differences are off by u each, products and sums of the normal by 2u more, those of the height
        // by 3u: at most 8u of the products' sizes, whose own sum is low by as little. Twice that is 8ε.
        let slack = 8.0 * f64::EPSILON * size;
        // What underflows loses less than 2⁻¹⁰⁷⁴ a product, and a product of the normal is then multiplied by less than
        // 1e200: together far below the least slack, 1e-115. Where a size is beyond that, or no number, it stays open.
        const CLEAR: std::ops::Range<f64> = 1e-100..1e270;
        let clear = CLEAR.contains(&size) && height.abs() > slack && to.abs().max_element() < 1e200;
        clear.then_some(if height > 0.0 { Front } else { Back })
    }

    #[inline]
    fn clear_sides(&self, [a, b, c]: &Corners) -> Option<[Orientation; 3]> {
        Some([self.clear_side(*a)?, self.clear_side(*b)?, self.clear_side(*c)?])
    }
}

/// A point, rounded, that two triangles share beside their common corners: the middle of the places where a side of one
/// meets the other. `None` where rounding finds none.
pub(super) fn common_point(ids: [[u32; 3]; 2], [a, b]: [Corners; 2]) -> Option<[f64; 3]> {
    let mut places: Vec<DVec3> = Vec::new();
    for (one, one_ids, other, other_ids) in [(&a, ids[0], &b, ids[1]), (&b, ids[1], &a, ids[0])] {
        let plane = Plane::of(other);
        let sides = one.map(|p| Exact::side(*other, p));
        for i in 0..3 {
            let j = (i + 1) % 3;
            if sides[i] == Flat && !other_ids.contains(&one_ids[i]) && contains(other, one[i]) {
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
