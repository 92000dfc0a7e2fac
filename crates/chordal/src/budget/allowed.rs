//! `Allowed`: the length that a budget allows, everywhere alike or by place.
use super::lens::{Lens, Sight};
use super::{Budget, PixelBudget, Pixels, View};
use crate::math::Box3;

/// What may be lost: a length, and for one eye at one place pixels, which are more of a length the farther away.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Allowed {
    /// Infinite where pixels alone are the limit.
    length: f64,
    by_view: Option<(Pixels, Lens)>,
}

impl Allowed {
    /// The same length everywhere.
    pub fn everywhere(length: f64) -> Self {
        Self { length, by_view: None }
    }

    /// What a budget allows in `place` and around it: `None` where no length is small enough, whatever the part of it.
    pub fn of(budget: &Budget, place: &Box3) -> Option<Self> {
        match &budget.pixels {
            Some(PixelBudget { pixels, view: view @ View::Camera(_) }) => Some(Self {
                length: budget.length.map_or(f64::INFINITY, super::Tolerance::get),
                by_view: Some((*pixels, view.lens())),
            }),
            _ => budget.length_in(place).map(Self::everywhere),
        }
    }

    /// The length, where it is the same everywhere.
    pub fn constant(&self) -> Option<f64> {
        self.by_view.is_none().then_some(self.length)
    }

    /// The length for all points of `place`; `None` where the eye is too close for any.
    pub fn at(&self, place: &Box3) -> Option<f64> {
        self.seen(place).0
    }

    /// The same, and the sight of the place where there is an eye.
    pub fn seen(&self, place: &Box3) -> (Option<f64>, Option<Sight>) {
        let Some((pixels, lens)) = &self.by_view else { return (Some(self.length), None) };
        let sight = lens.sight(place);
        let length = sight.length_of(*pixels).map(|seen| if self.length < seen { self.length } else { seen });
        (length, Some(sight))
    }
}
