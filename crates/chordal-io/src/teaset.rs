//! Newell's teaset text: patches as sixteen indices from 1, then the points, all separated by commas.
use crate::grow::{push, with_room};
use crate::text::{IntegerError, TextLines, finite, grouped, integer, show, text_of, trim};
use crate::warnings::Warnings;
use crate::{Axis, Content, FileLocation, Frame, Limits, ReadError, ReadOutcome};
use chordal::Patch;

/// Reads the patches of a file of the 1991 teaset: the number of patches, a line of sixteen indices for each,
/// the number of points, a line `x,y,z` for each. Indices start at 1. Z is up, as in the teaset.
///
/// # Errors
/// [`ReadError`] at the line, for a wrong number of values, an index out of range, or a coordinate that is
/// not finite.
///
/// ```
/// use chordal_io::{Content, Limits, teaset};
/// let file = b"1\n1,1,1,1,1,1,1,1,2,2,2,2,2,2,2,2\n2\n0,0,0\n1.5,0,0\n";
/// let Content::Patches(patches, _) = teaset::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(patches[0].control[3][3], [1.5, 0.0, 0.0]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut rows = NonBlankLines { lines: TextLines::new(text_of(bytes)?), line: 1, limit: limits.rows };
    let mut warnings = Warnings::default();
    let mut rows_of_patches: Vec<(u64, [u32; 16])> = Vec::new();
    for row in 0..rows.count("patches")? {
        let indices = rows.row(|| format!("patch {row}"), index)?;
        push(&mut rows_of_patches, (rows.line, indices))?;
    }
    let n_points = rows.count("points")?;
    let mut points: Vec<[f64; 3]> = Vec::new();
    for row in 0..n_points {
        let point =
            rows.row(|| format!("point {}", row + 1), |token, place| finite(token, || place.clone()))?;
        push(&mut points, point)?;
    }
    while let Some(text) = rows.next() {
        let sentence = format!("lines after the last point, {} first", show(text));
        warnings.count("trailing-text", || (FileLocation::Line(rows.line), sentence));
    }
    // Points come after the patches, so indices can be looked up only now.
    let mut patches = with_room(rows_of_patches.len())?;
    for (line, indices) in &rows_of_patches {
        patches.push(patch(*line, indices, &points)?);
    }
    crate::assemble::check_patches(&patches, &mut warnings)?;
    let frame = Frame { up: Some(Axis::Z), metres_per_unit: None, ..Frame::default() };
    Ok(ReadOutcome { content: Content::Patches(patches, frame), warnings: warnings.into_list() })
}

/// Whether the text begins with a line that holds only a number, then indices with commas.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    let mut lines = TextLines::new(text).map(|(_, line)| trim(line)).filter(|line| !line.is_empty());
    let (Some(first), Some(second)) = (lines.next(), lines.next()) else { return false };
    let is_index = |token: &[u8]| integer(trim(token)).is_ok();
    integer(first).is_ok() && second.contains(&b',') && second.split(|b| *b == b',').all(is_index)
}

fn patch(line: u64, indices: &[u32; 16], points: &[[f64; 3]]) -> Result<Patch, ReadError> {
    let mut control = [[[0.0; 3]; 4]; 4];
    for (corner, &index) in control.as_flattened_mut().iter_mut().zip(indices) {
        *corner = *points.get(index as usize - 1).ok_or_else(|| {
            let n = grouped(points.len() as u64);
            let message = format!("index {index} is out of range: there are {n} points");
            ReadError::new("index-out-of-range", FileLocation::Line(line), message)
        })?;
    }
    Ok(Patch { control })
}

/// An index from 1.
fn index(token: &[u8], place: FileLocation) -> Result<u32, ReadError> {
    let shown = show(token);
    let (code, message) = match integer(token).map(u32::try_from) {
        Ok(Ok(0)) => ("index-out-of-range", "index 0: indices start at 1".to_owned()),
        Ok(Ok(index)) => return Ok(index),
        Err(IntegerError::Spelling) => ("not-an-index", format!("{shown} is not an index")),
        _ => ("index-out-of-range", format!("index {shown} is out of range: from 1 to 4,294,967,295")),
    };
    Err(ReadError::new(code, place, message))
}

/// Lines that are not blank.
struct NonBlankLines<'a> {
    lines: TextLines<'a>,
    line: u64,
    limit: u64,
}

impl<'a> NonBlankLines<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            let (line, text) = self.lines.next()?;
            self.line = line;
            if !trim(text).is_empty() {
                return Some(trim(text));
            }
        }
    }

    fn expect(&mut self, what: impl Fn() -> String) -> Result<&'a [u8], ReadError> {
        self.next().ok_or_else(|| {
            ReadError::new(
                "truncated",
                FileLocation::Line(self.line),
                format!("the file ends before {}", what()),
            )
        })
    }

    fn count(&mut self, what: &str) -> Result<u64, ReadError> {
        let text = self.expect(|| format!("the number of {what}"))?;
        let count = integer(text).ok().and_then(|count| u64::try_from(count).ok()).ok_or_else(|| {
            let message = format!("{} is not a number of {what}", show(text));
            ReadError::new("not-a-count", FileLocation::Line(self.line), message)
        })?;
        if count > self.limit {
            return Err(crate::assemble::too_many_rows(
                FileLocation::Line(self.line),
                what,
                count,
                self.limit,
            ));
        }
        Ok(count)
    }

    /// Parses a line of exactly `N` values with commas between them.
    fn row<T: Default + Copy, const N: usize>(
        &mut self,
        what: impl Fn() -> String,
        value: impl Fn(&[u8], FileLocation) -> Result<T, ReadError>,
    ) -> Result<[T; N], ReadError> {
        let text = self.expect(&what)?;
        let n_values = text.split(|b| *b == b',').count();
        if n_values != N {
            let message =
                format!("{} has {n_values} values with commas between them where {N} are needed", what());
            return Err(ReadError::new("wrong-width", FileLocation::Line(self.line), message));
        }
        let mut values = [T::default(); N];
        for (slot, token) in values.iter_mut().zip(text.split(|b| *b == b',')) {
            *slot = value(trim(token), FileLocation::Line(self.line))?;
        }
        Ok(values)
    }
}
