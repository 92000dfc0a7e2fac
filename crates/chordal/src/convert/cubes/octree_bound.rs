//! Bounds the distance between the mesh of an octree and the trilinear isosurface, cell by cell: the proof of `bound.rs`
//! for cells of several levels.
//!
//! g is trilinear in each cell of each level. Vertices on edges are zeros of g, up to the error δ of rounded values;
//! vertices inside a cell are means of such vertices, hence in their convex hull. A *leaf* is a cell that is not halved.
//!
//! **g on a triangle.** The formula of `bound.rs` needs no more than that: on all triangles of a leaf |g| ≤ e + δ, with e
//! from the mixed differences of its own corners, and a part of the leaf has no larger e.
//!
//! **A point far from 0 is on its side of the mesh.** From x with g(x) > e + δ in a leaf the path along the axes ends at a
//! corner of that leaf with g > e + δ, which counts as outside, and meets no triangle of the leaf. The loops of a cell
//! separate the corners on its surface by their sides, and the triangles that fill them separate its inside: x is outside
//! of the mesh.
//!
//! **Three cells in a row** are of one level. The middle one is a leaf; each of the other two is a leaf, a part of a larger
//! leaf, or halved. The slopes are of these three cells alone, since the path stays in them. For each cell, e is that of
//! the leaf at the end of the path: of the larger leaf if the cell is a part of it, otherwise no more than the cell's own.
//! Then the proof is as in `bound.rs`. It does not use triangles, so it holds if cells are halved later, which only makes
//! e smaller.
//!
//! **The other cells** are cut up by `cell_prover.rs` with the triangles of the current mesh, and again after cells near
//! them are halved.
use super::bound::diagonal;
use super::cell_prover::{CellProver, OctreeLevel};
use super::halved_lattice::{HalvedLattice, largest_on_triangles};
use super::octree::OctreeCell;
use super::rule::{Border, Polygonize};
use super::slopes::{LOW, shift};
use super::source::DenseSamples;
use super::transition_cells::OctreeSurface;
use crate::implicit::Affine3;
use crate::math::{Box3, add_up, greater, lesser, mul_up, sub_down};

/// The lattice of one level's cells.
pub(in crate::convert) struct LevelLattice {
    pub affine: Affine3,
    pub rule: Polygonize,
    /// The largest distance of written vertices from zeros of the interpolant on the edges, or from their means.
    moved: f64,
    /// The part of that by rounding.
    rounding: f64,
    diagonal: f64,
    /// The lengths of the three steps in space, rounded up.
    lengths: [f64; 3],
    /// A bound in exact coordinates that is small enough.
    enough: f64,
}

impl LevelLattice {
    /// The lattice of a level with this transform; its vertices on edges have the error `moved`, of which `rounding` is by
    /// rounding. The last argument is the goal, a length.
    pub fn new(affine: Affine3, rule: Polygonize, (moved, rounding): (f64, f64), length: f64) -> Self {
        let lengths = affine.steps().map(|step| Box3 { min: [0.0; 3], max: step.map(f64::abs) }.diagonal());
        let longest = lengths.into_iter().fold(0.0, |most, side| greater(side, most));
        // A mean of up to 2²⁰ vertices in coordinates of the cell, with a rounding of 2⁻⁵³ for each: 2⁻³⁰ of an edge along
        // each axis is far more.
        let moved = add_up(moved, mul_up(longest, 4.0 / 1_073_741_824.0));
        // Less than the rest of the length by a few roundings, so that the sum is within the length.
        let enough = sub_down(length, moved) * (1.0 - 4.0 * f64::EPSILON);
        Self { diagonal: diagonal(&affine), affine, rule, moved, rounding, lengths, enough }
    }
}

impl LevelLattice {
    /// Whether every cell is near enough by its diagonal.
    pub fn is_within(&self, length: f64) -> bool {
        add_up(self.diagonal, self.moved) <= length
    }
}

/// The validity of a cell's bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellEvidence {
    /// It holds whatever cells are halved.
    Lasting,
    /// It holds for the current triangles.
    OfTriangles,
}

/// The proof for the cells of an octree.
pub(super) struct OctreeProof<'a> {
    pub surface: &'a OctreeSurface<'a>,
    pub levels: &'a [LevelLattice],
    /// The goal for the bound.
    pub length: f64,
}

/// The kind of a cell beside cells of its size: its triangles and the interpolant in it depend on this alone, except for
/// their position. It is its level, the values at its corners, less the surface's level, as bits, and its capped borders,
/// one bit for each of six.
pub(super) type OctreeCellKind = (u8, [u64; 8], u8);

/// Below this fraction of the diagonal no cell is cut up: `CellProver` does not go further.
const FINE: f64 = 1.0 / 32.0;

