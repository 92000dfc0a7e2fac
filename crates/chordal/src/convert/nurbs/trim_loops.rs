//! Trim loops as polygons with edges in cells of a lattice.
//!
//! **Bound.** Let `c` be a part of a loop and `e` the edge that replaces it. The point of `e` nearest to `c(t)` moves
//! with `t` without jumps; at both ends it then goes on to the vertex. The distance from a convex set is a convex
//! function. So the distance of a point of `c` is at most the mean of its control points' distances, weighted by their
//! shares in the point, and the distance of an end is at most its distance from the vertex.
//!
//! Move all points of all loops to their edges. A point changes its side of the loops only if the move sweeps over it;
//! the same holds for a move of points beyond the surface's range to the end of the range. So a point in only one of
//! both areas is, along a straight line of parameters, at most that far from both the loop and its edge. The loop
//! belongs to the surface; edges beside no triangle are counted by `uncovered.rs`.
//!
//! **Lengths.** A step `(du, dv)` moves the surface by the root of `E·du² + 2F·du·dv + G·dv²` at most. `E` and `G` are
//! the squares of its largest speeds over the box of control points and edge, `F` is the largest product of both
//! derivatives. That is at most `√(1 + F/√(EG))` times the distance in the units `√E` and `√G`.
use super::face_lattice::FaceLattice;
use crate::explicit::nurbs::{BernsteinRow, NurbsSurface};
use crate::explicit::polygons::winding_number;
use crate::explicit::{Arc, Curve, CurveSegment};
use crate::math::{Orientation, greater, length, lesser, orient2d, power_of_two};
use std::f64::consts::FRAC_PI_2;

/// Halvings of a loop's piece. Chosen: after more, its parameters are next to each other.
const DEEPEST: u32 = 60;

/// The most vertices of a face's loops; then edges are cut no further, and the bound is larger. Chosen: they take some
/// 100 MB.
const MOST_VERTICES: usize = 1 << 22;
/// An edge is cut into fewer parts than this at once, and into two if it needs more or an unknown number. Chosen: an
/// estimate from so far away is not reliable.
const MOST_AT_ONCE: f64 = 32.0;

/// A piece of a loop.
pub(super) enum TrimPiece {
    Rational { weighted: BernsteinRow<2>, weights: BernsteinRow<1>, ends: [[f64; 2]; 2] },
    Arc(Arc<2>),
}

/// The loops of a face by their pieces, with the errors of their coordinates.
pub(super) struct TrimPieces {
    pieces: Vec<TrimPiece>,
    /// By loop: its pieces.
    pub loops: Vec<std::ops::Range<usize>>,
    pub slack: f64,
    pub degree: usize,
    /// By direction: the largest number of a loop's control points.
    pub reach: [f64; 2],
}

/// A vertex of a loop, in coordinates of the lattice.
pub(super) type TrimPoint = [f64; 2];

/// An edge between two vertices, and the part of a loop that it replaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrimEdge {
    pub piece: usize,
    pub part: [f64; 2],
    pub ends: [u32; 2],
}

/// The polygons of a face.
#[derive(Default)]
pub(super) struct TrimPolygons {
    pub vertices: Vec<TrimPoint>,
    /// By loop, in order.
    pub loops: Vec<Vec<TrimEdge>>,
    /// A bound for the distance between the surface within the polygons and the surface within the loops.
    pub loop_error: f64,
}

impl TrimPiece {
    fn new(segment: &CurveSegment<2>) -> Self {
        let rational = |points: Vec<[f64; 2]>| Self::Rational {
            ends: [points[0], points[points.len() - 1]],
            weights: BernsteinRow(vec![[1.0]; points.len()]),
            weighted: BernsteinRow(points),
        };
        match segment {
            CurveSegment::Line(ends) => rational(ends.to_vec()),
            CurveSegment::Cubic(cubic) => rational(cubic.control.to_vec()),
            CurveSegment::Rational(curve) => Self::Rational {
                weighted: curve.weighted().clone(),
                weights: curve.weights().clone(),
                ends: curve.ends(),
            },
            CurveSegment::Arc(arc) => Self::Arc(*arc),
        }
    }

