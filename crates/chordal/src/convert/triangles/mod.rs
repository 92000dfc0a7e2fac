//! The parts of `cage_to_mesh` for Loop subdivision: [`cell`] is a part of the surface, [`leaf`] a triangle
//! over it, [`derivative_bound`] and [`hull_distance`] prove the distance between the two, [`mesher`] splits
//! edges until all leaves are within tolerance, [`assemble`] computes vertex normals, [`budget`] applies a
//! budget.
pub(super) mod assemble;
pub(super) mod budget;
pub(super) mod cell;
pub(super) mod derivative_bound;
pub(super) mod hull_distance;
pub(super) mod leaf;
pub(super) mod mesher;
