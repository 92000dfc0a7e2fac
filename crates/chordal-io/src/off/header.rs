//! `OffHeader`: the keyword, the counts and the certificate at the start of an OFF file.
use super::CERTIFICATE;
use super::keyword::{OffKeyword, without_comment};
use crate::assemble::too_many_rows;
use crate::certificate::CertificateComments;
use crate::text::{IntegerError, LineTokens, TextLines, grouped, integer, show, text_of, trim};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use serde_json::Value;

/// The data before the first vertex.
#[derive(Debug)]
pub(super) struct OffHeader {
    pub(super) keyword: OffKeyword,
    /// The number of coordinates of a position in the file, 2 or 3, without the homogeneous one.
    pub(super) dimension: usize,
    pub(super) n_vertices: u64,
    pub(super) n_faces: u64,
    pub(super) certificate: Option<Value>,
    /// The offset at which the rows start, and the number of lines before them.
    pub(super) body: usize,
    pub(super) lines: u64,
}

impl OffHeader {
    /// Parses the header; blank lines, comments and a byte order mark may precede it.
    pub(super) fn read(bytes: &[u8], limits: &Limits, warnings: &mut Warnings) -> Result<Self, ReadError> {
        let mut reader = OffHeaderReader::new(bytes, limits, warnings);
        let keyword = reader.keyword();
        if !matches!(&keyword, Ok(keyword) if keyword.is_binary) {
            text_of(bytes)?;
        }
        let keyword = keyword?;
        let dimension = if keyword.has_dimension { reader.dimension(&keyword)? } else { 3 };
        let n_vertices = reader.rows(&keyword, "vertices")?;
        let n_faces = reader.rows(&keyword, "faces")?;
        reader.edges(&keyword, n_vertices)?;
        let body = if keyword.is_binary { reader.at } else { reader.lines.offset() };
        let (certificate, lines) = (reader.certificate.finish(reader.warnings), reader.line);
        Ok(Self { keyword, dimension, n_vertices, n_faces, certificate, body, lines })
    }

    /// The count of numbers of a position in the file.
    pub(super) fn n_coordinates(&self) -> usize {
        self.dimension + usize::from(self.keyword.is_homogeneous)
    }
}

struct OffHeaderReader<'a, 'b> {
    bytes: &'a [u8],
    limits: &'b Limits,
    warnings: &'b mut Warnings,
    lines: TextLines<'a>,
    /// The remaining words of the current line.
    words: LineTokens<'a>,
    line: u64,
    /// Digits that were joined to the keyword, or the first count of a file without a keyword.
    pending: Option<&'a [u8]>,
    /// The next byte of a binary header.
    at: usize,
    certificate: CertificateComments,
}

impl<'a, 'b> OffHeaderReader<'a, 'b> {
    fn new(bytes: &'a [u8], limits: &'b Limits, warnings: &'b mut Warnings) -> Self {
        Self {
            bytes,
            limits,
            warnings,
            lines: TextLines::new(bytes),
            words: LineTokens::new(&[]),
            line: 1,
            pending: None,
            at: 0,
            certificate: CertificateComments::default(),
        }
    }

    fn error(&self, code: &'static str, message: impl Into<String>) -> ReadError {
        ReadError::new(code, FileLocation::Line(self.line), message.into())
    }

    /// Moves to the next line. Returns false at the end of the file.
    fn next_line(&mut self) -> Result<bool, ReadError> {
        let Some((line, text)) = self.lines.next() else { return Ok(false) };
        self.line = line;
        if text.len() > self.limits.header_line {
            let n = grouped(text.len() as u64);
            let limit = self.limits.header_line;
            let message = format!("a header line of {n} bytes is over the limit of {limit}");
            return Err(self.error("line-too-long", message));
        }
        let text = text.strip_prefix(&[0xef, 0xbb, 0xbf]).filter(|_| line == 1).unwrap_or(text);
        if let Some(piece) = text.strip_prefix(CERTIFICATE.as_bytes()) {
            self.certificate.take(piece, FileLocation::Line(line));
        }
        self.words = LineTokens::new(without_comment(text));
        Ok(true)
    }

