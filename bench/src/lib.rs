//! What the programs of the bench share: the corpora, dumped meshes, and the referee's sampler.
mod corpus;
mod dump;
#[path = "../../crates/chordal/tests/referee/sampler/mod.rs"]
pub mod sampler;

pub use corpus::{labels, out, patches};
pub use dump::{Dumped, read, write};
