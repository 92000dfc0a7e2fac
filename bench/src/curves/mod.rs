//! The flattening bench: drawings, the sides that flatten them, and what is measured of their polylines.
pub mod drawings;
pub mod sampler;
pub mod sides;

/// The control points of a cubic Bézier curve.
pub type Cubic = [[f64; 2]; 4];
