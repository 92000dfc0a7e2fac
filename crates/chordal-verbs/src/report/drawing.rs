//! Curves in the report; only from `inspect`.
use crate::input::shape::in_space;
use chordal::check::curves::{Join, joins};
use chordal::explicit::{Curve, CurveSegment};
use chordal::math::greater;
use chordal_io::{DrawingElement, PathSet};
use serde::Serialize;

/// The counts of curves.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DrawingFacts {
    /// Drawn elements.
    pub elements: u64,
    /// Filled elements.
    pub filled: u64,
    /// Subpaths of all elements.
    pub subpaths: u64,
    /// Closed subpaths.
    pub closed: u64,
    /// Open subpaths.
    pub open: u64,
    /// The smooth pieces of all subpaths.
    pub pieces: PieceCounts,
    /// Joins between consecutive pieces.
    pub joins: JoinCounts,
    /// The total length of all curves: an estimate by quadrature, without a bound.
    pub length_estimate: f64,
    /// The largest distance from a curve to the exact one that the file describes, due to rounded numbers.
    pub slack: f64,
    /// The view box of the file: lowest x and y, width and height; `None` if it has none.
    pub view_box: Option<[f64; 4]>,
    /// The worst joins, at most [`MOST_JOINS`]: kinks by their angle, then other joins below G2 by the jump of the
    /// curvature.
    pub worst: Vec<PathJoinFacts>,
}

/// Pieces by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PieceCounts {
    /// Straight lines.
    pub lines: u64,
    /// Cubic Bézier curves, including quadratic ones.
    pub cubics: u64,
    /// Arcs of ellipses.
    pub arcs: u64,
    /// Rational Bézier curves.
    pub rational: u64,
}

/// Joins by apparent smoothness, and by the derivatives if the parameter of each piece runs from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct JoinCounts {
    /// The direction jumps: a kink.
    pub g0: u64,
    /// The direction is continuous and the curvature jumps.
    pub g1: u64,
    /// Direction and curvature are continuous.
    pub g2: u64,
    /// The first derivative jumps.
    pub c0: u64,
    /// The first derivative is continuous and the second jumps.
    pub c1: u64,
    /// Both are continuous.
    pub c2: u64,
}

/// A join of a path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathJoinFacts {
    /// The index of the element among those drawn.
    pub element: u64,
    /// The kind of the element, as in "path".
    pub kind: &'static str,
    /// Its name in the file, or empty.
    pub name: String,
    /// The index of the subpath among all.
    pub subpath: u64,
    /// The index of the piece that starts there.
    pub piece: u64,
    /// The point.
    pub at: [f64; 3],
    /// The turning angle; `None` if a piece has no direction because it is a point.
    pub angle_deg: Option<f64>,
    /// The class Gn, 0 or 1.
    pub geometric: u8,
    /// The class Cn.
    pub parametric: u8,
    /// The curvatures before and after, one over the radius; `None` if a first derivative is zero.
    pub curvatures: [Option<f64>; 2],
    /// The length of the difference of the curvature vectors; `None` if one is missing.
    pub curvature_gap: Option<f64>,
}

/// The most joins that are listed. Chosen: a report stays readable.
const MOST_JOINS: usize = 32;

impl DrawingFacts {
    /// The facts of curves.
    #[must_use]
    pub fn from_curves<const D: usize>(drawn: &PathSet<Curve<D>>) -> Self {
        let mut facts = Self {
            elements: drawn.elements.len() as u64,
            filled: drawn.elements.iter().filter(|element| element.filled).count() as u64,
            subpaths: drawn.lines.len() as u64,
            view_box: drawn.view_box,
            ..Self::default()
        };
        for (index, curve) in drawn.lines.iter().enumerate() {
            facts.add(curve);
            for join in joins(curve) {
                facts.add_join(&join, index, drawn.element_of(index));
            }
        }
        // Stable, so that equally bad joins stay in order.
        facts.worst.sort_by(worst_first);
        facts.worst.truncate(MOST_JOINS);
        facts
    }

