//! `JsonReader`: a streaming JSON reader that tracks its JSON pointer and builds no tree.
use crate::text::{number, show};
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::advice::Message;
use std::collections::HashSet;

/// The deepest nesting, whatever the limits allow. Chosen: each level takes some of the call stack.
const DEEPEST: usize = 512;

/// The kind of the next value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JsonKind {
    Object,
    Array,
    String,
    Number,
    /// `true`, `false` or `null`.
    Word,
}

#[derive(Debug)]
enum JsonPathStep {
    Key(String),
    Index(u64),
}

/// A position in a JSON text.
#[derive(Debug)]
pub(crate) struct JsonReader<'a> {
    bytes: &'a [u8],
    at: usize,
    deepest: usize,
    path: Vec<JsonPathStep>,
}

type JsonResult<T> = Result<T, ReadError>;

impl<'a> JsonReader<'a> {
    /// Starts at the beginning of a text.
    pub(crate) fn new(bytes: &'a [u8], limits: &Limits) -> JsonResult<Self> {
        if let Err(error) = std::str::from_utf8(bytes) {
            let place = FileLocation::Byte(error.valid_up_to() as u64);
            return Err(ReadError::new("not-utf8", place, "the text is not UTF-8"));
        }
        Ok(Self { bytes, at: 0, deepest: limits.depth.min(DEEPEST), path: Vec::new() })
    }

    /// The current location as a pointer; the file itself at the root.
    pub(crate) fn place(&self) -> FileLocation {
        if self.path.is_empty() {
            return FileLocation::File;
        }
        let step = |step: &JsonPathStep| match step {
            JsonPathStep::Key(key) => format!("/{}", key.replace('~', "~0").replace('/', "~1")),
            JsonPathStep::Index(index) => format!("/{index}"),
        };
        FileLocation::Pointer(self.path.iter().map(step).collect())
    }

    /// An error at the current location.
    pub(crate) fn error(&self, code: &'static str, message: impl Into<Message>) -> ReadError {
        ReadError::new(code, self.place(), message)
    }

    fn syntax(&self, expected: &str) -> ReadError {
        let rest = &self.bytes[self.at..];
        let actual = match rest.first() {
            None => "the end of the file".to_owned(),
            Some(_) => show(&rest[..rest.len().min(12)]),
        };
        ReadError::new(
            "not-json",
            FileLocation::Byte(self.at as u64),
            format!("{actual} where {expected} should stand"),
        )
    }

    fn skip_space(&mut self) {
        let rest = &self.bytes[self.at..];
        let space = |b: &u8| matches!(b, b' ' | b'\t' | b'\n' | b'\r');
        self.at += rest.iter().position(|b| !space(b)).unwrap_or(rest.len());
    }

    fn take(&mut self, byte: u8) -> bool {
        self.skip_space();
        let is_next = self.bytes.get(self.at) == Some(&byte);
        self.at += usize::from(is_next);
        is_next
    }

    /// The kind of the next value, without reading it.
    pub(crate) fn peek(&mut self) -> JsonResult<JsonKind> {
        self.skip_space();
        match self.bytes.get(self.at) {
            Some(b'{') => Ok(JsonKind::Object),
            Some(b'[') => Ok(JsonKind::Array),
            Some(b'"') => Ok(JsonKind::String),
            Some(b'-' | b'0'..=b'9') => Ok(JsonKind::Number),
            Some(b't' | b'f' | b'n') => Ok(JsonKind::Word),
            _ => Err(self.syntax("a value")),
        }
    }

    fn expect(&mut self, kind: JsonKind, what: &str) -> JsonResult<()> {
        let actual = self.peek()?;
        if actual == kind {
            return Ok(());
        }
        Err(self.error(
            "wrong-type",
            format!("{what} should stand here, not {actual:?}").replace("Word", "a word"),
        ))
    }

    fn enter(&mut self, step: JsonPathStep) -> JsonResult<()> {
        self.path.push(step);
        if self.path.len() > self.deepest {
            let message = format!("nested deeper than the limit of {} levels", self.deepest);
            return Err(ReadError::new("too-deep", FileLocation::Byte(self.at as u64), message));
        }
        Ok(())
    }

