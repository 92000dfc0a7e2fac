//! Marching cubes on lattices of samples, and what is proved of it.
mod bits;
pub(crate) mod bound;
pub(crate) mod caps;
pub(crate) mod finer;
mod local;
pub(crate) mod march;
pub(crate) mod normals;
pub(crate) mod rule;
mod slopes;
pub(crate) mod source;
pub(crate) mod squares;
pub(crate) mod table;
