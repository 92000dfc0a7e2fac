//! Arithmetic without shapes: outward rounding, [`Interval`], [`Box3`], exact predicates, SIMD dispatch.
mod big_int;
mod box3;
mod branch_and_bound;
#[cfg_attr(not(test), allow(dead_code))]
pub(crate) mod determinants;
mod double_double;
pub mod elementary;
mod exponent;
mod integer_map;
mod interval;
mod predicates;
mod probe;
mod rounding;
pub mod simd;
mod vector;

pub use box3::Box3;
pub(crate) use branch_and_bound::{PriorityItem, branch_and_bound};
pub(crate) use double_double::DoubleDouble;
pub(crate) use exponent::{exponent, power_of_two, unit_scale};
pub(crate) use integer_map::IntegerMap;
pub use interval::Interval;
pub(crate) use interval::bare::BareInterval;
pub(crate) use predicates::dot_sign;
pub(crate) use predicates::{Orientation, PointInTriangle, orient2d, orient3d, triangle_contains};
pub use probe::flushes_subnormals;
pub(crate) use rounding::length_up;
pub use rounding::{
    add_down, add_up, div_down, div_up, mul_down, mul_up, sqrt_down, sqrt_up, sub_down, sub_up,
};
pub(crate) use simd::prefetch;
pub(crate) use vector::{cross, difference, distance, dot, length, unit_and_length};
pub use vector::{greater, lesser, unit};

/// Exact predicates, and the error for numbers that form no interval.
pub mod exact {
    pub use super::interval::InvalidInterval;
    pub use super::predicates::{Orientation, PointInTriangle, orient2d, orient3d, triangle_contains};
}
