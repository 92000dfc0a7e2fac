//! Sews faces: vertices of loops at the same place become one, and if a vertex of one loop lies on an edge of another,
//! that edge gets a vertex there.
//!
//! Which vertices belong together is a guess by distance. No proof rests on it: the moves of vertices are measured, and
//! are part of the bound.
use super::prepared_face::PreparedFace;
use super::trim_loops::{TrimEdge, TrimPoint, TrimPolygons};
use crate::budget::{Job, par_map};
use crate::explicit::nurbs::BezierNet;
use crate::explicit::{BoxTree, BoxTreeNode};
use crate::math::{Box3, distance, greater, lesser};
use std::collections::BTreeMap;

/// Steps of a golden-section search. Chosen: each keeps 0.618 of an interval, so that a ten-millionth remains.
const STEPS: usize = 34;
/// Parts of an edge whose ends are the first samples for the nearest point. Chosen: enough for a half turn, so that its
/// nearest point is beside the nearest sample.
const SAMPLES: usize = 6;
/// The fraction of the sewing length within one face. Chosen: so small that thin parts of a face stay open.
const OWN: f64 = 1e-6;
/// The same for points more than half of the parameters apart, as on a seam. Chosen: the two sides of a seam meet only
/// up to the precision of their computation.
const OWN_SEAM: f64 = 1e-3;
/// Rounds that halve edges between the same vertices. Chosen: two curves that touch at their ends part early.
const DOUBLED_ROUNDS: usize = 8;
/// The golden ratio's inverse.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A face with polygons for its loops.
pub(super) struct TrimmedFace<'a> {
    pub net: BezierNet<'a>,
    pub prepared: PreparedFace,
    pub polygons: TrimPolygons,
    /// The surface's point at each vertex of the polygons.
    pub positions: Vec<[f64; 3]>,
}

/// The pairs of vertices, of all loops, that belong together.
pub(super) struct SewnVertices {
    /// By face: the number of its first vertex.
    pub first: Vec<u32>,
    /// Pairs of vertices of all faces that are near each other.
    pub near: Vec<[u32; 2]>,
}

/// An edge of all faces.
#[derive(Clone, Copy)]
struct EdgePlace {
    face: u32,
    around: u32,
    edge: u32,
}

/// A match of a vertex in another loop.
enum VertexMatch {
    /// It is this vertex of a face.
    Same(u32, u32),
    /// It lies on this edge, at this parameter of its piece.
    On(EdgePlace, f64),
}

impl TrimmedFace<'_> {
    /// The surface's point at coordinates of the lattice. The patches of two faces would be less exact: they are apart by
    /// the sum of both errors.
    pub fn surface_point(&self, at: [f64; 2]) -> [f64; 3] {
        let [u, v] = [0, 1].map(|k| self.prepared.lattice.parameter(k, at[k]));
        self.net.at(u, v)
    }

    fn point(&self, piece: usize, t: f64) -> [f64; 3] {
        self.surface_point(self.prepared.pieces.lattice_point(&self.prepared.lattice, piece, t))
    }

    /// The parameter of the point on an edge's part nearest to a point: beside the nearest sample, by golden sections.
    fn nearest(&self, edge: &TrimEdge, p: [f64; 3], near_at: impl Fn(TrimPoint) -> f64) -> Option<f64> {
        let far = |t: f64| distance(self.point(edge.piece, t), p);
        let [from, to] = edge.part;
        let at = |k: usize| from + (to - from) * (k as f64 / SAMPLES as f64);
        let (nearest, _) = (0..=SAMPLES).fold((0, f64::INFINITY), |best, k| {
            let distances = far(at(k));
            if distances < best.1 { (k, distances) } else { best }
        });
        // The nearest point is assumed to be between the neighbours of the nearest sample.
        let [mut low, mut high] = [at(nearest.saturating_sub(1)), at((nearest + 1).min(SAMPLES))];
        let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let mut distances = inner.map(far);
        for _ in 0..STEPS {
            if distances[0] < distances[1] {
                high = inner[1];
                (inner[1], distances[1]) = (inner[0], distances[0]);
                inner[0] = high - GOLDEN * (high - low);
                distances[0] = far(inner[0]);
            } else {
                low = inner[0];
                (inner[0], distances[0]) = (inner[1], distances[1]);
                inner[1] = low + GOLDEN * (high - low);
                distances[1] = far(inner[1]);
            }
        }
        let t = 0.5 * (low + high);
        let at = self.prepared.pieces.lattice_point(&self.prepared.lattice, edge.piece, t);
        (distance(self.surface_point(at), p) <= near_at(at)).then_some(t)
    }
}

