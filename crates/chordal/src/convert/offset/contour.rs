//! Triangles from the cells of an octree: a vertex for each part of the surface in a cell, a polygon around each crossed
//! edge.
//!
//! *Parts.* On a face that two cells share, the surface runs from where it enters the inside to where it leaves it: each
//! run of inside corners is cut off by itself. Such segments join the crossed edges of a cell to closed loops, and each
//! loop is a part with a vertex of its own. So the result is closed, and no vertex joins two fans.
//!
//! *No crossings.* A polygon connects the vertices of the cells around an edge. Where the way from one cell's vertex to
//! the next leaves the two cells, it goes over a point of their common face; where the two triangles of a quad would not
//! stay between the ends of their edge, the polygon is a fan around the point where the edge is crossed. Then each
//! triangle is inside of cells that no other polygon's triangle shares, except for parts that share a cell.
//!
//! Source: T. Ju, T. Udeshi, *Intersection-free Contouring on an Octree Grid*, 2006.
use super::distance::{Hint, OffsetSample, Plane, along};
use super::edge_view::EdgeView;
use super::octree::{Octree, OffsetCell};
use super::vertex::{INSET, PlacedVertex, place};
use crate::budget::{Job, par_map};
use crate::explicit::DisjointSets;
use crate::math::{difference, distance, dot};
use std::collections::{BTreeMap, BTreeSet};

