//! `FaceLattice`: a surface as a lattice of bicubic patches, which are cut into cells.
//!
//! *Lattice coordinates* are whole numbers on the borders of patches: `x` counts columns, `y` counts rows.
use super::face_cells::FaceCells;
use crate::convert::patches::derivative_bound::{PatchDerivatives, rounding};
use crate::explicit::Patch;
use crate::explicit::nurbs::NurbsSurface;
use crate::math::{difference, dot, greater, length, lesser};
use glam::DVec3;

/// The most parts of a patch in one direction. Chosen: errors fall with its square, so more would hardly ever help.
const MOST_PARTS: f64 = 4096.0;
/// Samples of a patch's bending along one direction. Chosen: the ends, the middle, and one between each.
const SAMPLES: usize = 5;
/// An estimate within this factor of a length is close enough. Chosen: it is only an estimate.
const TOLERATED: f64 = 1.02;
/// An excess over a whole number of parts that adds no part. Chosen: as small as the error of the estimates.
const TOLERATED_EXCESS: f64 = 0.02;
/// Rounds that adapt the number of parts until estimates fit. Chosen: a few suffice, since each multiplies by the
/// missing factor.
const ROUNDS: usize = 12;

/// A surface as patches and lines.
pub(super) struct FaceLattice {
    patches: Vec<Patch>,
    derivatives: Vec<PatchDerivatives>,
    /// Numbers of columns and rows of patches.
    pub n: [usize; 2],
    /// By direction: the surface's parameters at the borders of patches.
    breaks: [Vec<f64>; 2],
    /// By direction, column and row: the surface's piece.
    piece_of: [Vec<usize>; 2],
    pub cells: FaceCells,
    /// By patch: upper bounds of the derivatives by the surface's two parameters, and of their product.
    speeds: Vec<[f64; 3]>,
    /// The largest speeds along both parameters.
    pub fastest: [f64; 2],
    /// The largest error from rounding of parameters, as a length.
    pub parameter_rounding: f64,
    /// The largest error from rounding of triangles.
    pub rounding: f64,
}

/// The number of patches of a surface's piece in a direction, and the largest number of cells of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PieceCuts {
    pub patches: usize,
    pub cells: usize,
}

/// A rectangle of parameters.
pub(super) type ParameterBox = [[f64; 2]; 2];

