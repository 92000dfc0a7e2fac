//! `CellProver`: bounds the distance between one cell's triangles and the interpolant's surface by cutting
//! both up.
//!
//! As in `bound.rs`, g is the interpolant minus the level, negative inside, and S the boundary of {g < 0} in
//! the box of the lattice: the zeros of g in the box's inside, and its negative points in a capped border.
//! Beyond a capped border all points are outside.
//!
//! **From S.** A box in a cell has points of S only if the values of g at its corners are not all on one side,
//! since g is a mean of them. The distance from such a box to the mesh is no more than the distance of its
//! middle to some triangles plus half of its diagonal. Boxes are halved until that is within the aim. So are
//! squares in capped borders.
//!
//! **From the mesh.** A piece of a triangle is within its radius of its middle q. Vertices are points of S, up
//! to their margin and rounding. If the side of a point q' is certain and differs from the side of q, there is
//! a point of S between q and q'. Pieces are quartered until such a point is near enough.
//!
//! **Lower bound.** Between two points with certain and different sides there is a point of S. The distance of
//! one of the two to the triangles around, less the distance between the two, is a lower bound of the Hausdorff
//! distance. Triangles of other cells than the 27 around are farther away than the width of a cell.
//!
//! A value of g is a mean of eight corners with at most a dozen roundings, each of at most half a unit in the
//! last place of the largest corner: beyond 64 of those units its side is certain.
use super::caps::{CapVertex, squares_of, triangles};
use super::case_table::{EDGES, TABLE};
use super::marching_cubes::vertex_at;
use super::octree::OctreeCell;
use super::rule::{Border, Inside, LatticeTransform, Polygonize};
use super::source::SampleSource;
use super::transition_cells::{OctreeSurface, OctreeTriangle, is_certain};
use crate::check::{distance_up, triangle_at_least};
use crate::implicit::Affine3;
use crate::math::{add_up, cross, dot, greater, length, lesser, mul_up, sub_down};

type TriangleCoords = [[f64; 3]; 3];

/// The lattice with its surface and its mesh, cell by cell.
pub(super) struct CellProver<'a> {
    /// Not generic: this and the proof, compiled for each type of samples and for the finer lattice of each,
    /// were a sixth of the crate's functions.
    pub source: &'a dyn SampleSource,
    pub rule: &'a Polygonize,
    pub affine: &'a Affine3,
    /// The longest diagonal of a cell, rounded up.
    pub diagonal: f64,
    /// The largest distance of vertices from the interpolant's own zeros.
    pub moved: f64,
    /// The largest move of a point in space by rounding.
    pub rounding: f64,
    /// The largest error of a value.
    pub slack: f64,
    /// Whether a bound above the target is of no use.
    pub gives_up: bool,
    /// The mesh, if it is of an octree and not of the lattice alone; the octree's cells of one level are those of `source`.
    pub octree: Option<OctreeLevel<'a>>,
}

/// A surface in the cells of an octree, and a level of it.
#[derive(Clone, Copy)]
pub(super) struct OctreeLevel<'a> {
    pub surface: &'a OctreeSurface<'a>,
    pub level: u8,
}

/// g at the corners of a cell, and the size above which a value in it has a certain side.
struct CellInterpolant {
    g: [f64; 8],
    off: f64,
}

/// A triangle of the mesh in indices and in space.
struct CellTriangle {
    index: TriangleCoords,
    space: TriangleCoords,
    /// Whether each corner is a point of S, up to its margin and rounding.
    is_zero: [bool; 3],
}

/// The most boxes or pieces examined in one cell.
const MOST: usize = 4096;
/// A factor that rounds a length down or up: far more than its dozen roundings.
const ABOVE: f64 = 1.0 + 64.0 * f64::EPSILON;

impl CellInterpolant {
    fn at(&self, [x, y, z]: [f64; 3]) -> f64 {
        let g = &self.g;
        let along = |c: usize| g[c] * (1.0 - x) + g[c + 1] * x;
        let low = along(0) * (1.0 - y) + along(2) * y;
        let high = along(4) * (1.0 - y) + along(6) * y;
        low * (1.0 - z) + high * z
    }

