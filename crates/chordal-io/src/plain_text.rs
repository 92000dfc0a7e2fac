//! `PlainCursor`: the fast path for lines of a text in the spelling that most programs use. Other lines are
//! left untouched for the complete reader, which accepts every spelling and reports errors.
use crate::short_decimal::{digit, short_decimal};
use crate::text::number;
use memchr::memchr2;
use std::num::NonZero;

/// A cursor in a text. After a call that returned `None` its position is undefined: go back to the start of
/// the line.
#[derive(Clone, Debug)]
pub(crate) struct PlainCursor<'a> {
    pub(crate) text: &'a [u8],
    pub(crate) at: usize,
}

impl PlainCursor<'_> {
    #[inline]
    fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    /// Skips spaces and tabs.
    #[inline]
    pub(crate) fn skip_blanks(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t')) {
            self.at += 1;
        }
    }

    /// Skips `word` if it comes next, followed by a blank.
    #[inline]
    pub(crate) fn word(&mut self, word: &[u8]) -> Option<()> {
        let rest = self.text.get(self.at..)?.strip_prefix(word)?;
        matches!(rest.first(), Some(b' ' | b'\t')).then(|| self.at += word.len())
    }

    /// The number after blanks, up to a blank or the end of the line.
    #[inline]
    pub(crate) fn number(&mut self) -> Option<f64> {
        self.skip_blanks();
        let rest = &self.text[self.at..];
        if let Some((value, n)) = short_decimal(rest)
            && rest.get(n).is_none_or(|b| is_end(*b))
        {
            self.at += n;
            return Some(value);
        }
        self.long_number()
    }

    fn long_number(&mut self) -> Option<f64> {
        let rest = &self.text[self.at..];
        let token = &rest[..rest.iter().position(|b| is_end(*b)).unwrap_or(rest.len())];
        self.at += token.len();
        number(token)
    }

    /// A whole number of few digits, with an optional sign.
    #[inline]
    pub(crate) fn integer(&mut self) -> Option<i32> {
        let negative = self.peek() == Some(b'-');
        self.at += usize::from(negative);
        let (start, mut value) = (self.at, 0_i32);
        while let Some(digit) = digit(self.text, self.at) {
            value = value.wrapping_mul(10).wrapping_add(digit as i32);
            self.at += 1;
        }
        // Nine digits are below 2³¹.
        (1..=9).contains(&(self.at - start)).then_some(if negative { -value } else { value })
    }

    /// Skips a byte if it comes next.
    #[inline]
    pub(crate) fn passes(&mut self, byte: u8) -> bool {
        let stands = self.peek() == Some(byte);
        self.at += usize::from(stands);
        stands
    }

    /// Whether a word ends here.
    #[inline]
    pub(crate) fn is_at_end(&self) -> bool {
        self.peek().is_none_or(is_end)
    }

    /// Whether the line continues after blanks.
    #[inline]
    pub(crate) fn goes_on(&mut self) -> bool {
        self.skip_blanks();
        !matches!(self.peek(), None | Some(b'\n' | b'\r'))
    }

    /// Skips blanks and the end of the line.
    #[inline]
    pub(crate) fn end_line(&mut self) -> Option<()> {
        self.skip_blanks();
        let rest = &self.text[self.at..];
        self.at += match rest {
            [b'\n', ..] => 1,
            [b'\r', b'\n', ..] => 2,
            [b'\r', ..] => 1,
            [] => 0,
            _ => return None,
        };
        Some(())
    }

    /// Skips the rest of the line and its end.
    pub(crate) fn skip_line(&mut self) {
        let rest = &self.text[self.at..];
        self.at += memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        self.end_line();
    }
}

#[inline]
fn is_end(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r')
}

/// Cuts a text into parts of whole lines, each of about `size` bytes. If `keeps` is true for the lines so
/// far, without the last line's end, the next line stays with them.
pub(crate) fn parts_of_lines(text: &[u8], size: usize, keeps: fn(&[u8]) -> bool) -> Vec<&[u8]> {
    let (mut parts, mut rest) = (Vec::new(), text);
    while rest.len() > size {
        let mut cursor = PlainCursor { text: rest, at: size };
        loop {
            cursor.skip_line();
            let mut lines = &rest[..cursor.at];
            while let [before @ .., b'\n' | b'\r'] = lines {
                lines = before;
            }
            if cursor.at == rest.len() || !keeps(lines) {
                break;
            }
        }
        let (part, after) = rest.split_at(cursor.at);
        parts.push(part);
        rest = after;
    }
    if !rest.is_empty() {
        parts.push(rest);
    }
    parts
}

/// The number of parts that are parsed before any of them is merged: enough for all threads to finish at
/// nearly the same time, and few, since the parsed parts are kept in memory beside the mesh until then.
pub(crate) fn parts_at_once(threads: usize) -> usize {
    // Parts are merged in the order of the text, whatever their number: no result depends on it.
    let available = || std::thread::available_parallelism().map_or(1, NonZero::get);
    // Chosen: with four per thread, the last ones to finish leave at most a quarter of a thread's work.
    4 * if threads == 0 { available() } else { threads }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_the_text_and_end_where_lines_do() {
        let text = b"a\nbb \\\nccc\r\n\r\ndd\re\\\r\nf\n\ngg";
        for size in 1..text.len() + 2 {
            let parts = parts_of_lines(text, size, |line| line.ends_with(b"\\"));
            assert_eq!(parts.concat(), text);
            for pair in parts.windows(2) {
                let [before, after] = pair else { unreachable!() };
                assert!(before.len() >= size);
                assert!(before.ends_with(b"\n") || before.ends_with(b"\r") && !after.starts_with(b"\n"));
                assert!(!before.ends_with(b"\\\n") && !before.ends_with(b"\\\r\n"), "{before:?}");
            }
        }
    }
}