impl FaceLattice {
    /// The patches of a surface, row by row, with the number of parts of each of its pieces. The degree and the largest
    /// coordinates of the loops bound the rounding of their points.
    pub fn new(
        surface: &NurbsSurface,
        patches: Vec<Patch>,
        cuts: &[Vec<usize>; 2],
        degree: usize,
        loops_reach: [f64; 2],
    ) -> Self {
        let breaks = [0, 1].map(|k| {
            let knots = &surface.knots()[k];
            let of = |(piece, n): (usize, &usize)| {
                let ([a, b], n) = (knots.piece(piece), *n);
                (0..n).map(move |part| a + (b - a) * (part as f64 / n as f64))
            };
            let mut all: Vec<f64> = cuts[k].iter().enumerate().flat_map(of).collect();
            all.push(knots.domain()[1]);
            all
        });
        let n = [0, 1].map(|k| breaks[k].len() - 1);
        let piece_of = [0, 1].map(|k| {
            let all = cuts[k].iter().enumerate();
            all.flat_map(|(piece, n)| std::iter::repeat_n(piece, *n)).collect()
        });
        let width = |k: usize, i: usize| breaks[k][i + 1] - breaks[k][i];
        let speed = |index: usize| {
            let control = &patches[index].control;
            let along_u: Vec<[f64; 3]> =
                control.iter().flat_map(|row| row.windows(2).map(|p| difference(p[1], p[0]))).collect();
            let up = |j: usize| (0..4).map(move |i| [j, i]);
            let along_v: Vec<[f64; 3]> =
                (0..3).flat_map(up).map(|[j, i]| difference(control[j + 1][i], control[j][i])).collect();
            let longest = |all: &[[f64; 3]]| all.iter().fold(0.0, |most: f64, d| greater(length(*d), most));
            // Derivatives are means of these vectors, and so is their product of the products of all pairs.
            let product =
                along_u.iter().flat_map(|a| along_v.iter().map(|b| dot(*a, *b).abs())).fold(0.0, greater);
            // Lengths are rounded by a few parts in 2⁵² of themselves, products by a few parts in 2⁵² of the lengths.
            let most = 3.0 * (1.0 + 16.0 * f64::EPSILON);
            let widths = [width(0, index % n[0]), width(1, index / n[0])];
            let [u, v] = [longest(&along_u), longest(&along_v)];
            let product = product + 16.0 * f64::EPSILON * u * v;
            [most * u / widths[0], most * v / widths[1], most * most * product / (widths[0] * widths[1])]
        };
        let speeds: Vec<[f64; 3]> = (0..patches.len()).map(speed).collect();
        let fastest = [0, 1].map(|k| speeds.iter().fold(0.0, |most: f64, s| greater(s[k], most)));
        // Derived: a parameter is a weighted mean of control points, in as many steps as its degree p. Its error is below
        // 8(p + 8) roundings of its range's largest number; a lattice coordinate adds 16 roundings of the number of patches
        // times the widest.
        let parameter_rounding = (0..2).fold(0.0, |sum, k| {
            let reach = greater(greater(breaks[k][0].abs(), breaks[k][n[k]].abs()), loops_reach[k]);
            let widest = (0..n[k]).fold(0.0, |most: f64, i| greater(width(k, i), most));
            let steps = 8.0 * (degree + 8) as f64 * reach + 16.0 * n[k] as f64 * widest;
            sum + fastest[k] * steps * f64::EPSILON
        });
        Self {
            cells: FaceCells::new(n, vec![[1; 2]; patches.len()]),
            derivatives: patches.iter().map(PatchDerivatives::new).collect(),
            rounding: patches.iter().map(rounding).fold(0.0, greater),
            patches,
            n,
            breaks,
            piece_of,
            speeds,
            fastest,
            parameter_rounding,
        }
    }

    /// By patch: the number of parts along both directions for triangles with an expected distance within a length.
    pub fn needs(&self, length: f64) -> Vec<[f64; 2]> {
        (0..self.patches.len()).map(|index| self.parts_of(index, length)).collect()
    }

    /// By direction: the best number of patches for each of the surface's pieces, and of cells for each of these, by the
    /// numbers that the patches need; a piece has at least `least` patches.
    ///
    /// The number of cells is a power of two, so that a patch that needs fewer has every second line of its neighbour.
    pub fn cuts_of_pieces(&self, needs: &[[f64; 2]], least: &[Vec<usize>; 2]) -> [Vec<PieceCuts>; 2] {
        [0, 1].map(|k| {
            let mut most = vec![0.0; least[k].len()];
            for (index, need) in needs.iter().enumerate() {
                let piece = self.piece_of[k][[index % self.n[0], index / self.n[0]][k]];
                most[piece] = greater(most[piece], need[k]);
            }
            let of = |(piece, least): (usize, &usize)| {
                let n = self.piece_of[k].iter().filter(|of| **of == piece).count();
                let needed = whole_parts(most[piece] * n as f64);
                let mut cells = 1;
                while 2 * cells * least <= needed {
                    cells *= 2;
                }
                PieceCuts { patches: needed.div_ceil(cells).max(*least), cells }
            };
            least[k].iter().enumerate().map(of).collect()
        })
    }

    /// Cuts patches into cells: as many as their piece has, or a half, a quarter and so on if they need no more.
    pub fn cut(&mut self, needs: &[[f64; 2]], pieces: &[Vec<PieceCuts>; 2]) {
        let parts = needs.iter().enumerate().map(|(index, need)| {
            let place = [index % self.n[0], index / self.n[0]];
            [0, 1].map(|k| {
                let mut cells = pieces[k][self.piece_of[k][place[k]]].cells;
                while cells.is_multiple_of(2) && cells / 2 >= whole_parts(need[k]) {
                    cells /= 2;
                }
                cells
            })
        });
        self.cells = FaceCells::new(self.n, parts.collect());
    }

