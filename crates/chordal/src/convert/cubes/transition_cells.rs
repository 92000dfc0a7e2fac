//! Triangles of the cells of an octree: closed and manifold, whatever cells are halved.
//!
//! **Faces.** A square between two cells is cut up like the more finely halved of them.
//!
//! ```text
//!   ┌───────┬───┬───┐
//!   │       │   │   │    the large cell sees the side in the middle
//!   │       ├───┼───┤    as two parts, like the halved cell
//!   │       │   │   │
//!   └───────┴───┴───┘
//! ```
//!
//! Each square that is not cut up has the segments of `case_table.rs`: every run of inside corners is cut off by itself.
//! Both sides see the same squares, with the same values (`halved_lattice.rs`), hence the same segments.
//!
//! **Edges.** An edge is halved if any of the cells around it is halved. If its ends are on different sides, so are the ends
//! of exactly one half. So an edge of a square, however far it is cut up, has one vertex or none, on its smallest such half.
//!
//! **Cells.** So each vertex on a cell's surface is an end of one segment in each of two squares: segments form closed
//! loops. If no face is cut up, the loops and the triangles are those of the table. Every other loop has a vertex inside the
//! cell, and a fan around it; a loop of three vertices is a triangle. All edges of a fan except the segments are at that
//! vertex, so that no other cell has them. The diagonals of the table join edges that share no face of the cell, while a
//! common edge of two cells lies in a face of one of them: so no other cell has the diagonals either. Hence every edge has
//! two triangles, and around each vertex the cells at its edge add one fan each, from face to face: the mesh is a closed
//! manifold up to the border of the lattice, as in `case_table.rs`.
//!
//! **Caps.** Squares of capped borders have polygons as in `caps.rs`. If a side is cut up, the ends of its parts are corners
//! of the polygon, which is convex and gets a fan around a vertex inside it.
//!
//! The vertices of a cell are on its edges and faces, except for means of these with positive weights.
//!
//! Source: the cutting of faces by their finer side is that of C.-C. Ho, F.-C. Wu, B.-Y. Chen, Y.-Y. Chuang, M. Ouhyoung,
//! *Cubical marching squares: adaptive feature preserving surface extraction from volume data*, 2005.
use super::caps::{CapVertex, triangles};
use super::case_table::{EDGES, TABLE, is_crossed};
use super::halved_lattice::{HalvedLattice, mean};
use super::marching_squares::square_segments;
use super::octree::{HalvedCells, MOST_HALVINGS, OctreeCell};
use super::rule::{Border, LatticeTransform, Polygonize};
use super::source::SampleSource;
use crate::implicit::Affine3;
use crate::math::distance;

/// The kind of an octree's vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum OctreeVertexKind {
    /// On an edge along that axis.
    Crossing(u8),
    /// The corner of a square of a capped border.
    Corner,
    /// Inside a cell, or inside its square of a capped border: the number of its loop or polygon there.
    Centre(u16),
}

/// A vertex on the edges of an octree, or inside a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct OctreeVertex {
    pub kind: OctreeVertexKind,
    pub level: u8,
    /// The lower end of its edge, its corner, or the first corner of its cell, counted in cells of the level.
    pub low: [u32; 3],
    /// Its offset from there, in cells of the level.
    pub part: [f64; 3],
    /// Whether it is within the margin of a point of the surface: rounded values may leave that uncertain.
    pub is_zero: bool,
}

/// The order of vertices, by their places: z, y, x, level and kind.
pub(super) type VertexOrder = ([u64; 3], u8, OctreeVertexKind);

impl OctreeVertex {
    /// Its key in that order, the same in every cell that has the vertex.
    pub fn order(&self) -> VertexOrder {
        let [x, y, z] = self.low.map(|i| u64::from(i) << (MOST_HALVINGS - usize::from(self.level)));
        // The corner of a square is a corner of larger and of smaller squares.
        let level = if self.kind == OctreeVertexKind::Corner { 0 } else { self.level };
        ([z, y, x], level, self.kind)
    }

    /// In indices of the lattice.
    pub fn index(&self) -> [f64; 3] {
        let step = step(self.level);
        [0, 1, 2].map(|k| (f64::from(self.low[k]) + self.part[k]) * step)
    }

    /// In space. Powers of two are exact: the same bits as by the transform of the level's own lattice.
    pub fn point(&self, place: &LatticeTransform, offset: [i64; 3]) -> [f64; 3] {
        let step = step(self.level);
        let whole = |k: usize| ((offset[k] << self.level) + i64::from(self.low[k])) as f64;
        place.at([0, 1, 2].map(|k| (whole(k) + self.part[k]) * step))
    }

