//! Profiles swept along paths: frames along a path, and a bound for their distance from frames that do not rotate.
pub(super) mod frame_error;
pub(super) mod frame_spline;
mod interval_polynomial;
pub(super) mod moving_frame;
