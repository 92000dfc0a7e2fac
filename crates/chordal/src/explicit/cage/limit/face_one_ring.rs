//! `FaceOneRing`: a face of a cage with all data that determines its limit surface, and its subdivision.
use super::super::edges::{CageEdges, VertexIncidence};
use super::super::sharpness::{CageSharpness, is_hole};
use super::super::vertex_rule::CagePoint;
use super::super::{Boundary, Cage, CreasingMethod, FaceSizes, INFINITELY_SHARP, InvalidCage, Scheme};
use crate::math::greater;

/// A cage's edges, incidence and sharpness, computed once.
pub(in super::super) struct CageTopology {
    pub edges: CageEdges,
    pub incidence: VertexIncidence,
    pub sharp: CageSharpness,
}

impl CageTopology {
    pub fn new(cage: &Cage) -> Self {
        Self::with_edges(cage, CageEdges::new(cage))
    }

    fn with_edges(cage: &Cage, edges: CageEdges) -> Self {
        let around = VertexIncidence::new(cage, &edges);
        let sharp = CageSharpness::new(cage, &edges, &around);
        Self { edges, incidence: around, sharp }
    }

    pub fn is_hole(&self, cage: &Cage, face: usize) -> bool {
        is_hole(cage, &self.edges, &self.incidence, face)
    }
}

/// A face and the faces around its vertices, as a separate cage with that face first.
///
/// Faces beyond an infinitely sharp edge are left out: they do not shape this one, and would only enlarge the
/// hull. So the limit surface of the face lies in the convex hull of the vertices here: all rules are means
/// with nonnegative weights.
#[derive(Clone, Debug)]
pub(crate) struct FaceOneRing {
    cage: Cage,
    /// For Loop's scheme the identity of the edge from each corner, if some edges have the same ends;
    /// otherwise empty.
    classes: Vec<u32>,
    /// The largest rounding error of its positions, in each coordinate.
    off: f64,
}

impl FaceOneRing {
    pub(in super::super) fn new(cage: &Cage, parts: &CageTopology, face: usize) -> Self {
        Self::rotated(cage, &[], parts, face, 0)
    }

    /// The topology of its cage.
    pub(super) fn topology(&self) -> CageTopology {
        CageTopology::with_edges(&self.cage, edges_with_classes(&self.cage, &self.classes))
    }

    /// The ring of a face, starting at its corner `turn`.
    fn rotated(cage: &Cage, edge_classes: &[u32], parts: &CageTopology, face: usize, turn: usize) -> Self {
        let middle = cage.face(face);
        let mut sectors: Vec<CreaseSector> = middle
            .iter()
            .map(|vertex| CreaseSector::new(parts, cage.creasing, *vertex, face as u32))
            .collect();
        let mut faces: Vec<u32> = Vec::with_capacity(16);
        // If a vertex has some of the faces beyond a cut because of another vertex, it needs all of them.
        // Lists only grow, so this ends.
        loop {
            faces.clear();
            sectors.iter().for_each(|sector| faces.extend_from_slice(&sector.faces));
            if cage.creasing == CreasingMethod::Chaikin {
                sectors.iter().zip(middle).for_each(|(sector, vertex)| {
                    faces.extend(sector.faces_at_far_ends(parts, *vertex));
                });
            }
            faces.sort_unstable();
            faces.dedup();
            let is_torn = |sector: &&mut CreaseSector, vertex: u32| {
                let around = parts.incidence.faces(vertex as usize);
                let n_present = around.iter().filter(|face| faces.binary_search(face).is_ok()).count();
                sector.sharpness < INFINITELY_SHARP && n_present > sector.faces.len()
            };
            let pairs = sectors.iter_mut().zip(middle);
            let torn = pairs.filter(|(sector, vertex)| is_torn(sector, **vertex)).map(|(sector, vertex)| {
                sector.faces = parts.incidence.faces(*vertex as usize).to_vec();
            });
            if torn.count() == 0 {
                break;
            }
        }
        let sharp = sectors.iter().zip(middle).map(|(sector, vertex)| (*vertex, sector.sharpness));
        let sharp_vertices: Vec<(u32, f64)> = sharp.filter(|(_, sharpness)| *sharpness > 0.0).collect();
        faces.retain(|other| *other != face as u32);
        let mut vertices: Vec<u32> = middle.to_vec();
        faces.iter().for_each(|face| vertices.extend_from_slice(cage.face(*face as usize)));
        vertices.sort_unstable();
        vertices.dedup();
        let local = |vertex: u32| vertices.partition_point(|v| *v < vertex) as u32;
        let mut corners: Vec<u32> = Vec::with_capacity(4 * faces.len() + middle.len());
        // The face itself comes first, with the corner that its parameters start from.
        corners.extend((0..middle.len()).map(|k| local(middle[(k + turn) % middle.len()])));
        let mut ends = vec![corners.len() as u32];
        let mut classes: Vec<u32> = Vec::new();
        if !edge_classes.is_empty() {
            let n = middle.len();
            classes.extend((0..n).map(|k| edge_classes[cage.begin(face) + (k + turn) % n]));
            faces
                .iter()
                .for_each(|face| classes.extend_from_slice(&edge_classes[cage.sizes.range(*face as usize)]));
        }
        let mut creases: Vec<([u32; 2], f64)> = Vec::new();
        for &index in std::iter::once(&(face as u32)).chain(&faces) {
            let (begin, face) = (cage.begin(index as usize), cage.face(index as usize));
            for k in 0..face.len() {
                let edge = parts.edges.of_corner[begin + k] as usize;
                if parts.sharp.edges[edge] > 0.0 {
                    creases.push((parts.edges.ends[edge].map(local), parts.sharp.edges[edge]));
                }
            }
        }
        for &index in &faces {
            corners.extend(cage.face(index as usize).iter().map(|v| local(*v)));
            ends.push(corners.len() as u32);
        }
        // An edge is listed by each of its faces.
        creases.sort_by_key(|(ends, _)| *ends);
        creases.dedup_by_key(|(ends, _)| *ends);
        let mut sharp_vertices: Vec<_> = sharp_vertices.into_iter().map(|(v, s)| (local(v), s)).collect();
        sharp_vertices.sort_by_key(|(vertex, _)| *vertex);
        let positions = vertices.iter().map(|v| cage.positions[*v as usize]).collect();
        let cage = Cage {
            positions,
            sizes: FaceSizes::from_ends(ends),
            corners,
            scheme: cage.scheme,
            boundary: Boundary::EdgeOnly,
            creasing: cage.creasing,
            creases,
            sharp_vertices,
            holes: Vec::new(),
            is_refined: true,
            texcoords: None,
        };
        Self { cage, classes, off: 0.0 }
    }

