//! The closest point of one triangle to a query, and bounds for its distance that include all rounding.
use crate::math::{
    add_down, add_up, div_down, div_up, exponent, greater, lesser, mul_down, mul_up, power_of_two, sqrt_up,
    sub_down, sub_up,
};
use glam::DVec3;

/// The closest point of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleClosestPoint {
    /// Barycentric coordinates: ≥ 0, with sum 1 up to rounding.
    pub barycentric: [f64; 3],
    pub distance_sq: f64,
}

/// A triangle is thin if its squared doubled area is below this fraction of the fourth power of its longest
/// edge. The areas by which the closed form decides lose up to the inverse of that in precision. Chosen: 1/64
/// is an aspect of 1:8.
const THIN: f64 = 1.0 / 64.0;

/// The closest point of a triangle of any shape to `q`.
///
/// The error of the distance is a few units in the last place of the distance to the farthest corner. Source
/// of the regions: C. Ericson, *Real-Time Collision Detection*, 2005, 5.1.5; corners are tested first, and
/// thin triangles and those without area are treated in a frame of their own.
#[inline]
pub(super) fn closest_point(q: [f64; 3], corners: [[f64; 3]; 3]) -> TriangleClosestPoint {
    let [a, b, c] = [DVec3::from(corners[0]), DVec3::from(corners[1]), DVec3::from(corners[2])];
    let q = DVec3::from(q);
    // Edges are differences of the corners: differences of offsets from a far `q` would include its rounding.
    let (ab, ac) = (b - a, c - a);
    let (aq, bq, cq) = (q - a, q - b, q - c);
    let (d1, d2) = (ab.dot(aq), ac.dot(aq));
    if d1 <= 0.0 && d2 <= 0.0 {
        return TriangleClosestPoint { barycentric: [1.0, 0.0, 0.0], distance_sq: aq.length_squared() };
    }
    let (d3, d4) = (ab.dot(bq), ac.dot(bq));
    if d3 >= 0.0 && d4 <= d3 {
        return TriangleClosestPoint { barycentric: [0.0, 1.0, 0.0], distance_sq: bq.length_squared() };
    }
    let (d5, d6) = (ab.dot(cq), ac.dot(cq));
    if d6 >= 0.0 && d5 <= d6 {
        return TriangleClosestPoint { barycentric: [0.0, 0.0, 1.0], distance_sq: cq.length_squared() };
    }
    let (e, f, g) = (ab.length_squared(), ac.length_squared(), (c - b).length_squared());
    let ef = greater(e, f);
    let longest = greater(ef, g);
    let closed = if ab.cross(ac).length_squared() > THIN * longest * longest {
        by_areas([[d1, d2], [d3, d4], [d5, d6]])
    } else {
        None
    };
    let barycentric = closed.unwrap_or_else(|| ThinTriangle::new([a, b, c]).closest_point(q));
    let [u, v, w] = barycentric;
    TriangleClosestPoint { barycentric, distance_sq: (aq * u + bq * v + cq * w).length_squared() }
}

