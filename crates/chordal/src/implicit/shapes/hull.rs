//! Convex hulls: of points in the plane as a polygon, of points or equal balls in space as a leaf.
use super::{InvalidShape, finite_point, largest, not_negative, polygon, sum};
use crate::budget::Evidence;
use crate::implicit::{Distance, Expr, Field, Leaf, LeafAnswer, LeafError, Lipschitz};
use crate::math::{
    Box3, DoubleDouble, Interval, Orientation, add_down, add_up, greater, lesser, orient2d, orient3d,
    sub_down, unit,
};
use std::sync::Arc;

/// The most points of a hull in space. Chosen: its planes are found by trying all triples of points.
pub(super) const MOST_POINTS: usize = 128;

/// The convex hull of points in the plane, unbounded along z. The value is the exact distance.
///
/// # Errors
/// When a number is not finite, or all points lie on a line.
pub fn planar_hull(points: &[[f64; 2]]) -> Result<Field, InvalidShape> {
    points.iter().try_for_each(|p| finite_point("a hull's point", *p).map(|_| ()))?;
    let corners = planar_corners(points);
    if corners.len() < 3 {
        return Err(InvalidShape::Number("the points of a plane hull lie on a line".into()));
    }
    polygon(&corners)
}

/// The corners of the hull, counter-clockwise. Source: A. Andrew, *Another efficient algorithm for convex
/// hulls in two dimensions*, 1979.
pub(super) fn planar_corners(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    let mut corners: Vec<[f64; 2]> = Vec::new();
    let turns = |corners: &[[f64; 2]], p: &[f64; 2]| match corners {
        [.., a, b] => orient2d(*a, *b, *p) == Orientation::Front,
        _ => true,
    };
    for pass in 0..2 {
        let first = corners.len();
        let mut side: Vec<[f64; 2]> = Vec::new();
        for k in 0..sorted.len() {
            let p = if pass == 0 { sorted[k] } else { sorted[sorted.len() - 1 - k] };
            while side.len() >= 2 && !turns(&side, &p) {
                side.pop();
            }
            side.push(p);
        }
        // The last corner is the first of the other side.
        side.pop();
        corners.truncate(first);
        corners.extend(side);
    }
    corners
}

/// The convex hull of points in space, or of balls of one radius around them. The value is the exact
/// distance.
///
/// # Errors
/// When there are no points or more than 128, a number is not finite, the radius is negative, or the points
/// lie in a plane and the radius is 0.
///
/// ```
/// use chordal::implicit::shapes::hull;
/// let wedge = hull(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 0.0)?;
/// assert!((wedge.expr().at([1.0, 1.0, 1.0]).unwrap() - 2.0 / 3.0_f64.sqrt()).abs() < 1e-15);
/// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
/// ```
pub fn hull(points: &[[f64; 3]], radius: f64) -> Result<Field, InvalidShape> {
    points.iter().try_for_each(|p| finite_point("a hull's point", *p).map(|_| ()))?;
    let radius = not_negative("a hull's radius", radius)?;
    if !(1..=MOST_POINTS).contains(&points.len()) {
        let message = format!("a hull has {} points, and must have 1 to {MOST_POINTS}", points.len());
        return Err(InvalidShape::Number(message));
    }
    let hull = ConvexHull::new(points);
    if hull.is_flat() && radius == 0.0 {
        return Err(InvalidShape::Number("the points of a hull lie in a plane, and its radius is 0".into()));
    }
    let (planes, within) = (hull.planes.clone(), Box3::from_points(points));
    let (is_flat, axes) = (hull.is_flat(), Expr::axes());
    let mut value = Expr::leaf(Arc::new(hull), axes.clone());
    let mut bounds = within;
    if radius > 0.0 {
        value = value - radius;
        bounds =
            Box3 { min: within.min.map(|x| sub_down(x, radius)), max: within.max.map(|x| add_up(x, radius)) };
    }
    let field = Field::new(value).known_distance(Distance::EXACT);
    if radius > 0.0 || is_flat {
        return Ok(field.known_bounds(bounds));
    }
    let plane = |HullPlane { normal, through }: &HullPlane| {
        sum((0..3).filter(|k| normal[*k] != 0.0).map(|k| (&axes[k] - through[k]) * normal[k]))
    };
    Ok(field.known_sign(largest(&planes.iter().map(plane).collect::<Vec<_>>())).known_bounds(bounds))
}

