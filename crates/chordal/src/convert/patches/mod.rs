//! The parts of `patches_to_mesh`, in the order in which they run: [`adjacency`] finds shared curves,
//! [`plan`] splits patches into tiles and chooses their rates by the bound of [`derivative_bound`], [`seams`]
//! gives the sides of all tiles their shared points, [`tile`] triangulates and proves one tile, [`refine`]
//! adds cells where a tile misses its tolerance, [`assemble`] numbers the vertices and computes normals.
//! [`sheet_plan`] plans some sheets anew, and [`coherence`] chooses them, for one view after another.
pub(super) mod adjacency;
pub(super) mod allowance;
pub(super) mod assemble;
pub(super) mod budget;
pub(super) mod cell_estimate;
pub(super) mod coherence;
pub(super) mod derivative_bound;
pub(super) mod extraordinary_tile;
pub(super) mod mesher;
pub(super) mod patch_tile;
pub(super) mod plan;
pub(super) mod refine;
pub(super) mod seams;
pub(super) mod sheet_plan;
pub(super) mod subpatch;
pub(super) mod texcoords;
pub(super) mod tile;
pub(super) mod tile_border;
