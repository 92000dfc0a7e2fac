//! The inside of simple contours as a CSG formula of half-planes, one for each edge.
//!
//! A distance to contours has kinks where the nearest edge changes, also at the contours' corners. Its sign
//! can be written without kinks. A simple chain of edges, whose first and last are rays, is split at a corner
//! `v` of its convex hull. Both parts, with the edges at `v` extended to rays, are simple chains again, since
//! these rays leave the hull. The region left of the chain is the intersection of the regions left of the
//! parts if the chain turns left at `v`, otherwise their union. So every edge occurs once in the formula.
//!
//! Source: D. Dobkin, L. Guibas, J. Hershberger, J. Snoeyink, *An efficient algorithm for finding the CSG
//! representation of a simple polygon*, 1988. The search for the corner is derived here: it is the lowest
//! corner in a direction in which both rays leave.
use super::contours::ContourEdge;
use crate::implicit::Expr;
use crate::math::{Orientation, dot_sign, greater, length, orient2d};
use std::cmp::Ordering;

/// The most edges of a contour. Defined: finding the corners takes the square of their number at worst.
const MOST_EDGES: usize = 1024;
/// Edges count as collinear if they are off one line by at most this fraction of their size. Derived: some
/// hundred roundings of coordinates. Half-planes on both sides of one line are then complements, and leave no
/// crack between them without an edge.
const SAME: f64 = 1.0 / (1_u64 << 45) as f64;
/// Edges that are off by more than [`SAME`] and less than this would leave such a crack. Defined: far above
/// rounding.
const NEAR: f64 = 1.0 / (1_u64 << 30) as f64;

type PlanarPoint = [f64; 2];

/// An expression in two coordinates that is negative inside the contours of these edges, with the inside of
/// each edge on the side opposite to [`ContourEdge::outside`]. None if that exceeds the limits, or would
/// leave cracks.
pub(super) fn half_plane_formula(edges: &[ContourEdge], [x, y]: [&Expr; 2]) -> Option<Expr> {
    if edges.len() > MOST_EDGES || edges.iter().any(|edge| edge.outside == 0) {
        return None;
    }
    let mut loops: Vec<PolygonLoop> = Vec::new();
    let mut start = 0;
    while start < edges.len() {
        let n = edges[start..].iter().take_while(|edge| edge.contour == edges[start].contour).count();
        loops.push(PolygonLoop::from_edges(&edges[start..start + n]));
        start += n;
    }
    let mut lines = HalfPlaneCache { at: [x, y], formulas: Vec::new() };
    let inside: Vec<Expr> = loops.iter().map(|polygon| polygon.inside(&mut lines)).collect::<Option<_>>()?;
    // A clockwise loop is a hole in the smallest loop around it.
    let outer_of = |hole: &PolygonLoop| {
        let around = |k: &usize| loops[*k].is_outer && loops[*k].encloses(hole.corners[0]);
        (0..loops.len()).filter(around).min_by(|a, b| loops[*a].area().total_cmp(&loops[*b].area()))
    };
    let outer: Vec<Option<usize>> =
        loops.iter().map(|polygon| if polygon.is_outer { None } else { outer_of(polygon) }).collect();
    let mut union: Option<Expr> = None;
    for (k, solid) in inside.iter().enumerate().filter(|(k, _)| loops[*k].is_outer) {
        let holes = (0..loops.len()).filter(|hole| outer[*hole] == Some(k));
        let solid = holes.fold(solid.clone(), |solid, hole| solid.max(&inside[hole]));
        union = Some(union.map_or(solid.clone(), |union| union.min(&solid)));
    }
    union
}

/// A closed contour with the inside on its left.
struct PolygonLoop {
    corners: Vec<PlanarPoint>,
    is_outer: bool,
}

impl PolygonLoop {
    fn from_edges(edges: &[ContourEdge]) -> Self {
        let mut corners: Vec<PlanarPoint> = edges.iter().map(|edge| edge.a).collect();
        if edges.iter().any(|edge| edge.outside < 0) {
            corners.reverse();
        }
        // Collinear edges become one edge.
        let n = corners.len();
        let bends: Vec<bool> = (0..n).map(|k| turn_at(&corners, k) != Orientation::Flat).collect();
        let mut bends = bends.into_iter();
        corners.retain(|_| bends.next() == Some(true));
        // The lowest corner is on the hull: a loop that turns left there runs counter-clockwise.
        let is_outer = turn_at(&corners, lowest_corner(&corners)) == Orientation::Front;
        Self { corners, is_outer }
    }

