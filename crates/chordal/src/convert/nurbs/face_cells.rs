//! `FaceCells`: a lattice of patches, each cut into rows and columns of cells of its own.
//!
//! A point on a line belongs to the cells on both sides of it. If neighbouring patches have different lines, a cell has
//! corners of other cells on its sides.
use crate::math::{greater, lesser};

/// Coordinates nearer to a line than this, in units of a patch, are moved onto it: slivers show nothing. Chosen: too
/// small to be seen, and above rounding. The move counts in the bound.
const NEAR_LINE: f64 = 1e-10;

/// The lines within all patches, in coordinates of the lattice.
pub(super) struct FaceCells {
    /// Numbers of columns and rows of patches.
    pub n: [usize; 2],
    /// By patch, row by row: its numbers of columns and rows of cells.
    parts: Vec<[usize; 2]>,
    /// By patch: the number of cells in the patches before; at the end, the number of all cells.
    first: Vec<usize>,
}

/// A cell: its patch, and its column and row there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FaceCell {
    pub patch: usize,
    at: [usize; 2],
}

/// A rectangle, by direction: its two ends.
pub(super) type Rectangle = [[f64; 2]; 2];

impl FaceCells {
    pub fn new(n: [usize; 2], parts: Vec<[usize; 2]>) -> Self {
        let mut first = Vec::with_capacity(parts.len() + 1);
        let mut sum: usize = 0;
        for [a, b] in &parts {
            first.push(sum);
            sum = sum.saturating_add(a.saturating_mul(*b));
        }
        first.push(sum);
        Self { n, parts, first }
    }

    pub fn count(&self) -> usize {
        self.first[self.parts.len()]
    }

    /// The number of a cell among all.
    pub fn index(&self, cell: FaceCell) -> usize {
        self.first[cell.patch] + cell.at[1] * self.parts[cell.patch][0] + cell.at[0]
    }

