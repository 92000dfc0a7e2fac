//! `Affine3`: the map from the indices of a lattice to points of space.
use crate::math::{Orientation, orient3d};
use std::fmt;

/// The position of the sample with index (i, j, k): rows of `[a, b, c, d]` with `x = a·i + b·j + c·k + d` and
/// so on. Sheared and mirrored lattices are allowed; only flat ones are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine3([[f64; 4]; 3]);

impl Affine3 {
    /// The index (i, j, k) is the point (i, j, k).
    pub const IDENTITY: Self = Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    /// The map with these rows.
    ///
    /// # Errors
    /// [`InvalidAffine`] when a number is not finite, or the map flattens space.
    pub fn new(rows: [[f64; 4]; 3]) -> Result<Self, InvalidAffine> {
        let map = Self(rows);
        if !rows.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(InvalidAffine("a number of the lattice's transform is not finite".into()));
        }
        if map.orientation() == 0 {
            return Err(InvalidAffine("the lattice's transform is singular: it flattens space".into()));
        }
        Ok(map)
    }

    /// Cubes of side `step` with the first sample at `origin`.
    ///
    /// # Errors
    /// As for [`Affine3::new`].
    pub fn cubes(origin: [f64; 3], step: f64) -> Result<Self, InvalidAffine> {
        let [x, y, z] = origin;
        Self::new([[step, 0.0, 0.0, x], [0.0, step, 0.0, y], [0.0, 0.0, step, z]])
    }

    /// The rows.
    #[must_use]
    pub fn rows(&self) -> [[f64; 4]; 3] {
        self.0
    }

    /// The map that applies `first`, then this one, rounded.
    ///
    /// # Errors
    /// As for [`Affine3::new`].
    ///
    /// ```
    /// use chordal::implicit::Affine3;
    /// let (doubled, moved) = (Affine3::cubes([0.0; 3], 2.0)?, Affine3::cubes([1.0, 0.0, 0.0], 1.0)?);
    /// assert_eq!(doubled.after(&moved)?.at([0.0; 3]), [2.0, 0.0, 0.0]);
    /// # Ok::<(), chordal::implicit::InvalidAffine>(())
    /// ```
    pub fn after(&self, first: &Self) -> Result<Self, InvalidAffine> {
        let (a, b) = (self.rows(), first.rows());
        let entry = |i: usize, j: usize| (a[i][0] * b[0][j] + a[i][1] * b[1][j]) + a[i][2] * b[2][j];
        let row =
            |i: usize| std::array::from_fn(|j| if j == 3 { entry(i, j) + a[i][3] } else { entry(i, j) });
        Self::new([0, 1, 2].map(row))
    }

    /// The point of an index, rounded. The index may be fractional.
    #[inline]
    #[must_use]
    pub fn at(&self, index: [f64; 3]) -> [f64; 3] {
        self.0.map(|[a, b, c, d]| ((a * index[0] + b * index[1]) + c * index[2]) + d)
    }

    /// The three step vectors: the motion of the point when one index grows by 1.
    #[must_use]
    pub fn steps(&self) -> [[f64; 3]; 3] {
        [0, 1, 2].map(|k| [self.0[0][k], self.0[1][k], self.0[2][k]])
    }

    /// 1 if the map keeps handedness, −1 if it mirrors, 0 if it flattens space; exact.
    #[must_use]
    pub fn orientation(&self) -> i8 {
        let [a, b, c] = self.steps();
        match orient3d([0.0; 3], a, b, c) {
            Orientation::Front => 1,
            Orientation::Flat => 0,
            Orientation::Back => -1,
        }
    }
}

/// The reason why a map is invalid, in one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidAffine(String);

impl fmt::Display for InvalidAffine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for InvalidAffine {}
