//! Queries on a field: which side a point is on, normals, ray intersections, and closest points.
mod beam;
mod bracket;
mod closest;
mod octree;
mod point_queries;
mod ray_march;
mod sphere_trace;
mod tracer;
mod voxels;

pub use beam::{Beam, BeamCounts, BeamHit, BeamRecord};
pub use closest::{FieldClosestPoint, closest_points};
pub use octree::{FieldOctree, FieldOctreeError};
pub use point_queries::{contains, normals};
pub use sphere_trace::{SphereStep, SphereTrace, SphereTraceEnd, sphere_trace};
pub use tracer::FieldTracer;