/// The corners of a cell's edges, by axis.
const EDGES: [[u8; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];
/// The cells around an edge, counter-clockwise seen against the axis, by steps along the two other axes.
const AROUND: [[u32; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];
/// Steps of Newton's method along an edge. Chosen: the first brings most crossings within a hundredth of their edge.
const STEPS: usize = 2;
/// A crossing is found if the surface is nearer than this share of its edge.
const FOUND: f64 = 1e-3;
/// Work of a task.
const TASK: usize = 64;

const NONE: u32 = u32::MAX;

/// An edge of some leaf that no leaf beside it divides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    axis: u8,
    low: [u32; 3],
    size: u32,
}

impl Edge {
    /// The line that contains it.
    fn line(self) -> (u8, u32, u32) {
        let axis = usize::from(self.axis);
        (self.axis, self.low[(axis + 1) % 3], self.low[(axis + 2) % 3])
    }

    fn start(self) -> u32 {
        self.low[usize::from(self.axis)]
    }
}

/// An edge that the surface crosses.
#[derive(Clone, Copy, Debug)]
struct CrossedOctreeEdge {
    edge: Edge,
    is_low_inside: bool,
    /// The leaves around it; a leaf that takes up two quarters occurs twice in a row.
    ring: [u32; 4],
    /// The point on the edge.
    point: [f64; 3],
    plane: Plane,
    /// By quarter k: the segment on the face between the leaves k and k + 1; `NONE` if they are one leaf.
    segments: [u32; 4],
}

impl CrossedOctreeEdge {
    fn quarter(&self, leaf: u32) -> usize {
        self.ring.iter().position(|other| *other == leaf).expect("the leaf is beside the edge")
    }

    /// The number of the part of a leaf, before parts are joined.
    fn item(id: u32, quarter: usize) -> u32 {
        4 * id + quarter as u32
    }
}

/// The surface on a face that two leaves share: from one crossed edge to another.
#[derive(Clone, Copy, Debug)]
struct Segment {
    ends: [u32; 2],
    leaves: [u32; 2],
    face: Face,
}

/// A square on which two leaves meet: the whole side of the smaller one.
#[derive(Clone, Copy, Debug)]
struct Face {
    axis: usize,
    low: [u32; 3],
    size: u32,
}

/// The surface of an octree.
pub(super) struct Contour {
    pub positions: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    /// By face: the leaves that its vertices came from.
    pub leaves: Vec<[u32; 4]>,
    /// Leaves that should be cut: their vertex was not found within, or two parts share it.
    pub unsure: BTreeSet<u32>,
}

/// Results of earlier rounds.
#[derive(Default)]
pub(super) struct ContourMemo {
    crossings: BTreeMap<Edge, ([f64; 3], Plane)>,
    vertices: BTreeMap<(OffsetCell, Vec<Edge>), PlacedVertex>,
}

pub(super) fn contour(tree: &Octree, known: &mut ContourMemo, job: &Job) -> Contour {
    let mut crossings = crossings(tree, known, job);
    let (segments, parts) = segments(tree, &mut crossings);
    Builder { tree, crossings, segments, job }.build(parts, known)
}

/// All crossed edges, in the order of their owners: the first of the smallest leaves around them.
fn crossings(tree: &Octree, known: &mut ContourMemo, job: &Job) -> Vec<CrossedOctreeEdge> {
    let numbers: Vec<u32> = (0..tree.leaves.len() as u32).collect();
    let owned: Vec<CrossedOctreeEdge> =
        par_map(job, &numbers, |_, leaf| owned_crossings(tree, *leaf)).into_iter().flatten().collect();
    let new: Vec<CrossedOctreeEdge> =
        owned.iter().filter(|c| !known.crossings.contains_key(&c.edge)).copied().collect();
    let tasks: Vec<&[CrossedOctreeEdge]> = new.chunks(TASK).collect();
    let found = par_map(job, &tasks, |_, task| {
        let mut hint = Hint::default();
        task.iter().map(|c| (c.edge, crossing_point(tree, c, &mut hint))).collect::<Vec<_>>()
    });
    known.crossings.extend(found.into_iter().flatten());
    let located = |c: CrossedOctreeEdge| {
        let (point, plane) = known.crossings[&c.edge];
        CrossedOctreeEdge { point, plane, ..c }
    };
    owned.into_iter().map(located).collect()
}

fn owned_crossings(tree: &Octree, number: u32) -> Vec<CrossedOctreeEdge> {
    let leaf = tree.leaves[number as usize];
    let mut found = Vec::new();
    for (e, corners) in EDGES.iter().enumerate() {
        let axis = e / 4;
        let [low, high] = corners.map(|c| leaf.corner(usize::from(c)));
        let [below, above] = [low, high].map(|at| tree.sample(at).value < 0.0);
        if below == above {
            continue;
        }
        if let Some(ring) = owned_ring(tree, number, axis, low) {
            let edge = Edge { axis: axis as u8, low, size: leaf.size };
            let plane = Plane { at: [0.0; 3], normal: [0.0; 3] };
            found.push(CrossedOctreeEdge {
                edge,
                is_low_inside: below,
                ring,
                point: [0.0; 3],
                plane,
                segments: [NONE; 4],
            });
        }
    }
    found
}

/// The leaves around an edge, if no leaf there is smaller and none of the same size is before this one.
fn owned_ring(tree: &Octree, number: u32, axis: usize, low: [u32; 3]) -> Option<[u32; 4]> {
    let size = tree.leaves[number as usize].size;
    let (u, w) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut ring = [NONE; 4];
    for (quarter, [du, dw]) in AROUND.into_iter().enumerate() {
        let mut at = low;
        at[u] = at[u].checked_sub(du)?;
        at[w] = at[w].checked_sub(dw)?;
        let other = tree.leaf_at(at)?;
        let other_size = tree.leaves[other as usize].size;
        if other_size < size || other_size == size && other < number {
            return None;
        }
        ring[quarter] = other;
    }
    Some(ring)
}

/// Where the surface crosses an edge, and its plane there.
fn crossing_point(tree: &Octree, c: &CrossedOctreeEdge, hint: &mut Hint) -> ([f64; 3], Plane) {
    let axis = usize::from(c.edge.axis);
    let [low, high] = tree.on_edge(axis, c.edge.low, c.edge.size);
    let length = high.at[axis] - low.at[axis];
    let (mut first, mut last) = (0.0, 1.0);
    let mut share = low.value / (low.value - high.value);
    let mut best: Option<(f64, OffsetSample)> = None;
    for _ in 0..=STEPS {
        let mut at = low.at;
        at[axis] += share * length;
        let sample = tree.distance().at(at, hint);
        let is_inside = sample.value < 0.0;
        if best.as_ref().is_none_or(|(_, best)| sample.value.abs() < best.value.abs()) {
            best = Some((share, sample));
        }
        if sample.value.abs() <= FOUND * length {
            break;
        }
        *(if is_inside == c.is_low_inside { &mut first } else { &mut last }) = share;
        let newton = share - sample.value / (sample.normal[axis] * length);
        share = if newton > first && newton < last { newton } else { 0.5 * (first + last) };
    }
    let (share, sample) = best.expect("there is at least one step");
    let mut point = low.at;
    point[axis] += share * length;
    (point, sample.plane())
}

/// Joins crossed edges along the faces of leaves.
fn segments(tree: &Octree, crossings: &mut [CrossedOctreeEdge]) -> (Vec<Segment>, DisjointSets) {
    let mut lines: Vec<((u8, u32, u32), u32, u32)> =
        crossings.iter().enumerate().map(|(id, c)| (c.edge.line(), c.edge.start(), id as u32)).collect();
    lines.sort_unstable();
    let mut parts = DisjointSets::new(4 * crossings.len());
    let mut segments = Vec::new();
    for id in 0..crossings.len() as u32 {
        for quarter in 0..4 {
            let c = crossings[id as usize];
            let next = (quarter + 1) % 4;
            let leaves = [c.ring[quarter], c.ring[next]];
            if leaves[0] == leaves[1] {
                parts.union(CrossedOctreeEdge::item(id, quarter), CrossedOctreeEdge::item(id, next));
                continue;
            }
            if c.segments[quarter] != NONE {
                continue;
            }
            let face = common_face(leaves.map(|leaf| tree.leaves[leaf as usize]));
            for ends in runs(&face, &lines, crossings) {
                let number = segments.len() as u32;
                for leaf in leaves {
                    let [one, two] =
                        ends.map(|end| CrossedOctreeEdge::item(end, crossings[end as usize].quarter(leaf)));
                    parts.union(one, two);
                }
                for end in ends {
                    let crossing = &mut crossings[end as usize];
                    let between = |k: &usize| {
                        let pair = [crossing.ring[*k], crossing.ring[(k + 1) % 4]];
                        pair == leaves || pair == [leaves[1], leaves[0]]
                    };
                    let at = (0..4).find(between).expect("the face ends at the edge");
                    crossing.segments[at] = number;
                }
                segments.push(Segment { ends, leaves, face });
            }
        }
    }
    (segments, parts)
}

/// The face of two leaves that share an edge of it.
fn common_face([a, b]: [OffsetCell; 2]) -> Face {
    let meets = |k: usize| a.low[k] + a.size == b.low[k] || b.low[k] + b.size == a.low[k];
    let overlaps = |k: usize| a.low[k] < b.low[k] + b.size && b.low[k] < a.low[k] + a.size;
    let axis = (0..3)
        .find(|k| meets(*k) && (0..3).all(|j| j == *k || overlaps(j)))
        .expect("leaves that follow each other around an edge share a face");
    let small = if a.size <= b.size { a } else { b };
    let mut low = small.low;
    low[axis] = if a.low[axis] + a.size == b.low[axis] { b.low[axis] } else { a.low[axis] };
    Face { axis, low, size: small.size }
}

/// The segments on a face: from each crossing into the inside to the next one out of it.
fn runs(face: &Face, lines: &[((u8, u32, u32), u32, u32)], crossings: &[CrossedOctreeEdge]) -> Vec<[u32; 2]> {
    let (u, w) = ((face.axis + 1) % 3, (face.axis + 2) % 3);
    let moved = |k: usize| {
        let mut low = face.low;
        low[k] += face.size;
        low
    };
    let mut around: Vec<(u32, bool)> = Vec::new();
    for (axis, low, is_back) in
        [(u, face.low, false), (w, moved(u), false), (u, moved(w), true), (w, face.low, true)]
    {
        let line = Edge { axis: axis as u8, low, size: face.size }.line();
        let first = lines.partition_point(|(other, start, _)| (*other, *start) < (line, low[axis]));
        let on = lines[first..]
            .iter()
            .take_while(|(other, start, _)| *other == line && *start < low[axis] + face.size);
        let at = around.len();
        // Whether one leaves the inside there.
        around.extend(on.map(|(_, _, id)| (*id, crossings[*id as usize].is_low_inside != is_back)));
        if is_back {
            around[at..].reverse();
        }
    }
    let n = around.len();
    let pairs = (0..n).map(|k| (around[k], around[(k + 1) % n]));
    pairs.filter(|((_, from), (_, to))| !from && *to).map(|((from, _), (to, _))| [from, to]).collect()
}

struct Builder<'a> {
    tree: &'a Octree,
    crossings: Vec<CrossedOctreeEdge>,
    segments: Vec<Segment>,
    job: &'a Job,
}

