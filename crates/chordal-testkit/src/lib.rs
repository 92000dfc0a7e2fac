//! Shared helpers of the tests: random numbers, the corpus of foreign files, temporary folders, the size of
//! sweeps, fingerprints, a font, written files, and samplers that measure surfaces.
//!
//! This crate has no dependencies, least of all on a crate that it helps to test: a sampler that called the
//! library would repeat its mistakes. So shapes are passed as arrays. Only tests and benches depend on it,
//! and it is not published.
pub mod corpus;
mod effort;
mod fingerprint;
mod folder;
mod random;
pub mod sampler;
mod tiny_font;
mod written;

pub use effort::{cases, is_long, some};
pub use fingerprint::Fingerprint;
pub use folder::{Folder, names};
pub use random::Random;
pub use tiny_font::{tiny_font, tiny_glyph_area};
pub use written::{assert_written, path_in_tree};
