//! The generalized winding number of a mesh, possibly open or broken, around a point.
//!
//! The winding number of a triangle is the fraction of directions that it covers. Far clusters of triangles
//! are summed by their first two moments; the remainder is bounded, cluster by cluster, by the third
//! derivative of `1/r`: for all x of a cluster around `c` with `|x − c| ≤ r`, seen from a distance `R`,
//! Taylor's remainder is at most `½·|x − c|²·6/(R − r)⁴`, and the solid angle has a factor of `1/4π`. (For a
//! harmonic function the third derivative as a form is largest along one direction, where it is
//! `3!·P₃(cos)/r⁴ ≤ 6/r⁴`.)
//!
//! Sources: A. Jacobson, L. Kavan, O. Sorkine-Hornung, *Robust inside-outside segmentation using generalized
//! winding numbers*, 2013; G. Barill, N. Dickson, R. Schmidt, D. Levin, A. Jacobson, *Fast winding numbers
//! for soups and clouds*, 2018, for the sum by clusters; the bound is our own. A. Van Oosterom, J. Strackee,
//! *The solid angle of a plane triangle*, 1983.
use super::{Bvh, LAST, LEAF, NONE, STACK, WIDTH};
use crate::math::{difference, dot, greater, length, lesser};
use std::f64::consts::PI;

/// The winding number of a surface around a point: 1 inside a closed outward surface, 0 outside, and values
/// between if it is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindingNumber {
    /// The number.
    pub value: f64,
    /// An upper bound for its error: the remainders of clusters, and an allowance for every rounding.
    pub off_at_most: f64,
}

/// The far-field moments of a cluster of triangles, in scaled coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ClusterMoments {
    /// The centroid of the area.
    centre: [f64; 3],
    area: f64,
    /// The sum of the area vectors.
    normal: [f64; 3],
    /// `∫ (x − centre) nᵀ`, its symmetric part: xx, yy, zz, 2·yz, 2·zx, 2·xy.
    tensor: [f64; 6],
    /// `∫ |x − centre|²`.
    second: f64,
    /// No corner is farther from the centre than this.
    radius: f64,
}

impl ClusterMoments {
    fn from_triangle([a, b, c]: [[f64; 3]; 3]) -> Self {
        let centre = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
        let (e, f) = (difference(b, a), difference(c, a));
        let normal = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        let normal = normal.map(|x| 0.5 * x);
        let squares = [a, b, c].map(|p| dot(difference(p, centre), difference(p, centre)));
        let largest = squares.into_iter().fold(0.0, |m, s| greater(s, m));
        let area = length(normal);
        // ∫|x − centre|² over a triangle is a twelfth of its area times the sum of its corners' squared
        // distances.
        let second = area * (squares[0] + squares[1] + squares[2]) / 12.0;
        Self { centre, area, normal, tensor: [0.0; 6], second, radius: grown(largest.sqrt()) }
    }

    fn from_children(parts: &[Self]) -> Self {
        let mut cluster = Self::default();
        for part in parts {
            cluster.area += part.area;
            (0..3).for_each(|k| cluster.normal[k] += part.normal[k]);
            (0..3).for_each(|k| cluster.centre[k] += part.area * part.centre[k]);
        }
        cluster.centre = if cluster.area > 0.0 {
            cluster.centre.map(|x| x / cluster.area)
        } else {
            parts.first().map_or([0.0; 3], |part| part.centre)
        };
        // Moments about a part's own centre, moved to the common one: moments of the second order
        // gain a product with the offset, as in the parallel axis theorem.
        for part in parts {
            let offset = difference(part.centre, cluster.centre);
            let n = part.normal;
            let moved = [
                offset[0] * n[0],
                offset[1] * n[1],
                offset[2] * n[2],
                offset[1] * n[2] + offset[2] * n[1],
                offset[2] * n[0] + offset[0] * n[2],
                offset[0] * n[1] + offset[1] * n[0],
            ];
            (0..6).for_each(|k| cluster.tensor[k] += part.tensor[k] + moved[k]);
            cluster.second += part.second + part.area * dot(offset, offset);
            let radius = grown(length(offset) + part.radius);
            cluster.radius = greater(radius, cluster.radius);
        }
        cluster
    }