    /// The largest distance of a patch from its two halves, by its derivatives.
    pub fn bending(&self) -> f64 {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let of = |(patch, derivatives): (&Patch, &PatchDerivatives)| {
            let [a, b] =
                diagonal_bounds(derivatives, square, square.map(|[u, v]| DVec3::from(patch.at(u, v))));
            lesser(a, b)
        };
        self.patches.iter().zip(&self.derivatives).map(of).fold(0.0, greater)
    }

    /// The number of parts of a patch along both directions.
    fn parts_of(&self, index: usize, length: f64) -> [f64; 2] {
        // The number of cells is least with half of the length for the bending along each direction.
        let few_parts = [SAMPLES as f64; 2];
        let [along_u, along_v, _] = self.worst_bending(index, few_parts);
        let squares = few_parts[0] * few_parts[0];
        let mut parts =
            [along_u, along_v].map(|bending| greater((2.0 * bending * squares / length).sqrt(), 1.0));
        for _ in 0..ROUNDS {
            let [.., cell_bending] = self.worst_bending(index, parts);
            let is_done = cell_bending <= TOLERATED * length && cell_bending * TOLERATED >= length;
            // Errors go with the square of the size.
            let factor = lesser((cell_bending / length).sqrt(), 8.0);
            let next = parts.map(|n| lesser(greater(n * factor, 1.0), MOST_PARTS));
            if is_done || next == parts {
                break;
            }
            parts = next;
        }
        parts
    }

    /// The largest estimated bending in a patch cut into so many parts: of cells' sides along both directions, and of the
    /// cells.
    fn worst_bending(&self, index: usize, parts: [f64; 2]) -> [f64; 3] {
        let (patch, derivatives) = (&self.patches[index], &self.derivatives[index]);
        let mut worst = [0.0_f64; 3];
        for j in 0..SAMPLES {
            for i in 0..SAMPLES {
                let size = parts.map(|n| 1.0 / n);
                let at = [i, j].map(|k| k as f64 / (SAMPLES - 1) as f64);
                let from = [0, 1].map(|k| at[k] * (1.0 - size[k]));
                let corner = |du: f64, dv: f64| [from[0] + du * size[0], from[1] + dv * size[1]];
                let square = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
                let points = square.map(|[u, v]| DVec3::from(patch.at(u, v)));
                let [first, second] = diagonal_bounds(derivatives, square, points);
                worst[2] = greater(worst[2], lesser(first, second));
                for (k, [p, q]) in [[0, 1], [0, 3]].into_iter().enumerate() {
                    let (ends, at) = ([square[p], square[q]], [points[p], points[q]]);
                    worst[k] = greater(worst[k], edge_bound(derivatives, ends, at));
                }
            }
        }
        worst
    }

    /// The point of the lattice at parameters, on a line if it is near one.
    pub fn place_of(&self, parameters: [f64; 2]) -> [f64; 2] {
        self.cells.snapped([0, 1].map(|k| self.coordinate(k, parameters[k])))
    }

    /// Moves points to the end of the range of a parameter if all of them are beyond it.
    pub fn cut_off(&self, k: usize, points: &mut [[f64; 2]]) {
        let [from, to] = [self.breaks[k][0], self.breaks[k][self.n[k]]];
        if points.iter().all(|p| p[k] < from) {
            points.iter_mut().for_each(|p| p[k] = from);
        } else if points.iter().all(|p| p[k] > to) {
            points.iter_mut().for_each(|p| p[k] = to);
        }
    }

    fn coordinate(&self, k: usize, parameter: f64) -> f64 {
        let breaks = &self.breaks[k];
        let last = self.n[k] - 1;
        let i = breaks.partition_point(|b| *b <= parameter).saturating_sub(1).min(last);
        let part = (parameter - breaks[i]) / (breaks[i + 1] - breaks[i]);
        i as f64 + if part > 0.0 { lesser(part, 1.0) } else { 0.0 }
    }

    /// The parameter of a lattice coordinate.
    pub fn parameter(&self, k: usize, x: f64) -> f64 {
        let i = (x as usize).min(self.n[k] - 1);
        let (a, b) = (self.breaks[k][i], self.breaks[k][i + 1]);
        a + (b - a) * (x - i as f64)
    }

