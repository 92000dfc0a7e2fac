//! How far a mesh of marching cubes is from the level surface of the trilinear interpolant, proved cell by cell.
//!
//! Let g be the interpolant minus the level, negated where high is inside, so that the shape is {g < 0}, and S its boundary
//! in the lattice's box (a tie is outside). Coordinates of a cell are indices, from 0 to 1; `mesh` is the mesh with its
//! vertices at the exact zeros of g on the edges, and what is written differs from it by rounding and by the
//! margin, which are added at the end.
//!
//! **Every cell by its diagonal.** In a cell g is a convex combination of the corners. So a cell without inside corners
//! holds no point with g < 0, and one without outside corners only such points: a point of S lies in a cell with both
//! (one that has points with g < 0 arbitrarily close to it). Triangles lie in such cells too. And such a cell has an edge with
//! ends on both sides, which has a vertex of the mesh and a point of S. So a point of either is within the longest
//! diagonal of its cell of the other.
//!
//! **g on a triangle.** Along each axis g is linear, so its Hessian H has no diagonal. Let q = Σ λᵢ Vᵢ be on a triangle of
//! the cell, with g(Vᵢ) = 0. Taylor's formula about q gives 0 = Σ λᵢ g(Vᵢ) = g(q) + ½ Σ λᵢ (Vᵢ−q)ᵀ H(ξᵢ) (Vᵢ−q), hence
//! |g(q)| ≤ Σ λᵢ (|Δx||Δy| Mxy + |Δy||Δz| Myz + |Δx||Δz| Mxz), with M the largest mixed derivatives in the cell: each is linear
//! in the third coordinate, so it is the larger of two second differences of corners. By Cauchy and Schwarz
//! Σ λᵢ|Δx||Δy| ≤ √(Σ λᵢΔx² · Σ λᵢΔy²), and a variance is at most a quarter of the squared range (Popoviciu). Ranges are
//! at most 1, so |g| ≤ e = (Mxy + Myz + Mxz)/4 on all triangles of the cell.
//!
//! **A stack of cells.** For a cell and an axis, say z, take cells below and above it until the four corners at
//! the low end are all on one side, those at the high end all on the other, and suppose that all differences along z in the
//! stack have one sign and are at least m > 0 in size. The derivative of g along z is a convex combination of four of
//! them, so on each line along z through the stack g is strictly monotone, and it changes sign: there is exactly one
//! point of S on it, and g crosses there. The mesh has an odd number of points on the line, hence one: no triangle is in the
//! ends of the stack, whose corners agree, and the mesh separates inside from outside corners. With e the largest in the stack, the
//! mesh's point has |g| ≤ e, and so the two are within e/m of each other. This serves points of S and of the mesh in
//! the cell alike.
//!
//! **At a capped border** the stack may end early on its outer side, for the shape ends there: where the line leaves the
//! box while g < 0 it crosses S in the border, and the mesh likewise its cap; each stands within e/m of the other as
//! before, because g is linear on the sides of the squares and |g| ≤ e holds for the border's polygons too. Lines in the
//! border itself show the same for the caps. Squares all of whose corners are inside are in both.
//!
//! Where no axis has a stack the diagonal stays.
use super::march::Plan;
use super::rule::{Border, Inside, Polygonize};
use super::source::Source;
use crate::budget::Job;
use crate::implicit::Affine;
use crate::math::{Box3, add_up, div_up, mul_up};

/// The longest stack that is tried.
const MOST_CELLS: usize = 16;

/// Half a unit in the last place of 1: the relative error of one rounding.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// A bound on the distance, and where it is largest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Farthest {
    pub most: f64,
    pub at: [usize; 3],
}

/// What the proof needs of the lattice.
pub(crate) struct Proof<'a, S> {
    source: &'a S,
    rule: &'a Polygonize,
    size: [usize; 3],
    /// The lengths of the three steps in space, rounded up.
    lengths: [f64; 3],
    /// The longest diagonal of a cell in space, rounded up.
    diagonal: f64,
    /// By how much every value may be off.
    slack: f64,
}

