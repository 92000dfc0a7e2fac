//! Sharpness over the rounds on grids: the rules of points and their weights, which do not depend on
//! positions.
use super::edges::{csr_lists, csr_row};
use super::quads::NONE;
use super::stencils::StencilWeights;
use super::vertex_rule::{RuleBlend, crease_weight, decrement_sharpness, subdivide_sharpness};
use super::{CreasingMethod, INFINITELY_SHARP};
use std::collections::BTreeMap;

/// The weights of one round.
#[derive(Clone, Debug, Default)]
pub(super) struct StencilTable {
    /// Vertices that do not follow only the smooth rule, in ascending order.
    pub vertices: Vec<(u32, StencilWeights)>,
    /// Edges with a point that does not, in ascending order.
    pub edges: Vec<(u32, EdgeStencil)>,
}

/// The weights of the crease rule for the new points along an edge.
#[derive(Clone, Debug)]
pub(super) enum EdgeStencil {
    /// One weight for points between parts, and one for midpoints of parts.
    Even { points: f64, middles: f64 },
    /// One weight per point, a midpoint first.
    Each(Vec<f64>),
}

/// The sharpness of the parts of an edge.
enum EdgeSharpness {
    Even(f64),
    Each(Vec<f64>),
}

impl EdgeSharpness {
    fn at(&self, part: usize) -> f64 {
        match self {
            Self::Even(sharp) => *sharp,
            Self::Each(parts) => parts[part],
        }
    }
}

/// The sharpness of all edges and vertices at some round.
pub(super) struct GridSharpness<'a> {
    /// The ends of the edges of the first round or, for Loop, of the cage.
    ends: &'a [[u32; 2]],
    creasing: CreasingMethod,
    /// The number of parts of an edge.
    n: usize,
    edges: BTreeMap<u32, EdgeSharpness>,
    vertices: BTreeMap<u32, f64>,
    /// Vertices that have no face, lie on sharp edges or are sharp, ascending; and the edges of each.
    special: Vec<u32>,
    vertex_edge_ends: Vec<u32>,
    vertex_edges: Vec<u32>,
}

