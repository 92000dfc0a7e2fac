//! `Json`: reads JSON piece by piece, keeps the pointer to where it is, and builds no tree.
use crate::text::{number, show};
use crate::{Limits, Place, ReadError};
use std::collections::HashSet;

/// The deepest nesting that is read whatever the limits say: each level takes some of the call stack.
const DEEPEST: usize = 512;

/// What comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Object,
    Array,
    String,
    Number,
    /// `true`, `false` or `null`.
    Word,
}

#[derive(Debug)]
enum Step {
    Key(String),
    Index(u64),
}

/// A place in a JSON text.
#[derive(Debug)]
pub(crate) struct Json<'a> {
    bytes: &'a [u8],
    at: usize,
    deepest: usize,
    path: Vec<Step>,
}

type Outcome<T> = Result<T, ReadError>;

impl<'a> Json<'a> {
    /// At the start of a text.
    pub(crate) fn new(bytes: &'a [u8], limits: &Limits) -> Outcome<Self> {
        if let Err(error) = std::str::from_utf8(bytes) {
            let place = Place::Byte(error.valid_up_to() as u64);
            return Err(ReadError::new("not-utf8", place, "the text is not UTF-8"));
        }
        Ok(Self { bytes, at: 0, deepest: limits.depth.min(DEEPEST), path: Vec::new() })
    }

    /// Where this is, as a pointer; the root is the file.
    pub(crate) fn place(&self) -> Place {
        if self.path.is_empty() {
            return Place::File;
        }
        let step = |step: &Step| match step {
            Step::Key(key) => format!("/{}", key.replace('~', "~0").replace('/', "~1")),
            Step::Index(index) => format!("/{index}"),
        };
        Place::Pointer(self.path.iter().map(step).collect())
    }

    /// An error here.
    pub(crate) fn error(&self, code: &'static str, message: impl Into<String>) -> ReadError {
        ReadError::new(code, self.place(), message)
    }

    fn syntax(&self, expected: &str) -> ReadError {
        let rest = &self.bytes[self.at..];
        let found = match rest.first() {
            None => "the end of the file".to_owned(),
            Some(_) => show(&rest[..rest.len().min(12)]),
        };
        ReadError::new(
            "not-json",
            Place::Byte(self.at as u64),
            format!("{found} where {expected} should stand"),
        )
    }

    fn skip_space(&mut self) {
        let rest = &self.bytes[self.at..];
        let space = |b: &u8| matches!(b, b' ' | b'\t' | b'\n' | b'\r');
        self.at += rest.iter().position(|b| !space(b)).unwrap_or(rest.len());
    }

    fn take(&mut self, byte: u8) -> bool {
        self.skip_space();
        let found = self.bytes.get(self.at) == Some(&byte);
        self.at += usize::from(found);
        found
    }

    /// What comes next.
    pub(crate) fn peek(&mut self) -> Outcome<Kind> {
        self.skip_space();
        match self.bytes.get(self.at) {
            Some(b'{') => Ok(Kind::Object),
            Some(b'[') => Ok(Kind::Array),
            Some(b'"') => Ok(Kind::String),
            Some(b'-' | b'0'..=b'9') => Ok(Kind::Number),
            Some(b't' | b'f' | b'n') => Ok(Kind::Word),
            _ => Err(self.syntax("a value")),
        }
    }

    fn expect(&mut self, kind: Kind, what: &str) -> Outcome<()> {
        let found = self.peek()?;
        if found == kind {
            return Ok(());
        }
        Err(self.error(
            "wrong-type",
            format!("{what} should stand here, not {found:?}").replace("Word", "a word"),
        ))
    }

    fn enter(&mut self, step: Step) -> Outcome<()> {
        self.path.push(step);
        if self.path.len() > self.deepest {
            let message = format!("nested deeper than the limit of {} levels", self.deepest);
            return Err(ReadError::new("too-deep", Place::Byte(self.at as u64), message));
        }
        Ok(())
    }

    /// Reads an array: `each` must read one element, whose index it gets. Returns the number of elements.
    pub(crate) fn array(&mut self, mut each: impl FnMut(&mut Self, u64) -> Outcome<()>) -> Outcome<u64> {
        self.expect(Kind::Array, "an array")?;
        self.at += 1;
        if self.take(b']') {
            return Ok(0);
        }
        let mut index = 0;
        loop {
            self.enter(Step::Index(index))?;
            each(self, index)?;
            self.path.pop();
            index += 1;
            if self.take(b']') {
                return Ok(index);
            }
            if !self.take(b',') {
                return Err(self.syntax("',' or ']'"));
            }
        }
    }

    /// Reads an object: `each` must read one value, whose key it gets.
    pub(crate) fn object(&mut self, mut each: impl FnMut(&mut Self, &str) -> Outcome<()>) -> Outcome<()> {
        self.expect(Kind::Object, "an object")?;
        self.at += 1;
        if self.take(b'}') {
            return Ok(());
        }
        // Only asked whether a key was there before: no order depends on it.
        let mut seen = HashSet::new();
        loop {
            self.skip_space();
            let key = self.string()?;
            self.enter(Step::Key(key.clone()))?;
            if !self.take(b':') {
                return Err(self.syntax("':'"));
            }
            if seen.contains(&key) {
                return Err(self.error("duplicate-key", "this key stands twice in one object"));
            }
            each(self, &key)?;
            seen.insert(key);
            self.path.pop();
            if self.take(b'}') {
                return Ok(());
            }
            if !self.take(b',') {
                return Err(self.syntax("',' or '}'"));
            }
        }
    }

