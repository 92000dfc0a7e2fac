//! [`Contours`] as a leaf. The gradient in a box is enclosed from the edges that may be nearest.
use super::contours::{ContourBvhNode, ContourEdge, Contours};
use super::contours_build;
use crate::budget::Evidence;
use crate::implicit::{Leaf, LeafAnswer, LeafError, Lipschitz};
use crate::math::{Box3, Interval, add_up, greater, length, lesser};
use std::sync::Arc;

const UNIT: [f64; 2] = [-1.0, 1.0];
/// If the sine of an edge pair's turn is smaller, the edges count as straight. Chosen: far above rounding,
/// and the arc between their normals is as short.
const STRAIGHT: f64 = 1e-9;

impl Contours {
    /// An interval of each partial derivative that covers all of Clarke's generalized gradients.
    ///
    /// The gradient is `±(p − q)/|p − q|` with the nearest point `q`: the normal of an edge if `q` is inside
    /// the edge, and between the normals of two edges if `q` is their corner. If an edge is nearest to some
    /// point of the box, its distance from the box's middle is at most the smallest distance there plus the
    /// diameter.
    pub(super) fn slope_over(&self, bounds: &Box3) -> [Interval; 3] {
        let flat =
            Box3 { min: [bounds.min[0], bounds.min[1], 0.0], max: [bounds.max[0], bounds.max[1], 0.0] };
        let [x, y, _] = flat.centre();
        let middle = [x, y];
        // Includes the rounding of the middle.
        let rounding = add_up(self.rounding(middle), f64::EPSILON * (x.abs() + y.abs()));
        let radius = add_up(0.5 * flat.diagonal(), rounding);
        let zero = Interval::point(0.0);
        let unit = range(UNIT);
        if !radius.is_finite() {
            return [unit, unit, zero];
        }
        let reach = add_up(self.value(middle).abs(), add_up(2.0 * radius, rounding));
        let mut hull: Option<[Interval; 2]> = None;
        let is_near = |node: &ContourBvhNode| {
            (0..2)
                .all(|k| node.min[k] <= add_up(middle[k], reach) && node.max[k] >= -add_up(-middle[k], reach))
        };
        self.descend(is_near, |row| {
            let edge = &self.edges[row as usize];
            let ([dx, dy], _) = edge.offset(middle);
            if (dx * dx + dy * dy).sqrt() > reach {
                return;
            }
            for part in self.slopes(edge, &flat, middle, radius) {
                let joined = hull.map_or(part, |hull| [hull[0].hull(part[0]), hull[1].hull(part[1])]);
                hull = Some(joined);
            }
        });
        let [dx, dy] = hull.unwrap_or([unit; 2]);
        [dx, dy, zero]
    }

    /// The gradients at points around `middle` whose nearest point is on an edge.
    fn slopes(&self, edge: &ContourEdge, flat: &Box3, middle: [f64; 2], radius: f64) -> Vec<[Interval; 2]> {
        let along = [edge.b[0] - edge.a[0], edge.b[1] - edge.a[1]];
        let length = length(along);
        let from = [middle[0] - edge.a[0], middle[1] - edge.a[1]];
        let closest = (from[0] * along[0] + from[1] * along[1]) / length;
        // Rounding of the closest point is 8 units of `|p − a|`; many times as much is allowed for.
        let play = radius * (1.0 + 1e-9) + 64.0 * f64::EPSILON * (from[0].abs() + from[1].abs() + length);
        let normal = normal(edge);
        let mut parts = Vec::new();
        if edge.outside == 0 {
            parts.push([range(UNIT), range(UNIT)]);
            return parts;
        }
        if closest + play > 0.0 && closest - play < length {
            parts.push(normal.map(near));
        }
        if closest - play <= 0.0 {
            parts.extend(about_corner([&self.edges[edge.before as usize], edge], flat));
        }
        if closest + play >= length {
            parts.extend(about_corner([edge, &self.edges[edge.after as usize]], flat));
        }
        parts
    }
}

/// The gradients at points of a box whose nearest point is the corner of two edges. They lie between the
/// normals of these, and point away from the corner, or towards it if it is reentrant. None if the box has no
/// such point.
fn about_corner(edges: [&ContourEdge; 2], flat: &Box3) -> Option<[Interval; 2]> {
    let arc = between(normal(edges[0]), normal(edges[1]));
    let along = edges.map(|edge| [edge.b[0] - edge.a[0], edge.b[1] - edge.a[1]]);
    let turn = along[0][0] * along[1][1] - along[0][1] * along[1][0];
    let size = (along[0][0].abs() + along[0][1].abs()) * (along[1][0].abs() + along[1][1].abs());
    // If the edges run straight on, or disagree about the side, only the arc is known.
    let is_straight = turn.abs() <= STRAIGHT * size || turn.is_nan();
    if is_straight || edges[0].outside != edges[1].outside {
        return Some(arc);
    }
    let sign = if (turn > 0.0) == (edges[0].outside > 0) { 1.0 } else { -1.0 };
    let corner = edges[1].a;
    let from: [Interval; 2] =
        std::array::from_fn(|k| range([flat.min[k], flat.max[k]]) - Interval::point(corner[k]));
    let direction = [from[0].direction_cosine(from[1].square()), from[1].direction_cosine(from[0].square())];
    let ranges: [Interval; 2] =
        std::array::from_fn(|k| arc[k].intersection(Interval::point(sign) * direction[k]));
    ranges.iter().all(|range| !range.is_empty()).then_some(ranges)
}

