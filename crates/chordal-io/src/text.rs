//! Parsing of text formats: lines, tokens, numbers, and how an error shows a token.
use crate::short_decimal::short_decimal;
use crate::{FileLocation, ReadError};
use memchr::{memchr, memchr2, memchr2_iter};
use std::sync::OnceLock;

/// A token as shown in messages: quoted, escaped, and shortened if it is long.
pub(crate) fn show(token: &[u8]) -> String {
    const MOST: usize = 40;
    let cut = if token.len() > MOST { "…" } else { "" };
    format!("'{}{cut}'", token[..token.len().min(MOST)].escape_ascii())
}

/// A count as shown in messages: 4294967295 as 4,294,967,295.
pub(crate) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Physical lines, ended by LF, CR LF or CR, counted from 1, without their ends.
#[derive(Clone, Debug)]
pub(crate) struct TextLines<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
}

impl<'a> TextLines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, line: 0 }
    }

    /// The byte offset of the next line.
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    /// Skips lines that were read elsewhere.
    pub(crate) fn advance(&mut self, n_bytes: usize, n_lines: u64) {
        self.at += n_bytes;
        self.line += n_lines;
    }

    /// The number of lines so far.
    pub(crate) fn n_lines(&self) -> u64 {
        self.line
    }
}

impl<'a> Iterator for TextLines<'a> {
    type Item = (u64, &'a [u8]);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let end = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let skip = match &rest[end..] {
            [b'\r', b'\n', ..] => 2,
            [] => 0,
            _ => 1,
        };
        self.at += end + skip;
        self.line += 1;
        Some((self.line, &rest[..end]))
    }
}

/// The number of bytes between two counts of a [`LineIndex`].
const LINE_COUNT_STEP: usize = 4096; // chosen: one page, so that a lookup costs as much as reading a page

/// Finds the line of a byte in constant time.
#[derive(Debug, Default)]
pub(crate) struct LineIndex {
    /// The number of line ends before each step.
    n_ends: OnceLock<Vec<u32>>,
}

impl LineIndex {
    /// The line of a byte of `text`, which must be the same text at every call; beyond the end, the last
    /// line.
    pub(crate) fn line_at(&self, text: &[u8], offset: usize) -> u64 {
        let offset = offset.min(text.len().saturating_sub(1));
        let n_ends = self.n_ends.get_or_init(|| {
            let mut sum = 0;
            let starts = (0..=text.len()).step_by(LINE_COUNT_STEP);
            starts
                .map(|start| {
                    let before = sum;
                    sum += ends_of_lines(text, start, start + LINE_COUNT_STEP);
                    before
                })
                .collect()
        });
        let step = offset / LINE_COUNT_STEP;
        let before = ends_of_lines(text, step * LINE_COUNT_STEP, offset);
        u64::from(n_ends[step] + before) + 1
    }
}

/// The number of lines that end in a range of a text.
fn ends_of_lines(text: &[u8], start: usize, end: usize) -> u32 {
    let is_end = |i: &usize| text[start + i] == b'\n' || text.get(start + i + 1) != Some(&b'\n');
    memchr2_iter(b'\n', b'\r', &text[start..end.min(text.len())]).filter(is_end).count() as u32
}

/// The text of a file, without byte order mark and leading spaces.
pub(crate) fn text_start(bytes: &[u8]) -> &[u8] {
    let text = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    let start = text.iter().position(|b| !is_space(*b)).unwrap_or(text.len());
    &text[start..]
}

/// Whether a byte separates tokens.
#[inline]
pub(crate) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

/// The tokens of one line.
#[derive(Clone, Debug)]
pub(crate) struct LineTokens<'a> {
    rest: &'a [u8],
}

impl<'a> LineTokens<'a> {
    pub(crate) fn new(line: &'a [u8]) -> Self {
        Self { rest: line }
    }

    /// The rest of the line, trimmed.
    pub(crate) fn rest(&self) -> &'a [u8] {
        trim(self.rest)
    }
}

impl<'a> Iterator for LineTokens<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !is_space(*b))?;
        let rest = &self.rest[start..];
        let end = rest.iter().position(|b| is_space(*b)).unwrap_or(rest.len());
        self.rest = &rest[end..];
        Some(&rest[..end])
    }
}

/// Removes spaces at both ends.
pub(crate) fn trim(mut bytes: &[u8]) -> &[u8] {
    while let [first, rest @ ..] = bytes
        && is_space(*first)
    {
        bytes = rest;
    }
    while let [rest @ .., last] = bytes
        && is_space(*last)
    {
        bytes = rest;
    }
    bytes
}

/// Parses a number, or returns `None`. A number that is too large is infinite, like `inf`. `nan` and the
/// spellings of old Microsoft runtimes (`-1.#IND`) are NaN.
#[inline]
pub(crate) fn number(token: &[u8]) -> Option<f64> {
    if let Some((value, n)) = short_decimal(token)
        && n == token.len()
    {
        return Some(value);
    }
    long_number(token)
}

fn long_number(token: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(token).ok()?;
    match text.parse() {
        Ok(value) => Some(value),
        Err(_) => {
            let (_, kind) = text.split_once('#')?;
            let is_nan = ["IND", "INF", "QNAN", "SNAN"].iter().any(|k| kind.starts_with(k));
            is_nan.then_some(f64::NAN)
        }
    }
}

/// One sentence that says why a token is not a number.
pub(crate) fn number_error(token: &[u8]) -> String {
    let shown = show(token);
    if memchr(b',', token).is_some() {
        return format!("{shown} is not a number; a decimal comma must be a point, as in 1.5");
    }
    format!("{shown} is not a number")
}

