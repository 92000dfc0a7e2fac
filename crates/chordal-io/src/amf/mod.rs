//! AMF, an older format of 3D printing: objects made of volumes with materials and colours, placed by
//! constellations, as XML, zipped or not.
mod build;
mod document;
mod object;
mod read;

pub(crate) use read::looks_like;
pub use read::read;