    /// The larger of these numbers and the coordinates of the control points, by direction.
    fn reach(&self, least: [f64; 2]) -> [f64; 2] {
        let control_points = match self {
            Self::Rational { weighted, weights, .. } => {
                weighted.0.iter().zip(&weights.0).map(|(x, [w])| x.map(|x| x / w)).collect()
            }
            Self::Arc(arc) => arc.bounds().to_vec(),
        };
        control_points.iter().fold(least, |most, p| [0, 1].map(|k| greater(p[k].abs(), most[k])))
    }

    pub fn at(&self, t: f64) -> [f64; 2] {
        match self {
            // The given ends and not rounded ones, so that successive pieces meet.
            Self::Rational { ends, .. } if t <= 0.0 => ends[0],
            Self::Rational { ends, .. } if t >= 1.0 => ends[1],
            Self::Rational { weighted, weights, .. } => {
                let [w] = weights.at(t);
                weighted.at(t).map(|x| x / w)
            }
            Self::Arc(arc) => arc.at(t),
        }
    }

    /// The largest share in a point of all control points but the first and the last. For a polynomial of degree `p` it is
    /// `1 − 2^(1−p)`, in the middle; weights change it by at most the ratio of the heaviest inner one to the lighter end.
    fn inner_share(&self, [from, to]: [f64; 2]) -> f64 {
        match self {
            Self::Rational { weights, .. } => {
                let w = weights.part(from, to).0;
                let p = w.len() - 1;
                let heaviest = w[1..p].iter().fold(0.0, |most: f64, [w]| greater(*w, most));
                let at_ends = lesser(w[0][0], w[p][0]);
                let inner = (1.0 - power_of_two(1 - p as i32)) * (heaviest / at_ends);
                let ends = power_of_two(1 - p as i32);
                // Derived: each weight is a mean in as many steps as its degree, and some roundings more.
                (inner / (inner + ends)) * (1.0 + (8 * p + 16) as f64 * f64::EPSILON)
            }
            // As a rational quadratic the corner has the cosine of half the arc's angle as its weight, at most 1, so
            // that its share is at most a half, and some roundings.
            Self::Arc(_) => 0.501,
        }
    }

    /// Points whose convex hull contains a part; none if the part is too large.
    fn hull(&self, [from, to]: [f64; 2]) -> Option<Vec<[f64; 2]>> {
        match self {
            Self::Rational { weighted, weights, .. } => {
                let (x, w) = (weighted.part(from, to), weights.part(from, to));
                Some(x.0.iter().zip(&w.0).map(|(x, [w])| x.map(|x| x / w)).collect())
            }
            Self::Arc(arc) => {
                let part = arc.part_about_middle(from, to);
                if part.half_rad.abs() > 0.5 * FRAC_PI_2 {
                    return None;
                }
                let [a, b] = [arc.at(from), arc.at(to)];
                // The crossing of the tangents at both ends is beyond the middle of the chord.
                let (sin, cos) = libm::sincos(part.half_rad);
                let over = sin * sin / cos;
                let corner = std::array::from_fn(|k| 0.5 * (a[k] + b[k]) + over * part.to_middle[k]);
                Some(vec![a, corner, b])
            }
        }
    }
}

