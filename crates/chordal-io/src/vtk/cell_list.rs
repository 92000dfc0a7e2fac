//! `CellList`: the cells of a file as lists of points, in the several forms of files.
use super::number_array::NumberArray;
use crate::grow::push;
use crate::text::grouped;
use crate::{FileLocation, ReadError};

/// How the end of each cell in the list of points is stored.
#[derive(Clone, Debug)]
pub(super) enum CellEnds<'a> {
    /// The number of points precedes the points of each cell.
    Counted,
    /// The end of each cell.
    Ends(NumberArray<'a>),
    /// The start of each cell, then the end of the last.
    Starts(NumberArray<'a>),
}

/// The cells in order.
#[derive(Clone, Debug)]
pub(super) struct CellList<'a> {
    points: NumberArray<'a>,
    ends: CellEnds<'a>,
    /// The index of the next cell, the index of the first one in the file, and the position in the list of
    /// points.
    row: u64,
    first: u64,
    at: usize,
}

impl<'a> CellList<'a> {
    /// A list of cells; its first cell is the `first` of the file.
    pub(super) fn new(points: NumberArray<'a>, ends: CellEnds<'a>, first: u64) -> Self {
        Self { points, ends, row: 0, first, at: 0 }
    }

    /// Sets the index of the first cell, once it is known.
    pub(super) fn start_at(&mut self, first: u64) {
        self.first = first;
    }

    /// An error at the next cell.
    pub(super) fn error(&self, code: &'static str, message: String) -> ReadError {
        let row = self.first + self.row;
        ReadError::new(code, FileLocation::Row { list: "cell", row }, message)
    }

    /// The points of the next cell, which must be below `n_points`.
    ///
    /// # Errors
    /// If its end is before its start or beyond the list, or a point does not exist.
    #[inline]
    pub(super) fn next(&mut self, n_points: usize, corners: &mut Vec<u32>) -> Result<(), ReadError> {
        corners.clear();
        let end = self.end()?;
        for i in self.at..end {
            let index = self.points.integer(i);
            match index {
                Some(index) if index >= 0 && (index as u64) < n_points as u64 => push(corners, index as u32)?,
                _ => {
                    let shown = index.map_or_else(|| "beyond 64 bits".to_owned(), |index| index.to_string());
                    let n = grouped(n_points as u64);
                    let message = format!("index {shown} is out of range: there are {n} points, from 0");
                    return Err(self.error("index-out-of-range", message));
                }
            }
        }
        (self.at, self.row) = (end, self.row + 1);
        Ok(())
    }

    /// The points of the next cell if it is a triangle of points below `n_points`; other cells stay unread.
    #[inline]
    pub(super) fn next_triangle(&mut self, n_points: usize) -> Option<[u32; 3]> {
        let row = self.row as usize;
        let CellEnds::Ends(ends) = &self.ends else { return None };
        if row >= ends.len()
            || self.points.len() - self.at < 3
            || ends.integer(row) != Some(self.at as i64 + 3)
        {
            return None;
        }
        let [a, b, c] = self.points.three_integers(self.at)?;
        let is_there = |index: i64| index >= 0 && (index as u64) < n_points as u64;
        if !(is_there(a) && is_there(b) && is_there(c)) {
            return None;
        }
        (self.at, self.row) = (self.at + 3, self.row + 1);
        Some([a as u32, b as u32, c as u32])
    }

    /// The end of the next cell in the list of points; its start is `at`.
    #[inline]
    fn end(&mut self) -> Result<usize, ReadError> {
        let row = self.row as usize;
        let n = self.points.len();
        // The cells a b c and d e f g in the three forms:
        //
        //      counted   3 a b c 4 d e f g
        //      ends      a b c d e f g       3 7
        //      starts    a b c d e f g       0 3 7
        let end = match &self.ends {
            CellEnds::Counted if self.at < n => {
                let count = self.points.integer(self.at);
                self.at += 1;
                count.and_then(|count| (self.at as i64).checked_add(count))
            }
            CellEnds::Ends(ends) if row < ends.len() => ends.integer(row),
            CellEnds::Starts(starts) if row + 1 < starts.len() => {
                if row == 0 && starts.integer(0) != Some(0) {
                    return Err(self.error("bad-offset", "the first cell does not start at 0".to_owned()));
                }
                starts.integer(row + 1)
            }
            _ => return Err(self.error("truncated", "the list of cells ends before this one".to_owned())),
        };
        match end.and_then(|end| usize::try_from(end).ok()) {
            Some(end) if end >= self.at && end <= n => Ok(end),
            _ => {
                let shown = end.map_or_else(|| "beyond 64 bits".to_owned(), |end| end.to_string());
                let message = format!(
                    "the cell ends at {shown} in its list of points, outside {} to {}",
                    grouped(self.at as u64),
                    grouped(n as u64)
                );
                Err(self.error("bad-offset", message))
            }
        }
    }

    /// The count of numbers in the list after the last cell that was read.
    pub(super) fn n_left(&self) -> u64 {
        (self.points.len() - self.at) as u64
    }
}
