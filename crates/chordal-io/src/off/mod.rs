//! Geomview's OFF: polygons over shared vertices, as text or binary.
mod colors;
mod faces;
mod header;
mod keyword;
mod read;
mod rows;
mod vertices;
mod write;
mod write_polygons;

pub(crate) use keyword::looks_like;
pub use read::read;
pub(crate) use write::keeps;
pub use write::write;
pub use write_polygons::write_polygons;

/// The prefix of a comment with a piece of a certificate.
const CERTIFICATE: &str = "# chordal: ";
