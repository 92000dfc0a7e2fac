//! Cells that hold several levels of one function, such as both sides of a thin wall.
//!
//! If both sides of a wall can have the value, no direction of growth exists, and without further arguments
//! cells would have to be as small as the wall is thin. But between two levels of one function a wall has no
//! holes:
//!
//! **Lemma (walls).** Let P be a box that holds a cell, longer than it along an axis. Let the sign of F on P
//! depend on some primitives only, all of them different levels of one function up to sign and scale, each
//! with a derivative of one sign along the axis, all over P. Let each be negative on one lid of P across the
//! axis and positive on the other. Then the zero sets of the primitives cut P into parts, one more than there
//! are primitives, each connected, and F has one sign on each.
//!
//! *Proof.* On each line along the axis every primitive has one zero, by monotonicity and its signs on the
//! lids; it depends continuously on the line. The order of the zeros is the same on all lines, as levels of
//! one function do not meet. So each part is the set between two graphs over the base of P, which is
//! connected, and no primitive changes its sign there. ∎
//!
//! So a flow that ends in the cell ends in a part, and the mesh has to wind correctly around a point of each
//! part.
use super::cell_growth::WindingProbe;
use super::local_trees::LiteralSides;
use super::regions::SignRegions;
use super::slope::padded;
use crate::implicit::{LeafError, Membership, PrimitiveEvaluator};
use crate::math::Box3;

/// The length by which P extends beyond the cell at both ends, in sides of the cell: a sheet whose steepest
/// derivative is along the axis rises by no more than two sides across the cell.
const REACH: f64 = 2.25;
/// Bisections in the search for zeros on the middle line.
const HALVINGS: usize = 40;

/// A cell, and the axis along which its walls may be graphs.
pub(super) struct WallCell {
    pub cell: u32,
    pub axis: usize,
    pub bounds: Box3,
    /// The length of its sides.
    pub side: f64,
}

/// The box P of a cell.
struct WallPrism {
    cell: u32,
    axis: usize,
    bounds: Box3,
    /// The tree of P, and the sides of its primitives in P.
    tree: u32,
    sides: Vec<LiteralSides>,
    /// The primitives that change their sign, and whether they grow along the axis.
    levels: Vec<(u32, bool)>,
}

/// The cells to which the lemma applies, with the points of their parts.
pub(super) fn cells_with_walls(
    regions: &mut SignRegions,
    evaluator: &mut PrimitiveEvaluator,
    cells: &[WallCell],
) -> Result<Vec<(u32, Vec<WindingProbe>)>, LeafError> {
    let boxes: Vec<Box3> = cells.iter().map(long_box).collect();
    let trees = regions.trees_of(evaluator, &boxes)?;
    let mut prisms = Vec::new();
    for ((wall, bounds), tree) in cells.iter().zip(&boxes).zip(trees) {
        if let Ok(tree) = tree {
            let (sides, levels) = (Vec::new(), Vec::new());
            let (cell, axis) = (wall.cell, wall.axis);
            prisms.push(WallPrism { cell, axis, bounds: *bounds, tree, sides, levels });
        }
    }
    monotone(regions, evaluator, &mut prisms)?;
    crossed(evaluator, &mut prisms)?;
    points(regions, evaluator, &prisms)
}

fn long_box(wall: &WallCell) -> Box3 {
    let mut bounds = wall.bounds;
    let reach = REACH * wall.side;
    bounds.min[wall.axis] -= reach;
    bounds.max[wall.axis] += reach;
    padded(&bounds)
}

/// Keeps the prisms on which only levels of one function change sign, and are monotone along the axis.
fn monotone(
    regions: &SignRegions,
    evaluator: &mut PrimitiveEvaluator,
    prisms: &mut Vec<WallPrism>,
) -> Result<(), LeafError> {
    let list = |prism: &WallPrism| regions.trees.get(prism.tree).primitives.iter();
    let questions: Vec<(u32, Box3)> =
        prisms.iter().flat_map(|prism| list(prism).map(|p| (*p, prism.bounds))).collect();
    let slopes = evaluator.dual_ranges(&questions)?;
    let primitives = evaluator.csg().primitives();
    // Answers come in the order of the questions, of which a prism has as many as its tree has
    // primitives.
    let mut remaining = slopes.as_slice();
    prisms.retain_mut(|prism| {
        let local = regions.trees.get(prism.tree);
        let (prism_slopes, after) = remaining.split_at(local.primitives.len());
        remaining = after;
        prism.sides = prism_slopes.iter().map(|slope| LiteralSides::from_range(&slope.value)).collect();
        for ((p, slope), sides) in local.primitives.iter().zip(prism_slopes).zip(&prism.sides) {
            // A primitive that keeps its sign all over the prism is no level of the wall.
            if !sides.is_open() {
                continue;
            }
            let Some(gradient) = slope.gradient else { return false };
            let along = gradient[prism.axis];
            if along.lo() <= 0.0 && along.hi() >= 0.0 {
                return false;
            }
            prism.levels.push((*p, along.lo() > 0.0));
        }
        let primitive = |level: &(u32, bool)| &primitives[level.0 as usize];
        let Some((first, others)) = prism.levels.split_first() else { return false };
        !others.is_empty() && others.iter().all(|other| primitive(first).is_parallel_to(primitive(other)))
    });
    Ok(())
}

