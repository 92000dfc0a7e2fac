//! Marching cubes on lattices of samples, and what is proved of it.
mod bits;
pub(crate) mod bound;
mod caps;
pub(crate) mod march;
pub(crate) mod normals;
pub(crate) mod rule;
pub(crate) mod source;
pub(super) mod table;
