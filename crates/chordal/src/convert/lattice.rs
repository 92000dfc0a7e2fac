//! Lattices: the points where a field is sampled, and the bricks in which the samples are processed.
use crate::budget::{JobError, Refusal, RefusalCode};
use crate::implicit::Affine3;
use crate::math::{Box3, add_up, greater, lesser};

/// Samples along each side of a brick.
pub(super) const BRICK: usize = 8;

/// A lattice of samples: their number along each index, and their positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Samples along each index.
    pub size: [usize; 3],
    /// Maps indices to space.
    pub affine: Affine3,
}

impl Lattice {
    /// Covers a box with cubes: `cells` of them along its longest side, and `margin` more beyond each side.
    /// `None` for a box that is empty, endless, or a single point, for no cells, and for more samples than
    /// 2⁴⁰.
    #[must_use]
    pub fn around(bounds: &Box3, cells: usize, margin: usize) -> Option<Self> {
        if bounds.is_empty() || cells == 0 {
            return None;
        }
        let sides: [f64; 3] = std::array::from_fn(|k| bounds.max[k] - bounds.min[k]);
        let longest = sides.iter().fold(0.0, |m, s| greater(*s, m));
        let step = longest / cells as f64;
        if !(step > 0.0 && step.is_finite()) {
            return None;
        }
        let counts = sides.map(|side| (side / step).ceil() as usize);
        let size = counts.map(|n| n.saturating_add(margin.saturating_mul(2)).saturating_add(1));
        if size.iter().try_fold(1_usize, |all, n| all.checked_mul(*n)).is_none_or(|n| n as u64 > 1 << 40) {
            return None;
        }
        // The cells may exceed the side; both ends share the excess.
        let origin = std::array::from_fn(|k| {
            let slack = counts[k] as f64 * step - sides[k];
            bounds.min[k] - (margin as f64 * step + 0.5 * slack)
        });
        Some(Self { size, affine: Affine3::cubes(origin, step).ok()? })
    }

    /// Covers a box for the distances to a shape in it: with a margin of three cells, or of the `band`, a number of
    /// cells above 0.
    ///
    /// # Errors
    /// [`JobError::Refused`] for a band that is not above 0 and at most a million, and if [`Lattice::around`] is
    /// `None`.
    pub fn for_distances(bounds: &Box3, cells: usize, band: Option<f64>) -> Result<Self, JobError> {
        let refused = |code, message: String| JobError::Refused(Refusal::new(code, message));
        if let Some(width) = band.filter(|width| !(*width > 0.0 && *width <= 1e6)) {
            let message = format!("the band is {width} cells, and must be above 0 and at most 1e6");
            return Err(refused(RefusalCode::Budget, message));
        }
        let margin = band.map_or(3, |width| width.ceil() as usize);
        Self::around(bounds, cells, margin).ok_or_else(|| {
            let message = format!("there is no lattice with {cells} cells along the shape's longest side");
            refused(RefusalCode::Empty, message)
        })
    }

    /// The edge length of its cells, if they are cubes.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.affine.rows()[0][0]
    }

    /// The position of a sample.
    #[must_use]
    pub fn at(&self, index: [usize; 3]) -> [f64; 3] {
        self.affine.at(index.map(|i| i as f64))
    }

    /// The number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.size.iter().product()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.size.contains(&0)
    }

    pub(super) fn row(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.size[0] * (j + self.size[1] * k)
    }

    /// The number of layers of bricks along the last index.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.size[2].div_ceil(BRICK)
    }

    /// The bricks of a layer, each by the indices of its first sample and one past its last.
    pub fn bricks(&self, layer: usize) -> impl Iterator<Item = [[usize; 3]; 2]> + '_ {
        let counts = [self.size[0].div_ceil(BRICK), self.size[1].div_ceil(BRICK)];
        (0..counts[1]).flat_map(move |j| {
            (0..counts[0]).map(move |i| {
                let first = [i * BRICK, j * BRICK, layer * BRICK];
                let end = std::array::from_fn(|k| {
                    let end = first[k] + BRICK;
                    lesser(end, self.size[k])
                });
                [first, end]
            })
        })
    }

    /// A box around all samples of a brick as [`Affine3::at`] computes them, rounding included.
    pub(super) fn hull(&self, [first, end]: [[usize; 3]; 2]) -> Box3 {
        let mut hull = Box3::EMPTY;
        for corner in 0..8_usize {
            let index = std::array::from_fn(|k| if corner >> k & 1 == 0 { first[k] } else { end[k] - 1 });
            hull = hull.with(self.at(index));
        }
        // The rounded map is not quite linear between corners: it deviates by 3 roundings of its terms.
        let last = end.map(|n| n as f64);
        let rounding = self.affine.rows().map(|[a, b, c, d]| {
            4.0 * f64::EPSILON * (a.abs() * last[0] + b.abs() * last[1] + c.abs() * last[2] + d.abs())
        });
        Box3 {
            min: std::array::from_fn(|k| -add_up(-hull.min[k], rounding[k])),
            max: std::array::from_fn(|k| add_up(hull.max[k], rounding[k])),
        }
    }
}
