//! One round of refinement for any polygons and tags: the plain version, the reference for the fast ones.
use super::edges::{CageEdges, VertexIncidence};
use super::sharpness::{CageSharpness, is_hole};
use super::vertex_rule::{CagePoint, SubdivisionVertex, decrement_sharpness, edge_point, plus};
use super::{Boundary, Cage, Chart, CreasingMethod, FaceSizes, InvalidCage, MOST, Scheme};

impl Cage {
    /// The cage after one round: the same limit surface, about four times as many faces.
    ///
    /// Its vertices are the moved vertices of the cage, with the same indices; then one for each edge, in the
    /// order of the first corner; then, except for Loop, one for each face. Its faces follow those of the
    /// cage: for each corner of a face, in order, the part at that corner, which starts at the corner; for
    /// Loop the central part comes last. The border, and edges with more than two faces, are sharp by
    /// topology, without being listed as creases.
    ///
    /// *Cost.* Some hundred bytes per corner while it runs.
    ///
    /// # Errors
    /// [`InvalidCage::TooMany`] when the result would have too many corners, [`InvalidCage::NotFinite`] if
    /// coordinates overflow.
    pub fn refined(&self) -> Result<Self, InvalidCage> {
        if 4 * self.corners.len() > MOST {
            return Err(InvalidCage::TooMany { what: "corners", most: MOST });
        }
        let edges = CageEdges::new(self);
        let around = VertexIncidence::new(self, &edges);
        let sharp = CageSharpness::new(self, &edges, &around);
        self.refined_by(&edges, &around, &sharp)
    }

    /// The same with given edges, incidence and sharpness.
    pub(super) fn refined_by(
        &self,
        edges: &CageEdges,
        around: &VertexIncidence,
        sharp: &CageSharpness,
    ) -> Result<Self, InvalidCage> {
        let round = RefinementStep { cage: self, sharp, edges, incidence: around };
        let mut positions =
            Vec::with_capacity(self.positions.len() + round.edges.ends.len() + self.n_faces());
        let middles = round.face_points();
        positions.extend((0..self.positions.len()).map(|v| round.vertex_point(v, &middles)));
        positions.extend((0..round.edges.ends.len()).map(|e| round.edge_point(e, &middles)));
        if self.scheme != Scheme::Loop {
            positions.extend(middles);
        }
        if let Some(row) = positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(InvalidCage::NotFinite { row });
        }
        let (sizes, corners) = round.faces();
        let texcoords = self.texcoords.as_ref().map(|texcoords| {
            let chart = Chart::from_texcoords(self, texcoords, edges, around, sharp);
            let refined = chart.cage().refined().map_err(as_texcoord_error)?;
            let values = refined.positions.iter().map(|p| [p[0], p[1]]).collect();
            Ok(chart.texcoords(1, values, refined.corners))
        });
        Ok(Self { positions, sizes, corners, texcoords: texcoords.transpose()?, ..round.tags() })
    }

    /// The next round without positions and faces.
    pub(super) fn next_tags(
        &self,
        edges: &CageEdges,
        around: &VertexIncidence,
        sharp: &CageSharpness,
    ) -> Self {
        RefinementStep { cage: self, edges, incidence: around, sharp }.tags()
    }

    /// The next round with all positions zero.
    pub(super) fn next_topology(
        &self,
        edges: &CageEdges,
        around: &VertexIncidence,
        sharp: &CageSharpness,
    ) -> Self {
        let round = RefinementStep { cage: self, edges, incidence: around, sharp };
        let (sizes, corners) = round.faces();
        let middles = if self.scheme == Scheme::Loop { 0 } else { self.n_faces() };
        let n = self.positions.len() + edges.ends.len() + middles;
        Self { positions: vec![[0.0; 3]; n], sizes, corners, ..round.tags() }
    }
}

/// Turns an error of a chart into one of its cage.
pub(super) fn as_texcoord_error(error: InvalidCage) -> InvalidCage {
    match error {
        InvalidCage::NotFinite { row } => InvalidCage::TexcoordNotFinite { row },
        other => other,
    }
}

struct RefinementStep<'a> {
    cage: &'a Cage,
    edges: &'a CageEdges,
    incidence: &'a VertexIncidence,
    sharp: &'a CageSharpness,
}