/// Sews faces that are nearer than a length, and cuts the edges of each face until they are within its goal of its loops.
///
/// A vertex of one face becomes a vertex of the other. So edges are cut for the loops' sake only after the faces have
/// exchanged the vertices that cells need.
pub(super) fn sew(faces: &mut [TrimmedFace<'_>], goals: &[f64], near: f64, job: &Job) -> SewnVertices {
    let mut unions = exchange(faces, near, job);
    for (face, goal) in faces.iter_mut().zip(goals) {
        face.prepared.pieces.refine(&face.prepared.lattice, *goal, &mut face.polygons);
        for k in face.positions.len()..face.polygons.vertices.len() {
            face.positions.push(face.surface_point(face.polygons.vertices[k]));
        }
        face.halve_doubled_edges(OWN * near);
    }
    // Once more, for the vertices of the refined loops.
    unions.extend(exchange(faces, near, job));
    let mut first = Vec::with_capacity(faces.len());
    let mut n = 0;
    for face in faces.iter_mut() {
        first.push(n as u32);
        n += face.positions.len();
        face.polygons.loop_error = face.prepared.pieces.distance(&face.prepared.lattice, &face.polygons);
    }
    let unions = unions.into_iter().map(|pair| pair.map(|[face, vertex]| first[face as usize] + vertex));
    SewnVertices { near: unions.collect(), first }
}

/// Gives edges the vertices of others that lie on them. Returns the pairs of vertices to be united, each by its face and
/// its number there.
fn exchange(faces: &mut [TrimmedFace<'_>], near: f64, job: &Job) -> Vec<[[u32; 2]; 2]> {
    let mut places = Vec::new();
    let mut boxes = Vec::new();
    for (face, face_to_cut) in faces.iter().enumerate() {
        for (around, edges) in face_to_cut.polygons.loops.iter().enumerate() {
            for (index, edge) in edges.iter().enumerate() {
                places.push(EdgePlace { face: face as u32, around: around as u32, edge: index as u32 });
                boxes.push(face_to_cut.edge_box(edge, near));
            }
        }
    }
    let tree = BoxTree::over(&boxes);
    let vertices: Vec<[u32; 2]> = faces
        .iter()
        .enumerate()
        .flat_map(|(f, face)| (0..face.positions.len()).map(move |v| [f as u32, v as u32]))
        .collect();
    let shared: &[TrimmedFace<'_>] = faces;
    let matches_of_vertices: Vec<Vec<VertexMatch>> =
        par_map(job, &vertices, |_, vertex| matches_of(shared, *vertex, &tree, &places, near));

    // Vertices on edges, by edge and along it.
    let mut inserted: Vec<([u32; 3], f64, [u32; 2])> = Vec::new();
    let mut unions: Vec<[[u32; 2]; 2]> = Vec::new();
    for (vertex, matches) in vertices.iter().zip(matches_of_vertices) {
        for one in matches {
            match one {
                VertexMatch::Same(face, other) => unions.push([*vertex, [face, other]]),
                VertexMatch::On(place, t) => {
                    inserted.push(([place.face, place.around, place.edge], t, *vertex))
                }
            }
        }
    }
    // The order of the edges and of the parameters along them, so that the numbers of new vertices do not
    // depend on threads.
    inserted.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    // From the last edge to the first, so that the numbers of earlier edges stay.
    for run in inserted.chunk_by(|a, b| a.0 == b.0).collect::<Vec<_>>().into_iter().rev() {
        let [face, around, edge] = run[0].0;
        let face_to_cut = &mut faces[face as usize];
        let edge_to_cut = face_to_cut.polygons.loops[around as usize][edge as usize];
        let mut parts: Vec<TrimEdge> = vec![edge_to_cut];
        let mut last: Option<([f64; 3], u32)> = None;
        for (_, t, vertex) in run {
            let at = face_to_cut.in_cell_of(&edge_to_cut, *t);
            let position = face_to_cut.surface_point(at);
            let id = match last {
                Some((there, id)) if distance(there, position) <= near => id,
                _ => {
                    face_to_cut.polygons.vertices.push(at);
                    face_to_cut.positions.push(position);
                    let id = face_to_cut.positions.len() as u32 - 1;
                    let rest = parts.len() - 1;
                    let [from, to] = [parts[rest].ends[0], parts[rest].ends[1]];
                    let [start, end] = parts[rest].part;
                    parts[rest] = TrimEdge { part: [start, *t], ends: [from, id], ..edge_to_cut };
                    parts.push(TrimEdge { part: [*t, end], ends: [id, to], ..edge_to_cut });
                    last = Some((position, id));
                    id
                }
            };
            unions.push([*vertex, [face, id]]);
        }
        let edge = edge as usize;
        face_to_cut.polygons.loops[around as usize].splice(edge..=edge, parts);
    }
    unions
}

/// The vertices and edges near a vertex.
fn matches_of(
    faces: &[TrimmedFace<'_>],
    [face, vertex]: [u32; 2],
    tree: &BoxTree,
    places: &[EdgePlace],
    near: f64,
) -> Vec<VertexMatch> {
    let p = faces[face as usize].positions[vertex as usize];
    let holds = |bounds: &Box3| (0..3).all(|k| bounds.min[k] <= p[k] && p[k] <= bounds.max[k]);
    let mut matches = Vec::new();
    let mut open: Vec<u32> =
        tree.root().into_iter().filter(|(bounds, _)| holds(bounds)).map(|(_, c)| c).collect();
    while let Some(child) = open.pop() {
        let item = match tree.node(child) {
            BoxTreeNode::Inner(children) => {
                open.extend(children.iter().filter(|(bounds, _)| holds(bounds)).map(|(_, child)| *child));
                continue;
            }
            BoxTreeNode::Leaf(item) => item,
        };
        let place = places[item];
        let other_face = &faces[place.face as usize];
        let edge = &other_face.polygons.loops[place.around as usize][place.edge as usize];
        if place.face == face && edge.ends.contains(&vertex) {
            continue;
        }
        let near_at = |at: TrimPoint| {
            if place.face != face {
                return near;
            }
            let (here, n) = (other_face.polygons.vertices[vertex as usize], other_face.prepared.lattice.n);
            // Across a seam, parameters differ by nearly the whole range.
            let is_seam = (0..2).any(|k| (at[k] - here[k]).abs() > 0.5 * n[k] as f64);
            near * if is_seam { OWN_SEAM } else { OWN }
        };
        let ends = edge.ends.map(|id| other_face.positions[id as usize]);
        let far = ends.map(|end| distance(end, p));
        let nearer = usize::from(far[1] < far[0]);
        // An end takes precedence over a point beside it, so that vertices become one.
        if far[nearer] <= near_at(other_face.polygons.vertices[edge.ends[nearer] as usize]) {
            matches.push(VertexMatch::Same(place.face, edge.ends[nearer]));
            continue;
        }
        matches.extend(other_face.nearest(edge, p, near_at).map(|t| VertexMatch::On(place, t)));
    }
    matches
}

impl TrimmedFace<'_> {
    /// A box around an edge's part of the surface, with a margin for near vertices.
    fn edge_box(&self, edge: &TrimEdge, near: f64) -> Box3 {
        let [from, to] = edge.part;
        let at = |k: usize| self.point(edge.piece, from + (to - from) * (k as f64 / SAMPLES as f64));
        let mut points: Vec<[f64; 3]> = (0..=SAMPLES).map(at).collect();
        // Twice the height that the arch between two samples has: a quarter of the height over two such parts.
        let arch = points.windows(3).fold(0.0, |most: f64, p| {
            let between = std::array::from_fn(|k| 0.5 * (p[0][k] + p[2][k]));
            greater(distance(p[1], between), most)
        });
        points.extend(edge.ends.map(|id| self.positions[id as usize]));
        let (bounds, margin) = (Box3::from_points(&points), near + 0.5 * arch);
        Box3 { min: bounds.min.map(|x| x - margin), max: bounds.max.map(|x| x + margin) }
    }

    /// Halves edges with both vertices in common if their loops are apart: otherwise the area between them would vanish.
    fn halve_doubled_edges(&mut self, near: f64) {
        for _ in 0..DOUBLED_ROUNDS {
            let mut by_ends: BTreeMap<[[u64; 2]; 2], Vec<[usize; 2]>> = BTreeMap::new();
            for (around, edges) in self.polygons.loops.iter().enumerate() {
                for (index, edge) in edges.iter().enumerate() {
                    let mut ends = edge.ends.map(|id| self.polygons.vertices[id as usize].map(f64::to_bits));
                    ends.sort_unstable();
                    by_ends.entry(ends).or_default().push([around, index]);
                }
            }
            let mut doubled: Vec<([usize; 2], f64, TrimPoint)> = Vec::new();
            for places in by_ends.into_values().filter(|places| places.len() > 1) {
                let middle = |[around, index]: [usize; 2]| {
                    let edge = &self.polygons.loops[around][index];
                    let t = 0.5 * (edge.part[0] + edge.part[1]);
                    ([around, index], t, self.in_cell_of(edge, t))
                };
                let middles: Vec<_> = places.into_iter().map(middle).collect();
                let points = middles.iter().map(|(_, _, at)| self.surface_point(*at)).collect::<Vec<_>>();
                if points.iter().any(|p| distance(*p, points[0]) > near) {
                    doubled.extend(middles);
                }
            }
            if doubled.is_empty() {
                break;
            }
            doubled.sort_by_key(|(place, ..)| *place);
            // From the last edge to the first, so that the numbers of earlier edges stay.
            for ([around, index], t, at) in doubled.into_iter().rev() {
                let edge = self.polygons.loops[around][index];
                self.polygons.vertices.push(at);
                self.positions.push(self.surface_point(at));
                let id = self.positions.len() as u32 - 1;
                let halves = [
                    TrimEdge { part: [edge.part[0], t], ends: [edge.ends[0], id], ..edge },
                    TrimEdge { part: [t, edge.part[1]], ends: [id, edge.ends[1]], ..edge },
                ];
                self.polygons.loops[around].splice(index..=index, halves);
            }
        }
    }

    /// The lattice point of an edge's part at a parameter, in the cell of the edge.
    fn in_cell_of(&self, edge: &TrimEdge, t: f64) -> [f64; 2] {
        let at = self.prepared.pieces.lattice_point(&self.prepared.lattice, edge.piece, t);
        let ends = edge.ends.map(|id| self.polygons.vertices[id as usize]);
        // An edge on a line is in the cells on both sides, and stays on it.
        let Some(common) = self.prepared.lattice.cells.common_rectangle(ends) else { return at };
        [0, 1].map(|k| lesser(greater(at[k], common[k][0]), common[k][1]))
    }
}
