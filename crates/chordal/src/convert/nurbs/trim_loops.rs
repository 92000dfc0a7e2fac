//! Trim loops as polygons whose edges lie in cells of a lattice.
//!
//! *Bound.* Let `c` be a part of a loop and `e` the edge in its place. The point of `e` nearest to `c(t)` moves with `t`
//! without jumps; at both ends it then goes on to the vertex. Distance from a convex set is a convex function, so that
//! of a point of `c` is at most the mean of its control points' distances, by the parts they have in it; that of an end
//! is at most its distance from the vertex. Moving all points of all loops to their edges changes on which side of the
//! loops a point lies only where the move sweeps over it, and nor does moving what is beyond the surface's range to the
//! end of it; so a point of one area that is not in the other is, along a straight line of parameters, at most that far
//! from both, the loop and its edge. The loop belongs to the truth; of edges, what is beside no triangle is counted by
//! `uncovered.rs`.
//!
//! A step `(du, dv)` moves the surface by the root of `E·du² + 2F·du·dv + G·dv²` at most, `E` and `G` the squares of its
//! largest speeds over the box of control points and edge, `F` the largest product of both derivatives; that is
//! `√(1 + F/√(EG))` of the distance in the units `√E` and `√G`.
use super::face_lattice::FaceLattice;
use crate::explicit::nurbs::{BernsteinRow, NurbsSurface};
use crate::explicit::polygons::winding_number;
use crate::explicit::{Arc, Curve, CurveSegment};
use crate::math::{Orientation, greater, lesser, orient2d, power_of_two};
use std::f64::consts::FRAC_PI_2;

/// Halvings of a loop's piece. Chosen: beyond, its parameters are next to each other.
const DEEPEST: u32 = 60;

/// Vertices of the loops of a face; beyond, edges stay as they are, and the bound says so. Chosen.
const MOST_VERTICES: usize = 1 << 22;
/// Parts into which an edge is cut at once, fewer than this; into two where it is far off or not known how far. Chosen.
const MOST_AT_ONCE: f64 = 32.0;

/// A piece of a loop.
pub(super) enum TrimPiece {
    Rational { weighted: BernsteinRow<2>, weights: BernsteinRow<1>, ends: [[f64; 2]; 2] },
    Arc(Arc<2>),
}

/// The loops of a face by their pieces; what their numbers may be off.
pub(super) struct TrimPieces {
    pieces: Vec<TrimPiece>,
    /// By loop: the pieces it has.
    pub loops: Vec<std::ops::Range<usize>>,
    pub slack: f64,
    pub degree: usize,
    /// By direction: the largest number of a loop's control points.
    pub reach: [f64; 2],
}

/// A vertex of a loop, in coordinates of the lattice.
pub(super) type TrimPoint = [f64; 2];

/// An edge between two vertices and the part of a loop for which it stands.
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
    /// How far the surface within the polygons is from that within the loops, at most.
    pub off: f64,
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

    /// The larger ones of these numbers and those of the control points, by direction.
    fn reach(&self, least: [f64; 2]) -> [f64; 2] {
        let all = match self {
            Self::Rational { weighted, weights, .. } => {
                weighted.0.iter().zip(&weights.0).map(|(x, [w])| x.map(|x| x / w)).collect()
            }
            Self::Arc(arc) => arc.bounds().to_vec(),
        };
        all.iter().fold(least, |most, p| [0, 1].map(|k| greater(p[k].abs(), most[k])))
    }

    pub fn at(&self, t: f64) -> [f64; 2] {
        match self {
            Self::Rational { ends, .. } if t <= 0.0 => ends[0],
            Self::Rational { ends, .. } if t >= 1.0 => ends[1],
            Self::Rational { weighted, weights, .. } => {
                let [w] = weights.at(t);
                weighted.at(t).map(|x| x / w)
            }
            Self::Arc(arc) => arc.at(t),
        }
    }

    /// The largest part that all control points but the first and the last have in a point. Of a polynomial of degree `p`
    /// it is `1 − 2^(1−p)`, in the middle; weights are at most as uneven as inner ones are heavier than those at the ends.
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
            // As a rational quadratic the corner has the weight cos of half its angle, at most 1, so that its part is at most
            // a half, and some roundings.
            Self::Arc(_) => 0.501,
        }
    }

    /// Points whose convex hull contains a part; none where it is too large a part.
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
                // Where the tangents at both ends meet: beyond the middle of the chord.
                let (sin, cos) = libm::sincos(part.half_rad);
                let over = sin * sin / cos;
                let corner = std::array::from_fn(|k| 0.5 * (a[k] + b[k]) + over * part.to_middle[k]);
                Some(vec![a, corner, b])
            }
        }
    }
}

