//! The trees of primitives that are still undecided in regions of space, for many boxes: a loose octree over
//! the domain.
//!
//! A region is a cell extended by half of its size, so a box that is smaller than a cell lies in the region
//! of the cell that holds its centre. A region is created when enough boxes need it; each stores the tree
//! that its primitives' signs leave open.
use super::face_side_cache::FaceSideCache;
use super::local_trees::{LiteralSides, LocalTrees};
use crate::implicit::{LeafError, Membership, PrimitiveEvaluator};
use crate::math::Box3;

#[derive(Clone, Debug)]
struct SignRegion {
    cell: Box3,
    level: u32,
    /// The index of a tree, or the side on which all of the region is.
    tree: Result<u32, Membership>,
    children: [Option<u32>; 8],
}

/// The undecided trees by region, and the cached sides of faces.
#[derive(Clone, Debug)]
pub(super) struct SignRegions {
    regions: Vec<SignRegion>,
    pub trees: LocalTrees,
    pub face_sides: FaceSideCache,
    /// The memory limit of regions and trees.
    most_bytes: u64,
}

/// A region with at most this many primitives is not divided.
const FEW: usize = 3;
/// The number of boxes that pays for a child of a region. Chosen: creating it takes as many ranges as a box
/// without it, and its boxes need fewer.
const WORTH: usize = 6;
/// The share of the job's memory for regions and their trees; a box without a region for itself uses a larger
/// one.
const MEMORY_SHARE: u64 = 16;
/// The most halvings of the domain: defined, cells of a 2000th.
const DEEPEST: u32 = 11;

impl SignRegions {
    pub fn new(evaluator: &PrimitiveEvaluator, domain: &Box3, memory_limit: u64) -> Self {
        let root = SignRegion { cell: *domain, level: 0, tree: Ok(0), children: [None; 8] };
        let trees = LocalTrees::new(evaluator.csg());
        let face_sides = FaceSideCache::new(memory_limit);
        Self { regions: vec![root], trees, face_sides, most_bytes: memory_limit / MEMORY_SHARE }
    }

    /// For each box the tree of the smallest region that holds it.
    pub fn trees_of(
        &mut self,
        evaluator: &mut PrimitiveEvaluator,
        boxes: &[Box3],
    ) -> Result<Vec<Result<u32, Membership>>, LeafError> {
        let mut trees = vec![Ok(0); boxes.len()];
        let mut open = vec![(0_u32, (0..boxes.len() as u32).collect::<Vec<u32>>())];
        while !open.is_empty() {
            let mut below: Vec<(u32, usize, Vec<u32>)> = Vec::new();
            for (number, rows) in open {
                let region = &self.regions[number as usize];
                let tree = region.tree;
                // A box outside the region of the root is not in the region of any child.
                rows.iter().for_each(|row| trees[*row as usize] = tree);
                let is_small = match tree {
                    Ok(tree) => self.trees.get(tree).primitives.len() <= FEW,
                    Err(_) => true,
                };
                if is_small || region.level == DEEPEST {
                    continue;
                }
                let mut parts: [Vec<u32>; 8] = Default::default();
                for row in rows {
                    if let Some(octant) = octant(&region.cell, &boxes[row as usize]) {
                        parts[octant].push(row);
                    }
                }
                // A child that exists costs nothing; a new one must pay.
                let is_worth = |octant: usize, rows: &Vec<u32>| {
                    !rows.is_empty() && (region.children[octant].is_some() || rows.len() >= WORTH)
                };
                let parts = parts.into_iter().enumerate().filter(|(octant, rows)| is_worth(*octant, rows));
                below.extend(parts.map(|(octant, rows)| (number, octant, rows)));
            }
            self.add_children(evaluator, &below)?;
            let child = |number: u32, octant: usize| self.regions[number as usize].children[octant];
            open = below
                .into_iter()
                .filter_map(|(number, octant, rows)| Some((child(number, octant)?, rows)))
                .collect();
        }
        Ok(trees)
    }

    /// Creates the missing children.
    fn add_children(
        &mut self,
        evaluator: &mut PrimitiveEvaluator,
        wanted: &[(u32, usize, Vec<u32>)],
    ) -> Result<(), LeafError> {
        let bytes = size_of_val(&*self.regions) as u64 + self.trees.bytes();
        // Without the children boxes keep the tree of the parent, which is valid there too, only
        // longer.
        if bytes > self.most_bytes {
            return Ok(());
        }
        let mut questions = Vec::new();
        let mut new = Vec::new();
        for (parent, octant, _) in wanted {
            let region = &self.regions[*parent as usize];
            let (Ok(tree), None) = (region.tree, region.children[*octant]) else { continue };
            let cell = octant_cell(&region.cell, *octant);
            let bounds = around(&cell);
            questions.extend(self.trees.get(tree).primitives.iter().map(|p| (*p, bounds)));
            new.push((*parent, *octant, cell, tree));
        }
        let ranges = evaluator.ranges(&questions)?;
        let mut remaining = ranges.as_slice();
        for (parent, octant, cell, tree) in new {
            let (region_ranges, after) = remaining.split_at(self.trees.get(tree).primitives.len());
            remaining = after;
            let sides: Vec<LiteralSides> = region_ranges.iter().map(LiteralSides::from_range).collect();
            let tree = self.trees.restricted(tree, &sides);
            let level = self.regions[parent as usize].level + 1;
            self.regions[parent as usize].children[octant] = Some(self.regions.len() as u32);
            self.regions.push(SignRegion { cell, level, tree, children: [None; 8] });
        }
        Ok(())
    }
}

/// The octant whose region holds a box.
fn octant(cell: &Box3, bounds: &Box3) -> Option<usize> {
    let (centre, middle) = (bounds.centre(), cell.centre());
    let octant = (0..3).fold(0, |octant, k| octant | usize::from(centre[k] >= middle[k]) << k);
    let region = around(&octant_cell(cell, octant));
    let fits = (0..3).all(|k| region.min[k] <= bounds.min[k] && bounds.max[k] <= region.max[k]);
    fits.then_some(octant)
}

fn octant_cell(cell: &Box3, octant: usize) -> Box3 {
    let middle = cell.centre();
    let high = |k: usize| octant >> k & 1 == 1;
    Box3 {
        min: std::array::from_fn(|k| if high(k) { middle[k] } else { cell.min[k] }),
        max: std::array::from_fn(|k| if high(k) { cell.max[k] } else { middle[k] }),
    }
}

/// A cell extended by half of its size on every side.
fn around(cell: &Box3) -> Box3 {
    let half = |k: usize| 0.5 * (cell.max[k] - cell.min[k]);
    Box3 {
        min: std::array::from_fn(|k| cell.min[k] - half(k)),
        max: std::array::from_fn(|k| cell.max[k] + half(k)),
    }
}
