//! `length_from_pixels`: the length that a budget in pixels allows around a box; what is left of one after a step.
use crate::budget::{Failure, PixelBudget, Pixels, RefusalCode};
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

/// Halvings of an interval of pixels. Chosen: a millionth of it is left.
const HALVINGS: usize = 20;

/// What is left of a budget of pixels after a step of a length at a place.
pub(super) fn remaining_pixels(px: &PixelBudget, lost: f64, place: &Box3) -> Option<PixelBudget> {
    let wanted = px.pixels.get();
    let lost = px.view.pixels_of(lost, place)?;
    let fits = |left: f64| px.view.pixels_of_two_steps(left, lost).is_some_and(|both| both <= wanted);
    // Both together are a little more than their sum.
    let (mut fitting, mut beyond) = (0.0, wanted);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (fitting + beyond);
        *(if fits(middle) { &mut fitting } else { &mut beyond }) = middle;
    }
    Some(PixelBudget { pixels: Pixels::new(fitting).ok()?, ..*px })
}
