//! Fewer triangles: lossy, same kind, and the loss is bounded.
mod chain;
mod engine;
mod flat;
mod part;
mod quadric;
mod queue;
mod reduction;
mod room;
mod samples;
mod select;
mod simplify;
mod surface;
mod tree;
mod watch;
mod wedges;

pub use chain::{Level, Source, Steps, chain};
pub use reduction::Kept;
pub use select::{HYSTERESIS, Shown, Switches};
pub use simplify::{Simplified, simplify};
pub use tree::{Cuts, Tile, Tree, tree};