impl OctreeProof<'_> {
    fn lattice(&self, cell: OctreeCell) -> &LevelLattice {
        &self.levels[usize::from(cell.level)]
    }

    /// A bound by rows of cells, or else by the diagonal, for vertices as written.
    pub fn lasting_bound(&self, cell: OctreeCell, values: &[f64; 8]) -> f64 {
        let lattice = self.lattice(cell);
        let mut most = add_up(lattice.diagonal, lattice.moved);
        let cells = self.surface.source.size().map(|n| ((n - 1) << cell.level) as u32);
        for axis in (0..3).filter(|axis| cell.at[*axis] > 0 && cell.at[*axis] + 1 < cells[*axis]) {
            if most > self.length {
                most = lesser(self.row_bound(cell, values, axis), most);
            }
        }
        most
    }

    fn row_bound(&self, cell: OctreeCell, values: &[f64; 8], axis: usize) -> f64 {
        let surface = self.surface;
        let level = surface.rule.level;
        let low = LOW[axis];
        let mut moved = self.lattice(cell).moved;
        let mut beside = [0.0; 2];
        // The four corners in each of the four planes across the row.
        let mut planes = [[0.0; 4]; 4];
        planes[1] = low.map(|c| values[c] - level);
        planes[2] = low.map(|c| values[c + (1 << axis)] - level);
        for end in 0..2 {
            let mut next = cell;
            next.at[axis] = if end == 0 { cell.at[axis] - 1 } else { cell.at[axis] + 1 };
            let there = surface.values(next);
            planes[3 * end] = low.map(|c| there[c + (end << axis)] - level);
            let around = surface.halved.leaf_around(next);
            // The neighbour is a part of a larger leaf, whose triangles count.
            if around.level < cell.level {
                beside[end] = largest_on_triangles(&surface.values(around), surface.slack);
                moved = greater(self.lattice(around).moved, moved);
            }
        }
        // The kernel adds twice the error of a value; mixed differences and vertices have four times it.
        let shift = shift(&planes, beside, 2.0 * surface.slack);
        add_up(mul_up(shift, self.lattice(cell).lengths[axis]), moved)
    }

    /// Whether cutting up may show that a cell is near enough.
    pub fn may_cut(&self, cell: OctreeCell) -> bool {
        let lattice = self.lattice(cell);
        lattice.enough >= FINE * lattice.diagonal
    }

    /// A bound by the triangles of a cell and of the cells around it, if it is near enough.
    pub fn bound_if_near(&self, cell: OctreeCell) -> Option<f64> {
        let lattice = self.lattice(cell);
        self.bound_within(cell, lattice.enough).filter(|most| *most <= self.length)
    }

    /// A bound by the triangles of a cell and of the cells around it, for vertices as written; the aim is in exact coordinates.
    pub fn bound_within(&self, cell: OctreeCell, aim: f64) -> Option<f64> {
        let lattice = self.lattice(cell);
        self.with_prover(cell, |prover| {
            let far = prover.cell_distance(cell.index(), aim);
            (far < lattice.diagonal).then(|| add_up(far, lattice.moved))
        })
    }

    /// A lower bound of the distance, in a cell.
    pub fn witness(&self, cell: OctreeCell, known: f64) -> Option<(f64, [f64; 3])> {
        self.with_prover(cell, |prover| prover.witness(cell.index(), known))
    }

    fn with_prover<T>(&self, cell: OctreeCell, work: impl FnOnce(&CellProver<'_>) -> T) -> T {
        let lattice = self.lattice(cell);
        let surface = self.surface;
        let source =
            HalvedLattice { coarse: surface.source, rule: surface.rule, level: u32::from(cell.level) };
        work(&CellProver {
            source: &source,
            rule: &lattice.rule,
            affine: &lattice.affine,
            diagonal: lattice.diagonal,
            moved: lattice.moved,
            rounding: lattice.rounding,
            slack: surface.slack,
            gives_up: true,
            octree: Some(OctreeLevel { surface, level: cell.level }),
        })
    }

    /// The kind of a cell beside cells of its size alone.
    pub fn kind(&self, cell: OctreeCell) -> Option<OctreeCellKind> {
        let surface = self.surface;
        if !surface.is_ordinary(cell) {
            return None;
        }
        let mut capped = 0;
        for (axis, ends) in surface.rule.border.iter().enumerate() {
            let last = ((surface.source.size()[axis] - 1) << cell.level) as u32 - 1;
            let is_there = [cell.at[axis] == 0, cell.at[axis] == last];
            for end in (0..2).filter(|end| is_there[*end] && ends[*end] == Border::Capped) {
                capped |= 1 << (2 * axis + end);
            }
        }
        let values = surface.values(cell).map(|value| (value - surface.rule.level).to_bits());
        Some((cell.level, values, capped))
    }

    /// The bound of all cells of a kind, by one cell in a separate lattice, if it is near enough: see `bound.rs`.
    pub fn bound_of_kind(&self, (level, corners, capped): &OctreeCellKind) -> Option<f64> {
        let lattice = &self.levels[usize::from(*level)];
        let border = [0, 1, 2].map(|k| {
            [0, 1].map(|end| if capped >> (2 * k + end) & 1 == 1 { Border::Capped } else { Border::Open })
        });
        let rule = Polygonize { border, offset: [0; 3], level: 0.0, ..lattice.rule };
        let values = corners.map(f64::from_bits);
        let source = DenseSamples { values: &values, size: [2; 3], rule };
        let affine = Affine3::new(lattice.affine.rows().map(|[a, b, c, _]| [a, b, c, 0.0])).ok()?;
        let prover = CellProver {
            source: &source,
            rule: &rule,
            affine: &affine,
            diagonal: lattice.diagonal,
            moved: lattice.moved,
            rounding: lattice.rounding,
            slack: self.surface.slack,
            gives_up: true,
            octree: None,
        };
        // The roundings of triangles in the whole lattice differ from those in this one.
        let others = mul_up(2.0, lattice.rounding);
        let far = add_up(prover.cell_distance([0; 3], sub_down(lattice.enough, others)), others);
        Some(add_up(far, lattice.moved)).filter(|most| *most <= self.length)
    }

    /// A bound of every cell of a level.
    pub fn diagonal_bound(&self, cell: OctreeCell) -> f64 {
        add_up(self.lattice(cell).diagonal, self.lattice(cell).moved)
    }
}
