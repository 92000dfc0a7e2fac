//! NRRD volumes, `.nrrd`: header and samples in one file, versions 1 to 5; samples raw, packed by gzip, or as
//! text.
//!
//! Source: G. Kindlmann, "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html (2005).
mod fields;
mod orientation;
mod read;
mod write;

pub use read::read;
pub(crate) use write::names_unit;
pub use write::{write, write_sparse};

/// The first bytes of a file, before a digit for its version.
pub(crate) const MAGIC: &[u8] = b"NRRD000";
/// The key of the certificate.
const CERTIFICATE: &str = "chordal";
