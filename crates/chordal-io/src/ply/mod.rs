//! Stanford PLY: elements of named properties, as text or binary.
mod body;
mod faces;
mod header;
mod read;
mod vertices;
mod write;

pub use read::read;
pub use write::write;