impl TrimPieces {
    /// The loops; the border of the surface if there are none.
    pub fn new(surface: &NurbsSurface, loops: &[Curve<2>]) -> Self {
        let border = || {
            let [[a, b], [c, d]] = [0, 1].map(|k| surface.knots()[k].domain());
            let corners = [[a, c], [b, c], [b, d], [a, d]];
            (0..4).map(|k| CurveSegment::Line([corners[k], corners[(k + 1) % 4]])).collect::<Vec<_>>()
        };
        let mut trim_pieces =
            Self { pieces: Vec::new(), loops: Vec::new(), slack: 0.0, degree: 1, reach: [0.0; 2] };
        let mut add = |segments: &[CurveSegment<2>], slack: f64| {
            let first = trim_pieces.pieces.len();
            trim_pieces.pieces.extend(segments.iter().map(TrimPiece::new));
            trim_pieces.loops.push(first..trim_pieces.pieces.len());
            for segment in segments {
                let (degree, arc_slack) = match segment {
                    CurveSegment::Line(_) => (1, 0.0),
                    CurveSegment::Cubic(_) => (3, 0.0),
                    CurveSegment::Rational(curve) => (curve.degree(), 0.0),
                    CurveSegment::Arc(arc) => {
                        let numbers = arc.axes().into_iter().chain([arc.centre()]);
                        let reach = numbers.flatten().fold(0.0, |sum: f64, x| sum + x.abs());
                        // Derived: the roundings of sine, cosine and their products with the radius, which may be larger
                        // than the surface's range.
                        (2, arc.slack() + 16.0 * f64::EPSILON * reach)
                    }
                };
                trim_pieces.degree = trim_pieces.degree.max(degree);
                trim_pieces.slack = greater(trim_pieces.slack, slack + arc_slack);
            }
        };
        if loops.is_empty() {
            add(&border(), 0.0);
        }
        loops.iter().for_each(|path| add(path.segments(), path.slack()));
        for piece in &trim_pieces.pieces {
            trim_pieces.reach = piece.reach(trim_pieces.reach);
        }
        trim_pieces
    }

    pub fn at(&self, piece: usize, t: f64) -> [f64; 2] {
        self.pieces[piece].at(t)
    }

    /// A bound for the distance of the loops from the chords of their pieces: 0 if they are straight.
    pub fn bulge(&self, lattice: &FaceLattice) -> f64 {
        let distance_of = |piece: usize| {
            let ends = [0.0, 1.0].map(|t| self.lattice_point(lattice, piece, t));
            self.edge_distance(lattice, &TrimEdge { piece, part: [0.0, 1.0], ends: [0; 2] }, ends)
        };
        (0..self.pieces.len()).map(distance_of).fold(0.0, greater)
    }

    /// The loops as polygons with edges in cells.
    pub fn polygons(&self, lattice: &FaceLattice) -> TrimPolygons {
        let mut polygons = TrimPolygons::default();
        for pieces in &self.loops {
            let first = polygons.vertices.len() as u32;
            let n = pieces.len() as u32;
            polygons.vertices.extend(pieces.clone().map(|piece| self.lattice_point(lattice, piece, 0.0)));
            let edge_of_piece = |(k, piece): (u32, usize)| TrimEdge {
                piece,
                part: [0.0, 1.0],
                ends: [first + k, first + (k + 1) % n],
            };
            polygons.loops.push((0..n).zip(pieces.clone()).map(edge_of_piece).collect());
        }
        self.refine(lattice, f64::INFINITY, &mut polygons);
        polygons
    }

    /// Cuts edges until they are in cells and within a length of their loops, or as near as rounding allows.
    pub fn refine(&self, lattice: &FaceLattice, length: f64, polygons: &mut TrimPolygons) {
        let length = greater(length, lattice.parameter_rounding);
        for edges in std::mem::take(&mut polygons.loops) {
            let mut parts = Vec::new();
            for edge in edges {
                self.cut(lattice, length, edge, 0, polygons, &mut parts);
            }
            polygons.loops.push(parts);
        }
    }

    /// The point of a piece, in the lattice.
    pub fn lattice_point(&self, lattice: &FaceLattice, piece: usize, t: f64) -> TrimPoint {
        lattice.place_of(self.at(piece, t))
    }

