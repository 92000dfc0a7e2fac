//! How much room formats have for a certificate.
use crate::certificate::PREFIX;
use crate::{Format, Limits};

/// The most bytes of a certificate in a file of triangles, where the format has a limit.
///
/// ```
/// use chordal_io::{Format, most_certificate_bytes};
/// assert!(most_certificate_bytes(Format::Ply).is_some() && most_certificate_bytes(Format::Glb).is_none());
/// ```
#[must_use]
pub fn most_certificate_bytes(format: Format) -> Option<usize> {
    let is_line = matches!(format, Format::Ply | Format::Obj | Format::Off | Format::Vtp);
    is_line.then(|| Limits::default().header_line - PREFIX)
}
