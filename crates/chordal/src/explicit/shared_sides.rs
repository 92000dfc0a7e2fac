//! Finds the sides of patches that are the same curve.
use super::{Bezier, Patch, PatchSide};
use std::cmp::Ordering;

/// A side of a sheet that equals or contains a shared curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PatchEdgeUse {
    pub(crate) sheet: u32,
    pub(crate) side: PatchSide,
    /// Whether the side runs against the curve.
    pub(crate) reversed: bool,
}

/// For each curve, the sides that equal it: their four control points are equal bit for bit, forwards or
/// backwards. Sides that are single points are left out. In the order of the first use of each curve.
///
/// By sorting: O(n log n) for n patches.
pub(crate) fn shared_sides(patches: &[Patch]) -> Vec<Vec<PatchEdgeUse>> {
    let mut sides: Vec<(Bezier<3>, PatchEdgeUse)> = Vec::with_capacity(4 * patches.len());
    for (patch, shape) in patches.iter().enumerate() {
        for side in PatchSide::ALL {
            let curve = shape.side(side);
            if curve.is_point() {
                continue;
            }
            // The smaller of the two directions stands for both.
            let back = curve.reversed();
            let reversed = compare(&back, &curve) == Ordering::Less;
            let used = PatchEdgeUse { sheet: patch as u32, side, reversed };
            sides.push((if reversed { back } else { curve }, used));
        }
    }
    sides.sort_by(|a, b| compare(&a.0, &b.0).then((a.1.sheet, a.1.side).cmp(&(b.1.sheet, b.1.side))));
    let runs = sides.chunk_by(|a, b| compare(&a.0, &b.0) == Ordering::Equal);
    let mut edges: Vec<Vec<PatchEdgeUse>> = runs.map(|run| run.iter().map(|f| f.1).collect()).collect();
    // In the order of the input, so that vertices are numbered in file order.
    edges.sort_by_key(|uses| (uses[0].sheet, uses[0].side));
    edges
}

fn compare(a: &Bezier<3>, b: &Bezier<3>) -> Ordering {
    let (a, b) = (a.control.as_flattened(), b.control.as_flattened());
    a.iter().zip(b).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
}