/// Keeps the prisms on whose lids all levels have the signs that the lemma requires.
fn crossed(evaluator: &mut PrimitiveEvaluator, prisms: &mut Vec<WallPrism>) -> Result<(), LeafError> {
    let lids = |prism: &WallPrism| {
        let (mut low, mut high) = (prism.bounds, prism.bounds);
        low.max[prism.axis] = low.min[prism.axis];
        high.min[prism.axis] = high.max[prism.axis];
        [low, high]
    };
    let questions: Vec<(u32, Box3)> = prisms
        .iter()
        .flat_map(|prism| prism.levels.iter().flat_map(|(p, _)| lids(prism).map(|lid| (*p, lid))))
        .collect();
    let ranges = evaluator.ranges(&questions)?;
    let mut remaining = ranges.as_slice();
    prisms.retain(|prism| {
        let (lid_ranges, after) = remaining.split_at(2 * prism.levels.len());
        remaining = after;
        prism.levels.iter().zip(lid_ranges.chunks_exact(2)).all(|((_, grows), lids)| {
            // Seen in the direction in which the primitive grows.
            let [below, above] = if *grows { [lids[0], lids[1]] } else { [lids[1], lids[0]] };
            below[1] < 0.0 && above[0] > 0.0
        })
    });
    Ok(())
}

/// For each prism a point in each of its parts, if these were found and their sides proved.
fn points(
    regions: &SignRegions,
    evaluator: &mut PrimitiveEvaluator,
    prisms: &[WallPrism],
) -> Result<Vec<(u32, Vec<WindingProbe>)>, LeafError> {
    let at = |prism: &WallPrism, along: f64| {
        let mut p = prism.bounds.centre();
        p[prism.axis] = along;
        p
    };
    let zeros = zeros(evaluator, prisms, &at)?;
    let mut remaining = zeros.as_slice();
    let mut points_of_prisms: Vec<Vec<[f64; 3]>> = Vec::new();
    for prism in prisms {
        let (prism_zeros, after) = remaining.split_at(prism.levels.len());
        remaining = after;
        // Zeros and lids in order along the axis: between each two of them is one part, and its
        // middle.
        let mut cuts = prism_zeros.to_vec();
        cuts.extend([prism.bounds.min[prism.axis], prism.bounds.max[prism.axis]]);
        cuts.sort_unstable_by(f64::total_cmp);
        points_of_prisms.push(cuts.windows(2).map(|pair| at(prism, 0.5 * pair[0] + 0.5 * pair[1])).collect());
    }
    let point = |p: [f64; 3]| Box3 { min: p, max: p };
    let questions: Vec<(u32, Box3)> = prisms
        .iter()
        .zip(&points_of_prisms)
        .flat_map(|(prism, points)| {
            points.iter().flat_map(|at| prism.levels.iter().map(|(p, _)| (*p, point(*at))))
        })
        .collect();
    let ranges = evaluator.ranges(&questions)?;
    let mut remaining = ranges.as_slice();
    let mut probes_of_cells = Vec::new();
    for (prism, points) in prisms.iter().zip(points_of_prisms) {
        let (prism_ranges, after) = remaining.split_at(prism.levels.len() * points.len());
        remaining = after;
        if let Some(probes) = parts(regions, prism, &points, prism_ranges) {
            probes_of_cells.push((prism.cell, probes));
        }
    }
    Ok(probes_of_cells)
}

/// The approximate zero of each level on the middle line.
fn zeros(
    evaluator: &mut PrimitiveEvaluator,
    prisms: &[WallPrism],
    at: &impl Fn(&WallPrism, f64) -> [f64; 3],
) -> Result<Vec<f64>, LeafError> {
    let levels: Vec<(&WallPrism, u32, bool)> = prisms
        .iter()
        .flat_map(|prism| prism.levels.iter().map(move |(p, grows)| (prism, *p, *grows)))
        .collect();
    let mut ends: Vec<[f64; 2]> = levels
        .iter()
        .map(|(prism, ..)| [prism.bounds.min[prism.axis], prism.bounds.max[prism.axis]])
        .collect();
    let middle = |[low, high]: &[f64; 2]| 0.5 * low + 0.5 * high;
    for _ in 0..HALVINGS {
        let questions: Vec<(u32, [f64; 3])> =
            levels.iter().zip(&ends).map(|((prism, p, _), ends)| (*p, at(prism, middle(ends)))).collect();
        let values = evaluator.values(&questions)?;
        for ((ends, value), (_, _, grows)) in ends.iter_mut().zip(values).zip(&levels) {
            let is_before = (value < 0.0) == *grows;
            ends[usize::from(!is_before)] = middle(ends);
        }
    }
    Ok(ends.iter().map(middle).collect())
}

/// The points with their sides, if they are in different parts.
fn parts(
    regions: &SignRegions,
    prism: &WallPrism,
    points: &[[f64; 3]],
    ranges: &[[f64; 2]],
) -> Option<Vec<WindingProbe>> {
    let local = regions.trees.get(prism.tree);
    let mut before: Option<Vec<LiteralSides>> = None;
    let mut probes = Vec::with_capacity(points.len());
    for (at, ranges) in points.iter().zip(ranges.chunks_exact(prism.levels.len())) {
        let mut sides = prism.sides.clone();
        for ((p, _), range) in prism.levels.iter().zip(ranges) {
            let of_level = LiteralSides::from_range(range);
            // A part contains no zero of a level.
            if of_level.is_open() || *range == [0.0; 2] {
                return None;
            }
            sides[local.index_of(*p)] = of_level;
        }
        let side = local.membership_without_cracks(&sides);
        // Two neighbouring points with the same sides are in one part, so another part has no
        // point.
        if side == Membership::Unknown || before.as_ref() == Some(&sides) {
            return None;
        }
        probes.push(WindingProbe { at: *at, side });
        before = Some(sides);
    }
    Some(probes)
}
