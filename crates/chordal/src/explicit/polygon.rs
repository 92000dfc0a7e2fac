//! Predicates for polygons in the plane: convexity, winding number, containment. Every answer is exact.
use super::FillRule;
use crate::math::{Orientation, PointInTriangle, orient2d};

/// The winding number of a closed polygon around a point, counter-clockwise positive; `None` if the point
/// lies on a side, and for an empty ring.
///
/// `ring`: finite corners in order; the last is joined to the first. Time O(n).
///
/// ```
/// use chordal::explicit::polygons::winding_number;
/// let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
/// assert_eq!(winding_number(&square, [1.0, 1.0]), Some(1));
/// assert_eq!(winding_number(&square, [3.0, 1.0]), Some(0));
/// assert_eq!(winding_number(&square, [2.0, 0.5]), None);
/// ```
///
/// Source: D. Sunday, *Inclusion of a point in a polygon*, 2001, with exact predicates.
#[must_use]
pub fn winding_number(ring: &[[f64; 2]], point: [f64; 2]) -> Option<i32> {
    let mut winding = 0;
    let mut from = *ring.last()?;
    for &to in ring {
        // A corner on the level of the point counts as below it. So two sides that meet there count
        // once if the ring passes the level, and not at all or twice, in opposite directions, if it
        // only touches it.
        let (starts_below, ends_below) = (from[1] <= point[1], to[1] <= point[1]);
        if starts_below != ends_below {
            match orient2d(from, to, point) {
                Orientation::Flat => return None,
                Orientation::Front if starts_below => winding += 1,
                Orientation::Back if ends_below => winding -= 1,
                _ => {}
            }
        } else if is_on_level_or_corner(from, to, point) {
            return None;
        }
        from = to;
    }
    Some(winding)
}

/// Whether the point lies on a side whose ends are both at or below its height, or both above.
fn is_on_level_or_corner(from: [f64; 2], to: [f64; 2], point: [f64; 2]) -> bool {
    if to == point || from == point {
        return true;
    }
    let is_between = |x: f64, a: f64, b: f64| (a <= x && x <= b) || (b <= x && x <= a);
    from[1] == point[1] && to[1] == point[1] && is_between(point[0], from[0], to[0])
}

/// The location of a point relative to the region that several closed polygons enclose by a fill rule. A
/// point on any side of any polygon is on the boundary. Time O(n).
///
/// ```
/// use chordal::explicit::FillRule;
/// use chordal::explicit::polygons::polygon_contains;
/// use chordal::math::exact::PointInTriangle;
/// let square = |x: f64, size: f64| vec![[x, x], [x + size, x], [x + size, x + size], [x, x + size]];
/// let rings = [square(0.0, 3.0), square(1.0, 1.0)];
/// assert_eq!(polygon_contains(&rings, FillRule::EvenOdd, [1.5, 1.5]), PointInTriangle::Outside);
/// assert_eq!(polygon_contains(&rings, FillRule::NonZero, [1.5, 1.5]), PointInTriangle::Inside);
/// ```
#[must_use]
pub fn polygon_contains<R: AsRef<[[f64; 2]]>>(
    rings: &[R],
    rule: FillRule,
    point: [f64; 2],
) -> PointInTriangle {
    let mut winding = 0;
    for ring in rings.iter().map(AsRef::as_ref).filter(|ring| !ring.is_empty()) {
        match winding_number(ring, point) {
            Some(number) => winding += number,
            None => return PointInTriangle::Boundary,
        }
    }
    if rule.holds(winding) { PointInTriangle::Inside } else { PointInTriangle::Outside }
}

/// Whether a closed polygon is the boundary of a convex set, in either direction. Corners on a straight side
/// are allowed. Repeated corners, spikes, a second winding and polygons without area are not. Exact. Time
/// O(n).
///
/// ```
/// use chordal::explicit::polygons::is_convex;
/// assert!(is_convex(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0]]));
/// assert!(!is_convex(&[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]]));
/// ```
#[must_use]
pub fn is_convex(ring: &[[f64; 2]]) -> bool {
    let n = ring.len();
    let at = |i: usize| ring[i % n];
    let is_before = |a: [f64; 2], b: [f64; 2]| a[0] < b[0] || a[0] == b[0] && a[1] < b[1];
    let (mut sense, mut reversals) = (Orientation::Flat, 0);
    for i in 0..n {
        let [a, b, c] = [at(i), at(i + 1), at(i + 2)];
        if b == a {
            return false;
        }
        // Along a convex polygon the lexicographic order reverses twice: at its leftmost corner and at its
        // rightmost.
        let turns_back = is_before(a, b) != is_before(b, c);
        reversals += usize::from(turns_back);
        match orient2d(a, b, c) {
            // A reversal on one line is a spike.
            Orientation::Flat if turns_back => return false,
            Orientation::Flat => {}
            turn if sense == Orientation::Flat => sense = turn,
            turn if turn != sense => return false,
            _ => {}
        }
    }
    sense != Orientation::Flat && reversals == 2
}

/// The n − 2 triangles of the fan from the first corner of a polygon of n corners; none for fewer than three
/// corners. The polygon should be convex ([`is_convex`]). A corner on a straight side next to the first
/// corner gives a triangle without area.
///
/// ```
/// use chordal::explicit::polygons::fan;
/// assert_eq!(fan(4), [[0, 1, 2], [0, 2, 3]]);
/// ```
#[must_use]
pub fn fan(n: u32) -> Vec<[u32; 3]> {
    (2..n).map(|i| [0, i - 1, i]).collect()
}