impl Builder<'_> {
    fn build(&self, parts: DisjointSets, known: &mut ContourMemo) -> Contour {
        let (vertex_of_item, n_vertices) = parts.labels();
        let placed = self.place(&vertex_of_item, n_vertices, known);
        let mut unsure = BTreeSet::new();
        let mut leaf_of = vec![NONE; n_vertices];
        for (id, c) in self.crossings.iter().enumerate() {
            for quarter in 0..4 {
                let vertex = vertex_of_item[CrossedOctreeEdge::item(id as u32, quarter) as usize];
                leaf_of[vertex as usize] = c.ring[quarter];
            }
        }
        for (vertex, placed) in placed.iter().enumerate() {
            if !placed.is_sure {
                unsure.insert(leaf_of[vertex]);
            }
        }
        let mut positions: Vec<[f64; 3]> = placed.iter().map(|vertex| vertex.at).collect();
        let on_faces = self.face_vertices(&vertex_of_item, &mut positions);
        let mut contour = Contour { positions, faces: Vec::new(), leaves: Vec::new(), unsure };
        let mut polygons: Vec<Polygon> = Vec::with_capacity(self.crossings.len());
        for (id, c) in self.crossings.iter().enumerate() {
            let corners: [u32; 4] =
                std::array::from_fn(|k| vertex_of_item[CrossedOctreeEdge::item(id as u32, k) as usize]);
            let is_crease = corners.iter().any(|v| placed[*v as usize].is_crease);
            polygons.push(self.polygon(c, corners, &on_faces, is_crease, &contour.positions));
        }
        let doubled = doubled_diagonals(&polygons);
        for (c, Polygon { ring, cut }) in self.crossings.iter().zip(polygons) {
            match cut.filter(|triangles| diagonal(triangles).is_none_or(|pair| !doubled.contains(&pair))) {
                Some(triangles) => triangles.into_iter().for_each(|face| contour.push(face, c.ring)),
                None => contour.push_fan(&ring, c),
            }
        }
        contour
    }

    fn place(&self, vertex_of_item: &[u32], n_vertices: usize, known: &mut ContourMemo) -> Vec<PlacedVertex> {
        let mut members: Vec<(OffsetCell, Vec<u32>)> =
            vec![(OffsetCell { low: [0; 3], size: 0 }, Vec::new()); n_vertices];
        for (id, c) in self.crossings.iter().enumerate() {
            for quarter in 0..4 {
                let vertex = vertex_of_item[CrossedOctreeEdge::item(id as u32, quarter) as usize] as usize;
                members[vertex].0 = self.tree.leaves[c.ring[quarter] as usize];
                if members[vertex].1.last() != Some(&(id as u32)) {
                    members[vertex].1.push(id as u32);
                }
            }
        }
        let key = |(cell, ids): &(OffsetCell, Vec<u32>)| {
            (*cell, ids.iter().map(|id| self.crossings[*id as usize].edge).collect::<Vec<Edge>>())
        };
        let placed = par_map(self.job, &members, |_, member| {
            let key = key(member);
            if let Some(placed) = known.vertices.get(&key) {
                return (None, *placed);
            }
            let planes: Vec<Plane> = member.1.iter().map(|id| self.crossings[*id as usize].plane).collect();
            (Some(key), place(self.tree.distance(), &planes, self.tree.cell_box(member.0)))
        });
        let mut all = Vec::with_capacity(n_vertices);
        for (key, placed) in placed {
            if let Some(key) = key {
                known.vertices.insert(key, placed);
            }
            all.push(placed);
        }
        all
    }

    /// By segment: the vertex on its face, or `NONE` if the straight way from one cell's vertex to the other's passes
    /// through the face.
    fn face_vertices(&self, vertex_of_item: &[u32], positions: &mut Vec<[f64; 3]>) -> Vec<u32> {
        let vertices_of = |segment: &Segment| {
            segment.leaves.map(|leaf| {
                let quarter = self.crossings[segment.ends[0] as usize].quarter(leaf);
                vertex_of_item[CrossedOctreeEdge::item(segment.ends[0], quarter) as usize]
            })
        };
        let mut pairs: Vec<([u32; 2], u32)> = Vec::with_capacity(self.segments.len());
        for (number, segment) in self.segments.iter().enumerate() {
            let [a, b] = vertices_of(segment);
            pairs.push(([a.min(b), a.max(b)], number as u32));
        }
        pairs.sort_unstable();
        let mut is_bent = vec![false; self.segments.len()];
        for same in pairs.chunk_by(|a, b| a.0 == b.0) {
            for (vertices, number) in same {
                let ends = vertices.map(|v| positions[v as usize]);
                // Two segments between the same vertices would be one edge of four faces.
                is_bent[*number as usize] =
                    same.len() > 1 || !self.passes(&self.segments[*number as usize].face, ends);
            }
        }
        let mut on_faces = vec![NONE; self.segments.len()];
        for (number, segment) in self.segments.iter().enumerate() {
            if is_bent[number] {
                on_faces[number] = positions.len() as u32;
                positions.push(self.face_point(segment));
            }
        }
        on_faces
    }

    fn face_box(&self, face: &Face) -> [[f64; 3]; 2] {
        let mut high = face.low;
        (0..3).filter(|k| *k != face.axis).for_each(|k| high[k] += face.size);
        [self.tree.at(face.low), self.tree.at(high)]
    }

    /// Whether a straight line passes through a face, and not along a side of it, where triangles would be flat.
    fn passes(&self, face: &Face, [a, b]: [[f64; 3]; 2]) -> bool {
        let [low, high] = self.face_box(face);
        let k = face.axis;
        let share = (low[k] - a[k]) / (b[k] - a[k]);
        if !(0.0..=1.0).contains(&share) {
            return false;
        }
        let at = along(a, share, difference(b, a));
        (0..3).all(|j| {
            let inset = INSET * (high[j] - low[j]);
            j == k || at[j] >= low[j] + inset && at[j] <= high[j] - inset
        })
    }

    /// A point of the surface on a face, between two crossings of the face's sides.
    fn face_point(&self, segment: &Segment) -> [f64; 3] {
        let [low, high] = self.face_box(&segment.face);
        let [a, b] = segment.ends.map(|end| self.crossings[end as usize].point);
        let clamped = |p: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| {
                let inset = INSET * (high[k] - low[k]);
                p[k].clamp(low[k] + inset, high[k] - inset)
            })
        };
        let mut at: [f64; 3] = clamped(std::array::from_fn(|k| 0.5 * (a[k] + b[k])));
        let mut hint = Hint::default();
        for _ in 0..STEPS {
            let sample = self.tree.distance().at(at, &mut hint);
            let mut slope = sample.normal;
            slope[segment.face.axis] = 0.0;
            let square = dot(slope, slope);
            // A slope of a tenth would go ten times as far as the surface.
            if square > 0.01 {
                at = clamped(along(at, -sample.value / square, slope));
            }
        }
        at
    }

    /// The polygon around a crossed edge.
    fn polygon(
        &self,
        c: &CrossedOctreeEdge,
        corners: [u32; 4],
        on_faces: &[u32],
        is_crease: bool,
        positions: &[[f64; 3]],
    ) -> Polygon {
        let mut ring: Vec<u32> = Vec::with_capacity(8);
        let mut is_straight = true;
        for (corner, segment) in corners.into_iter().zip(c.segments) {
            if segment == NONE {
                // The same leaf twice.
                continue;
            }
            ring.push(corner);
            let on_face = on_faces[segment as usize];
            if on_face != NONE {
                is_straight = false;
                ring.push(on_face);
            }
        }
        if !c.is_low_inside {
            ring.reverse();
        }
        let cut = if is_straight { self.cut(c, &ring, is_crease, positions) } else { None };
        Polygon { ring, cut }
    }

    /// One or two triangles that stay between the ends of the edge, if there are such.
    fn cut(
        &self,
        c: &CrossedOctreeEdge,
        ring: &[u32],
        is_crease: bool,
        positions: &[[f64; 3]],
    ) -> Option<Vec<[u32; 3]>> {
        let at = |k: usize| positions[ring[k] as usize];
        let view = EdgeView::new(
            self.tree.on_edge(usize::from(c.edge.axis), c.edge.low, c.edge.size).map(|end| end.at),
            usize::from(c.edge.axis),
            !c.is_low_inside,
        );
        match ring.len() {
            3 => view.holds([at(0), at(1), at(2)]).then(|| vec![[ring[0], ring[1], ring[2]]]),
            4 => {
                let allowed = [0, 1].map(|first| view.holds_quad([0, 1, 2, 3].map(|k| at((first + k) % 4))));
                let first = match allowed {
                    [false, false] => return None,
                    [true, false] => 0,
                    [false, true] => 1,
                    [true, true] if is_crease => usize::from(self.off(at(0), at(2)) > self.off(at(1), at(3))),
                    [true, true] => usize::from(distance(at(0), at(2)) > distance(at(1), at(3))),
                };
                let v = |k: usize| ring[(first + k) % 4];
                Some(vec![[v(0), v(1), v(2)], [v(0), v(2), v(3)]])
            }
            _ => None,
        }
    }

    /// How far the middle of a diagonal is from the surface.
    fn off(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let middle = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        self.tree.distance().at(middle, &mut Hint::default()).value.abs()
    }
}