    fn add<const D: usize>(&mut self, curve: &Curve<D>) {
        *(if curve.is_closed() { &mut self.closed } else { &mut self.open }) += 1;
        self.slack = greater(curve.slack(), self.slack);
        for piece in curve.segments() {
            let count = match piece {
                CurveSegment::Line(_) => &mut self.pieces.lines,
                CurveSegment::Cubic(_) => &mut self.pieces.cubics,
                CurveSegment::Arc(_) => &mut self.pieces.arcs,
                CurveSegment::Rational(_) => &mut self.pieces.rational,
            };
            *count += 1;
            self.length_estimate += length(piece);
        }
    }

    fn add_join<const D: usize>(&mut self, join: &Join<D>, subpath: usize, element: Option<&DrawingElement>) {
        // Positions are always continuous: the pieces of a path meet to the bit.
        let (geometric, parametric) = (join.geometric.unwrap_or(0), join.parametric.unwrap_or(0));
        let joins = &mut self.joins;
        *[&mut joins.g0, &mut joins.g1, &mut joins.g2][usize::from(geometric)] += 1;
        *[&mut joins.c0, &mut joins.c1, &mut joins.c2][usize::from(parametric)] += 1;
        if geometric == 2 {
            return;
        }
        self.worst.push(PathJoinFacts {
            element: element.map_or(0, |element| element.source),
            kind: element.map_or("path", |element| element.kind),
            name: element.map_or_else(String::new, |element| element.name.to_string()),
            subpath: subpath as u64,
            piece: join.piece as u64,
            at: in_space(join.at),
            angle_deg: join.angle_rad.map(f64::to_degrees),
            geometric,
            parametric,
            curvatures: join.curvatures,
            curvature_gap: join.curvature_gap,
        });
        // Never holds more than twice the limit.
        if self.worst.len() == 2 * MOST_JOINS {
            self.worst.sort_by(worst_first);
            self.worst.truncate(MOST_JOINS);
        }
    }
}

/// Kinks before others; joins without an angle or a curvature first.
fn worst_first(a: &PathJoinFacts, b: &PathJoinFacts) -> std::cmp::Ordering {
    let badness = |join: &PathJoinFacts| {
        let (angle, gap) = (join.angle_deg, join.curvature_gap);
        (if join.geometric == 0 { angle } else { gap }).unwrap_or(f64::INFINITY)
    };
    a.geometric.cmp(&b.geometric).then(badness(b).total_cmp(&badness(a)))
}

/// The length by Gauss' quadrature of five points on each quarter of the parameter.
fn length<const D: usize>(piece: &CurveSegment<D>) -> f64 {
    // Abramowitz and Stegun, Handbook of Mathematical Functions, table 25.4.
    const NODES: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683, 0.478_628_670_499_366_5),
        (-0.538_469_310_105_683, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let speed = |t: f64| piece.tangent(t).iter().fold(0.0, |sum: f64, x| sum + x * x).sqrt();
    let parts = if matches!(piece, CurveSegment::Line(_)) { return speed(0.0) } else { 4 };
    let width = 1.0 / f64::from(parts);
    (0..parts).fold(0.0, |sum, part| {
        let middle = (f64::from(part) + 0.5) * width;
        NODES
            .iter()
            .fold(sum, |sum, (x, weight)| sum + 0.5 * width * weight * speed(middle + 0.5 * width * x))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::explicit::Arc;

    #[test]
    fn the_length_of_a_circle_is_nearly_its_own() {
        let turn = 2.0 * std::f64::consts::PI;
        let circle = Arc::new([5.0, 5.0], [[2.0, 0.0], [0.0, 2.0]], 0.0, turn).unwrap();
        assert!((length(&CurveSegment::Arc(circle)) - 2.0 * turn).abs() < 1e-12);
        assert_eq!(length(&CurveSegment::Line([[0.0, 0.0], [3.0, 4.0]])), 5.0);
    }
}
