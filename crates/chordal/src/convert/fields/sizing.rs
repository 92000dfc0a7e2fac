//! `SizingField`: where cells are to be smaller than elsewhere, and how small.
use crate::check::PointTree;
use crate::math::Box3;

/// A place where cells are to be smaller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::convert) struct SizingPoint {
    /// Where.
    pub at: [f64; 3],
    /// The longest edge of the cell there before it is stretched; a cell whose longest edge is longer is cut.
    pub size: f64,
}

/// Places where cells are to be small.
pub(super) struct SizingField<'p> {
    places: &'p [SizingPoint],
    /// Of their points.
    tree: PointTree<'p>,
}

impl<'p> SizingField<'p> {
    /// `points` are those of the places, which the tree borrows.
    pub fn new(places: &'p [SizingPoint], points: &'p [[f64; 3]]) -> Self {
        Self { places, tree: PointTree::new(points) }
    }

    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Whether somewhere in the box cells are to be smaller than `size`.
    pub fn is_smaller_in(&self, bounds: &Box3, size: f64) -> bool {
        self.tree.any_in(bounds, |place| size > self.places[place as usize].size)
    }
}