    /// Whether a point off the contour is inside it, for either orientation.
    fn encloses(&self, p: PlanarPoint) -> bool {
        let n = self.corners.len();
        let crosses = |k: &usize| {
            let (a, b) = (self.corners[*k], self.corners[(*k + 1) % n]);
            // Half-open, so that a corner at the height of p counts once.
            let up = a[1] <= p[1] && b[1] > p[1];
            let down = b[1] <= p[1] && a[1] > p[1];
            up && orient2d(a, b, p) == Orientation::Front || down && orient2d(a, b, p) == Orientation::Back
        };
        (0..n).filter(crosses).count() % 2 == 1
    }

    fn area(&self) -> f64 {
        let n = self.corners.len();
        let parts = (0..n).map(|k| {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % n]);
            a[0] * b[1] - a[1] * b[0]
        });
        (0.5 * parts.sum::<f64>()).abs()
    }

    /// The formula of the inside, split at the smallest and the largest corner, which are on the hull.
    fn inside(&self, lines: &mut HalfPlaneCache) -> Option<Expr> {
        let n = self.corners.len();
        let from = lowest_corner(&self.corners);
        let corners: Vec<PlanarPoint> = (0..=n).map(|k| self.corners[(from + k) % n]).collect();
        let split = (1..n).reduce(|best, k| if corners[k] > corners[best] { k } else { best })?;
        let chain = PolygonChain { corners: &corners };
        let (first, second) = (chain.left([0, split], lines)?, chain.left([split, n], lines)?);
        Some(if self.is_outer { first.max(&second) } else { first.min(&second) })
    }
}

/// The lexicographically smallest corner.
fn lowest_corner(corners: &[PlanarPoint]) -> usize {
    (1..corners.len()).fold(0, |best, k| if corners[k] < corners[best] { k } else { best })
}

fn turn_at(corners: &[PlanarPoint], k: usize) -> Orientation {
    let n = corners.len();
    orient2d(corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n])
}

struct PolygonChain<'a> {
    corners: &'a [PlanarPoint],
}

impl PolygonChain<'_> {
    /// The region left of the edges from one corner to another, with the first and last as rays.
    fn left(&self, [first, last]: [usize; 2], lines: &mut HalfPlaneCache) -> Option<Expr> {
        let mut parts = vec![(first, last)];
        // The splits of all parts in prefix order, without recursion; None for an edge.
        let mut splits: Vec<Option<Orientation>> = Vec::new();
        while let Some((from, to)) = parts.pop() {
            if to - from == 1 {
                splits.push(None);
                continue;
            }
            let corner = self.hull_corner(from, to)?;
            let [a, b, c] = [corner - 1, corner, corner + 1].map(|k| self.corners[k]);
            splits.push(Some(orient2d(a, b, c)));
            parts.extend([(corner, to), (from, corner)]);
        }
        // Read backwards, operands come before their operator, and edges come in reverse order.
        let mut formulas: Vec<Expr> = Vec::new();
        let mut edge = last;
        for split in splits.into_iter().rev() {
            let formula = match split {
                None => {
                    edge -= 1;
                    lines.half_plane([self.corners[edge], self.corners[edge + 1]])?
                }
                Some(turn) => {
                    let (a, b) = (formulas.pop()?, formulas.pop()?);
                    match turn {
                        Orientation::Front => a.max(&b),
                        Orientation::Back => a.min(&b),
                        Orientation::Flat => return None,
                    }
                }
            };
            formulas.push(formula);
        }
        formulas.pop()
    }

    /// A corner of the hull between two corners of the chain.
    fn hull_corner(&self, from: usize, to: usize) -> Option<usize> {
        let edge = |k: usize| {
            let (a, b) = (self.corners[k], self.corners[k + 1]);
            let along = [b[0] - a[0], b[1] - a[1]];
            let length = length(along);
            along.map(|x| x / length)
        };
        let (first, last) = (edge(from), edge(to - 1));
        // Both rays run upward along this direction. A tie goes to the first corner along `first`, which is
        // on the hull.
        let up = [last[0] - first[0], last[1] - first[1]];
        let rises = |k: usize, sign: f64| {
            dot_sign(up.map(|x| sign * x), self.corners[k], self.corners[k + 1]) == Ordering::Greater
        };
        if up != [0.0; 2] && rises(from, -1.0) && rises(to - 1, 1.0) {
            let low = self.lowest(from, to, up, [-up[1], up[0]]);
            return Some(low);
        }
        // Rays of opposite direction: the hull corner is below them, or above.
        let across = [-first[1], first[0]];
        [across, across.map(|x| -x)].into_iter().find_map(|up| {
            let low = self.lowest(from, to, up, first);
            (dot_sign(up, self.corners[from + 1], self.corners[low]) == Ordering::Less
                && dot_sign(up, self.corners[from], self.corners[low]) == Ordering::Less)
                .then_some(low)
        })
    }

    /// The lowest inner corner along `up`; among equally low ones the first along `then`.
    fn lowest(&self, from: usize, to: usize, up: PlanarPoint, then: PlanarPoint) -> usize {
        (from + 2..to).fold(from + 1, |best, k| {
            let (a, b) = (self.corners[best], self.corners[k]);
            let order = dot_sign(up, a, b).then_with(|| dot_sign(then, a, b));
            if order == Ordering::Less { k } else { best }
        })
    }
}

