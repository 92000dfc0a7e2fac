//! Rounds over quads as grids: after the first round each face is a quad, and later rounds make a grid of each, with all that is
//! sharp or irregular on the borders of grids. So inside of a grid there is nothing to look up.
use super::edges::{Around, Edges};
use super::refine::Sharp;
use super::rules::{Point, Vertex, less, middle, plus};
use super::{Cage, Creasing, InvalidCage, MOST, Scheme};
use std::collections::BTreeMap;

impl Cage {
    /// The cage after some rounds; none gives the cage itself.
    ///
    /// The faces are the same as by [`Cage::refined`] so many times, and so are the vertices, but for rounding and the order after
    /// the second round: first the vertices of the first round, under their numbers; then for each of its edges the points along it, from its
    /// lower vertex; then for each of its faces the points inside, row by row, rows running from its first vertex to its
    /// second. Faces follow those of the first round, row by row as well. Loop's scheme repeats [`Cage::refined`].
    ///
    /// *Cost.* Per face of the result 24 bytes for positions and 20 for indices, and as much again for positions of the last round but one
    /// while it runs.
    ///
    /// # Errors
    /// As for [`Cage::refined`].
    pub fn refined_times(&self, rounds: u32) -> Result<Self, InvalidCage> {
        if rounds < 2 || self.scheme == Scheme::Loop {
            return (0..rounds).try_fold(self.clone(), |cage, _| cage.refined());
        }
        let first = self.refined()?;
        let n_corners = (1..rounds).try_fold(first.corners.len(), |n, _| n.checked_mul(4));
        if n_corners.is_none_or(|n| n > MOST) {
            return Err(InvalidCage::TooMany { what: "corners", most: MOST });
        }
        let mut grids = Grids::of(&first);
        for _ in 1..rounds {
            grids.divide();
        }
        grids.cage()
    }
}

/// Points of grids over the faces of a cage of quads.
struct Grids<'a> {
    base: &'a Cage,
    edges: Edges,
    around: Around,
    /// Parts of an edge.
    n: usize,
    vertices: Vec<Point>,
    /// For each edge the n − 1 points along it.
    along: Vec<Point>,
    /// For each face the (n − 1)² points inside of it.
    inside: Vec<Point>,
    sharp_vertices: Vec<f64>,
    /// Sharp edges, with the sharpness of each part.
    creases: BTreeMap<u32, Vec<f64>>,
}

impl<'a> Grids<'a> {
    fn of(base: &'a Cage) -> Self {
        let edges = Edges::of(base);
        let around = Around::of(base, &edges);
        let sharp = Sharp::of(base, &edges, &around);
        let creases = sharp.edges.iter().enumerate().filter(|(_, sharp)| **sharp > 0.0);
        Self {
            base,
            n: 1,
            vertices: base.positions.clone(),
            along: Vec::new(),
            inside: Vec::new(),
            creases: creases.map(|(e, sharp)| (e as u32, vec![*sharp])).collect(),
            sharp_vertices: sharp.vertices,
            edges,
            around,
        }
    }

    /// The point of an edge that is so many parts from one of its ends.
    #[inline]
    fn on_edge(&self, edge: u32, from: u32, part: usize) -> Point {
        let ends = self.edges.ends[edge as usize];
        let part = if ends[0] == from { part } else { self.n - part };
        if part == 0 {
            self.vertices[ends[0] as usize]
        } else if part == self.n {
            self.vertices[ends[1] as usize]
        } else {
            self.along[edge as usize * (self.n - 1) + part - 1]
        }
    }

    /// The edge of a side of a face, and the vertex that it begins at.
    #[inline]
    fn side(&self, face: usize, side: usize) -> (u32, u32) {
        let corner = 4 * face + side % 4;
        (self.edges.of_corner[corner], self.base.corners[corner])
    }

    /// The point of a grid in a row and a column; rows are parallel to the first side.
    #[inline]
    fn at(&self, face: usize, row: usize, column: usize) -> Point {
        let n = self.n;
        let on = |side: usize, part: usize| {
            let (edge, from) = self.side(face, side);
            self.on_edge(edge, from, part)
        };
        if row == 0 {
            on(0, column)
        } else if row == n {
            on(2, n - column)
        } else if column == 0 {
            on(3, n - row)
        } else if column == n {
            on(1, row)
        } else {
            self.inside[(face * (n - 1) + row - 1) * (n - 1) + column - 1]
        }
    }

