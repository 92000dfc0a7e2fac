//! `SampledSigns`: which points are inside functions that are known only at points.
//!
//! Without ranges, nothing but samples tells a large cell from one that the boundary passes. Instead of cutting all of space
//! into small cells, functions are sampled once on a lattice as dense as the corners of such cells, and a cell stays large
//! where all samples in it and around it are on one side.
use super::cells::ZeroSide;
use super::grid::FieldGridError;
use crate::implicit::PrimitiveEvaluator;
use crate::math::{Box3, greater, lesser};

/// Corners of cells with an edge of 1 are as dense as a lattice with so many steps in it. Counted: 92,287 corners beside
/// 91,125 points in a cube with cells of a 25th of it.
const STEPS: f64 = 1.74;
/// The fewest steps along each side of the bounds. Chosen: features of a tenth of a short side are found, too.
const FEWEST: f64 = 12.0;
/// Cells whose corners miss a sample are cut down to so many of the shortest steps,
const IN_STEPS: f64 = 2.0;
/// but not below this fraction of the coarsest. Chosen: 200,000 cells in a plate of a hundredth of its length.
const NOT_BELOW: f64 = 0.25;

/// On which side of some primitives the points of a lattice over the bounds are.
#[derive(Debug, Default)]
pub(super) struct SampledSigns {
    origin: [f64; 3],
    steps: [f64; 3],
    /// Points along each axis.
    n_points: [usize; 3],
    /// Cells with a longest edge of at most this are not cut for a sample that their corners miss.
    enough: f64,
    /// By primitive, if it is sampled: the number of points inside that come before each point along all axes.
    before: Vec<Option<Vec<u32>>>,
}

/// Samples of a primitive in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct SampleCount {
    n_inside: usize,
    n_all: usize,
}

impl SampledSigns {
    /// Samples all primitives with leaves whose range over the bounds has no end; `zero` is the side of 0 by primitive.
    ///
    /// # Errors
    /// The error of a leaf.
    pub fn new(
        evaluator: &mut PrimitiveEvaluator,
        has_leaves: &[bool],
        zero: &[ZeroSide],
        bounds: Box3,
        coarsest: f64,
    ) -> Result<Self, FieldGridError> {
        let sides: [f64; 3] = std::array::from_fn(|k| bounds.max[k] - bounds.min[k]);
        let n_steps = sides.map(|side| greater((STEPS * side / coarsest).ceil(), FEWEST));
        let steps: [f64; 3] = std::array::from_fn(|k| sides[k] / n_steps[k]);
        // Where cells may be as large as the bounds, nothing is sampled; flat bounds have no inside.
        if coarsest >= sides.iter().fold(0.0, |a, b| greater(*b, a)) || !steps.iter().all(|step| *step > 0.0)
        {
            return Ok(Self::default());
        }
        let n_points = n_steps.map(|n| n as usize + 1);
        let shortest = steps.iter().fold(f64::INFINITY, |a, b| lesser(*b, a));
        let mut all = Self {
            origin: bounds.min,
            steps,
            n_points,
            enough: greater(IN_STEPS * shortest, NOT_BELOW * coarsest),
            before: vec![None; has_leaves.len()],
        };
        let [nx, ny, nz] = n_points;
        for (p, _) in has_leaves.iter().enumerate().filter(|(_, has_leaves)| **has_leaves) {
            let range = evaluator.dual_ranges(&[(p as u32, bounds)])?[0].value;
            if range.iter().all(|end| end.is_finite()) {
                continue;
            }
            let question = |i: usize| {
                let at = [i % nx, i / nx % ny, i / (nx * ny)];
                (p as u32, std::array::from_fn(|k| all.origin[k] + at[k] as f64 * steps[k]))
            };
            let questions: Vec<(u32, [f64; 3])> = (0..nx * ny * nz).map(question).collect();
            let values = evaluator.values(&questions)?;
            all.before[p] = Some(count_before(n_points, |i| zero[p].is_inside(values[i])));
        }
        Ok(all)
    }

    /// Whether all points in the box and a step around it are inside the primitive, or none of them; `None` where they differ
    /// or are not known.
    pub fn is_inside(&self, primitive: u32, cell: &Box3) -> Option<bool> {
        let before = self.before_of(primitive)?;
        let from = |k: usize| self.steps_to(cell.min[k], k).floor() - 1.0;
        let to = |k: usize| self.steps_to(cell.max[k], k).ceil() + 1.0;
        // Beside the bounds the points at their border count.
        let last = |k: usize| (self.n_points[k] - 1) as f64;
        let low = std::array::from_fn(|k| from(k).clamp(0.0, last(k)) as usize);
        let high = std::array::from_fn(|k| to(k).clamp(0.0, last(k)) as usize);
        let SampleCount { n_inside, n_all } = self.count(before, low, high);
        (n_inside == 0 || n_inside == n_all).then_some(n_inside > 0)
    }

    /// Whether some point in the box is on the other side than all corners of a cell in it, which is large enough to be cut
    /// for that.
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

    /// The points from one to another, both included.
    fn count(&self, before: &[u32], low: [usize; 3], high: [usize; 3]) -> SampleCount {
        let (from, to) = (low, high.map(|x| x + 1));
        let [nx, ny, _] = self.n_points.map(|n| n + 1);
        let up_to = |x: usize, y: usize, z: usize| before[x + nx * (y + ny * z)] as usize;
        let in_columns = |z: usize| {
            up_to(to[0], to[1], z) + up_to(from[0], from[1], z)
                - up_to(from[0], to[1], z)
                - up_to(to[0], from[1], z)
        };
        let n_all = (0..3).map(|k| to[k] - from[k]).product();
        SampleCount { n_inside: in_columns(to[2]) - in_columns(from[2]), n_all }
    }
}

/// For each corner of a lattice of one point more along each axis: how many points are inside and before it along all axes.
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
        let of =
            |before| SampledSigns { origin: [0.0; 3], steps: [1.0; 3], n_points: n, enough: 0.5, before };
        let lattice = of(vec![Some(count_before(n, is_inside)), None]);
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
        let all = of(vec![Some(count_before(n, |_| true))]);
        let beside = Box3 { min: [-9.0; 3], max: [-8.0; 3] };
        assert_eq!(all.is_inside(0, &beside), Some(true));
    }
}
