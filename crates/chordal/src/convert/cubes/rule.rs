//! The options of the polygonizer, and the crossing of the surface with an edge of the lattice.
use crate::implicit::Affine3;

/// The rule for inside samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inside {
    /// Those below the level, as in fields and distances.
    Low,
    /// Those above the level, as in densities, masks and occupancies.
    #[default]
    High,
}

/// How a shape ends at the border of the lattice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// The surface ends at the border.
    Open,
    /// Flat faces in the border close the shape.
    #[default]
    Capped,
}

/// Whether vertices carry normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normals {
    /// No normals.
    #[default]
    None,
    /// Along the gradient of central differences of the samples, outwards.
    Gradient,
}

/// How a grid becomes triangles.
///
/// A sample that equals the level is outside, and so is NaN, which counts as the level in the position of the
/// surface. ±∞ count as the largest numbers of f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polygonize {
    /// The level, finite.
    pub level: f64,
    /// The side of the level on which the shape is.
    pub inside: Inside,
    /// The low and the high border of each index.
    pub border: [[Border; 2]; 3],
    /// Whether vertices carry normals.
    pub normals: Normals,
    /// The index of the first sample in a larger lattice, to which the grid's transform then belongs: blocks
    /// of one volume join bit for bit.
    pub offset: [i64; 3],
    /// The least distance of a vertex from a sample, as a fraction of the lattice edge; see [`Polygonize::MARGIN`].
    pub margin: f64,
}

impl Polygonize {
    /// The default margin: exactly 2⁻²⁰ of an edge. Vertices of different edges stay that far apart, so that
    /// no triangle is flat if samples equal the level.
    pub const MARGIN: f64 = 1.0 / 1_048_576.0;
    /// A margin that single precision resolves on lattices of up to 512 samples a side around the origin.
    pub const MARGIN_F32: f64 = 1.0 / 1024.0;

    /// The surface at this level, with larger samples inside, capped at the border.
    #[must_use]
    pub fn above(level: f64) -> Self {
        Self {
            level,
            inside: Inside::High,
            border: [[Border::Capped; 2]; 3],
            normals: Normals::None,
            offset: [0; 3],
            margin: Self::MARGIN,
        }
    }

    /// Like [`Polygonize::above`], with smaller samples inside.
    #[must_use]
    pub fn below(level: f64) -> Self {
        Self { inside: Inside::Low, ..Self::above(level) }
    }

    /// The same, open at the border of the lattice.
    #[must_use]
    pub fn open(self) -> Self {
        Self { border: [[Border::Open; 2]; 3], ..self }
    }

    /// Whether a sample is inside.
    #[inline(always)]
    pub(crate) fn is_inside(&self, sample: f64) -> bool {
        match self.inside {
            Inside::Low => sample < self.level,
            Inside::High => sample > self.level,
        }
    }

    /// A sample as the finite number that it counts as.
    #[inline]
    pub(crate) fn finite_sample(&self, sample: f64) -> f64 {
        if sample.is_nan() { self.level } else { sample.clamp(f64::MIN, f64::MAX) }
    }

    /// The position of the level between two samples on different sides, from 0 at the first to 1 at the
    /// second, kept away from both by the margin.
    #[inline(always)]
    pub(crate) fn crossing(&self, from: f64, to: f64) -> f64 {
        let part = (self.level - from) / (to - from);
        if part >= self.margin && part <= 1.0 - self.margin { part } else { self.robust_crossing(from, to) }
    }

    /// [`Polygonize::crossing`] near a sample, or for samples with a difference that is not finite.
    #[cold]
    fn robust_crossing(&self, from: f64, to: f64) -> f64 {
        // Quarters, so that the difference of the largest numbers stays finite.
        let (from, to) = (0.25 * self.finite_sample(from), 0.25 * self.finite_sample(to));
        let part = (0.25 * self.level - from) / (to - from);
        if part < self.margin {
            self.margin
        } else if part > 1.0 - self.margin {
            1.0 - self.margin
        } else if part.is_nan() {
            // Both are so small that a quarter of them is 0.
            0.5
        } else {
            part
        }
    }
}

/// Maps indices of a lattice to space, by one formula for every block, so that blocks agree in every bit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LatticeTransform {
    rows: [[f64; 4]; 3],
    offset: [i64; 3],
}

impl LatticeTransform {
    pub(crate) fn new(affine: &Affine3, offset: [i64; 3]) -> Self {
        Self { rows: affine.rows(), offset }
    }

    /// The index along an axis in the larger lattice.
    #[inline(always)]
    pub(crate) fn global(&self, axis: usize, index: usize) -> f64 {
        (self.offset[axis] + index as i64) as f64
    }

    /// The point in space of index coordinates in the larger lattice.
    #[inline(always)]
    pub(crate) fn at(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        self.rows.map(|[a, b, c, d]| a * x + (b * y + (c * z + d)))
    }
}
