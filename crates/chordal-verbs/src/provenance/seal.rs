//! The seal of a certificate: a digest of all its values. It detects accidental edits, and is not a signature: after an
//! edit on purpose, anybody can seal again.
use super::digest::sha256;
use serde_json::{Map, Number, Value};

/// The key of the seal in a certificate.
pub(crate) const SEAL: &str = "seal";

/// The SHA-256 of a certificate's canonical JSON without its seal: keys in order, no spaces, whole numbers without a point
/// and others in their shortest form. So tools that write the same values in another form do not break it.
///
/// ```
/// use chordal_verbs::seal_of;
/// let of = |text: &str| seal_of(&serde_json::from_str(text).unwrap());
/// assert_eq!(of(r#"{"a": 1.0, "b": [true, null]}"#), of(r#"{ "b":[true,null], "a":1, "seal":"x" }"#));
/// assert_eq!(of(r#"{"a": 1.5e-07}"#), of(r#"{"a": 1.5e-7}"#));
/// assert_ne!(of(r#"{"a": 1.0}"#), of(r#"{"a": 1.0000000000000002}"#));
/// ```
#[must_use]
pub fn seal_of(certificate: &Value) -> String {
    let mut text = String::new();
    match certificate {
        Value::Object(map) => add_object(&mut text, map, &|key| key != SEAL),
        other => add(&mut text, other),
    }
    sha256(text.as_bytes())
}

fn add(text: &mut String, value: &Value) {
    match value {
        Value::Object(map) => add_object(text, map, &|_| true),
        Value::Array(items) => {
            text.push('[');
            for (i, item) in items.iter().enumerate() {
                if i > 0 {
                    text.push(',');
                }
                add(text, item);
            }
            text.push(']');
        }
        Value::Number(number) => match number.as_f64().filter(|x| is_whole(*x)) {
            Some(whole) => text.push_str(&(whole as i64).to_string()),
            None => text.push_str(&shortest(number)),
        },
        plain => text.push_str(&plain.to_string()),
    }
}

fn add_object(text: &mut String, map: &Map<String, Value>, counts: &dyn Fn(&str) -> bool) {
    let mut keys: Vec<&String> = map.keys().filter(|key| counts(key)).collect();
    // Their order in the file is that of its writer.
    keys.sort_unstable();
    text.push('{');
    for (i, key) in keys.into_iter().enumerate() {
        if i > 0 {
            text.push(',');
        }
        text.push_str(&Value::from(key.as_str()).to_string());
        text.push(':');
        add(text, &map[key]);
    }
    text.push('}');
}

/// A number in its shortest form, however it was written: other programs write 1e-07 for 1e-7.
fn shortest(number: &Number) -> String {
    let is_integer = number.is_u64() || number.is_i64();
    let same = number.as_f64().filter(|_| !is_integer).and_then(Number::from_f64);
    same.as_ref().unwrap_or(number).to_string()
}

/// Whether a number is whole and exact as an i64. Defined: doubles below 2⁵³ are.
fn is_whole(x: f64) -> bool {
    x.fract() == 0.0 && x.abs() < 9_007_199_254_740_992.0
}
