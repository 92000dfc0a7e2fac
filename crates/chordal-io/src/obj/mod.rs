//! Wavefront OBJ: polygons with texture coordinates and normals at their corners.
mod cage;
mod detect;
mod index;
mod read;
mod statements;
mod tag_names;
mod tags;
mod vertex_table;
mod write;
mod write_polygons;

pub(crate) use detect::looks_like;
pub use read::read;
pub(crate) use write::keeps;
pub use write::write;
pub use write_polygons::write_polygons;

/// The prefix of a comment with a certificate as JSON.
const CERTIFICATE: &[u8] = b"# chordal: ";
