//! `FlatTriangle`: bounds the distance of a surface over a triangle from the flat triangle between three
//! vertices, by distances of control points.
//!
//! Let `S` be the surface, a disc with its border in three curves, `M` the triangle between its corners, `π`
//! the projection into the plane of `M`.
//!
//! *Surface to mesh.* The distance from the convex `M` is a convex function, so over a piece of `S` in the
//! hull of control points it is no more than the largest distance of these; `V` is the largest over all pieces.
//!
//! *Mesh to surface.* Let a side of `M` be within `ε` of its curve in space and within `δ` in the plane, both
//! by pairing a point of the curve with the nearest of the side, which is continuous and covers the side.
//! Moving `π(∂S)` to `∂M` along these pairs moves nothing by more than `δ`. So around a point `x` of `M` that
//! is farther than `δ` from each side the curve `π(∂S)` winds once, as `∂M` does: `x` is the projection of a
//! point of `S`, whose distance from `M` is its height over `x`, at most `V`. Any other `x` is within `δ` of
//! a side's point, and that is within `ε` of `S`.
//!
//! So the distance in both directions is at most the larger of `V` and the largest `ε + δ` of a side. Pieces
//! and curves are subdivided, the worst first, until that is within a tolerance or some point of the surface
//! shows that it is not.
//!
//! **Rounding.** An error `e` of vertices moves the ends of curves by as much. This adds `e` to each of `V`, `ε`,
//! `δ` and leaves `e` of a side's ends uncovered: [`LoopLeaf`](super::leaf::LoopLeaf) adds `4 e`. The distance
//! from `M` is rounded up. Distances from sides are sums of three products relative to a corner, with an error of
//! some roundings of the distance from that corner, [`NEAR_SIDE`]. The error of the unit normal is some roundings
//! times the square of the longest side over twice the area.
use super::cell::LoopCellShape;
use crate::check::distance_up;
use crate::explicit::InvalidCage;
use crate::explicit::cage::limit::Quartic;
use crate::math::{PriorityItem, branch_and_bound, lesser};
use glam::DVec3;
use std::collections::BinaryHeap;

/// The largest number of visited pieces. Chosen: a leaf that needs more is split instead.
const MOST_PIECES: usize = 300;
/// The largest depth of subdivision: 2⁻⁴⁵ of a face is below rounding.
const DEEPEST: usize = 45;
/// A triangle with less area than this fraction of its longest side squared has no plane for the proof. Chosen: the
/// roundings of its normal would be too large.
const LEAST_SHAPE: f64 = 1e-6;
/// Roundings in a unit normal, with a margin: six products and differences of lengths up to a side, and the
/// quotient.
const TILT: f64 = 32.0 * f64::EPSILON;
/// Roundings of a distance from a side, relative to the distance from the corner: two dot products, a
/// quotient, a length; with a margin.
const NEAR_SIDE: f64 = 64.0 * f64::EPSILON;

/// A piece of the surface: a polynomial with its error, or an extraordinary piece that is not yet subdivided.
pub(crate) enum LoopPiece<'a> {
    Quartic(Box<Quartic>, f64),
    Extraordinary(LoopCellShape<'a>),
}

/// A flat triangle.
pub(crate) struct FlatTriangle {
    corners: [[f64; 3]; 3],
    /// Its unit normal and the error of that normal.
    normal: Option<(DVec3, f64)>,
    /// The tolerance that a bound should meet.
    tolerance: f64,
}

/// A piece and its depth of subdivision.
struct LoopQueueEntry<T> {
    piece: T,
    depth: usize,
    /// A lower limit for every bound of the piece.
    least: f64,
}

/// A side's curve, or a piece of the surface that contains it.
enum LoopSideCurve<'a> {
    Quartic([[f64; 3]; 5], f64),
    Extraordinary(LoopCellShape<'a>),
}

impl FlatTriangle {
    pub(crate) fn new(corners: [[f64; 3]; 3], tolerance: f64) -> Self {
        let [a, b, c] = corners.map(DVec3::from);
        let area = (b - a).cross(c - a);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        let is_sound = area.length() > LEAST_SHAPE * longest && area.length() >= f64::MIN_POSITIVE;
        let normal = is_sound.then(|| (area / area.length(), TILT * longest / area.length()));
        Self { corners, normal, tolerance }
    }

