//! Samplers: how far points, triangles and bicubic patches are apart, measured from control points and
//! vertices alone.
//!
//! What is found belongs to a sample: it is attained, up to rounding or to a gap that is proved. So a bound
//! below it is wrong, and a bound above it may still be.
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
