//! Samples in place of ranges, for functions without interval evaluation and for ranges that are too wide: gradients at the
//! corners of cells, and signs on a lattice.
use super::cells::{CellSizes, CellTest, PrunedTree, prune};
use super::grid::{CELLS_A_TASK, CellAction, CellBuffers, CellQuery, FieldGrid, FieldGridError, PendingCell};
use crate::budget::par_map;
use crate::implicit::{DualRange, Membership, PrimitiveEvaluator};
use crate::math::{Box3, Interval, greater, lesser};
use std::sync::Arc;

/// Up to this many cells of one level are cut by ranges of slopes; if there are more, slopes at their corners decide.
/// Measured: 51,000 on the cube with gyroid infill.
const MOST_BY_RANGES: usize = 1 << 17;

impl<'a> FieldGrid<'a> {
    /// If too many cells would be cut, ranges are far too wide: then slopes at the corners of a cell decide whether it
    /// is done. The proof has to find the features that they miss.
    pub(super) fn refine_by_samples(
        &mut self,
        evaluator: &mut PrimitiveEvaluator<'a>,
        judged: &mut [(PendingCell, CellAction)],
    ) -> Result<(), FieldGridError> {
        let cells: Vec<usize> = (0..judged.len()).filter(|cell| judged[*cell].1 == CellAction::Cut).collect();
        self.goes_by_samples |= cells.len() > MOST_BY_RANGES;
        if !self.goes_by_samples {
            return Ok(());
        }
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for row in &cells {
            let cell = &judged[*row].0;
            pairs.extend(
                cell.pruned.primitives.iter().flat_map(|p| cell.tetrahedron.corners.map(|v| (*p, v))),
            );
        }
        pairs.sort_unstable();
        pairs.dedup();
        let questions: Vec<(u32, [f64; 3])> =
            pairs.iter().map(|(p, v)| (*p, self.tetrahedra.position(*v))).collect();
        let slopes = evaluator.duals(&questions)?;
        let gradient =
            |p: u32, v: u32| slopes[pairs.binary_search(&(p, v)).expect("it was asked for")].gradient;
        let chunks: Vec<&[usize]> = cells.chunks(CELLS_A_TASK).collect();
        let view = &*self;
        let is_done = |cell: &usize| view.is_resolved_by_samples(&judged[*cell].0, gradient);
        let done =
            par_map(self.job, &chunks, |_, part| part.iter().map(is_done).collect::<Vec<bool>>()).concat();
        for (cell, _) in cells.iter().zip(done).filter(|(_, is_done)| *is_done) {
            judged[*cell].1 = CellAction::Done;
        }
        Ok(())
    }

    /// Whether a cell is done, assuming that slopes in it are as at its corners.
    fn is_resolved_by_samples(&self, cell: &PendingCell, gradient: impl Fn(u32, u32) -> [f64; 3]) -> bool {
        let (corners, pruned) = (cell.tetrahedron.corners, &cell.pruned);
        let range =
            |p: &u32| DualRange { gradient: hull(&corners.map(|v| gradient(*p, v))), ..DualRange::UNKNOWN };
        let ranges: Vec<DualRange> = pruned.primitives.iter().map(range).collect();
        let value = |p: &u32| corners.map(|v| self.values.get(v, *p).expect("it was asked for"));
        let values: Vec<[f64; 4]> = pruned.primitives.iter().map(value).collect();
        let test = CellTest {
            csg: self.csg,
            pruned,
            ranges: &ranges,
            values: &values,
            // `is_resolved` does not use it.
            noise: &vec![0.0; values.len()],
            idle: &[],
            sizes: CellSizes::new(&self.tetrahedra, corners, self.options.floor),
        };
        test.is_resolved()
    }

    /// For functions without a range of the gradient, takes the hull of the gradients at the corners. A function without
    /// a range of values either is ignored unless its sign changes among the corners.
    pub(super) fn gather_corner_gradients(
        &self,
        cell: &CellQuery,
        pruned: &PrunedTree,
        buffers: &mut CellBuffers,
    ) {
        let CellBuffers { ranges, values, idle, .. } = buffers;
        idle.clear();
        idle.resize(values.len(), false);
        for (k, p) in pruned.primitives.iter().enumerate() {
            if !self.has_leaves[*p as usize] || ranges[k].gradient.is_some() {
                continue;
            }
            let is_unknown = ranges[k].value == DualRange::UNKNOWN.value;
            if is_unknown && values[k].iter().all(|x| (*x < 0.0) == (values[k][0] < 0.0)) {
                idle[k] = true;
                continue;
            }
            let gradients =
                cell.tetrahedron.corners.map(|v| self.values.gradient(v, *p).unwrap_or([f64::NAN; 3]));
            ranges[k].gradient = hull(&gradients);
        }
    }

    /// Whether a sampled primitive is on one side at all corners of a cell, and on the other one at a sample in its box.
    pub(super) fn misses_samples(
        &self,
        pruned: &Arc<PrunedTree>,
        values: &[[f64; 4]],
        space: &Box3,
        longest: f64,
    ) -> bool {
        pruned.primitives.iter().zip(values).any(|(p, values)| {
            let zero = self.zero[*p as usize];
            let is_inside = zero.is_inside(values[0]);
            values.iter().all(|x| zero.is_inside(*x) == is_inside)
                && self.signs.is_missed(*p, space, longest, is_inside)
        })
    }

    /// Whether a cell is decided, assuming that sampled primitives have everywhere in it the side that they have at its
    /// corners and at the samples.
    pub(super) fn is_decided_by_signs(
        &self,
        pruned: &Arc<PrunedTree>,
        values: &[[f64; 4]],
        sides: &mut [Membership],
        space: &Box3,
    ) -> bool {
        for ((p, values), side) in pruned.primitives.iter().zip(values).zip(sides.iter_mut()) {
            if *side != Membership::Unknown {
                continue;
            }
            let zero = self.zero[*p as usize];
            if let Some(is_inside) = self.signs.is_inside(*p, space)
                && values.iter().all(|x| zero.is_inside(*x) == is_inside)
            {
                *side = if is_inside { Membership::Inside } else { Membership::Outside };
            }
        }
        prune(pruned, sides).is_none()
    }
}

/// The smallest box that contains all of the vectors.
fn hull(vectors: &[[f64; 3]]) -> Option<[Interval; 3]> {
    let mut ranges = [Interval::UNKNOWN; 3];
    for (k, range) in ranges.iter_mut().enumerate() {
        let (mut low, mut high) = (vectors[0][k], vectors[0][k]);
        for v in vectors {
            low = lesser(v[k], low);
            high = greater(v[k], high);
        }
        *range = Interval::new(low, high).ok()?;
    }
    Some(ranges)
}
