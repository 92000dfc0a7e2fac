//! Rounds of Loop's scheme over triangles as grids: all sharp or irregular points lie on their borders, as
//! for quads.
use super::creases::{EdgeStencil, StencilTable};
use super::edges::{CageEdges, VertexIncidence};
use super::refinement_step::loop_weight;
use super::values::{Real, WideSum, add, chunks, mid, scaled};
use crate::budget::{Job, par_map_owned};

/// Points per task, approximately. Chosen: enough to outweigh the start of a task, few enough for an even
/// load.
const TASK: usize = 1 << 14;

/// Marks a missing face.
const NONE: u32 = u32::MAX;

/// Triangles with their edges.
#[derive(Clone, Debug)]
pub(super) struct TriangleTopology {
    pub n_vertices: usize,
    corners: Vec<[u32; 3]>,
    /// For each corner the edge to the next one.
    edges: Vec<[u32; 3]>,
    /// The ends of each edge, the lower vertex first.
    pub ends: Vec<[u32; 2]>,
    /// The first two sides of each edge, as 3 × triangle + side.
    sides: Vec<[u32; 2]>,
    incidence: VertexIncidence,
    /// The weight of a neighbour by the number of neighbours.
    loop_weights: Vec<f64>,
}

impl TriangleTopology {
    pub fn new(corners: &[u32], n_vertices: usize, edges: CageEdges, around: VertexIncidence) -> Self {
        let mut sides = vec![[NONE; 2]; edges.ends.len()];
        for (side, edge) in edges.of_corner.iter().enumerate() {
            // Only two sides are kept; an edge with more faces is sharp.
            let edge_sides = &mut sides[*edge as usize];
            let slot = usize::from(edge_sides[0] != NONE);
            if edge_sides[slot] == NONE {
                edge_sides[slot] = side as u32;
            }
        }
        let max_valence = (0..n_vertices).map(|v| around.edges(v).len()).max().unwrap_or(0);
        Self {
            n_vertices,
            corners: corners.as_chunks().0.to_vec(),
            edges: edges.of_corner.as_chunks().0.to_vec(),
            ends: edges.ends,
            sides,
            incidence: around,
            // A single edge never follows the smooth rule; without edges no weight is needed.
            loop_weights: (0..=max_valence).map(|n| if n == 0 { 0.0 } else { loop_weight(n) }).collect(),
        }
    }

    pub fn n_faces(&self) -> usize {
        self.corners.len()
    }

    /// The number of points with n parts along an edge.
    pub fn n_points(&self, n: usize) -> usize {
        self.n_vertices + self.ends.len() * (n - 1) + self.corners.len() * n_inside(n)
    }

    /// The index of a point of a side, `part` parts from the start of the side.
    fn on_side(&self, face: usize, side: usize, n: usize, part: usize) -> usize {
        let edge = self.edges[face][side] as usize;
        let ends = self.ends[edge];
        let part = if ends[0] == self.corners[face][side] { part } else { n - part };
        match part {
            0 => ends[0] as usize,
            _ if part == n => ends[1] as usize,
            _ => self.n_vertices + edge * (n - 1) + part - 1,
        }
    }

    /// The index of a point of a grid: steps along the first side, and rows from it.
    fn index(&self, face: usize, n: usize, (column, row): (usize, usize)) -> usize {
        if row == 0 {
            self.on_side(face, 0, n, column)
        } else if column == 0 {
            self.on_side(face, 2, n, n - row)
        } else if column + row == n {
            self.on_side(face, 1, n, row)
        } else {
            // Rows of n − 2, n − 3, … points.
            let before = (row - 1) * (n - 2) - (row - 1) * row.saturating_sub(2) / 2;
            let start = self.n_vertices + self.ends.len() * (n - 1) + face * n_inside(n);
            start + before + column - 1
        }
    }

    /// The corners of the faces of a range of triangles: row by row, upright and inverted ones alternating.
    pub fn faces(&self, n: usize, (first, out): (usize, &mut [u32])) {
        let (mut low, mut high) = (vec![0; n + 1], vec![0; n + 1]);
        for (k, mut out) in out.chunks_exact_mut(3 * n * n).enumerate() {
            let fill = |row: usize, line: &mut [u32]| {
                let count = n + 1 - row;
                let mut at = |c: usize| line[c] = self.index(first + k, n, (c, row)) as u32;
                at(0);
                at(count - 1);
                if row == 0 {
                    (1..count - 1).for_each(at);
                } else if count > 2 {
                    at(1);
                    let start = line[1];
                    line[1..count - 1].iter_mut().zip(start..).for_each(|(out, index)| *out = index);
                }
            };
            fill(0, &mut low);
            for row in 0..n {
                fill(row + 1, &mut high);
                let (row_corners, remaining) = out.split_at_mut(3 * (2 * (n - row) - 1));
                //      high[c] ── high[c+1]       A row has one inverted triangle less than upright ones.
                //       ╱  ╲      ╱
                //      ╱    ╲    ╱
                //   low[c] ── low[c+1]
                for (c, out) in row_corners.chunks_mut(6).enumerate() {
                    out[..3].copy_from_slice(&[low[c], low[c + 1], high[c]]);
                    if out.len() == 6 {
                        out[3..].copy_from_slice(&[low[c + 1], high[c + 1], high[c]]);
                    }
                }
                out = remaining;
                std::mem::swap(&mut low, &mut high);
            }
        }
    }
}

