//! The body of a PLY file: a sequence of numbers, as text or binary.
use super::header::{PlyElement, PlyEncoding, PlyHeader, PlyPropertyType, PlyScalar};
use super::text_rows::{self, PlyTextRows};
use crate::plain_text::parts_of_lines;
use crate::text::{IntegerError, LineTokens, TextLines, grouped, integer, number, number_error, show, trim};
use crate::{FileLocation, ReadError};
use chordal::Job;

/// A cursor over the rows of a body.
pub(super) struct PlyBody<'a> {
    encoding: PlyEncoding,
    bytes: &'a [u8],
    /// The offset at which the body starts.
    body: usize,
    /// The offset of the next byte of a binary body.
    at: usize,
    lines: TextLines<'a>,
    first_line: u64,
    line: u64,
    tokens: LineTokens<'a>,
    row: u64,
    /// The bytes of a part of a text whose rows are parsed in parallel.
    part_bytes: Option<usize>,
}

type PlyResult<T> = Result<T, ReadError>;

impl<'a> PlyBody<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &PlyHeader, part_bytes: Option<usize>) -> Self {
        Self {
            encoding: header.encoding,
            bytes,
            body: header.body,
            at: header.body,
            lines: TextLines::new(&bytes[header.body..]),
            first_line: header.lines,
            line: header.lines,
            tokens: LineTokens::new(&[]),
            row: 0,
            part_bytes,
        }
    }

    /// The byte of the cursor, or in a text its line.
    pub(super) fn place(&self) -> FileLocation {
        match self.encoding {
            PlyEncoding::Text => FileLocation::Line(self.line),
            _ => FileLocation::Byte(self.at as u64),
        }
    }

    /// An error in the current row.
    pub(super) fn error(&self, element: &PlyElement, code: &'static str, message: &str) -> ReadError {
        ReadError::new(code, self.place(), format!("row {} of '{}': {message}", self.row, element.name))
    }

    /// Refuses an element with more rows than the file can hold, before any is read.
    pub(super) fn check_size(&self, element: &PlyElement) -> PlyResult<()> {
        let left = match self.encoding {
            PlyEncoding::Text => self.bytes.len() - self.body - self.lines.offset(),
            _ => self.bytes.len() - self.at,
        } as u64;
        let least = |shape: PlyPropertyType| match (self.encoding, shape) {
            // A digit and its separator; the last line of a file needs no line end.
            (PlyEncoding::Text, _) => 2,
            (_, PlyPropertyType::One(scalar)) => scalar.size(),
            (_, PlyPropertyType::List { length, .. }) => length.size(),
        };
        let row: u64 = element.properties.iter().map(|p| least(p.shape)).sum();
        let slack = u64::from(self.encoding == PlyEncoding::Text);
        match row.checked_mul(element.rows) {
            Some(needed) if needed <= left + slack => Ok(()),
            _ => {
                let message = format!(
                    "element '{}' has {} rows of at least {row} bytes, but only {} bytes follow",
                    element.name,
                    grouped(element.rows),
                    grouped(left)
                );
                Err(ReadError::new("truncated", self.place(), message))
            }
        }
    }

    /// Passes the first rows of an element to `take`, as long as they are plain and accepted, and returns how
    /// many were accepted; see [`text_rows`]. Zero for a binary body.
    pub(super) fn plain_rows(
        &mut self,
        element: &PlyElement,
        job: &Job,
        take: impl FnMut(&PlyTextRows) -> PlyResult<u64>,
    ) -> PlyResult<u64> {
        let Some(part_bytes) = self.part_bytes.filter(|_| self.encoding == PlyEncoding::Text) else {
            return Ok(0);
        };
        if element.properties.is_empty() {
            return Ok(0);
        }
        let text = &self.bytes[self.body + self.lines.offset()..];
        let parts = parts_of_lines(text, part_bytes, |_| false);
        let taken = text_rows::plain_rows(&parts, element, job, take)?;
        self.lines.advance(taken.n_bytes, taken.n_rows);
        if taken.n_rows > 0 {
            self.line = self.first_line + self.lines.n_lines();
            self.row = taken.n_rows - 1;
            self.tokens = LineTokens::new(&[]);
        }
        Ok(taken.n_rows)
    }

    /// Moves to row `row`. A text has one row on each line; blank lines are skipped.
    #[inline]
    pub(super) fn start_row(&mut self, element: &PlyElement, row: u64) -> PlyResult<()> {
        self.row = row;
        if self.encoding != PlyEncoding::Text {
            return Ok(());
        }
        loop {
            let Some((line, text)) = self.lines.next() else {
                return Err(self.error(element, "truncated", "the file ends before this row"));
            };
            self.line = self.first_line + line;
            self.tokens = LineTokens::new(text);
            if !self.tokens.rest().is_empty() {
                return Ok(());
            }
        }
    }

    /// Ends a row: in a text, nothing may follow on its line.
    #[inline]
    pub(super) fn end_row(&mut self, element: &PlyElement) -> PlyResult<()> {
        if self.encoding != PlyEncoding::Text {
            return Ok(());
        }
        match self.tokens.next() {
            None => Ok(()),
            Some(token) => {
                let message = format!("{} stands after the last value that the header declares", show(token));
                Err(self.error(element, "row-too-long", &message))
            }
        }
    }

    #[inline]
    fn token(&mut self, element: &PlyElement) -> PlyResult<&'a [u8]> {
        match self.tokens.next() {
            Some(token) => Ok(token),
            None => Err(self.error(
                element,
                "row-too-short",
                "the line has fewer values than the header declares",
            )),
        }
    }

    #[inline]
    fn take<const N: usize>(&mut self, element: &PlyElement) -> PlyResult<[u8; N]> {
        match self.bytes[self.at..].first_chunk::<N>() {
            Some(chunk) => {
                self.at += N;
                Ok(*chunk)
            }
            None => Err(self.error(element, "truncated", "the file ends inside this row")),
        }
    }

    /// Reads the next number; it may be NaN or infinite.
    #[inline]
    pub(super) fn number(&mut self, element: &PlyElement, scalar: PlyScalar) -> PlyResult<f64> {
        if scalar.range().is_some() {
            return self.integer(element, scalar).map(|value| value as f64);
        }
        match (self.encoding, scalar) {
            (PlyEncoding::Text, PlyScalar::Opaque(_)) => self.token(element).map(|_| 0.0),
            (PlyEncoding::Text, _) => {
                let token = self.token(element)?;
                number(token).ok_or_else(|| self.error(element, "not-a-number", &number_error(token)))
            }
            (PlyEncoding::Little, PlyScalar::F32) => Ok(f64::from(f32::from_le_bytes(self.take(element)?))),
            (PlyEncoding::Little, PlyScalar::F64) => Ok(f64::from_le_bytes(self.take(element)?)),
            (PlyEncoding::Big, PlyScalar::F32) => Ok(f64::from(f32::from_be_bytes(self.take(element)?))),
            (PlyEncoding::Big, PlyScalar::F64) => Ok(f64::from_be_bytes(self.take(element)?)),
            (_, opaque) => self.skip_bytes(element, opaque.size()).map(|()| 0.0),
        }
    }

    /// Reads the next number of an integer type.
    #[inline]
    pub(super) fn integer(&mut self, element: &PlyElement, scalar: PlyScalar) -> PlyResult<i64> {
        if self.encoding == PlyEncoding::Text {
            return self.text_integer(element, scalar);
        }
        let little = self.encoding == PlyEncoding::Little;
        Ok(match scalar {
            PlyScalar::I8 => i64::from(i8::from_le_bytes(self.take(element)?)),
            PlyScalar::U8 => i64::from(u8::from_le_bytes(self.take(element)?)),
            PlyScalar::I16 => {
                let bytes = self.take(element)?;
                i64::from(if little { i16::from_le_bytes(bytes) } else { i16::from_be_bytes(bytes) })
            }
            PlyScalar::U16 => {
                let bytes = self.take(element)?;
                i64::from(if little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) })
            }
            PlyScalar::I32 => {
                let bytes = self.take(element)?;
                i64::from(if little { i32::from_le_bytes(bytes) } else { i32::from_be_bytes(bytes) })
            }
            PlyScalar::U32 => {
                let bytes = self.take(element)?;
                i64::from(if little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
            }
            // The header allows only integer types here.
            PlyScalar::F32 | PlyScalar::F64 | PlyScalar::Opaque(_) => {
                return Err(self.error(element, "type-unknown", "an integer should stand here"));
            }
        })
    }

    fn text_integer(&mut self, element: &PlyElement, scalar: PlyScalar) -> PlyResult<i64> {
        let token = self.token(element)?;
        let (low, high) = scalar.range().unwrap_or((i64::MIN, i64::MAX));
        match integer(token) {
            Ok(value) if low <= value && value <= high => Ok(value),
            Err(IntegerError::Spelling) => {
                let message = format!("{} is not a whole number", show(token));
                Err(self.error(element, "not-a-number", &message))
            }
            _ => {
                let message = format!("{} is outside its type, {low} to {high}", show(token));
                Err(self.error(element, "value-out-of-range", &message))
            }
        }
    }

    /// Reads the length of a list, and checks that enough bytes follow.
    #[inline]
    pub(super) fn length(
        &mut self,
        element: &PlyElement,
        length: PlyScalar,
        item: PlyScalar,
    ) -> PlyResult<u64> {
        let n = self.integer(element, length)?;
        let Ok(n) = u64::try_from(n) else {
            return Err(self.error(element, "list-length", &format!("a list of length {n}")));
        };
        let left = match self.encoding {
            // Each item is at least a character and a space.
            PlyEncoding::Text => self.tokens.rest().len() as u64 / 2 + 1,
            _ => (self.bytes.len() - self.at) as u64 / item.size(),
        };
        if n > left {
            let message = format!("a list of {} values, but at most {} follow", grouped(n), grouped(left));
            return Err(self.error(element, "list-length", &message));
        }
        Ok(n)
    }

    fn skip_bytes(&mut self, element: &PlyElement, n: u64) -> PlyResult<()> {
        match usize::try_from(n)
            .ok()
            .and_then(|n| self.at.checked_add(n))
            .filter(|end| *end <= self.bytes.len())
        {
            Some(end) => {
                self.at = end;
                Ok(())
            }
            None => Err(self.error(element, "truncated", "the file ends inside this row")),
        }
    }

    /// Skips a property.
    pub(super) fn skip(&mut self, element: &PlyElement, shape: PlyPropertyType) -> PlyResult<()> {
        match shape {
            PlyPropertyType::One(scalar) => self.number(element, scalar).map(|_| ()),
            PlyPropertyType::List { length, item } => {
                let n = self.length(element, length, item)?;
                if self.encoding != PlyEncoding::Text {
                    // `length` checked that the product fits.
                    return self.skip_bytes(element, n * item.size());
                }
                (0..n).try_for_each(|_| self.token(element).map(|_| ()))
            }
        }
    }

    /// Skips all rows of an element.
    pub(super) fn skip_element(&mut self, element: &PlyElement) -> PlyResult<()> {
        let fixed = element.properties.iter().map(|p| match p.shape {
            PlyPropertyType::One(scalar) => Some(scalar.size()),
            PlyPropertyType::List { .. } => None,
        });
        let size: Option<u64> = fixed.sum();
        match size {
            // In a text, rows without properties have no lines.
            _ if element.properties.is_empty() => Ok(()),
            // `check_size` checked that the product fits.
            Some(size) if self.encoding != PlyEncoding::Text => self.skip_bytes(element, size * element.rows),
            _ => (0..element.rows).try_for_each(|row| {
                self.start_row(element, row)?;
                element.properties.iter().try_for_each(|p| self.skip(element, p.shape))?;
                self.end_row(element)
            }),
        }
    }

    /// The number of bytes, or lines of text, after the last element, and their location.
    pub(super) fn rest(mut self) -> Option<(FileLocation, u64)> {
        if self.encoding != PlyEncoding::Text {
            let n = (self.bytes.len() - self.at) as u64;
            return (n > 0).then(|| (self.place(), n));
        }
        let mut rest = self.lines.by_ref().filter(|(_, text)| !trim(text).is_empty());
        let (line, _) = rest.next()?;
        let place = FileLocation::Line(self.first_line + line);
        Some((place, 1 + rest.count() as u64))
    }
}
