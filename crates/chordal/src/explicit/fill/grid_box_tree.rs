//! `GridBoxTree`: a balanced tree of boxes, for overlapping pairs and for queries by segment.
use super::snap_grid::{GridPoint, side};

/// Items per leaf: below this a linear scan is as fast.
const LEAF: usize = 8;

/// A box on the grid, borders included.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridBox {
    pub min: GridPoint,
    pub max: GridPoint,
}

impl GridBox {
    const EMPTY: Self = Self { min: [i64::MAX; 2], max: [i64::MIN; 2] };

    pub fn around(a: GridPoint, b: GridPoint) -> Self {
        Self { min: [a[0].min(b[0]), a[1].min(b[1])], max: [a[0].max(b[0]), a[1].max(b[1])] }
    }

    fn union(self, other: Self) -> Self {
        Self {
            min: [self.min[0].min(other.min[0]), self.min[1].min(other.min[1])],
            max: [self.max[0].max(other.max[0]), self.max[1].max(other.max[1])],
        }
    }

    pub fn meets(&self, other: &Self) -> bool {
        (0..2).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// Whether the box lies strictly on one side of the line through two points.
    fn is_beside(&self, [a, b]: [GridPoint; 2]) -> bool {
        let [l, h] = [self.min, self.max];
        let sides = [[l[0], l[1]], [h[0], l[1]], [l[0], h[1]], [h[0], h[1]]].map(|corner| side(a, b, corner));
        sides.iter().all(|side| side.is_gt()) || sides.iter().all(|side| side.is_lt())
    }
}

/// A balanced tree: node i has the children 2i + 1 and 2i + 2, each with half of its items.
#[derive(Debug)]
pub(super) struct GridBoxTree {
    boxes: Vec<GridBox>,
    items: Vec<u32>,
    nodes: Vec<GridBox>,
}

/// A node and its items.
#[derive(Clone, Copy, Debug)]
struct GridBoxNode {
    node: usize,
    low: usize,
    high: usize,
}

impl GridBoxTree {
    pub fn new(boxes: Vec<GridBox>) -> Self {
        let items: Vec<u32> = (0..boxes.len() as u32).collect();
        let leaves = items.len().div_ceil(LEAF).next_power_of_two();
        let mut tree = Self { boxes, items, nodes: vec![GridBox::EMPTY; 2 * leaves - 1] };
        tree.fill(tree.root());
        tree
    }

    fn root(&self) -> GridBoxNode {
        GridBoxNode { node: 0, low: 0, high: self.items.len() }
    }

    fn is_leaf(&self, part: GridBoxNode) -> bool {
        2 * part.node + 1 >= self.nodes.len()
    }

    fn halves(part: GridBoxNode) -> [GridBoxNode; 2] {
        let middle = part.low + (part.high - part.low) / 2;
        [
            GridBoxNode { node: 2 * part.node + 1, high: middle, ..part },
            GridBoxNode { node: 2 * part.node + 2, low: middle, ..part },
        ]
    }

    fn fill(&mut self, part: GridBoxNode) {
        let is_leaf = self.is_leaf(part);
        let boxes = &self.boxes;
        let items = &mut self.items[part.low..part.high];
        let bounds = items.iter().fold(GridBox::EMPTY, |bounds, item| bounds.union(boxes[*item as usize]));
        self.nodes[part.node] = bounds;
        if is_leaf {
            return;
        }
        if !items.is_empty() {
            let axis = usize::from(bounds.max[1] - bounds.min[1] > bounds.max[0] - bounds.min[0]);
            let key = |item: &u32| {
                let GridBox { min, max } = boxes[*item as usize];
                (min[axis] + max[axis], *item)
            };
            let middle = items.len() / 2;
            items.select_nth_unstable_by_key(middle, key);
        }
        Self::halves(part).into_iter().for_each(|half| self.fill(half));
    }

    /// Calls `each` with all pairs of items whose boxes meet; returning false stops the search.
    pub fn pairs(&self, mut each: impl FnMut(u32, u32) -> bool) {
        let mut open = vec![(self.root(), self.root())];
        while let Some((a, b)) = open.pop() {
            if !self.nodes[a.node].meets(&self.nodes[b.node]) {
                continue;
            }
            match (self.is_leaf(a), self.is_leaf(b)) {
                (false, _) if a.node == b.node => {
                    // A node against itself: each pair of halves once.
                    let [l, h] = Self::halves(a);
                    open.extend([(l, l), (l, h), (h, h)]);
                }
                // Of two different nodes the larger is halved.
                (false, _) if self.is_leaf(b) || a.high - a.low >= b.high - b.low => {
                    open.extend(Self::halves(a).map(|half| (half, b)));
                }
                (_, false) => open.extend(Self::halves(b).map(|half| (a, half))),
                _ => {
                    for (i, first) in self.items[a.low..a.high].iter().enumerate() {
                        let start = if a.node == b.node { a.low + i + 1 } else { b.low };
                        for second in &self.items[start..b.high] {
                            if self.boxes[*first as usize].meets(&self.boxes[*second as usize])
                                && !each(*first, *second)
                            {
                                return;
                            }
                        }
                    }
                }
            }
        }
    }

    /// Calls `each` with all items whose boxes meet that of a segment, except in nodes entirely beside its
    /// line.
    pub fn along(&self, segment: [GridPoint; 2], mut each: impl FnMut(u32)) {
        let around = GridBox::around(segment[0], segment[1]);
        let mut open = vec![self.root()];
        while let Some(part) = open.pop() {
            let node = &self.nodes[part.node];
            if part.low == part.high || !node.meets(&around) || node.is_beside(segment) {
                continue;
            }
            if self.is_leaf(part) {
                let near = |item: &&u32| self.boxes[**item as usize].meets(&around);
                self.items[part.low..part.high].iter().filter(near).for_each(|item| each(*item));
            } else {
                open.extend(Self::halves(part));
            }
        }
    }
}
