//! Closest-point queries.
use super::frame::{BvhFrame, down, up};
use super::triangle;
use super::{Bvh, BvhNode, BvhTriangle, LAST, LEAF, STACK, WIDTH};
use crate::math::{add_up, div_down, div_up, exponent, greater, lesser, power_of_two, sub_down};

/// The closest point of a mesh to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshClosestPoint {
    /// The closest point, rounded.
    pub point: [f64; 3],
    /// The face that contains it; the lowest of equally close ones.
    pub face: u32,
    /// The barycentric coordinates in the face: ≥ 0, with sum 1 up to rounding.
    pub barycentric: [f64; 3],
    /// The squared distance, rounded; 0 below 1e-162 and ∞ above 1e154 (see [`Bvh::closest_distance_up`]).
    pub distance_sq: f64,
}

/// Distance from the middle of the mesh, in local extents, up to which f32 decides between boxes. Chosen:
/// farther out f32 could not distinguish them, and f64 decides.
const FAR: f64 = 64.0;

/// The slack of [`NearQuery::limit`], derived there; more than f64 needs, near and far.
const RELATIVE: f64 = 1.0 + 1.0 / (1 << 18) as f64;
const ABSOLUTE: f64 = 1.0 / (1_u64 << 62) as f64;

/// The squared distances of boxes to a query, in local units: too large by at most the margin of `limit`.
trait BoxDistance {
    /// A squared distance.
    type Square: Copy + PartialOrd;
    /// Larger than any distance, so that every box is opened.
    const ALL: Self::Square;
    fn squares(&self, node: &BvhNode) -> [Self::Square; WIDTH];
    /// Boxes farther away than this contain no triangle whose computed squared distance is at most `best_sq`.
    fn limit(&self, best_sq: f64) -> Self::Square;
}

/// A query near the mesh in local coordinates, rounded down and up to f32.
struct NearQuery {
    low: [f32; 3],
    high: [f32; 3],
}

impl BoxDistance for NearQuery {
    type Square = f32;
    const ALL: f32 = f32::MAX;

    #[inline]
    fn squares(&self, node: &BvhNode) -> [f32; WIDTH] {
        let mut squares = [0.0; WIDTH];
        for k in 0..3 {
            let [low, high] = &node.bounds[k];
            for lane in 0..WIDTH {
                let below = low[lane] - self.high[k];
                let above = self.low[k] - high[lane];
                let gap = greater(below, above);
                let gap = greater(gap, 0.0);
                squares[lane] += gap * gap;
            }
        }
        squares
    }

    /// Seven roundings of 2⁻²⁴ make a square of f32 at most 2⁻²¹ too large; below the normal numbers it is
    /// too large by less than 2⁻¹²⁶. The arithmetic of the triangles computes a distance that is too small by
    /// at most 2⁻⁴⁶ (16 roundings of values up to 130): `(d + 2⁻⁴⁶)² ≤ d²(1 + 2⁻²⁰) + 2⁻⁷¹`. All this is less
    /// than the slack here.
    #[inline]
    fn limit(&self, best_sq: f64) -> f32 {
        let limit = (best_sq * RELATIVE + ABSOLUTE) as f32;
        lesser(limit, Self::ALL)
    }
}

/// A query far from the mesh, in coordinates in which its distance is about 1.
struct FarQuery {
    q: [f64; 3],
    middle: [f64; 3],
    shrink: f64,
}

impl BoxDistance for FarQuery {
    type Square = f64;
    const ALL: f64 = f64::MAX;

    #[inline]
    fn squares(&self, node: &BvhNode) -> [f64; WIDTH] {
        let mut squares = [0.0; WIDTH];
        for k in 0..3 {
            let [low, high] = &node.bounds[k];
            for lane in 0..WIDTH {
                let at = |x: f32| f64::from(x) * self.shrink + self.middle[k];
                let (below, above) = (at(low[lane]) - self.q[k], self.q[k] - at(high[lane]));
                let gap = greater(below, above);
                let gap = greater(gap, 0.0);
                squares[lane] += gap * gap;
            }
        }
        squares
    }

    /// Boxes and triangles are computed with a few dozen roundings of 2⁻⁵³ on values of at most 4, and the
    /// distance is at least 1/4: the error is less than 2⁻⁴⁰ of it.
    #[inline]
    fn limit(&self, best_sq: f64) -> f64 {
        const RELATIVE: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;
        let limit = best_sq * RELATIVE;
        lesser(limit, Self::ALL)
    }
}

