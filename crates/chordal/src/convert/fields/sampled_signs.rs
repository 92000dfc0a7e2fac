//! `SampledSigns`: the sides of lattice points, for functions that are known only at points.
//!
//! Without ranges, only samples can show that the boundary does not pass a large cell. Instead of cutting all of space
//! into small cells, functions are sampled once on a lattice as dense as the corners of such cells, and a cell stays large
//! if all samples in it and around it are on one side.
use super::cells::ZeroSide;
use crate::implicit::{LeafError, PrimitiveEvaluator};
use crate::math::{Box3, greater, lesser};

/// Lattice steps per longest edge of cells, for as many lattice points as corners. Counted: 92,287 corners and
/// 91,125 points in a cube with cells of a 25th of it.
const STEPS: f64 = 1.74;
/// The fewest steps along each side of the bounds. Chosen: features of a tenth of a short side are found, too.
const FEWEST: f64 = 12.0;
/// Cells whose corners miss a sample are cut down to this many of the shortest steps. Chosen: then samples are about as
/// dense as corners.
const IN_STEPS: f64 = 2.0;
/// They are not cut below this fraction of the coarsest edge. Chosen: 200,000 cells in a plate of a hundredth of its length.
const NOT_BELOW: f64 = 0.25;

/// The sides of the points of a lattice over the bounds, for sampled primitives, as summed-volume tables.
#[derive(Debug, Default)]
pub(super) struct SampledSigns {
    origin: [f64; 3],
    steps: [f64; 3],
    /// Points along each axis.
    n_points: [usize; 3],
    /// Cells with a longest edge of at most this are not cut for a sample that their corners miss.
    enough: f64,
    /// By primitive, if it is sampled: for each lattice corner, the number of inside points with smaller indices along all
    /// axes.
    before: Vec<Option<Vec<u32>>>,
}

/// Samples of a primitive in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct SampleCount {
    n_inside: usize,
    n_all: usize,
}

impl SampledSigns {
    /// Samples all primitives with leaves whose range over the bounds is infinite; `zero` is the side of 0 by primitive.
    ///
    /// # Errors
    /// The error of a leaf.
    pub fn new(
        evaluator: &mut PrimitiveEvaluator,
        has_leaves: &[bool],
        zero: &[ZeroSide],
        bounds: Box3,
        coarsest: f64,
    ) -> Result<Self, LeafError> {
        let sides: [f64; 3] = std::array::from_fn(|k| bounds.max[k] - bounds.min[k]);
        let n_steps = sides.map(|side| greater((STEPS * side / coarsest).ceil(), FEWEST));
        let steps: [f64; 3] = std::array::from_fn(|k| sides[k] / n_steps[k]);
        // If cells may be as large as the bounds, nothing is sampled; flat bounds have no inside.
        if coarsest >= sides.iter().fold(0.0, |a, b| greater(*b, a)) || !steps.iter().all(|step| *step > 0.0)
        {
            return Ok(Self::default());
        }
        let n_points = n_steps.map(|n| n as usize + 1);
        let shortest = steps.iter().fold(f64::INFINITY, |a, b| lesser(*b, a));
        let mut signs = Self {
            origin: bounds.min,
            steps,
            n_points,
            enough: greater(IN_STEPS * shortest, NOT_BELOW * coarsest),
            before: vec![None; has_leaves.len()],
        };
        let [nx, ny, nz] = n_points;
        for (p, _) in has_leaves.iter().enumerate().filter(|(_, has_leaves)| **has_leaves) {
            let range = evaluator.dual_ranges(&[(p as u32, bounds)])?[0].value;
            // Samples serve only where intervals say nothing.
            if range.iter().all(|end| end.is_finite()) {
                continue;
            }
            let query = |i: usize| {
                let at = [i % nx, i / nx % ny, i / (nx * ny)];
                (p as u32, std::array::from_fn(|k| signs.origin[k] + at[k] as f64 * steps[k]))
            };
            let queries: Vec<(u32, [f64; 3])> = (0..nx * ny * nz).map(query).collect();
            let values = evaluator.values(&queries)?;
            signs.before[p] = Some(count_before(n_points, |i| zero[p].is_inside(values[i])));
        }
        Ok(signs)
    }

    /// `Some(true)` if all points in the box and a step around it are inside the primitive, `Some(false)` if none is; `None` if
    /// they differ or are unknown.
    pub fn is_inside(&self, primitive: u32, cell: &Box3) -> Option<bool> {
        let before = self.before_of(primitive)?;
        let from = |k: usize| self.steps_to(cell.min[k], k).floor() - 1.0;
        let to = |k: usize| self.steps_to(cell.max[k], k).ceil() + 1.0;
        // For boxes beside the bounds, the points at the border are taken.
        let last = |k: usize| (self.n_points[k] - 1) as f64;
        let low = std::array::from_fn(|k| from(k).clamp(0.0, last(k)) as usize);
        let high = std::array::from_fn(|k| to(k).clamp(0.0, last(k)) as usize);
        let SampleCount { n_inside, n_all } = self.count(before, low, high);
        (n_inside == 0 || n_inside == n_all).then_some(n_inside > 0)
    }

