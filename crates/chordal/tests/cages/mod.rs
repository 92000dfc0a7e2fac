//! Cages: refined like the reference, and by laws that need none.
mod attack;
pub mod corpus;
mod laws;
mod limit;
mod loop_limit;
mod mesh;
mod reference;
mod refinement;
mod texcoords;
