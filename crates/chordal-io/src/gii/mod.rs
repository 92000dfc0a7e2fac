//! GIFTI, `.gii`: brain surfaces exchanged by neuroimaging programs, arrays in XML.
//!
//! The crate `gifti` on crates.io is not used: it is a stub that reads nothing (checked in 2026).
mod data_array;
mod read;

pub use read::{read, read_with};

/// Whether the text is a GIFTI file.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    /// The bytes in which the root must begin. Chosen: a declaration, a document type and a comment may
    /// precede it.
    const LOOKED_AT: usize = 4096;
    let head = &text[..text.len().min(LOOKED_AT)];
    text.starts_with(b"<") && memchr::memmem::find(head, b"<GIFTI").is_some()
}
