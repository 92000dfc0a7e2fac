//! One precomputed round of Catmull–Clark or bilinear refinement over any polygons: stencil weights that do
//! not depend on the values at the vertices.
use super::edges::{CageEdges, VertexIncidence};
use super::sharpness::CageSharpness;
use super::values::{Real, WideSum, add, chunks, mid, scaled};
use super::vertex_rule::{RuleBlend, VertexRule, crease_weight};
use super::{Cage, FaceSizes, Scheme};
use crate::budget::{Job, par_map_owned};

/// Vertices, edges or faces per task. Chosen: enough to outweigh the start of a task.
const TASK: usize = 4096;

/// The weights of the three rules in the new point of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StencilWeights {
    pub corner: f64,
    pub crease: f64,
    pub smooth: f64,
    /// The two edges of the crease.
    pub edges: [u32; 2],
}

impl StencilWeights {
    pub const CORNER: Self = Self { corner: 1.0, crease: 0.0, smooth: 0.0, edges: [0; 2] };

    pub fn from_blend(mix: RuleBlend) -> Self {
        let mut shares = Self::default();
        for (share, rule) in [mix.share, 1.0 - mix.share].into_iter().zip(mix.rules) {
            match rule {
                VertexRule::Corner => shares.corner += share,
                VertexRule::Smooth => shares.smooth += share,
                VertexRule::Crease(edges) => {
                    shares.crease += share;
                    shares.edges = edges;
                }
            }
        }
        shares
    }
}

impl StencilWeights {
    /// The new point of a vertex, from its position, the next points along its edges and the point of the
    /// smooth rule.
    #[inline(always)]
    pub fn apply<T: Real, const K: usize>(
        &self,
        here: [T; K],
        next_to: impl Fn(u32) -> [T; K],
        smooth: impl FnOnce() -> [T; K],
    ) -> [T; K] {
        let mut sum = scaled(T::from_f64(self.corner + 0.75 * self.crease), here);
        if self.crease > 0.0 {
            let share = T::from_f64(0.125 * self.crease);
            for edge in self.edges {
                sum = add(sum, share, next_to(edge));
            }
        }
        if self.smooth > 0.0 { add(sum, T::from_f64(self.smooth), smooth()) } else { sum }
    }
}

/// The topology of a round and its weights.
#[derive(Clone, Debug)]
pub(super) struct RefinementStencils {
    n_vertices: usize,
    edges: CageEdges,
    incidence: VertexIncidence,
    /// The vertex of each corner, and the size of each face.
    corners: Vec<u32>,
    sizes: FaceSizes,
    /// Vertices that do not follow only the smooth rule, in ascending order.
    special: Vec<(u32, StencilWeights)>,
    /// Edges that do not, with the weight of their midpoint.
    creased: Vec<(u32, f64)>,
}

impl RefinementStencils {
    pub fn new(cage: &Cage, edges: CageEdges, around: VertexIncidence, sharp: &CageSharpness) -> Self {
        let is_bilinear = cage.scheme == Scheme::Bilinear;
        let mut special = Vec::new();
        for v in 0..cage.positions.len() {
            let sharp_edges = around.edges(v).iter().map(|e| (*e, sharp.edges[*e as usize]));
            // Bilinear points and those without edges stay where they are.
            if sharp_edges.len() == 0 || is_bilinear {
                special.push((v as u32, StencilWeights::CORNER));
            } else if sharp.vertices[v] > 0.0 || sharp_edges.clone().any(|(_, sharp)| sharp > 0.0) {
                let shares =
                    StencilWeights::from_blend(RuleBlend::new(cage.creasing, sharp.vertices[v], sharp_edges));
                if shares.smooth < 1.0 {
                    special.push((v as u32, shares));
                }
            }
        }
        let mut creased = Vec::new();
        for e in 0..edges.ends.len() {
            if sharp.edges[e] > 0.0 || is_bilinear {
                let halves = edges.ends[e].map(|v| sharp.subdivided(cage.creasing, &around, e, v as usize));
                creased
                    .push((e as u32, if is_bilinear { 1.0 } else { crease_weight(sharp.edges[e], halves) }));
            }
        }
        Self {
            n_vertices: cage.positions.len(),
            edges,
            incidence: around,
            corners: cage.corners.clone(),
            sizes: cage.sizes.clone(),
            special,
            creased,
        }
    }

