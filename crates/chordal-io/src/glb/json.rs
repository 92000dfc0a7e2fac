//! `JsonValue`: the JSON chunk as a tree, parsed within limits.
//!
//! serde_json's own tree is not used for two reasons. It drops one of two equal keys, which are refused here.
//! It takes more memory: a value takes 24 bytes here, and a file must not choose how much memory or nesting
//! it takes.
use crate::json::{JsonKind, JsonReader};
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
        let invalid = |offset: u64, error: ReadError| {
            ReadError::new("INVALID_JSON", FileLocation::Byte(at + offset), error.message)
        };
        let mut json = JsonReader::new(bytes, limits).map_err(|error| match error.place {
            FileLocation::Byte(offset) => invalid(offset, error),
            _ => invalid(0, error),
        })?;
        let value = value(&mut json).and_then(|value| json.end().map(|()| value));
        value.map_err(|error| invalid(json.at() as u64, error))
    }
}

/// The most bytes of JSON that are read. Chosen: a hundred thousand nodes take about ten million bytes.
pub(super) const MAX_BYTES: u64 = 256 << 20;

/// Reads one value with all values inside.
fn value(json: &mut JsonReader<'_>) -> Result<JsonValue, ReadError> {
    Ok(match json.peek()? {
        JsonKind::Object => {
            let mut entries: Vec<(Box<str>, JsonValue)> = Vec::new();
            json.object(|json, key| push(&mut entries, (key.into(), value(json)?)))?;
            JsonValue::Object(entries.into())
        }
        JsonKind::Array => {
            let mut items = Vec::new();
            json.array(|json, _| push(&mut items, value(json)?))?;
            JsonValue::Array(items.into())
        }
        JsonKind::String => JsonValue::Text(json.characters()?.into()),
        JsonKind::Word => json.word()?.map_or(JsonValue::Null, JsonValue::Bool),
        JsonKind::Number => {
            let token = json.number_token()?;
            // -0 is a number of its own, which an integer cannot hold.
            let integer = std::str::from_utf8(token).ok().filter(|token| *token != "-0");
            match integer.and_then(|token| token.parse().ok()) {
                Some(integer) => JsonValue::Int(integer),
                None => JsonValue::Float(json.finite(token)?),
            }
        }
    })
}

/// Appends to a list. Long lists grow by only a quarter, since a file with one long list decides how much is
/// allocated.
fn push<T>(list: &mut Vec<T>, item: T) -> Result<(), ReadError> {
    if list.len() == list.capacity() {
        let more = (list.len() / 4).max(4);
        list.try_reserve_exact(more).map_err(|_| crate::grow::out_of_memory(list.len()))?;
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
        assert!(parse("1e400").unwrap_err().contains("over the limit"));
    }

    #[test]
    fn refuses_nesting_past_the_limit_and_keys_that_come_twice() {
        let nested = |n: usize| "[".repeat(n) + &"]".repeat(n);
        assert!(parse(&nested(128)).is_ok());
        assert_eq!(parse(&nested(129)).unwrap_err(), "byte 128: nested deeper than the limit of 128 levels");
        assert!(parse(&nested(200_000)).is_err());
        assert!(parse(r#"{"a":1,"b":2,"a":3}"#).unwrap_err().contains("\"a\" comes twice"));
        assert!(parse(r#"{"__proto__":{"a":1}}"#).is_ok());
    }
}
