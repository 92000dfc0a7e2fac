//! `VtkSurface`: the triangles of cells, each with the index of its cell.
use super::cell_list::CellList;
use super::cell_types::{CellShape, shape, title};
use crate::assemble::too_many_rows;
use crate::faces::{Faces, SHORT_FACES};
use crate::grow::{out_of_memory, push, push_many};
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use std::collections::BTreeMap;

/// The numbers of skipped and flattened cells in a file, by type.
#[derive(Debug, Default)]
pub(super) struct CellCounts {
    left_out: BTreeMap<u8, u64>,
    curved: BTreeMap<u8, u64>,
    n_surface: u64,
}

impl CellCounts {
    /// Warns about skipped cells.
    ///
    /// # Errors
    /// `no-surface` if all cells were skipped.
    pub(super) fn finish(self, warnings: &mut Warnings) -> Result<(), ReadError> {
        let total = |counts: &BTreeMap<u8, u64>| counts.values().fold(0_u64, |sum, n| sum.saturating_add(*n));
        let list = |counts: &BTreeMap<u8, u64>| {
            let each = counts.iter().map(|(kind, n)| format!("{} {}", grouped(*n), title(*kind)));
            each.collect::<Vec<_>>().join(", ")
        };
        if self.n_surface == 0 && !self.left_out.is_empty() {
            let message = format!(
                "the file has no cell that is a surface (triangle, quad, polygon, strip), only: {}",
                list(&self.left_out)
            );
            return Err(ReadError::new("no-surface", FileLocation::File, message));
        }
        warnings.count_many("cells-left-out", total(&self.left_out), || {
            let message = format!("cells that are no surface were left out: {}", list(&self.left_out));
            (FileLocation::File, message)
        });
        warnings.count_many("curved-cells", total(&self.curved), || {
            let message =
                format!("curved cells were read as flat ones over their corners: {}", list(&self.curved));
            (FileLocation::File, message)
        });
        Ok(())
    }
}

/// The triangles of one piece.
#[derive(Debug, Default)]
pub(super) struct VtkSurface {
    pub faces: Faces,
    /// The cell of each triangle.
    pub cells: Vec<u32>,
    n_stitches: u64,
    n_from_strips: u64,
    corners: Vec<u32>,
}

impl VtkSurface {
    /// Reads `kinds` cells of a list, whose points must be below `n_points`. The first of them is cell
    /// `first` of the piece.
    ///
    /// # Errors
    /// Errors of the list, or too many triangles.
    pub(super) fn read(
        &mut self,
        list: &mut CellList<'_>,
        kinds: impl IntoIterator<Item = u8>,
        scope: &mut CellScope<'_>,
    ) -> Result<(), ReadError> {
        let mut corners = std::mem::take(&mut self.corners);
        let kinds = kinds.into_iter();
        // A triangle takes three points of the list.
        let most = kinds.size_hint().0.min(list.n_left() as usize / 3);
        self.faces.reserve(most)?;
        self.cells.try_reserve_exact(most).map_err(|_| out_of_memory(most))?;
        for kind in kinds {
            // A fast path, since most cells are triangles.
            let triangle =
                if shape(kind) == CellShape::Polygon { list.next_triangle(scope.n_points) } else { None };
            if let Some(triangle) = triangle {
                scope.counts.n_surface += 1;
                self.faces.push(&triangle, scope.cell)?;
                push(&mut self.cells, scope.cell as u32)?;
            } else {
                list.next(scope.n_points, &mut corners)?;
                self.cell(kind, &mut corners, scope)?;
            }
            scope.cell += 1;
            let n = self.faces.n_triangles() as u64;
            if n > scope.limits.rows {
                let place = FileLocation::Row { list: "cell", row: scope.cell };
                return Err(too_many_rows(place, "triangles", n, scope.limits.rows));
            }
        }
        self.corners = corners;
        Ok(())
    }

    #[inline]
    fn cell(&mut self, kind: u8, corners: &mut Vec<u32>, scope: &mut CellScope<'_>) -> Result<(), ReadError> {
        let shape = shape(kind);
        if shape == CellShape::LeftOut {
            *scope.counts.left_out.entry(kind).or_default() += 1;
            return Ok(());
        }
        scope.counts.n_surface += 1;
        match shape {
            CellShape::Strip => return self.strip(corners, scope.cell),
            // The corners of a pixel run row by row, not around it.
            CellShape::Pixel if corners.len() == 4 => corners.swap(2, 3),
            // Corners come first, then the points on curved edges, which are left out.
            CellShape::Curved(n) => corners.truncate(n),
            CellShape::CurvedHalf => corners.truncate(corners.len() / 2),
            _ => {}
        }
        if matches!(shape, CellShape::Curved(_) | CellShape::CurvedHalf) {
            *scope.counts.curved.entry(kind).or_default() += 1;
        }
        if corners.len() < 3 {
            let row = scope.cell;
            scope
                .warnings
                .count("short-faces", || (FileLocation::Row { list: "cell", row }, SHORT_FACES.to_owned()));
            return Ok(());
        }
        let before = self.faces.n_triangles();
        self.faces.push(corners, scope.cell)?;
        push_many(&mut self.cells, scope.cell as u32, self.faces.n_triangles() - before)
    }

    fn strip(&mut self, corners: &[u32], cell: u64) -> Result<(), ReadError> {
        for (i, triple) in corners.windows(3).enumerate() {
            let [a, b, c] = [triple[0], triple[1], triple[2]];
            if a == b || b == c || c == a {
                self.n_stitches += 1;
                continue;
            }
            // Every second triangle of a strip has the opposite orientation.
            self.faces.push(&if i % 2 == 0 { [a, b, c] } else { [b, a, c] }, cell)?;
            push(&mut self.cells, cell as u32)?;
            self.n_from_strips += 1;
        }
        Ok(())
    }

    /// Warns about changes to strips.
    pub(super) fn count_strips(&self, warnings: &mut Warnings) {
        warnings.count_all("strips-cut", self.n_from_strips, "triangles were read from strips");
        let message = "triangles of strips that only lead to the next place were dropped";
        warnings.count_all("strip-stitches", self.n_stitches, message);
    }
}

/// The context in which cells are read.
pub(super) struct CellScope<'s> {
    pub n_points: usize,
    /// The index of the next cell of the piece.
    pub cell: u64,
    pub counts: &'s mut CellCounts,
    pub warnings: &'s mut Warnings,
    pub limits: &'s Limits,
}
