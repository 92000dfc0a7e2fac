//! `JsonValue`: the JSON chunk, parsed within limits.
//!
//! It has its own parser for three reasons. A file must not choose how much memory or nesting it takes.
//! Duplicate keys are refused instead of one being dropped. Numbers are rounded correctly. A value takes 24
//! bytes.
use crate::{FileLocation, Limits, ReadError};
use serde_json::{Map, Value};

/// A JSON value. Objects keep the order of the file, and have no duplicate keys.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum JsonValue {
    Null,
    Bool(bool),
    /// A number without point and exponent that fits into an i64.
    Int(i64),
    /// Any other number, finite.
    Float(f64),
    Text(Box<str>),
    Array(Box<[JsonValue]>),
    Object(Box<[(Box<str>, JsonValue)]>),
}

impl JsonValue {
    /// The value of a key; `None` if this is not an object.
    pub fn get(&self, key: &str) -> Option<&Self> {
        self.entries().iter().find(|(k, _)| **k == *key).map(|(_, value)| value)
    }

    /// The entries of an object; empty if this is not an object.
    pub fn entries(&self) -> &[(Box<str>, Self)] {
        if let Self::Object(entries) = self { entries } else { &[] }
    }

    /// The items of an array.
    pub fn items(&self) -> Option<&[Self]> {
        if let Self::Array(items) = self { Some(items) } else { None }
    }

    /// The text of a string.
    pub fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    /// The value of a number.
    #[allow(clippy::cast_precision_loss)]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Int(i) => Some(*i as f64),
            Self::Float(x) => Some(*x),
            _ => None,
        }
    }

    /// The value of a whole number, even if it is written as `3.0` or `3e2`.
    #[allow(clippy::cast_possible_truncation)]
    pub fn integer(&self) -> Option<i64> {
        match self {
            Self::Int(i) => Some(*i),
            // Below 2⁶³ in size the conversion is exact; larger numbers are neither counts nor indices.
            Self::Float(x) if x.trunc() == *x => Some(if x.abs() < 9_223_372_036_854_775_808.0 {
                *x as i64
            } else {
                i64::MAX.wrapping_mul(x.signum() as i64)
            }),
            _ => None,
        }
    }

    /// Converts to serde_json's value.
    pub fn to_value(&self) -> Value {
        match self {
            Self::Null => Value::Null,
            Self::Bool(b) => Value::from(*b),
            Self::Int(i) => Value::from(*i),
            Self::Float(x) => Value::from(*x),
            Self::Text(text) => Value::from(&**text),
            Self::Array(items) => items.iter().map(Self::to_value).collect(),
            Self::Object(entries) => {
                Value::Object(entries.iter().map(|(k, v)| (k.to_string(), v.to_value())).collect())
            }
        }
    }

    /// Parses a text that starts at byte `at` of the file.
    ///
    /// # Errors
    /// At the byte, if the text is not JSON, nests deeper than the limit, or repeats a key.
    pub fn parse(bytes: &[u8], at: u64, limits: &Limits) -> Result<Self, ReadError> {
        let invalid = |offset: usize, what: &str| {
            ReadError::new("INVALID_JSON", FileLocation::Byte(at + offset as u64), what.to_owned())
        };
        let text =
            std::str::from_utf8(bytes).map_err(|e| invalid(e.valid_up_to(), "the JSON is not UTF-8"))?;
        // Nesting takes stack here and wherever the value is traversed; a thousand levels fit any thread.
        let mut parser = JsonParser { text, at: 0, depth: limits.depth.min(1000) };
        let value = parser.value(0).and_then(|value| {
            parser.space();
            if parser.at == text.len() { Ok(value) } else { Err("the JSON goes on after its end".to_owned()) }
        });
        value.map_err(|what| invalid(parser.at, &what))
    }
}

/// The most bytes of JSON that are read. Chosen: a hundred thousand nodes take about ten million bytes.
pub(super) const MAX_BYTES: u64 = 256 << 20;