    /// The next word, on this line or a later one.
    fn word(&mut self, what: &str) -> Result<&'a [u8], ReadError> {
        if let Some(word) = self.pending.take() {
            return Ok(word);
        }
        loop {
            if let Some(word) = self.words.next() {
                return Ok(word);
            }
            if !self.next_line()? {
                return Err(self.error("truncated", format!("the file ends before {what}")));
            }
        }
    }

    fn keyword(&mut self) -> Result<OffKeyword, ReadError> {
        let word = self.word("its keyword")?;
        let Some((mut keyword, digits)) = OffKeyword::from_word(word) else {
            return self.without_keyword(word);
        };
        if keyword.is_out_of_order {
            let message = format!(
                "variant {} is not supported: with N before C, programs disagree on what comes first in a row; \
                 Geomview's keyword is [ST][C][N][4][n]OFF",
                show(word)
            );
            return Err(self.error("format-unsupported", message));
        }
        if !digits.is_empty() {
            let place = FileLocation::Line(self.line);
            self.warnings.count("keyword-joined", || {
                (place, "no space stands between the keyword and the count after it".to_owned())
            });
            // The digits are the number of vertices, as in `OFF8 6 12`.
            self.pending = Some(digits);
        }
        let mut after = self.words.clone();
        if digits.is_empty() && after.next() == Some(b"BINARY") {
            if let Some(word) = after.next() {
                let message = format!("{} stands after 'BINARY', where the line should end", show(word));
                return Err(self.error("row-too-long", message));
            }
            keyword.is_binary = true;
            self.at = self.lines.offset();
        }
        Ok(keyword)
    }

    /// Handles a first word that is not a keyword: a count, or an error.
    fn without_keyword(&mut self, word: &'a [u8]) -> Result<OffKeyword, ReadError> {
        if integer(word) == Err(IntegerError::Spelling) {
            let message = format!("{} where a keyword [ST][C][N][4][n]OFF should stand", show(word));
            let is_variant = word.ends_with(b"OFF");
            return Err(self.error(if is_variant { "format-unsupported" } else { "not-off" }, message));
        }
        let place = FileLocation::Line(self.line);
        self.warnings.count("keyword-missing", || {
            (place, "the keyword 'OFF' is missing, and was taken to stand before the counts".to_owned())
        });
        self.pending = Some(word);
        Ok(OffKeyword::default())
    }

    /// The next four bytes of a binary header as a number.
    fn binary_integer(&mut self, what: &str) -> Result<i64, ReadError> {
        let Some(chunk) = self.bytes[self.at..].first_chunk::<4>() else {
            let place = FileLocation::Byte(self.at as u64);
            return Err(ReadError::new("truncated", place, format!("the file ends before {what}")));
        };
        self.at += 4;
        Ok(i64::from(i32::from_be_bytes(*chunk)))
    }

    /// A count, and its location.
    fn count(&mut self, keyword: &OffKeyword, what: &str) -> Result<(u64, FileLocation), ReadError> {
        let refuse = |place, shown: String| {
            ReadError::new("not-a-count", place, format!("{shown} is no {what} below 2^63"))
        };
        if keyword.is_binary {
            let place = FileLocation::Byte(self.at as u64);
            let n = self.binary_integer(&format!("the {what}"))?;
            let Ok(n) = u64::try_from(n) else { return Err(refuse(place, n.to_string())) };
            return Ok((n, place));
        }
        let word = self.word(&format!("the {what}"))?;
        let place = FileLocation::Line(self.line);
        match integer(word).ok().and_then(|n| u64::try_from(n).ok()) {
            Some(n) => Ok((n, place)),
            None => Err(refuse(place, show(word))),
        }
    }

    /// The dimension of space.
    fn dimension(&mut self, keyword: &OffKeyword) -> Result<usize, ReadError> {
        let (n, place) = self.count(keyword, "dimension")?;
        match n {
            3 => Ok(3),
            2 => {
                let message = "positions of two coordinates have 0 as their third";
                self.warnings.count("padded-positions", || (place, message.to_owned()));
                Ok(2)
            }
            // With one coordinate there are no faces, and a digit per vertex would exceed the documented
            // memory.
            _ => {
                let message =
                    format!("variant nOFF of dimension {} is not supported; 2 and 3 are", grouped(n));
                Err(ReadError::new("format-unsupported", place, message))
            }
        }
    }

    /// A number of rows within the limits.
    fn rows(&mut self, keyword: &OffKeyword, what: &'static str) -> Result<u64, ReadError> {
        let (n, place) = self.count(keyword, &format!("number of {what}"))?;
        // The largest index means "none".
        let indices = u64::from(u32::MAX) - 1;
        let most = if what == "vertices" { self.limits.rows.min(indices) } else { self.limits.rows };
        if n > most {
            return Err(too_many_rows(place, what, n, most));
        }
        Ok(n)
    }

    /// Reads the number of edges. Nothing depends on it, and some writers leave it out of a text.
    fn edges(&mut self, keyword: &OffKeyword, n_vertices: u64) -> Result<(), ReadError> {
        if keyword.is_binary {
            return self.binary_integer("the number of edges").map(|_| ());
        }
        let Some(word) = self.words.next() else {
            if n_vertices > 0 {
                self.edges_on_a_line();
            }
            return Ok(());
        };
        if integer(word) == Err(IntegerError::Spelling) {
            return Err(self.error("not-a-count", format!("{} is no number of edges", show(word))));
        }
        match self.words.next() {
            None => Ok(()),
            Some(word) => {
                let message = format!("{} stands after the number of edges", show(word));
                Err(self.error("row-too-long", message))
            }
        }
    }

    /// Skips a line with a single number, which cannot be a vertex.
    fn edges_on_a_line(&mut self) {
        let mut ahead = self.lines.clone();
        let next = ahead.find(|(_, text)| !trim(without_comment(text)).is_empty());
        if let Some((line, text)) = next
            && integer(trim(without_comment(text))) != Err(IntegerError::Spelling)
        {
            (self.lines, self.line) = (ahead, line);
        }
    }
}