    pub fn n_before(&self) -> usize {
        self.n_vertices
    }

    pub fn n_after(&self) -> usize {
        self.n_vertices + self.edges.ends.len() + self.sizes.len()
    }

    /// The values after the round: for vertices, edges and faces.
    pub fn apply<T: Real, const K: usize>(&self, values: &[[T; K]], job: &Job, out: &mut [[T; K]]) {
        let (vertices, edges_and_middles) = out.split_at_mut(self.n_vertices);
        let (edges, middles) = edges_and_middles.split_at_mut(self.edges.ends.len());
        par_map_owned(job, chunks(middles, TASK), |(first, out)| {
            out.iter_mut().enumerate().for_each(|(k, out)| *out = self.middle(values, first + k));
        });
        let middles = &*middles;
        par_map_owned(job, chunks(edges, TASK), |(first, out)| self.edges(values, middles, (first, out)));
        par_map_owned(job, chunks(vertices, TASK), |(first, out)| {
            self.vertices(values, middles, (first, out));
        });
    }

    fn face(&self, face: usize) -> &[u32] {
        &self.corners[self.sizes.range(face)]
    }

    fn middle<T: Real, const K: usize>(&self, values: &[[T; K]], face: usize) -> [T; K] {
        let vertices = self.face(face);
        let share = 1.0 / vertices.len() as f64;
        vertices.iter().fold(WideSum::ZERO, |sum, v| sum.plus(share, values[*v as usize])).value()
    }

    fn edges<T: Real, const K: usize>(
        &self,
        values: &[[T; K]],
        middles: &[[T; K]],
        (first, out): (usize, &mut [[T; K]]),
    ) {
        let start = self.creased.partition_point(|(e, _)| (*e as usize) < first);
        let mut creased = self.creased[start..].iter().peekable();
        for (k, out) in out.iter_mut().enumerate() {
            let edge = first + k;
            let [a, b] = self.edges.ends[edge].map(|v| values[v as usize]);
            let share = creased.next_if(|(e, _)| *e as usize == edge).map_or(0.0, |(_, share)| *share);
            let middle = mid(a, b);
            if share >= 1.0 {
                *out = middle;
                continue;
            }
            let start = scaled(T::from_f64(0.5), middle);
            let faces = self.edges.faces(edge).iter();
            let smooth = faces.fold(start, |sum, face| add(sum, T::from_f64(0.25), middles[*face as usize]));
            *out = add(scaled(T::from_f64(share), middle), T::from_f64(1.0 - share), smooth);
        }
    }

    fn vertices<T: Real, const K: usize>(
        &self,
        values: &[[T; K]],
        middles: &[[T; K]],
        (first, out): (usize, &mut [[T; K]]),
    ) {
        let start = self.special.partition_point(|(v, _)| (*v as usize) < first);
        let mut special = self.special[start..].iter().peekable();
        for (k, out) in out.iter_mut().enumerate() {
            let vertex = first + k;
            *out = match special.next_if(|(v, _)| *v as usize == vertex) {
                None => self.smooth(values, middles, vertex),
                Some((_, shares)) => shares.apply(
                    values[vertex],
                    |edge| self.other_end(values, edge, vertex),
                    || self.smooth(values, middles, vertex),
                ),
            };
        }
    }

    fn other_end<T: Real, const K: usize>(&self, values: &[[T; K]], edge: u32, vertex: usize) -> [T; K] {
        let [a, b] = self.edges.ends[edge as usize];
        values[if a as usize == vertex { b } else { a } as usize]
    }

    fn smooth<T: Real, const K: usize>(
        &self,
        values: &[[T; K]],
        middles: &[[T; K]],
        vertex: usize,
    ) -> [T; K] {
        let edges = self.incidence.edges(vertex);
        let n = edges.len() as f64;
        let (vertex_share, share) = ((n - 2.0) / n, 1.0 / (n * n));
        let ends = edges.iter().map(|e| self.other_end(values, *e, vertex));
        let sum = ends.fold(WideSum::ZERO.plus(vertex_share, values[vertex]), |sum, p| sum.plus(share, p));
        let faces = self.incidence.faces(vertex).iter();
        faces.fold(sum, |sum, face| sum.plus(share, middles[*face as usize])).value()
    }
}