/// A plane that holds a face, with the inside below it.
#[derive(Clone, Debug)]
struct HullPlane {
    normal: [f64; 3],
    through: [f64; 3],
}

impl HullPlane {
    fn at(&self, p: [f64; 3]) -> f64 {
        let d = |k: usize| (p[k] - self.through[k]) * self.normal[k];
        d(0) + d(1) + d(2)
    }
}

/// The signed distance to a convex polyhedron; or the distance to a polygon, segment or point, which has no
/// inside.
#[derive(Clone, Debug)]
struct ConvexHull {
    planes: Vec<HullPlane>,
    /// Its faces as triangles; segments and points have equal corners.
    triangles: Vec<[[f64; 3]; 3]>,
    largest: f64,
}

impl ConvexHull {
    fn new(points: &[[f64; 3]]) -> Self {
        let mut points = points.to_vec();
        points.sort_by(|a, b| {
            a.iter().zip(b).fold(std::cmp::Ordering::Equal, |o, (x, y)| o.then(x.total_cmp(y)))
        });
        points.dedup();
        let largest = points.as_flattened().iter().fold(0.0, |most, x| greater(x.abs(), most));
        let mut hull = Self { planes: Vec::new(), triangles: Vec::new(), largest };
        let mut face_sets: Vec<u128> = Vec::new();
        for i in 0..points.len() {
            for j in i + 1..points.len() {
                for k in j + 1..points.len() {
                    hull.add_face(&points, [i, j, k], &mut face_sets);
                }
            }
        }
        if hull.triangles.is_empty() {
            // The points are on a line: the first and the last in this order are its ends.
            let [a, b] = [points[0], points[points.len() - 1]];
            hull.triangles.push([a, b, b]);
        }
        hull
    }

    fn is_flat(&self) -> bool {
        self.planes.is_empty()
    }

    /// Adds the face through three points, if all other points are on one side of it. `face_sets` holds the
    /// points of each face so far, as bits.
    fn add_face(&mut self, points: &[[f64; 3]], [i, j, k]: [usize; 3], face_sets: &mut Vec<u128>) {
        let bits = |k: usize| 1_u128 << k;
        let triple = bits(i) | bits(j) | bits(k);
        // The three points are of a face that is known already.
        if face_sets.iter().any(|face| face & triple == triple) {
            return;
        }
        let corners = [points[i], points[j], points[k]];
        let (mut on_plane, mut front, mut back) = (0_u128, false, false);
        for (at, p) in points.iter().enumerate() {
            match orient3d(corners[0], corners[1], corners[2], *p) {
                Orientation::Flat => on_plane |= bits(at),
                Orientation::Front => front = true,
                Orientation::Back => back = true,
            }
            if front && back {
                return;
            }
        }
        let cross = cross(corners);
        let Some(normal) = unit(cross) else { return };
        face_sets.push(on_plane);
        // Project the face's corners to two axes, without the axis along which the normal is largest.
        let drop = (0..3).fold(0, |best, k| if normal[k].abs() > normal[best].abs() { k } else { best });
        let [u, v] = [(drop + 1) % 3, (drop + 2) % 3];
        let face: Vec<[f64; 3]> =
            (0..points.len()).filter(|at| on_plane & bits(*at) != 0).map(|at| points[at]).collect();
        let flat: Vec<[f64; 2]> = face.iter().map(|p| [p[u], p[v]]).collect();
        let around: Vec<[f64; 3]> = planar_corners(&flat)
            .iter()
            .filter_map(|q| face.iter().find(|p| [p[u], p[v]] == *q).copied())
            .collect();
        for k in 1..around.len().saturating_sub(1) {
            self.triangles.push([around[0], around[k], around[k + 1]]);
        }
        if front || back {
            // The side without points is outside. Corners close to the plane are no evidence: their side is
            // lost in rounding.
            let plane = HullPlane { normal, through: corners[0] };
            let farthest = points
                .iter()
                .map(|p| plane.at(*p))
                .fold(0.0, |most: f64, x| if x.abs() > most.abs() { x } else { most });
            let normal = if farthest > 0.0 { normal.map(|x| -x) } else { normal };
            self.planes.push(HullPlane { normal, ..plane });
        }
    }

