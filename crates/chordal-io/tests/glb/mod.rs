//! GLB: what is written reads back, what is broken is refused, as gltf-validator would have it.
mod assets;
mod build;
mod data;
mod deformation;
mod draco;
mod errors;
mod face_kinds;
mod files;
mod hostile_container;
mod hostile_objects;
mod instancing;
mod levels;
mod meshopt;
mod mutations;
mod quantized;
mod reader;
mod round_trip;