    /// The place in a patch of lattice coordinates.
    fn place(&self, patch: usize, [x, y]: [f64; 2]) -> [f64; 2] {
        // Exact: both are multiples of the same steps, or one is 0.
        [x - (patch % self.n[0]) as f64, y - (patch / self.n[0]) as f64]
    }

    /// The point of the patches at lattice coordinates.
    pub fn position(&self, at: [f64; 2]) -> [f64; 3] {
        let (patch, [u, v]) = self.patch_and_place(at);
        self.patches[patch].at(u, v)
    }

    /// The unit normal of the patches at lattice coordinates; none if tangents vanish.
    pub fn normal(&self, at: [f64; 2]) -> Option<[f64; 3]> {
        let (patch, [u, v]) = self.patch_and_place(at);
        self.patches[patch].normal(u, v)
    }

    fn patch_and_place(&self, at: [f64; 2]) -> (usize, [f64; 2]) {
        let [i, j] = [0, 1].map(|k| (at[k] as usize).min(self.n[k] - 1));
        let patch = j * self.n[0] + i;
        (patch, self.place(patch, at))
    }

    /// The distance bound of a triangle within a patch, without rounding.
    pub fn triangle_bound(&self, patch: usize, corners: [[f64; 2]; 3], at: [[f64; 3]; 3]) -> f64 {
        self.derivatives[patch].triangle_bound(corners.map(|at| self.place(patch, at)), at.map(DVec3::from))
    }

    /// The distance of the image of a straight line within a patch from the chord between its ends, without rounding.
    pub fn edge_bound(&self, patch: usize, ends: [[f64; 2]; 2], at: [[f64; 3]; 2]) -> f64 {
        let ends = ends.map(|at| self.place(patch, at));
        edge_bound(&self.derivatives[patch], ends, at.map(DVec3::from))
    }

    /// The bounds of both ways to halve a cell.
    pub fn diagonal_bounds(&self, patch: usize, corners: [[f64; 2]; 4], at: [[f64; 3]; 4]) -> [f64; 2] {
        let corners = corners.map(|at| self.place(patch, at));
        diagonal_bounds(&self.derivatives[patch], corners, at.map(DVec3::from))
    }

    /// Upper bounds of the derivatives by both parameters, and of their product, over the patches that a rectangle of
    /// parameters touches.
    pub fn speeds(&self, [u, v]: ParameterBox) -> [f64; 3] {
        let range = |k: usize, [from, to]: [f64; 2]| {
            let first = self.breaks[k].partition_point(|b| *b < from).saturating_sub(1);
            let end = self.breaks[k].partition_point(|b| *b <= to).clamp(1, self.n[k]);
            first.min(end - 1)..end
        };
        let (columns, rows) = (range(0, u), range(1, v));
        let touched = rows.flat_map(|j| columns.clone().map(move |i| j * self.n[0] + i));
        touched.fold([0.0; 3], |most, patch| std::array::from_fn(|k| greater(self.speeds[patch][k], most[k])))
    }
}

/// The distance of the image of a straight line from its chord: the bound of a degenerate triangle with its third corner
/// in the middle of a side.
fn edge_bound(derivatives: &PatchDerivatives, ends: [[f64; 2]; 2], at: [DVec3; 2]) -> f64 {
    let middle = std::array::from_fn(|k| 0.5 * (ends[0][k] + ends[1][k]));
    derivatives.triangle_bound([ends[0], ends[1], middle], [at[0], at[1], 0.5 * (at[0] + at[1])])
}

fn whole_parts(need: f64) -> usize {
    greater((need - TOLERATED_EXCESS).ceil(), 1.0) as usize
}

/// The larger bound of the two triangles beside the diagonal from the first corner, and the same for the other
/// diagonal.
fn diagonal_bounds(derivatives: &PatchDerivatives, corners: [[f64; 2]; 4], at: [DVec3; 4]) -> [f64; 2] {
    let bound = |t: [usize; 3]| derivatives.triangle_bound(t.map(|k| corners[k]), t.map(|k| at[k]));
    [greater(bound([0, 1, 2]), bound([0, 2, 3])), greater(bound([0, 1, 3]), bound([1, 2, 3]))]
}
