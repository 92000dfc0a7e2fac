//! Fitting: few cubic Bézier curves near curves and points, with a proved distance.
pub(super) mod arc_cubics;
pub(super) mod hermite;
mod least_squares;
pub(super) mod point_path;
pub(super) mod rational_cubics;
mod rational_error;
pub(super) mod spans;
