//! One tile: its triangles, and the proof of their distance.
use super::adjacency::PatchCorner;
use super::derivative_bound::{PatchDerivatives, ThirdOrderJet, across, max_barycentric_quadratic};
use super::extraordinary_tile;
use super::patch_tile::{PatchTile, PatchTileMesh, cell_counts};
use super::seams::TileSeams;
use super::subpatch::{Subpatch, SubpatchShape};
use super::tile_border::{BorderVertex, walk_side};
use crate::explicit::{Patch, PatchSide, bernstein, face_normal};
use crate::math::greater;
use glam::DVec3;

/// A vertex of a tile: its parameters in the tile's unit square and its position.
#[derive(Clone, Copy)]
struct TileVertex {
    u: f64,
    v: f64,
    at: DVec3,
}

struct TileTriangulator<'a> {
    derivatives: PatchDerivatives,
    border: Vec<TileVertex>,
    /// Start of each side in `border`, and its end.
    sides: [usize; 5],
    /// The shared vertex at each border vertex of the tile.
    shared: Vec<BorderVertex>,
    inner: Vec<TileVertex>,
    normals: Vec<[f64; 3]>,
    tile: &'a PatchTile,
    /// Cells in each direction; there are `(n−1) × (m−1)` inner vertices.
    n: usize,
    m: usize,
    triangles: Vec<[u32; 3]>,
    /// Triangles that a pole makes a segment or a point.
    degenerate: Vec<[u32; 3]>,
    collides: bool,
    bound: f64,
    worst: [[f64; 2]; 3],
}

/// Triangulates and proves the tile with the given index.
pub(crate) fn build(
    index: usize,
    tile: &PatchTile,
    subpatch: &Subpatch<'_>,
    seams: &TileSeams,
) -> PatchTileMesh {
    let part = match &subpatch.shape {
        SubpatchShape::Bezier(patch) => subpatch.tile_patch(patch, tile),
        SubpatchShape::Extraordinary(extraordinary) => {
            return extraordinary_tile::build(index, tile, extraordinary, seams);
        }
    };
    let mut work = TileTriangulator {
        derivatives: PatchDerivatives::new(&part),
        border: Vec::new(),
        sides: [0; 5],
        shared: Vec::new(),
        inner: Vec::new(),
        normals: Vec::new(),
        tile,
        n: tile.n as usize,
        m: tile.m as usize,
        triangles: Vec::new(),
        degenerate: Vec::new(),
        collides: false,
        bound: 0.0,
        worst: [[0.0; 2]; 3],
    };
    work.walk_border(index, seams);
    let counts =
        PatchSide::ALL.map(|side| (work.sides[side as usize + 1] - work.sides[side as usize]) as u32);
    work.triangulate(counts, &part);
    let too_few = work.collides || work.has_gap();
    PatchTileMesh {
        triangles: work.triangles,
        inner: work.inner.iter().map(|knot| knot.at.into()).collect(),
        inner_normals: work.normals,
        bound: (work.bound + subpatch.rounding_error()).next_up(),
        worst: work.worst,
        normal_deviation: None,
        too_few,
        border_normals: Vec::new(),
        place: part.bounds(),
        is_kept: false,
    }
}

