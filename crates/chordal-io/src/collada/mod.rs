//! COLLADA (`.dae`): triangles, polygons, materials and the nodes that place them.
mod build;
mod document;
mod elements;
mod geometry;
mod looks;
mod primitives;
mod read;
mod reader;
mod transform;

pub(crate) use read::looks_like;
pub use read::read;