    /// The rings of the parts of its face, one for each corner. Those of a quad start at its lower left, like
    /// the quad itself, so that all have their sides in the same directions; those of another face start at
    /// its corner. For Loop's scheme they also have the sides in the directions of the triangle; the last one
    /// is the central part, rotated by half a turn.
    pub(crate) fn subdivided(&self) -> Result<Vec<Self>, InvalidCage> {
        let before = self.topology();
        let refined = self.cage.refined_by(&before.edges, &before.incidence, &before.sharp)?;
        let classes = self.classes_after(&before.edges);
        let parts = CageTopology::with_edges(&refined, edges_with_classes(&refined, &classes));
        let n = self.n_corners();
        // A mean of k points in a row is off by k roundings, weights included; means do not increase earlier
        // errors.
        let longest =
            (0..n).map(|k| parts.incidence.edges(self.cage.corners[k] as usize).len()).fold(0, usize::max);
        let round = (4 * longest + 4 * n + 16) as f64 * f64::EPSILON * self.size();
        let is_loop = self.cage.scheme == Scheme::Loop;
        let n_parts = if is_loop { 4 } else { n };
        // A part has the vertex of the cage as its first corner; turned back, all parts have their
        // sides in the directions of the whole.
        let turn = |part: usize| match (is_loop, n) {
            (true, _) => [0, 2, 1, 1][part],
            (_, 4) => (4 - part) % 4,
            _ => 0,
        };
        let part = |part: usize| Self {
            off: self.off + round,
            ..Self::rotated(&refined, &classes, &parts, part, turn(part))
        };
        Ok((0..n_parts).map(part).collect())
    }

    /// The identity of edges after a round of Loop's scheme: halves by their edge, edges inside triangles by
    /// their corner.
    fn classes_after(&self, edges: &CageEdges) -> Vec<u32> {
        if self.cage.scheme != Scheme::Loop {
            return Vec::new();
        }
        let mut classes = Vec::with_capacity(4 * self.cage.corners.len());
        for (face, vertices) in self.cage.faces().enumerate() {
            //         2
            //        / \
            //       *---*        inside(k) cuts off corner k. The central triangle comes last and starts in
            //      / \ / \       the middle of the side from 0 to 1, so its first side cuts off corner 1.
            //     0---*---1
            let inside = |k: usize| (2 * edges.ends.len() + 3 * face + k) as u32;
            let half = |k: usize, vertex: u32| {
                let edge = edges.of_corner[3 * face + k];
                2 * edge + u32::from(edges.ends[edge as usize][0] != vertex)
            };
            for (k, vertex) in vertices.iter().enumerate() {
                classes.extend([half(k, *vertex), inside(k), half((k + 2) % 3, *vertex)]);
            }
            classes.extend([inside(1), inside(2), inside(0)]);
        }
        classes
    }