/// The outward normal of an edge, rounded; components that are exactly 0 stay 0.
fn normal(edge: &ContourEdge) -> [f64; 2] {
    let sign = f64::from(edge.outside);
    let n = [sign * (edge.b[1] - edge.a[1]), sign * (edge.a[0] - edge.b[0])];
    let length = length(n);
    n.map(|x| x / length)
}

fn range([low, high]: [f64; 2]) -> Interval {
    Interval::new(low, high).unwrap_or(Interval::UNKNOWN)
}

/// A rounded component of a unit vector, after six roundings of half a unit.
fn near(x: f64) -> Interval {
    let error = 8.0 * f64::EPSILON * x.abs();
    let (low, high) = (x - error, x + error);
    range([greater(low, -1.0), lesser(high, 1.0)])
}

/// All unit vectors on the shorter arc between two. A component reaches ±1 only if that direction is on the
/// arc.
fn between(a: [f64; 2], b: [f64; 2]) -> [Interval; 2] {
    let cross = a[0] * b[1] - a[1] * b[0];
    // Nearly opposite vectors may span either arc; the threshold is far more than their rounding.
    let opposite = a[0] * b[0] + a[1] * b[1] < -1.0 + 1e-12;
    let on_arc = |d: [f64; 2]| {
        let (from, to) = ((a[0] * d[1] - a[1] * d[0]) * cross, (d[0] * b[1] - d[1] * b[0]) * cross);
        let ahead = (a[0] + b[0]) * d[0] + (a[1] + b[1]) * d[1] > -1e-12;
        // Derived: the products are rounded by less than 1e-15, and an arc may be that much longer.
        opposite || (from >= -1e-14 && to >= -1e-14 && ahead && cross != 0.0)
    };
    std::array::from_fn(|k| {
        let mut axis = [0.0; 2];
        axis[k] = 1.0;
        let mut part = near(a[k]).hull(near(b[k]));
        if on_arc(axis) {
            part = part.hull(Interval::point(1.0));
        }
        if on_arc(axis.map(|x: f64| -x)) {
            part = part.hull(Interval::point(-1.0));
        }
        part
    })
}

impl Leaf for Contours {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        // Neighbours in a batch are often neighbours in space.
        let mut start = 0;
        for ([x, y, _], value) in points.iter().zip(out) {
            if x.is_finite() && y.is_finite() {
                (*value, start, _) = self.signed([*x, *y], start);
            } else {
                *value = f64::NAN;
            }
        }
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        for ([x, y, _], gradient) in points.iter().zip(out) {
            let (value, row, inside) = self.signed([*x, *y], 0);
            let edge = &self.edges[row as usize];
            let (offset, t) = edge.offset([*x, *y]);
            *gradient = if value == 0.0 || (0.0 < t && t < 1.0) {
                // The normal of the edge, towards the outside.
                let n = [edge.b[1] - edge.a[1], edge.a[0] - edge.b[0]];
                let length = length(n);
                let to_right = offset[0] * n[0] + offset[1] * n[1] > 0.0;
                let outward = if edge.outside == 0 { to_right != inside } else { edge.outside > 0 };
                let sign = if outward { 1.0 } else { -1.0 };
                [sign * n[0] / length, sign * n[1] / length, 0.0]
            } else {
                [offset[0] / value, offset[1] / value, 0.0]
            };
        }
        Ok(LeafAnswer::Given)
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        for (bounds, range) in boxes.iter().zip(out) {
            let flat =
                Box3 { min: [bounds.min[0], bounds.min[1], 0.0], max: [bounds.max[0], bounds.max[1], 0.0] };
            let [x, y, _] = flat.centre();
            // The middle is rounded: half of the diagonal and a unit of rounding reach every point of the
            // box.
            let reach = add_up(
                0.5 * flat.diagonal(),
                add_up(self.rounding([x, y]), f64::EPSILON * (x.abs() + y.abs())),
            );
            *range = if reach.is_finite() {
                // The exact distance is continuous and 1-Lipschitz.
                Interval::point(self.value([x, y]))
                    + Interval::new(-reach, reach).unwrap_or(Interval::UNKNOWN)
            } else {
                Interval::ENTIRE
            };
        }
        Ok(LeafAnswer::Given)
    }

    fn gradient_over(&self, boxes: &[Box3], out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        for (bounds, gradient) in boxes.iter().zip(out) {
            *gradient = self.slope_over(bounds);
        }
        Ok(LeafAnswer::Given)
    }

    fn without_axis(&self, axis: f64) -> Option<Arc<dyn Leaf>> {
        let joined = contours_build::with_mirror_image(self, axis)?;
        Some(Arc::new(joined))
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        Some(Lipschitz { constant: 1.0, error: self.rounding([self.largest; 2]) })
    }

    fn evidence(&self) -> Evidence {
        Evidence::Proved
    }
}
