//! The body of a PLY file: numbers one after the other, as text or binary.
use super::header::{Element, Encoding, Header, Scalar, Shape};
use crate::text::{Lines, NoInteger, Tokens, grouped, integer, number, show, trim, why_no_number};
use crate::{Place, ReadError};

/// A cursor over the rows of a body.
pub(super) struct Body<'a> {
    encoding: Encoding,
    bytes: &'a [u8],
    /// Where the body starts.
    body: usize,
    /// The next byte of a binary body.
    at: usize,
    lines: Lines<'a>,
    first_line: u64,
    line: u64,
    tokens: Tokens<'a>,
    row: u64,
}

type Outcome<T> = Result<T, ReadError>;

impl<'a> Body<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self {
            encoding: header.encoding,
            bytes,
            body: header.body,
            at: header.body,
            lines: Lines::new(&bytes[header.body..]),
            first_line: header.lines,
            line: header.lines,
            tokens: Tokens::new(&[]),
            row: 0,
        }
    }

    /// The byte, or in text the line, at which the reader is.
    pub(super) fn place(&self) -> Place {
        match self.encoding {
            Encoding::Text => Place::Line(self.line),
            _ => Place::Byte(self.at as u64),
        }
    }

    /// An error in the current row.
    pub(super) fn error(&self, element: &Element, code: &'static str, message: &str) -> ReadError {
        ReadError::new(code, self.place(), format!("row {} of '{}': {message}", self.row, element.name))
    }

    /// Refuses an element that cannot be as long as it says, before anything is read of it.
    pub(super) fn check_size(&self, element: &Element) -> Outcome<()> {
        let left = match self.encoding {
            Encoding::Text => self.bytes.len() - self.body - self.lines.offset(),
            _ => self.bytes.len() - self.at,
        } as u64;
        let least = |shape: Shape| match (self.encoding, shape) {
            // A digit and what separates it from the next one; the last line of a file needs no end.
            (Encoding::Text, _) => 2,
            (_, Shape::One(scalar)) => scalar.size(),
            (_, Shape::List { length, .. }) => length.size(),
        };
        let row: u64 = element.properties.iter().map(|p| least(p.shape)).sum();
        let slack = u64::from(self.encoding == Encoding::Text);
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

    /// Goes to row `row`. A text has one row a line; blank lines are skipped.
    #[inline]
    pub(super) fn start_row(&mut self, element: &Element, row: u64) -> Outcome<()> {
        self.row = row;
        if self.encoding != Encoding::Text {
            return Ok(());
        }
        loop {
            let Some((line, text)) = self.lines.next() else {
                return Err(self.error(element, "truncated", "the file ends before this row"));
            };
            self.line = self.first_line + line;
            self.tokens = Tokens::new(text);
            if !self.tokens.rest().is_empty() {
                return Ok(());
            }
        }
    }

    /// Ends a row: a text must have nothing more on its line.
    #[inline]
    pub(super) fn end_row(&mut self, element: &Element) -> Outcome<()> {
        if self.encoding != Encoding::Text {
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
    fn token(&mut self, element: &Element) -> Outcome<&'a [u8]> {
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
    fn take<const N: usize>(&mut self, element: &Element) -> Outcome<[u8; N]> {
        match self.bytes[self.at..].first_chunk::<N>() {
            Some(chunk) => {
                self.at += N;
                Ok(*chunk)
            }
            None => Err(self.error(element, "truncated", "the file ends inside this row")),
        }
    }

    /// The next number; it may be NaN or infinite.
    #[inline]
    pub(super) fn number(&mut self, element: &Element, scalar: Scalar) -> Outcome<f64> {
        if scalar.range().is_some() {
            return self.integer(element, scalar).map(|value| value as f64);
        }
        match (self.encoding, scalar) {
            (Encoding::Text, Scalar::Opaque(_)) => self.token(element).map(|_| 0.0),
            (Encoding::Text, _) => {
                let token = self.token(element)?;
                number(token).ok_or_else(|| self.error(element, "not-a-number", &why_no_number(token)))
            }
            (Encoding::Little, Scalar::F32) => Ok(f64::from(f32::from_le_bytes(self.take(element)?))),
            (Encoding::Little, Scalar::F64) => Ok(f64::from_le_bytes(self.take(element)?)),
            (Encoding::Big, Scalar::F32) => Ok(f64::from(f32::from_be_bytes(self.take(element)?))),
            (Encoding::Big, Scalar::F64) => Ok(f64::from_be_bytes(self.take(element)?)),
            (_, opaque) => self.skip_bytes(element, opaque.size()).map(|()| 0.0),
        }
    }

    /// The next number of an integer type.
    #[inline]
    pub(super) fn integer(&mut self, element: &Element, scalar: Scalar) -> Outcome<i64> {
        if self.encoding == Encoding::Text {
            return self.text_integer(element, scalar);
        }
        let little = self.encoding == Encoding::Little;
        Ok(match scalar {
            Scalar::I8 => i64::from(i8::from_le_bytes(self.take(element)?)),
            Scalar::U8 => i64::from(u8::from_le_bytes(self.take(element)?)),
            Scalar::I16 => {
                let bytes = self.take(element)?;
                i64::from(if little { i16::from_le_bytes(bytes) } else { i16::from_be_bytes(bytes) })
            }
            Scalar::U16 => {
                let bytes = self.take(element)?;
                i64::from(if little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) })
            }
            Scalar::I32 => {
                let bytes = self.take(element)?;
                i64::from(if little { i32::from_le_bytes(bytes) } else { i32::from_be_bytes(bytes) })
            }
            Scalar::U32 => {
                let bytes = self.take(element)?;
                i64::from(if little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
            }
            // The header admits integer types only where one is asked for.
            Scalar::F32 | Scalar::F64 | Scalar::Opaque(_) => {
                return Err(self.error(element, "type-unknown", "an integer should stand here"));
            }
        })
    }

    fn text_integer(&mut self, element: &Element, scalar: Scalar) -> Outcome<i64> {
        let token = self.token(element)?;
        let (low, high) = scalar.range().unwrap_or((i64::MIN, i64::MAX));
        match integer(token) {
            Ok(value) if low <= value && value <= high => Ok(value),
            Err(NoInteger::Spelling) => {
                let message = format!("{} is not a whole number", show(token));
                Err(self.error(element, "not-a-number", &message))
            }
            _ => {
                let message = format!("{} is outside its type, {low} to {high}", show(token));
                Err(self.error(element, "value-out-of-range", &message))
            }
        }
    }

    /// The length of a list, once it is sure that its items can follow.
    #[inline]
    pub(super) fn length(&mut self, element: &Element, length: Scalar, item: Scalar) -> Outcome<u64> {
        let n = self.integer(element, length)?;
        let Ok(n) = u64::try_from(n) else {
            return Err(self.error(element, "list-length", &format!("a list of length {n}")));
        };
        let left = match self.encoding {
            // Each item is a character and a space at least.
            Encoding::Text => self.tokens.rest().len() as u64 / 2 + 1,
            _ => (self.bytes.len() - self.at) as u64 / item.size(),
        };
        if n > left {
            let message = format!("a list of {} values, but at most {} follow", grouped(n), grouped(left));
            return Err(self.error(element, "list-length", &message));
        }
        Ok(n)
    }

    fn skip_bytes(&mut self, element: &Element, n: u64) -> Outcome<()> {
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

    /// Goes past a property.
    pub(super) fn skip(&mut self, element: &Element, shape: Shape) -> Outcome<()> {
        match shape {
            Shape::One(scalar) => self.number(element, scalar).map(|_| ()),
            Shape::List { length, item } => {
                let n = self.length(element, length, item)?;
                if self.encoding != Encoding::Text {
                    // `length` has made sure that the product fits.
                    return self.skip_bytes(element, n * item.size());
                }
                (0..n).try_for_each(|_| self.token(element).map(|_| ()))
            }
        }
    }

    /// Goes past all rows of an element.
    pub(super) fn skip_element(&mut self, element: &Element) -> Outcome<()> {
        let fixed = element.properties.iter().map(|p| match p.shape {
            Shape::One(scalar) => Some(scalar.size()),
            Shape::List { .. } => None,
        });
        let size: Option<u64> = fixed.sum();
        match size {
            // A text has no lines for rows without properties.
            _ if element.properties.is_empty() => Ok(()),
            // `check_size` has made sure that the product fits.
            Some(size) if self.encoding != Encoding::Text => self.skip_bytes(element, size * element.rows),
            _ => (0..element.rows).try_for_each(|row| {
                self.start_row(element, row)?;
                element.properties.iter().try_for_each(|p| self.skip(element, p.shape))?;
                self.end_row(element)
            }),
        }
    }

    /// How many bytes, or lines of text, stand after the last element, and where.
    pub(super) fn rest(mut self) -> Option<(Place, u64)> {
        if self.encoding != Encoding::Text {
            let n = (self.bytes.len() - self.at) as u64;
            return (n > 0).then(|| (self.place(), n));
        }
        let mut rest = self.lines.by_ref().filter(|(_, text)| !trim(text).is_empty());
        let (line, _) = rest.next()?;
        let place = Place::Line(self.first_line + line);
        Some((place, 1 + rest.count() as u64))
    }
}
