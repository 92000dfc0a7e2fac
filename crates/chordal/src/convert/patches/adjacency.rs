//! `PatchAdjacency`: which sides of patches are one curve, and which corners are therefore one vertex.
//!
//! Two sides are the same curve if their four control points are equal, forwards or backwards. Corners are
//! joined only along shared curves (and along sides that are one point): patches that merely touch in a point
//! stay separate, so that no vertex becomes non-manifold.
use crate::explicit::{DisjointSets, Patch, PatchEdgeUse, PatchSide, shared_sides};

/// One boundary curve, in one of its directions.
pub(crate) struct PatchEdge {
    /// Corner vertices at its start and end.
    pub(crate) ends: [u32; 2],
    /// The patch sides that are this curve.
    pub(crate) uses: Vec<PatchEdgeUse>,
    /// The fewest segments that keep its vertices apart from those of other curves.
    pub(crate) min_segments: u32,
}

/// The boundary along one side of a sheet.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SideBoundary {
    /// All control points are equal: the side is its corner vertex.
    Point,
    /// A shared edge.
    Edge { edge: u32, reversed: bool },
    /// Two edges, each over half of the side, by rising parameter; no tile extends across its middle.
    Halves([(u32, bool); 2]),
}

/// How the two boundary curves at a corner of a patch meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PatchCorner {
    /// The curves meet nowhere else.
    Plain,
    /// The same two curves also meet at the corner of another patch: a chord across the corner would be an edge of
    /// both patches, so the corner must not be cut off.
    Whole,
    /// The curves are one, folded at the corner: the vertex next to the corner is the same on both sides.
    Folded,
}

/// The identified sides and corners of all patches.
pub(crate) struct PatchAdjacency {
    pub(crate) edges: Vec<PatchEdge>,
    /// By patch and side.
    pub(crate) sides: Vec<[SideBoundary; 4]>,
    /// By patch and corner (0,0), (1,0), (1,1), (0,1): the corner vertex.
    pub(crate) corners: Vec<[u32; 4]>,
    /// By patch and corner: how the two curves meet there.
    pub(crate) corner_kinds: Vec<[PatchCorner; 4]>,
    /// The positions of the corner vertices.
    pub(crate) corner_positions: Vec<[f64; 3]>,
}

impl PatchAdjacency {
    /// Finds shared curves by sorting: O(n log n) for n patches.
    pub(crate) fn new(patches: &[Patch]) -> Self {
        let mut edges: Vec<PatchEdge> = shared_sides(patches)
            .into_iter()
            .map(|uses| PatchEdge { ends: [0; 2], uses, min_segments: 1 })
            .collect();
        let mut seams = vec![[SideBoundary::Point; 4]; patches.len()];
        let mut classes = DisjointSets::new(4 * patches.len());
        for (index, edge) in edges.iter().enumerate() {
            let first = use_ends(edge.uses[0]);
            for &used in &edge.uses {
                seams[used.sheet as usize][used.side as usize] =
                    SideBoundary::Edge { edge: index as u32, reversed: used.reversed };
                let ends = use_ends(used);
                classes.union(first[0], ends[0]);
                classes.union(first[1], ends[1]);
            }
        }
        for (patch, seam) in seams.iter().enumerate() {
            for side in PatchSide::ALL {
                // Both corners of a side without length are one.
                if matches!(seam[side as usize], SideBoundary::Point) {
                    let [a, b] = side_corners(patch as u32, side);
                    classes.union(a, b);
                }
            }
        }
        let (number, count) = classes.labels();
        let mut corner_positions = vec![[0.0; 3]; count];
        let corners: Vec<[u32; 4]> =
            (0..patches.len()).map(|p| std::array::from_fn(|k| number[4 * p + k])).collect();
        // Corners of one class are equal: they are joined along curves with equal control points.
        for (patch, ids) in patches.iter().zip(&corners) {
            for (side, id) in PatchSide::ALL.into_iter().zip(ids) {
                corner_positions[*id as usize] = patch.side(side).control[0];
            }
        }
        for edge in &mut edges {
            edge.ends = use_ends(edge.uses[0]).map(|corner| number[corner as usize]);
        }
        let kinds = classify_corners(&seams);
        let mut adjacency = Self { edges, sides: seams, corners, corner_kinds: kinds, corner_positions };
        adjacency.set_least_segments();
        adjacency
    }

    /// Sets the fewest segments of each edge. A curve that returns to its start needs three segments to be a
    /// loop; two curves between the same two vertices need two each, or their chords would be one.
    pub(crate) fn set_least_segments(&mut self) {
        let pair = |[a, b]: [u32; 2]| if a < b { [a, b] } else { [b, a] };
        let mut order: Vec<([u32; 2], usize)> = self.edges.iter().map(|e| pair(e.ends)).zip(0..).collect();
        order.sort_unstable();
        for run in order.chunk_by(|a, b| a.0 == b.0) {
            for &([start, end], i) in run {
                self.edges[i].min_segments = if start == end { 3 } else { 1 + u32::from(run.len() > 1) };
            }
        }
    }
}

/// Classifies every corner of every patch by how its curves meet.
pub(crate) fn classify_corners(seams: &[[SideBoundary; 4]]) -> Vec<[PatchCorner; 4]> {
    // The number of a curve's end. Sides run counter-clockwise, so each starts where the one before it ends.
    let end = |seam: SideBoundary, side: PatchSide, starts: bool| match seam {
        // Even at the start of the curve, odd at its end, where a reversed side starts.
        SideBoundary::Edge { edge, reversed } => Some(2 * edge + u32::from(starts == reversed)),
        SideBoundary::Halves(halves) => {
            // In the order of the parameter; top and left run against it.
            let against = !matches!(side, PatchSide::Bottom | PatchSide::Right);
            let (edge, reversed) = halves[usize::from(starts == against)];
            Some(2 * edge + u32::from(starts == reversed))
        }
        SideBoundary::Point => None,
    };
    let mut curve_ends: Vec<([u32; 2], usize)> = Vec::new();
    for (patch, sides) in seams.iter().enumerate() {
        for corner in 0..4 {
            let before = (corner + 3) % 4;
            let (first, last) = (
                end(sides[corner], PatchSide::ALL[corner], true),
                end(sides[before], PatchSide::ALL[before], false),
            );
            if let (Some(a), Some(b)) = (first, last) {
                curve_ends.push((if a < b { [a, b] } else { [b, a] }, 4 * patch + corner));
            }
        }
    }
    curve_ends.sort_unstable();
    let mut kinds = vec![[PatchCorner::Plain; 4]; seams.len()];
    for run in curve_ends.chunk_by(|a, b| a.0 == b.0) {
        let [a, b] = run[0].0;
        if run.len() > 1 || a == b {
            let kind = if a == b { PatchCorner::Folded } else { PatchCorner::Whole };
            run.iter().for_each(|(_, corner)| kinds[corner / 4][corner % 4] = kind);
        }
    }
    kinds
}

/// The flat corner indices at the start and end of a side.
pub(crate) fn side_corners(sheet: u32, side: PatchSide) -> [u32; 2] {
    let start = side as u32;
    [4 * sheet + start, 4 * sheet + (start + 1) % 4]
}

/// The flat corner indices at the start and end of the curve that a side uses.
fn use_ends(used: PatchEdgeUse) -> [u32; 2] {
    let [a, b] = side_corners(used.sheet, used.side);
    if used.reversed { [b, a] } else { [a, b] }
}