/// One cell.
#[derive(Clone, Copy)]
struct Cell {
    /// g at the corners, but for a common constant.
    corners: [f64; 8],
    /// Bits of those that are inside.
    signs: u8,
    /// e: the most of |g| on its triangles.
    error: f64,
}

/// For each axis the corners at its low end.
const LOW: [[usize; 4]; 3] = [[0, 2, 4, 6], [0, 1, 4, 5], [0, 1, 2, 3]];
/// For each axis the bits of those.
const LOW_BITS: [u8; 3] = [0b0101_0101, 0b0011_0011, 0b0000_1111];

impl<'a, S: Source> Proof<'a, S> {
    pub fn new(source: &'a S, affine: &Affine, rule: &'a Polygonize) -> Self {
        let steps = affine.steps();
        let diagonal = diagonal(affine);
        let lengths = steps.map(|step| length_up(step.map(f64::abs)));
        Self { source, rule, size: source.size(), lengths, diagonal, slack: 0.0 }
    }

    /// The same where the values are those of another function, up to `slack`.
    pub fn with_slack(self, slack: f64) -> Self {
        Self { slack, ..self }
    }

    /// A bound for all cells, without the rounding of vertices.
    pub fn farthest(&self, plan: &Plan, job: &Job) -> Farthest {
        let none = Farthest { most: 0.0, at: [0; 3] };
        let slabs = plan.for_each_slab(job, |walk| {
            let mut worst = none;
            walk(&mut |at, _| {
                if !job.is_cancelled() {
                    let most = self.cell_bound(at, worst.most);
                    if most > worst.most {
                        worst = Farthest { most, at };
                    }
                }
            });
            worst
        });
        slabs.into_iter().fold(none, |worst, one| if one.most > worst.most { one } else { worst })
    }

    /// A bound for one cell. Once it is no more than `enough` nothing better is looked for.
    fn cell_bound(&self, at: [usize; 3], enough: f64) -> f64 {
        let cell = self.cell(at);
        // The axis with the steepest slowest edge first.
        let mut axes = [0, 1, 2].map(|axis| (cell.slope(axis), axis));
        for (a, b) in [(0, 1), (1, 2), (0, 1)] {
            if axes[b].0 > axes[a].0 {
                axes.swap(a, b);
            }
        }
        // Where a side may be wrong a cell need not hold both.
        let mut best = if self.slack == 0.0 { self.diagonal } else { f64::INFINITY };
        for (slope, axis) in axes {
            if best <= enough || slope <= 0.0 {
                break;
            }
            if let Some(shift) = self.stack(at, &cell, axis) {
                let most = mul_up(shift, self.lengths[axis]);
                if most < best {
                    best = most;
                }
            }
        }
        best
    }

    /// e/m of the stack of a cell along an axis, if there is one.
    fn stack(&self, at: [usize; 3], cell: &Cell, axis: usize) -> Option<f64> {
        let rises = cell.corners[7] > cell.corners[7 - (1 << axis)];
        let mut slope = cell.slope(axis);
        let mut error = cell.error;
        for up in [true, false] {
            // g rises towards outside.
            let (wanted, outward) = if up == rises { (0, true) } else { (LOW_BITS[axis], false) };
            let end =
                |cell: &Cell| (if up { cell.signs >> (1 << axis) } else { cell.signs }) & LOW_BITS[axis];
            let (mut here, mut current) = (at, *cell);
            for step in 0.. {
                if end(&current) == wanted && (self.slack == 0.0 || self.is_clear(&current, up, axis)) {
                    break;
                }
                let next = if up { here[axis] + 1 } else { here[axis].wrapping_sub(1) };
                if next >= self.size[axis] - 1 {
                    let border = self.rule.border[axis][usize::from(up)];
                    if outward && border == Border::Capped {
                        break;
                    }
                    return None;
                }
                here[axis] = next;
                current = self.cell(here);
                let next_slope = current.slope(axis);
                let rises_too = current.corners[7] > current.corners[7 - (1 << axis)];
                if step == MOST_CELLS || next_slope <= 0.0 || rises_too != rises {
                    return None;
                }
                slope = if next_slope < slope { next_slope } else { slope };
                error = if current.error > error { current.error } else { error };
            }
        }
        // With values off by the slack, differences are off by two of it, and g on the mesh by one more.
        let slope = (slope - 2.0 * self.slack).next_down();
        let shift = div_up(add_up(error, mul_up(2.0, self.slack)), slope);
        (slope > 0.0 && shift.is_finite()).then_some(shift)
    }

