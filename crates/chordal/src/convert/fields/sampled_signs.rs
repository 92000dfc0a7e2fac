//! `SampledSigns`: which points are inside functions that are known only at points.
//!
//! Without ranges, nothing but samples tells a large cell from one that the boundary passes. Instead of cutting all of space
//! into small cells, functions are sampled once on a lattice as dense as the corners of such cells, and a cell stays large
//! where all samples in it and around it are on one side.
use super::cells::ZeroSide;
use super::grid::FieldGridError;
use super::tetrahedra::{IntegerBox, TOP, Tetrahedra};
use crate::implicit::PrimitiveEvaluator;
use crate::math::Box3;

/// Corners of cells with an edge of 1 are as dense as a lattice with so many steps in it. Counted: 92,287 corners beside
/// 91,125 points in a cube with cells of a 25th of it.
const STEPS: f64 = 1.74;

/// On which side of some primitives the points of a lattice over the whole cube are.
#[derive(Debug, Default)]
pub(super) struct SampledSigns {
    /// Steps along each axis.
    n_steps: usize,
    /// By primitive, if it is sampled: the number of points inside that come before each point along all axes.
    before: Vec<Option<Vec<u32>>>,
}

impl SampledSigns {
    /// Samples all primitives with leaves whose range over the cube has no end; `zero` is the side of 0 by primitive.
    ///
    /// # Errors
    /// The error of a leaf.
    pub fn new(
        evaluator: &mut PrimitiveEvaluator,
        has_leaves: &[bool],
        zero: &[ZeroSide],
        cells: &Tetrahedra,
        coarsest: f64,
    ) -> Result<Self, FieldGridError> {
        let [side, ..] = cells.sides_of([[0; 3], [TOP; 3]]);
        let n_steps = (STEPS * side / coarsest).ceil();
        if cells.stretch() != [1.0; 3] || n_steps < 1.0 || !has_leaves.contains(&true) {
            return Ok(Self::default());
        }
        let n_steps = n_steps as usize;
        let place = |at: usize| (at as i64 * TOP) / n_steps as i64;
        let whole = Box3 { min: cells.position_of([0; 3]), max: cells.position_of([TOP; 3]) };
        let mut before = vec![None; has_leaves.len()];
        for (p, _) in has_leaves.iter().enumerate().filter(|(_, has_leaves)| **has_leaves) {
            let range = evaluator.dual_ranges(&[(p as u32, whole)])?[0].value;
            if range.iter().all(|end| end.is_finite()) {
                continue;
            }
            let n = n_steps + 1;
            let question = |i: usize| {
                let at = [i % n, i / n % n, i / (n * n)].map(place);
                (p as u32, cells.position_of(at))
            };
            let questions: Vec<(u32, [f64; 3])> = (0..n * n * n).map(question).collect();
            let values = evaluator.values(&questions)?;
            before[p] = Some(count_before(n, |i| zero[p].is_inside(values[i])));
        }
        Ok(Self { n_steps, before })
    }

    /// Whether all points in the box and a step around it are inside the primitive, or none of them; `None` where they differ
    /// or are not known.
    pub fn is_inside(&self, primitive: u32, [low, high]: IntegerBox) -> Option<bool> {
        let before = self.before.get(primitive as usize)?.as_ref()?;
        let n_steps = self.n_steps as i64;
        let from = low.map(|x| ((x * n_steps).div_euclid(TOP) - 1).max(0) as usize);
        let to = high.map(|x| ((x * n_steps + TOP - 1).div_euclid(TOP) + 1).min(n_steps) as usize + 1);
        let n = self.n_steps + 2;
        let up_to = |x: usize, y: usize, z: usize| u64::from(before[x + n * (y + n * z)]);
        let in_columns = |z: usize| {
            up_to(to[0], to[1], z) + up_to(from[0], from[1], z)
                - up_to(from[0], to[1], z)
                - up_to(to[0], from[1], z)
        };
        let n_inside = in_columns(to[2]) - in_columns(from[2]);
        let n_points: usize = (0..3).map(|k| to[k] - from[k]).product();
        match n_inside {
            0 => Some(false),
            all if all == n_points as u64 => Some(true),
            _ => None,
        }
    }
}

/// For each corner of a lattice of `n + 1` points along each axis: how many points of one of `n` are inside and before it
/// along all axes.
fn count_before(n: usize, is_inside: impl Fn(usize) -> bool) -> Vec<u32> {
    let m = n + 1;
    let mut before = vec![0; m * m * m];
    for z in 0..n {
        for y in 0..n {
            let mut row = 0;
            for x in 0..n {
                row += u32::from(is_inside(x + n * (y + n * z)));
                let at = |y: usize, z: usize| x + 1 + m * (y + m * z);
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
        let n = 5;
        let is_inside = |i: usize| (i * i + i / 7).is_multiple_of(3);
        let lattice = SampledSigns { n_steps: n - 1, before: vec![Some(count_before(n, is_inside)), None] };
        let step = TOP / (n as i64 - 1);
        for low in 0..n {
            for high in low..n {
                let whole = [[low as i64 * step; 3], [high as i64 * step; 3]];
                let (from, to) = (low.saturating_sub(1), (high + 1).min(n - 1));
                let signs: Vec<bool> = (0..n * n * n)
                    .filter(|i| [i % n, i / n % n, i / (n * n)].iter().all(|x| (from..=to).contains(x)))
                    .map(is_inside)
                    .collect();
                let expected = signs.iter().all(|sign| *sign == signs[0]).then_some(signs[0]);
                assert_eq!(lattice.is_inside(0, whole), expected, "{low} to {high}");
                assert_eq!(lattice.is_inside(1, whole), None);
            }
        }
        let all = SampledSigns { n_steps: n - 1, before: vec![Some(count_before(n, |_| true))] };
        assert_eq!(all.is_inside(0, [[1; 3], [TOP - 1; 3]]), Some(true));
    }
}