/// The number of points inside a triangle with n parts along an edge.
fn n_inside(n: usize) -> usize {
    (n - 1) * n.saturating_sub(2) / 2
}

/// The values at the points: vertices, n − 1 along each edge, and the points inside each triangle, row by
/// row.
pub(super) struct TriangleGridLevel<'a, T, const K: usize> {
    pub triangles: &'a TriangleTopology,
    pub n: usize,
    pub values: &'a [[T; K]],
}

impl<T: Real, const K: usize> TriangleGridLevel<'_, T, K> {
    /// The points after a round, with twice as many parts along each edge.
    pub fn divide(&self, rules: &StencilTable, job: &Job, out: &mut [[T; K]]) {
        let (vertices, edges_and_faces) = out.split_at_mut(self.triangles.n_vertices);
        let wide = 2 * self.n - 1;
        let (along, inside) = edges_and_faces.split_at_mut(self.triangles.ends.len() * wide);
        par_map_owned(job, chunks(vertices, TASK / 4), |(first, out)| self.vertices(rules, first, out));
        par_map_owned(job, chunks(along, TASK.div_ceil(wide) * wide), |(first, out)| {
            self.edges(rules, first / wide, out);
        });
        let each = n_inside(2 * self.n);
        if each > 0 {
            par_map_owned(job, chunks(inside, TASK.div_ceil(each) * each), |(first, out)| {
                self.faces(first / each, out);
            });
        }
    }

    fn next_to(&self, vertex: usize, edge: u32) -> [T; K] {
        let ends = self.triangles.ends[edge as usize];
        let begins = ends[0] as usize == vertex;
        self.values[match self.n {
            1 => ends[usize::from(begins)] as usize,
            n => self.triangles.n_vertices + edge as usize * (n - 1) + if begins { 0 } else { n - 2 },
        }]
    }

    fn vertices(&self, rules: &StencilTable, first: usize, out: &mut [[T; K]]) {
        let listed = &rules.vertices;
        let mut special = listed[listed.partition_point(|(v, _)| (*v as usize) < first)..].iter().peekable();
        for (k, out) in out.iter_mut().enumerate() {
            let vertex = first + k;
            let here = self.values[vertex];
            *out = match special.next_if(|(v, _)| *v as usize == vertex) {
                None => self.smooth(vertex),
                Some((_, shares)) => {
                    shares.apply(here, |edge| self.next_to(vertex, edge), || self.smooth(vertex))
                }
            };
        }
    }

    fn smooth(&self, vertex: usize) -> [T; K] {
        let edges = self.triangles.incidence.edges(vertex);
        let share = self.triangles.loop_weights[edges.len()];
        let sum = edges.iter().fold(WideSum::ZERO, |sum, edge| sum.plus(1.0, self.next_to(vertex, *edge)));
        WideSum::ZERO.plus(1.0 - edges.len() as f64 * share, self.values[vertex]).plus(share, sum.0).value()
    }

    /// The points along a range of edges.
    fn edges(&self, rules: &StencilTable, first: usize, out: &mut [[T; K]]) {
        let (n, triangles) = (self.n, self.triangles);
        let listed = &rules.edges;
        let mut special = listed[listed.partition_point(|(e, _)| (*e as usize) < first)..].iter().peekable();
        let mut line = Vec::new();
        let mut beside = [Vec::new(), Vec::new()];
        for (k, out) in out.chunks_exact_mut(2 * n - 1).enumerate() {
            let edge = first + k;
            let along = special.next_if(|(e, _)| *e as usize == edge).map(|(_, along)| along);
            let ends = triangles.ends[edge].map(|v| self.values[v as usize]);
            line.clear();
            line.push(ends[0]);
            line.extend_from_slice(&self.values[triangles.n_vertices + edge * (n - 1)..][..n - 1]);
            line.push(ends[1]);
            let sides = triangles.sides[edge];
            let is_alone = sides[1] == NONE;
            if !is_alone {
                sides.into_iter().zip(&mut beside).for_each(|(side, row)| self.beside(side, row));
            }
            let [a, b] = &beside;
            for (index, out) in out.iter_mut().enumerate() {
                // Even numbers are midpoints, after old point i; odd ones are old points, which
                // move.
                let i = index / 2 + index % 2;
                // An edge without two sides is sharp along its entire length.
                let share = match along {
                    None => 0.0,
                    Some(_) if is_alone => 1.0,
                    Some(EdgeStencil::Even { middles, .. }) if index % 2 == 0 => *middles,
                    Some(EdgeStencil::Even { points, .. }) => *points,
                    Some(EdgeStencil::Each(shares)) => shares[index],
                };
                let crease = || match index % 2 {
                    0 => mid(line[i], line[i + 1]),
                    _ => add(
                        scaled(T::from_f64(0.75), line[i]),
                        T::from_f64(0.25),
                        mid(line[i - 1], line[i + 1]),
                    ),
                };
                if share >= 1.0 {
                    *out = crease();
                    continue;
                }
                let smooth = match index % 2 {
                    0 => edge_point([line[i], line[i + 1]], [a[i], b[i]]),
                    _ => vertex_point(line[i], [line[i - 1], line[i + 1], a[i - 1], a[i], b[i - 1], b[i]]),
                };
                *out = match share > 0.0 {
                    true => add(scaled(T::from_f64(share), crease()), T::from_f64(1.0 - share), smooth),
                    false => smooth,
                };
            }
        }
    }

    /// The n points next to a side, in the direction of its edge.
    fn beside(&self, side: u32, out: &mut Vec<[T; K]>) {
        let (face, k, n) = (side as usize / 3, side as usize % 3, self.n);
        let triangles = self.triangles;
        out.clear();
        // The line one row inside each side, in the direction of the side: row 1, the diagonal
        // before the last, column 1.
        out.extend((0..n).map(|part| {
            let at = match k {
                0 => (part, 1),
                1 => (n - 1 - part, part),
                _ => (1, n - 1 - part),
            };
            self.values[triangles.index(face, n, at)]
        }));
        if triangles.ends[triangles.edges[face][k] as usize][0] != triangles.corners[face][k] {
            out.reverse();
        }
    }

    /// The points inside a range of triangles.
    fn faces(&self, first: usize, out: &mut [[T; K]]) {
        let (n, triangles) = (self.n, self.triangles);
        let mut rows: [Vec<[T; K]>; 3] = [const { Vec::new() }; 3];
        for (k, mut out) in out.chunks_exact_mut(n_inside(2 * n)).enumerate() {
            let fill = |row: usize, line: &mut Vec<[T; K]>| {
                line.clear();
                let value = |column: usize| self.values[triangles.index(first + k, n, (column, row))];
                match n - row {
                    _ if row == 0 => line.extend((0..=n).map(value)),
                    0 => line.push(value(0)),
                    1 => line.extend([value(0), value(1)]),
                    last => {
                        line.push(value(0));
                        let start = triangles.index(first + k, n, (1, row));
                        line.extend_from_slice(&self.values[start..][..last - 1]);
                        line.push(value(last));
                    }
                }
            };
            let [below, low, high] = &mut rows;
            fill(0, low);
            fill(1, high);
            for y in 1..2 * n - 1 {
                let (row_points, remaining) = out.split_at_mut(2 * n - 1 - y);
                out = remaining;
                // Rows of the result: odd ones lie between two old rows, even ones on one. Three
                // old rows are enough at a time.
                if y % 2 == 0 {
                    std::mem::swap(below, low);
                    std::mem::swap(low, high);
                    fill(y / 2 + 1, high);
                    // Along the row `low`, midpoints first.
                    for (k, out) in row_points.iter_mut().enumerate() {
                        let c = k / 2 + k % 2;
                        *out = match k % 2 {
                            0 => edge_point([low[c], low[c + 1]], [high[c], below[c + 1]]),
                            _ => vertex_point(
                                low[c],
                                [low[c - 1], low[c + 1], high[c - 1], high[c], below[c], below[c + 1]],
                            ),
                        };
                    }
                } else {
                    // Between `low` and `high`.
                    for (k, out) in row_points.iter_mut().enumerate() {
                        let c = k / 2 + k % 2;
                        *out = match k % 2 {
                            0 => edge_point([low[c + 1], high[c]], [low[c], high[c + 1]]),
                            _ => edge_point([low[c], high[c]], [low[c + 1], high[c - 1]]),
                        };
                    }
                }
            }
        }
    }
}

/// The new point on an edge, from its ends and the opposite vertices.
#[inline(always)]
fn edge_point<T: Real, const K: usize>(ends: [[T; K]; 2], across: [[T; K]; 2]) -> [T; K] {
    add(scaled(T::from_f64(0.75), mid(ends[0], ends[1])), T::from_f64(0.25), mid(across[0], across[1]))
}

/// A point with six neighbours after a round.
#[inline(always)]
fn vertex_point<T: Real, const K: usize>(here: [T; K], [a, b, c, d, e, f]: [[T; K]; 6]) -> [T; K] {
    let sum = std::array::from_fn(|k| (a[k] + b[k]) + (c[k] + d[k]) + (e[k] + f[k]));
    add(scaled(T::from_f64(0.625), here), T::from_f64(0.0625), sum)
}
