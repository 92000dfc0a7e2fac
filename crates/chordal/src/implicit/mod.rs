//! Shapes as rules: fields, which say for every point whether it is inside, and grids of samples.
mod affine;
mod block;
mod distance;
mod expr;
mod field;
mod graph;
mod grid;
mod leaf;
mod machine;
mod number;
mod op;
pub mod plain;
mod program;
mod shorten;
mod slope;
mod sources;
mod tape;

pub use affine::{Affine, InvalidAffine};
pub use distance::{Distance, Quality};
pub use expr::Expr;
pub use field::Field;
pub use graph::{Graph, Term};
pub use grid::{Grid, InvalidGrid, Samples};
pub use leaf::{Answer, Leaf, LeafError, Lipschitz};
pub use op::{Binary, Unary};
pub use slope::Slope;
pub use tape::Tape;
