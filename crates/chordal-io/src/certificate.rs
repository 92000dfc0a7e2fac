//! A certificate as one line of text: how it travels in formats that have comments.
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{Limits, Place, WriteError};
use serde_json::Value;

/// The certificate that the rest of a comment spells; counted when it spells none.
pub(crate) fn read(text: &[u8], limits: &Limits, place: Place, warnings: &mut Warnings) -> Option<Value> {
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

/// The certificate as one line without a line break.
///
/// # Errors
/// [`WriteError::Unsupported`] when readers, by default, refuse a line of that length.
pub(crate) fn line(certificate: &Value) -> Result<String, WriteError> {
    // The comment's own words stand before it.
    let limit = Limits::default().header_line - 32;
    let line = certificate.to_string();
    if line.len() > limit {
        let message = format!("a certificate of {} bytes does not fit into a line of {limit}", line.len());
        return Err(WriteError::Unsupported(message));
    }
    Ok(line)
}