    /// The vector from the nearest point of the hull, and the signed distance.
    fn nearest_offset(&self, p: [f64; 3]) -> ([f64; 3], f64) {
        let deepest = self.planes.iter().map(|plane| (plane.at(p), plane.normal));
        let deepest = deepest.reduce(|a, b| if b.0 > a.0 { b } else { a });
        if let Some((depth, normal)) = deepest.filter(|(depth, _)| *depth <= 0.0) {
            return (normal, depth);
        }
        let square = |v: &[f64; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        let away = self.triangles.iter().map(|t| from_triangle(p, t));
        let nearest = away.reduce(|a, b| if square(&b) < square(&a) { b } else { a }).unwrap_or(p);
        (nearest, square(&nearest).sqrt())
    }

    /// A bound on the rounding of distances around `p`. Derived as for polygons: dot products of differences,
    /// each off by some units of the coordinates.
    fn rounding(&self, p: [f64; 3]) -> f64 {
        const UNITS: f64 = 256.0 * f64::EPSILON;
        let size = p.iter().fold(self.largest, |most, x| greater(x.abs(), most));
        add_up(UNITS * size, f64::MIN_POSITIVE)
    }
}

/// The normal of a triangle times twice its area. If the corners are nearly collinear, plain doubles keep no
/// digit of it, and a plane in a wrong direction would cut the hull.
fn cross([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let step = |to: [f64; 3], k: usize| DoubleDouble::two_sum(to[k], -a[k]);
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
        let [along, across] = [step(b, i).times(step(c, j)), step(b, j).times(step(c, i))];
        along.minus(across).hi
    })
}

/// `p` minus its nearest point on a triangle. Source: C. Ericson, *Real-Time Collision Detection*, 5.1.5.
fn from_triangle(p: [f64; 3], [a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let minus = |x: &[f64; 3], y: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| x[k] - y[k]) };
    let dot = |x: &[f64; 3], y: &[f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    let square = |x: &[f64; 3]| dot(x, x);
    let to_segment = |a: &[f64; 3], b: &[f64; 3]| -> [f64; 3] {
        let (along, from) = (minus(b, a), minus(&p, a));
        let t = dot(&from, &along) / square(&along);
        let t = if t > 0.0 { lesser(t, 1.0) } else { 0.0 };
        // Exactly at the end, without the rounding of a sum.
        if t == 1.0 { minus(&p, b) } else { std::array::from_fn(|k| from[k] - t * along[k]) }
    };
    let (ab, ac, ap) = (minus(b, a), minus(c, a), minus(&p, a));
    let (d00, d01, d11) = (square(&ab), dot(&ab, &ac), square(&ac));
    let (d20, d21) = (dot(&ap, &ab), dot(&ap, &ac));
    let area = d00 * d11 - d01 * d01;
    let (v, w) = ((d11 * d20 - d01 * d21) / area, (d00 * d21 - d01 * d20) / area);
    // False for triangles without area, too, of which the sides are left.
    if area > 0.0 && v > 0.0 && w > 0.0 && v + w < 1.0 {
        return std::array::from_fn(|k| ap[k] - v * ab[k] - w * ac[k]);
    }
    let sides = [to_segment(a, b), to_segment(b, c), to_segment(c, a)];
    sides.into_iter().fold(ap, |best, side| if square(&side) < square(&best) { side } else { best })
}

