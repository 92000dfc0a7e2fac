//! STL, text and binary: a list of triangles, without units and without topology.
mod binary;
mod facets;
mod read;
mod text;
mod write;

pub(crate) use read::looks_like;
pub use read::read;
pub use write::write;