/// The vertices around a crossed edge, and the triangles between them; without these it is a fan around the crossing.
struct Polygon {
    ring: Vec<u32>,
    cut: Option<Vec<[u32; 3]>>,
}

fn pair_of(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The side that two triangles share: the first one of both.
fn diagonal(triangles: &[[u32; 3]]) -> Option<[u32; 2]> {
    if let [[a, _, c], _] = triangles { Some(pair_of(*a, *c)) } else { None }
}

/// Diagonals that are sides of other polygons or diagonals of theirs: such an edge would have four faces. It happens where two
/// large leaves meet along several small edges.
fn doubled_diagonals(polygons: &[Polygon]) -> BTreeSet<[u32; 2]> {
    let mut pairs: Vec<([u32; 2], bool)> = Vec::new();
    for Polygon { ring, cut } in polygons {
        pairs.extend((0..ring.len()).map(|k| (pair_of(ring[k], ring[(k + 1) % ring.len()]), false)));
        pairs.extend(cut.as_deref().and_then(diagonal).map(|pair| (pair, true)));
    }
    pairs.sort_unstable();
    let groups = pairs.chunk_by(|a, b| a.0 == b.0);
    groups
        .filter(|group| group.len() > 1 && group.iter().any(|(_, is_cut)| *is_cut))
        .map(|group| group[0].0)
        .collect()
}

impl Contour {
    fn push_fan(&mut self, ring: &[u32], c: &CrossedOctreeEdge) {
        let middle = self.positions.len() as u32;
        self.positions.push(c.point);
        for k in 0..ring.len() {
            self.push([middle, ring[k], ring[(k + 1) % ring.len()]], c.ring);
        }
    }

    fn push(&mut self, face: [u32; 3], leaves: [u32; 4]) {
        self.faces.push(face);
        self.leaves.push(leaves);
    }
}
