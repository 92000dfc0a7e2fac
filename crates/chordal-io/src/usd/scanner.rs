//! `UsdaScanner`: the words of USD's text form.
use crate::text::{LineIndex, is_space, show};
use crate::{FileLocation, ReadError};
use memchr::memchr;

/// A cursor in a text.
pub(super) struct UsdaScanner<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
}

/// Whether a byte ends a word.
fn ends_word(byte: u8) -> bool {
    is_space(byte) || b"=()[]{}<>,;@\"'#".contains(&byte)
}

impl<'a> UsdaScanner<'a> {
    pub(super) fn error(&self, code: &'static str, message: impl Into<String>) -> ReadError {
        ReadError::new(code, self.place(), message.into())
    }

    pub(super) fn place(&self) -> FileLocation {
        FileLocation::Line(LineIndex::default().line_at(self.bytes, self.at))
    }

    /// The error for a token other than the expected one.
    pub(super) fn expected(&self, what: &str) -> ReadError {
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        if rest.is_empty() {
            return self.error("truncated", format!("the file ends where {what} is expected"));
        }
        let end = rest.iter().skip(1).position(|b| ends_word(*b)).map_or(rest.len(), |at| at + 1);
        self.error("syntax", format!("{} stands where {what} is expected", show(&rest[..end])))
    }

    /// Skips spaces, comments and the separators of statements.
    pub(super) fn skip(&mut self) -> Result<(), ReadError> {
        loop {
            match self.bytes.get(self.at..).unwrap_or_default() {
                [b, ..] if is_space(*b) || *b == b';' => self.at += 1,
                [b'#', ..] | [b'/', b'/', ..] => {
                    let rest = &self.bytes[self.at..];
                    self.at += memchr(b'\n', rest).unwrap_or(rest.len());
                }
                [b'/', b'*', rest @ ..] => match memchr::memmem::find(rest, b"*/") {
                    // The comment includes two bytes at each end.
                    Some(n) => self.at += n + 4,
                    None => return Err(self.error("truncated", "a comment has no end")),
                },
                _ => return Ok(()),
            }
        }
    }

    /// Peeks at the next byte that is not white space; 0 at the end.
    pub(super) fn peek(&mut self) -> Result<u8, ReadError> {
        self.skip()?;
        Ok(self.bytes.get(self.at).copied().unwrap_or(0))
    }

    /// Skips a byte if it comes next. Returns whether it did.
    pub(super) fn take(&mut self, byte: u8) -> Result<bool, ReadError> {
        let is_next = self.peek()? == byte && self.at < self.bytes.len();
        self.at += usize::from(is_next);
        Ok(is_next)
    }

    pub(super) fn need(&mut self, byte: u8) -> Result<(), ReadError> {
        if self.take(byte)? { Ok(()) } else { Err(self.expected(&format!("'{}'", char::from(byte)))) }
    }

    /// A word: a name, a type, a number. Empty if something else comes next.
    pub(super) fn word(&mut self) -> Result<&'a str, ReadError> {
        self.skip()?;
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let end = rest.iter().position(|b| ends_word(*b)).unwrap_or(rest.len());
        let word = std::str::from_utf8(&rest[..end])
            .map_err(|_| self.error("not-utf8", format!("{} is no UTF-8", show(&rest[..end]))))?;
        self.at += end;
        Ok(word)
    }

    /// Peeks at the next word.
    pub(super) fn peek_word(&mut self) -> Result<&'a str, ReadError> {
        self.skip()?;
        let at = self.at;
        let word = self.word()?;
        self.at = at;
        Ok(word)
    }

    /// A string in single or double quotes, or in three of either.
    pub(super) fn string(&mut self) -> Result<String, ReadError> {
        let quote = self.peek()?;
        if quote != b'"' && quote != b'\'' {
            return Err(self.expected("a quoted string"));
        }
        let rest = &self.bytes[self.at..];
        let n = if rest.len() > 2 && rest[1] == quote && rest[2] == quote { 3 } else { 1 };
        let start = self.at + n;
        let (mut at, mut has_escapes) = (start, false);
        loop {
            match self.bytes.get(at) {
                None => return Err(self.error("truncated", "a string has no end")),
                Some(b'\\') => {
                    has_escapes = true;
                    // Over the next byte, too: an escaped quote does not end the string.
                    at += 1;
                }
                Some(b'\n') if n == 1 => return Err(self.error("syntax", "a string has no end in its line")),
                Some(b) if *b == quote => {
                    let closing = self.bytes.get(at..at + n).unwrap_or_default();
                    if closing.len() == n && closing.iter().all(|b| *b == quote) {
                        break;
                    }
                }
                Some(_) => {}
            }
            at += 1;
        }
        let raw = &self.bytes[start..at];
        let text = if has_escapes { unescaped(raw) } else { raw.to_vec() };
        let text = String::from_utf8(text).map_err(|_| self.error("not-utf8", "a string is no UTF-8"))?;
        self.at = at + n;
        Ok(text)
    }

    /// The path of a file, between single or triple `@`.
    pub(super) fn asset(&mut self) -> Result<&'a str, ReadError> {
        self.need(b'@')?;
        let rest = &self.bytes[self.at..];
        let (start, end, mark) = match rest.strip_prefix(b"@@") {
            Some(inside) => (2, memchr::memmem::find(inside, b"@@@").map(|n| n + 2), 3),
            None => (0, memchr(b'@', rest), 1),
        };
        let Some(end) = end else { return Err(self.error("truncated", "the path of a file has no end")) };
        let path = std::str::from_utf8(&rest[start..end])
            .map_err(|_| self.error("not-utf8", "the path of a file is no UTF-8"))?;
        self.at += end + mark;
        Ok(path)
    }

    /// The path of a prim or property, between angle brackets.
    pub(super) fn path(&mut self) -> Result<&'a str, ReadError> {
        self.need(b'<')?;
        let rest = &self.bytes[self.at..];
        let end = memchr(b'>', rest).ok_or_else(|| self.error("truncated", "a path has no end"))?;
        let path =
            std::str::from_utf8(&rest[..end]).map_err(|_| self.error("not-utf8", "a path is no UTF-8"))?;
        self.at += end + 1;
        Ok(path)
    }
}

/// The bytes of a string after its backslash escapes are resolved.
fn unescaped(raw: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(raw.len());
    let mut at = 0;
    while at < raw.len() {
        let byte = raw[at];
        at += 1;
        if byte != b'\\' {
            out.push(byte);
            continue;
        }
        let Some(escaped) = raw.get(at).copied() else { break };
        at += 1;
        out.push(match escaped {
            b'n' => b'\n',
            b't' => b'\t',
            b'r' => b'\r',
            b'x' => {
                // Two hexadecimal digits make one byte.
                let digits = raw.get(at..at + 2).and_then(|pair| std::str::from_utf8(pair).ok());
                match digits.and_then(|pair| u8::from_str_radix(pair, 16).ok()) {
                    Some(value) => {
                        at += 2;
                        value
                    }
                    None => b'x',
                }
            }
            other => other,
        });
    }
    out
}
