//! Rounds over quads as grids: after the first round each face is a quad, and later rounds turn each into a
//! grid. All sharp or irregular points lie on the borders of grids, so the interior needs no lookups.
use super::creases::{EdgeStencil, StencilTable};
use super::quads::{NONE, QuadTopology};
use super::rows::{GridBorders, LineStencil, between, divide, moved, spread};
use super::values::{Real, WideSum, add, chunks, scaled};
use crate::budget::{Job, par_map_owned};
use crate::math::simd::{Kernel, dispatch, isa};

/// Points per task, approximately. Chosen: enough to outweigh the start of a task, few enough for an even
/// load.
const TASK: usize = 1 << 14;

/// The values at the points of grids: vertices, n − 1 points along each edge, (n − 1)² inside each quad.
pub(super) struct QuadGridLevel<'a, T, const K: usize> {
    pub quads: &'a QuadTopology,
    /// The number of parts of an edge.
    pub n: usize,
    pub values: &'a [[T; K]],
}

/// The number of points.
pub(super) fn n_points(quads: &QuadTopology, n: usize) -> usize {
    quads.n_vertices + quads.ends.len() * (n - 1) + quads.edges.len() * (n - 1) * (n - 1)
}

impl<T: Real, const K: usize> QuadGridLevel<'_, T, K> {
    #[inline(always)]
    fn vertex(&self, vertex: u32) -> [T; K] {
        self.values[vertex as usize]
    }

    /// The points along an edge, without its ends.
    #[inline(always)]
    fn along(&self, edge: u32) -> &[[T; K]] {
        &self.values[self.quads.n_vertices + edge as usize * (self.n - 1)..][..self.n - 1]
    }

    /// The points inside a quad.
    #[inline(always)]
    fn inside(&self, quad: usize) -> &[[T; K]] {
        let n = self.n - 1;
        &self.values[self.quads.n_vertices + self.quads.ends.len() * n + quad * n * n..][..n * n]
    }

    /// A point of an edge.
    #[inline(always)]
    fn on_edge(&self, edge: u32, part: usize) -> [T; K] {
        let ends = self.quads.ends[edge as usize];
        match part {
            0 => self.vertex(ends[0]),
            _ if part == self.n => self.vertex(ends[1]),
            _ => self.along(edge)[part - 1],
        }
    }

    /// The point of an edge next to one of its ends.
    #[inline(always)]
    fn next_to(&self, vertex: usize, edge: u32) -> [T; K] {
        let begins = self.quads.ends[edge as usize][0] as usize == vertex;
        self.on_edge(edge, if begins { 1 } else { self.n - 1 })
    }

    /// The point of a grid diagonally next to a corner.
    #[inline(always)]
    fn diagonal(&self, corner: u32) -> [T; K] {
        let (quad, k) = (corner as usize / 4, corner as usize % 4);
        let last = self.n.wrapping_sub(2);
        match self.n {
            1 => self.vertex(self.quads.corners[quad][(k + 2) % 4]),
            _ => {
                let (row, column) = ([0, 0, last, last][k], [0, last, last, 0][k]);
                self.inside(quad)[row * (self.n - 1) + column]
            }
        }
    }

    /// All points of an edge, including its ends.
    fn whole(&self, edge: u32, out: &mut Vec<[T; K]>) {
        let ends = self.quads.ends[edge as usize];
        out.clear();
        out.push(self.vertex(ends[0]));
        out.extend_from_slice(self.along(edge));
        out.push(self.vertex(ends[1]));
    }

    /// The row of a grid next to one of its sides, in the direction of the edge: its ends, and the other
    /// points, gathered if it is a column.
    #[inline(always)]
    fn beside<'b>(&'b self, side: u32, gathered: &'b mut Vec<[T; K]>) -> ([[T; K]; 2], &'b [[T; K]]) {
        //           edges[2]
        //         ┌──────────┐
        //  edges  │  inside  │  edges     inside: (n − 1)² points, row by row from edges[0] to edges[2];
        //   [3]   │          │   [1]      rows run from edges[3] to edges[1]
        //         └──────────┘
        //           edges[0]
        let (quad, k, n) = (side as usize / 4, side as usize % 4, self.n);
        let edges = self.quads.edges[quad];
        // The edges that contain its ends, and the positions on them.
        let (from, to) = if k % 2 == 0 { (edges[3], edges[1]) } else { (edges[0], edges[2]) };
        let part = if k == 0 || k == 3 { 1 } else { n - 1 };
        let ends = [self.on_edge(from, part), self.on_edge(to, part)];
        let inside = self.inside(quad);
        if n == 1 {
            return (ends, &[]);
        }
        let inner = match k {
            0 => &inside[..n - 1],
            2 => &inside[(n - 2) * (n - 1)..],
            _ => {
                let start = if k == 1 { n - 2 } else { 0 };
                gathered.clear();
                gathered.extend(inside[start..].iter().step_by(n - 1));
                gathered
            }
        };
        (ends, inner)
    }

    /// The points after a round, with twice as many parts along each edge.
    pub fn divide(&self, rules: &StencilTable, weights: LineStencil<T>, job: &Job, out: &mut [[T; K]]) {
        let (vertices, edges_and_faces) = out.split_at_mut(self.quads.n_vertices);
        let wide = 2 * self.n - 1;
        let (along, inside) = edges_and_faces.split_at_mut(self.quads.ends.len() * wide);
        let few = TASK.div_ceil(wide);
        // Bilinear: existing points do not move.
        if weights[1] == T::default() {
            vertices.copy_from_slice(&self.values[..vertices.len()]);
        } else {
            par_map_owned(job, chunks(vertices, TASK / 4), |(first, out)| self.vertices(rules, first, out));
        }
        par_map_owned(job, chunks(along, few * wide), |(first, out)| {
            dispatch(isa(), GridEdgeKernel { level: self, rules, weights, first: first / wide, out });
        });
        let few = TASK.div_ceil(wide * wide);
        par_map_owned(job, chunks(inside, few * wide * wide), |(first, out)| {
            dispatch(isa(), GridFaceKernel { level: self, weights, first: first / (wide * wide), out });
        });
    }

    fn vertices(&self, rules: &StencilTable, first: usize, out: &mut [[T; K]]) {
        let listed = &rules.vertices;
        // Rules for other than smooth vertices are listed in the order of the vertices; a task
        // joins the list at its first vertex.
        let mut special = listed[listed.partition_point(|(v, _)| (*v as usize) < first)..].iter().peekable();
        for (k, out) in out.iter_mut().enumerate() {
            let vertex = first + k;
            *out = match special.next_if(|(v, _)| *v as usize == vertex) {
                None => self.smooth(vertex),
                Some((_, shares)) => shares.apply(
                    self.values[vertex],
                    |edge| self.next_to(vertex, edge),
                    || self.smooth(vertex),
                ),
            };
        }
    }

    /// The smooth rule for a vertex surrounded by quads: for n corners, 1 − 7/(4n) of itself, 3/(2n²) of the
    /// next points on its edges and 1/(4n²) of the diagonal points. Each edge belongs to two corners.
    fn smooth(&self, vertex: usize) -> [T; K] {
        let around = self.quads.corners_at(vertex);
        let (mut edges, mut across) = (WideSum::ZERO, WideSum::ZERO);
        for corner in around {
            let [edge, _] = self.quads.edges_at_corner(*corner);
            edges = edges.plus(1.0, self.next_to(vertex, edge));
            across = across.plus(1.0, self.diagonal(*corner));
        }
        let n = around.len() as f64;
        let sum = WideSum::ZERO.plus(1.0 - 1.75 / n, self.values[vertex]);
        sum.plus(1.5 / (n * n), edges.0).plus(0.25 / (n * n), across.0).value()
    }
}