    /// Cuts an edge until it is near its part of the loop and in one cell.
    fn cut(
        &self,
        lattice: &FaceLattice,
        length: f64,
        edge: TrimEdge,
        depth: u32,
        polygons: &mut TrimPolygons,
        edges: &mut Vec<TrimEdge>,
    ) {
        let ends = edge.ends.map(|id| polygons.vertices[id as usize]);
        let [from, to] = edge.part;
        let middle = 0.5 * (from + to);
        let can_halve =
            from < middle && middle < to && depth < DEEPEST && polygons.vertices.len() < MOST_VERTICES;
        let crossing = self.crossing(lattice, &edge, ends);
        let parts = match crossing {
            Some((at, part)) if can_halve => vec![(at, part)],
            // A whole loop.
            None if can_halve && edge.ends[0] == edge.ends[1] => {
                let part = |k: u8| from + (to - from) * (f64::from(k) / 3.0);
                [1, 2].map(part).map(|part| (self.lattice_point(lattice, edge.piece, part), part)).to_vec()
            }
            None if can_halve => {
                // Errors go with the square of a part's size.
                let n = if length.is_finite() {
                    (self.edge_distance(lattice, &edge, ends) / length).sqrt().ceil()
                } else {
                    1.0
                };
                // With one part or none the edge is near enough, and stays whole.
                let n = if n < MOST_AT_ONCE { n as usize } else { 2 };
                let part = |k: usize| from + (to - from) * (k as f64 / n as f64);
                (1..n).map(part).map(|part| (self.lattice_point(lattice, edge.piece, part), part)).collect()
            }
            _ => Vec::new(),
        };
        if parts.is_empty() {
            edges.push(edge);
            return;
        }
        let (mut id, mut begin) = (edge.ends[0], from);
        for (at, part) in parts {
            polygons.vertices.push(at);
            let next = polygons.vertices.len() as u32 - 1;
            let part_edge = TrimEdge { part: [begin, part], ends: [id, next], ..edge };
            self.cut(lattice, length, part_edge, depth + 1, polygons, edges);
            (id, begin) = (next, part);
        }
        let last = TrimEdge { part: [begin, to], ends: [id, edge.ends[1]], ..edge };
        self.cut(lattice, length, last, depth + 1, polygons, edges);
    }

    /// The crossing of an edge's part with a line between its ends, if these are in no common cell.
    fn crossing(
        &self,
        lattice: &FaceLattice,
        edge: &TrimEdge,
        ends: [TrimPoint; 2],
    ) -> Option<(TrimPoint, f64)> {
        let (k, line) = lattice.cells.line_between(ends)?;
        let is_below = ends[0][k] < line;
        let [mut from, mut to] = edge.part;
        for _ in 0..DEEPEST {
            let middle = 0.5 * (from + to);
            if !(from < middle && middle < to) {
                break;
            }
            let x = self.lattice_point(lattice, edge.piece, middle)[k];
            *(if (x < line) == is_below { &mut from } else { &mut to }) = middle;
        }
        let mut at = self.lattice_point(lattice, edge.piece, to);
        // Exactly on the line, so that the vertex belongs to the cells on both sides.
        at[k] = line;
        Some((lattice.cells.snapped(at), to))
    }

    /// A bound for the distance of an edge from its part of the loop, as a length on the surface.
    fn edge_distance(&self, lattice: &FaceLattice, edge: &TrimEdge, ends: [TrimPoint; 2]) -> f64 {
        let Some(mut points) = self.pieces[edge.piece].hull(edge.part) else { return f64::INFINITY };
        for k in 0..2 {
            lattice.cut_off(k, &mut points);
        }
        let ends = ends.map(|end| [0, 1].map(|k| lattice.parameter(k, end[k])));
        let n = points.len();
        points.extend(ends);
        let range = |k: usize| {
            let reach = |[low, high]: [f64; 2], p: &[f64; 2]| [lesser(p[k], low), greater(p[k], high)];
            points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], reach)
        };
        let speeds = lattice.speeds([range(0), range(1)]);
        let scaled = |p: [f64; 2]| [p[0] * speeds[0], p[1] * speeds[1]];
        let [a, b] = ends.map(scaled);
        let distances =
            points[..n].iter().map(|p| distance_to_segment(scaled(*p), a, b)).collect::<Vec<f64>>();
        let most = |all: &[f64]| {
            all.iter().fold(0.0, |far: f64, distance| {
                // A distance that is no number must not be lost in a maximum.
                if distance.is_nan() { f64::INFINITY } else { greater(*distance, far) }
            })
        };
        let at_ends = greater(most(&distances[..1]), most(&distances[n - 1..]));
        let inner = if n > 2 { most(&distances[1..n - 1]) } else { 0.0 };
        let along = at_ends + inner * self.pieces[edge.piece].inner_share(edge.part);
        let to_vertices = [(points[0], a), (points[n - 1], b)].map(|(p, end)| {
            let p = scaled(p);
            distance_to_segment(p, end, end)
        });
        let farthest = greater(along, most(&to_vertices));
        let skew = speeds[2] / (speeds[0] * speeds[1]);
        let skew = if skew < 1.0 { skew } else { 1.0 };
        // Some roundings of the distance.
        (1.0 + skew).sqrt() * farthest * (1.0 + 64.0 * f64::EPSILON)
    }

    /// A bound for the distance of all polygons from their loops, as a length on the surface.
    pub fn distance(&self, lattice: &FaceLattice, polygons: &TrimPolygons) -> f64 {
        let edges = polygons.loops.iter().flatten();
        let distance_of = |edge: &TrimEdge| {
            self.edge_distance(lattice, edge, edge.ends.map(|id| polygons.vertices[id as usize]))
        };
        // Coordinates of loops have an error up to the slack, along both directions.
        let slack = self.slack * (lattice.fastest[0] + lattice.fastest[1]);
        edges.map(distance_of).fold(0.0, greater) + slack + 4.0 * lattice.parameter_rounding
    }
}

