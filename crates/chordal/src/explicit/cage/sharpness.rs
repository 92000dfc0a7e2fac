//! `CageSharpness`: the sharpness of the edges and vertices of a cage.
use super::edges::{CageEdges, VertexIncidence};
use super::vertex_rule::subdivide_sharpness;
use super::{Boundary, Cage, CreasingMethod, INFINITELY_SHARP};
use crate::explicit::DisjointSets;
use crate::math::greater;

/// The sharpness of all edges and vertices, including sharpness by topology.
pub(super) struct CageSharpness {
    pub edges: Vec<f64>,
    pub vertices: Vec<f64>,
}

impl CageSharpness {
    pub fn new(cage: &Cage, edges: &CageEdges, around: &VertexIncidence) -> Self {
        let mut of_edges: Vec<f64> = (0..edges.ends.len())
            .map(|e| if edges.non_manifold[e] || edges.faces(e).len() < 2 { INFINITELY_SHARP } else { 0.0 })
            .collect();
        for ([a, b], sharp) in &cage.creases {
            if let Some(edge) = edges.between(*a, *b) {
                let sharpness = &mut of_edges[edge as usize];
                *sharpness = greater(*sharpness, *sharp);
            }
        }
        let mut of_vertices: Vec<f64> = (0..cage.positions.len())
            .map(|v| !cage.is_refined && is_corner(cage, edges, around, v))
            .map(|is_corner| if is_corner { INFINITELY_SHARP } else { 0.0 })
            .collect();
        for (vertex, sharp) in &cage.sharp_vertices {
            let sharpness = &mut of_vertices[*vertex as usize];
            *sharpness = greater(*sharpness, *sharp);
        }
        Self { edges: of_edges, vertices: of_vertices }
    }

    /// The sharpness of the half of an edge at a vertex after a round.
    pub fn subdivided(
        &self,
        creasing: CreasingMethod,
        around: &VertexIncidence,
        edge: usize,
        vertex: usize,
    ) -> f64 {
        let sharpness = around.edges(vertex).iter().map(|e| self.edges[*e as usize]);
        subdivide_sharpness(creasing, self.edges[edge], sharpness)
    }
}

/// Whether a vertex is fixed by the topology around it: a corner of the border, if the boundary rule says so,
/// or a vertex where surfaces meet only in a point or in more than one straight seam.
fn is_corner(cage: &Cage, edges: &CageEdges, around: &VertexIncidence, vertex: usize) -> bool {
    let (of_edges, of_faces) = (around.edges(vertex), around.faces(vertex));
    if of_faces.len() == 1 && of_edges.len() == 2 {
        return cage.boundary == Boundary::EdgeAndCorner;
    }
    let non_manifold = of_edges.iter().filter(|e| edges.non_manifold[**e as usize]).count();
    let border = of_edges.iter().filter(|e| edges.faces(**e as usize).len() == 1).count();
    let is_seam = non_manifold == 2 && border == 0 && of_faces.len() > of_edges.len();
    let is_many = non_manifold > 0 || n_fans(edges, around, vertex) > 1;
    is_many && !is_seam
}

/// Whether a face has no surface.
pub(super) fn is_hole(cage: &Cage, edges: &CageEdges, around: &VertexIncidence, face: usize) -> bool {
    let on_border = |v: &u32| around.edges(*v as usize).iter().any(|e| edges.faces(*e as usize).len() == 1);
    let border = cage.boundary == Boundary::None && cage.face(face).iter().any(on_border);
    border || cage.holes.binary_search(&(face as u32)).is_ok()
}

/// The number of fans around a vertex: groups of faces connected by edges at it.
pub(super) fn n_fans(edges: &CageEdges, around: &VertexIncidence, vertex: usize) -> usize {
    let faces = around.faces(vertex);
    // The faces are in ascending order.
    let index = |face: u32| faces.binary_search(&face).unwrap_or(0) as u32;
    let mut fans = DisjointSets::new(faces.len());
    for edge in around.edges(vertex) {
        for pair in edges.faces(*edge as usize).windows(2) {
            fans.union(index(pair[0]), index(pair[1]));
        }
    }
    faces.len() - fans.n_unions() as usize
}
