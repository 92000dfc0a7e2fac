//! `WordReader`: the words of a text with their line numbers, for formats that ignore line breaks.
use crate::text::{LineTokens, TextLines};
use crate::{FileLocation, ReadError};

/// The words of a text, in order.
#[derive(Clone, Debug)]
pub(crate) struct WordReader<'a> {
    lines: TextLines<'a>,
    tokens: LineTokens<'a>,
    line: u64,
}

impl<'a> WordReader<'a> {
    pub(crate) fn new(text: &'a [u8]) -> Self {
        Self { lines: TextLines::new(text), tokens: LineTokens::new(&[]), line: 1 }
    }

    /// The next word.
    #[inline]
    pub(crate) fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(token) = self.tokens.next() {
                return Some(token);
            }
            let (line, text) = self.lines.next()?;
            (self.line, self.tokens) = (line, LineTokens::new(text));
        }
    }

    /// The next word, or an error that names the missing word.
    #[inline]
    pub(crate) fn expect(&mut self, what: impl FnOnce() -> String) -> Result<&'a [u8], ReadError> {
        match self.next() {
            Some(word) => Ok(word),
            None => {
                Err(ReadError::new("truncated", self.place(), format!("the file ends before {}", what())))
            }
        }
    }

    /// The rest of the line of the last word; the next word is on another line.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.tokens.rest();
        self.tokens = LineTokens::new(&[]);
        rest
    }

    /// The offset of the line after the one of the last word.
    pub(crate) fn next_line(&self) -> usize {
        self.lines.offset()
    }

    /// The line of the last word.
    pub(crate) fn place(&self) -> FileLocation {
        FileLocation::Line(self.line)
    }
}