impl<'a> GridSharpness<'a> {
    /// From the edges and vertices with a sharpness above 0, the number of all vertices and the ends of all
    /// edges.
    pub fn new(
        creasing: CreasingMethod,
        (n_vertices, all_ends): (usize, &'a [[u32; 2]]),
        edges: &[(u32, f64)],
        vertices: &[(u32, f64)],
    ) -> Self {
        let ends = edges.iter().flat_map(|(e, _)| all_ends[*e as usize]);
        let mut is_bare = vec![true; n_vertices];
        all_ends.iter().flatten().for_each(|v| is_bare[*v as usize] = false);
        // A vertex without edges stays where it is, which is a rule of its own.
        let bare = (0..n_vertices as u32).filter(|v| is_bare[*v as usize]);
        let mut special: Vec<u32> = ends.chain(vertices.iter().map(|(v, _)| *v)).chain(bare).collect();
        special.sort_unstable();
        special.dedup();
        let mut indices = vec![NONE; n_vertices];
        special.iter().enumerate().for_each(|(index, v)| indices[*v as usize] = index as u32);
        let at_ends = all_ends.iter().enumerate().flat_map(|(e, ends)| ends.map(|v| (v, e as u32)));
        let indices = at_ends.map(|(v, e)| (indices[v as usize], e)).filter(|(index, _)| *index != NONE);
        let (around_ends, around) = csr_lists(special.len(), indices);
        Self {
            ends: all_ends,
            creasing,
            n: 1,
            edges: edges.iter().map(|(e, sharp)| (*e, EdgeSharpness::Even(*sharp))).collect(),
            vertices: vertices.iter().copied().collect(),
            special,
            vertex_edge_ends: around_ends,
            vertex_edges: around,
        }
    }

    /// The edges of the special vertex with this index, with the sharpness of their parts next to it.
    fn edges_around(&self, index: usize) -> impl Iterator<Item = (u32, f64)> + Clone {
        let vertex = self.special[index];
        csr_row(&self.vertex_edge_ends, &self.vertex_edges, index).iter().map(move |e| {
            let at = if self.ends[*e as usize][0] == vertex { 0 } else { self.n - 1 };
            (*e, self.edges.get(e).map_or(0.0, |parts| parts.at(at)))
        })
    }

    /// Returns the weights of the next round and lowers the sharpness to that after the round.
    pub fn next(&mut self) -> StencilTable {
        let mut rules = StencilTable::default();
        for (index, vertex) in self.special.iter().enumerate() {
            let edges = self.edges_around(index);
            let sharpness = self.vertices.get(vertex).copied().unwrap_or(0.0);
            let is_bare = csr_row(&self.vertex_edge_ends, &self.vertex_edges, index).is_empty();
            let shares = if is_bare {
                StencilWeights::CORNER
            } else {
                StencilWeights::from_blend(RuleBlend::new(self.creasing, sharpness, edges))
            };
            if shares.smooth < 1.0 {
                rules.vertices.push((*vertex, shares));
            }
        }
        let mut remaining = BTreeMap::new();
        for (edge, parts) in &self.edges {
            let (along, halves) = self.subdivide_edge(*edge, parts);
            rules.edges.push((*edge, along));
            let is_sharp = match &halves {
                EdgeSharpness::Even(sharp) => *sharp > 0.0,
                EdgeSharpness::Each(sharpness) => sharpness.iter().any(|sharp| *sharp > 0.0),
            };
            if is_sharp {
                remaining.insert(*edge, halves);
            }
        }
        // Only now: all rules of a round take the sharpness before it.
        self.edges = remaining;
        self.vertices.values_mut().for_each(|sharp| *sharp = decrement_sharpness(*sharp));
        self.vertices.retain(|_, sharp| *sharp > 0.0);
        self.n *= 2;
        rules
    }

    fn subdivide_edge(&self, edge: u32, parts: &EdgeSharpness) -> (EdgeStencil, EdgeSharpness) {
        let point = |sharp: [f64; 2]| {
            let two = [(0, sharp[0]), (1, sharp[1])];
            StencilWeights::from_blend(RuleBlend::new(self.creasing, 0.0, two.into_iter())).crease
        };
        // With uniform creasing, and for lines that never end, all parts of an edge keep one
        // sharpness; with Chaikin's rule each part depends on its neighbours.
        let is_stable = |sharp: f64| self.creasing == CreasingMethod::Uniform || sharp >= INFINITELY_SHARP;
        if let EdgeSharpness::Even(sharp) = parts
            && is_stable(*sharp)
        {
            let remaining = decrement_sharpness(*sharp);
            let along = EdgeStencil::Even {
                points: point([*sharp; 2]),
                middles: crease_weight(*sharp, [remaining; 2]),
            };
            return (along, EdgeSharpness::Even(remaining));
        }
        let half_sharpness = |part: usize, point_index: usize| {
            let sharp = parts.at(part);
            if point_index == 0 || point_index == self.n {
                let vertex = self.ends[edge as usize][point_index / self.n];
                // Both ends of an edge with a sharpness are in `special`.
                let index = self.special.binary_search(&vertex).unwrap_or(0);
                subdivide_sharpness(self.creasing, sharp, self.edges_around(index).map(|(_, sharp)| sharp))
            } else {
                subdivide_sharpness(
                    self.creasing,
                    sharp,
                    [parts.at(point_index - 1), parts.at(point_index)].into_iter(),
                )
            }
        };
        let halves: Vec<f64> = (0..self.n)
            .flat_map(|part| [half_sharpness(part, part), half_sharpness(part, part + 1)])
            .collect();
        let mut shares = Vec::with_capacity(2 * self.n - 1);
        for part in 0..self.n {
            if part > 0 {
                shares.push(point([parts.at(part - 1), parts.at(part)]));
            }
            shares.push(crease_weight(parts.at(part), [halves[2 * part], halves[2 * part + 1]]));
        }
        (EdgeStencil::Each(shares), EdgeSharpness::Each(halves))
    }

    /// The sharpness of a part of an edge.
    pub fn part_sharpness(&self, edge: u32, part: usize) -> f64 {
        self.edges.get(&edge).map_or(0.0, |parts| parts.at(part))
    }

    /// The sharp vertices, in ascending order.
    pub fn vertices(&self) -> Vec<(u32, f64)> {
        self.vertices.iter().map(|(v, sharp)| (*v, *sharp)).collect()
    }
}