    /// One row more inside than a side, from the side's begin to its end.
    fn beside(&self, face: usize, side: usize) -> impl Fn(usize) -> Point + '_ {
        let n = self.n;
        move |part| match side {
            0 => self.at(face, 1, part),
            1 => self.at(face, part, n - 1),
            2 => self.at(face, n - 1, n - part),
            _ => self.at(face, n - part, 1),
        }
    }

    /// A round: twice as many parts along each edge.
    fn divide(&mut self) {
        let is_bilinear = self.base.scheme == Scheme::Bilinear;
        let vertices = (0..self.vertices.len())
            .map(|v| match self.around.edges(v).is_empty() || is_bilinear {
                true => self.vertices[v],
                false => Base { grids: self, vertex: v as u32 }.moved(),
            })
            .collect();
        let mut along = Vec::with_capacity(self.edges.ends.len() * (2 * self.n - 1));
        let mut creases = BTreeMap::new();
        for edge in 0..self.edges.ends.len() {
            let sharp = self.creases.get(&(edge as u32)).map(|sharp| (sharp, self.less_sharp(edge as u32)));
            let before = sharp.as_ref().map(|(before, after)| (before.as_slice(), after.as_slice()));
            self.divide_edge(edge, before, &mut along);
            if let Some((_, after)) = sharp.filter(|(_, after)| after.iter().any(|s| *s > 0.0)) {
                creases.insert(edge as u32, after);
            }
        }
        let inside = self.divide_faces();
        self.sharp_vertices.iter_mut().for_each(|sharp| *sharp = less(*sharp));
        (self.vertices, self.along, self.inside, self.creases) = (vertices, along, inside, creases);
        self.n *= 2;
    }

    /// What is left of the sharpness of an edge on the halves of its parts.
    fn less_sharp(&self, edge: u32) -> Vec<f64> {
        let sharp = &self.creases[&edge];
        let ends = self.edges.ends[edge as usize];
        let left = |part: usize, place: usize| {
            let nothing = [0.0; 3];
            if place == 0 {
                Base { grids: self, vertex: ends[0] }.left(sharp[part])
            } else if place == self.n {
                Base { grids: self, vertex: ends[1] }.left(sharp[part])
            } else {
                let sharp = [sharp[place - 1], sharp[place]];
                let creasing = self.base.creasing;
                let line = Between { here: nothing, ends: [nothing; 2], sharp, smooth: || nothing, creasing };
                line.left(self.creases[&edge][part])
            }
        };
        (0..self.n).flat_map(|part| [left(part, part), left(part, part + 1)]).collect()
    }

    /// The points along an edge after a round, where it is sharp with the sharpness of its parts before and after.
    fn divide_edge(&self, edge: usize, sharp: Option<(&[f64], &[f64])>, out: &mut Vec<Point>) {
        let ends = self.edges.ends[edge];
        let here = |part: usize| self.on_edge(edge as u32, ends[0], part);
        let faces = self.edges.faces(edge);
        // Where it is not sharp it has two faces.
        let rows: Vec<_> = faces
            .iter()
            .map(|face| {
                let face = *face as usize;
                let side = (0..4).find(|side| self.side(face, *side).0 == edge as u32).unwrap_or(0);
                let is_along = self.side(face, side).1 == ends[0];
                let row = self.beside(face, side);
                move |part: usize| if is_along { row(part) } else { row(self.n - part) }
            })
            .collect();
        // The middle of a cell beside a part of the edge.
        let cell = |k: usize, part: usize| {
            let sum = [here(part + 1), rows[k](part), rows[k](part + 1)];
            sum.into_iter().fold(here(part).map(|x| 0.25 * x), |sum, p| plus(sum, 0.25, p))
        };
        let parts_of = |part: usize| {
            sharp.map_or((0.0, [0.0; 2]), |(before, after)| {
                (before[part], [after[2 * part], after[2 * part + 1]])
            })
        };
        for part in 0..self.n {
            if part > 0 {
                let smooth = || {
                    let mut sum = here(part).map(|x| 0.5 * x);
                    for p in [here(part - 1), here(part + 1)] {
                        sum = plus(sum, 0.0625, p);
                    }
                    for (k, row) in rows.iter().enumerate() {
                        for p in [row(part), cell(k, part - 1), cell(k, part)] {
                            sum = plus(sum, 0.0625, p);
                        }
                    }
                    sum
                };
                out.push(if self.base.scheme == Scheme::Bilinear {
                    here(part)
                } else {
                    let sharp = [parts_of(part - 1).0, parts_of(part).0];
                    let ends = [here(part - 1), here(part + 1)];
                    Between { here: here(part), ends, sharp, smooth, creasing: self.base.creasing }.moved()
                });
            }
            let (sharpness, halves) = parts_of(part);
            let two = [here(part), here(part + 1)];
            let smooth = || {
                let start = [0, 1, 2].map(|k| 0.25 * two[0][k] + 0.25 * two[1][k]);
                (0..rows.len()).fold(start, |sum, k| plus(sum, 0.25, cell(k, part)))
            };
            // Bilinear edges are as sharp as can be.
            let sharpness = if self.base.scheme == Scheme::Bilinear { 1.0 } else { sharpness };
            out.push(middle(two, sharpness, halves, smooth));
        }
    }

    /// The points inside of faces after a round.
    fn divide_faces(&self) -> Vec<Point> {
        let n = self.n;
        let wide = 2 * n - 1;
        let mut out = vec![[0.0; 3]; self.base.n_faces() * wide * wide];
        let mut grid = vec![[0.0; 3]; (n + 1) * (n + 1)];
        let mut cells = vec![[0.0; 3]; n * n];
        for (face, out) in out.chunks_exact_mut(wide * wide).enumerate() {
            for (row, points) in grid.chunks_exact_mut(n + 1).enumerate() {
                for (column, point) in points.iter_mut().enumerate() {
                    *point = self.at(face, row, column);
                }
            }
            self.divide_face(&grid, &mut cells, out);
        }
        out
    }

    fn divide_face(&self, grid: &[Point], cells: &mut [Point], out: &mut [Point]) {
        let (n, wide) = (self.n, 2 * self.n - 1);
        for (row, cells) in cells.chunks_exact_mut(n).enumerate() {
            let (low, high) = (&grid[row * (n + 1)..][..n + 1], &grid[(row + 1) * (n + 1)..][..n + 1]);
            for ((cell, low), high) in cells.iter_mut().zip(low.windows(2)).zip(high.windows(2)) {
                *cell = [0, 1, 2].map(|k| 0.25 * ((low[0][k] + low[1][k]) + (high[0][k] + high[1][k])));
            }
        }
        let is_bilinear = self.base.scheme == Scheme::Bilinear;
        let edge = |a: Point, b: Point, cells: [Point; 2]| {
            [0, 1, 2].map(|k| match is_bilinear {
                true => 0.5 * (a[k] + b[k]),
                false => 0.25 * ((a[k] + b[k]) + (cells[0][k] + cells[1][k])),
            })
        };
        let grid_at = |row: usize, column: usize| grid[row * (n + 1) + column];
        let cell_at = |row: usize, column: usize| cells[row * n + column];
        for (y, out) in out.chunks_exact_mut(wide).enumerate() {
            // Even rows lie through the middles of cells, odd ones on the grid.
            let row = y.div_ceil(2);
            for (x, out) in out.iter_mut().enumerate() {
                let column = x.div_ceil(2);
                *out = match (y % 2, x % 2) {
                    (0, 0) => cell_at(row, column),
                    (0, _) => {
                        let cells = [cell_at(row, column - 1), cell_at(row, column)];
                        edge(grid_at(row, column), grid_at(row + 1, column), cells)
                    }
                    (_, 0) => {
                        let cells = [cell_at(row - 1, column), cell_at(row, column)];
                        edge(grid_at(row, column), grid_at(row, column + 1), cells)
                    }
                    _ if is_bilinear => grid_at(row, column),
                    _ => {
                        let four = [
                            [grid_at(row, column - 1), grid_at(row, column + 1)],
                            [grid_at(row - 1, column), grid_at(row + 1, column)],
                            [cell_at(row - 1, column - 1), cell_at(row, column)],
                            [cell_at(row - 1, column), cell_at(row, column - 1)],
                        ];
                        let here = grid_at(row, column);
                        [0, 1, 2].map(|k| {
                            let sum = four.iter().fold(0.0, |sum, two| sum + (two[0][k] + two[1][k]));
                            0.5 * here[k] + 0.0625 * sum
                        })
                    }
                };
            }
        }
    }

    /// The number of a point of a grid, as [`Grids::at`] has it.
    fn index(&self, face: usize, row: usize, column: usize) -> u32 {
        let n = self.n;
        let on = |side: usize, part: usize| {
            let (edge, from) = self.side(face, side);
            let ends = self.edges.ends[edge as usize];
            let part = if ends[0] == from { part } else { n - part };
            if part == 0 || part == n {
                return ends[part / n];
            }
            (self.vertices.len() + edge as usize * (n - 1) + part - 1) as u32
        };
        match (row, column) {
            (0, _) => on(0, column),
            _ if row == n => on(2, n - column),
            (_, 0) => on(3, n - row),
            _ if column == n => on(1, row),
            _ => {
                let inside = (face * (n - 1) + row - 1) * (n - 1) + column - 1;
                (self.vertices.len() + self.along.len() + inside) as u32
            }
        }
    }

    fn cage(self) -> Result<Cage, InvalidCage> {
        let n = self.n;
        let n_faces = self.base.n_faces() * n * n;
        let mut corners = Vec::with_capacity(4 * n_faces);
        let mut low = vec![0; n + 1];
        let mut high = vec![0; n + 1];
        for face in 0..self.base.n_faces() {
            low.iter_mut().enumerate().for_each(|(column, index)| *index = self.index(face, 0, column));
            for row in 1..=n {
                high.iter_mut()
                    .enumerate()
                    .for_each(|(column, index)| *index = self.index(face, row, column));
                for (low, high) in low.windows(2).zip(high.windows(2)) {
                    corners.extend([low[0], low[1], high[1], high[0]]);
                }
                std::mem::swap(&mut low, &mut high);
            }
        }
        let part = (n * n) as u32;
        let holes = self.base.holes.iter().flat_map(|face| face * part..(face + 1) * part).collect();
        let creases = self.sharp_parts();
        let sharp = self.sharp_vertices.iter().enumerate().map(|(v, sharp)| (v as u32, *sharp));
        let sharp_vertices = sharp.filter(|(_, sharp)| *sharp > 0.0).collect();
        let mut positions = self.vertices;
        positions.extend(self.along);
        positions.extend(self.inside);
        if let Some(row) = positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(InvalidCage::NotFinite { row });
        }
        let ends = (1..=n_faces as u32).map(|k| 4 * k).collect();
        Ok(Cage { positions, ends, corners, holes, creases, sharp_vertices, ..*self.base })
    }

    /// The parts of edges that are sharp, but for those that are by nature.
    fn sharp_parts(&self) -> Vec<([u32; 2], f64)> {
        let mut all = Vec::new();
        for ([a, b], _) in &self.base.creases {
            let Some(edge) = self.edges.between(*a, *b) else { continue };
            let Some(sharp) = self.creases.get(&edge) else { continue };
            let ends = self.edges.ends[edge as usize];
            let index = |part: usize| match part {
                0 => ends[0],
                _ if part == self.n => ends[1],
                _ => (self.vertices.len() + edge as usize * (self.n - 1) + part - 1) as u32,
            };
            for (part, sharp) in sharp.iter().enumerate().filter(|(_, sharp)| **sharp > 0.0) {
                let (a, b) = (index(part), index(part + 1));
                all.push((if a < b { [a, b] } else { [b, a] }, *sharp));
            }
        }
        all.sort_unstable_by_key(|(ends, _)| *ends);
        all
    }
}

