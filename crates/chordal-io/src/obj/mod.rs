//! Wavefront OBJ: polygons with texture coordinates and normals at their corners.
mod cage;
mod detect;
mod gltf_to_mtl;
mod index;
mod libraries;
mod mtl;
mod mtl_map;
mod mtl_to_gltf;
mod names;
mod part;
mod pictures;
mod read;
mod side_files;
mod statements;
mod tag_names;
mod tags;
mod vertex_table;
mod write;
mod write_polygons;

pub(crate) use detect::looks_like;
pub use read::read;
pub(crate) use read::read_with;
pub use side_files::{ObjSideFiles, side_files, side_files_of_polygons};
pub(crate) use side_files::{lost_looks, write_files, write_polygons_files};
pub(crate) use write::keeps;
pub use write::{write, write_with_library};
pub use write_polygons::{write_polygons, write_polygons_with_library};

/// The prefix of a comment with a piece of a certificate.
const CERTIFICATE: &str = "# chordal: ";
