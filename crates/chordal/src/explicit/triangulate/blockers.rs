//! `Blockers`: a tree of the corners that can lie inside an ear, for queries by triangle.
use super::turn;
use crate::math::{greater, lesser};

/// Points per leaf: below this a linear scan is as fast.
const LEAF: usize = 8;
/// Marks a corner that blocks nothing.
const NONE: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct BlockerNode {
    min: [f64; 2],
    max: [f64; 2],
    alive: u32,
}

/// A balanced tree over the corners that were reflex or straight at the start. Its shape never changes;
/// corners are only removed.
#[derive(Clone, Debug, Default)]
pub(super) struct Blockers {
    items: Vec<u32>,
    nodes: Vec<BlockerNode>,
    /// For each corner of the polygon its leaf, or `NONE`.
    leaf_of: Vec<u32>,
    stack: Vec<(u32, u32, u32)>,
}

impl Blockers {
    /// Builds the tree over `items`, corners of `points`.
    pub(super) fn build(&mut self, points: &[[f64; 2]], items: impl Iterator<Item = u32>) {
        self.items.clear();
        self.items.extend(items);
        self.leaf_of.clear();
        self.leaf_of.resize(points.len(), NONE);
        // A complete binary tree in an array: the children of node i are 2i + 1 and 2i + 2.
        let leaves = self.items.len().div_ceil(LEAF).next_power_of_two();
        self.nodes.clear();
        self.nodes.resize(2 * leaves - 1, BlockerNode { min: [0.0; 2], max: [0.0; 2], alive: 0 });
        self.fill(points, 0, 0, self.items.len());
    }

    fn fill(&mut self, points: &[[f64; 2]], node: usize, low: usize, high: usize) {
        let is_leaf = self.is_leaf(node);
        let items = &mut self.items[low..high];
        let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for &item in items.iter() {
            let p = points[item as usize];
            for k in 0..2 {
                min[k] = lesser(p[k], min[k]);
                max[k] = greater(p[k], max[k]);
            }
        }
        self.nodes[node] = BlockerNode { min, max, alive: items.len() as u32 };
        if is_leaf {
            items.iter().for_each(|item| self.leaf_of[*item as usize] = node as u32);
            return;
        }
        let axis = usize::from(max[1] - min[1] > max[0] - min[0]);
        let half = items.len() / 2;
        if half < items.len() {
            let key = |item: &u32| points[*item as usize][axis];
            items.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        }
        self.fill(points, 2 * node + 1, low, low + half);
        self.fill(points, 2 * node + 2, low + half, high);
    }

    fn is_leaf(&self, node: usize) -> bool {
        2 * node + 1 >= self.nodes.len()
    }

    /// Removes a corner; does nothing when it is not in the tree.
    pub(super) fn remove(&mut self, corner: u32) {
        let leaf = std::mem::replace(&mut self.leaf_of[corner as usize], NONE);
        if leaf == NONE {
            return;
        }
        let mut node = leaf as usize;
        loop {
            self.nodes[node].alive -= 1;
            if node == 0 {
                return;
            }
            node = (node - 1) / 2;
        }
    }

    /// Whether `blocks` holds for any remaining corner that may lie in the closed triangle. `work` counts
    /// down with every step; at zero the answer is no.
    pub(super) fn any(
        &mut self,
        points: &[[f64; 2]],
        triangle: [[f64; 2]; 3],
        work: &mut u64,
        blocks: impl Fn(u32) -> bool,
    ) -> bool {
        self.stack.clear();
        self.stack.push((0, 0, self.items.len() as u32));
        let bounds = bounds(triangle);
        while let Some((node, low, high)) = self.stack.pop() {
            if *work == 0 {
                return false;
            }
            *work -= 1;
            let BlockerNode { min, max, alive } = self.nodes[node as usize];
            if alive == 0 || apart([min, max], bounds) || beside([min, max], triangle) {
                continue;
            }
            if !self.is_leaf(node as usize) {
                let half = low + (high - low) / 2;
                self.stack.push((2 * node + 1, low, half));
                self.stack.push((2 * node + 2, half, high));
                continue;
            }
            for &item in &self.items[low as usize..high as usize] {
                *work = work.saturating_sub(1);
                let p = points[item as usize];
                // A corner that was removed has no leaf.
                if self.leaf_of[item as usize] != NONE && !apart([p, p], bounds) && blocks(item) {
                    return true;
                }
            }
        }
        false
    }
}

fn bounds([a, b, c]: [[f64; 2]; 3]) -> [[f64; 2]; 2] {
    let low = |x: f64, y: f64| lesser(x, y);
    let high = |x: f64, y: f64| greater(x, y);
    [
        [low(a[0], low(b[0], c[0])), low(a[1], low(b[1], c[1]))],
        [high(a[0], high(b[0], c[0])), high(a[1], high(b[1], c[1]))],
    ]
}

fn apart([a_min, a_max]: [[f64; 2]; 2], [b_min, b_max]: [[f64; 2]; 2]) -> bool {
    (0..2).any(|k| a_max[k] < b_min[k] || b_max[k] < a_min[k])
}

/// Whether the box lies entirely to the right of one side of the counter-clockwise triangle.
fn beside([min, max]: [[f64; 2]; 2], triangle: [[f64; 2]; 3]) -> bool {
    (0..3).any(|k| {
        let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
        // The corner of the box farthest to the left of a → b.
        let corner = [if b[1] > a[1] { min[0] } else { max[0] }, if b[0] > a[0] { max[1] } else { min[1] }];
        turn(a, b, corner) < 0.0
    })
}
