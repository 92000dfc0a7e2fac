//! `OffRowReader`: the vertices and faces of an OFF file as rows of numbers, as text or binary.
use super::colors::OffColor;
use super::header::OffHeader;
use super::keyword::without_comment;
use crate::text::{IntegerError, LineTokens, TextLines, grouped, integer, number, number_error, show, trim};
use crate::{FileLocation, ReadError};

/// A cursor over the rows after the header. In a text each row begins on a new line, so that a missing or
/// extra number is noticed there; only the corners of a face may continue on further lines.
pub(super) struct OffRowReader<'a> {
    is_binary: bool,
    bytes: &'a [u8],
    /// The byte at which the rows start.
    body: usize,
    /// The offset of the next byte of a binary file.
    at: usize,
    lines: TextLines<'a>,
    first_line: u64,
    line: u64,
    tokens: LineTokens<'a>,
    /// Whether the current row has more than one line.
    goes_on: bool,
    /// The list of the current row, as in "vertex".
    list: &'static str,
    row: u64,
}

type OffResult<T> = Result<T, ReadError>;

impl<'a> OffRowReader<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &OffHeader) -> Self {
        Self {
            is_binary: header.keyword.is_binary,
            bytes,
            body: header.body,
            at: header.body,
            lines: TextLines::new(&bytes[header.body..]),
            first_line: header.lines,
            line: header.lines,
            tokens: LineTokens::new(&[]),
            goes_on: false,
            list: "",
            row: 0,
        }
    }

    /// The byte of the cursor, or in a text its line.
    pub(super) fn place(&self) -> FileLocation {
        if self.is_binary { FileLocation::Byte(self.at as u64) } else { FileLocation::Line(self.line) }
    }

    /// The line or, in a binary file, the row.
    pub(super) fn line_or_row(&self) -> u64 {
        if self.is_binary { self.row } else { self.line }
    }

    /// An error in the current row.
    pub(super) fn error(&self, code: &'static str, message: &str) -> ReadError {
        ReadError::new(code, self.place(), format!("{} {}: {message}", self.list, self.row))
    }

    /// Starts a list. Refuses a list with more rows of `n_numbers` numbers than the file can hold, before any
    /// is read.
    pub(super) fn start_list(&mut self, list: &'static str, n_rows: u64, n_numbers: usize) -> OffResult<()> {
        self.list = list;
        let (size, left, slack) = if self.is_binary {
            (4, self.bytes.len() - self.at, 0)
        } else {
            // A digit and its separator; the last line of a file needs no line end.
            (2, self.bytes.len() - self.body - self.lines.offset(), 1)
        };
        let (least, left) = (size * n_numbers as u64, left as u64);
        match least.checked_mul(n_rows) {
            Some(needed) if needed <= left + slack => Ok(()),
            _ => {
                let message = format!(
                    "the {list} list has {} rows of at least {least} bytes, but only {} bytes follow",
                    grouped(n_rows),
                    grouped(left)
                );
                Err(ReadError::new("truncated", self.place(), message))
            }
        }
    }

    /// Moves to row `row`. Blank lines and comments are skipped.
    #[inline]
    pub(super) fn start_row(&mut self, row: u64) -> OffResult<()> {
        self.row = row;
        self.goes_on = false;
        if self.is_binary {
            return Ok(());
        }
        self.next_line()
    }

    /// Moves to the next line with numbers.
    #[inline]
    fn next_line(&mut self) -> OffResult<()> {
        loop {
            let Some((line, text)) = self.lines.next() else {
                return Err(self.error("truncated", "the file ends before the end of this row"));
            };
            self.line = self.first_line + line;
            self.tokens = LineTokens::new(without_comment(text));
            if !self.tokens.rest().is_empty() {
                return Ok(());
            }
        }
    }

    /// Ends a row: in a text, nothing may follow on its line.
    #[inline]
    pub(super) fn end_row(&mut self) -> OffResult<()> {
        if self.is_binary {
            return Ok(());
        }
        match self.tokens.next() {
            None => Ok(()),
            Some(token) => {
                let message =
                    format!("{} stands after the last number that the keyword declares", show(token));
                Err(self.error("row-too-long", &message))
            }
        }
    }

    #[inline]
    fn token(&mut self) -> OffResult<&'a [u8]> {
        match self.tokens.next() {
            Some(token) => Ok(token),
            None => Err(self.error("row-too-short", "the line has fewer numbers than it needs")),
        }
    }

    #[inline]
    fn take(&mut self) -> OffResult<[u8; 4]> {
        match self.bytes[self.at..].first_chunk::<4>() {
            Some(chunk) => {
                self.at += 4;
                Ok(*chunk)
            }
            None => Err(self.error("truncated", "the file ends inside this row")),
        }
    }

    /// Reads the next number; it may be NaN or infinite.
    #[inline]
    pub(super) fn number(&mut self) -> OffResult<f64> {
        if self.is_binary {
            return Ok(f64::from(f32::from_be_bytes(self.take()?)));
        }
        let token = self.token()?;
        number(token).ok_or_else(|| self.error("not-a-number", &number_error(token)))
    }

    /// Reads the next whole number.
    #[inline]
    pub(super) fn integer(&mut self) -> OffResult<i64> {
        if self.is_binary {
            return Ok(i64::from(i32::from_be_bytes(self.take()?)));
        }
        let token = self.token()?;
        match integer(token) {
            Ok(value) => Ok(value),
            Err(IntegerError::Spelling) => {
                let message = format!("{} is not a whole number", show(token));
                Err(self.error("not-a-number", &message))
            }
            Err(IntegerError::TooLarge) => {
                let message = format!("{} is over the limit of 2^63", show(token));
                Err(self.error("value-out-of-range", &message))
            }
        }
    }

    /// Reads the number of corners, and checks that enough words follow.
    #[inline]
    pub(super) fn length(&mut self) -> OffResult<u64> {
        let n = self.integer()?;
        let Ok(n) = u64::try_from(n) else {
            return Err(self.error("list-length", &format!("a face of {n} corners")));
        };
        let left = if self.is_binary {
            (self.bytes.len() - self.at) as u64 / 4
        } else {
            // Each corner is at least a digit and a space, and the last one may end the file.
            let after = self.bytes.len() - self.body - self.lines.offset();
            (self.tokens.rest().len() + after) as u64 / 2 + 1
        };
        if n > left {
            let message =
                format!("a face of {} corners, but at most {} numbers follow", grouped(n), grouped(left));
            return Err(self.error("list-length", &message));
        }
        Ok(n)
    }

    /// Reads the index of a corner, which may be on a later line than the start of its face.
    #[inline]
    pub(super) fn corner(&mut self) -> OffResult<i64> {
        if !self.is_binary && self.tokens.rest().is_empty() {
            self.goes_on = true;
            if self.next_line().is_err() {
                let message = "the file ends before the last corner of the face";
                return Err(self.error("list-length", message));
            }
        }
        self.integer()
    }

    /// Whether the corners of the face are on several lines. Then nothing may follow them: it would be the
    /// next face, and a corner of this one would be missing.
    pub(super) fn goes_on(&self) -> OffResult<bool> {
        if self.goes_on && !self.tokens.rest().is_empty() {
            let message = "the face has fewer corners than it declares, or they are mixed with another row";
            return Err(self.error("list-length", message));
        }
        Ok(self.goes_on)
    }

    /// The number of words left on the line.
    pub(super) fn n_words_left(&self) -> usize {
        self.tokens.clone().count()
    }

    /// The number of channels that the current face has after its corners.
    #[inline]
    pub(super) fn n_face_channels(&mut self) -> OffResult<usize> {
        let n = if self.is_binary { self.integer()? } else { self.n_words_left() as i64 };
        match n {
            0 | 1 | 3 | 4 => Ok(n as usize),
            _ => {
                let message =
                    format!("a colour of {n} numbers; 3 or 4 make a colour, 1 names one of a colour map");
                Err(self.error("wrong-width", &message))
            }
        }
    }

    /// Reads a colour of three or four channels.
    pub(super) fn color(&mut self, width: usize) -> OffResult<OffColor> {
        let mut color = OffColor { channels: [1.0; 4], width, is_whole: !self.is_binary };
        for k in 0..width {
            let next = self.tokens.clone().next().unwrap_or_default();
            color.is_whole &= integer(next) != Err(IntegerError::Spelling);
            color.channels[k] = self.number()?;
        }
        Ok(color)
    }

    /// The number of bytes, or lines of text, after the last row, and their location.
    pub(super) fn rest(mut self) -> Option<(FileLocation, u64)> {
        if self.is_binary {
            let n = (self.bytes.len() - self.at) as u64;
            return (n > 0).then(|| (self.place(), n));
        }
        let mut rest = self.lines.by_ref().filter(|(_, text)| !trim(without_comment(text)).is_empty());
        let (line, _) = rest.next()?;
        let place = FileLocation::Line(self.first_line + line);
        Some((place, 1 + rest.count() as u64))
    }
}
