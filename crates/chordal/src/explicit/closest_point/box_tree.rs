//! `BoxTree`: a tree of boxes, split at the median of their centres.
use crate::math::{Box3, greater, mul_down, sub_down};

/// Marks a child that is an item, not a node.
const ITEM: u32 = 1 << 31;

/// A binary tree over boxes.
#[derive(Clone, Debug)]
pub(crate) struct BoxTree {
    nodes: Vec<[(Box3, u32); 2]>,
    root: Option<(Box3, u32)>,
}

/// The content of a child.
pub(crate) enum BoxTreeNode {
    Inner([(Box3, u32); 2]),
    Leaf(usize),
}

impl BoxTree {
    pub fn over(items: &[Box3]) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(items.len()), root: None };
        let mut order: Vec<u32> = (0..items.len() as u32).collect();
        if !items.is_empty() {
            tree.root = Some(tree.build(items, &mut order));
        }
        tree
    }

    /// The box of all items, and the child to start from.
    pub fn root(&self) -> Option<(Box3, u32)> {
        self.root
    }

    pub fn node(&self, child: u32) -> BoxTreeNode {
        if child & ITEM != 0 {
            BoxTreeNode::Leaf((child & !ITEM) as usize)
        } else {
            BoxTreeNode::Inner(self.nodes[child as usize])
        }
    }

    fn build(&mut self, items: &[Box3], order: &mut [u32]) -> (Box3, u32) {
        let bounds = order.iter().fold(Box3::EMPTY, |bounds, k| bounds.union(items[*k as usize]));
        if let [only] = order {
            return (bounds, *only | ITEM);
        }
        let centres = order.iter().fold(Box3::EMPTY, |bounds, k| bounds.with(items[*k as usize].centre()));
        let wide: [f64; 3] = std::array::from_fn(|k| centres.max[k] - centres.min[k]);
        let axis = (1..3).fold(0, |widest, k| if wide[k] > wide[widest] { k } else { widest });
        let key = |k: &u32| items[*k as usize].centre()[axis];
        let middle = order.len() / 2;
        order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let (low, high) = order.split_at_mut(middle);
        let halves = [self.build(items, low), self.build(items, high)];
        self.nodes.push(halves);
        (bounds, self.nodes.len() as u32 - 1)
    }
}

/// The distance of a point outside a box along each axis, rounded down.
pub(super) fn gaps_down(p: [f64; 3], bounds: &Box3) -> [f64; 3] {
    std::array::from_fn(|k| {
        let (below, above) = (sub_down(bounds.min[k], p[k]), sub_down(p[k], bounds.max[k]));
        let gap = greater(below, above);
        greater(gap, 0.0)
    })
}

/// A lower bound for the distance of a point to a box: a sum of squares and a root, with at most four
/// roundings after the differences.
pub(super) fn distance_down(p: [f64; 3], bounds: &Box3) -> f64 {
    let square = gaps_down(p, bounds).iter().fold(0.0, |sum, gap| sum + gap * gap);
    let down = mul_down(square.sqrt(), 1.0 - 4.0 * f64::EPSILON);
    greater(down, 0.0)
}
