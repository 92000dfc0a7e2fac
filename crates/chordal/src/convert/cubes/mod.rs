//! Marching cubes on lattices of samples, with proved bounds.
pub(crate) mod bound;
pub(crate) mod caps;
pub(crate) mod case_table;
mod cell_prover;
pub(crate) mod gaussian;
pub(crate) mod marching_cubes;
pub(crate) mod marching_squares;
pub(crate) mod mask_cells;
pub(crate) mod normals;
pub(crate) mod rule;
pub(crate) mod sign_bits;
mod slopes;
pub(crate) mod source;
pub(crate) mod upsample;
