//! Draco, `.drc`: compressed triangles, as Google's `draco_encoder` writes them.
mod read;

pub use read::read;

/// The signature of a stream.
pub(crate) const MAGIC: &[u8] = b"DRACO";
