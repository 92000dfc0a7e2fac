//! A certificate as one line of text, for formats that have comments.
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, WriteError};
use serde_json::Value;

/// Parses the certificate from the rest of a comment. Counts a warning where it is not valid.
pub(crate) fn read(
    text: &[u8],
    limits: &Limits,
    place: FileLocation,
    warnings: &mut Warnings,
) -> Option<Value> {
    let parsed = if text.len() > limits.header_line {
        Err(format!("{} bytes are over the limit of {}", grouped(text.len() as u64), limits.header_line))
    } else {
        serde_json::from_slice(text).map_err(|error| error.to_string())
    };
    match parsed {
        Ok(value) => Some(value),
        Err(why) => {
            warnings.count("certificate-unreadable", || {
                (place, format!("the certificate in a comment is unreadable and was skipped: {why}"))
            });
            None
        }
    }
}

/// The comment's own prefix precedes it.
pub(crate) const PREFIX: usize = 32;

/// Serialises the certificate as one line without a line break, in ASCII: the header of a PLY holds no other
/// letters.
///
/// # Errors
/// [`WriteError::Unsupported`] when the line is longer than readers accept by default.
pub(crate) fn line(certificate: &Value) -> Result<String, WriteError> {
    let limit = Limits::default().header_line - PREFIX;
    let line = in_ascii(&certificate.to_string());
    if line.len() > limit {
        let message = format!("a certificate of {} bytes does not fit into a line of {limit}", line.len());
        return Err(WriteError::Unsupported(message));
    }
    Ok(line)
}

/// JSON with the same content: letters beyond ASCII are in its strings, where an escape says the same.
fn in_ascii(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for letter in json.chars() {
        if letter.is_ascii() {
            text.push(letter);
            continue;
        }
        for unit in letter.encode_utf16(&mut [0; 2]) {
            text.push_str(&format!("\\u{unit:04x}"));
        }
    }
    text
}
