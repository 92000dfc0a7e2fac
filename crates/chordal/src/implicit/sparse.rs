//! `SparseGrid`: samples on a lattice in bricks of 8³, without the bricks that hold only background.
use super::affine::Affine3;
use super::grid::{Grid, InvalidGrid, Samples};
use crate::math::greater;

/// Samples along each side of a brick.
pub(crate) const BRICK: usize = 8;
/// Samples of a brick.
const VOLUME: usize = BRICK * BRICK * BRICK;

/// The directory entry of an absent brick outside the shape: all samples equal the background …
const OUTSIDE: u32 = u32::MAX;
/// … and inside: all samples equal minus the background.
const INSIDE: u32 = u32::MAX - 1;

/// Samples in f64 on a lattice, for data such as a narrow band of distances. A directory has one entry for
/// each brick of 8³ samples. A brick is stored unless all its samples equal the background value, or all
/// equal minus that value.
///
/// Access to a sample takes O(1) through the directory; [`SparseGrid::to_dense`] has the same numbers bit for
/// bit. Memory: 4 KiB for a stored brick, and 4 bytes for an absent one, 1/1024 of its dense samples
/// ([`SparseGrid::bytes`]).
///
/// ```
/// use chordal::implicit::{Affine3, Grid, Samples, SparseGrid};
/// // A band of width 1 around a plane.
/// let values = (0..16 * 16 * 64).map(|n| ((n / 256) as f64 - 20.5).clamp(-1.0, 1.0)).collect();
/// let dense = Grid::new([16, 16, 64], Samples::F64(values), Affine3::IDENTITY)?;
/// let sparse = SparseGrid::from_grid(&dense, 1.0);
/// assert_eq!(sparse.n_bricks(), [4, 32]);
/// assert_eq!((sparse.sample([3, 4, 0]), sparse.sample([3, 4, 21]), sparse.sample([3, 4, 63])), (-1.0, 0.5, 1.0));
/// assert_eq!(sparse.to_dense(), dense);
/// # Ok::<(), chordal::implicit::InvalidGrid>(())
/// ```
///
/// Source: K. Museth, *VDB: high-resolution sparse volumes with dynamic topology*, 2013, of which this is the
/// lowest level.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseGrid {
    size: [usize; 3],
    affine: Affine3,
    background: f64,
    /// For each brick of the lattice, the first index running fastest, the index of its values.
    directory: Vec<u32>,
    /// 512 values per stored brick, the first index running fastest; those beyond the lattice are 0.
    values: Vec<f64>,
}

impl SparseGrid {
    /// The dense grid without the bricks that hold only `background`, or only minus that. Cost: one pass over
    /// the samples.
    ///
    /// # Panics
    /// When 2³² − 2 bricks or more have to be stored.
    #[must_use]
    pub fn from_grid(grid: &Grid, background: f64) -> Self {
        let size = grid.size();
        let mut sparse = Self::empty(size, *grid.affine(), background);
        let [nx, ny, nz] = size;
        for layer in 0..nz.div_ceil(BRICK) {
            let planes = BRICK.min(nz - layer * BRICK);
            let start = nx * ny * layer * BRICK;
            let samples: Vec<f64> =
                (start..start + nx * ny * planes).map(|n| grid.samples().get(n)).collect();
            let layer = BrickSlab::from_samples(&samples, size, background);
            sparse.push(layer);
        }
        sparse
    }

    /// A grid without layers.
    pub(crate) fn empty(size: [usize; 3], affine: Affine3, background: f64) -> Self {
        Self { size, affine, background, directory: Vec::new(), values: Vec::new() }
    }

    /// Appends the next eight planes.
    pub(crate) fn push(&mut self, layer: BrickSlab) {
        let first = (self.values.len() / VOLUME) as u32;
        // The marks of absent bricks are above all numbers, and stay.
        let placed = layer.directory.iter().map(|brick| if *brick < INSIDE { first + brick } else { *brick });
        self.directory.extend(placed);
        self.values.extend(layer.values);
        assert!(self.values.len() / VOLUME < INSIDE as usize, "bricks are numbered in 32 bits");
    }

    /// The number of samples along each index.
    #[must_use]
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// The map from indices to space.
    #[must_use]
    pub fn affine(&self) -> &Affine3 {
        &self.affine
    }

    /// The background value: all samples of an absent brick equal it, or minus it.
    #[must_use]
    pub fn background(&self) -> f64 {
        self.background
    }

