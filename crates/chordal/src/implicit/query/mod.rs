//! Questions to a field: which side, which way, where a ray meets it, and how far away it is.
mod beam;
mod bracket;
mod closest;
mod octree;
mod point_queries;
mod ray_march;
mod tracer;
mod voxels;

pub use beam::{Beam, BeamCounts, BeamHit, BeamRecord};
pub use closest::{FieldClosestPoint, closest_points};
pub use octree::{FieldOctree, FieldOctreeError};
pub use point_queries::{contains, normals};
pub use tracer::FieldTracer;