/// A vertex of the first round.
struct Base<'a> {
    grids: &'a Grids<'a>,
    vertex: u32,
}

impl Vertex for Base<'_> {
    fn here(&self) -> Point {
        self.grids.vertices[self.vertex as usize]
    }

    fn sharpness(&self) -> f64 {
        self.grids.sharp_vertices[self.vertex as usize]
    }

    fn edges(&self) -> impl Iterator<Item = (u32, f64)> + Clone {
        self.grids.around.edges(self.vertex as usize).iter().map(|edge| {
            let begins = self.grids.edges.ends[*edge as usize][0] == self.vertex;
            let part = if begins { 0 } else { self.grids.n - 1 };
            (*edge, self.grids.creases.get(edge).map_or(0.0, |sharp| sharp[part]))
        })
    }

    fn other_end(&self, edge: u32) -> Point {
        self.grids.on_edge(edge, self.vertex, 1)
    }

    fn smooth(&self) -> Point {
        let grids = self.grids;
        let (edges, faces) =
            (grids.around.edges(self.vertex as usize), grids.around.faces(self.vertex as usize));
        let n = edges.len() as f64;
        let share = 1.0 / (n * n);
        let start = self.here().map(|x| (n - 2.0) / n * x);
        let sum = edges.iter().fold(start, |sum, edge| plus(sum, share, self.other_end(*edge)));
        faces.iter().fold(sum, |sum, face| {
            let face = *face as usize;
            let side = (0..4).find(|side| grids.side(face, *side).1 == self.vertex).unwrap_or(0);
            let row = grids.beside(face, side);
            let (edge, from) = grids.side(face, side);
            let cell = [grids.on_edge(edge, from, 1), row(0), row(1)];
            let cell = cell.into_iter().fold(self.here().map(|x| 0.25 * x), |sum, p| plus(sum, 0.25, p));
            plus(sum, share, cell)
        })
    }

    fn creasing(&self) -> Creasing {
        self.grids.base.creasing
    }
}

/// A point along an edge, between two of its parts.
struct Between<F> {
    here: Point,
    ends: [Point; 2],
    sharp: [f64; 2],
    smooth: F,
    creasing: Creasing,
}

impl<F: Fn() -> Point> Vertex for Between<F> {
    fn here(&self) -> Point {
        self.here
    }

    fn sharpness(&self) -> f64 {
        0.0
    }

    fn edges(&self) -> impl Iterator<Item = (u32, f64)> + Clone {
        [(0, self.sharp[0]), (1, self.sharp[1])].into_iter()
    }

    fn other_end(&self, edge: u32) -> Point {
        self.ends[edge as usize]
    }

    fn smooth(&self) -> Point {
        (self.smooth)()
    }

    fn creasing(&self) -> Creasing {
        self.creasing
    }
}