impl Leaf for ConvexHull {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        for (p, value) in points.iter().zip(out) {
            *value = if p.iter().all(|x| x.is_finite()) { self.nearest_offset(*p).1 } else { f64::NAN };
        }
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        for (p, gradient) in points.iter().zip(out) {
            let (away, distance) = self.nearest_offset(*p);
            *gradient = if distance > 0.0 { away.map(|x| x / distance) } else { away };
        }
        Ok(LeafAnswer::Given)
    }

    /// Outside, a point minus its nearest point of a convex set is 1-Lipschitz (firmly non-expansive), so
    /// over a box it stays in a ball around its value at the centre.
    fn gradient_over(&self, boxes: &[Box3], out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        let any = Interval::new(-1.0, 1.0).unwrap_or(Interval::ENTIRE);
        for (bounds, gradient) in boxes.iter().zip(out) {
            *gradient = [any; 3];
            let p = bounds.centre();
            let reach = add_up(0.5 * bounds.diagonal(), self.rounding(p));
            // The centre is rounded.
            let reach = add_up(reach, f64::EPSILON * p.iter().fold(0.0, |sum, x| sum + x.abs()));
            if !reach.is_finite() {
                continue;
            }
            let (away, distance) = self.nearest_offset(p);
            let lowest = sub_down(distance, reach);
            if lowest > 0.0 {
                let length = Interval::new(lowest, add_up(distance, reach)).unwrap_or(Interval::ENTIRE);
                for k in 0..3 {
                    let part = Interval::new(add_down(away[k], -reach), add_up(away[k], reach));
                    gradient[k] = (part.unwrap_or(Interval::ENTIRE) / length).intersection(any);
                }
            }
        }
        Ok(LeafAnswer::Given)
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        None
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        for (bounds, range) in boxes.iter().zip(out) {
            let p = bounds.centre();
            let reach = add_up(0.5 * bounds.diagonal(), self.rounding(p));
            // The centre is rounded.
            let reach = add_up(reach, f64::EPSILON * p.iter().fold(0.0, |sum, x| sum + x.abs()));
            *range = if reach.is_finite() {
                // The exact distance is continuous and 1-Lipschitz.
                Interval::point(self.nearest_offset(p).1)
                    + Interval::new(-reach, reach).unwrap_or(Interval::UNKNOWN)
            } else {
                Interval::ENTIRE
            };
        }
        Ok(LeafAnswer::Given)
    }

    fn evidence(&self) -> Evidence {
        Evidence::Proved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box with another corner, outside an edge by far less than the digits of its coordinates resolve in
    /// products.
    #[test]
    fn a_corner_next_to_an_edge_changes_nothing_elsewhere() {
        let corner = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 3.0 } else { 0.1 });
        let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
        let box_hull = hull(&corners, 0.0).unwrap();
        for ulps in 1..9_u64 {
            let out = |x: f64| f64::from_bits(x.to_bits() + ulps);
            for at in [0.7, 1.1, 2.9] {
                let corners_and_more =
                    [corners.clone(), vec![[at, out(3.0), out(3.0)], [out(3.0), at, 3.0]]].concat();
                let hull_of_more = hull(&corners_and_more, 0.0).unwrap();
                let points = (0..1331).map(|k| [k % 11, k / 11 % 11, k / 121].map(|x| 0.35 * x as f64 - 0.2));
                for p in points {
                    let [expected, actual] =
                        [&box_hull, &hull_of_more].map(|field| field.expr().at(p).unwrap());
                    assert!((expected - actual).abs() < 1e-13, "{ulps} {at} {p:?}: {expected} {actual}");
                }
            }
        }
    }
}
