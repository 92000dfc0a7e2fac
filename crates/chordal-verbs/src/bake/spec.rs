//! `BakeSpec`: the lattice for distances as a user requests it.
use chordal::budget::Length;

/// The lattice around a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeSpec {
    /// The number of cells.
    pub resolution: BakeResolution,
    /// The width of the narrow band, in cells on either side of the surface; samples outside are not distances. `None`:
    /// distances everywhere.
    pub band: Option<f64>,
    /// Whether only the bricks that the band reaches are stored; needs a band.
    pub is_sparse: bool,
    /// Whether to prove a bound for the distance between the shape and the zero set of the interpolant of the samples: some
    /// tenths of a millisecond a triangle. With a length it always is proved.
    pub is_bounded: bool,
}

/// The number of cells of a lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BakeResolution {
    /// So many cells along the longest side of the shape's box.
    Cells(usize),
    /// As many as it takes to prove that the zero set of the interpolant is within this length of the shape.
    Within(Length),
}

impl BakeSpec {
    /// Distances everywhere, on so many cells along the longest side, without a proof for their surface.
    #[must_use]
    pub fn cells(cells: usize) -> Self {
        Self::from(BakeResolution::Cells(cells))
    }
}

impl From<BakeResolution> for BakeSpec {
    fn from(resolution: BakeResolution) -> Self {
        Self { resolution, band: None, is_sparse: false, is_bounded: false }
    }
}
