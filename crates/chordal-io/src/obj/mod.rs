//! Wavefront OBJ: polygons with their corners' texture coordinates and normals.
mod cage;
mod detect;
mod index;
mod read;
mod statements;
mod tags;
mod vertex_table;
mod write;
mod write_polygons;

pub(crate) use detect::looks_like;
pub use read::read;
pub(crate) use write::colors_agree;
pub use write::write;
pub use write_polygons::write_polygons;

/// How a comment begins that carries a certificate as JSON.
const CERTIFICATE: &[u8] = b"# chordal: ";
