//! `TextCursor`: parses numbers, flags and separators of SVG attributes, and locates errors.
use crate::text::show;

/// Where and why parsing a text failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SvgSyntaxError {
    /// Bytes from the start of the text.
    pub at: usize,
    /// The expected and the actual text.
    pub what: String,
    /// Whether the cause is a number that is not finite.
    pub not_finite: bool,
}

pub(super) type CursorResult<T> = Result<T, SvgSyntaxError>;

/// A position in an attribute's text.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextCursor<'a> {
    text: &'a [u8],
    at: usize,
}

/// White space of SVG: tab, line feed, form feed, carriage return, space.
pub(super) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0c)
}

impl<'a> TextCursor<'a> {
    pub fn new(text: &'a str) -> Self {
        Self { text: text.as_bytes(), at: 0 }
    }

    pub fn at(&self) -> usize {
        self.at
    }

    pub fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    pub fn step(&mut self) {
        self.at += 1;
    }

    pub fn skip_space(&mut self) {
        while self.peek().is_some_and(is_space) {
            self.at += 1;
        }
    }

    /// Skips white space with at most one comma. Returns whether there was a comma.
    pub fn skip_comma(&mut self) -> bool {
        self.skip_space();
        let comma = self.peek() == Some(b',');
        if comma {
            self.at += 1;
            self.skip_space();
        }
        comma
    }

    /// Skips this byte if it comes next. Returns whether it did.
    pub fn take(&mut self, byte: u8) -> bool {
        let is_next = self.peek() == Some(byte);
        self.at += usize::from(is_next);
        is_next
    }

    /// Skips and returns the letters that come next.
    pub fn word(&mut self) -> &'a [u8] {
        let rest = &self.text[self.at..];
        let len = rest.iter().take_while(|b| b.is_ascii_alphabetic()).count();
        self.at += len;
        &rest[..len]
    }

    /// The rest of the text.
    pub fn rest(&self) -> &'a [u8] {
        &self.text[self.at..]
    }

    pub fn is_at_end(&self) -> bool {
        self.at >= self.text.len()
    }

    /// The error that names what was expected here.
    pub fn trouble(&self, expected: &str) -> SvgSyntaxError {
        let rest = self.rest();
        let actual = if rest.is_empty() {
            "the end".to_owned()
        } else {
            let len = rest.iter().take_while(|b| !is_space(**b) && **b != b',').count().clamp(1, 20);
            show(&rest[..len.min(rest.len())])
        };
        SvgSyntaxError {
            at: self.at,
            what: format!("{actual} where {expected} should stand"),
            not_finite: self.is_no_finite_word(),
        }
    }

    /// Whether the next word is one that programs print for values that are not finite.
    fn is_no_finite_word(&self) -> bool {
        let rest = self.rest();
        let rest = match rest {
            [b'+' | b'-', rest @ ..] => rest,
            all => all,
        };
        rest.get(..3)
            .is_some_and(|word| word.eq_ignore_ascii_case(b"nan") || word.eq_ignore_ascii_case(b"inf"))
    }

    /// Whether a number comes next.
    pub fn at_number(&self) -> bool {
        match self.rest() {
            [b'0'..=b'9' | b'.', ..] | [b'+' | b'-', b'0'..=b'9' | b'.', ..] => true,
            _ => self.is_no_finite_word(),
        }
    }

    /// Parses a finite number: sign, digits, point, digits, exponent. A point may be first or last.
    pub fn number(&mut self) -> CursorResult<f64> {
        let rest = self.rest();
        let mut len = usize::from(matches!(rest.first(), Some(b'+' | b'-')));
        let digits = |from: usize| rest[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let n_whole = digits(len);
        len += n_whole;
        let mut fraction = 0;
        if rest.get(len) == Some(&b'.') {
            fraction = digits(len + 1);
            len += 1 + fraction;
        }
        if n_whole + fraction == 0 {
            return Err(self.trouble("a number"));
        }
        if matches!(rest.get(len), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(rest.get(len + 1), Some(b'+' | b'-')));
            let exponent =
                rest.get(len + 1 + sign..).map_or(0, |r| r.iter().take_while(|b| b.is_ascii_digit()).count());
            // An `e` without digits starts a unit: em, ex.
            len += if exponent > 0 { 1 + sign + exponent } else { 0 };
        }
        let token = &rest[..len];
        match crate::text::number(token) {
            Some(value) if value.is_finite() => {
                self.at += len;
                Ok(value)
            }
            Some(_) => {
                let what = format!("{} is over the limit of 1.8e308", show(token));
                Err(SvgSyntaxError { at: self.at, what, not_finite: true })
            }
            None => Err(self.trouble("a number")),
        }
    }

    /// Parses a number, after an optional separator.
    pub fn next_number(&mut self) -> CursorResult<f64> {
        self.skip_comma();
        self.number()
    }

    /// Parses `0` or `1`, which needs no separator after it.
    pub fn flag(&mut self) -> CursorResult<bool> {
        self.skip_comma();
        match self.peek() {
            Some(digit @ (b'0' | b'1')) => {
                self.at += 1;
                Ok(digit == b'1')
            }
            _ => Err(self.trouble("a flag, 0 or 1,")),
        }
    }
}

/// Parses all numbers of a list. Returns the error too, if one ended it early.
pub(super) fn numbers(text: &str) -> (Vec<f64>, Option<SvgSyntaxError>) {
    let mut cursor = TextCursor::new(text);
    let mut values = Vec::new();
    cursor.skip_space();
    while !cursor.is_at_end() {
        match cursor.number() {
            Ok(value) => values.push(value),
            Err(trouble) => return (values, Some(trouble)),
        }
        if cursor.skip_comma() && cursor.is_at_end() {
            return (values, Some(cursor.trouble("a number")));
        }
    }
    (values, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_need_no_more_between_them_than_tells_them_apart() {
        let all = |text: &str| numbers(text);
        assert_eq!(all("1.5.5-3e2").0, [1.5, 0.5, -300.0]);
        assert_eq!(all(" +1,-.5 \t1e-2,2. ").0, [1.0, -0.5, 0.01, 2.0]);
        assert_eq!(all("1-2-3+4").0, [1.0, -2.0, -3.0, 4.0]);
        assert_eq!(all(""), (vec![], None));
    }

    #[test]
    fn trouble_says_where_and_what() {
        for (text, n, at, part, not_finite) in [
            ("1,,2", 1, 2, "','", false),
            ("1 x", 1, 2, "'x'", false),
            ("1 2,", 2, 4, "the end", false),
            ("1 1e999", 1, 2, "1e999", true),
            ("NaN", 0, 0, "NaN", true),
            ("-inf", 0, 0, "-inf", true),
            ("-", 0, 0, "'-'", false),
        ] {
            let (found, trouble) = numbers(text);
            let trouble = trouble.unwrap();
            assert_eq!((found.len(), trouble.at, trouble.not_finite), (n, at, not_finite), "{text}");
            assert!(trouble.what.contains(part), "{text}: {}", trouble.what);
        }
    }
}
