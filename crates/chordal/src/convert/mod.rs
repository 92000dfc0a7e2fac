//! The bridge: one file per arrow `a_to_b`, each lossy one under a budget and with a bound.
mod patches;
mod patches_to_mesh;

pub use patches_to_mesh::patches_to_mesh;
