//! The parts of `cage_to_mesh` for Loop's scheme: [`cell`] is a place of the surface, [`leaf`] a triangle over it, [`bend`] and [`height`] prove
//! how far both are apart, [`mesher`] splits edges until all leaves are near enough, [`assemble`] gives vertices their normals, [`within`] keeps a budget.
pub(super) mod assemble;
pub(super) mod bend;
pub(super) mod cell;
pub(super) mod height;
pub(super) mod leaf;
pub(super) mod mesher;
pub(super) mod within;