impl RefinementStep<'_> {
    fn at(&self, vertex: u32) -> CagePoint {
        self.cage.positions[vertex as usize]
    }

    /// The centroids of the faces.
    fn face_points(&self) -> Vec<CagePoint> {
        let centre = |vertices: &[u32]| {
            let share = 1.0 / vertices.len() as f64;
            vertices.iter().map(|v| self.at(*v)).fold([0.0; 3], |sum, p| plus(sum, share, p))
        };
        self.cage.faces().map(centre).collect()
    }

    fn edge_point(&self, edge: usize, middles: &[CagePoint]) -> CagePoint {
        let [a, b] = self.edges.ends[edge].map(|v| self.at(v));
        if self.cage.scheme == Scheme::Bilinear {
            return [0, 1, 2].map(|k| 0.5 * a[k] + 0.5 * b[k]);
        }
        let faces = self.edges.faces(edge);
        let smooth = || match self.cage.scheme {
            Scheme::Loop => {
                let across = |face: u32| {
                    let vertices = self.cage.face(face as usize);
                    vertices
                        .iter()
                        .copied()
                        .find(|v| !self.edges.ends[edge].contains(v))
                        .unwrap_or(vertices[0])
                };
                // Loop: 3/8 of each end and 1/8 of each vertex across.
                let start = [0, 1, 2].map(|k| 0.375 * a[k] + 0.375 * b[k]);
                faces.iter().fold(start, |sum, face| plus(sum, 0.125, self.at(across(*face))))
            }
            _ => {
                // Catmull and Clark: the mean of both ends and of the middles of both faces.
                let start = [0, 1, 2].map(|k| 0.25 * a[k] + 0.25 * b[k]);
                faces.iter().fold(start, |sum, face| plus(sum, 0.25, middles[*face as usize]))
            }
        };
        edge_point([a, b], self.sharp.edges[edge], self.halves_of(edge), smooth)
    }

    fn vertex_point(&self, vertex: usize, middles: &[CagePoint]) -> CagePoint {
        if self.cage.scheme == Scheme::Bilinear || self.incidence.edges(vertex).is_empty() {
            return self.cage.positions[vertex];
        }
        CageVertex { round: self, vertex, middles }.vertex_point()
    }

    fn smooth_point(&self, vertex: usize, middles: &[CagePoint]) -> CagePoint {
        let (edges, faces) = (self.incidence.edges(vertex), self.incidence.faces(vertex));
        let here = self.cage.positions[vertex];
        let n = edges.len() as f64;
        if self.cage.scheme == Scheme::Loop {
            let share = loop_weight(edges.len());
            let start = here.map(|x| (1.0 - n * share) * x);
            return edges.iter().fold(start, |sum, e| plus(sum, share, self.other_end(*e, vertex)));
        }
        // (F + 2·R + (n − 3)·v) / n, with the mean F of the points of faces and the mean R of the
        // middles of edges, which contain v as well: n − 2 of it in all.
        let share = 1.0 / (n * n);
        let start = here.map(|x| (n - 2.0) / n * x);
        let sum = edges.iter().fold(start, |sum, e| plus(sum, share, self.other_end(*e, vertex)));
        faces.iter().fold(sum, |sum, f| plus(sum, share, middles[*f as usize]))
    }

    fn other_end(&self, edge: u32, vertex: usize) -> CagePoint {
        let [a, b] = self.edges.ends[edge as usize];
        self.at(if a as usize == vertex { b } else { a })
    }

    /// The sharpness of the half of an edge at a vertex after the round.
    fn half_sharpness(&self, edge: usize, vertex: usize) -> f64 {
        let sharpness = self.sharp.edges[edge];
        if sharpness > 0.0 {
            CageVertex { round: self, vertex, middles: &[] }.subdivided_sharpness(sharpness)
        } else {
            0.0
        }
    }

    fn halves_of(&self, edge: usize) -> [f64; 2] {
        self.edges.ends[edge].map(|v| self.half_sharpness(edge, v as usize))
    }

    /// The sizes of faces, and their corners.
    fn faces(&self) -> (FaceSizes, Vec<u32>) {
        let (n_vertices, n_edges) = (self.cage.positions.len() as u32, self.edges.ends.len() as u32);
        let is_loop = self.cage.scheme == Scheme::Loop;
        let size = if is_loop { 3 } else { 4 };
        let mut corners = Vec::with_capacity(4 * self.cage.corners.len());
        let mut first = 0;
        for (f, vertices) in self.cage.faces().enumerate() {
            let n = vertices.len();
            let edge = |k: usize| n_vertices + self.edges.of_corner[first + k % n];
            for (k, vertex) in vertices.iter().enumerate() {
                let (next, last) = (edge(k), edge(k + n - 1));
                if is_loop {
                    corners.extend([*vertex, next, last]);
                } else {
                    corners.extend([*vertex, next, n_vertices + n_edges + f as u32, last]);
                }
            }
            if is_loop {
                corners.extend([edge(0), edge(1), edge(2)]);
            }
            first += n;
        }
        (FaceSizes::uniform(size, corners.len() / size), corners)
    }

    /// All except positions and faces.
    fn tags(&self) -> Cage {
        let cage = self.cage;
        Cage {
            positions: Vec::new(),
            sizes: FaceSizes::default(),
            corners: Vec::new(),
            holes: self.holes(),
            creases: self.creases(),
            sharp_vertices: self.sharp_vertices(),
            // Faces without surface are listed as holes from now on.
            boundary: if cage.boundary == Boundary::None { Boundary::EdgeOnly } else { cage.boundary },
            is_refined: true,
            texcoords: None,
            ..*cage
        }
    }

    /// The parts of faces without surface.
    fn holes(&self) -> Vec<u32> {
        let mut holes = Vec::new();
        let mut first = 0;
        for (f, vertices) in self.cage.faces().enumerate() {
            let n = if self.cage.scheme == Scheme::Loop { 4 } else { vertices.len() as u32 };
            if is_hole(self.cage, self.edges, self.incidence, f) {
                holes.extend(first..first + n);
            }
            first += n;
        }
        holes
    }

    /// The halves of creases, each at its vertex.
    fn creases(&self) -> Vec<([u32; 2], f64)> {
        let n_vertices = self.cage.positions.len() as u32;
        let mut creases = Vec::new();
        for ([a, b], _) in &self.cage.creases {
            let Some(edge) = self.edges.between(*a, *b) else { continue };
            let halves = self.halves_of(edge as usize);
            for (vertex, sharp) in self.edges.ends[edge as usize].into_iter().zip(halves) {
                if sharp > 0.0 {
                    creases.push(([vertex, n_vertices + edge], sharp));
                }
            }
        }
        creases.sort_unstable_by_key(|(ends, _)| *ends);
        creases
    }

    fn sharp_vertices(&self) -> Vec<(u32, f64)> {
        let vertices =
            self.sharp.vertices.iter().enumerate().map(|(v, sharp)| (v as u32, decrement_sharpness(*sharp)));
        vertices.filter(|(_, sharp)| *sharp > 0.0).collect()
    }
}

