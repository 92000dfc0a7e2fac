//! The sampler: measures how far triangles and bicubic patches are apart, from control points and vertices alone.
//!
//! It shares no code with the library and needs none of its types: patches are `4 × 4` control points, a mesh is
//! positions and indices. The benches against other engines measure with the same files.
mod climb;
mod measure;
mod surface;
mod tree;
mod triangles;
mod vector;

pub use measure::measure;
pub use surface::{Control, Foot, Surface, evaluate, quarters};
pub use tree::{Bounds, around, distance_to_bounds};
pub use triangles::Triangles;
pub use vector::{Point, add, cross, distance, dot, length, scale, sub};
