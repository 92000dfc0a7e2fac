//! The room that formats have for a certificate.
use crate::Format;
use crate::certificate::{MOST, most_in_a_line};

/// The most bytes of a certificate in a file, if the format has a limit.
///
/// ```
/// use chordal_io::{Format, most_certificate_bytes};
/// assert!(most_certificate_bytes(Format::Ply).is_some() && most_certificate_bytes(Format::Glb).is_none());
/// ```
#[must_use]
pub fn most_certificate_bytes(format: Format) -> Option<usize> {
    match format {
        Format::Ply | Format::Obj | Format::Off | Format::Vtp => Some(MOST),
        Format::Nrrd => Some(most_in_a_line()),
        _ => None,
    }
}
