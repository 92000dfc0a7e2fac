//! `Words`: a text as words that know their line, for formats in which line breaks mean nothing.
use crate::text::{Lines, Tokens};
use crate::{Place, ReadError};

/// The words of a text, one after the other.
#[derive(Clone, Debug)]
pub(crate) struct Words<'a> {
    lines: Lines<'a>,
    tokens: Tokens<'a>,
    line: u64,
}

impl<'a> Words<'a> {
    pub(crate) fn new(text: &'a [u8]) -> Self {
        Self { lines: Lines::new(text), tokens: Tokens::new(&[]), line: 1 }
    }

    /// The next word.
    #[inline]
    pub(crate) fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(token) = self.tokens.next() {
                return Some(token);
            }
            let (line, text) = self.lines.next()?;
            (self.line, self.tokens) = (line, Tokens::new(text));
        }
    }

    /// The next word, or an error that says what is missing.
    #[inline]
    pub(crate) fn expect(&mut self, what: impl FnOnce() -> String) -> Result<&'a [u8], ReadError> {
        match self.next() {
            Some(word) => Ok(word),
            None => {
                Err(ReadError::new("truncated", self.place(), format!("the file ends before {}", what())))
            }
        }
    }

    /// What is left of the line of the last word; the next word is on another line.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.tokens.rest();
        self.tokens = Tokens::new(&[]);
        rest
    }

    /// The line of the last word.
    pub(crate) fn place(&self) -> Place {
        Place::Line(self.line)
    }
}
