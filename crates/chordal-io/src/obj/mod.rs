//! Wavefront OBJ: polygons with their corners' texture coordinates and normals.
mod cage;
mod index;
mod kind;
mod read;
mod rows;
mod statements;
mod tags;
mod write;
mod write_polygons;

pub(crate) use kind::looks_like;
pub use read::read;
pub(crate) use write::colors_agree;
pub use write::write;
pub use write_polygons::write_polygons;

/// How a comment begins that carries a certificate as JSON.
const CERTIFICATE: &[u8] = b"# chordal: ";
