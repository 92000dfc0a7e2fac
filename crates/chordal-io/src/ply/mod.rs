//! Stanford PLY: elements of named properties, as text or binary.
mod body;
mod faces;
mod header;
mod read;
mod vertices;
mod write;
mod write_polygons;

pub use read::read;
pub use write::write;
pub use write_polygons::write_polygons;