impl TrimPieces {
    /// The loops; the border of the surface where there are none.
    pub fn new(surface: &NurbsSurface, loops: &[Curve<2>]) -> Self {
        let border = || {
            let [[a, b], [c, d]] = [0, 1].map(|k| surface.knots()[k].domain());
            let corners = [[a, c], [b, c], [b, d], [a, d]];
            (0..4).map(|k| CurveSegment::Line([corners[k], corners[(k + 1) % 4]])).collect::<Vec<_>>()
        };
        let mut made = Self { pieces: Vec::new(), loops: Vec::new(), slack: 0.0, degree: 1, reach: [0.0; 2] };
        let mut add = |segments: &[CurveSegment<2>], slack: f64| {
            let first = made.pieces.len();
            made.pieces.extend(segments.iter().map(TrimPiece::new));
            made.loops.push(first..made.pieces.len());
            for segment in segments {
                let (degree, own) = match segment {
                    CurveSegment::Line(_) => (1, 0.0),
                    CurveSegment::Cubic(_) => (3, 0.0),
                    CurveSegment::Rational(curve) => (curve.degree(), 0.0),
                    // Derived: sine, cosine and their products, of a radius that may be larger than the surface's range.
                    CurveSegment::Arc(arc) => {
                        let numbers = arc.axes().into_iter().chain([arc.centre()]);
                        let reach = numbers.flatten().fold(0.0, |sum: f64, x| sum + x.abs());
                        // Derived: see above.
                        (2, arc.slack() + 16.0 * f64::EPSILON * reach)
                    }
                };
                made.degree = made.degree.max(degree);
                made.slack = greater(made.slack, slack + own);
            }
        };
        if loops.is_empty() {
            add(&border(), 0.0);
        }
        loops.iter().for_each(|path| add(path.segments(), path.slack()));
        for piece in &made.pieces {
            made.reach = piece.reach(made.reach);
        }
        made
    }

    pub fn at(&self, piece: usize, t: f64) -> [f64; 2] {
        self.pieces[piece].at(t)
    }

    /// How far the loops are from the chords of their pieces, at most: 0 where they are straight.
    pub fn bulge(&self, lattice: &FaceLattice) -> f64 {
        let off = |piece: usize| {
            let ends = [0.0, 1.0].map(|t| self.lattice_point(lattice, piece, t));
            self.off(lattice, &TrimEdge { piece, part: [0.0, 1.0], ends: [0; 2] }, ends)
        };
        (0..self.pieces.len()).map(off).fold(0.0, greater)
    }

    /// The loops as polygons whose edges lie in cells.
    pub fn polygons(&self, lattice: &FaceLattice) -> TrimPolygons {
        let mut made = TrimPolygons::default();
        for pieces in &self.loops {
            let first = made.vertices.len() as u32;
            let n = pieces.len() as u32;
            made.vertices.extend(pieces.clone().map(|piece| self.lattice_point(lattice, piece, 0.0)));
            let whole = |(k, piece): (u32, usize)| TrimEdge {
                piece,
                part: [0.0, 1.0],
                ends: [first + k, first + (k + 1) % n],
            };
            made.loops.push((0..n).zip(pieces.clone()).map(whole).collect());
        }
        self.refine(lattice, f64::INFINITY, &mut made);
        made
    }

