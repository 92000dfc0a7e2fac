//! 3MF, the format of 3D printing: objects of triangles with materials, placed by components and a build, as
//! XML parts of a zip package.
mod build;
mod meshes;
mod model;
mod namespace;
mod package;
mod properties;
mod read;
mod write;
mod write_model;
mod write_properties;

pub(crate) use read::looks_like;
pub use read::read;
pub use write::write;
pub(crate) use write_properties::{changes, keeps};

/// The name of the metadata with the certificate, without its prefix.
const CERTIFICATE: &str = "certificate";