    /// Whether some point in a cell's box is on the other side than all corners of the cell, and the cell is large enough to be
    /// cut for it.
    pub fn is_missed(&self, primitive: u32, cell: &Box3, longest: f64, is_inside: bool) -> bool {
        let Some(before) = self.before_of(primitive).filter(|_| longest > self.enough) else { return false };
        let low: [f64; 3] = std::array::from_fn(|k| greater(self.steps_to(cell.min[k], k).ceil(), 0.0));
        let high: [f64; 3] = std::array::from_fn(|k| {
            let last = (self.n_points[k] - 1) as f64;
            lesser(self.steps_to(cell.max[k], k).floor(), last)
        });
        if (0..3).any(|k| low[k] > high[k]) {
            return false;
        }
        let SampleCount { n_inside, n_all } =
            self.count(before, low.map(|x| x as usize), high.map(|x| x as usize));
        n_inside != if is_inside { n_all } else { 0 }
    }

    fn before_of(&self, primitive: u32) -> Option<&[u32]> {
        self.before.get(primitive as usize)?.as_deref()
    }

    fn steps_to(&self, x: f64, k: usize) -> f64 {
        (x - self.origin[k]) / self.steps[k]
    }

    /// Counts the points from `low` to `high`, both included.
    fn count(&self, before: &[u32], low: [usize; 3], high: [usize; 3]) -> SampleCount {
        let (from, to) = (low, high.map(|x| x + 1));
        let [nx, ny, _] = self.n_points.map(|n| n + 1);
        let up_to = |x: usize, y: usize, z: usize| before[x + nx * (y + ny * z)] as usize;
        let in_columns = |z: usize| {
            // Sums before differences, since counts are unsigned.
            up_to(to[0], to[1], z) + up_to(from[0], from[1], z)
                - up_to(from[0], to[1], z)
                - up_to(to[0], from[1], z)
        };
        let n_all = (0..3).map(|k| to[k] - from[k]).product();
        SampleCount { n_inside: in_columns(to[2]) - in_columns(from[2]), n_all }
    }
}

/// A summed-volume table: for each corner of a lattice with one more point along each axis, the number of inside points
/// with smaller indices along all axes.
fn count_before([nx, ny, nz]: [usize; 3], is_inside: impl Fn(usize) -> bool) -> Vec<u32> {
    let (mx, my) = (nx + 1, ny + 1);
    let mut before = vec![0; mx * my * (nz + 1)];
    for z in 0..nz {
        for y in 0..ny {
            let mut row = 0;
            for x in 0..nx {
                row += u32::from(is_inside(x + nx * (y + ny * z)));
                let at = |y: usize, z: usize| x + 1 + mx * (y + my * z);
                before[at(y + 1, z + 1)] =
                    row + before[at(y, z + 1)] + before[at(y + 1, z)] - before[at(y, z)];
            }
        }
    }
    before
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_of_boxes_are_those_of_their_points() {
        let n = [5, 4, 6];
        let is_inside = |i: usize| (i * i + i / 7).is_multiple_of(3);
        let signs =
            |before| SampledSigns { origin: [0.0; 3], steps: [1.0; 3], n_points: n, enough: 0.5, before };
        let lattice = signs(vec![Some(count_before(n, is_inside)), None]);
        let place = |i: usize| [i % n[0], i / n[0] % n[1], i / (n[0] * n[1])];
        let inside_of = |low: usize, high: usize| -> Vec<bool> {
            let is_there = |i: &usize| place(*i).iter().all(|x| (low..=high).contains(x));
            (0..n.iter().product()).filter(is_there).map(is_inside).collect()
        };
        for low in 0..4_usize {
            for high in low..4 {
                let around = inside_of(low.saturating_sub(1), high + 1);
                let cell = Box3 { min: [low as f64; 3], max: [high as f64; 3] };
                let expected = around.iter().all(|sign| *sign == around[0]).then_some(around[0]);
                assert_eq!(lattice.is_inside(0, &cell), expected, "{low} to {high}");
                assert_eq!(lattice.is_inside(1, &cell), None);
                let within = inside_of(low, high);
                assert_eq!(lattice.is_missed(0, &cell, 1.0, true), within.contains(&false));
                assert_eq!(lattice.is_missed(0, &cell, 1.0, false), within.contains(&true));
                assert!(!lattice.is_missed(0, &cell, 0.5, true) && !lattice.is_missed(1, &cell, 1.0, true));
            }
        }
        let between = Box3 { min: [0.25; 3], max: [0.75; 3] };
        assert!(!lattice.is_missed(0, &between, 1.0, true) && !lattice.is_missed(0, &between, 1.0, false));
        let all = signs(vec![Some(count_before(n, |_| true))]);
        let beside = Box3 { min: [-9.0; 3], max: [-8.0; 3] };
        assert_eq!(all.is_inside(0, &beside), Some(true));
    }
}
