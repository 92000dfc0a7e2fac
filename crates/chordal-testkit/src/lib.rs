//! What the tests of Chordal's crates share: random numbers, the folder of foreign files, folders of a test's
//! own, how long a sweep may take, fingerprints, a font, and the samplers that measure surfaces.
//!
//! This crate depends on nothing, and least of all on a crate that it helps to judge: a sampler that called
//! the library would repeat its mistakes. So shapes come in as arrays. It stands below all others, only as a
//! dependency of tests and benches, and is not published.
pub mod corpus;
mod effort;
mod fingerprint;
mod folder;
mod random;
pub mod sampler;
mod tiny_font;

pub use effort::{cases, is_long, some};
pub use fingerprint::Fingerprint;
pub use folder::{Folder, names};
pub use random::Random;
pub use tiny_font::{tiny_font, tiny_glyph_area};
