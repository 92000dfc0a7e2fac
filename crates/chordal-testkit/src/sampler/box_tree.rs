//! A bounding volume hierarchy, to find the nearest of many items.
use super::vector::{Point, norm};

/// An axis-aligned box: low and high corner.
pub type Bounds = [Point; 2];

/// A binary tree of boxes, built by splitting at the median along the longest side.
pub struct BoxTree {
    nodes: Vec<BoxNode>,
    order: Vec<u32>,
}

struct BoxNode {
    bounds: Bounds,
    /// The range of `order` below this node.
    range: [u32; 2],
    /// The index of the second child; the first child follows its parent. 0 for a leaf.
    second: u32,
}

/// The most items of a leaf. Chosen: larger leaves visit more items, smaller ones more nodes.
const LEAF: usize = 4;

/// The box around points.
pub fn around(points: impl IntoIterator<Item = Point>) -> Bounds {
    points.into_iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], p| {
        [std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k]))]
    })
}

/// The distance from a point to a box; 0 inside.
pub fn distance_to_bounds([low, high]: &Bounds, p: Point) -> f64 {
    norm(std::array::from_fn(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0.0)))
}

impl BoxTree {
    pub fn new(boxes: &[Bounds]) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..boxes.len() as u32).collect() };
        if !boxes.is_empty() {
            tree.build(boxes, 0, boxes.len());
        }
        tree
    }

    fn build(&mut self, boxes: &[Bounds], start: usize, end: usize) {
        let bounds = around(self.order[start..end].iter().flat_map(|&i| boxes[i as usize]));
        let node = self.nodes.len();
        self.nodes.push(BoxNode { bounds, range: [start as u32, end as u32], second: 0 });
        if end - start <= LEAF {
            return;
        }
        let side = |k: usize| bounds[1][k] - bounds[0][k];
        let axis = (0..3).max_by(|&a, &b| side(a).total_cmp(&side(b))).unwrap_or(0);
        let middle = |i: &u32| boxes[*i as usize][0][axis] + boxes[*i as usize][1][axis];
        let half = (end - start) / 2;
        self.order[start..end].select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
        self.build(boxes, start, start + half);
        self.nodes[node].second = self.nodes.len() as u32;
        self.build(boxes, start + half, end);
    }

    /// Visits, roughly from near to far, each item whose node is nearer to `p` than `best`. The visitor gets
    /// the item and the best distance so far, and returns the new best distance.
    pub fn visit(&self, p: Point, best: f64, mut visitor: impl FnMut(usize, f64) -> f64) {
        let mut best = best;
        let mut stack = vec![];
        if let Some(root) = self.nodes.first() {
            stack.push((distance_to_bounds(&root.bounds, p), 0));
        }
        while let Some((distance, node_idx)) = stack.pop() {
            if distance >= best {
                continue;
            }
            let node = &self.nodes[node_idx];
            if node.second == 0 {
                for &item in &self.order[node.range[0] as usize..node.range[1] as usize] {
                    best = visitor(item as usize, best);
                }
                continue;
            }
            let children = [node_idx + 1, node.second as usize]
                .map(|c| (distance_to_bounds(&self.nodes[c].bounds, p), c));
            let near_first = children[0].0 <= children[1].0;
            let [near, far] = if near_first { children } else { [children[1], children[0]] };
            stack.push(far);
            stack.push(near);
        }
    }
}