/// Kernel for the points along a range of edges.
struct GridEdgeKernel<'a, T, const K: usize> {
    level: &'a QuadGridLevel<'a, T, K>,
    rules: &'a StencilTable,
    weights: LineStencil<T>,
    first: usize,
    out: &'a mut [[T; K]],
}

impl<T: Real, const K: usize> Kernel for GridEdgeKernel<'_, T, K> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { level, rules, weights, first, out } = self;
        let wide = 2 * level.n - 1;
        let (mut row, mut gathered) = (Vec::new(), [Vec::new(), Vec::new()]);
        let mut line = vec![[T::default(); K]; level.n + 1];
        let mut smooth = vec![[T::default(); K]; wide];
        // Rules are listed by edge, so one pass over both finds the rule of each edge.
        let listed = &rules.edges;
        let mut special = listed[listed.partition_point(|(e, _)| (*e as usize) < first)..].iter().peekable();
        for (k, out) in out.chunks_exact_mut(wide).enumerate() {
            let edge = first + k;
            let along = special.next_if(|(e, _)| *e as usize == edge).map(|(_, along)| along);
            if along.is_some() {
                level.whole(edge as u32, &mut row);
                spread(weights, &row, out);
            }
            let sides = level.quads.sides[edge];
            // An edge without two sides is sharp along its entire length.
            if matches!(along, Some(EdgeStencil::Even { points, middles }) if *points >= 1.0 && *middles >= 1.0)
                || sides[1] == NONE
            {
                continue;
            }
            let (ends, ends_of_line) = (level.quads.ends[edge].map(|v| level.vertex(v)), [0, level.n]);
            let [first, second] = &mut gathered;
            let (a, b) = (level.beside(sides[0], first), level.beside(sides[1], second));
            for k in 0..2 {
                line[ends_of_line[k]] = moved(weights, ends[k], [a.0[k], b.0[k]]);
            }
            between(weights, level.along(edge as u32), [a.1, b.1], &mut line[1..level.n]);
            let Some(along) = along else {
                spread(weights, &line, out);
                continue;
            };
            spread(weights, &line, &mut smooth);
            for (index, (out, smooth)) in out.iter_mut().zip(&smooth).enumerate() {
                let share = match along {
                    EdgeStencil::Even { points, middles } => *(if index % 2 == 0 { middles } else { points }),
                    EdgeStencil::Each(shares) => shares[index],
                };
                *out = add(scaled(T::from_f64(share), *out), T::from_f64(1.0 - share), *smooth);
            }
        }
    }
}

