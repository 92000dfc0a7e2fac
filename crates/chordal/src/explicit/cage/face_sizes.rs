//! The ranges of the corners of faces, without memory per face if all have the same size.
use std::ops::Range;

/// A unique form: one or more faces of equal size are always `Even`.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum FaceSizes {
    Even { size: usize, n: usize },
    Each(Vec<u32>),
}

impl FaceSizes {
    /// From the end of each face's corners.
    pub fn from_ends(ends: Vec<u32>) -> Self {
        let size = ends.first().map_or(0, |end| *end as usize);
        let is_even = ends.iter().enumerate().all(|(face, end)| *end as usize == (face + 1) * size);
        if is_even { Self::uniform(size, ends.len()) } else { Self::Each(ends) }
    }

    pub fn uniform(size: usize, n: usize) -> Self {
        if n == 0 { Self::default() } else { Self::Even { size, n } }
    }

    pub fn len(&self) -> usize {
        match self {
            Self::Even { n, .. } => *n,
            Self::Each(ends) => ends.len(),
        }
    }

    /// The corners of a face.
    ///
    /// # Panics
    /// When there is no such face.
    #[inline]
    pub fn range(&self, face: usize) -> Range<usize> {
        match self {
            Self::Even { size, n } => {
                assert!(face < *n, "there is no face {face}");
                size * face..size * (face + 1)
            }
            Self::Each(ends) => {
                let start = if face == 0 { 0 } else { ends[face - 1] };
                start as usize..ends[face] as usize
            }
        }
    }
}

impl Default for FaceSizes {
    fn default() -> Self {
        Self::Each(Vec::new())
    }
}
