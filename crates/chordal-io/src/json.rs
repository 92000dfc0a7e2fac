//! `JsonReader`: a streaming JSON reader that tracks its JSON pointer and builds no tree.
use crate::text::{number, show};
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::advice::Message;
use std::borrow::Cow;
use std::collections::BTreeSet;

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
enum JsonPathStep<'a> {
    Key(Cow<'a, str>),
    Index(u64),
}

/// A position in a JSON text.
#[derive(Debug)]
pub(crate) struct JsonReader<'a> {
    text: &'a str,
    at: usize,
    deepest: usize,
    path: Vec<JsonPathStep<'a>>,
}

type JsonResult<T> = Result<T, ReadError>;

impl<'a> JsonReader<'a> {
    /// Starts at the beginning of a text.
    pub(crate) fn new(bytes: &'a [u8], limits: &Limits) -> JsonResult<Self> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let place = FileLocation::Byte(error.valid_up_to() as u64);
            ReadError::new("not-utf8", place, "the text is not UTF-8")
        })?;
        Ok(Self { text, at: 0, deepest: limits.depth.min(DEEPEST), path: Vec::new() })
    }

    fn bytes(&self) -> &'a [u8] {
        self.text.as_bytes()
    }

    /// The byte up to which the text was read; after an error, the byte of the error.
    pub(crate) fn at(&self) -> usize {
        self.at
    }

    /// The current location as a pointer; the file itself at the root.
    pub(crate) fn place(&self) -> FileLocation {
        if self.path.is_empty() {
            return FileLocation::File;
        }
        let step = |step: &JsonPathStep<'_>| match step {
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
        let rest = &self.bytes()[self.at..];
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
        let rest = &self.bytes()[self.at..];
        let space = |b: &u8| matches!(b, b' ' | b'\t' | b'\n' | b'\r');
        self.at += rest.iter().position(|b| !space(b)).unwrap_or(rest.len());
    }

    fn take(&mut self, byte: u8) -> bool {
        self.skip_space();
        let is_next = self.bytes().get(self.at) == Some(&byte);
        self.at += usize::from(is_next);
        is_next
    }

    /// The kind of the next value, without reading it.
    pub(crate) fn peek(&mut self) -> JsonResult<JsonKind> {
        self.skip_space();
        match self.bytes().get(self.at) {
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

    /// Passes the bracket of an array or an object.
    fn open(&mut self) -> JsonResult<()> {
        if self.path.len() >= self.deepest {
            let message = format!("nested deeper than the limit of {} levels", self.deepest);
            return Err(ReadError::new("too-deep", FileLocation::Byte(self.at as u64), message));
        }
        self.at += 1;
        Ok(())
    }

    /// Reads an array. `each` must read one element, and gets its index. Returns the number of elements.
    pub(crate) fn array(
        &mut self,
        mut each: impl FnMut(&mut Self, u64) -> JsonResult<()>,
    ) -> JsonResult<u64> {
        self.expect(JsonKind::Array, "an array")?;
        self.open()?;
        if self.take(b']') {
            return Ok(0);
        }
        let mut index = 0;
        loop {
            self.path.push(JsonPathStep::Index(index));
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
        self.open()?;
        if self.take(b'}') {
            return Ok(());
        }
        let mut seen = BTreeSet::new();
        loop {
            self.skip_space();
            let key = self.characters()?;
            self.path.push(JsonPathStep::Key(key.clone()));
            if !self.take(b':') {
                return Err(self.syntax("':'"));
            }
            if seen.contains(&key) {
                return Err(self.error("duplicate-key", format!("{key:?} comes twice in one object")));
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
        let token = self.number_token()?;
        self.finite(token)
    }

    /// The value of a number as it is spelled, if it is finite in double precision.
    pub(crate) fn finite(&self, token: &[u8]) -> JsonResult<f64> {
        number(token)
            .filter(|value| value.is_finite())
            .ok_or_else(|| self.error("not-finite", format!("{} is over the limit of 1.8e308", show(token))))
    }

    /// Reads a number as it is spelled.
    pub(crate) fn number_token(&mut self) -> JsonResult<&'a [u8]> {
        self.expect(JsonKind::Number, "a number")?;
        let rest = &self.bytes()[self.at..];
        let end = rest
            .iter()
            .position(|b| !matches!(b, b'-' | b'+' | b'.' | b'e' | b'E' | b'0'..=b'9'))
            .unwrap_or(rest.len());
        let token = &rest[..end];
        if !is_json_number(token) {
            return Err(self.syntax("a number"));
        }
        self.at += end;
        Ok(token)
    }

    /// Reads a string.
    pub(crate) fn string(&mut self) -> JsonResult<String> {
        self.characters().map(Cow::into_owned)
    }

    /// Reads a string; it is that of the text if nothing in it is escaped.
    pub(crate) fn characters(&mut self) -> JsonResult<Cow<'a, str>> {
        if !self.take(b'"') {
            return Err(self.syntax("a string"));
        }
        let mut characters = Cow::Borrowed("");
        loop {
            let rest = &self.bytes()[self.at..];
            let n = rest.iter().position(|b| matches!(b, b'"' | b'\\' | 0..0x20)).unwrap_or(rest.len());
            let plain = &self.text[self.at..self.at + n];
            if characters.is_empty() {
                characters = Cow::Borrowed(plain);
            } else {
                characters.to_mut().push_str(plain);
            }
            self.at += n;
            match rest.get(n) {
                Some(b'"') => {
                    self.at += 1;
                    return Ok(characters);
                }
                Some(b'\\') => characters.to_mut().push(self.escape()?),
                Some(_) => return Err(self.syntax("an escaped control character")),
                None => return Err(self.syntax("'\"'")),
            }
        }
    }

    fn escape(&mut self) -> JsonResult<char> {
        let plain = match self.bytes().get(self.at + 1) {
            Some(b'u') => return self.escape_code(),
            Some(b'b') => '\u{8}',
            Some(b'f') => '\u{c}',
            Some(b'n') => '\n',
            Some(b'r') => '\r',
            Some(b't') => '\t',
            Some(same @ (b'"' | b'\\' | b'/')) => char::from(*same),
            _ => return Err(self.syntax("an escape")),
        };
        self.at += 2;
        Ok(plain)
    }

    fn escape_code(&mut self) -> JsonResult<char> {
        let unit = |at: usize| -> Option<u32> {
            let digits = self.bytes().get(at..at + 6)?.strip_prefix(b"\\u")?;
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
        self.at += length;
        Ok(character)
    }

    /// Reads `true` or `false`.
    pub(crate) fn flag(&mut self) -> JsonResult<bool> {
        match self.word() {
            Ok(Some(value)) => Ok(value),
            _ => Err(self.error("wrong-type", "true or false should stand here")),
        }
    }

    /// Reads `true`, `false` or `null`, which is `None`.
    pub(crate) fn word(&mut self) -> JsonResult<Option<bool>> {
        self.skip_space();
        let rest = &self.bytes()[self.at..];
        let words = [(&b"true"[..], Some(true)), (&b"false"[..], Some(false)), (&b"null"[..], None)];
        let found = words.into_iter().find(|(word, _)| rest.starts_with(word));
        let (word, value) = found.ok_or_else(|| self.syntax("a value"))?;
        self.at += word.len();
        Ok(value)
    }

    /// Reads a value of any kind and returns its text.
    pub(crate) fn raw(&mut self) -> JsonResult<&'a [u8]> {
        self.skip_space();
        let start = self.at;
        self.skip()?;
        Ok(&self.bytes()[start..self.at])
    }

    /// Skips a value of any kind.
    pub(crate) fn skip(&mut self) -> JsonResult<()> {
        match self.peek()? {
            JsonKind::Object => self.object(|json, _| json.skip()),
            JsonKind::Array => self.array(|json, _| json.skip()).map(|_| ()),
            JsonKind::String => self.characters().map(|_| ()),
            JsonKind::Number => self.number().map(|_| ()),
            JsonKind::Word => self.word().map(|_| ()),
        }
    }

    /// Refuses anything but white space after the value.
    pub(crate) fn end(&mut self) -> JsonResult<()> {
        self.skip_space();
        if self.at < self.bytes().len() { Err(self.syntax("the end of the file")) } else { Ok(()) }
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