struct JsonParser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl JsonParser<'_> {
    fn peek(&self) -> u8 {
        self.text.as_bytes().get(self.at).copied().unwrap_or(0)
    }

    fn space(&mut self) {
        while matches!(self.peek(), b' ' | b'\t' | b'\n' | b'\r') {
            self.at += 1;
        }
    }

    fn eat(&mut self, byte: u8) -> bool {
        let is_next = self.peek() == byte;
        self.at += usize::from(is_next);
        is_next
    }

    fn value(&mut self, depth: usize) -> Result<JsonValue, String> {
        self.space();
        match self.peek() {
            b'{' | b'[' if depth >= self.depth => Err(format!("the JSON nests deeper than {}", self.depth)),
            b'{' => self.object(depth + 1),
            b'[' => self.array(depth + 1),
            b'"' => Ok(JsonValue::Text(self.string()?.into())),
            b't' => self.word("true", JsonValue::Bool(true)),
            b'f' => self.word("false", JsonValue::Bool(false)),
            b'n' => self.word("null", JsonValue::Null),
            b'-' | b'0'..=b'9' => self.number(),
            _ if self.at >= self.text.len() => Err("the JSON ends too early".to_owned()),
            _ => Err("a JSON value is expected".to_owned()),
        }
    }

    fn word(&mut self, word: &str, value: JsonValue) -> Result<JsonValue, String> {
        if !self.text[self.at..].starts_with(word) {
            return Err("a JSON value is expected".to_owned());
        }
        self.at += word.len();
        Ok(value)
    }

    fn array(&mut self, depth: usize) -> Result<JsonValue, String> {
        self.at += 1;
        let mut items = Vec::new();
        self.space();
        if !self.eat(b']') {
            loop {
                push(&mut items, self.value(depth)?)?;
                self.space();
                if self.eat(b']') {
                    break;
                }
                if !self.eat(b',') {
                    return Err("a comma or the end of a list is expected".to_owned());
                }
            }
        }
        Ok(JsonValue::Array(items.into()))
    }

    fn object(&mut self, depth: usize) -> Result<JsonValue, String> {
        self.at += 1;
        let mut entries: Vec<(Box<str>, JsonValue)> = Vec::new();
        self.space();
        if !self.eat(b'}') {
            loop {
                self.space();
                if self.peek() != b'"' {
                    return Err("a key is expected".to_owned());
                }
                let key = self.string()?.into();
                self.space();
                if !self.eat(b':') {
                    return Err("a colon is expected".to_owned());
                }
                let value = self.value(depth)?;
                push(&mut entries, (key, value))?;
                self.space();
                if self.eat(b'}') {
                    break;
                }
                if !self.eat(b',') {
                    return Err("a comma or the end of an object is expected".to_owned());
                }
            }
        }
        let mut keys: Vec<&str> = entries.iter().map(|(key, _)| &**key).collect();
        keys.sort_unstable();
        if let Some(twice) = keys.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("key {:?} comes twice in the object that ends here", twice[0]));
        }
        Ok(JsonValue::Object(entries.into()))
    }

    fn number(&mut self) -> Result<JsonValue, String> {
        let start = self.at;
        self.eat(b'-');
        if !self.eat(b'0') && self.digits() == 0 {
            return Err("a digit is expected".to_owned());
        }
        let mut is_integer = true;
        if self.eat(b'.') {
            is_integer = false;
            if self.digits() == 0 {
                return Err("a digit is expected".to_owned());
            }
        }
        if self.eat(b'e') || self.eat(b'E') {
            is_integer = false;
            if !self.eat(b'-') {
                self.eat(b'+');
            }
            if self.digits() == 0 {
                return Err("a digit is expected".to_owned());
            }
        }
        let text = &self.text[start..self.at];
        if let (true, Ok(i)) = (is_integer && text != "-0", text.parse()) {
            return Ok(JsonValue::Int(i));
        }
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(JsonValue::Float(x)),
            _ => Err("the number is too large".to_owned()),
        }
    }

    fn digits(&mut self) -> usize {
        let start = self.at;
        while self.peek().is_ascii_digit() {
            self.at += 1;
        }
        self.at - start
    }

    fn string(&mut self) -> Result<String, String> {
        self.at += 1;
        let mut out = String::new();
        loop {
            let rest = &self.text[self.at..];
            let plain = rest.find(|c: char| c == '"' || c == '\\' || c < ' ').unwrap_or(rest.len());
            out.push_str(&rest[..plain]);
            self.at += plain;
            if self.eat(b'"') {
                return Ok(out);
            }
            if !self.eat(b'\\') {
                return Err("a string has no end or holds a control character".to_owned());
            }
            out.push(self.escape()?);
        }
    }

    fn escape(&mut self) -> Result<char, String> {
        let kind = self.peek();
        self.at += 1;
        Ok(match kind {
            b'"' | b'\\' | b'/' => char::from(kind),
            b'b' => '\u{8}',
            b'f' => '\u{c}',
            b'n' => '\n',
            b'r' => '\r',
            b't' => '\t',
            b'u' => return self.unicode(),
            _ => {
                self.at -= 1;
                return Err("an escape is unknown".to_owned());
            }
        })
    }

    fn unicode(&mut self) -> Result<char, String> {
        let mut units = [self.hex()?, 0];
        let mut n_units = 1;
        // Characters above U+FFFF are written as surrogate pairs.
        if (0xD800..0xDC00).contains(&units[0]) && self.text[self.at..].starts_with("\\u") {
            self.at += 2;
            units[1] = self.hex()?;
            n_units = 2;
        }
        let mut decoded = char::decode_utf16(units[..n_units].iter().copied());
        match (decoded.next(), decoded.next()) {
            (Some(Ok(c)), None) => Ok(c),
            _ => Err("half a surrogate pair is no character".to_owned()),
        }
    }

    fn hex(&mut self) -> Result<u16, String> {
        let digits = self.text.as_bytes().get(self.at..self.at + 4);
        let digits = digits.filter(|d| d.iter().all(u8::is_ascii_hexdigit));
        let digits = digits.and_then(|d| std::str::from_utf8(d).ok());
        let unit = digits.and_then(|d| u16::from_str_radix(d, 16).ok());
        self.at += if unit.is_some() { 4 } else { 0 };
        unit.ok_or_else(|| "four hexadecimal digits are expected".to_owned())
    }
}

