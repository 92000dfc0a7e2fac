//! Shapes as rules: fields, which say for every point whether it is inside, and grids of samples.
mod affine;
mod distance;
mod expr;
mod field;
mod graph;
mod grid;
mod leaf;
mod op;
mod plain;
mod tape;
mod trilinear;

pub use affine::{Affine, InvalidAffine};
pub use distance::{Distance, Quality};
pub use expr::Expr;
pub use field::Field;
pub use graph::{Graph, Term};
pub(crate) use grid::with_samples;
pub use grid::{Grid, InvalidGrid, Samples};
pub use leaf::{Answer, Leaf, LeafError, Lipschitz};
pub use op::{Binary, Unary};
pub use plain::Slope;
pub use tape::Tape;
pub use trilinear::Trilinear;