    /// The winding number of a cluster and its error; `None` unless the cluster is far enough for an opening
    /// of `1 / closeness`.
    #[inline]
    fn winding_from(&self, q: [f64; 3], closeness: f64) -> Option<[f64; 2]> {
        let d = difference(self.centre, q);
        let square = dot(d, d);
        let away = square.sqrt();
        let gap = away - self.radius;
        // Inside the ball around the cluster the series does not hold.
        if gap <= 0.0 || gap < closeness * self.radius {
            return None;
        }
        let t = &self.tensor;
        let trace = t[0] + t[1] + t[2];
        let along = t[0] * d[0] * d[0]
            + t[1] * d[1] * d[1]
            + t[2] * d[2] * d[2]
            + t[3] * d[1] * d[2]
            + t[4] * d[2] * d[0]
            + t[5] * d[0] * d[1];
        let cube = square * away;
        let value = (dot(self.normal, d) + trace - 3.0 * along / square) / cube;
        let remainder = 3.0 * self.second / (gap * gap) / (gap * gap);
        // A few dozen roundings of sums over the cluster, none of whose terms exceeds its area over the
        // squared gap.
        const ROUNDING: f64 = 256.0 * f64::EPSILON;
        let rounding = ROUNDING * self.area / (gap * gap);
        Some([value / (4.0 * PI), (remainder * (1.0 + ROUNDING) + rounding) / (4.0 * PI)])
    }
}

/// An upper bound for a length after some roundings.
fn grown(x: f64) -> f64 {
    // Margin for eight roundings of half a unit.
    x * (1.0 + 4.0 * f64::EPSILON)
}

/// The fraction of directions that a triangle covers, negative from behind, and a bound on its error.
#[inline]
fn triangle_winding(q: [f64; 3], corners: [[f64; 3]; 3]) -> [f64; 2] {
    let [a, b, c] = corners.map(|p| difference(p, q));
    let (la, lb, lc) = (length(a), length(b), length(c));
    let det = a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0]);
    let size = la * lb * lc;
    let base = size + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    // Some 16 roundings of half a unit in each of the two, of terms that are together at most 4 · size,
    // rotate the angle by that over their length; beyond a full turn there is no bound.
    const ROUNDINGS: f64 = 64.0 * f64::EPSILON;
    let reach = (det * det + base * base).sqrt();
    let error = ROUNDINGS * size / reach;
    let error = lesser(error, 1.0);
    // Seen from the front, the corners run counter-clockwise and the point is outside.
    [libm::atan2(det, base) / (2.0 * PI), error + f64::EPSILON]
}

/// The moments of the subtree of each child of each node.
pub(super) fn moments(bvh: &Bvh) -> Vec<[ClusterMoments; WIDTH]> {
    let mut moments = vec![[ClusterMoments::default(); WIDTH]; bvh.nodes.len()];
    // Children come after their parents.
    for (index, node) in bvh.nodes.iter().enumerate().rev() {
        for lane in 0..WIDTH {
            let child = node.child[lane];
            if child == NONE {
                continue;
            }
            moments[index][lane] = if child & LEAF != 0 {
                let triangle_moments =
                    |row: u32| ClusterMoments::from_triangle(bvh.corners_of(&bvh.triangles[row as usize]));
                ClusterMoments::from_children(
                    &leaf_rows(bvh, child).map(triangle_moments).collect::<Vec<_>>(),
                )
            } else {
                // In an array and not a list: this runs once for each node.
                let below = &bvh.nodes[child as usize];
                let n = below.child.iter().filter(|child| **child != NONE).count();
                let parts = moments[child as usize];
                let mut children = [ClusterMoments::default(); WIDTH];
                let lanes = (0..WIDTH).filter(|k| below.child[*k] != NONE);
                children.iter_mut().zip(lanes).for_each(|(to, k)| *to = parts[k]);
                ClusterMoments::from_children(&children[..n])
            };
        }
    }
    moments
}

