//! The parts of `patches_to_mesh`, in the order in which they run:
//! [`quilt`] finds shared curves, [`plan`] cuts patches into tiles and chooses their rates by the bound of
//! [`bend`], [`seams`] gives every tile's sides their shared points, [`tile`] triangulates and proves one tile, [`demand`] asks for more where one misses,
//! [`assemble`] numbers the vertices and computes normals.
pub(super) mod assemble;
pub(super) mod bend;
pub(super) mod demand;
pub(super) mod ground;
pub(super) mod mesher;
pub(super) mod plan;
pub(super) mod probe;
pub(super) mod quilt;
pub(super) mod rough;
pub(super) mod seams;
pub(super) mod texcoords;
pub(super) mod tile;
pub(super) mod tip;
pub(super) mod within;