/// A query in coordinates that suit its distance: scaled, and shrunk if it is far.
struct ClosestQuery {
    q: [f64; 3],
    /// The scale from world to these coordinates, a power of two.
    scale: f64,
    /// The scale from scaled coordinates to these, a power of two, 1 when near.
    shrink: f64,
}

impl ClosestQuery {
    /// `None` when `p` is not finite.
    fn new(frame: &BvhFrame, p: [f64; 3]) -> Option<Self> {
        let largest = |v: [f64; 3]| v.iter().fold(0.0, |m, x| greater(x.abs(), m));
        if !p.iter().all(|x| x.is_finite()) {
            return None;
        }
        let distance = largest(std::array::from_fn(|k| p[k] * frame.scale - frame.middle[k]));
        if distance <= FAR {
            return Some(Self { q: frame.scaled(p), scale: frame.scale, shrink: 1.0 });
        }
        // If the scaled point overflows, the mesh is a point relative to it, and exponents alone give the
        // distance.
        let scale = exponent(frame.scale) - 1;
        let away = if distance.is_finite() { exponent(distance) } else { exponent(largest(p)) + scale };
        let scale = power_of_two(scale - away);
        Some(Self { q: p.map(|x| x * scale), scale, shrink: power_of_two(-away) })
    }

    fn is_near(&self) -> bool {
        self.shrink == 1.0
    }

    /// The corners of a triangle in these coordinates.
    #[inline]
    fn corners(&self, bvh: &Bvh, triangle: &BvhTriangle) -> [[f64; 3]; 3] {
        let corners = bvh.corners_of(triangle);
        if self.is_near() {
            return corners;
        }
        corners.map(|p| p.map(|x| x * self.shrink))
    }
}

