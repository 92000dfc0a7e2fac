//! Rows of a text PLY, many at once on the threads of a job: as far as every line is one row, spelled as programs
//! spell it. Where that ends the reader of single rows goes on; it says what is wrong, if anything is.
use super::header::{PlyElement, PlyPropertyType, PlyScalar};
use crate::ReadError;
use crate::grow::push;
use crate::plain_text::PlainCursor;
use chordal::Job;
use chordal::budget::par_map;
use std::num::NonZero;

/// The bytes of a part: long enough that starting one costs nothing, and short enough that what is read of it is
/// still in the cache when it is taken over.
pub(super) const PART_BYTES: usize = 256 << 10;

/// Rows of a part, one on each line.
#[derive(Debug, Default)]
pub(super) struct PlyTextRows {
    /// The numbers of all rows.
    pub values: Vec<f64>,
    /// Where each row ends in them.
    pub ends: Vec<u32>,
}

/// How many of some rows were taken over, and the bytes of their lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PlyTextProgress {
    pub n_rows: u64,
    pub n_bytes: usize,
}

/// Reads the rows of an element from the beginning of a text, as far as they are plain, and gives them in their
/// order to `take`, which returns how many it took. The list of a row is without its length.
pub(super) fn plain_rows(
    parts: &[&[u8]],
    element: &PlyElement,
    job: &Job,
    mut take: impl FnMut(&PlyTextRows) -> Result<u64, ReadError>,
) -> Result<PlyTextProgress, ReadError> {
    let mut progress = PlyTextProgress::default();
    let available = || std::thread::available_parallelism().map_or(1, NonZero::get);
    let n_threads = if job.threads == 0 { available() } else { job.threads };
    // Enough parts for all threads to end at nearly the same time; what was read of them is kept until then.
    for wave in parts.chunks(4 * n_threads) {
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

/// The rows from the beginning of a part to the first line that is none, or not plain.
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
            let whole = i64::from(cursor.whole()?);
            (low <= whole && whole <= high && cursor.is_at_end()).then_some(whole as f64)
        }
        (PlyScalar::Opaque(_), None) => None,
        (_, None) => cursor.number(),
    }
}

#[cfg(test)]
mod tests {
    use crate::Limits;
    use crate::ply::read::read_in_parts;
    use chordal_testkit::Random;

    const HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 40\nproperty float x\nproperty uchar c\n\
                        property double y\nproperty float z\nelement face 30\nproperty list uchar int vertex_indices\nend_header\n";

    fn random_text(random: &mut Random, n_odd: usize) -> Vec<u8> {
        let mut lines: Vec<String> = Vec::new();
        for _ in 0..40 {
            lines.push(format!(
                "{} {} {:e} {:.3}",
                random.below(9),
                random.below(256),
                random.signed(),
                random.signed()
            ));
        }
        for _ in 0..30 {
            let n = 3 + random.below(2);
            let corners: Vec<String> = (0..n).map(|_| random.below(40).to_string()).collect();
            lines.push(format!("{n} {}", corners.join(" ")));
        }
        let odd = [
            "",
            " ",
            "1 2 3",
            "1 2 3 4 5",
            "nan 1 2 3",
            "1 256 2 3",
            "1 -1 2 3",
            "x 1 2 3",
            "3 0 1 40",
            "3 0 1 -1",
            "2 0 1",
            "3 0 1 2 3",
            "4 0 1 2",
            "  3 0 1\t2 ",
            "+1 +2 3 4",
            "1e999 1 1 1",
            "3 0 1 2.0",
            "300 1 2",
        ];
        for _ in 0..n_odd {
            let at = random.below(lines.len());
            lines[at] = odd[random.below(odd.len())].to_owned();
        }
        let end = ["\n", "\r\n", "\r"][random.below(3)];
        let mut text = HEAD.as_bytes().to_vec();
        text.extend_from_slice((lines.join(end) + ["", end][random.below(2)]).as_bytes());
        text
    }

    #[test]
    fn plain_rows_read_as_row_by_row() {
        let mut random = Random::new(11);
        let (mut n_read, mut n_refused) = (0, 0);
        for i in 0..3000_usize {
            let text = random_text(&mut random, i % 4);
            let limits =
                Limits { drop_nonfinite: i % 2 == 0, rows: [500, 45][i % 9 / 8], ..Limits::default() };
            let plain = format!("{:?}", read_in_parts(&text, &limits, None));
            let size = 1 + random.below(200);
            let in_parts = Limits { threads: 1 + i % 3, ..limits };
            let fast = format!("{:?}", read_in_parts(&text, &in_parts, Some(size)));
            assert_eq!(fast, plain, "{size} bytes a part: {}", text.escape_ascii());
            n_read += usize::from(fast.starts_with("Ok"));
            n_refused += usize::from(!fast.starts_with("Ok"));
        }
        assert!(n_read > 500 && n_refused > 500, "{n_read} read, {n_refused} refused");
    }
}
