//! `SizingField`: points at which cells have to be small, with their sizes.
use crate::check::PointTree;
use crate::math::Box3;

/// A point that needs smaller cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::convert) struct SizingPoint {
    /// Its position.
    pub at: [f64; 3],
    /// The longest edge, before stretching, that the cell there may have; a cell with a longer one is cut.
    pub size: f64,
}

/// All points that need small cells.
pub(super) struct SizingField<'p> {
    places: &'p [SizingPoint],
    /// A tree over their positions.
    tree: PointTree<'p>,
}

impl<'p> SizingField<'p> {
    /// `points` are the positions of `places`, which the tree borrows.
    pub fn new(places: &'p [SizingPoint], points: &'p [[f64; 3]]) -> Self {
        Self { places, tree: PointTree::new(points) }
    }

    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Whether some point in the box needs cells smaller than `size`.
    pub fn is_smaller_in(&self, bounds: &Box3, size: f64) -> bool {
        self.tree.any_in(bounds, |place| size > self.places[place as usize].size)
    }
}