    /// The number of stored bricks, and of all bricks of the lattice.
    #[must_use]
    pub fn n_bricks(&self) -> [usize; 2] {
        [self.values.len() / VOLUME, self.directory.len()]
    }

    /// The bytes of values and directory.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        8 * self.values.len() as u64 + 4 * self.directory.len() as u64
    }

    /// The largest absolute value; infinite samples count as the largest number.
    pub(crate) fn largest(&self) -> f64 {
        let sizes = self.values.iter().map(|x| if x.is_infinite() { f64::MAX } else { x.abs() });
        sizes.fold(self.background.abs(), |most, x| greater(x, most))
    }

    /// One sample.
    ///
    /// # Panics
    /// When an index is not below the size.
    #[inline]
    #[must_use]
    pub fn sample(&self, index: [usize; 3]) -> f64 {
        assert!((0..3).all(|k| index[k] < self.size[k]), "{index:?} is not below {:?}", self.size);
        let [bx, by] = [self.size[0].div_ceil(BRICK), self.size[1].div_ceil(BRICK)];
        let [x, y, z] = index.map(|i| i / BRICK);
        match self.directory[x + bx * (y + by * z)] {
            OUTSIDE => self.background,
            INSIDE => -self.background,
            brick => {
                let [i, j, k] = index.map(|i| i % BRICK);
                self.values[VOLUME * brick as usize + i + BRICK * (j + BRICK * k)]
            }
        }
    }

    /// Whether the brick of a sample is stored; otherwise all its samples equal the background, or minus
    /// that.
    ///
    /// # Panics
    /// When an index is not below the size.
    #[must_use]
    pub fn is_stored(&self, index: [usize; 3]) -> bool {
        assert!((0..3).all(|k| index[k] < self.size[k]), "{index:?} is not below {:?}", self.size);
        let [bx, by] = [self.size[0].div_ceil(BRICK), self.size[1].div_ceil(BRICK)];
        let [x, y, z] = index.map(|i| i / BRICK);
        self.directory[x + bx * (y + by * z)] < INSIDE
    }

    /// The same samples in one array, for files and for code that needs all of them.
    #[must_use]
    pub fn to_dense(&self) -> Grid {
        let [nx, ny, nz] = self.size;
        let mut samples = Vec::with_capacity(nx * ny * nz);
        for k in 0..nz {
            for j in 0..ny {
                samples.extend((0..nx).map(|i| self.sample([i, j, k])));
            }
        }
        let grid: Result<Grid, InvalidGrid> = Grid::new(self.size, Samples::F64(samples), self.affine);
        grid.expect("as many samples as the lattice has")
    }
}

/// Up to eight planes of samples in bricks; fewer at the end of the lattice.
pub(crate) struct BrickSlab {
    /// Brick indices, counted from the first brick of this layer.
    directory: Vec<u32>,
    values: Vec<f64>,
}

impl BrickSlab {
    /// The bytes of values and directory.
    pub(crate) fn bytes(&self) -> u64 {
        8 * self.values.len() as u64 + 4 * self.directory.len() as u64
    }

    /// The bricks of some planes of a lattice.
    pub(crate) fn from_samples(samples: &[f64], size: [usize; 3], background: f64) -> Self {
        let [nx, ny, _] = size;
        let planes = samples.len() / (nx * ny);
        let mut layer = Self { directory: Vec::new(), values: Vec::new() };
        for y in (0..ny).step_by(BRICK) {
            for x in (0..nx).step_by(BRICK) {
                let mut brick = [0.0; VOLUME];
                let (mut outside, mut inside) = (true, true);
                for k in 0..planes {
                    for j in y..ny.min(y + BRICK) {
                        for i in x..nx.min(x + BRICK) {
                            let value = samples[i + nx * (j + ny * k)];
                            // Compare bits, so that −0 and NaN come back unchanged.
                            outside &= value.to_bits() == background.to_bits();
                            inside &= value.to_bits() == (-background).to_bits();
                            brick[i - x + BRICK * (j - y + BRICK * k)] = value;
                        }
                    }
                }
                let number = (layer.values.len() / VOLUME) as u32;
                layer.directory.push(if outside {
                    OUTSIDE
                } else if inside {
                    INSIDE
                } else {
                    number
                });
                if !outside && !inside {
                    layer.values.extend(brick);
                }
            }
        }
        layer
    }
}