    /// Whether the corners at an end of a cell are so far from the level that no slack changes their sides.
    fn is_clear(&self, cell: &Cell, up: bool, axis: usize) -> bool {
        LOW[axis].iter().all(|low| {
            let corner = cell.corners[low + if up { 1 << axis } else { 0 }];
            (corner.abs() - self.rule.level.abs()).abs() > 2.0 * self.slack
        })
    }

    fn cell(&self, [i, j, k]: [usize; 3]) -> Cell {
        let flip = if self.rule.inside == Inside::High { -1.0 } else { 1.0 };
        let mut signs = 0;
        let mut corners = [0.0; 8];
        for (c, corner) in corners.iter_mut().enumerate() {
            let sample = self.source.at([i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)]);
            signs |= u8::from(self.rule.is_inside(sample)) << c;
            *corner = flip * self.rule.counted(sample);
        }
        Cell { corners, signs, error: error(&corners) }
    }
}

impl Cell {
    /// A bound from below on the size of the differences along an axis; 0 when their signs differ.
    fn slope(&self, axis: usize) -> f64 {
        let differences = LOW[axis].map(|low| self.corners[low + (1 << axis)] - self.corners[low]);
        let rises = differences[0] > 0.0;
        let sizes = differences.map(|d| if rises { d } else { -d });
        let least = sizes.into_iter().fold(sizes[0], |least, d| if d < least { d } else { least });
        if least > 0.0 { least.next_down() } else { 0.0 }
    }
}

/// e: from the larger of two second differences for each pair of axes. Those are rounded three times, each time by at most
/// the rounding of a number that is no larger than twice the longest first difference, or four times it.
fn error(v: &[f64; 8]) -> f64 {
    let mixed = |a: [usize; 4], b: [usize; 4]| {
        let one = |[p, q, r, s]: [usize; 4]| ((v[s] - v[r]) - (v[q] - v[p])).abs();
        let (a, b) = (one(a), one(b));
        if a > b { a } else { b }
    };
    let xy = mixed([0, 1, 2, 3], [4, 5, 6, 7]);
    let xz = mixed([0, 1, 4, 5], [2, 3, 6, 7]);
    let yz = mixed([0, 2, 4, 6], [1, 3, 5, 7]);
    let (low, high) = v.iter().fold((v[0], v[0]), |(low, high), &x| {
        (if x < low { x } else { low }, if x > high { x } else { high })
    });
    let rounding = mul_up(32.0 * ROUNDING, (high - low).next_up());
    add_up(0.25 * add_up(add_up(xy, xz), yz), rounding)
}

/// The longest diagonal of a cell, rounded up.
pub(crate) fn diagonal(affine: &Affine) -> f64 {
    let steps = affine.steps();
        let diagonals = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[y, z]| {
            length_up([0, 1, 2].map(|k| {
                let sum = (steps[0][k] + y * steps[1][k]) + z * steps[2][k];
                let size = (steps[0][k].abs() + steps[1][k].abs()) + steps[2][k].abs();
                // Two additions, each with a rounding of at most that share of the size.
                add_up(sum.abs(), mul_up(4.0 * ROUNDING, size))
            }))
        });
        diagonals.into_iter().fold(0.0, |most, d| if d > most { d } else { most })
}

fn length_up(sides: [f64; 3]) -> f64 {
    Box3 { min: [0.0; 3], max: sides }.diagonal()
}
