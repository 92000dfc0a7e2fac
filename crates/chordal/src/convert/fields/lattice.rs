//! `Lattice`: cubes of one size over a box, in bricks of 8 × 8 × 8.
use crate::math::Box3;

/// Cells along the side of a brick.
pub(super) const BRICK: usize = 8;
/// Points along the side of a brick, those that it shares with the next one included.
pub(super) const POINTS: usize = BRICK + 1;

/// Where the points of a lattice are: those of whole numbers, times the step, from the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    pub origin: [f64; 3],
    pub step: f64,
    /// Bricks along each axis.
    pub bricks: [u32; 3],
}

/// Shares of a step by which the first points lie outside of the box, one for each axis: so odd that planes at round
/// numbers do not run through points, where an edge would be met at its very end.
const ASIDE: [f64; 3] = [0.618_034, 0.381_966, 0.754_878];

impl Lattice {
    /// Cubes of side `step` that cover the box with one more all around; `None` where there would be too many to count, or
    /// coordinates could not tell them apart.
    pub fn over(bounds: &Box3, step: f64) -> Option<Self> {
        let ends = bounds.min.iter().chain(&bounds.max);
        let reach = ends.fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most });
        // A cell has to have room for places inside of it: exactly 2¹² steps of the largest coordinate.
        if step < 4096.0 * f64::EPSILON * reach {
            return None;
        }
        let mut lattice = Self { origin: [0.0; 3], step, bricks: [0; 3] };
        for (k, aside) in ASIDE.into_iter().enumerate() {
            lattice.origin[k] = bounds.min[k] - step * (1.0 + aside);
            let cells = (bounds.max[k] - lattice.origin[k]) / step + 2.0;
            let bricks = (cells / BRICK as f64).ceil();
            // Far below the numbers at which places between neighbours would be no place.
            if !(bricks >= 1.0 && bricks < f64::from(1_u32 << 24)) {
                return None;
            }
            lattice.bricks[k] = bricks as u32;
        }
        Some(lattice)
    }

    /// A coordinate of a point; it grows with the number, so that boxes between points hold all points between.
    pub fn at(&self, axis: usize, number: u32) -> f64 {
        self.origin[axis] + self.step * f64::from(number)
    }

    /// The box of a cube of `size` bricks.
    pub fn bounds(&self, brick: [u32; 3], size: u32) -> Box3 {
        let first = |k: usize| brick[k] * BRICK as u32;
        Box3 {
            min: std::array::from_fn(|k| self.at(k, first(k))),
            max: std::array::from_fn(|k| self.at(k, first(k) + size * BRICK as u32)),
        }
    }
}