    /// Reads a number that is finite as an f64.
    pub(crate) fn number(&mut self) -> Outcome<f64> {
        self.expect(Kind::Number, "a number")?;
        let rest = &self.bytes[self.at..];
        let end = rest
            .iter()
            .position(|b| !matches!(b, b'-' | b'+' | b'.' | b'e' | b'E' | b'0'..=b'9'))
            .unwrap_or(rest.len());
        let token = &rest[..end];
        if !is_json_number(token) {
            return Err(self.syntax("a number"));
        }
        let value = number(token).filter(|value| value.is_finite()).ok_or_else(|| {
            self.error("not-finite", format!("{} is over the limit of 1.8e308", show(token)))
        })?;
        self.at += end;
        Ok(value)
    }

    /// Reads a string.
    pub(crate) fn string(&mut self) -> Outcome<String> {
        if !self.take(b'"') {
            return Err(self.syntax("a string"));
        }
        let mut text = Vec::new();
        loop {
            let Some(&byte) = self.bytes.get(self.at) else { return Err(self.syntax("'\"'")) };
            match byte {
                b'"' => break,
                b'\\' => self.escape(&mut text)?,
                0..0x20 => return Err(self.syntax("an escaped control character")),
                _ => {
                    text.push(byte);
                    self.at += 1;
                }
            }
        }
        self.at += 1;
        // The input is UTF-8 and escapes are whole characters, so that nothing is replaced here.
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    fn escape(&mut self, text: &mut Vec<u8>) -> Outcome<()> {
        let plain = match self.bytes.get(self.at + 1) {
            Some(b'u') => return self.escape_code(text),
            Some(b'b') => 0x08,
            Some(b'f') => 0x0c,
            Some(b'n') => b'\n',
            Some(b'r') => b'\r',
            Some(b't') => b'\t',
            Some(same @ (b'"' | b'\\' | b'/')) => *same,
            _ => return Err(self.syntax("an escape")),
        };
        text.push(plain);
        self.at += 2;
        Ok(())
    }

    fn escape_code(&mut self, text: &mut Vec<u8>) -> Outcome<()> {
        let unit = |at: usize| -> Option<u32> {
            let digits = self.bytes.get(at..at + 6)?.strip_prefix(b"\\u")?;
            digits.iter().try_fold(0, |value, d| Some(16 * value + char::from(*d).to_digit(16)?))
        };
        let first = unit(self.at);
        let (code, length) = match first {
            // Two halves of one character beyond the basic plane.
            Some(high @ 0xd800..0xdc00) => match unit(self.at + 6) {
                Some(low @ 0xdc00..0xe000) => (Some(0x10000 + ((high - 0xd800) << 10) + (low - 0xdc00)), 12),
                _ => (None, 0),
            },
            code => (code, 6),
        };
        let Some(character) = code.and_then(char::from_u32) else {
            return Err(self.syntax("an escaped character"));
        };
        text.extend(character.encode_utf8(&mut [0; 4]).as_bytes());
        self.at += length;
        Ok(())
    }

    /// Reads `true` or `false`.
    pub(crate) fn flag(&mut self) -> Outcome<bool> {
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let known = [(&b"true"[..], true), (&b"false"[..], false)];
        match known.iter().find(|(word, _)| rest.starts_with(word)) {
            Some((word, value)) => {
                self.at += word.len();
                Ok(*value)
            }
            None => Err(self.error("wrong-type", "true or false should stand here")),
        }
    }

    /// Reads a value of any kind, as the text that it is.
    pub(crate) fn raw(&mut self) -> Outcome<&'a [u8]> {
        self.skip_space();
        let start = self.at;
        self.skip()?;
        Ok(&self.bytes[start..self.at])
    }

    /// Reads a value of any kind and forgets it.
    pub(crate) fn skip(&mut self) -> Outcome<()> {
        match self.peek()? {
            Kind::Object => self.object(|json, _| json.skip()),
            Kind::Array => self.array(|json, _| json.skip()).map(|_| ()),
            Kind::String => self.string().map(|_| ()),
            Kind::Number => self.number().map(|_| ()),
            Kind::Word => {
                let rest = &self.bytes[self.at..];
                let words: [&[u8]; 3] = [b"true", b"false", b"null"];
                let word = words.iter().find(|word| rest.starts_with(word));
                self.at += word.ok_or_else(|| self.syntax("a value"))?.len();
                Ok(())
            }
        }
    }

    /// Refuses anything but space after the value.
    pub(crate) fn end(mut self) -> Outcome<()> {
        self.skip_space();
        if self.at < self.bytes.len() { Err(self.syntax("the end of the file")) } else { Ok(()) }
    }
}

/// The grammar of RFC 8259, which is narrower than that of Rust: no leading zero, no bare point, no plus.
fn is_json_number(token: &[u8]) -> bool {
    let rest = token.strip_prefix(b"-").unwrap_or(token);
    let digits = |text: &[u8]| text.iter().take_while(|b| b.is_ascii_digit()).count();
    let whole = digits(rest);
    if whole == 0 || (whole > 1 && rest[0] == b'0') {
        return false;
    }
    let mut rest = &rest[whole..];
    if let Some(fraction) = rest.strip_prefix(b".") {
        let n = digits(fraction);
        if n == 0 {
            return false;
        }
        rest = &fraction[n..];
    }
    let Some(exponent) = rest.strip_prefix(b"e").or_else(|| rest.strip_prefix(b"E")) else {
        return rest.is_empty();
    };
    let exponent = exponent.strip_prefix(b"-").or_else(|| exponent.strip_prefix(b"+")).unwrap_or(exponent);
    !exponent.is_empty() && digits(exponent) == exponent.len()
}