fn distance_to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let part = if square > 0.0 { (to[0] * along[0] + to[1] * along[1]) / square } else { 0.0 };
    let part = if part > 0.0 { lesser(part, 1.0) } else { 0.0 };
    let across = [to[0] - part * along[0], to[1] - part * along[1]];
    length(across)
}

/// The most edges among which a crossing is sought, for a message about wrong loops. Chosen: all pairs of so many take
/// a second.
const MOST_CHECKED: usize = 1 << 14;

impl TrimPieces {
    /// A loop that runs the wrong way round, by the number of loops around it; none if all are right.
    pub fn backward(lattice: &FaceLattice, polygons: &TrimPolygons) -> Option<usize> {
        let loops = loops_of(lattice, polygons);
        let area = |p: &[[f64; 2]]| {
            let next = p.iter().cycle().skip(1);
            p.iter().zip(next).fold(0.0, |sum, (a, b)| sum + (a[0] * b[1] - a[1] * b[0]))
        };
        (0..loops.len()).find(|index| {
            let Some(start) = loops[*index].first() else { return false };
            let around = (0..loops.len())
                .filter(|other| other != index && winding_number(&loops[*other], *start) != Some(0))
                .count();
            // Outer loops run counter-clockwise, the holes in them clockwise, and so on.
            (area(&loops[*index]) > 0.0) != around.is_multiple_of(2)
        })
    }

    /// Parameters near a crossing of two edges; none if there are too many edges.
    pub fn crossing_edges(lattice: &FaceLattice, polygons: &TrimPolygons) -> Option<[f64; 2]> {
        let edges: Vec<[[f64; 2]; 2]> = loops_of(lattice, polygons)
            .iter()
            .flat_map(|p| (0..p.len()).map(|k| [p[k], p[(k + 1) % p.len()]]).collect::<Vec<_>>())
            .collect();
        if edges.len() > MOST_CHECKED {
            return None;
        }
        // Edges that only touch do not cross.
        let sides = |[a, b]: [[f64; 2]; 2], [p, q]: [[f64; 2]; 2]| {
            let both = [orient2d(a, b, p), orient2d(a, b, q)];
            both.contains(&Orientation::Front) && both.contains(&Orientation::Back)
        };
        let crosses = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| sides(a, b) && sides(b, a);
        (0..edges.len())
            .find(|i| edges[..*i].iter().any(|other| crosses(edges[*i], *other)))
            .map(|i| std::array::from_fn(|k| 0.5 * (edges[i][0][k] + edges[i][1][k])))
    }
}

/// The corners of polygons in the plane of parameters.
fn loops_of(lattice: &FaceLattice, polygons: &TrimPolygons) -> Vec<Vec<[f64; 2]>> {
    let points = |edges: &Vec<TrimEdge>| -> Vec<[f64; 2]> {
        let at = |edge: &TrimEdge| polygons.vertices[edge.ends[0] as usize];
        edges.iter().map(|edge| [0, 1].map(|k| lattice.parameter(k, at(edge)[k]))).collect()
    };
    polygons.loops.iter().map(points).collect()
}
