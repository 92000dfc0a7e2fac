//! `BezNumbers`: the numbers of a file of Bézier patches, in text or in Geomview's big-endian binary form.
use super::keyword::BezKeyword;
use crate::text::{finite, show};
use crate::word_reader::WordReader;
use crate::{FileLocation, ReadError};
use memchr::memchr;

/// The remaining numbers.
pub(super) enum BezNumbers<'a> {
    Text(BezWords<'a>),
    Binary { bytes: &'a [u8], at: usize },
}

impl BezNumbers<'_> {
    /// The next number.
    pub(super) fn next(&mut self, what: impl Fn() -> String) -> Result<f64, ReadError> {
        match self {
            Self::Text(words) => {
                let word = words.expect(&what)?;
                finite(word, || words.place()).map_err(|mut error| {
                    error.message =
                        chordal::budget::advice::Message::from(what() + ": ").message(&error.message);
                    error
                })
            }
            Self::Binary { bytes, at } => {
                let place = FileLocation::Byte(*at as u64);
                let number = bytes.get(*at..).and_then(|rest| rest.first_chunk());
                let Some(number) = number else {
                    return Err(ReadError::new(
                        "truncated",
                        place,
                        format!("the file ends before {}", what()),
                    ));
                };
                *at += number.len();
                let value = f32::from_be_bytes(*number);
                if value.is_finite() {
                    return Ok(value.into());
                }
                Err(ReadError::new("not-finite", place, format!("{}: {value} is not finite", what())))
            }
        }
    }

    pub(super) fn place(&self) -> FileLocation {
        match self {
            Self::Text(words) => words.place(),
            Self::Binary { at, .. } => FileLocation::Byte(*at as u64),
        }
    }
}

/// The words of a file without its comments; one word can be put back.
pub(super) struct BezWords<'a> {
    words: WordReader<'a>,
    kept: Option<&'a [u8]>,
}

impl<'a> BezWords<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { words: WordReader::new(text), kept: None }
    }

    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        if let Some(word) = self.kept.take() {
            return Some(word);
        }
        loop {
            let word = self.words.next()?;
            let Some(comment) = memchr(b'#', word) else { return Some(word) };
            self.words.rest_of_line();
            if comment > 0 {
                return Some(&word[..comment]);
            }
        }
    }

    /// Peeks at the next word.
    pub(super) fn peek(&mut self) -> Option<&'a [u8]> {
        self.kept = self.next();
        self.kept
    }

    pub(super) fn expect(&mut self, what: impl FnOnce() -> String) -> Result<&'a [u8], ReadError> {
        let truncated = |words: &Self| {
            ReadError::new("truncated", words.place(), format!("the file ends before {}", what()))
        };
        self.next().ok_or_else(|| truncated(self))
    }

    /// The line of the last word.
    pub(super) fn place(&self) -> FileLocation {
        self.words.place()
    }

    /// The keyword at the start; a brace that opens the object and an appearance block may precede it.
    ///
    /// # Errors
    /// If another word comes first, or a block does not end. The flag is true if there was a block.
    pub(super) fn first_keyword(&mut self) -> Result<(BezKeyword, bool), ReadError> {
        let mut has_appearance = false;
        loop {
            let word = self.expect(|| "the keyword, such as BBP or BEZ224".to_owned())?;
            match word {
                b"{" | b"=" => {}
                b"appearance" => {
                    has_appearance = true;
                    self.skip_block()?;
                }
                _ => {
                    let Some(keyword) = BezKeyword::from_word(word) else {
                        let message =
                            format!("{} is no keyword of Bézier patches, such as BBP or BEZ224", show(word));
                        return Err(ReadError::new("not-bez", self.place(), message));
                    };
                    return Ok((keyword, has_appearance));
                }
            }
        }
    }

    /// Skips a block in braces.
    fn skip_block(&mut self) -> Result<(), ReadError> {
        let mut depth = 0_u64;
        loop {
            let word = self.expect(|| "the closing brace of the appearance".to_owned())?;
            for byte in word {
                match byte {
                    b'{' => depth += 1,
                    b'}' if depth > 0 => depth -= 1,
                    _ => {}
                }
            }
            if depth == 0 {
                return Ok(());
            }
        }
    }

    /// The offset of the line after the last word.
    pub(super) fn next_line(&self) -> usize {
        self.words.next_line()
    }
}