    /// g at the corners of a box in the cell: [`CellInterpolant::at`] at each, with shared terms computed
    /// once.
    fn over(&self, low: [f64; 3], high: [f64; 3]) -> [f64; 8] {
        let mixed = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
        let g = &self.g;
        let along: [f64; 8] =
            std::array::from_fn(|c| mixed(g[c & 6], g[c | 1], if c & 1 == 0 { low[0] } else { high[0] }));
        let across: [f64; 8] = std::array::from_fn(|c| {
            mixed(along[c & 5], along[c | 2], if c & 2 == 0 { low[1] } else { high[1] })
        });
        std::array::from_fn(|c| {
            mixed(across[c & 3], across[c | 4], if c & 4 == 0 { low[2] } else { high[2] })
        })
    }

    fn gradient(&self, t: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| {
            let (mut low, mut high) = (t, t);
            (low[k], high[k]) = (0.0, 1.0);
            self.at(high) - self.at(low)
        })
    }
}

impl CellProver<'_> {
    fn corners(&self, [i, j, k]: [usize; 3]) -> CellInterpolant {
        let flip = if self.rule.inside == Inside::High { -1.0 } else { 1.0 };
        let samples = self.source.corners([i, j, k]);
        let g: [f64; 8] =
            std::array::from_fn(|c| flip * (self.rule.finite_sample(samples[c]) - self.rule.level));
        let most = g.iter().fold(0.0, |m: f64, x| greater(x.abs(), m));
        // The roundings of a value, derived above; the smallest number covers underflow.
        let off = add_up(mul_up(32.0 * f64::EPSILON, most), add_up(self.slack, f64::MIN_POSITIVE));
        CellInterpolant { g, off }
    }

    /// The cell of a point in index coordinates, and the point's coordinates in it.
    fn locate(&self, p: [f64; 3]) -> ([usize; 3], [f64; 3]) {
        let size = self.source.size();
        // The last sample of a row is in the last cell.
        let cell = [0, 1, 2].map(|k| (p[k] as usize).min(size[k] - 2));
        (cell, [0, 1, 2].map(|k| p[k] - cell[k] as f64))
    }

    /// Whether a point is inside, if that is certain.
    fn sure_side(&self, p: [f64; 3]) -> Option<bool> {
        let size = self.source.size();
        let mut beyond = false;
        for k in 0..3 {
            let ends = [p[k] < 0.0, p[k] > (size[k] - 1) as f64];
            for end in (0..2).filter(|end| ends[*end]) {
                // Nothing is known beyond an open border.
                if self.rule.border[k][end] == Border::Open {
                    return None;
                }
                beyond = true;
            }
        }
        if beyond {
            return Some(false);
        }
        let (cell, t) = self.locate(p);
        let corners = self.corners(cell);
        let g = corners.at(t);
        if g > corners.off {
            Some(false)
        } else if g < -corners.off {
            Some(true)
        } else {
            None
        }
    }

    /// The point in space of index coordinates.
    fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let place = LatticeTransform::new(self.affine, self.rule.offset);
        place.at([0, 1, 2].map(|k| place.global(k, 0) + p[k]))
    }

    /// The length in space of a vector in index coordinates, rounded up.
    fn space_length(&self, d: [f64; 3]) -> f64 {
        let steps = self.affine.steps();
        let along = [0, 1, 2].map(|k| steps[0][k] * d[0] + steps[1][k] * d[1] + steps[2][k] * d[2]);
        let size =
            |k: usize| (steps[0][k] * d[0]).abs() + (steps[1][k] * d[1]).abs() + (steps[2][k] * d[2]).abs();
        // Five roundings for each coordinate, relative to the sum of sizes.
        let rounding = 8.0 * f64::EPSILON * (size(0) + size(1) + size(2));
        (length(along) + rounding) * ABOVE
    }

    /// The triangles of a cell, including those of its squares in capped borders.
    fn triangles(&self, cell: [usize; 3]) -> Vec<CellTriangle> {
        if let Some(OctreeLevel { surface, level }) = self.octree {
            let mut pieces = Vec::new();
            surface.for_each_piece(OctreeCell { level, at: cell.map(|i| i as u32) }, |triangle| {
                pieces.push(self.piece(surface, triangle));
            });
            return pieces;
        }
        let place = LatticeTransform::new(self.affine, self.rule.offset);
        let mut signs = 0;
        let corner = |c: usize| [cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)];
        for c in 0..8 {
            signs |= usize::from(self.rule.is_inside(self.source.at(corner(c)))) << c;
        }
        let vertex = |kind: usize, at: [usize; 3]| {
            let mut index = at.map(|i| i as f64);
            // A corner of a cap, kind 3, is a point of the surface: it is inside, at a capped border.
            let mut is_zero = true;
            if kind < 3 {
                let mut ahead = at;
                ahead[kind] += 1;
                let [from, to] = [at, ahead].map(|at| self.source.at(at));
                index[kind] += self.rule.crossing(from, to);
                is_zero = is_certain([from, to], self.slack, self.rule.margin);
            }
            (index, vertex_at(self.source, self.rule, &place, kind, at), is_zero)
        };
        let piece = |v: [([f64; 3], [f64; 3], bool); 3]| CellTriangle {
            index: v.map(|v| v.0),
            space: v.map(|v| v.1),
            is_zero: v.map(|v| v.2),
        };
        let case = &TABLE.upright[signs];
        let edge = |edge: u8| vertex(usize::from(edge / 4), corner(usize::from(EDGES[usize::from(edge)][0])));
        let mut pieces: Vec<CellTriangle> =
            case.corners[..usize::from(case.triangles)].iter().map(|t| piece(t.map(edge))).collect();
        for square in squares_of(cell, self.source.size(), self.rule.border) {
            let mut vertices = Vec::new();
            let number = |spot: CapVertex| {
                vertices.push(match spot {
                    CapVertex::Corner(i) => vertex(3, square[i]),
                    CapVertex::Side(i) => {
                        let (a, b) = (square[i], square[(i + 1) % 4]);
                        let axis = (0..3).find(|&k| a[k] != b[k]).unwrap_or(0);
                        vertex(axis, if a[axis] < b[axis] { a } else { b })
                    }
                });
                vertices.len() as u32 - 1
            };
            let mut faces = Vec::new();
            triangles(square.map(|at| self.rule.is_inside(self.source.at(at))), number, |face| {
                faces.push(face)
            });
            pieces.extend(faces.iter().map(|face| piece(face.map(|v| vertices[v as usize]))));
        }
        pieces
    }

    fn piece(&self, surface: &OctreeSurface<'_>, triangle: OctreeTriangle) -> CellTriangle {
        let place = surface.place();
        let parts = self.octree.map_or(1.0, |octree| (1_u64 << octree.level) as f64);
        CellTriangle {
            index: triangle.map(|vertex| vertex.index().map(|x| x * parts)),
            space: triangle.map(|vertex| vertex.point(&place, surface.rule.offset)),
            is_zero: triangle.map(|vertex| vertex.is_zero),
        }
    }

    /// The triangles of a cell and of those around it.
    fn neighbour_triangles(&self, cell: [usize; 3]) -> Vec<TriangleCoords> {
        let size = self.source.size();
        let span = |k: usize| cell[k].saturating_sub(1)..(cell[k] + 2).min(size[k] - 1);
        let mut triangles = Vec::new();
        if let Some(OctreeLevel { surface, level }) = self.octree {
            for leaf in surface.leaves_around(OctreeCell { level, at: cell.map(|i| i as u32) }) {
                surface.for_each_piece(leaf, |triangle| triangles.push(self.piece(surface, triangle).space));
            }
            return triangles;
        }
        for k in span(2) {
            for j in span(1) {
                triangles.extend(
                    span(0).flat_map(|i| self.triangles([i, j, k]).into_iter().map(|piece| piece.space)),
                );
            }
        }
        triangles
    }

    /// The distance between the mesh and S in a cell, rounding included: at most `target` if that can be
    /// proved, otherwise the best bound so far, and never more than the diagonal.
    pub fn cell_distance(&self, cell: [usize; 3], target: f64) -> f64 {
        let triangles = self.triangles(cell);
        // The rounding of points, which is added again below.
        let target = sub_down(target, mul_up(4.0, self.rounding));
        let surface_to_mesh = self.surface_to_mesh(cell, &triangles, target);
        // Derived: each point of a triangle is within its longest side over √3 of a corner (Jung), and corners
        // are points of S, except for vertices inside the cell.
        let has_zeros = triangles.iter().all(|piece| piece.is_zero == [true; 3]);
        let by_corners =
            if has_zeros { add_up(mul_up(0.577_351, self.diagonal), self.moved) } else { f64::INFINITY };
        let mesh_to_surface = if by_corners <= target || surface_to_mesh >= self.diagonal {
            by_corners
        } else {
            self.mesh_to_surface(cell, &triangles, target)
        };
        let most = add_up(greater(surface_to_mesh, mesh_to_surface), mul_up(4.0, self.rounding));
        lesser(most, self.diagonal)
    }

    fn surface_to_mesh(&self, cell: [usize; 3], own: &[CellTriangle], target: f64) -> f64 {
        let corners = self.corners(cell);
        let mut boxes = vec![([0.0; 3], 1.0, None)];
        for square in squares_of(cell, self.source.size(), self.rule.border) {
            let axis = (0..3).find(|&k| square.iter().all(|at| at[k] == square[0][k])).unwrap_or(0);
            let mut low = [0.0; 3];
            low[axis] = (square[0][axis] - cell[axis]) as f64;
            boxes.push((low, 1.0, Some(axis)));
        }
        let mut around: Option<Vec<TriangleCoords>> = None;
        let mut most = 0.0;
        let mut looked_at = 0;
        while let Some((low, side, flat)) = boxes.pop() {
            looked_at += 1;
            if looked_at > MOST || most >= self.diagonal || self.gives_up && most > target {
                return self.diagonal;
            }
            let high = [0, 1, 2].map(|k| if flat == Some(k) { low[k] } else { low[k] + side });
            let values = corners.over(low, high);
            let has_inside = !values.iter().all(|g| *g > corners.off);
            // Beyond a capped border all points are outside.
            let has_outside = flat.is_some() || !values.iter().all(|g| *g < -corners.off);
            if !(has_inside && has_outside) {
                continue;
            }
            let half = mul_up(0.5 * side, self.diagonal);
            let middle = [0, 1, 2]
                .map(|k| cell[k] as f64 + if flat == Some(k) { low[k] } else { low[k] + 0.5 * side });
            let middle = self.point(middle);
            let nearest = |least: f64, t: &TriangleCoords| {
                let far = distance_up(middle, t);
                lesser(far, least)
            };
            let mut far = own.iter().map(|piece| &piece.space).fold(f64::INFINITY, nearest);
            // The triangles of 27 cells are made only if those of the cell itself are too far from a part of
            // it.
            if add_up(far, half) > target && side <= 0.5 {
                far = around.get_or_insert_with(|| self.neighbour_triangles(cell)).iter().fold(far, nearest);
            }
            let far = add_up(far, half);
            // Boxes whose halves are far below the target, or a sixty-fourth of a cell, are not cut.
            if far <= target || half < 0.125 * target || side < 1.0 / 32.0 {
                most = greater(far, most);
            } else {
                let n = if flat.is_some() { 4 } else { 8 };
                for c in 0..n {
                    let mut next = low;
                    let mut bit = c;
                    for k in (0..3).filter(|k| flat != Some(*k)) {
                        next[k] += 0.5 * side * (bit & 1) as f64;
                        bit >>= 1;
                    }
                    boxes.push((next, 0.5 * side, flat));
                }
            }
        }
        most
    }

    fn mesh_to_surface(&self, cell: [usize; 3], own: &[CellTriangle], target: f64) -> f64 {
        let mut most = 0.0;
        let mut looked_at = 0;
        let mut pieces: Vec<(TriangleCoords, u32)> = own.iter().map(|piece| (piece.index, 0)).collect();
        while let Some((piece, depth)) = pieces.pop() {
            looked_at += 1;
            if looked_at > MOST || most >= self.diagonal {
                return self.diagonal;
            }
            let [a, b, c] = piece;
            let middle = [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0);
            let radius = piece
                .map(|v| self.space_length([0, 1, 2].map(|k| v[k] - middle[k])))
                .into_iter()
                .fold(0.0, |m, r| greater(r, m));
            // A point of the surface within this reach of the middle is within the target of the whole piece.
            let reach = sub_down(target, radius);
            // Vertices that are zeros come first, since they take no search.
            let vertices =
                own.iter().flat_map(|piece| (0..3).filter(|v| piece.is_zero[*v]).map(|v| piece.index[v]));
            let nearest = vertices
                .map(|v| self.space_length([0, 1, 2].map(|k| v[k] - middle[k])))
                .fold(f64::INFINITY, least);
            let nearest = add_up(nearest, self.moved);
            let distance = match reach > 0.0 {
                true if nearest <= reach => Some(nearest),
                true => self.distance_within(cell, middle, reach),
                false => None,
            };
            if let Some(far) = distance {
                let far = add_up(far, radius);
                most = greater(far, most);
            } else if depth < 5 {
                let half = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]));
                let (ab, bc, ca) = (half(a, b), half(b, c), half(c, a));
                for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                    pieces.push((part, depth + 1));
                }
            } else {
                return self.diagonal;
            }
        }
        most
    }

    /// The distance of S from a point, if a point of S is found within `reach`.
    fn distance_within(&self, cell: [usize; 3], from: [f64; 3], reach: f64) -> Option<f64> {
        let here = self.sure_side(from);
        let mut most = 0.0;
        // If the side of the point itself is uncertain, both sides have to be near: one of the two differs
        // from it.
        for inside in [true, false].into_iter().filter(|inside| here != Some(*inside)) {
            let far = self.distance_to_side(cell, from, inside, reach)?;
            most = greater(far, most);
        }
        Some(most)
    }

    /// The distance from a point to a point on the given side, if one is found within `reach`.
    fn distance_to_side(&self, cell: [usize; 3], from: [f64; 3], inside: bool, reach: f64) -> Option<f64> {
        let corners = self.corners(cell);
        let t = [0, 1, 2].map(|k| from[k] - cell[k] as f64);
        let slope = corners.gradient(t);
        let sign = if inside { -1.0 } else { 1.0 };
        let at = |d: [f64; 3], long: f64| -> Option<f64> {
            let unit = self.space_length(d);
            let scale = long / unit;
            let d = d.map(|x| x * scale);
            let there = [0, 1, 2].map(|k| from[k] + d[k]);
            (scale.is_finite() && self.sure_side(there) == Some(inside)).then(|| self.space_length(d) * ABOVE)
        };
        let uphill = slope.map(|x| sign * x);
        // A Newton step, and a little more.
        let square = dot(slope, slope);
        let newton = self.space_length(uphill) * corners.at(t).abs() / square * 1.0625;
        // Below `reach` by far more than rounding adds to a length.
        let share = |part: f64| part * reach * (1.0 - 1024.0 * f64::EPSILON);
        if newton <= share(1.0)
            && let Some(far) = at(uphill, newton)
        {
            return Some(far);
        }
        for part in [1.0, 0.5, 0.25] {
            if let Some(far) = at(uphill, share(part)) {
                return Some(far);
            }
            for k in 0..3 {
                for way in [1.0, -1.0] {
                    let mut d = [0.0; 3];
                    d[k] = way;
                    if let Some(far) = at(d, share(part)) {
                        return Some(far);
                    }
                }
            }
        }
        None
    }

    /// A point of S far from the mesh, with a lower bound of its distance. `None` when none is found that is
    /// farther than `known`.
    pub fn witness(&self, cell: [usize; 3], known: f64) -> Option<(f64, [f64; 3])> {
        const PARTS: usize = 4;
        let corners = self.corners(cell);
        let triangles = self.triangles(cell);
        let mut candidates: Vec<(f64, [f64; 3])> = Vec::new();
        for n in 0..PARTS * PARTS * PARTS {
            let part = [n % PARTS, n / PARTS % PARTS, n / (PARTS * PARTS)];
            let mut t = part.map(|i| (i as f64 + 0.5) / PARTS as f64);
            for _ in 0..3 {
                let (g, slope) = (corners.at(t), corners.gradient(t));
                let step = g / dot(slope, slope);
                // The step leaves the part by at most half of its size: farther points are found from other parts.
                t = [0, 1, 2].map(|k| {
                    let (low, high) = (part[k] as f64 - 0.5, part[k] as f64 + 1.5);
                    let x = t[k] - step * slope[k];
                    let x = greater(x, low / PARTS as f64);
                    let x = lesser(x, high / PARTS as f64);
                    x.clamp(0.0, 1.0)
                });
            }
            let slope = corners.gradient(t);
            // Measured: a root has a value of at most a millionth of the change over a cell.
            let is_root = corners.at(t).abs() <= 1e-6 * length(slope);
            if !is_root {
                continue;
            }
            let at = [0, 1, 2].map(|k| cell[k] as f64 + t[k]);
            let p = self.point(at);
            let far = triangles.iter().map(|piece| distance_up(p, &piece.space)).fold(f64::INFINITY, least);
            if far > known {
                candidates.push((far, at));
            }
        }
        candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best: Option<(f64, [f64; 3])> = None;
        let mut around: Option<Vec<TriangleCoords>> = None;
        for (far, at) in candidates.into_iter().take(8) {
            let known = best.map_or(known, |best| best.0);
            if far <= known {
                break;
            }
            let around = around.get_or_insert_with(|| self.neighbour_triangles(cell));
            let p = self.point(at);
            // Triangles of more distant cells are at least that far away.
            let far = around.iter().map(|t| triangle_at_least(p, *t)).fold(self.narrowest(), least);
            let Some(apart) = (far > known).then(|| self.bracket(cell, at)).flatten() else { continue };
            let far = sub_down(far, add_up(apart, mul_up(4.0, self.rounding)));
            if far > known {
                best = Some((far, p));
            }
        }
        best
    }

    /// A bound for the distance of a point to S, by two points on different sides; for points that are almost on S.
    fn bracket(&self, cell: [usize; 3], at: [f64; 3]) -> Option<f64> {
        let slope = self.corners(cell).gradient([0, 1, 2].map(|k| at[k] - cell[k] as f64));
        let size = self.source.size();
        let along = length(slope);
        // Exact powers of two, from a trillionth of a cell to a thousandth.
        let mut step = 1.0 / 1_099_511_627_776.0;
        while step < 1.0 / 1024.0 {
            let ends = [1.0, -1.0].map(|way| [0, 1, 2].map(|k| at[k] + way * step * (slope[k] / along)));
            let within = |p: &[f64; 3]| (0..3).all(|k| p[k] >= 0.0 && p[k] <= (size[k] - 1) as f64);
            if ends.iter().all(within)
                && self.sure_side(ends[0]) == Some(false)
                && self.sure_side(ends[1]) == Some(true)
            {
                let d = [0, 1, 2].map(|k| ends[0][k] - ends[1][k]);
                return Some(self.space_length(d));
            }
            step *= 8.0;
        }
        None
    }

    /// The smallest distance between opposite faces of a cell, rounded down.
    fn narrowest(&self) -> f64 {
        let [a, b, c] = self.affine.steps();
        let volume = dot(a, cross(b, c)).abs();
        let widest =
            [cross(b, c), cross(c, a), cross(a, b)].map(length).into_iter().fold(0.0, |m, l| greater(l, m));
        // A determinant loses digits by cancellation, so its rounding is relative to the size of all its products.
        let size = length(a) * length(b) * length(c);
        let width = (volume - 32.0 * f64::EPSILON * size) / (widest * ABOVE);
        greater(width, 0.0)
    }
}

fn least(a: f64, b: f64) -> f64 {
    lesser(b, a)
}