/// The rows of a leaf's triangles.
pub(super) fn leaf_rows(bvh: &Bvh, child: u32) -> impl Iterator<Item = u32> + '_ {
    let first = child & !LEAF;
    let n = bvh.triangles[first as usize..].iter().position(|triangle| triangle.face & LAST != 0);
    first..=first + n.unwrap_or(0) as u32
}

/// Up to 2³² errors are summed at a time, each sum rounded by half a unit of 2⁻⁵²: less than 2⁻²⁰ of it.
const SUMMED: f64 = 1.0 + 1.0 / (1 << 20) as f64;
/// Clusters are summed from four radii away at first, and from twice as far each time that the bound is too
/// large. Chosen: a smaller value sums fewer nodes in the first round, and more often needs a second.
const CLOSENESS: f64 = 4.0;
/// Beyond this closeness, all triangles are summed one by one. Chosen: a larger value tries more rounds
/// before it gives up on clusters.
const CLOSEST: f64 = 128.0;

impl Bvh {
    /// The winding number of all triangles around `p`, one by one: the oracle of
    /// [`super::Enclosure::winding_number`]. `None` without faces, and when `p` is not finite. Time O(n),
    /// about 50 ns per triangle.
    #[must_use]
    pub fn winding_number_plain(&self, p: [f64; 3]) -> Option<WindingNumber> {
        let q = self.scaled_query(p)?;
        let sum = self.triangles.iter().map(|triangle| triangle_winding(q, self.corners_of(triangle)));
        Some(total(sum))
    }

    /// `p` in scaled coordinates; `None` without nodes or when it is not finite.
    pub(super) fn scaled_query(&self, p: [f64; 3]) -> Option<[f64; 3]> {
        let q = self.frame.scaled(p);
        (!self.nodes.is_empty() && q.iter().all(|x| x.is_finite())).then_some(q)
    }

    /// The winding number, with an error of at most `within` unless roundings alone are more.
    pub(super) fn winding_by(
        &self,
        moments: &[[ClusterMoments; WIDTH]],
        q: [f64; 3],
        within: f64,
    ) -> WindingNumber {
        let mut closeness = CLOSENESS;
        loop {
            let winding = self.sum(moments, q, closeness);
            if winding.off_at_most <= within || closeness.is_infinite() {
                return winding;
            }
            closeness = if closeness < CLOSEST { 2.0 * closeness } else { f64::INFINITY };
        }
    }

    fn sum(&self, moments: &[[ClusterMoments; WIDTH]], q: [f64; 3], closeness: f64) -> WindingNumber {
        let mut stack = [0_u32; STACK];
        let mut height = 1;
        let (mut value, mut error) = (0.0, 0.0);
        let mut add = |[v, o]: [f64; 2]| {
            value += v;
            // Adding rounds by half a unit of the partial sum.
            error += o + f64::EPSILON * f64::abs(value);
        };
        while height > 0 {
            height -= 1;
            let index = stack[height] as usize;
            let node = &self.nodes[index];
            for (child, moment) in node.child.into_iter().zip(&moments[index]) {
                if child == NONE {
                    continue;
                }
                if let Some(term) = moment.winding_from(q, closeness) {
                    add(term);
                } else if child & LEAF != 0 {
                    for row in leaf_rows(self, child) {
                        add(triangle_winding(q, self.corners_of(&self.triangles[row as usize])));
                    }
                } else {
                    stack[height] = child;
                    height += 1;
                }
            }
        }
        WindingNumber { value, off_at_most: error * SUMMED }
    }
}

/// The sum of many terms, each with its own error; the rounding of the sum is added.
fn total(terms: impl Iterator<Item = [f64; 2]>) -> WindingNumber {
    let (mut value, mut error) = (0.0_f64, 0.0);
    for [v, o] in terms {
        value += v;
        // Half a unit of the partial sum, which is less than this.
        error += o + f64::EPSILON * value.abs();
    }
    WindingNumber { value, off_at_most: error * SUMMED }
}
