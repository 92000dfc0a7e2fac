//! Implicit surfaces: fields, whose sign says for every point whether it is inside, and grids of samples.
mod affine;
mod block;
mod combine;
mod construction_ops;
pub mod csg;
mod distance;
mod dual;
mod expr;
mod field;
mod graph;
mod grid;
mod inputs;
mod interpreter;
mod leaf;
mod material;
mod number;
mod op;
mod outside;
mod program;
mod promises;
mod prune;
pub mod query;
pub mod reference;
pub mod shapes;
mod sparse;
mod tape;
mod trilinear;

pub use affine::{Affine3, InvalidAffine};
pub use combine::Seam;
pub(crate) use csg::{
    Csg, CsgNode, CsgRestriction, CsgTree, DualRange, Membership, Primitive, PrimitiveEvaluator,
};
pub use distance::{Distance, DistanceQuality};
pub(crate) use dual::Dual;
pub use expr::Expr;
pub use field::{Field, Repeat};
pub(crate) use graph::{ExprGraph, Term};
pub(crate) use grid::with_samples;
pub use grid::{Grid, InvalidGrid, Samples};
pub use leaf::Lipschitz;
pub(crate) use leaf::{Leaf, LeafAnswer, LeafError};
pub(crate) use op::{Binary, Unary};
pub(crate) use shapes::leaf_as_expr;
pub(crate) use sparse::BrickSlab;
pub use sparse::SparseGrid;
pub(crate) use tape::Tape;

/// How a field was built from solids whose surfaces are known in closed form.
///
/// Shapes and combinations keep it, all other operations drop it: a field without one is an operand by
/// itself. It describes the set of points where the field is negative, except for the rounding of placements
/// and for points on surfaces that coincide.
pub mod construction {
    pub use super::field::construction::{
        Construction, ConstructionNode, PlanarForm, SolidForm, ThreadProfile,
    };
}

/// Expressions as graphs and tapes, and their evaluation.
pub mod evaluation {
    pub use super::dual::Dual;
    pub use super::graph::{ExprGraph, Term};
    pub use super::op::{Binary, Unary};
    pub use super::tape::Tape;
    pub use super::trilinear::{SampleGrid, Trilinear};
}

/// User functions as leaves of an expression.
pub mod leaves {
    pub use super::leaf::{Leaf, LeafAnswer, LeafError};
}

/// Materials of surfaces.
pub mod materials {
    pub use super::material::SurfaceMaterial;
}