    pub fn all(&self) -> impl Iterator<Item = FaceCell> + '_ {
        self.parts.iter().enumerate().flat_map(|(patch, [a, b])| {
            (0..*b).flat_map(move |j| (0..*a).map(move |i| FaceCell { patch, at: [i, j] }))
        })
    }

    /// A line of a patch; whole numbers are patches' borders.
    fn line(&self, patch: usize, k: usize, i: usize) -> f64 {
        self.base(patch)[k] as f64 + i as f64 / self.parts[patch][k] as f64
    }

    /// The column and row of a patch.
    fn base(&self, patch: usize) -> [usize; 2] {
        [patch % self.n[0], patch / self.n[0]]
    }

    pub fn rectangle(&self, cell: FaceCell) -> Rectangle {
        [0, 1].map(|k| [0, 1].map(|end| self.line(cell.patch, k, cell.at[k] + end)))
    }

    /// The corners of a cell, counter-clockwise.
    pub fn corners(&self, cell: FaceCell) -> [[f64; 2]; 4] {
        let [[a, b], [c, d]] = self.rectangle(cell);
        [[a, c], [b, c], [b, d], [a, d]]
    }

    /// The first and the last column, or row, of patches whose closed range has a coordinate: one or two.
    fn patches_along(&self, k: usize, x: f64) -> [usize; 2] {
        let i = (x as usize).min(self.n[k] - 1);
        // A coordinate on a border belongs to the patches on both sides.
        [if x == i as f64 { i.saturating_sub(1) } else { i }, i]
    }

    /// The patches whose closed range has a point.
    fn patches_at(&self, at: [f64; 2]) -> impl Iterator<Item = usize> + use<> {
        let [[a, b], [c, d]] = [0, 1].map(|k| self.patches_along(k, at[k]));
        let columns = self.n[0];
        (c..=d).flat_map(move |j| (a..=b).map(move |i| j * columns + i))
    }

    /// The first and the last column, or row, of a patch's cells whose closed range has a coordinate: one or two.
    fn cells_along(&self, patch: usize, k: usize, x: f64) -> [usize; 2] {
        let n = self.parts[patch][k];
        let part = (x - self.base(patch)[k] as f64) * n as f64;
        let mut i = (part as usize).min(n - 1);
        // Rounding may miss by one.
        while i > 0 && x < self.line(patch, k, i) {
            i -= 1;
        }
        while i + 1 < n && x >= self.line(patch, k, i + 1) {
            i += 1;
        }
        [if i > 0 && x == self.line(patch, k, i) { i - 1 } else { i }, i]
    }

    /// The cells whose closed rectangle has a point.
    pub fn cells_at(&self, at: [f64; 2]) -> Vec<FaceCell> {
        let mut cells = Vec::new();
        for patch in self.patches_at(at) {
            let [[a, b], [c, d]] = [0, 1].map(|k| self.cells_along(patch, k, at[k]));
            cells.extend((c..=d).flat_map(|j| (a..=b).map(move |i| FaceCell { patch, at: [i, j] })));
        }
        cells
    }

    /// The cells that have both points.
    pub fn cells_of(&self, ends: [[f64; 2]; 2]) -> Vec<FaceCell> {
        let mut cells = self.cells_at(ends[0]);
        let other = self.cells_at(ends[1]);
        cells.retain(|cell| other.contains(cell));
        cells
    }

    /// The intersection of all cells with both points; none if there is no such cell.
    pub fn common_rectangle(&self, ends: [[f64; 2]; 2]) -> Option<Rectangle> {
        let rectangles = self.cells_of(ends).into_iter().map(|cell| self.rectangle(cell));
        rectangles.reduce(|a, b| [0, 1].map(|k| [greater(a[k][0], b[k][0]), lesser(a[k][1], b[k][1])]))
    }

    /// The point, moved onto near lines.
    pub fn snapped(&self, mut at: [f64; 2]) -> [f64; 2] {
        for x in &mut at {
            if (*x - x.round()).abs() < NEAR_LINE {
                *x = x.round();
            }
        }
        for k in 0..2 {
            for patch in self.patches_at(at) {
                let part = (at[k] - self.base(patch)[k] as f64) * self.parts[patch][k] as f64;
                let line = self.line(patch, k, part.round() as usize);
                if (at[k] - line).abs() < NEAR_LINE {
                    at[k] = line;
                    break;
                }
            }
        }
        at
    }

    /// A direction and a line across it, between two points without a common cell: the middle one of the borders of
    /// patches between them, or else of a patch's lines.
    pub fn line_between(&self, ends: [[f64; 2]; 2]) -> Option<(usize, f64)> {
        let range = |k: usize| {
            let [a, b] = ends.map(|end| end[k]);
            if a < b { (a, b) } else { (b, a) }
        };
        for k in 0..2 {
            let (low, high) = range(k);
            // The whole numbers strictly between the two.
            let between = low as usize + 1..high.ceil() as usize;
            if !between.is_empty() {
                return Some((k, ((between.start + between.end) / 2) as f64));
            }
        }
        let others: Vec<usize> = self.patches_at(ends[1]).collect();
        for patch in self.patches_at(ends[0]).filter(|patch| others.contains(patch)) {
            for k in 0..2 {
                let (low, high) = range(k);
                let [_, after] = self.cells_along(patch, k, low);
                let [before, _] = self.cells_along(patch, k, high);
                if after < before {
                    return Some((k, self.line(patch, k, (after + 1 + before) / 2)));
                }
            }
        }
        None
    }

    /// Whether two points are on one end of the lattice.
    pub fn is_end(&self, [a, b]: [[f64; 2]; 2]) -> bool {
        (0..2).any(|k| a[k] == b[k] && (a[k] == 0.0 || a[k] == self.n[k] as f64))
    }

    /// Visits the cells beside a cell, and `None` for each of its sides at the lattice's end.
    pub fn for_neighbours(&self, cell: FaceCell, mut visit: impl FnMut(Option<FaceCell>)) {
        // The direction of a side, and its end in the other direction.
        for (along, end) in [(0, 0), (1, 1), (0, 1), (1, 0)] {
            let across = 1 - along;
            let mut at = cell.at;
            if !self.is_on_border(cell, across, end) {
                at[across] = if end == 0 { at[across] - 1 } else { at[across] + 1 };
                visit(Some(FaceCell { patch: cell.patch, at }));
                continue;
            }
            let base = self.base(cell.patch)[across];
            if base == if end == 0 { 0 } else { self.n[across] - 1 } {
                visit(None);
                continue;
            }
            let step = [1, self.n[0]][across];
            let patch = if end == 0 { cell.patch - step } else { cell.patch + step };
            at[across] = if end == 0 { self.parts[patch][across] - 1 } else { 0 };
            let side = [0, 1].map(|end| self.line(cell.patch, along, cell.at[along] + end));
            // Cells that touch only an end of the side are left out.
            let [_, first] = self.cells_along(patch, along, side[0]);
            let [last, _] = self.cells_along(patch, along, side[1]);
            for i in first..=last {
                at[along] = i;
                visit(Some(FaceCell { patch, at }));
            }
        }
    }

    /// Whether a cell is the first or the last of its patch in a direction.
    fn is_on_border(&self, cell: FaceCell, k: usize, end: usize) -> bool {
        cell.at[k] == if end == 0 { 0 } else { self.parts[cell.patch][k] - 1 }
    }

    /// The corners of other cells on the sides of a cell.
    pub fn corners_on_sides(&self, cell: FaceCell) -> Vec<[f64; 2]> {
        let mut corners: Vec<[f64; 2]> = Vec::new();
        // The cells of one patch are a lattice: only beside another patch can corners lie within a side.
        if !(0..2).any(|k| (0..2).any(|end| self.is_on_border(cell, k, end))) {
            return corners;
        }
        let here = self.rectangle(cell);
        let is_within = |at: &[f64; 2]| {
            let is_between = |k: usize| here[k][0] < at[k] && at[k] < here[k][1];
            let is_on = |k: usize| at[k] == here[k][0] || at[k] == here[k][1];
            (is_between(0) && is_on(1)) || (is_between(1) && is_on(0))
        };
        self.for_neighbours(cell, |other| {
            let others = other.map(|other| self.corners(other));
            corners.extend(others.into_iter().flatten().filter(is_within));
        });
        corners.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        corners.dedup();
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two patches side by side, of 2 × 3 and of 4 × 2 cells.
    fn two() -> FaceCells {
        FaceCells::new([2, 1], vec![[2, 3], [4, 2]])
    }

    #[test]
    fn cells_beside_each_other_have_their_corners() {
        let cells = two();
        assert_eq!(cells.count(), 14);
        assert!(cells.all().enumerate().all(|(k, cell)| cells.index(cell) == k));
        // The left patch's upper right cell reaches from 2/3 to 1, the right one's cells from 0 to 1/2 and to 1.
        let cell = FaceCell { patch: 0, at: [1, 1] };
        assert_eq!(cells.corners_on_sides(cell), [[1.0, 0.5]]);
        let mut beside = Vec::new();
        cells.for_neighbours(cell, |other| beside.push(other));
        let place = |patch: usize, at: [usize; 2]| Some(FaceCell { patch, at });
        assert_eq!(
            beside,
            [place(0, [1, 0]), place(1, [0, 0]), place(1, [0, 1]), place(0, [1, 2]), place(0, [0, 1])]
        );
        assert_eq!(cells.cells_at([1.0, 0.5]).len(), 3);
        assert_eq!(cells.cells_at([0.5, 1.0 / 3.0]).len(), 4);
        assert!(cells.is_end([[2.0, 0.1], [2.0, 0.9]]) && !cells.is_end([[1.0, 0.1], [1.0, 0.9]]));
    }

    #[test]
    fn lines_are_found_between_points_without_a_common_cell() {
        let cells = two();
        assert_eq!(cells.line_between([[0.2, 0.1], [1.3, 0.1]]), Some((0, 1.0)));
        assert_eq!(cells.line_between([[1.0, 0.1], [0.2, 0.2]]), Some((0, 0.5)));
        assert_eq!(cells.line_between([[1.0, 0.0], [1.2, 0.5]]), None);
        // Along the border both patches' lines count.
        assert_eq!(cells.line_between([[1.0, 0.0], [1.0, 0.45]]), Some((1, 1.0 / 3.0)));
        assert_eq!(cells.line_between([[1.0, 1.0 / 3.0], [1.0, 0.6]]), Some((1, 0.5)));
        let common = cells.common_rectangle([[1.0, 1.0 / 3.0], [1.0, 0.5]]).unwrap();
        assert_eq!(common, [[1.0, 1.0], [1.0 / 3.0, 0.5]]);
        assert_eq!(cells.snapped([1.0 + 1e-12, 0.5 - 1e-12]), [1.0, 0.5]);
    }
}