    /// Reads an array. `each` must read one element, and gets its index. Returns the number of elements.
    pub(crate) fn array(
        &mut self,
        mut each: impl FnMut(&mut Self, u64) -> JsonResult<()>,
    ) -> JsonResult<u64> {
        self.expect(JsonKind::Array, "an array")?;
        self.at += 1;
        if self.take(b']') {
            return Ok(0);
        }
        let mut index = 0;
        loop {
            self.enter(JsonPathStep::Index(index))?;
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

    /// Reads an object. `each` must read one value, and gets its key.
    pub(crate) fn object(
        &mut self,
        mut each: impl FnMut(&mut Self, &str) -> JsonResult<()>,
    ) -> JsonResult<()> {
        self.expect(JsonKind::Object, "an object")?;
        self.at += 1;
        if self.take(b'}') {
            return Ok(());
        }
        // Only queried for membership: no result depends on its order.
        let mut seen = HashSet::new();
        loop {
            self.skip_space();
            let key = self.string()?;
            self.enter(JsonPathStep::Key(key.clone()))?;
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

    /// Reads a number that is finite in double precision.
    pub(crate) fn number(&mut self) -> JsonResult<f64> {
        self.expect(JsonKind::Number, "a number")?;
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
    pub(crate) fn string(&mut self) -> JsonResult<String> {
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
        // The input is UTF-8 and escapes are whole characters, so nothing is replaced here.
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    fn escape(&mut self, text: &mut Vec<u8>) -> JsonResult<()> {
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

    fn escape_code(&mut self, text: &mut Vec<u8>) -> JsonResult<()> {
        let unit = |at: usize| -> Option<u32> {
            let digits = self.bytes.get(at..at + 6)?.strip_prefix(b"\\u")?;
            digits.iter().try_fold(0, |value, d| Some(16 * value + char::from(*d).to_digit(16)?))
        };
        let first = unit(self.at);
        let (code, length) = match first {
            // A surrogate pair for one character beyond the basic plane.
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
    pub(crate) fn flag(&mut self) -> JsonResult<bool> {
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let words = [(&b"true"[..], true), (&b"false"[..], false)];
        match words.iter().find(|(word, _)| rest.starts_with(word)) {
            Some((word, value)) => {
                self.at += word.len();
                Ok(*value)
            }
            None => Err(self.error("wrong-type", "true or false should stand here")),
        }
    }

    /// Reads a value of any kind and returns its text.
    pub(crate) fn raw(&mut self) -> JsonResult<&'a [u8]> {
        self.skip_space();
        let start = self.at;
        self.skip()?;
        Ok(&self.bytes[start..self.at])
    }

    /// Skips a value of any kind.
    pub(crate) fn skip(&mut self) -> JsonResult<()> {
        match self.peek()? {
            JsonKind::Object => self.object(|json, _| json.skip()),
            JsonKind::Array => self.array(|json, _| json.skip()).map(|_| ()),
            JsonKind::String => self.string().map(|_| ()),
            JsonKind::Number => self.number().map(|_| ()),
            JsonKind::Word => {
                let rest = &self.bytes[self.at..];
                let words: [&[u8]; 3] = [b"true", b"false", b"null"];
                let word = words.iter().find(|word| rest.starts_with(word));
                self.at += word.ok_or_else(|| self.syntax("a value"))?.len();
                Ok(())
            }
        }
    }

    /// Refuses anything but white space after the value.
    pub(crate) fn end(mut self) -> JsonResult<()> {
        self.skip_space();
        if self.at < self.bytes.len() { Err(self.syntax("the end of the file")) } else { Ok(()) }
    }
}

/// The grammar of RFC 8259, which is narrower than Rust's: no leading zero, no bare point, no plus.
fn is_json_number(token: &[u8]) -> bool {
    let rest = token.strip_prefix(b"-").unwrap_or(token);
    let digits = |text: &[u8]| text.iter().take_while(|b| b.is_ascii_digit()).count();
    let n_digits = digits(rest);
    if n_digits == 0 || (n_digits > 1 && rest[0] == b'0') {
        return false;
    }
    let mut rest = &rest[n_digits..];
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