/// The weight of each of `n` neighbours in a vertex of Loop's scheme.
pub(super) fn loop_weight(n: usize) -> f64 {
    let n = n as f64;
    let turn = 0.375 + 0.25 * crate::math::elementary::cos(std::f64::consts::TAU / n);
    (0.625 - turn * turn) / n
}

/// A vertex in a round.
struct CageVertex<'a> {
    round: &'a RefinementStep<'a>,
    vertex: usize,
    /// The centroids of all faces.
    middles: &'a [CagePoint],
}

impl SubdivisionVertex for CageVertex<'_> {
    fn position(&self) -> CagePoint {
        self.round.cage.positions[self.vertex]
    }

    fn sharpness(&self) -> f64 {
        self.round.sharp.vertices[self.vertex]
    }

    fn edges(&self) -> impl Iterator<Item = (u32, f64)> + Clone {
        self.round.incidence.edges(self.vertex).iter().map(|e| (*e, self.round.sharp.edges[*e as usize]))
    }

    fn other_end(&self, edge: u32) -> CagePoint {
        self.round.other_end(edge, self.vertex)
    }

    fn smooth(&self) -> CagePoint {
        self.round.smooth_point(self.vertex, self.middles)
    }

    fn creasing(&self) -> CreasingMethod {
        self.round.cage.creasing
    }
}
