//! The parts of `cage_to_mesh` for Loop's scheme: [`cell`] is a place of the surface, [`leaf`] a triangle over it, [`derivative_bound`] and [`hull_distance`] prove
//! how far both are apart, [`mesher`] splits edges until all leaves are near enough, [`assemble`] gives vertices their normals, [`budget`] keeps a budget.
pub(super) mod assemble;
pub(super) mod budget;
pub(super) mod cell;
pub(super) mod derivative_bound;
pub(super) mod hull_distance;
pub(super) mod leaf;
pub(super) mod mesher;