/// Parses a finite number, or returns the error at `place`.
pub(crate) fn finite(token: &[u8], place: impl Fn() -> FileLocation) -> Result<f64, ReadError> {
    match number(token) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(not_finite(token, place())),
        None => Err(ReadError::new("not-a-number", place(), number_error(token))),
    }
}

/// The error for a coordinate that is NaN, infinite or beyond the range of f64.
pub(crate) fn not_finite(token: &[u8], place: FileLocation) -> ReadError {
    let message = format!("coordinate {} is not finite, or over the limit of 1.8e308", show(token));
    ReadError::new("not-finite", place, message)
}

/// Why a token is not an integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum IntegerError {
    /// It is not spelled as an integer.
    Spelling,
    /// It does not fit into an i64.
    TooLarge,
}

/// Parses an integer, with or without a sign.
#[inline]
pub(crate) fn integer(token: &[u8]) -> Result<i64, IntegerError> {
    let (digits, negative) = match token {
        [b'-', rest @ ..] => (rest, true),
        [b'+', rest @ ..] => (rest, false),
        all => (all, false),
    };
    if digits.is_empty() {
        return Err(IntegerError::Spelling);
    }
    let mut value = 0_i64;
    let mut fits = true;
    for &byte in digits {
        if !byte.is_ascii_digit() {
            return Err(IntegerError::Spelling);
        }
        let digit = i64::from(byte - b'0');
        match value.checked_mul(10).and_then(|v| v.checked_add(digit)) {
            Some(next) => value = next,
            None => fits = false,
        }
    }
    // -2^63 fits although its magnitude does not. It is beyond every limit here anyway.
    if fits { Ok(if negative { -value } else { value }) } else { Err(IntegerError::TooLarge) }
}

/// The bytes after a UTF-8 byte order mark, checked to be text.
///
/// # Errors
/// `not-utf8` for UTF-16 and UTF-32, `not-text` at the line of the first NUL byte.
pub(crate) fn text_of(bytes: &[u8]) -> Result<&[u8], ReadError> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let message = "the text is UTF-16, not UTF-8: save it as UTF-8 or plain ASCII";
        return Err(ReadError::new("not-utf8", FileLocation::Byte(0), message));
    }
    let bytes = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    let Some(nul) = memchr(0, bytes) else { return Ok(bytes) };
    let line = TextLines::new(&bytes[..=nul]).last().map_or(1, |(line, _)| line);
    let message = "a NUL byte: this is no text, or it is UTF-16 (save it as UTF-8)";
    Err(ReadError::new("not-text", FileLocation::Line(line), message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_with_lf_cr_or_both() {
        let lines: Vec<_> = TextLines::new(b"a\nb\r\nc\rd\n\n\re").collect();
        let expected: [(u64, &[u8]); 7] =
            [(1, b"a"), (2, b"b"), (3, b"c"), (4, b"d"), (5, b""), (6, b""), (7, b"e")];
        assert_eq!(lines, expected);
        assert_eq!(TextLines::new(b"").count(), 0);
        assert_eq!(TextLines::new(b"\n").count(), 1);
    }

    #[test]
    fn the_line_of_a_byte_is_the_one_that_counting_finds() {
        for end in ["\n", "\r", "\r\n", "\n\r", "\r\r\n"] {
            // Lines of 0 to 12 letters, so that line ends of all kinds cross a step.
            let mut text = String::new();
            for i in 0..LINE_COUNT_STEP / 2 {
                text.push_str(&"x".repeat(i * 5 % 13));
                text.push_str(end);
            }
            let text = text.as_bytes();
            let index = LineIndex::default();
            for at in (0..text.len()).step_by(61).chain(LINE_COUNT_STEP - 9..LINE_COUNT_STEP + 9) {
                let plain = TextLines::new(&text[..=at]).count() as u64;
                assert_eq!(index.line_at(text, at), plain, "byte {at} of lines with {end:?}");
            }
            assert_eq!(index.line_at(text, usize::MAX), index.line_at(text, text.len() - 1));
        }
        assert_eq!(LineIndex::default().line_at(b"", 7), 1);
    }

    #[test]
    fn numbers_are_read_as_they_are_spelled() {
        for (text, value) in [("1", 1.0), ("+2.", 2.0), ("-.5", -0.5), ("3.1E+2", 310.0), ("-0", 0.0)] {
            assert_eq!(number(text.as_bytes()), Some(value), "{text}");
        }
        assert_eq!(number(b"1e400"), Some(f64::INFINITY));
        assert!(number(b"-1.#IND").unwrap().is_nan() && number(b"1#QNAN").unwrap().is_nan());
        for text in ["", "1,5", "0x10", "1_000", "1e", "#", "1#", "--1", "\u{663}"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn integers_do_not_wrap() {
        assert_eq!(integer(b"+12"), Ok(12));
        assert_eq!(integer(b"-9223372036854775807"), Ok(-i64::MAX));
        assert_eq!(integer(b"9223372036854775808"), Err(IntegerError::TooLarge));
        assert_eq!(integer(b"99999999999999999999999999"), Err(IntegerError::TooLarge));
        for text in ["", "-", "1.0", "1e3", "9999999999999999999999x"] {
            assert_eq!(integer(text.as_bytes()), Err(IntegerError::Spelling), "{text}");
        }
    }

    #[test]
    fn counts_are_grouped_by_thousands() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(4_294_967_295), "4,294,967,295");
    }
}
