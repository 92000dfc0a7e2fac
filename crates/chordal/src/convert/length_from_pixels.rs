//! `length_from_pixels`: the length that a budget in pixels allows around a box.
use crate::budget::{Failure, PixelBudget, RefusalCode};
use crate::math::Box3;

/// The length that a budget in pixels allows anywhere near the box; the mesh may stick out by as much.
pub(super) fn length_from_pixels<T>(bounds: &Box3, px: &PixelBudget) -> Result<f64, Failure<T>> {
    let too_close = || {
        Failure::refused(
            RefusalCode::TooClose,
            "the shape comes so close to the eye that there is no bound in pixels",
        )
    };
    let alone = px.view.length_of(px.pixels, bounds).ok_or_else(too_close)?;
    let about = Box3 { min: bounds.min.map(|x| x - alone), max: bounds.max.map(|x| x + alone) };
    px.view.length_of(px.pixels, &about).ok_or_else(too_close)
}
