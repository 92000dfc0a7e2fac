//! Stanford PLY: elements of named properties, as text or binary.
mod body;
mod faces;
mod header;
mod read;
mod text_rows;
mod vertices;
mod write;
mod write_polygons;

pub use read::read;
pub(crate) use write::keeps;
pub use write::write;
pub use write_polygons::write_polygons;

/// Whether the text begins with the word `ply`.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    text.starts_with(b"ply") && text.get(3).is_some_and(|b| crate::text::is_space(*b))
}

/// The prefix of each piece of a certificate.
const CERTIFICATE: &str = "comment chordal ";
