//! `MaskCells`: bounds for the distance of the triangles of a mask's cells from the interpolant's surface.
//!
//! Samples of a mask are 0 or 1, and its level is ½. So the interpolant of a cell and its triangles follow from the sides
//! of its corners alone: there are 254 kinds with both sides, and as many again at each of six capped borders. Each kind
//! that occurs is proved once (`cell_prover.rs`), in a lattice of that one cell, open except for that one border.
//!
//! **Proof for every cell.** A point of S in a cell, or in one of its squares in capped borders, is within the kind's
//! bound of triangles of the cell and of that square, and the whole mesh has these. A point of these triangles is within
//! the bound of a point of the single cell's S. This is a vertex, or a point between two points that are on different
//! sides for certain, both in the cell, or one in the cell and one beyond the capped border. So it is a point of the
//! whole S. A cell at several capped borders has the bound of the kind for each border; for its other triangles and
//! points any of these bounds holds. A cell with all corners inside has only whole squares of capped borders, which are
//! in both the mesh and S.
use super::cell_prover::CellProver;
use super::rule::{Border, Polygonize};
use super::source::DenseSamples;
use crate::budget::{Job, par_map};
use crate::implicit::Affine3;
use crate::math::{add_up, greater, lesser};

/// Kinds of cells: a bit for each of 256 sets of inside corners; for cells at no capped border, then for cells at the low
/// and the high border of each index.
#[derive(Clone, Debug, Default)]
pub(in crate::convert) struct MaskCells([[u64; 4]; 7]);

impl MaskCells {
    /// Adds a cell with these corners inside, at these ends of the lattice, low and high by index, as far as they are capped.
    pub fn add(&mut self, inside: u8, ends: [[bool; 2]; 3], border: [[Border; 2]; 3]) {
        let (word, bit) = (usize::from(inside / 64), 1 << (inside % 64));
        let mut is_capped = false;
        for (number, (is_there, border)) in ends.as_flattened().iter().zip(border.as_flattened()).enumerate()
        {
            if *is_there && *border == Border::Capped {
                self.0[1 + number][word] |= bit;
                is_capped = true;
            }
        }
        self.0[0][word] |= if is_capped { 0 } else { bit };
    }

    /// Adds the kinds of another mask.
    pub fn add_all(&mut self, other: &Self) {
        for (known, more) in self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()) {
            *known |= more;
        }
    }

    /// Each kind: the number of its capped border, 0 for none, and the corners that are inside.
    fn kinds(&self) -> impl Iterator<Item = (usize, u8)> + '_ {
        let has = |(border, inside): &(usize, u8)| {
            self.0[*border][usize::from(inside / 64)] >> (inside % 64) & 1 == 1
        };
        (0..7).flat_map(|border| (0..=255_u8).map(move |inside| (border, inside))).filter(has)
    }
}

/// The bound of each kind of cell; 0 for kinds that do not occur.
pub(in crate::convert) struct MaskCellBounds([[f64; 256]; 7]);

/// The first aim, as a fraction of the diagonal, and the factor by which it grows if it is out of reach. Chosen: the error
/// of one corner alone is 1/25 of the diagonal.
const FIRST_AIM: f64 = 1.0 / 24.0;
const NEXT_AIM: f64 = 1.1875;

impl MaskCellBounds {
    /// Proves the bounds of these kinds in a lattice of one cell around the origin; `errors` are the largest distance of
    /// vertices from their exact places, and the part of it that is rounding.
    pub fn new(
        cells: &MaskCells,
        affine: &Affine3,
        (diagonal, errors): (f64, (f64, f64)),
        job: &Job,
    ) -> Self {
        let kinds: Vec<(usize, u8)> = cells.kinds().collect();
        let distances = par_map(job, &kinds, |_, (border, inside)| {
            let mut borders = [[Border::Open; 2]; 3];
            if let Some(number) = border.checked_sub(1) {
                borders.as_flattened_mut()[number] = Border::Capped;
            }
            let rule = Polygonize { border: borders, ..Polygonize::above(0.5) };
            let values: [u8; 8] = std::array::from_fn(|c| inside >> c & 1);
            let source = DenseSamples { values: &values, size: [2; 3], rule };
            let (moved, rounding) = errors;
            let prover = CellProver {
                source: &source,
                rule: &rule,
                affine,
                diagonal,
                moved,
                rounding,
                slack: 0.0,
                gives_up: true,
                octree: None,
            };
            // A search gives up once it is beyond its aim, so that low aims are cheap to try first.
            let (mut most, mut aim) = (diagonal, FIRST_AIM * diagonal);
            while most > aim {
                most = lesser(prover.cell_distance([0; 3], aim), most);
                aim *= NEXT_AIM;
            }
            // From the rounded triangles of that lattice to the exact ones.
            lesser(add_up(most, moved), diagonal)
        });
        let mut bounds = [[0.0; 256]; 7];
        for ((border, inside), most) in kinds.into_iter().zip(distances) {
            bounds[border][usize::from(inside)] = most;
        }
        Self(bounds)
    }

    /// The largest bound of some of the kinds.
    pub fn largest(&self, cells: &MaskCells) -> f64 {
        cells.kinds().fold(0.0, |most, (border, inside)| greater(self.0[border][usize::from(inside)], most))
    }
}