    /// In cells of a level, from the first corner of one.
    fn within(&self, cell: OctreeCell) -> [f64; 3] {
        let step = step(self.level - cell.level);
        [0, 1, 2].map(|k| {
            let whole = i64::from(self.low[k]) - (i64::from(cell.at[k]) << (self.level - cell.level));
            (whole as f64 + self.part[k]) * step
        })
    }
}

/// The side of a cell of a level: a power of two.
fn step(level: u8) -> f64 {
    1.0 / (1_u64 << level) as f64
}

/// Three vertices, counter-clockwise from outside of the shape in a space that is not mirrored.
pub(super) type OctreeTriangle = [OctreeVertex; 3];

/// An edge of a level by its lower end, and the values at its ends.
#[derive(Clone, Copy)]
struct ValuedEdge {
    level: u8,
    axis: usize,
    low: [u32; 3],
    ends: [f64; 2],
}

/// A square of a level by its first corner and the axis across it, with the values at its corners: the first two along the
/// next axis, then the other two.
#[derive(Clone, Copy)]
struct ValuedSquare {
    level: u8,
    axis: usize,
    low: [u32; 3],
    values: [f64; 4],
}

impl ValuedSquare {
    /// A face of a cell with these corners.
    fn of_cell(cell: OctreeCell, values: &[f64; 8], axis: usize, end: usize) -> Self {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut low = cell.at;
        low[axis] += end as u32;
        let corner = |c: usize| values[end << axis | (c & 1) << u | (c >> 1) << v];
        Self { level: cell.level, axis, low, values: [corner(0), corner(1), corner(2), corner(3)] }
    }

    /// The corner of a number, counter-clockwise as seen from the given end of the square's axis.
    fn around(end: usize, number: usize) -> usize {
        let turned = if end == 1 { number } else { 3 - number };
        [0, 1, 3, 2][turned % 4]
    }

    /// The side from a corner to the next, and whether it begins at its lower end.
    fn side(&self, end: usize, number: usize) -> (ValuedEdge, bool) {
        let (u, v) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let (a, b) = (Self::around(end, number), Self::around(end, (number + 1) % 4));
        let (first, last) = if a < b { (a, b) } else { (b, a) };
        let mut low = self.low;
        low[u] += (first & 1) as u32;
        low[v] += (first >> 1) as u32;
        let axis = if last - first == 1 { u } else { v };
        (
            ValuedEdge { level: self.level, axis, low, ends: [self.values[first], self.values[last]] },
            first == a,
        )
    }

    /// Its four parts, with values as in `halved_lattice.rs`: along the lower of the two axes first.
    fn parts(&self) -> [Self; 4] {
        let (u, v) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let [a, b, c, d] = self.values;
        let (ab, cd, ac, bd) = (mean(a, b), mean(c, d), mean(a, c), mean(b, d));
        // The mean of means is rounded, so the middle depends on the order.
        let middle = if u < v { mean(ab, cd) } else { mean(ac, bd) };
        let values = [[a, ab, ac, middle], [ab, b, middle, bd], [ac, middle, c, cd], [middle, bd, cd, d]];
        std::array::from_fn(|part| {
            let mut low = self.low.map(|i| 2 * i);
            low[u] += (part & 1) as u32;
            low[v] += (part >> 1) as u32;
            Self { level: self.level + 1, axis: self.axis, low, values: values[part] }
        })
    }
}

/// The surface in the cells of an octree.
pub(super) struct OctreeSurface<'a> {
    pub source: &'a dyn SampleSource,
    pub affine: &'a Affine3,
    pub rule: &'a Polygonize,
    pub halved: &'a HalvedCells,
    /// The largest error of a value of any level.
    pub slack: f64,
}

/// Whether the crossing between two values with errors up to `slack` is within the margin of the true one: its error is up
/// to twice theirs over their difference, and here no more than half of the margin.
pub(super) fn is_certain([from, to]: [f64; 2], slack: f64, margin: f64) -> bool {
    slack == 0.0 || (0.5 * from - 0.5 * to).abs() * margin > 4.0 * slack
}

