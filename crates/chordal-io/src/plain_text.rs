//! `PlainCursor`: the fast way through the lines of a text that are spelled as programs spell them. What it
//! does not take is left, untouched, to the reader that takes everything and says what is wrong.
use crate::text::number;
use memchr::memchr2;

/// A cursor in a text. After a call that returned `None` its place means nothing: go back to where the line
/// began.
#[derive(Clone, Debug)]
pub(crate) struct PlainCursor<'a> {
    pub(crate) text: &'a [u8],
    pub(crate) at: usize,
}

/// Powers of ten that are numbers of f64 to the last bit: 5²² < 2⁵³.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Digits that a u64 always holds: 10¹⁹ < 2⁶⁴.
const MOST_DIGITS: usize = 19;

/// A decimal of few digits that is a quotient or a product of two numbers that f64 holds exactly, so that one
/// rounding makes the nearest number: W. Clinger, *How to Read Floating Point Numbers Accurately*, 1990. With
/// the number of bytes that it takes; what follows is not looked at.
#[inline]
pub(crate) fn short_decimal(text: &[u8]) -> Option<(f64, usize)> {
    let negative = text.first() == Some(&b'-');
    let start = usize::from(negative);
    let (mut value, mut at) = (0_u64, start);
    while let Some(digit) = digit(text, at) {
        value = value.wrapping_mul(10).wrapping_add(digit);
        at += 1;
    }
    let (mut n_digits, mut n_decimals) = (at - start, 0);
    if text.get(at) == Some(&b'.') {
        at += 1;
        let point = at;
        while let Some(digit) = digit(text, at) {
            value = value.wrapping_mul(10).wrapping_add(digit);
            at += 1;
        }
        n_digits += at - point;
        n_decimals = at - point;
    }
    if n_digits == 0 || n_digits > MOST_DIGITS || value > 1 << f64::MANTISSA_DIGITS {
        return None;
    }
    let mut scale = -(n_decimals as i32);
    if let Some(b'e' | b'E') = text.get(at) {
        let sign = text.get(at + 1);
        let minus = sign == Some(&b'-');
        let first = at + 1 + usize::from(minus || sign == Some(&b'+'));
        at = first;
        let mut exponent = 0_i32;
        while let Some(digit) = digit(text, at) {
            exponent = exponent.wrapping_mul(10).wrapping_add(digit as i32);
            at += 1;
        }
        // Three digits are more than POWERS has, and an exponent of many does not fit.
        if at == first || at - first > 3 {
            return None;
        }
        scale += if minus { -exponent } else { exponent };
    }
    let power = *POWERS.get(scale.unsigned_abs() as usize)?;
    let size = if scale < 0 { value as f64 / power } else { value as f64 * power };
    Some((if negative { -size } else { size }, at))
}

#[inline]
fn digit(text: &[u8], at: usize) -> Option<u64> {
    let digit = text.get(at)?.wrapping_sub(b'0');
    (digit < 10).then_some(u64::from(digit))
}

impl PlainCursor<'_> {
    #[inline]
    fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    /// Passes spaces and tabs.
    #[inline]
    pub(crate) fn skip_blanks(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t')) {
            self.at += 1;
        }
    }

    /// Passes a word that stands here with a blank after it.
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

    /// A whole number of few digits after its sign.
    #[inline]
    pub(crate) fn whole(&mut self) -> Option<i32> {
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

    /// Passes a byte, if it stands here.
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

    /// Whether the line goes on after blanks.
    #[inline]
    pub(crate) fn goes_on(&mut self) -> bool {
        self.skip_blanks();
        !matches!(self.peek(), None | Some(b'\n' | b'\r'))
    }

    /// Passes blanks and the end of the line.
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

    /// Passes the rest of the line, and its end.
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

/// The parts that a text is cut into, each of about `size` bytes and of whole lines; where `keeps` says so of
/// the lines so far, without the end of the last, the next one stays with them.
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

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn short_decimals_are_the_numbers_that_std_reads() {
        let mut random = Random::new(7);
        let mut n_short = 0;
        for i in 0..200_000_u64 {
            let bits = random.bits();
            let text = match i % 5 {
                0 => (f32::from_bits(bits as u32)).to_string(),
                1 => format!("{:e}", f32::from_bits(bits as u32)),
                2 => format!("{:.*}", (bits % 12) as usize, (bits >> 40) as f64 / 977.0),
                3 => format!("{}{}", if bits & 1 == 0 { "-" } else { "" }, (bits >> 1) >> (bits % 60)),
                _ => format!("{}.{}e{}", bits % 1000, bits >> (bits % 64), (bits % 60) as i64 - 30),
            };
            if let Some((value, n)) = short_decimal(text.as_bytes()) {
                assert_eq!(n, text.len(), "{text}");
                assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(value.to_bits()), "{text}");
                n_short += 1;
            }
        }
        assert!(n_short > 80_000, "{n_short}");
        for text in ["", "-", ".", "-.", "+1", "x", "nan", "inf", "1e", "1e+", "e5", "1e9999"] {
            assert_eq!(short_decimal(text.as_bytes()), None, "{text}");
        }
        assert_eq!(short_decimal(b"-0").map(|(x, n)| (x.to_bits(), n)), Some(((-0.0_f64).to_bits(), 2)));
        assert_eq!(short_decimal(b"2.5,1"), Some((2.5, 3)));
    }

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
