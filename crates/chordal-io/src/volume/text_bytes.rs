//! Numbers in text, converted to the bytes of a binary file.
use super::element::SampleType;
use crate::text::{IntegerError, grouped, integer, is_space, number, number_error, show};
use crate::{FileLocation, ReadError};

/// Parses numbers separated by spaces, as little-endian bytes of a type.
///
/// # Errors
/// For a token that is not a number, or not of that type, at its byte of the text.
pub(crate) fn text_bytes(
    text: &[u8],
    element: SampleType,
    place: impl Fn(usize) -> FileLocation,
) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    let mut at = 0;
    while at < text.len() {
        if is_space(text[at]) {
            at += 1;
            continue;
        }
        let end = text[at..].iter().position(|b| is_space(*b)).map_or(text.len(), |n| at + n);
        let token = &text[at..end];
        let reserved = bytes.try_reserve(element.width());
        reserved.map_err(|_| crate::grow::out_of_memory(bytes.len() / element.width()))?;
        if !put(token, element, &mut bytes) {
            let message = match number(token) {
                Some(_) => format!("{} is no number of the type that the header names", show(token)),
                None => number_error(token),
            };
            return Err(ReadError::new("bad-number", place(at), message));
        }
        at = end;
    }
    Ok(bytes)
}

/// Appends a number; false if the token is not one, or not of that type.
fn put(token: &[u8], element: SampleType, bytes: &mut Vec<u8>) -> bool {
    match element {
        // Single precision is parsed directly: through f64 it would be rounded twice.
        SampleType::F32 | SampleType::F16 => {
            let spelled = std::str::from_utf8(token).ok().and_then(|text| text.parse::<f32>().ok());
            let value = spelled.or_else(|| number(token).map(|value| value as f32));
            value.map(|value| bytes.extend(value.to_le_bytes())).is_some()
        }
        SampleType::F64 => number(token).map(|value| bytes.extend(value.to_le_bytes())).is_some(),
        SampleType::U64 => {
            let spelled = std::str::from_utf8(token).ok().and_then(|text| text.parse::<u64>().ok());
            let value = spelled.or_else(|| whole_number(token).and_then(|value| value.try_into().ok()));
            value.map(|value| bytes.extend(value.to_le_bytes())).is_some()
        }
        _ => whole_number(token).is_some_and(|value| put_integer(value, element, bytes)),
    }
}

fn put_integer(value: i64, element: SampleType, bytes: &mut Vec<u8>) -> bool {
    let (low, high) = match element {
        SampleType::Bool => (0, 1),
        SampleType::U8 => (0, u8::MAX.into()),
        SampleType::I8 => (i8::MIN.into(), i8::MAX.into()),
        SampleType::U16 => (0, u16::MAX.into()),
        SampleType::I16 => (i16::MIN.into(), i16::MAX.into()),
        SampleType::U32 => (0, u32::MAX.into()),
        SampleType::I32 => (i32::MIN.into(), i32::MAX.into()),
        _ => (i64::MIN, i64::MAX),
    };
    if !(low..=high).contains(&value) {
        return false;
    }
    bytes.extend(&value.to_le_bytes()[..element.width()]);
    true
}

/// A whole number, even if it is spelled as `12.0` or `1e3`.
fn whole_number(token: &[u8]) -> Option<i64> {
    match integer(token) {
        Ok(value) => Some(value),
        Err(IntegerError::TooLarge) => None,
        Err(IntegerError::Spelling) => {
            let value = number(token)?;
            // 2⁵³: beyond it f64 does not hold every whole number.
            let is_whole = value.fract() == 0.0 && value.abs() <= 9_007_199_254_740_992.0;
            is_whole.then_some(value as i64)
        }
    }
}

/// The error for a text with another number of samples than the header declares, if the counts differ.
pub(crate) fn check_count(
    there: u64,
    declared: u64,
    place: impl FnOnce() -> FileLocation,
) -> Result<(), ReadError> {
    let (there_shown, declared_shown) = (grouped(there), grouped(declared));
    let message = format!("{there_shown} numbers are there, the header says {declared_shown}");
    match there.cmp(&declared) {
        std::cmp::Ordering::Equal => Ok(()),
        std::cmp::Ordering::Less => {
            Err(ReadError::new("truncated", place(), format!("the samples are cut off: {message}")))
        }
        std::cmp::Ordering::Greater => Err(ReadError::new("trailing-bytes", place(), message)),
    }
}