impl OctreeSurface<'_> {
    /// The map from indices to space.
    pub fn place(&self) -> LatticeTransform {
        LatticeTransform::new(self.affine, self.rule.offset)
    }

    /// The values at the corners of a cell.
    pub fn values(&self, cell: OctreeCell) -> [f64; 8] {
        HalvedLattice { coarse: self.source, rule: self.rule, level: u32::from(cell.level) }
            .corners(cell.index())
    }

    /// Visits all triangles of a leaf.
    pub fn for_each_piece(&self, cell: OctreeCell, mut each: impl FnMut(OctreeTriangle)) {
        let values = self.values(cell);
        self.for_each_triangle(cell, &values, &mut each);
        self.for_each_cap_triangle(cell, &values, &mut each);
    }

    /// The leaves with points in a cell, or in a cell of its size beside it, in a fixed order.
    pub fn leaves_around(&self, cell: OctreeCell) -> Vec<OctreeCell> {
        let cells = self.source.size().map(|n| ((n - 1) as i64) << cell.level);
        let mut leaves: Vec<OctreeCell> = Vec::new();
        let mut parts = Vec::new();
        for n in 0..27_i64 {
            let by = [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1];
            let at: [i64; 3] = std::array::from_fn(|k| i64::from(cell.at[k]) + by[k]);
            if (0..3).any(|k| at[k] < 0 || at[k] >= cells[k]) {
                continue;
            }
            parts.push(self.halved.leaf_around(OctreeCell { level: cell.level, at: at.map(|i| i as u32) }));
            while let Some(part) = parts.pop() {
                if self.halved.is_cell_halved(part) {
                    parts.extend(part.parts());
                } else if part.level >= cell.level || !leaves.contains(&part) {
                    // Only a larger leaf is met more than once.
                    leaves.push(part);
                }
            }
        }
        leaves
    }

    /// The sides of the corners of a cell, as bits.
    pub fn signs(&self, values: &[f64; 8]) -> u8 {
        (0..8).fold(0, |signs, c| signs | u8::from(self.rule.is_inside(values[c])) << c)
    }

    /// Visits the triangles of a leaf, with these values at its corners, except for caps.
    pub fn for_each_triangle(
        &self,
        cell: OctreeCell,
        values: &[f64; 8],
        mut each: impl FnMut(OctreeTriangle),
    ) {
        let signs = self.signs(values);
        if signs == 0 || signs == u8::MAX {
            return;
        }
        // On a halved face the neighbours have vertices that the table does not know.
        if self.has_halved_face(cell) {
            return self.fill_loops(cell, values, each);
        }
        let mut vertices = [None; 12];
        for edge in (0..12).filter(|edge| is_crossed(signs, *edge)) {
            let [a, b] = EDGES[edge].map(usize::from);
            let low = std::array::from_fn(|k| cell.at[k] + (a >> k & 1) as u32);
            let ends = [values[a], values[b]];
            vertices[edge] = Some(self.crossing(ValuedEdge { level: cell.level, axis: edge / 4, low, ends }));
        }
        let case = &TABLE.upright[usize::from(signs)];
        for triangle in &case.corners[..usize::from(case.triangles)] {
            if let [Some(a), Some(b), Some(c)] = triangle.map(|edge| vertices[usize::from(edge)]) {
                each([a, b, c]);
            }
        }
    }

    fn beside(cell: OctreeCell, axis: usize, end: usize) -> [i64; 3] {
        let mut at = cell.at.map(i64::from);
        at[axis] += 2 * end as i64 - 1;
        at
    }

    fn has_halved_face(&self, cell: OctreeCell) -> bool {
        (0..6).any(|face| self.halved.is_halved(cell.level, Self::beside(cell, face / 2, face % 2)))
    }

    /// Whether a cell has the triangles that it would have if no cell were halved.
    pub fn is_ordinary(&self, cell: OctreeCell) -> bool {
        !(0..27).filter(|n| *n != 13).any(|n: i64| {
            let by = [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1];
            // A cell that touches this one in a corner alone halves none of its edges.
            let is_at_corner = by.iter().all(|step| *step != 0);
            let at = std::array::from_fn(|k| i64::from(cell.at[k]) + by[k]);
            !is_at_corner && self.halved.is_halved(cell.level, at)
        })
    }

    /// The vertex of an edge with ends on different sides.
    fn crossing(&self, mut edge: ValuedEdge) -> OctreeVertex {
        // The ends are on different sides, so those of exactly one half are, too.
        while self.halved.is_edge_halved(edge.level, edge.axis, edge.low) {
            edge = self.halves(edge)[usize::from(!self.is_first_half_crossed(&edge))];
        }
        let [from, to] = edge.ends;
        let mut part = [0.0; 3];
        part[edge.axis] = self.rule.crossing(from, to);
        OctreeVertex {
            kind: OctreeVertexKind::Crossing(edge.axis as u8),
            level: edge.level,
            low: edge.low,
            part,
            is_zero: is_certain(edge.ends, self.slack, self.rule.margin),
        }
    }

    fn is_first_half_crossed(&self, edge: &ValuedEdge) -> bool {
        let [from, to] = edge.ends;
        self.rule.is_inside(from) != self.rule.is_inside(mean(from, to))
    }

    fn halves(&self, ValuedEdge { level, axis, low, ends: [from, to] }: ValuedEdge) -> [ValuedEdge; 2] {
        let middle = mean(from, to);
        let first = low.map(|i| 2 * i);
        let mut second = first;
        second[axis] += 1;
        [
            ValuedEdge { level: level + 1, axis, low: first, ends: [from, middle] },
            ValuedEdge { level: level + 1, axis, low: second, ends: [middle, to] },
        ]
    }

    /// Fills the loops of a cell with a face that is cut up.
    fn fill_loops(&self, cell: OctreeCell, values: &[f64; 8], mut each: impl FnMut(OctreeTriangle)) {
        let mut next: Vec<(VertexOrder, OctreeVertex, VertexOrder)> = Vec::new();
        for face in 0..6 {
            let (axis, end) = (face / 2, face % 2);
            self.for_each_segment(ValuedSquare::of_cell(cell, values, axis, end), end, &mut |from, to| {
                next.push((from.order(), from, to.order()));
            });
        }
        next.sort_unstable_by_key(|segment| segment.0);
        let mut seen = vec![false; next.len()];
        let mut number = 0;
        for start in 0..next.len() {
            let mut ring = Vec::new();
            let mut at = start;
            while !seen[at] {
                seen[at] = true;
                ring.push(next[at].1);
                match next.binary_search_by_key(&next[at].2, |segment| segment.0) {
                    Ok(behind) => at = behind,
                    Err(_) => unreachable!("a vertex ends one segment and begins another"),
                }
            }
            // The direction of the table: against the segments.
            match ring[..] {
                [] => {}
                [a, b, c] => each([a, c, b]),
                _ => {
                    let centre = self.centre(cell, number, &ring);
                    number += 1;
                    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
                    pairs.for_each(|(from, to)| each([centre, *to, *from]));
                }
            }
        }
    }

    /// Visits the segments of a square of a cell at an end of its axis.
    fn for_each_segment(
        &self,
        square: ValuedSquare,
        end: usize,
        each: &mut dyn FnMut(OctreeVertex, OctreeVertex),
    ) {
        let inside = square.values.map(|value| self.rule.is_inside(value));
        // Values of parts are means of these, so no part has a segment either.
        if inside == [false; 4] || inside == [true; 4] {
            return;
        }
        let mut beyond = square.low.map(i64::from);
        // At an upper end, `low` is already the index of the cell behind the square.
        beyond[square.axis] -= i64::from(end == 0);
        if self.halved.is_halved(square.level, beyond) {
            square.parts().into_iter().for_each(|part| self.for_each_segment(part, end, each));
            return;
        }
        let corners = std::array::from_fn(|number| inside[ValuedSquare::around(end, number)]);
        square_segments(corners, |from, to| {
            let vertex = |side: usize| self.crossing(square.side(end, side).0);
            each(vertex(from), vertex(to));
        });
    }

    /// A vertex inside a cell: the mean of vertices on its surface, each weighted by the length of the nearest part of the
    /// curve through them, so that many vertices on a finer face do not pull it there.
    fn centre(&self, cell: OctreeCell, number: u16, ring: &[OctreeVertex]) -> OctreeVertex {
        let places: Vec<[f64; 3]> = ring.iter().map(|vertex| vertex.within(cell)).collect();
        let apart = |a: usize, b: usize| distance(places[a], places[b]);
        let n = places.len();
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for (at, place) in places.iter().enumerate() {
            let weight = apart((at + n - 1) % n, at) + apart(at, (at + 1) % n);
            (0..3).for_each(|k| sum[k] += weight * place[k]);
            weights += weight;
        }
        OctreeVertex {
            kind: OctreeVertexKind::Centre(number),
            level: cell.level,
            low: cell.at,
            part: sum.map(|x| x / weights),
            is_zero: false,
        }
    }

    /// Visits the triangles of the caps of a leaf.
    pub fn for_each_cap_triangle(
        &self,
        cell: OctreeCell,
        values: &[f64; 8],
        mut each: impl FnMut(OctreeTriangle),
    ) {
        for (axis, ends) in self.rule.border.iter().enumerate() {
            let last = ((self.source.size()[axis] - 1) << cell.level) as u32 - 1;
            let is_there = [cell.at[axis] == 0, cell.at[axis] == last];
            for end in (0..2).filter(|end| is_there[*end] && ends[*end] == Border::Capped) {
                let square = ValuedSquare::of_cell(cell, values, axis, end);
                self.fill_cap(cell, &square, end, &mut each);
            }
        }
    }

    fn fill_cap(
        &self,
        cell: OctreeCell,
        square: &ValuedSquare,
        end: usize,
        each: &mut impl FnMut(OctreeTriangle),
    ) {
        let inside: [bool; 4] = std::array::from_fn(|number| {
            self.rule.is_inside(square.values[ValuedSquare::around(end, number)])
        });
        let sides: [(ValuedEdge, bool); 4] = std::array::from_fn(|number| square.side(end, number));
        let is_cut = |side: &(ValuedEdge, bool)| {
            let ValuedEdge { level, axis, low, .. } = side.0;
            self.halved.is_edge_halved(level, axis, low)
        };
        let corner = |number: usize| {
            let (edge, is_first) = sides[number];
            let mut low = edge.low;
            low[edge.axis] += u32::from(!is_first);
            self.corner(edge.level, low)
        };
        if !sides.iter().any(is_cut) {
            let mut vertices = Vec::new();
            let number = |spot: CapVertex| {
                vertices.push(match spot {
                    CapVertex::Corner(number) => corner(number),
                    CapVertex::Side(number) => self.crossing(sides[number].0),
                });
                vertices.len() as u32 - 1
            };
            let mut faces = Vec::new();
            triangles(inside, number, |face| faces.push(face));
            return faces.iter().for_each(|face| each(face.map(|v| vertices[v as usize])));
        }
        // Every run of inside corners, with all points on its sides, counter-clockwise.
        let side = |number: usize| {
            let (edge, is_first) = sides[number];
            let mut points = Vec::new();
            self.for_each_on_edge(edge, &mut |vertex| points.push(vertex));
            if !is_first {
                points.reverse();
            }
            points
        };
        let is_whole = inside == [true; 4];
        let firsts = (0..4).filter(|&i| if is_whole { i == 0 } else { inside[i] && !inside[(i + 3) % 4] });
        for first in firsts {
            let run = (1..4).find(|n| !inside[(first + n) % 4]).unwrap_or(4);
            // A run begins on the side before its first corner, where the surface crosses that side.
            let mut polygon = if is_whole { Vec::new() } else { side((first + 3) % 4) };
            for number in first..first + run {
                polygon.push(corner(number % 4));
                polygon.extend(side(number % 4));
            }
            // There are few loops: the numbers of caps begin far above theirs.
            let number = 4096 * (1 + 2 * square.axis + end) as u16 + first as u16;
            let centre = self.centre(cell, number, &polygon);
            let pairs = polygon.iter().zip(polygon.iter().cycle().skip(1));
            pairs.for_each(|(from, to)| each([centre, *from, *to]));
        }
    }

    fn corner(&self, level: u8, low: [u32; 3]) -> OctreeVertex {
        OctreeVertex { kind: OctreeVertexKind::Corner, level, low, part: [0.0; 3], is_zero: true }
    }

    /// Visits the points on an edge of a capped border that are inside or on the surface, between its ends, from the lower end
    /// on: the ends of its parts and its crossing.
    fn for_each_on_edge(&self, edge: ValuedEdge, each: &mut dyn FnMut(OctreeVertex)) {
        let inside = edge.ends.map(|value| self.rule.is_inside(value));
        if !self.halved.is_edge_halved(edge.level, edge.axis, edge.low) {
            if inside[0] != inside[1] {
                each(self.crossing(edge));
            }
            return;
        }
        // Values between two that are outside are outside as well.
        if inside == [false; 2] {
            return;
        }
        let [first, second] = self.halves(edge);
        self.for_each_on_edge(first, each);
        if self.rule.is_inside(second.ends[0]) {
            each(self.corner(second.level, second.low));
        }
        self.for_each_on_edge(second, each);
    }
}
