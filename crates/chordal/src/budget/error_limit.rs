//! `ErrorLimit`: the length that a budget allows, uniform or by place.
use super::lens::{Lens, PixelScale};
use super::{Budget, PixelBudget, Pixels, View};
use crate::math::{Box3, lesser};

/// The allowed error: a length and, for a camera, pixels, which allow more length farther away.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ErrorLimit {
    /// Infinite if only pixels are limited.
    length: f64,
    pixel_limit: Option<(Pixels, Lens)>,
}

impl ErrorLimit {
    /// The same length everywhere.
    pub fn uniform(length: f64) -> Self {
        Self { length, pixel_limit: None }
    }

    /// The limit of a budget in and around `place`. `None` if no length is small enough for any part of it.
    pub fn from_budget(budget: &Budget, place: &Box3) -> Option<Self> {
        match &budget.pixels {
            Some(PixelBudget { pixels, view: view @ View::Camera(_) }) => Some(Self {
                length: budget.length.map_or(f64::INFINITY, super::Tolerance::get),
                pixel_limit: Some((*pixels, view.lens())),
            }),
            _ => budget.length_in(place).map(Self::uniform),
        }
    }

    /// The length, if it is the same everywhere.
    pub fn constant(&self) -> Option<f64> {
        self.pixel_limit.is_none().then_some(self.length)
    }

    /// The length for all points of `place`; `None` if the eye is too close to some of them.
    pub fn at(&self, place: &Box3) -> Option<f64> {
        self.at_with_scale(place).0
    }

    /// [`ErrorLimit::at`], and the pixel scale of the place if there is a camera.
    pub fn at_with_scale(&self, place: &Box3) -> (Option<f64>, Option<PixelScale>) {
        let Some((pixels, lens)) = &self.pixel_limit else { return (Some(self.length), None) };
        let scale = lens.scale_at(place);
        let length = scale.length_of(*pixels).map(|visible| lesser(self.length, visible));
        (length, Some(scale))
    }
}