    /// Cuts edges until they are in cells and as near to their loops as wanted, or as rounding allows.
    pub fn refine(&self, lattice: &FaceLattice, wanted: f64, polygons: &mut TrimPolygons) {
        let wanted = greater(wanted, lattice.parameter_rounding);
        for edges in std::mem::take(&mut polygons.loops) {
            let mut made = Vec::new();
            for edge in edges {
                self.cut(lattice, wanted, edge, 0, polygons, &mut made);
            }
            polygons.loops.push(made);
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
        wanted: f64,
        edge: TrimEdge,
        depth: u32,
        made: &mut TrimPolygons,
        edges: &mut Vec<TrimEdge>,
    ) {
        let ends = edge.ends.map(|id| made.vertices[id as usize]);
        let [from, to] = edge.part;
        let middle = 0.5 * (from + to);
        let can_halve =
            from < middle && middle < to && depth < DEEPEST && made.vertices.len() < MOST_VERTICES;
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
                let n = if wanted.is_finite() {
                    (self.off(lattice, &edge, ends) / wanted).sqrt().ceil()
                } else {
                    1.0
                };
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
            made.vertices.push(at);
            let next = made.vertices.len() as u32 - 1;
            let one = TrimEdge { part: [begin, part], ends: [id, next], ..edge };
            self.cut(lattice, wanted, one, depth + 1, made, edges);
            (id, begin) = (next, part);
        }
        let last = TrimEdge { part: [begin, to], ends: [id, edge.ends[1]], ..edge };
        self.cut(lattice, wanted, last, depth + 1, made, edges);
    }

    /// Where an edge's part crosses a line between its ends, if these are in no common cell.
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
        at[k] = line;
        Some((lattice.cells.snapped(at), to))
    }

    /// How far an edge is from its part of the loop, at most, as a length on the surface.
    fn off(&self, lattice: &FaceLattice, edge: &TrimEdge, ends: [TrimPoint; 2]) -> f64 {
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
        let off = points[..n].iter().map(|p| distance_to_segment(scaled(*p), a, b)).collect::<Vec<f64>>();
        let most = |all: &[f64]| {
            all.iter()
                .fold(0.0, |far: f64, off| if off.is_nan() { f64::INFINITY } else { greater(*off, far) })
        };
        let at_ends = greater(most(&off[..1]), most(&off[n - 1..]));
        let inner = if n > 2 { most(&off[1..n - 1]) } else { 0.0 };
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

    /// How far all polygons are from their loops, at most, as a length on the surface.
    pub fn distance(&self, lattice: &FaceLattice, polygons: &TrimPolygons) -> f64 {
        let edges = polygons.loops.iter().flatten();
        let off =
            |edge: &TrimEdge| self.off(lattice, edge, edge.ends.map(|id| polygons.vertices[id as usize]));
        // Numbers of loops are off by a slack, along both directions.
        let slack = self.slack * (lattice.fastest[0] + lattice.fastest[1]);
        edges.map(off).fold(0.0, greater) + slack + 4.0 * lattice.parameter_rounding
    }
}

fn distance_to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let part = if square > 0.0 { (to[0] * along[0] + to[1] * along[1]) / square } else { 0.0 };
    let part = if part > 0.0 { lesser(part, 1.0) } else { 0.0 };
    let off = [to[0] - part * along[0], to[1] - part * along[1]];
    (off[0] * off[0] + off[1] * off[1]).sqrt()
}

/// Edges of loops that are looked at for where two of them cross, when it is known that something is wrong. Chosen: all
/// pairs of so many take a second.
const MOST_CHECKED: usize = 1 << 14;

impl TrimPieces {
    /// A loop that runs the wrong way round, by how many others are around it; none where all are right.
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
            (area(&loops[*index]) > 0.0) != around.is_multiple_of(2)
        })
    }

    /// Parameters near which two edges cross; none where there are too many to look at.
    pub fn crossing_edges(lattice: &FaceLattice, polygons: &TrimPolygons) -> Option<[f64; 2]> {
        let edges: Vec<[[f64; 2]; 2]> = loops_of(lattice, polygons)
            .iter()
            .flat_map(|p| (0..p.len()).map(|k| [p[k], p[(k + 1) % p.len()]]).collect::<Vec<_>>())
            .collect();
        if edges.len() > MOST_CHECKED {
            return None;
        }
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
