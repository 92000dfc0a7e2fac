//! Locations, limits, errors and escapes shared by readers and writers of XML.
use crate::text::show;
use crate::{FileLocation, ReadError};
use quick_xml::escape::{EscapeError, resolve_predefined_entity};

/// The most attributes of one element. Chosen: the check for duplicates is quadratic in them.
pub(crate) const MOST_ATTRIBUTES: usize = 1000;

/// The namespace of the certificate.
pub(crate) const CERTIFICATE_NAMESPACE: &str = "urn:chordal:certificate:1";

/// Why a document type with declarations is refused.
pub(crate) const DTD_REFUSED: &str =
    "DTD not allowed: declarations of a document type are refused, and so are their entities";

/// Line and column of a byte, both counted from 1; columns in characters.
pub(crate) fn place(text: &str, at: usize) -> FileLocation {
    let before = text.get(..at).unwrap_or(text);
    let line = before.bytes().filter(|b| *b == b'\n').count() as u64 + 1;
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    FileLocation::LineColumn { line, column: before[start..].chars().count() as u64 + 1 }
}

/// The text of a file, without its byte order mark.
///
/// # Errors
/// `not-utf8` and `not-text`.
pub(crate) fn text_of(bytes: &[u8]) -> Result<&str, ReadError> {
    let text = crate::text::text_of(bytes)?;
    std::str::from_utf8(text).map_err(|error| {
        let place = FileLocation::Byte(error.valid_up_to() as u64);
        ReadError::new("not-utf8", place, "the text is not UTF-8: save it as UTF-8")
    })
}

/// Why the encoding in an XML declaration does not match the text.
pub(crate) fn wrong_encoding(declaration: &str, text: &str) -> Option<String> {
    let declared = declaration.to_ascii_lowercase();
    let (_, encoding) = declared.split_once("encoding")?;
    let name = encoding.split(['"', '\'']).nth(1).unwrap_or("");
    // The bytes are UTF-8, or the text would have been refused. A wrong declaration is harmless if the text
    // is ASCII.
    if matches!(name, "utf-8" | "utf8" | "us-ascii" | "ascii") || text.is_ascii() {
        return None;
    }
    Some(format!("the file says that it is {}: save it as UTF-8", show(name.as_bytes())))
}

/// One sentence that says what is wrong with a reference.
pub(crate) fn reference_error(error: &EscapeError) -> String {
    match error {
        EscapeError::UnrecognizedEntity(_, name) if resolve_predefined_entity(name).is_none() => {
            format!("the entity {} is not known: only those of XML itself are", show(name.as_bytes()))
        }
        other => format!("a reference is not well formed: {other}"),
    }
}

/// Escapes text for an element or an attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // Escaped so that it reads back unchanged; a plain line break in an attribute would not.
            '\t' | '\n' | '\r' => escaped.push_str(&format!("&#{};", c as u32)),
            // XML 1.0 cannot represent these characters.
            c if (c as u32) < 0x20 || matches!(c, '\u{fffe}' | '\u{ffff}') => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}