/// The barycentric coordinates of the closest point, which is not a corner, from the dot products of `ab` and
/// `ac` with the offsets of `q` from the three corners; `None` if the areas contradict each other.
#[inline]
fn by_areas([[d1, d2], [d3, d4], [d5, d6]]: [[f64; 2]; 3]) -> Option<[f64; 3]> {
    // Each area is that of the triangle of `q` and one side, seen along the normal: not positive if
    // the foot of `q` is beyond the side.
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 > 0.0 && d3 < 0.0 {
        let t = d1 / (d1 - d3);
        return Some([1.0 - t, t, 0.0]);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 > 0.0 && d6 < 0.0 {
        let t = d2 / (d2 - d6);
        return Some([1.0 - t, 0.0, t]);
    }
    let va = d3 * d6 - d5 * d4;
    let (e4, e5) = (d4 - d3, d5 - d6);
    if va <= 0.0 && e4 > 0.0 && e5 > 0.0 {
        let t = e4 / (e4 + e5);
        return Some([0.0, 1.0 - t, t]);
    }
    let sum = va + vb + vc;
    let (v, w) = (vb / sum, vc / sum);
    let u = 1.0 - v - w;
    // Rounded areas may contradict each other near a corner of the regions.
    (u >= 0.0 && v >= 0.0 && w >= 0.0).then_some([u, v, w])
}

/// A triangle in its own frame, with the longest edge along x. However thin it is, the triangle with corners
/// `(0, 0)`, `(length, 0)` and `apex` is within a few units in the last place of the longest edge of the true
/// one.
struct ThinTriangle {
    /// The corners: start and end of the longest edge, apex.
    order: [usize; 3],
    start: DVec3,
    x: DVec3,
    y: DVec3,
    length: f64,
    apex: [f64; 2],
}

/// `v` minus its components along the unit vectors `axes`; done twice, since the first pass leaves its
/// rounding.
fn reject(v: DVec3, axes: &[DVec3]) -> DVec3 {
    let once = |v: DVec3| axes.iter().fold(v, |v, axis| v - *axis * axis.dot(v));
    once(once(v))
}

fn unit(v: DVec3) -> DVec3 {
    let longest = v.abs().max_element();
    if longest > 0.0 { (v / longest).normalize() } else { DVec3::ZERO }
}

impl ThinTriangle {
    fn new(p: [DVec3; 3]) -> Self {
        let squares: [f64; 3] = std::array::from_fn(|k| (p[(k + 1) % 3] - p[k]).length_squared());
        let k = (1..3).fold(0, |longest, k| if squares[k] > squares[longest] { k } else { longest });
        let order = [k, (k + 1) % 3, (k + 2) % 3];
        let [start, end, apex] = order.map(|i| p[i]);
        let x = unit(end - start);
        let height = reject(apex - start, &[x]);
        let y = unit(height);
        Self {
            order,
            start,
            x,
            y,
            length: (end - start).dot(x),
            apex: [(apex - start).dot(x), height.dot(y)],
        }
    }

    /// The barycentric coordinates of the closest point.
    fn closest_point(&self, q: DVec3) -> [f64; 3] {
        let to = q - self.start;
        let at = [to.dot(self.x), to.dot(self.y)];
        let apex = self.apex;
        let end = [self.length, 0.0];
        let clamped = |x: f64| {
            if x > 0.0 { lesser(x, 1.0) } else { 0.0 }
        };
        // The nearest point of the three edges …
        let edge = |from: [f64; 2], to: [f64; 2]| {
            let along = [to[0] - from[0], to[1] - from[1]];
            let dot = (at[0] - from[0]) * along[0] + (at[1] - from[1]) * along[1];
            let square = along[0] * along[0] + along[1] * along[1];
            let t = if square > 0.0 { clamped(dot / square) } else { 0.0 };
            let offset = [at[0] - from[0] - t * along[0], at[1] - from[1] - t * along[1]];
            (t, offset[0] * offset[0] + offset[1] * offset[1])
        };
        let sides = [edge([0.0; 2], end), edge([0.0; 2], apex), edge(end, apex)];
        let nearest = (1..3).fold(0, |closest, k| if sides[k].1 < sides[closest].1 { k } else { closest });
        let t = sides[nearest].0;
        let mut weights = [[1.0 - t, t, 0.0], [1.0 - t, 0.0, t], [0.0, 1.0 - t, t]][nearest];
        // … or the point itself, if it projects inside.
        let right_of_left = at[0] * apex[1] - at[1] * apex[0] > 0.0;
        let left_of_right = (at[0] - end[0]) * apex[1] - at[1] * (apex[0] - end[0]) < 0.0;
        if at[1] > 0.0 && right_of_left && left_of_right {
            let w = clamped(at[1] / apex[1]);
            let v = clamped((at[0] - w * apex[0]) / self.length);
            weights = [clamped(1.0 - v - w), v, w];
        }
        let mut barycentric = [0.0; 3];
        (0..3).for_each(|k| barycentric[self.order[k]] = weights[k]);
        barycentric
    }
}

/// A proved lower bound for the distance between `q` and the triangle, rounding included. If the distance is
/// surely at least `enough`, the bound may be any number of at least `enough`.
///
/// For any direction `u`, the entire triangle is at least `min (q − corner)·u / |u|` away: it lies beyond
/// that plane. The directions are that from the closest point to `q`, and the component of `q` perpendicular
/// to the edge or face of the closest point. They only affect how tight the bound is; the arithmetic after
/// them is rounded downwards.
pub(super) fn distance_down(q: [f64; 3], corners: [[f64; 3]; 3], enough: f64) -> f64 {
    let barycentric = closest_point(q, corners).barycentric;
    let p = [DVec3::from(corners[0]), DVec3::from(corners[1]), DVec3::from(corners[2])];
    let to = DVec3::from(q);
    let offsets = [to - p[0], to - p[1], to - p[2]];
    let nearest = offsets[0] * barycentric[0] + offsets[1] * barycentric[1] + offsets[2] * barycentric[2];
    let roughly = plane_separation_estimate(offsets, nearest);
    if roughly >= enough {
        return roughly;
    }
    let on = closest_feature(p, barycentric);
    let across = reject(to - p[on.from], &on.axes[..on.n]);
    let [a, b] = [nearest, across].map(|u| plane_separation(q, corners, u));
    greater(a, b)
}

/// [`plane_separation`] in a third of its time and with a wider margin, for `offsets` that are each off by
/// one rounding.
fn plane_separation_estimate(offsets: [DVec3; 3], u: DVec3) -> f64 {
    // Each of the three terms has at most five roundings of 2⁻⁵³, and the sum of their sizes is too low by as
    // many: 2⁻⁵⁰.
    const SHARE: f64 = 4.0 * f64::EPSILON;
    let along = |offset: DVec3| offset.dot(u) - offset.abs().dot(u.abs()) * SHARE;
    let [a, b, c] = [along(offsets[0]), along(offsets[1]), along(offsets[2])];
    let ab = lesser(a, b);
    let lowest = lesser(ab, c);
    // Products that underflow lose less than the smallest normal number; the length and the quotient take
    // four roundings.
    let distance = (lowest - f64::MIN_POSITIVE) / (u.length() * (1.0 + SHARE));
    if distance > 0.0 && u.length_squared() > MIN_SQUARE { distance * (1.0 - SHARE) } else { 0.0 }
}

/// Squares above this have lost nothing significant to underflow.
const MIN_SQUARE: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// Unit vectors that span the edge or face whose interior contains a point, and one of its corners.
struct ClosestFeature {
    from: usize,
    axes: [DVec3; 2],
    n: usize,
}

fn closest_feature(p: [DVec3; 3], barycentric: [f64; 3]) -> ClosestFeature {
    let mut used = (0..3).filter(|k| barycentric[*k] > 0.0);
    let from = used.next().unwrap_or(0);
    match (used.next(), used.next()) {
        (Some(_), Some(_)) => {
            let thin = ThinTriangle::new(p);
            ClosestFeature { from: thin.order[0], axes: [thin.x, thin.y], n: 2 }
        }
        (Some(to), None) => ClosestFeature { from, axes: [unit(p[to] - p[from]), DVec3::ZERO], n: 1 },
        _ => ClosestFeature { from, axes: [DVec3::ZERO; 2], n: 0 },
    }
}

/// A lower bound for the distance of the triangle from `q` beyond the plane perpendicular to `u`; 0 if it is
/// not beyond.
fn plane_separation(q: [f64; 3], corners: [[f64; 3]; 3], u: DVec3) -> f64 {
    // A power of two keeps squares in range and does not change the direction.
    let u = (u * power_of_two(-exponent(u.abs().max_element()))).to_array();
    let along = |corner: [f64; 3]| {
        (0..3).fold(0.0, |sum, k| {
            let end = if u[k] < 0.0 { sub_up(q[k], corner[k]) } else { sub_down(q[k], corner[k]) };
            add_down(sum, mul_down(end, u[k]))
        })
    };
    let lowest = corners.map(along).into_iter().fold(f64::INFINITY, |a, b| lesser(b, a));
    let square = u.iter().fold(0.0, |sum, x| add_up(sum, mul_up(*x, *x)));
    // NaN, from differences that overflow, fails the comparison.
    if lowest > 0.0 { div_down(lowest, sqrt_up(square)) } else { 0.0 }
}

/// An upper bound for the distance between `q` and the triangle: the true distance to the point with these
/// weights, which are ≥ 0 and are divided by their exact sum.
pub(super) fn distance_up(q: [f64; 3], corners: [[f64; 3]; 3], barycentric: [f64; 3]) -> f64 {
    let mut square = 0.0;
    for k in 0..3 {
        let (mut low, mut high) = (0.0, 0.0);
        for (corner, w) in corners.iter().zip(barycentric) {
            low = add_down(low, mul_down(sub_down(q[k], corner[k]), w));
            high = add_up(high, mul_up(sub_up(q[k], corner[k]), w));
        }
        let largest = greater(-low, high);
        square = add_up(square, mul_up(largest, largest));
    }
    let [u, v, w] = barycentric;
    div_up(sqrt_up(square), add_down(add_down(u, v), w))
}
