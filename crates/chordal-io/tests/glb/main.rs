//! GLB: what is written reads back, what is broken is refused, as gltf-validator would have it.
mod build;
mod data;
mod hostile_container;
mod hostile_objects;
mod mutations;
mod reader;
mod round_trip;
