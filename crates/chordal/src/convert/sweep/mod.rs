//! Profiles that are swept along paths: frames along a path, and how far they are from those that do not rotate.
pub(super) mod frame_error;
pub(super) mod frame_spline;
mod interval_polynomial;
pub(super) mod moving_frame;