/// Kernel for the points inside a range of quads.
struct GridFaceKernel<'a, T, const K: usize> {
    level: &'a QuadGridLevel<'a, T, K>,
    weights: LineStencil<T>,
    first: usize,
    out: &'a mut [[T; K]],
}

impl<T: Real, const K: usize> Kernel for GridFaceKernel<'_, T, K> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { level, weights, first, out } = self;
        let wide = 2 * level.n - 1;
        let mut line = vec![[T::default(); K]; level.n + 1];
        for (k, out) in out.chunks_exact_mut(wide * wide).enumerate() {
            let quads = level.quads;
            let sides = quads.edges[first + k].map(|edge| level.along(edge));
            let corners = quads.corners[first + k].map(|v| level.vertex(v));
            divide(weights, &GridBorders { sides, corners }, level.inside(first + k), (&mut line, out));
        }
    }
}

/// The corners of the faces of a range of quads: grid after grid, row by row.
pub(super) fn corners(quads: &QuadTopology, n: usize, (first, out): (usize, &mut [u32])) {
    // Points are numbered in this order: vertices, those along edges, those inside grids.
    let inside = quads.n_vertices + quads.ends.len() * (n - 1);
    let (mut low, mut high) = (vec![0; n + 1], vec![0; n + 1]);
    let on_edge = |edge: u32, part: usize| {
        let ends = quads.ends[edge as usize];
        match part {
            0 => ends[0],
            _ if part == n => ends[1],
            _ => (quads.n_vertices + edge as usize * (n - 1) + part - 1) as u32,
        }
    };
    for (k, out) in out.chunks_exact_mut(4 * n * n).enumerate() {
        let quad = first + k;
        let edges = quads.edges[quad];
        let fill = |row: usize, out: &mut [u32]| match row {
            0 => out.iter_mut().enumerate().for_each(|(c, out)| *out = on_edge(edges[0], c)),
            _ if row == n => out.iter_mut().enumerate().for_each(|(c, out)| *out = on_edge(edges[2], c)),
            _ => {
                let start = (inside + (quad * (n - 1) + row - 1) * (n - 1)) as u32;
                let (ends, between) = ([on_edge(edges[3], row), on_edge(edges[1], row)], 1..n);
                (out[0], out[n]) = (ends[0], ends[1]);
                out[between].iter_mut().zip(start..).for_each(|(out, index)| *out = index);
            }
        };
        fill(0, &mut low);
        for (row, out) in out.chunks_exact_mut(4 * n).enumerate() {
            fill(row + 1, &mut high);
            for ((out, low), high) in out.chunks_exact_mut(4).zip(low.windows(2)).zip(high.windows(2)) {
                out.copy_from_slice(&[low[0], low[1], high[1], high[0]]);
            }
            std::mem::swap(&mut low, &mut high);
        }
    }
}