/// The half-planes of the edges so far.
struct HalfPlaneCache<'a> {
    /// The two coordinates.
    at: [&'a Expr; 2],
    formulas: Vec<([PlanarPoint; 2], Expr)>,
}

impl HalfPlaneCache<'_> {
    /// Negative on the left of the line from `a` to `b`. Edges on one line share an expression, or have its
    /// negation. None if an edge is nearly on the line of another.
    fn half_plane(&mut self, edge: [PlanarPoint; 2]) -> Option<Expr> {
        for (other, expr) in &self.formulas {
            match line_relation(edge, *other) {
                LineRelation::Other => {}
                LineRelation::Near => return None,
                LineRelation::Same => return Some(expr.clone()),
                LineRelation::Opposite => return Some(-expr),
            }
        }
        let expr = half_plane(edge, self.at);
        self.formulas.push((edge, expr.clone()));
        Some(expr)
    }
}

/// The relation between the lines of two edges.
enum LineRelation {
    Other,
    /// Nearly one line, but by more than rounding.
    Near,
    Same,
    Opposite,
}

fn line_relation([a, b]: [PlanarPoint; 2], [p, q]: [PlanarPoint; 2]) -> LineRelation {
    let (along, line) = ([b[0] - a[0], b[1] - a[1]], [q[0] - p[0], q[1] - p[1]]);
    let size = line[0].abs() + line[1].abs();
    // The distances of both ends from the line, as fractions of the numbers that they are computed from.
    let relative_distance = |c: PlanarPoint| {
        let from = [c[0] - p[0], c[1] - p[1]];
        let distance = (line[0] * from[1] - line[1] * from[0]).abs();
        let coordinates = [a, b, p, q].as_flattened().iter().fold(0.0, |m: f64, x| greater(x.abs(), m));
        distance / (size * coordinates)
    };
    let (first, second) = (relative_distance(a), relative_distance(b));
    let largest = greater(first, second);
    if largest > NEAR {
        LineRelation::Other
    } else if largest > SAME {
        LineRelation::Near
    } else if along[0] * line[0] + along[1] * line[1] > 0.0 {
        LineRelation::Same
    } else {
        LineRelation::Opposite
    }
}

/// Negative on the left of the line from `a` to `b`: the signed distance to it, up to rounding.
fn half_plane([a, b]: [PlanarPoint; 2], [x, y]: [&Expr; 2]) -> Expr {
    let along = [b[0] - a[0], b[1] - a[1]];
    if along[0] == 0.0 {
        return if along[1] > 0.0 { x - a[0] } else { Expr::constant(a[0]) - x };
    }
    if along[1] == 0.0 {
        return if along[0] > 0.0 { Expr::constant(a[1]) - y } else { y - a[1] };
    }
    let length = length(along);
    let normal = [along[1] / length, -along[0] / length];
    (x - a[0]) * normal[0] + (y - a[1]) * normal[1]
}

