//! `Grid`: samples of a number on a lattice in space.
use super::affine::Affine3;
use std::fmt;

/// The samples of a [`Grid`], in their original type.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Samples {
    /// 32-bit floating point.
    F32(Vec<f32>),
    /// 64-bit floating point.
    F64(Vec<f64>),
    /// Unsigned 8-bit integers.
    U8(Vec<u8>),
    /// Signed 8-bit integers.
    I8(Vec<i8>),
    /// Unsigned 16-bit integers.
    U16(Vec<u16>),
    /// Signed 16-bit integers.
    I16(Vec<i16>),
    /// Unsigned 32-bit integers.
    U32(Vec<u32>),
    /// Signed 32-bit integers.
    I32(Vec<i32>),
}

/// Calls the body with the vector that a [`Samples`] holds, whatever its type.
macro_rules! with_samples {
    ($samples:expr, $values:ident => $body:expr) => {
        match $samples {
            $crate::implicit::Samples::F32($values) => $body,
            $crate::implicit::Samples::F64($values) => $body,
            $crate::implicit::Samples::U8($values) => $body,
            $crate::implicit::Samples::I8($values) => $body,
            $crate::implicit::Samples::U16($values) => $body,
            $crate::implicit::Samples::I16($values) => $body,
            $crate::implicit::Samples::U32($values) => $body,
            $crate::implicit::Samples::I32($values) => $body,
        }
    };
}

pub(crate) use with_samples;

impl Samples {
    /// The number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        with_samples!(self, values => values.len())
    }

    /// Whether there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One sample as f64, which represents all of these types exactly.
    ///
    /// # Panics
    /// When the index is too large.
    #[must_use]
    #[allow(clippy::useless_conversion, reason = "one body for every type of samples")]
    pub fn get(&self, index: usize) -> f64 {
        with_samples!(self, values => f64::from(values[index]))
    }

    /// The numbers of NaN and of infinite samples.
    #[must_use]
    pub fn count_not_finite(&self) -> [u64; 2] {
        let mut counts = [0; 2];
        match self {
            Self::F32(values) => values.iter().for_each(|v| tally(f64::from(*v), &mut counts)),
            Self::F64(values) => values.iter().for_each(|v| tally(*v, &mut counts)),
            _ => {}
        }
        counts
    }

    /// The bytes of one sample.
    #[must_use]
    pub fn width(&self) -> usize {
        match self {
            Self::U8(_) | Self::I8(_) => 1,
            Self::U16(_) | Self::I16(_) => 2,
            Self::F32(_) | Self::U32(_) | Self::I32(_) => 4,
            Self::F64(_) => 8,
        }
    }
}

fn tally(value: f64, [n_nan, n_infinite]: &mut [u64; 2]) {
    *n_nan += u64::from(value.is_nan());
    *n_infinite += u64::from(value.is_infinite());
}

/// Samples on a lattice, the first index running fastest, with the map from indices to space. Between samples
/// the value is the exact trilinear interpolant of the samples and the map, both taken in f64.
///
/// ```
/// use chordal::implicit::{Affine3, Grid, Samples};
/// let grid = Grid::new([2, 2, 2], Samples::U8(vec![0, 1, 0, 1, 0, 1, 0, 1]), Affine3::IDENTITY)?;
/// assert_eq!(grid.sample([1, 0, 1]), 1.0);
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    size: [usize; 3],
    samples: Samples,
    affine: Affine3,
}

impl Grid {
    /// A grid with `size[k]` samples along index k.
    ///
    /// # Errors
    /// [`InvalidGrid`] when a size is 0, or the number of samples is not their product.
    pub fn new(size: [usize; 3], samples: Samples, affine: Affine3) -> Result<Self, InvalidGrid> {
        let count = size.iter().try_fold(1_usize, |all, n| all.checked_mul(*n));
        if size.contains(&0) || count != Some(samples.len()) {
            let [x, y, z] = size;
            return Err(InvalidGrid(format!("{} samples are no lattice of {x} x {y} x {z}", samples.len())));
        }
        Ok(Self { size, samples, affine })
    }

    /// The number of samples along each index.
    #[must_use]
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// The samples, the first index running fastest.
    #[must_use]
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// The map from indices to space.
    #[must_use]
    pub fn affine(&self) -> &Affine3 {
        &self.affine
    }

    /// The same samples with another map to space.
    #[must_use]
    pub fn with_affine(self, affine: Affine3) -> Self {
        Self { affine, ..self }
    }

    /// One sample.
    ///
    /// # Panics
    /// When an index is not below the size.
    #[must_use]
    pub fn sample(&self, index: [usize; 3]) -> f64 {
        assert!((0..3).all(|k| index[k] < self.size[k]), "{index:?} is not below {:?}", self.size);
        self.samples.get(index[0] + self.size[0] * (index[1] + self.size[1] * index[2]))
    }
}

/// The reason why a grid is invalid, in one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidGrid(String);

impl fmt::Display for InvalidGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for InvalidGrid {}
