//! `AffineMap`: an affine map of the plane or of space.

/// An affine map of the plane or of space: `x ↦ columns·x + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AffineMap<const D: usize> {
    /// The images of the axes.
    pub columns: [[f64; D]; D],
    /// The image of the origin.
    pub offset: [f64; D],
}

impl<const D: usize> AffineMap<D> {
    /// The identity map.
    #[must_use]
    pub fn identity() -> Self {
        let unit = |i: usize, k: usize| if i == k { 1.0 } else { 0.0 };
        Self { columns: std::array::from_fn(|i| std::array::from_fn(|k| unit(i, k))), offset: [0.0; D] }
    }

    /// The image of a point.
    #[must_use]
    pub fn point(&self, p: [f64; D]) -> [f64; D] {
        let turned = self.vector(p);
        std::array::from_fn(|k| turned[k] + self.offset[k])
    }

    /// The image of a difference of points.
    #[must_use]
    pub fn vector(&self, v: [f64; D]) -> [f64; D] {
        std::array::from_fn(|k| (0..D).fold(0.0, |sum, i| sum + self.columns[i][k] * v[i]))
    }

    /// The composition: first `first`, then `self`.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        Self { columns: first.columns.map(|column| self.vector(column)), offset: self.point(first.offset) }
    }

    /// An upper bound for the growth of lengths (the Frobenius norm; at most √D times too large).
    #[must_use]
    pub fn stretch(&self) -> f64 {
        let squares = self.columns.as_flattened().iter().fold(0.0, |sum: f64, x| (sum + x * x).next_up());
        squares.sqrt().next_up()
    }
}
