//! Numbers that know no shape: outward rounding, [`Interval`], [`Box3`], exact predicates, SIMD dispatch.
mod box3;
#[cfg_attr(not(test), allow(dead_code))]
pub(crate) mod determinants;
mod double_double;
pub mod elementary;
mod exponent;
mod interval;
mod predicates;
mod probe;
mod ranked;
mod rounding;
pub mod simd;
mod vector;
mod wide;

pub use box3::Box3;
pub(crate) use double_double::DoubleDouble;
pub(crate) use exponent::{exponent, power_of_two};
pub(crate) use interval::ends::Ends;
pub use interval::{Interval, InvalidInterval};
pub(crate) use predicates::dot_sign;
pub use predicates::{Orientation, Position, orient2d, orient3d, triangle_contains};
pub use probe::flushes_subnormals;
pub(crate) use ranked::Ranked;
pub(crate) use rounding::length_up;
pub use rounding::{
    add_down, add_up, div_down, div_up, mul_down, mul_up, sqrt_down, sqrt_up, sub_down, sub_up,
};
pub(crate) use vector::{cross, difference, dot, length};
