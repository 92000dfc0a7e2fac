//! Indices of OBJ: counted from 1, or backwards from -1, and checked against overflow.
use crate::text::{IntegerError, grouped, integer, show};
use crate::{FileLocation, ReadError};

/// The row, from 0, of an index: from 1 over all `total` rows of the file, or backwards from -1 over the
/// `before` rows before this line.
#[inline]
pub(super) fn index(
    line: u64,
    token: &[u8],
    [one, many]: [&str; 2],
    before: usize,
    total: usize,
) -> Result<u32, ReadError> {
    let row = match integer(token) {
        Ok(index) if index > 0 => Some(index.unsigned_abs() - 1).filter(|row| *row < total as u64),
        Ok(index) if index < 0 => (before as u64).checked_sub(index.unsigned_abs()),
        _ => None,
    };
    // The counts are below 2^32, see `ObjRowCounts::check`.
    row.and_then(|row| u32::try_from(row).ok()).ok_or_else(|| {
        let shown = show(token);
        let (code, message) = match integer(token) {
            Err(IntegerError::Spelling) => ("not-an-index", format!("{shown} is not an index of a {one}")),
            Ok(0) => ("index-out-of-range", format!("index 0 of a {one}: indices start at 1")),
            Ok(..0) => {
                let n = grouped(before as u64);
                (
                    "index-out-of-range",
                    format!("index {shown} is out of range: {n} {many} stand before this line"),
                )
            }
            _ => {
                let n = grouped(total as u64);
                ("index-out-of-range", format!("index {shown} is out of range: the file has {n} {many}"))
            }
        };
        ReadError::new(code, FileLocation::Line(line), message)
    })
}
