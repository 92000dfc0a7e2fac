//! USD: meshes and cages under prims with transforms and materials, as text, in a binary form, or in a package.
mod basis;
mod build;
mod cage;
mod crate_layer;
mod crate_tables;
mod crate_value;
mod files;
mod forms;
mod layer;
mod material;
mod mesh;
mod parse;
mod parse_value;
mod pictures;
mod primvar;
mod read;
mod scanner;
mod shape_kind;
mod shapes;
mod stage;
mod topology;
mod transform;
mod unpack;
mod value;
mod vertex_table;
mod write;
mod write_material;
mod write_mesh;
mod write_package;
mod write_polygons;
mod write_text;

pub(crate) use forms::{looks_like_crate, looks_like_package, looks_like_text};
pub use read::read;
pub(crate) use read::read_with;
pub use write::write;
pub(crate) use write::{changes, keeps, write_files};
pub use write_package::{write_package, write_polygons_package};
pub use write_polygons::write_polygons;
pub(crate) use write_polygons::write_polygons_files;

/// The name of the metadata string with the certificate.
const CERTIFICATE: &str = "chordal";