    /// The number of corners of its face.
    pub(crate) fn n_corners(&self) -> usize {
        self.cage.sizes.range(0).end
    }

    pub(super) fn cage(&self) -> &Cage {
        &self.cage
    }

    /// Points whose convex hull contains the entire limit surface of the face.
    pub(crate) fn hull(&self) -> &[CagePoint] {
        &self.cage.positions
    }

    /// The largest coordinate.
    pub(crate) fn size(&self) -> f64 {
        let larger = |most: f64, x: &f64| greater(x.abs(), most);
        self.cage.positions.as_flattened().iter().fold(0.0, larger)
    }

    /// The largest rounding error of each coordinate.
    pub(crate) fn rounding(&self) -> f64 {
        self.off
    }
}

fn edges_with_classes(cage: &Cage, classes: &[u32]) -> CageEdges {
    if classes.is_empty() {
        CageEdges::new(cage)
    } else {
        CageEdges::with_classes(cage, |corner| classes[corner as usize])
    }
}

/// The faces around a vertex that shape a given face, and the sharpness of the vertex for them.
struct CreaseSector {
    faces: Vec<u32>,
    sharpness: f64,
}

impl CreaseSector {
    fn new(parts: &CageTopology, creasing: CreasingMethod, vertex: u32, face: u32) -> Self {
        let vertex_sharpness = parts.sharp.vertices[vertex as usize];
        let around = parts.incidence.edges(vertex as usize);
        let sharpness = |edge: u32| parts.sharp.edges[edge as usize];
        let n_infinite = around.iter().filter(|edge| sharpness(**edge) >= INFINITELY_SHARP).count();
        let all_faces = || parts.incidence.faces(vertex as usize).to_vec();
        if n_infinite == 0 {
            return Self { faces: all_faces(), sharpness: vertex_sharpness };
        }
        // The faces that are reached around the vertex without crossing a line that stays sharp.
        // The list is also the queue.
        let mut faces = vec![face];
        let mut next = 0;
        while next < faces.len() {
            let current = faces[next];
            next += 1;
            for &edge in around.iter().filter(|edge| sharpness(**edge) < INFINITELY_SHARP) {
                let on = parts.edges.faces(edge as usize);
                if on.contains(&current) {
                    for other in on {
                        if !faces.contains(other) {
                            faces.push(*other);
                        }
                    }
                }
            }
        }
        let is_beyond = |edge: &u32| parts.edges.faces(*edge as usize).iter().all(|f| !faces.contains(f));
        let is_corner = vertex_sharpness >= INFINITELY_SHARP || n_infinite > 2;
        let shapes = |sharpness: f64| match creasing {
            // By Chaikin's rule, creases beyond a cut affect how those on this side end.
            CreasingMethod::Chaikin if is_corner => sharpness > 0.0 && sharpness < INFINITELY_SHARP,
            _ if is_corner => false,
            // A crease that ends at the vertex makes it a corner for some rounds; one that does not end is
            // the vertex's own.
            _ => sharpness > 0.0,
        };
        let is_shaped = around.iter().any(|edge| is_beyond(edge) && shapes(sharpness(*edge)));
        Self {
            faces: if is_shaped { all_faces() } else { faces },
            sharpness: if is_corner { INFINITELY_SHARP } else { vertex_sharpness },
        }
    }

    /// The faces around the other ends of the vertex's creases: by Chaikin's rule the sharpness there affects
    /// how these end.
    fn faces_at_far_ends(&self, parts: &CageTopology, vertex: u32) -> Vec<u32> {
        let is_crease = |edge: &&u32| {
            let sharpness = parts.sharp.edges[**edge as usize];
            let is_near = || parts.edges.faces(**edge as usize).iter().any(|face| self.faces.contains(face));
            sharpness > 0.0 && sharpness < INFINITELY_SHARP && is_near()
        };
        let creases = parts.incidence.edges(vertex as usize).iter().filter(is_crease);
        let far_ends = creases.map(move |edge| {
            let [a, b] = parts.edges.ends[*edge as usize];
            if a == vertex { b } else { a }
        });
        far_ends.flat_map(|end| parts.incidence.faces(end as usize).iter().copied()).collect()
    }
}
