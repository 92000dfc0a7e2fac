//! Rows of a text PLY, parsed in parallel on the threads of a job, as long as every line is one row in the
//! usual spelling. After that, the reader of single rows continues and reports any error.
use super::header::{PlyElement, PlyPropertyType, PlyScalar};
use crate::ReadError;
use crate::grow::push;
use crate::plain_text::{PlainCursor, parts_at_once};
use chordal::Job;
use chordal::budget::par_map;

/// The bytes of a part. Chosen: long enough that starting one costs nothing, and short enough that its parsed
/// data is still in the cache when it is merged.
pub(super) const PART_BYTES: usize = 256 << 10;

/// Rows of a part, one on each line.
#[derive(Debug, Default)]
pub(super) struct PlyTextRows {
    /// The numbers of all rows.
    pub values: Vec<f64>,
    /// The end of each row in `values`.
    pub ends: Vec<u32>,
}

/// The number of rows that were merged, and the bytes of their lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PlyTextProgress {
    pub n_rows: u64,
    pub n_bytes: usize,
}

/// Reads the plain rows of an element from the beginning of a text, and passes them in order to `take`, which
/// returns how many it accepted. Lists are passed without their length.
pub(super) fn plain_rows(
    parts: &[&[u8]],
    element: &PlyElement,
    job: &Job,
    mut take: impl FnMut(&PlyTextRows) -> Result<u64, ReadError>,
) -> Result<PlyTextProgress, ReadError> {
    let mut progress = PlyTextProgress::default();
    for wave in parts.chunks(parts_at_once(job.threads)) {
        for (part, rows) in wave.iter().zip(par_map(job, wave, |_, part| rows_of(part, element))) {
            let mut rows = rows?;
            let left = usize::try_from(element.rows - progress.n_rows).unwrap_or(usize::MAX);
            rows.ends.truncate(left);
            let n_taken = take(&rows)?;
            progress.n_rows += n_taken;
            let n_bytes = bytes_of_lines(part, n_taken);
            progress.n_bytes += n_bytes;
            if n_bytes < part.len() {
                return Ok(progress);
            }
        }
    }
    Ok(progress)
}

/// The bytes of the first lines of a text.
fn bytes_of_lines(text: &[u8], n_lines: u64) -> usize {
    let mut cursor = PlainCursor { text, at: 0 };
    (0..n_lines).for_each(|_| cursor.skip_line());
    cursor.at
}

/// The rows from the beginning of a part to the first line that is not a plain row.
fn rows_of(text: &[u8], element: &PlyElement) -> Result<PlyTextRows, ReadError> {
    let mut rows = PlyTextRows::default();
    let mut cursor = PlainCursor { text, at: 0 };
    while cursor.at < text.len() {
        let before = rows.values.len();
        let is_plain = row(&mut cursor, element, &mut rows.values)?;
        let end = u32::try_from(rows.values.len()).ok().filter(|_| is_plain);
        let Some(end) = end else {
            rows.values.truncate(before);
            break;
        };
        push(&mut rows.ends, end)?;
    }
    Ok(rows)
}

/// Reads a row and its line. Returns whether it was plain.
#[inline]
fn row(cursor: &mut PlainCursor, element: &PlyElement, values: &mut Vec<f64>) -> Result<bool, ReadError> {
    for property in &element.properties {
        match property.shape {
            PlyPropertyType::One(scalar) => match value(cursor, scalar) {
                Some(value) => push(values, value)?,
                None => return Ok(false),
            },
            PlyPropertyType::List { length, item } => {
                let Some(n) = value(cursor, length).filter(|n| *n >= 0.0) else { return Ok(false) };
                for _ in 0..n as u64 {
                    match value(cursor, item) {
                        Some(value) => push(values, value)?,
                        None => return Ok(false),
                    }
                }
            }
        }
    }
    Ok(cursor.end_line().is_some())
}

#[inline]
fn value(cursor: &mut PlainCursor, scalar: PlyScalar) -> Option<f64> {
    match (scalar, scalar.range()) {
        (_, Some((low, high))) => {
            cursor.skip_blanks();
            let value = i64::from(cursor.integer()?);
            (low <= value && value <= high && cursor.is_at_end()).then_some(value as f64)
        }
        (PlyScalar::Opaque(_), None) => None,
        (_, None) => cursor.number(),
    }
}