/// The squared distance from `q` to the box of a triangle.
#[inline]
fn box_distance_sq(q: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> f64 {
    let mut square = 0.0;
    for k in 0..3 {
        let (low, high) = if a[k] < b[k] { (a[k], b[k]) } else { (b[k], a[k]) };
        let (low, high) = (lesser(c[k], low), greater(c[k], high));
        let (below, above) = (low - q[k], q[k] - high);
        let gap = greater(below, above);
        let gap = greater(gap, 0.0);
        square += gap * gap;
    }
    square
}

/// The closest triangle so far.
#[derive(Clone, Copy)]
struct ClosestTriangle {
    row: u32,
    face: u32,
    square: f64,
}

impl Bvh {
    /// The closest point of the mesh to `p`; `None` without faces or when `p` is not finite.
    ///
    /// The error of the distance is a few units in the last place of the larger of the distance and the
    /// extent of the mesh around the nearest face, for any shape of the triangles. Of equally close faces
    /// (rounded distances compared exactly) the lowest is returned.
    ///
    /// Cost: O(log n) for points near the mesh. The farther away, the more triangles are equally close, and
    /// from about 10¹² extents on all are.
    #[must_use]
    pub fn closest_point(&self, p: [f64; 3]) -> Option<MeshClosestPoint> {
        let query = ClosestQuery::new(&self.frame, p)?;
        let (closest, near) = self.nearest_triangle(&query)?;
        let triangle = &self.triangles[closest.row as usize];
        let corners = self.corners_of(triangle);
        let point = std::array::from_fn(|k| {
            let [u, v, w] = near.barycentric;
            (u * corners[0][k] + v * corners[1][k] + w * corners[2][k]) / self.frame.scale
        });
        // Divided twice, since the square of the scale may leave the range of f64.
        let distance_sq = near.distance_sq / query.scale / query.scale;
        Some(MeshClosestPoint { point, face: closest.face, barycentric: near.barycentric, distance_sq })
    }

    /// A proved lower bound for the distance from `p` to the mesh, with rounding included: every triangle is
    /// at least this far. `None` as for [`Bvh::closest_point`].
    ///
    /// It is below the true distance by a few units in the last place of the distance to the farthest corner
    /// of the nearest face.
    #[must_use]
    pub fn closest_distance_down(&self, p: [f64; 3]) -> Option<f64> {
        let query = ClosestQuery::new(&self.frame, p)?;
        let mut lowest = f64::INFINITY;
        self.closest_row(&query, |triangle| {
            let corners = query.corners(self, triangle);
            let down = triangle::distance_down(query.q, corners, lowest);
            lowest = lesser(down, lowest);
            down * down
        })?;
        // The error of underflow in these coordinates is less than the smallest normal number.
        let local = sub_down(lowest, f64::MIN_POSITIVE);
        let down = div_down(local, query.scale);
        Some(greater(down, 0.0))
    }

    /// A proved upper bound for the distance from `p` to the mesh, with rounding included: some point of the
    /// mesh is at most this far. `None` as for [`Bvh::closest_point`].
    #[must_use]
    pub fn closest_distance_up(&self, p: [f64; 3]) -> Option<f64> {
        let query = ClosestQuery::new(&self.frame, p)?;
        let (closest, near) = self.nearest_triangle(&query)?;
        let corners = query.corners(self, &self.triangles[closest.row as usize]);
        let local = add_up(triangle::distance_up(query.q, corners, near.barycentric), f64::MIN_POSITIVE);
        Some(div_up(local, query.scale))
    }

    /// [`Bvh::closest_distance_down`] and [`Bvh::closest_distance_up`] by one search. The hint is a row of
    /// the tree: any row for the first of many points, and then the row that the previous query left. It
    /// saves time, and the ends are proved for any hint.
    ///
    /// ```
    /// use chordal::{Job, Mesh, explicit::query::Bvh};
    /// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
    /// let bvh = Bvh::build(&Mesh::new(corners, vec![[0, 1, 2]]).unwrap(), &Job::default())?;
    /// let [low, high] = bvh.closest_distance_ends([0.25, 0.25, 2.0], &mut 0).unwrap();
    /// assert!(low <= 2.0 && 2.0 <= high && high - low < 1e-14);
    /// # Ok::<(), chordal::budget::JobError>(())
    /// ```
    #[must_use]
    pub fn closest_distance_ends(&self, p: [f64; 3], hint: &mut u32) -> Option<[f64; 2]> {
        let query = ClosestQuery::new(&self.frame, p)?;
        let row = if (*hint as usize) < self.triangles.len() { *hint } else { 0 };
        let first = self.triangles.get(row as usize)?;
        let down = |triangle: &BvhTriangle, sufficient: f64| {
            triangle::distance_down(query.q, query.corners(self, triangle), sufficient)
        };
        // From the hinted triangle on, every box that is farther is skipped. A good hint makes that
        // nearly all.
        let mut lowest = down(first, f64::INFINITY);
        let start = ClosestTriangle { row, face: first.face & !LAST, square: lowest * lowest };
        let closest = self.closest_row_from(&query, start, |triangle| {
            // A triangle is farther too if its box is farther by more than any rounding.
            if box_distance_sq(query.q, query.corners(self, triangle)) > lowest * lowest * RELATIVE + ABSOLUTE
            {
                return f64::INFINITY;
            }
            let distance = down(triangle, lowest);
            lowest = lesser(distance, lowest);
            distance * distance
        })?;
        *hint = closest.row;
        let corners = query.corners(self, &self.triangles[closest.row as usize]);
        let near = triangle::closest_point(query.q, corners);
        // The error of underflow in these coordinates is less than the smallest normal number.
        let low = div_down(sub_down(lowest, f64::MIN_POSITIVE), query.scale);
        let high = add_up(triangle::distance_up(query.q, corners, near.barycentric), f64::MIN_POSITIVE);
        Some([greater(low, 0.0), div_up(high, query.scale)])
    }

    fn nearest_triangle(
        &self,
        query: &ClosestQuery,
    ) -> Option<(ClosestTriangle, triangle::TriangleClosestPoint)> {
        let square = |triangle: &BvhTriangle| {
            triangle::closest_point(query.q, query.corners(self, triangle)).distance_sq
        };
        let closest = self.closest_row(query, square)?;
        let corners = query.corners(self, &self.triangles[closest.row as usize]);
        Some((closest, triangle::closest_point(query.q, corners)))
    }

    /// The triangle with the smallest `square`, and among equals the lowest face.
    fn closest_row(
        &self,
        query: &ClosestQuery,
        square: impl FnMut(&BvhTriangle) -> f64,
    ) -> Option<ClosestTriangle> {
        let unknown = ClosestTriangle { row: 0, face: u32::MAX, square: f64::INFINITY };
        self.closest_row_from(query, unknown, square)
    }

    /// The distance from `p` to the mesh, rounded as in [`Bvh::closest_point`], and the row of the closest
    /// triangle. The hint `row` should be near: it saves time and does not affect the answer, because the
    /// search skips only triangles that are certainly farther.
    ///
    /// If no triangle is nearer than `reach` (∞ is allowed), the answer is `reach`, rounded, and the row is
    /// the hint.
    pub(crate) fn distance_within(&self, p: [f64; 3], row: u32, reach: f64) -> Option<(f64, u32)> {
        let query = ClosestQuery::new(&self.frame, p)?;
        let square = |triangle: &BvhTriangle| {
            triangle::closest_point(query.q, query.corners(self, triangle)).distance_sq
        };
        let first = self.triangles.get(row as usize)?;
        let mut start = ClosestTriangle { row, face: first.face & !LAST, square: square(first) };
        let reach = reach * query.scale;
        if (f64::MIN_POSITIVE..start.square).contains(&(reach * reach)) {
            // No face has this number, so that a triangle at exactly this distance wins.
            start = ClosestTriangle { face: u32::MAX, square: reach * reach, ..start };
        }
        // The box of one triangle is smaller than that of its leaf, and faster to test than the triangle.
        let mut best = start.square;
        let closest = self.closest_row_from(&query, start, |triangle| {
            if box_distance_sq(query.q, query.corners(self, triangle)) > best * RELATIVE + ABSOLUTE {
                return f64::INFINITY;
            }
            let value = square(triangle);
            best = lesser(value, best);
            value
        })?;
        Some((closest.square.sqrt() / query.scale, closest.row))
    }

    /// [`Bvh::distance_within`] any distance.
    pub(crate) fn distance_with_hint(&self, p: [f64; 3], row: u32) -> Option<(f64, u32)> {
        self.distance_within(p, row, f64::INFINITY)
    }

    /// Proved lower and upper bounds for the distance from `p` to the triangle of a row, rounding included.
    pub(crate) fn distance_bounds(&self, p: [f64; 3], row: u32) -> Option<[f64; 2]> {
        let query = ClosestQuery::new(&self.frame, p)?;
        let corners = query.corners(self, &self.triangles[row as usize]);
        let near = triangle::closest_point(query.q, corners);
        // Rounding as in `closest_distance_down` and `closest_distance_up`.
        let down = sub_down(triangle::distance_down(query.q, corners, f64::INFINITY), f64::MIN_POSITIVE);
        let up = add_up(triangle::distance_up(query.q, corners, near.barycentric), f64::MIN_POSITIVE);
        let down = div_down(down, query.scale);
        Some([greater(down, 0.0), div_up(up, query.scale)])
    }

    /// The corners and the face of a row, in the coordinates of the mesh.
    pub(crate) fn triangle_of(&self, row: u32) -> ([[f64; 3]; 3], u32) {
        let triangle = &self.triangles[row as usize];
        let corners = self.corners_of(triangle).map(|p| p.map(|x| x / self.frame.scale));
        (corners, triangle.face & !LAST)
    }

    fn closest_row_from(
        &self,
        query: &ClosestQuery,
        start: ClosestTriangle,
        square: impl FnMut(&BvhTriangle) -> f64,
    ) -> Option<ClosestTriangle> {
        if query.is_near() {
            let [low, high] = self.frame.local(query.q);
            self.descend(&NearQuery { low: low.map(down), high: high.map(up) }, start, square)
        } else {
            let middle = self.frame.middle.map(|x| x * query.shrink);
            self.descend(&FarQuery { q: query.q, middle, shrink: query.shrink }, start, square)
        }
    }

    fn descend<S: BoxDistance>(
        &self,
        distances: &S,
        start: ClosestTriangle,
        mut square: impl FnMut(&BvhTriangle) -> f64,
    ) -> Option<ClosestTriangle> {
        if self.nodes.is_empty() {
            return None;
        }
        let mut best = start;
        let mut limit = if best.square < f64::INFINITY { distances.limit(best.square) } else { S::ALL };
        // Pending children, the nearest on top; distances decrease towards the top within each node's
        // children.
        let mut stack = [(S::ALL, 0_u32); STACK];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (box_square, child) = stack[height];
            // The root has the largest number as its distance, and is opened in any case.
            if box_square > limit && box_square < S::ALL {
                continue;
            }
            if child & LEAF != 0 {
                let mut row = child & !LEAF;
                loop {
                    let triangle = &self.triangles[row as usize];
                    let face = triangle.face & !LAST;
                    let value = square(triangle);
                    // Equal distances: the lower face, so that the answer does not depend on the
                    // tree or the hint.
                    if value < best.square || (value == best.square && face < best.face) {
                        best = ClosestTriangle { row, face, square: value };
                        limit = distances.limit(value);
                    }
                    if triangle.face & LAST != 0 {
                        break;
                    }
                    row += 1;
                }
                continue;
            }
            let node = &self.nodes[child as usize];
            let squares = distances.squares(node);
            let bottom = height;
            for (box_square, child) in squares.into_iter().zip(node.child) {
                if box_square <= limit {
                    // Insertion, farthest first: the nearest child is on top and is opened next.
                    let mut at = height;
                    while at > bottom && stack[at - 1].0 < box_square {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (box_square, child);
                    height += 1;
                }
            }
        }
        Some(best)
    }
}
