//! Samplers: distances between points, triangles and bicubic patches, computed only from control points and
//! vertices.
//!
//! A measured distance is attained at a sample, up to rounding or to a proved gap. So an upper bound below it
//! is wrong; one above it may be wrong too.
mod box_tree;
mod climb;
mod measure;
mod surface;
mod triangles;
mod vector;

pub use box_tree::{Bounds, around, distance_to_bounds};
pub use climb::climb;
pub use measure::{SamplingEffort, TwoSidedDistance, measure, mesh_to_surface, surface_to_mesh};
pub use surface::{Control, Foot, Surface, evaluate, quarters};
pub use triangles::{Triangles, closest_on_triangle, closest_weights, distance_to_triangle, on};
pub use vector::{Point, add, cross, distance, dot, norm, scale, sub};
