//! `QuadTopology`: the quads of the first round with their edges, built directly from the cage. Each starts
//! at its vertex of the cage, so that all edges have the direction of the rows and columns of the grids on
//! both sides.
use super::Cage;
use super::edges::{CageEdges, csr_lists, csr_row};

/// Marks a missing side.
pub(super) const NONE: u32 = u32::MAX;

/// The quads of the first round. Row 0 of a grid runs from a vertex of the cage to the midpoint of an edge,
/// column 0 to the midpoint of the previous edge, and the last point of the last row is the face point.
#[derive(Clone, Debug)]
pub(super) struct QuadTopology {
    pub n_vertices: usize,
    /// The vertices of each quad, counter-clockwise from the vertex of the cage.
    pub corners: Vec<[u32; 4]>,
    /// The edges of each quad: row 0, the last column, the last row, column 0.
    pub edges: Vec<[u32; 4]>,
    /// The ends of each edge, the lower vertex first.
    pub ends: Vec<[u32; 2]>,
    /// The first two sides of each edge, as 4 × quad + side.
    pub sides: Vec<[u32; 2]>,
    /// Corners of quads at each vertex, as 4 × quad + corner.
    vertex_corner_ends: Vec<u32>,
    vertex_corners: Vec<u32>,
    /// The two halves of each edge of the cage.
    pub halves: Vec<[u32; 2]>,
}

impl QuadTopology {
    /// Edges are numbered in the order in which the quads first use them.
    pub fn new(cage: &Cage, edges: &CageEdges) -> Self {
        let (n_vertices, n_edges) = (cage.positions.len() as u32, edges.ends.len() as u32);
        let n = cage.corners.len();
        let mut quads = Self {
            n_vertices: n_vertices as usize + n_edges as usize + cage.n_faces(),
            corners: Vec::with_capacity(n),
            edges: Vec::with_capacity(n),
            ends: Vec::with_capacity(2 * n_edges as usize + n),
            sides: Vec::with_capacity(2 * n_edges as usize + n),
            vertex_corner_ends: Vec::new(),
            vertex_corners: Vec::new(),
            halves: vec![[NONE; 2]; n_edges as usize],
        };
        let mut inner = vec![NONE; n];
        let mut first = 0;
        for (face, vertices) in cage.faces().enumerate() {
            let middle = n_vertices + n_edges + face as u32;
            for (k, &vertex) in vertices.iter().enumerate() {
                let (corner, last) = (first + k, first + if k == 0 { vertices.len() } else { k } - 1);
                let (next_edge, last_edge) = (edges.of_corner[corner], edges.of_corner[last]);
                let (next, before) = (n_vertices + next_edge, n_vertices + last_edge);
                //    before ── inner[last] ── middle
                //      │                        │
                //    column              inner[corner]
                //      │                        │
                //    vertex ────── row ────── next
                let half = |edge: u32| (edge as usize, usize::from(edges.ends[edge as usize][1] == vertex));
                let ((e, i), (f, j)) = (half(next_edge), half(last_edge));
                let row = quads.number(quads.halves[e][i], [vertex, next]);
                quads.halves[e][i] = row;
                inner[corner] = quads.number(inner[corner], [next, middle]);
                inner[last] = quads.number(inner[last], [before, middle]);
                let column = quads.number(quads.halves[f][j], [vertex, before]);
                quads.halves[f][j] = column;
                let around = [row, inner[corner], inner[last], column];
                for (side, edge) in around.iter().enumerate() {
                    let edge_sides = &mut quads.sides[*edge as usize];
                    // Only two sides are kept; an edge with more faces is sharp, and asks for none.
                    let slot = usize::from(edge_sides[0] != NONE);
                    if edge_sides[slot] == NONE {
                        edge_sides[slot] = (4 * corner + side) as u32;
                    }
                }
                quads.edges.push(around);
                quads.corners.push([vertex, next, middle, before]);
            }
            first += vertices.len();
        }
        let corners = quads.corners.as_flattened().iter().enumerate().map(|(c, v)| (*v, c as u32));
        (quads.vertex_corner_ends, quads.vertex_corners) = csr_lists(quads.n_vertices, corners);
        quads
    }

    /// The number of an edge: the given one if it has been assigned, otherwise the next.
    fn number(&mut self, number: u32, ends: [u32; 2]) -> u32 {
        if number != NONE {
            return number;
        }
        self.ends.push(ends);
        self.sides.push([NONE; 2]);
        (self.ends.len() - 1) as u32
    }

    /// The corners at a vertex.
    pub fn corners_at(&self, vertex: usize) -> &[u32] {
        csr_row(&self.vertex_corner_ends, &self.vertex_corners, vertex)
    }

    /// The edges of a quad at one of its corners.
    pub fn edges_at_corner(&self, corner: u32) -> [u32; 2] {
        let edges = &self.edges[corner as usize / 4];
        let k = corner as usize % 4;
        [edges[k], edges[(k + 3) % 4]]
    }
}
