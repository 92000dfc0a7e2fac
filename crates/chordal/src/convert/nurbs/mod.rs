//! NURBS surfaces as bicubic patches within a proved distance.
pub(super) mod fit;
mod fit_error;