/// The largest distance between the unit normal of a triangle of a finished tile and the unit normal of the surface at
/// one of its corners or in its middle. Triangles no longer than the allowed length are left out: they are not visible,
/// and normals never converge at folds and tips of a surface.
pub(crate) fn normal_deviation(
    (index, tile): (usize, &PatchTile),
    subpatch: &Subpatch<'_>,
    seams: &TileSeams,
    done: &PatchTileMesh,
) -> f64 {
    let mut knots: Vec<TileVertex> = Vec::new();
    for side in PatchSide::ALL {
        walk_side(index, tile, side, seams, |u, v, vertex| {
            knots.push(TileVertex { u, v, at: DVec3::from(seams.positions[vertex.id as usize]) });
        });
    }
    // The only inner vertex that such a tile may have is in its middle, as with two cells each way.
    let [n, m] = match &subpatch.shape {
        SubpatchShape::Extraordinary(_) => [2, 2],
        SubpatchShape::Bezier(_) => cell_counts(tile, PatchSide::ALL.map(|side| seams.count(index, side))),
    };
    let places = (1..m).flat_map(|j| (1..n).map(move |i| (i, j)));
    knots.extend(places.zip(&done.inner).map(|((i, j), at)| TileVertex {
        u: f64::from(i) / f64::from(n),
        v: f64::from(j) / f64::from(m),
        at: DVec3::from(*at),
    }));
    let within = |x: f64, [from, to]: [f64; 2]| from + (to - from) * x;
    let normal = |u: f64, v: f64| subpatch.normal(within(u, tile.u), within(v, tile.v)).map(DVec3::from);
    let at_knots: Vec<Option<DVec3>> = knots.iter().map(|knot| normal(knot.u, knot.v)).collect();
    let mut most = 0.0;
    for t in &done.triangles {
        let [a, b, c] = t.map(|k| knots[k as usize]);
        // The normal of a triangle no larger than the tolerance says nothing.
        let is_visible =
            [a.at - b.at, b.at - c.at, c.at - a.at].iter().any(|side| side.length() > tile.tolerance);
        let face = is_visible.then(|| face_normal([a.at, b.at, c.at].map(Into::into))).flatten();
        let Some(face) = face.map(DVec3::from) else { continue };
        let middle = normal((a.u + b.u + c.u) / 3.0, (a.v + b.v + c.v) / 3.0);
        let surface_normals = t.iter().map(|k| at_knots[*k as usize]).chain([middle]).flatten();
        most = surface_normals.map(|normal| (normal - face).length()).fold(most, greater);
    }
    most
}

