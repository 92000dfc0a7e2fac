//! Filling outlines: a grid of exact numbers, contours made to meet only at its points, and a sweep that triangulates.
pub(super) mod arrange;
pub(super) mod grid;
pub(super) mod sweep;
mod tree;