/// Appends to a list. Long lists grow by only a quarter, since a file with one long list decides how much is
/// allocated.
fn push<T>(list: &mut Vec<T>, item: T) -> Result<(), String> {
    if list.len() == list.capacity() {
        let more = (list.len() / 4).max(4);
        list.try_reserve_exact(more).map_err(|_| "the JSON takes more memory than there is".to_owned())?;
    }
    list.push(item);
    Ok(())
}

/// The members of an object except some.
pub(super) fn members_without(object: &JsonValue, left_out: &[&str]) -> Map<String, Value> {
    let kept = object.entries().iter().filter(|(key, _)| !left_out.contains(&&**key));
    kept.map(|(key, value)| (key.to_string(), value.to_value())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<JsonValue, String> {
        JsonValue::parse(text.as_bytes(), 0, &Limits::default()).map_err(|e| e.to_string())
    }

    #[test]
    fn a_value_takes_24_bytes() {
        assert_eq!(size_of::<JsonValue>(), 24);
    }

    #[test]
    fn agrees_with_another_parser_on_what_is_json() {
        for text in [
            r#"{"a":[1,2.5,-0,1e2,true,false,null,"x\n\u0041\ud83d\ude00\/"],"b":{}}"#,
            "  [ ] ",
            "-0.0",
            "1e-400",
            "123456789012345678901234567890",
            "[1,]",
            "{,}",
            "01",
            "1.",
            ".5",
            "+1",
            "1e",
            "nul",
            "\"\\x\"",
            "\"a\nb\"",
            "\"\\ud800\"",
            "[1 2]",
            "{\"a\" 1}",
            "",
            " ",
            "{} x",
            "NaN",
            "\u{feff}{}",
        ] {
            let theirs = serde_json::from_str::<Value>(text);
            let ours = parse(text);
            assert_eq!(ours.is_ok(), theirs.is_ok(), "{text:?}: {ours:?}, {theirs:?}");
            if let (Ok(ours), Ok(theirs)) = (ours, theirs) {
                if let (JsonValue::Float(ours), Some(theirs)) = (&ours, theirs.as_f64()) {
                    assert_eq!(*ours, theirs);
                } else if !text.contains("1e2") {
                    assert_eq!(ours.to_value(), theirs);
                }
            }
        }
    }

    #[test]
    fn keeps_numbers_to_the_last_bit() {
        for x in [0.1, 5e-324, 1.797_693_134_862_315_7e308, 2.225_073_858_507_201_4e-308, 0.001] {
            assert_eq!(parse(&format!("{x:e}")).unwrap().number(), Some(x));
            assert_eq!(parse(&Value::from(x).to_string()).unwrap().number(), Some(x));
        }
        assert!(parse("1e400").unwrap_err().contains("too large"));
    }

    #[test]
    fn refuses_nesting_past_the_limit_and_keys_that_come_twice() {
        let nested = |n: usize| "[".repeat(n) + &"]".repeat(n);
        assert!(parse(&nested(128)).is_ok());
        assert_eq!(parse(&nested(129)).unwrap_err(), "byte 128: the JSON nests deeper than 128");
        assert!(parse(&nested(200_000)).is_err());
        assert!(parse(r#"{"a":1,"b":2,"a":3}"#).unwrap_err().contains("\"a\" comes twice"));
        assert!(parse(r#"{"__proto__":{"a":1}}"#).is_ok());
    }
}