impl TileTriangulator<'_> {
    fn walk_border(&mut self, index: usize, seams: &TileSeams) {
        for side in PatchSide::ALL {
            walk_side(index, self.tile, side, seams, |u, v, vertex| {
                self.border.push(TileVertex { u, v, at: DVec3::from(seams.positions[vertex.id as usize]) });
                self.shared.push(vertex);
            });
            self.sides[side as usize + 1] = self.border.len();
        }
    }

    fn triangulate(&mut self, counts: [u32; 4], part: &Patch) {
        let [n, m] = cell_counts(self.tile, counts).map(|c| c as usize);
        (self.n, self.m) = (n, m);
        self.triangles.reserve(2 * (n - 1) * (m - 1) + self.border.len());
        self.add_inner_vertices(part);
        // A folded corner needs a strip on the side that ends at it.
        let folded = |side: PatchSide| {
            n > 2 && m > 2 && self.tile.corners[(side as usize + 1) % 4] == PatchCorner::Folded
        };
        let open = |side: PatchSide| {
            let is_row = matches!(side, PatchSide::Bottom | PatchSide::Top);
            folded(side) || counts[side as usize] as usize != if is_row { n } else { m }
        };
        // With strips on both sides of a single row no cells are left: one strip joins the two sides.
        if m == 1 && open(PatchSide::Bottom) && open(PatchSide::Top) {
            self.strip(&self.side(PatchSide::Bottom), &reversed(self.side(PatchSide::Top)));
        } else if n == 1 && open(PatchSide::Left) && open(PatchSide::Right) {
            self.strip(&self.side(PatchSide::Left), &reversed(self.side(PatchSide::Right)));
        } else {
            let ends = |low: PatchSide, high: PatchSide, count: usize| {
                [usize::from(open(low)), count - usize::from(open(high))]
            };
            self.grid(ends(PatchSide::Left, PatchSide::Right, n), ends(PatchSide::Bottom, PatchSide::Top, m));
        }
    }

    /// Adds the inner vertices with their normals, row by row.
    fn add_inner_vertices(&mut self, part: &Patch) {
        let (n, m) = (self.n, self.m);
        let q = part.control.map(|row| row.map(DVec3::from));
        let size = part.size();
        for j in 1..m {
            let v = j as f64 / m as f64;
            let b = bernstein(v);
            let s = 1.0 - v;
            let d = [3.0 * s * s, 6.0 * s * v, 3.0 * v * v];
            let line: [DVec3; 4] = std::array::from_fn(|k| {
                (q[0][k] * b[0] + q[1][k] * b[1]) + (q[2][k] * b[2] + q[3][k] * b[3])
            });
            let slope: [DVec3; 4] = std::array::from_fn(|k| {
                (q[1][k] - q[0][k]) * d[0] + (q[2][k] - q[1][k]) * d[1] + (q[3][k] - q[2][k]) * d[2]
            });
            let rise = [line[1] - line[0], line[2] - line[1], line[3] - line[2]];
            for i in 1..n {
                let u = i as f64 / n as f64;
                let w = bernstein(u);
                let s = 1.0 - u;
                let at = (line[0] * w[0] + line[1] * w[1]) + (line[2] * w[2] + line[3] * w[3]);
                let by_v = (slope[0] * w[0] + slope[1] * w[1]) + (slope[2] * w[2] + slope[3] * w[3]);
                let by_u = rise[0] * (3.0 * s * s) + rise[1] * (6.0 * s * u) + rise[2] * (3.0 * u * u);
                let normal = by_u.cross(by_v);
                let length_sq = normal.length_squared();
                // The plain quotient is accurate far from underflow and from vanishing tangents; otherwise the
                // patch is evaluated.
                let floor = 64.0 * f64::EPSILON * size;
                let sound = length_sq > f64::MIN_POSITIVE * 1e60
                    && by_u.length_squared() > floor * floor
                    && by_v.length_squared() > floor * floor
                    && length_sq.is_finite();
                let normal = if sound {
                    (normal / length_sq.sqrt()).into()
                } else {
                    part.normal(u, v).unwrap_or([0.0; 3])
                };
                self.inner.push(TileVertex { u, v, at });
                self.normals.push(normal);
            }
        }
    }

    /// The local vertices of a side including both corners, counter-clockwise.
    fn side(&self, side: PatchSide) -> Vec<u32> {
        let (start, end) = (self.sides[side as usize], self.sides[side as usize + 1]);
        let mut list: Vec<u32> = (start as u32..end as u32).collect();
        list.push((end % self.border.len()) as u32);
        list
    }

    fn inner_id(&self, i: usize, j: usize) -> u32 {
        (self.border.len() + (j - 1) * (self.n - 1) + (i - 1)) as u32
    }

    fn vertex(&self, id: u32) -> TileVertex {
        let id = id as usize;
        if id < self.border.len() { self.border[id] } else { self.inner[id - self.border.len()] }
    }

    /// The local vertex at grid position `(i, j)`. Positions on the border are valid only if that side has as many
    /// segments as the tile has cells, or at a corner.
    fn grid_id(&self, i: usize, j: usize) -> u32 {
        // Each side owns its first corner:
        //    (0, m) ←── side 2 ── (n, m)
        //      │                    ↑
        //    side 3               side 1
        //      ↓                    │
        //    (0, 0) ── side 0 ──→ (n, 0)
        let (n, m) = (self.n, self.m);
        let border = if j == 0 && i < n {
            self.sides[0] + i
        } else if i == n && j < m {
            self.sides[1] + j
        } else if j == m && i > 0 {
            self.sides[2] + (n - i)
        } else if i == 0 {
            self.sides[3] + (m - j)
        } else {
            return self.inner_id(i, j);
        };
        border as u32
    }

    /// Adds equal cells over columns `i` and rows `j`, each split along the tile's diagonal. If the range leaves out an
    /// outermost row or column, a strip connects the grid to the points of that side:
    ///
    /// ```text
    ///   o──o──o──o──o──o     a side with more segments than cells
    ///   |\/ \ /\/ \/\ /|     strip
    ///   o───o────o─────o
    ///   | / | /  |  /  |     equal cells
    ///   o───o────o─────o
    /// ```
    fn grid(&mut self, i: [usize; 2], j: [usize; 2]) {
        let (n, m) = (self.n, self.m);
        let (du, dv) = (1.0 / n as f64, 1.0 / m as f64);
        // The error of a parameter is at most an ulp of 1; the box of a cell is larger by that.
        let remainder = self.derivatives.remainder(du + 4.0 * f64::EPSILON, dv + 4.0 * f64::EPSILON);
        let mut low: Vec<u32> = (i[0]..=i[1]).map(|i| self.grid_id(i, j[0])).collect();
        for row in j[0]..j[1] {
            let high: Vec<u32> = (i[0]..=i[1]).map(|i| self.grid_id(i, row + 1)).collect();
            let bend = self.derivatives.row((row as f64 + 0.5) * dv);
            for k in 0..i[1] - i[0] {
                let jet = bend.at(((i[0] + k) as f64 + 0.5) * du);
                let rising = self.is_rising(i[0] + k, row);
                let corners = [low[k], low[k + 1], high[k + 1], high[k]];
                self.cell(corners, &CellJet { jet, remainder, rising });
            }
            low = high;
        }
        let row = |at: usize| -> Vec<u32> { (i[0]..=i[1]).map(|i| self.grid_id(i, at)).collect() };
        let column = |at: usize| -> Vec<u32> { (j[0]..=j[1]).map(|j| self.grid_id(at, j)).collect() };
        let inner = [row(j[0]), column(i[1]), reversed(row(j[1])), reversed(column(i[0]))];
        let open = [j[0] > 0, i[1] < n, j[1] < m, i[0] > 0];
        let mut outer = PatchSide::ALL.map(|side| self.side(side));
        for side in 0..4 {
            let next = (side + 1) % 4;
            if open[side] && open[next] {
                self.cut_corner(&mut outer, side, inner[next][0]);
            }
        }
        for side in (0..4).filter(|side| open[*side]) {
            self.strip(&outer[side], &inner[side]);
        }
    }

    /// At a corner of two stitched sides: joins the corner to vertex `inner`, or cuts the corner off, whichever bends
    /// less.
    fn cut_corner(&mut self, outer: &mut [Vec<u32>; 4], side: usize, inner: u32) {
        let next = (side + 1) % 4;
        let (count, count_next) = (outer[side].len(), outer[next].len());
        // A side of one segment has no vertex before its end to which the corner could be cut off.
        if count < 3 || count_next < 3 || self.tile.corners[next] != PatchCorner::Plain {
            return;
        }
        let (before, corner, after) = (outer[side][count - 2], outer[next][0], outer[next][1]);
        if self.bend_across_edge(before, after) < self.bend_across_edge(corner, inner) {
            let triangle = [before, corner, after];
            let bound = self.triangle_bound(triangle);
            self.emit(triangle, bound);
            // The strip of this side now ends where that of the next one begins: behind the corner.
            outer[side][count - 1] = after;
            outer[next].remove(0);
        }
    }

    /// Whether the cell's diagonal runs from its first corner to the opposite one.
    fn is_rising(&self, i: usize, j: usize) -> bool {
        let (right, top) = (i + 1 == self.n, j + 1 == self.m);
        let [first, second, third, fourth] = self.tile.corners.map(|corner| corner != PatchCorner::Plain);
        // A corner that must not be cut off has the diagonal that ends at it.
        if first && i == 0 && j == 0 || third && right && top {
            true
        } else if second && right && j == 0 || fourth && i == 0 && top {
            false
        } else {
            self.tile.rising
        }
    }

    /// The kind of corner at a local vertex.
    fn corner(&self, id: u32) -> PatchCorner {
        let corner = (0..4).find(|corner| self.sides[*corner] == id as usize);
        corner.map_or(PatchCorner::Plain, |corner| self.tile.corners[corner])
    }

    /// The two triangles of one cell, corners counter-clockwise.
    fn cell(&mut self, corners: [u32; 4], CellJet { jet, remainder, rising }: &CellJet) {
        let [a, b, c, d] = corners.map(|id| self.vertex(id));
        let (du, dv) = (b.u - a.u, d.v - a.v);
        let (u, v) = (0.5 * du, 0.5 * dv);
        let bottom = across(jet.half_along([du, 0.0], [0.0, -v]), b.at - a.at);
        let top = across(jet.half_along([du, 0.0], [0.0, v]), c.at - d.at);
        let left = across(jet.half_along([0.0, dv], [-u, 0.0]), d.at - a.at);
        let right = across(jet.half_along([0.0, dv], [u, 0.0]), c.at - b.at);
        let [ia, ib, ic, id] = corners;
        let [pa, pb, pc, pd] = [[-u, -v], [u, -v], [u, v], [-u, v]];
        // The middle of either diagonal is that of the cell, where the jet was taken: no third derivatives
        // enter there.
        let (first, second, bounds, twists) = if *rising {
            let diagonal = across(jet.second.half_along(du, dv), c.at - a.at);
            let bounds = [
                max_barycentric_quadratic(bottom, right, diagonal),
                max_barycentric_quadratic(top, left, diagonal),
            ];
            ([ia, ib, ic], [ia, ic, id], bounds, [[pa, pb, pc], [pa, pc, pd]])
        } else {
            let diagonal = across(jet.second.half_along(du, -dv), d.at - b.at);
            let bounds = [
                max_barycentric_quadratic(bottom, left, diagonal),
                max_barycentric_quadratic(top, right, diagonal),
            ];
            ([ia, ib, id], [ib, ic, id], bounds, [[pa, pb, pd], [pb, pc, pd]])
        };
        self.emit(first, bounds[0] + jet.third_order_bound(twists[0]) + remainder);
        self.emit(second, bounds[1] + jet.third_order_bound(twists[1]) + remainder);
    }

    /// Adds the triangles between two chains that run in the same direction, the second on the left of the
    /// first: at every step the cross edge that bends less. If the first chain starts or ends at a corner that must
    /// not be cut off, the corner is joined to the inner vertex next to it. A folded corner at its end is joined to
    /// two inner vertices, so that the corner's neighbour only connects to the second of them.
    fn strip(&mut self, outer: &[u32], inner: &[u32]) {
        let (mut i, mut j) = (0, 0);
        let last = inner.len() - 1;
        let on_border = |k: usize| usize::from((inner[k] as usize) < self.border.len());
        let meeting = |id: u32| if self.n > 1 && self.m > 1 { self.corner(id) } else { PatchCorner::Plain };
        let from_corner = meeting(outer[0]) != PatchCorner::Plain && on_border(0) == 1;
        let to_corner = match meeting(outer[outer.len() - 1]) {
            PatchCorner::Plain => 0,
            PatchCorner::Whole => on_border(last),
            PatchCorner::Folded => on_border(last) + 1,
        };
        //   inner[j] o------o     Each step adds a triangle on the last cross edge: with the next outer
        //            | `.   |     vertex if `forward`, otherwise with the next inner one.
        //            |   `. |
        //   outer[i] o------o
        while i + 1 < outer.len() || j + 1 < inner.len() {
            let forward = if i + 1 == outer.len() {
                false
            } else if j == last {
                true
            } else if from_corner && j == 0 {
                false
            } else if to_corner > 0 && j + to_corner >= last {
                true
            } else {
                let by_outer = self.bend_across_edge(outer[i + 1], inner[j]);
                let by_inner = self.bend_across_edge(outer[i], inner[j + 1]);
                by_outer <= by_inner
            };
            let triangle =
                if forward { [outer[i], outer[i + 1], inner[j]] } else { [outer[i], inner[j + 1], inner[j]] };
            if forward {
                i += 1
            } else {
                j += 1
            }
            let bound = self.triangle_bound(triangle);
            self.emit(triangle, bound);
        }
    }

    /// The bending across an edge, and its length in parameters, which decides if nothing bends.
    fn bend_across_edge(&self, a: u32, b: u32) -> (f64, f64) {
        let (a, b) = (self.vertex(a), self.vertex(b));
        let (du, dv) = (b.u - a.u, b.v - a.v);
        let jet = self.derivatives.at(0.5 * (a.u + b.u), 0.5 * (a.v + b.v));
        (across(jet.second.half_along(du, dv), b.at - a.at), du * du + dv * dv)
    }

    fn triangle_bound(&self, triangle: [u32; 3]) -> f64 {
        let knots = triangle.map(|id| self.vertex(id));
        self.derivatives.triangle_bound(knots.map(|knot| [knot.u, knot.v]), knots.map(|knot| knot.at))
    }

    fn emit(&mut self, triangle: [u32; 3], bound: f64) {
        if bound > self.bound {
            self.bound = bound;
            let place = |x: f64, [from, to]: [f64; 2]| from + (to - from) * x;
            let (u, v) = (self.tile.u, self.tile.v);
            self.worst = triangle.map(|id| self.vertex(id)).map(|knot| [place(knot.u, u), place(knot.v, v)]);
        }
        let [a, b, c] = triangle;
        // At a pole, a triangle with two corners at one vertex is left out; elsewhere, the border has too few
        // vertices.
        let twins = [self.coincidence(a, b), self.coincidence(b, c), self.coincidence(c, a)];
        if twins.contains(&VertexCoincidence::Collision) {
            self.collides = true;
        } else if twins.contains(&VertexCoincidence::Pole) {
            self.degenerate.push(triangle);
        } else {
            self.triangles.push(triangle);
        }
    }

    /// Whether the image of an omitted triangle is no side of another triangle. It cannot happen with three cells in each
    /// direction, since then no row of cells lies between two poles and every pole is joined to an inner vertex.
    fn has_gap(&self) -> bool {
        if self.degenerate.is_empty() || self.n > 2 && self.m > 2 {
            return false;
        }
        // Border vertices by their shared numbers, inner ones by those in the tile.
        let key = |local: u32| match self.shared.get(local as usize) {
            Some(vertex) => (false, vertex.id),
            None => (true, local),
        };
        let sides = |t: &[u32; 3]| {
            let [a, b, c] = t.map(key);
            [[a, b], [b, c], [c, a]].map(|[a, b]| if a < b { [a, b] } else { [b, a] })
        };
        let mut segments: Vec<_> = self.triangles.iter().flat_map(sides).collect();
        // A point is covered by a segment that contains it.
        segments.extend(self.triangles.as_flattened().iter().map(|&local| [key(local); 2]));
        segments.sort_unstable();
        let has = |side: &[(bool, u32); 2]| segments.binary_search(side).is_ok();
        !self.degenerate.iter().all(|t| sides(t).iter().all(has))
    }

    fn coincidence(&self, a: u32, b: u32) -> VertexCoincidence {
        match (self.shared.get(a as usize), self.shared.get(b as usize)) {
            (Some(a), Some(b)) if a.id == b.id && (a.pole || b.pole) => VertexCoincidence::Pole,
            (Some(a), Some(b)) if a.id == b.id => VertexCoincidence::Collision,
            _ => VertexCoincidence::Apart,
        }
    }
}

/// The diagonal of one cell, and the derivatives at its middle.
struct CellJet {
    jet: ThirdOrderJet,
    remainder: f64,
    rising: bool,
}

/// How two local vertices relate in space.
#[derive(PartialEq)]
enum VertexCoincidence {
    Apart,
    Pole,
    Collision,
}

fn reversed(chain: Vec<u32>) -> Vec<u32> {
    chain.into_iter().rev().collect()
}
