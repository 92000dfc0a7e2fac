//! `length_from_pixels`: the length that a budget in pixels allows around a box; `remaining_pixels`: the rest of such a
//! budget after one step.
use super::budget_search::too_close;
use crate::budget::{Failure, PixelBudget, Pixels};
use crate::math::Box3;

/// The length that a budget in pixels allows anywhere within that length of the box: a mesh may stick out so far.
pub(super) fn length_from_pixels<T>(bounds: &Box3, px: &PixelBudget) -> Result<f64, Failure<T>> {
    let too_close = || too_close("shape");
    let in_box = px.view.length_of(px.pixels, bounds).ok_or_else(too_close)?;
    let around = Box3 { min: bounds.min.map(|x| x - in_box), max: bounds.max.map(|x| x + in_box) };
    px.view.length_of(px.pixels, &around).ok_or_else(too_close)
}

/// Halvings of an interval of pixels. Chosen: a millionth of it is left.
const HALVINGS: usize = 20;

/// The rest of a budget of pixels after a step that loses a length in a box.
pub(super) fn remaining_pixels(px: &PixelBudget, lost: f64, bounds: &Box3) -> Option<PixelBudget> {
    let allowed = px.pixels.get();
    let spent = px.view.pixels_of(lost, bounds)?;
    let fits = |rest: f64| px.view.pixels_of_two_steps(rest, spent).is_some_and(|total| total <= allowed);
    // Bisection, because two steps together cost a little more than the sum of their pixels.
    let (mut fitting, mut beyond) = (0.0, allowed);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (fitting + beyond);
        *(if fits(middle) { &mut fitting } else { &mut beyond }) = middle;
    }
    Some(PixelBudget { pixels: Pixels::new(fitting).ok()?, ..*px })
}
