//! `BakeSpec`: the lattice that distances are sampled on, as it is asked for.
use chordal::budget::Length;

/// The lattice around a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeSpec {
    /// How many cells there are.
    pub resolution: BakeResolution,
    /// The narrow band in cells on either side of the surface; outside it samples are no distances. `None`:
    /// distances everywhere.
    pub band: Option<f64>,
    /// Whether only the bricks of samples that the band reaches are held; needs a band.
    pub is_sparse: bool,
    /// Whether the distance between the shape and where the interpolant of the samples vanishes is proved: some
    /// tenths of a millisecond a triangle. With a length it always is.
    pub is_bounded: bool,
}

/// How many cells a lattice gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BakeResolution {
    /// So many along the longest side of the shape's box.
    Cells(usize),
    /// As many as it takes for the surface where the interpolant vanishes to be proved so close to the shape.
    Within(Length),
}

impl BakeSpec {
    /// Distances everywhere on so many cells along the longest side, and no proof of their surface.
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