#[cfg(test)]
mod tests {
    use crate::implicit::shapes::{ContourFill, Contours};
    use crate::implicit::{Csg, Tape};
    use chordal_testkit::Random;

    /// Checks that half-planes and the distance put points off the contour on the same side. Returns whether
    /// there is a formula of half-planes.
    fn agrees(contours: &[Vec<[f64; 2]>], random: &mut Random) -> bool {
        let Ok(shape) = Contours::new(contours, ContourFill::EvenOdd) else { return false };
        let n_edges = shape.edges.len();
        let [min, max] = shape.bounds;
        let field = shape.into_field();
        if !field.has_sign() {
            return false;
        }
        let csg = Csg::from_expr(field.sign());
        assert!(csg.primitives().len() <= n_edges, "each edge stands in the formula once at most");
        let points: Vec<[f64; 3]> = (0..400)
            .map(|_| {
                let at = |k: usize, t: f64| min[k] - 0.5 + t * (max[k] - min[k] + 1.0);
                [at(0, random.unit()), at(1, random.unit()), 0.0]
            })
            .collect();
        let (mut distances, mut signs) = (vec![0.0; 400], vec![0.0; 400]);
        field.tape().at(&points, &mut distances).unwrap();
        Tape::new(field.sign()).at(&points, &mut signs).unwrap();
        for ((distance, sign), p) in distances.iter().zip(&signs).zip(&points) {
            assert!(distance.abs() < 1e-9 || (*distance < 0.0) == (*sign < 0.0), "{p:?} of {contours:?}");
        }
        true
    }

    /// Connected cells of a square lattice as one contour: many collinear edges and equal coordinates.
    fn staircase(random: &mut Random, n: usize) -> Vec<[f64; 2]> {
        let (mut low, mut high) = (Vec::new(), Vec::new());
        for k in 0..n {
            let (a, b) = (random.below(4) as f64, 5.0 + random.below(4) as f64);
            low.extend([[k as f64, a], [k as f64 + 1.0, a]]);
            high.extend([[k as f64, b], [k as f64 + 1.0, b]]);
        }
        high.reverse();
        low.extend(high);
        low
    }

    #[test]
    fn stars_combs_and_staircases_are_formulas_of_half_planes() {
        let mut random = Random::new(11);
        let mut n_made = 0;
        for case in 0..300_usize {
            let n = 3 + random.below(40);
            let outline: Vec<[f64; 2]> = match case % 3 {
                // A star about the origin: simple for all radii.
                0 => (0..n)
                    .map(|k| {
                        let angle = std::f64::consts::TAU * k as f64 / n as f64;
                        let r = 0.2 + 2.0 * random.unit();
                        [r * libm::cos(angle), r * libm::sin(angle)]
                    })
                    .collect(),
                // A star with integer coordinates, often collinear and sometimes degenerate.
                1 => (0..n)
                    .map(|k| {
                        let angle = std::f64::consts::TAU * k as f64 / n as f64;
                        let r = 3.0 + 9.0 * random.unit();
                        [(r * libm::cos(angle)).round(), (r * libm::sin(angle)).round()]
                    })
                    .collect(),
                _ => staircase(&mut random, n),
            };
            n_made += usize::from(agrees(&[outline], &mut random));
        }
        assert!(n_made > 200, "{n_made}");
    }

    #[test]
    fn a_spiral_is_a_formula_of_half_planes() {
        let mut random = Random::new(3);
        let arm = |r: f64| {
            move |k: u32| {
                let angle = 0.4 * f64::from(k);
                let r = r + 0.1 * angle;
                [r * libm::cos(angle), r * libm::sin(angle)]
            }
        };
        let mut outline: Vec<[f64; 2]> = (0..60).map(arm(0.5)).collect();
        outline.extend((0..60).rev().map(arm(0.2)));
        assert!(agrees(&[outline], &mut random));
    }

    #[test]
    fn holes_and_islands_are_in_the_formula() {
        let mut random = Random::new(4);
        let square = |half: f64, x: f64| {
            vec![[x - half, -half], [x + half, -half], [x + half, half], [x - half, half]]
        };
        let contours =
            [square(5.0, 0.0), square(3.0, 1.0), square(1.0, 1.5), square(0.5, -3.5), square(1.0, 8.0)];
        assert!(agrees(&contours, &mut random));
    }
}
