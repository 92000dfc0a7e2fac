//! GIFTI, `.gii`: the surfaces of brains that neuroimaging programs exchange, arrays in XML.
//!
//! The crate `gifti` on crates.io is not used: it is a stub that reads nothing (looked at in 2026).
mod data_array;
mod read;

pub use read::{read, read_with};

/// Whether the text is a GIFTI file.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    /// How far the root may be: a declaration, a document type and a comment stand before it.
    const LOOKED_AT: usize = 4096;
    let head = &text[..text.len().min(LOOKED_AT)];
    text.starts_with(b"<") && memchr::memmem::find(head, b"<GIFTI").is_some()
}