    /// A bound in both directions; a value above the tolerance only says that the tolerance could not be
    /// proved.
    pub(crate) fn bound(&self, piece: LoopPiece<'_>) -> f64 {
        let mut most = 0.0_f64;
        for side in 0..3 {
            most = most.max(match &piece {
                LoopPiece::Quartic(quartic, off) => {
                    self.side_distance(side, LoopSideCurve::Quartic(quartic.side(side), *off))
                }
                LoopPiece::Extraordinary(shape) => {
                    self.side_distance(side, LoopSideCurve::Extraordinary(*shape))
                }
            });
            if most > self.tolerance {
                return most;
            }
        }
        most.max(self.interior_distance(piece))
    }

    fn interior_distance(&self, piece: LoopPiece<'_>) -> f64 {
        let open = BinaryHeap::from([self.queue_piece(piece, 0)]);
        let is_settled = |worst: &PriorityItem<LoopQueueEntry<LoopPiece<'_>>>, _| {
            // No division brings a piece whose `least` is above the tolerance within it, and one such piece
            // decides.
            let (bound, item) = (worst.bound, &worst.item);
            bound <= self.tolerance || item.least > self.tolerance || item.depth > DEEPEST
        };
        let bound = branch_and_bound(open, MOST_PIECES, is_settled, |item, open| {
            let depth = item.depth + 1;
            match item.piece {
                LoopPiece::Quartic(quartic, off) => {
                    for quarter in quartic.quarters() {
                        open.push(self.queue_piece(LoopPiece::Quartic(Box::new(quarter), off), depth));
                    }
                }
                LoopPiece::Extraordinary(LoopCellShape::Extraordinary(extraordinary)) => {
                    for quarter in extraordinary.quarters()? {
                        open.push(self.queue_piece(
                            LoopPiece::Extraordinary(LoopCellShape::from_triangle(quarter)),
                            depth,
                        ));
                    }
                }
                LoopPiece::Extraordinary(LoopCellShape::Polynomial(polynomial)) => {
                    let quartic = Box::new(polynomial.quartic);
                    open.push(self.queue_piece(LoopPiece::Quartic(quartic, polynomial.off), depth));
                }
            }
            Ok::<_, InvalidCage>(())
        });
        bound.unwrap_or(f64::INFINITY)
    }

    fn queue_piece<'a>(
        &self,
        piece: LoopPiece<'a>,
        depth: usize,
    ) -> PriorityItem<LoopQueueEntry<LoopPiece<'a>>> {
        let far = |points: &[[f64; 3]]| {
            points.iter().fold(0.0_f64, |most, point| most.max(distance_up(*point, &self.corners)))
        };
        let (bound, least) = match &piece {
            LoopPiece::Quartic(quartic, off) => {
                // The corners are points of the surface, so that no bound is less than their distance.
                let ends = [0, 4, 14].map(|k| quartic.control[k]);
                (far(&quartic.control) + off, ALMOST * far(&ends) - off)
            }
            LoopPiece::Extraordinary(shape) => (far(shape.hull()) + piece_error(*shape), 0.0),
        };
        PriorityItem { bound, item: LoopQueueEntry { piece, depth, least } }
    }

    /// The distance of a side's curve from its chord, in space and in the plane together.
    fn side_distance(&self, side: usize, curve: LoopSideCurve<'_>) -> f64 {
        let mut open = BinaryHeap::new();
        open.push(self.queue_curve(side, curve, 0));
        let (mut space, mut plane) = (0.0_f64, 0.0_f64);
        // The largest distances in space and in the plane may belong to two pieces, so all remaining pieces are
        // included then.
        let take =
            |item: &LoopQueueEntry<(LoopSideCurve<'_>, [f64; 2])>, space: &mut f64, plane: &mut f64| {
                (*space, *plane) = (space.max(item.piece.1[0]), plane.max(item.piece.1[1]));
            };
        for _ in 0..MOST_PIECES {
            let Some(PriorityItem { bound, item }) = open.pop() else { break };
            let known = (space + plane).max(FINE * self.tolerance);
            if bound <= known || item.least > self.tolerance || item.depth > DEEPEST {
                take(&item, &mut space, &mut plane);
                break;
            }
            let depth = item.depth + 1;
            match item.piece.0 {
                LoopSideCurve::Quartic(points, off) => {
                    // Subdivided until the gain would be small.
                    if depth > HALVINGS {
                        take(
                            &LoopQueueEntry {
                                piece: (LoopSideCurve::Quartic(points, off), item.piece.1),
                                ..item
                            },
                            &mut space,
                            &mut plane,
                        );
                        continue;
                    }
                    for half in halve_curve(&points) {
                        open.push(self.queue_curve(side, LoopSideCurve::Quartic(half, off), depth));
                    }
                }
                LoopSideCurve::Extraordinary(LoopCellShape::Extraordinary(extraordinary)) => {
                    let Ok(quarters) = extraordinary.quarters() else { return f64::INFINITY };
                    // The quarters at both ends of the side contain its curve.
                    for k in [side, (side + 1) % 3] {
                        open.push(self.queue_curve(
                            side,
                            LoopSideCurve::Extraordinary(LoopCellShape::from_triangle(&quarters[k])),
                            depth,
                        ));
                    }
                }
                LoopSideCurve::Extraordinary(LoopCellShape::Polynomial(polynomial)) => {
                    let curve = LoopSideCurve::Quartic(polynomial.quartic.side(side), polynomial.off);
                    // A polynomial curve is halved as often, however small its piece is.
                    open.push(self.queue_curve(side, curve, 0));
                }
            }
        }
        open.iter().for_each(|left| take(&left.item, &mut space, &mut plane));
        space + plane
    }

    fn queue_curve<'a>(
        &self,
        side: usize,
        curve: LoopSideCurve<'a>,
        depth: usize,
    ) -> PriorityItem<LoopQueueEntry<(LoopSideCurve<'a>, [f64; 2])>> {
        let (far, off, least) = match &curve {
            LoopSideCurve::Quartic(points, off) => {
                // The ends are points of the surface, so that no bound is less than their distance.
                let ends = self.distances_from_side(side, &[points[0], points[4]]);
                (self.distances_from_side(side, points), *off, ALMOST * ends[0] - off)
            }
            LoopSideCurve::Extraordinary(shape) => {
                (self.distances_from_side(side, shape.hull()), piece_error(*shape), 0.0)
            }
        };
        let far = far.map(|far| far + off);
        PriorityItem { bound: far[0] + far[1], item: LoopQueueEntry { piece: (curve, far), depth, least } }
    }

    /// The largest distance of points from a side, in space and in the plane.
    fn distances_from_side(&self, side: usize, points: &[[f64; 3]]) -> [f64; 2] {
        let [a, b] = [side, (side + 1) % 3].map(|k| DVec3::from(self.corners[k]));
        let to_segment = |p: DVec3, along: DVec3| {
            let length_sq = along.length_squared();
            let share = p.dot(along) / length_sq;
            let share = if share > 0.0 { lesser(share, 1.0) } else { 0.0 };
            (p - along * share).length()
        };
        let mut most = [0.0_f64; 2];
        for point in points {
            let from = DVec3::from(*point) - a;
            let slack = NEAR_SIDE * (from.length() + (b - a).length());
            let space = to_segment(from, b - a) + slack;
            let plane = self.normal.map_or(space, |(normal, tilt)| {
                let flat = from - normal * from.dot(normal);
                to_segment(flat, b - a) + slack + 3.0 * tilt * from.length()
            });
            // A projection onto a plane that contains the side moves no point away from it.
            most = [most[0].max(space), most[1].max(lesser(plane, space))];
        }
        most
    }
}

/// A computed distance times this is a lower bound of the exact one. Chosen: far above rounding.
const ALMOST: f64 = 1.0 - 1e-9;
/// The distance of a curve from its side, as a fraction of the tolerance, that needs no subdivision. Chosen: a smaller
/// one gains little.
const FINE: f64 = 0.1;
/// Halvings of a quartic. Chosen: then it is within about a percent of its control points.
const HALVINGS: usize = 3;

fn piece_error(shape: LoopCellShape<'_>) -> f64 {
    match shape {
        LoopCellShape::Polynomial(polynomial) => polynomial.off,
        LoopCellShape::Extraordinary(extraordinary) => 2.0 * extraordinary.ring().rounding(),
    }
}

fn halve_curve(points: &[[f64; 3]; 5]) -> [[[f64; 3]; 5]; 2] {
    let (mut low, mut high) = (*points, *points);
    let mut row = *points;
    for step in 0..5 {
        (low[step], high[4 - step]) = (row[0], row[4 - step]);
        for k in 0..4 - step {
            row[k] = [0, 1, 2].map(|i| 0.5 * (row[k][i] + row[k + 1][i]));
        }
    }
    [low, high]
}
