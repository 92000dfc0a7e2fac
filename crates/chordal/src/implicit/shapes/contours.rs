//! `Contours`: closed contours of straight edges in the plane, and the exact signed distance to them.
use crate::implicit::{Distance, Expr};
use crate::math::{Orientation, add_up, greater, orient2d};
use std::sync::Arc;

/// The fill rule of contours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ContourFill {
    /// Points with an odd winding number.
    EvenOdd,
    /// Points with a winding number other than 0.
    NonZero,
}

impl ContourFill {
    /// Whether a point with this winding number is inside.
    pub(super) fn holds(self, winding: i32) -> bool {
        match self {
            Self::EvenOdd => winding % 2 != 0,
            Self::NonZero => winding != 0,
        }
    }
}

/// A directed edge of a contour.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContourEdge {
    pub a: [f64; 2],
    pub b: [f64; 2],
    /// The contour, and the rows of the edges before and after this one in it.
    pub contour: u32,
    pub before: u32,
    pub after: u32,
    /// 1 if the outside is to the right of the edge's direction, −1 if it is to the left, 0 if unknown.
    pub outside: i8,
}

/// A box over a run of edges, or over two nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContourBvhNode {
    pub min: [f64; 2],
    pub max: [f64; 2],
    /// Range of positions in the order, if the node has no children.
    pub run: [u32; 2],
    /// The second child; the first follows its parent. 0 if there are none.
    pub second: u32,
}

/// Closed contours in the plane, with a tree over their edges. The value is the signed distance to the edges,
/// negative inside, in the plane of x and y; z has no effect.
///
/// Exact predicates decide the side of a point. The distance is rounded: its error is at most 64 units of
/// rounding of the largest coordinate, which intervals allow for.
///
/// Cost: O(log n) for a point.
#[derive(Clone, Debug)]
pub struct Contours {
    pub(super) edges: Vec<ContourEdge>,
    pub(super) nodes: Vec<ContourBvhNode>,
    pub(super) order: Vec<u32>,
    pub(super) largest: f64,
    pub(super) fill: ContourFill,
    pub(super) distance: Distance,
    pub(super) bounds: [[f64; 2]; 2],
}

impl Contours {
    /// The distance quality: exact for contours that do not meet.
    #[must_use]
    pub fn distance(&self) -> Distance {
        self.distance
    }

    /// The value at these two coordinates.
    #[must_use]
    pub fn expr(self, at: [Expr; 2]) -> Expr {
        Self::shared_expr(Arc::new(self), at)
    }

    pub(super) fn shared_expr(contours: Arc<Self>, [x, y]: [Expr; 2]) -> Expr {
        Expr::leaf(contours, [x, y, Expr::constant(0.0)])
    }

    /// Its contours, each with the inside to the left of its sides. None if they cross or touch, since the
    /// inside is then unknown.
    pub(crate) fn loops(&self) -> Option<Vec<Vec<[f64; 2]>>> {
        let mut is_done = vec![false; self.edges.len()];
        let mut loops = Vec::new();
        for first in 0..self.edges.len() {
            if is_done[first] {
                continue;
            }
            let outside = self.edges[first].outside;
            let (mut points, mut row) = (Vec::new(), first);
            while !is_done[row] {
                is_done[row] = true;
                let edge = &self.edges[row];
                if edge.outside == 0 || edge.outside != outside {
                    return None;
                }
                points.push(edge.a);
                row = edge.after as usize;
            }
            if outside < 0 {
                points.reverse();
            }
            loops.push(points);
        }
        Some(loops)
    }

    /// The winding number of the contours around `p`, counter-clockwise, without the edges that `counts`
    /// rejects. Exact for points off all edges.
    pub(super) fn winding(&self, p: [f64; 2], counts: impl Fn(&ContourEdge) -> bool) -> i32 {
        let mut winding = 0;
        self.descend(
            // A ray to the right does not meet boxes on the left of the point, above it or below it.
            |node| node.max[0] >= p[0] && node.min[1] <= p[1] && node.max[1] >= p[1],
            |row| {
                let edge = &self.edges[row as usize];
                // Half-open, so that a corner at the height of p counts once.
                let (up, down) = (edge.a[1] <= p[1], edge.b[1] <= p[1]);
                if up != down && counts(edge) {
                    let side = orient2d(edge.a, edge.b, p);
                    winding += i32::from(up && side == Orientation::Front);
                    winding -= i32::from(down && side == Orientation::Back);
                }
            },
        );
        winding
    }

    /// Whether `p` is inside; exact off the edges.
    pub(super) fn holds(&self, p: [f64; 2]) -> bool {
        self.fill.holds(self.winding(p, |_| true))
    }

    /// Calls `visit` for every edge below the nodes that pass `enters`.
    pub(super) fn descend(
        &self,
        mut enters: impl FnMut(&ContourBvhNode) -> bool,
        mut visit: impl FnMut(u32),
    ) {
        let mut waiting = vec![0_u32];
        while let Some(at) = waiting.pop() {
            let Some(node) = self.nodes.get(at as usize).filter(|node| enters(node)) else { continue };
            if node.second == 0 {
                (node.run[0]..node.run[1]).for_each(|k| visit(self.order[k as usize]));
            } else {
                waiting.extend([node.second, at + 1]);
            }
        }
    }

    /// The smallest squared distance to an edge, and the lowest row of an edge at that distance.
    fn nearest(&self, p: [f64; 2], start: u32) -> (f64, u32) {
        // Boxes and edges round differently, by less than this fraction: so the smallest distance is found in
        // any order of the search.
        const SLACK: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;
        let mut best = (self.square(p, start), start);
        let mut waiting = [(0.0, 0_u32); 64];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (distance_sq, at) = waiting[height];
            if distance_sq > best.0 * SLACK {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.second == 0 {
                for k in node.run[0]..node.run[1] {
                    let row = self.order[k as usize];
                    let square = self.square(p, row);
                    if square < best.0 || (square == best.0 && row < best.1) {
                        best = (square, row);
                    }
                }
                continue;
            }
            let children = [at + 1, node.second].map(|child| (self.box_distance_sq(p, child), child));
            let nearer = usize::from(children[1].0 < children[0].0);
            // The nearer child is on top of the stack, so that it is searched first.
            waiting[height] = children[1 - nearer];
            waiting[height + 1] = children[nearer];
            height += 2;
        }
        best
    }

    fn box_distance_sq(&self, p: [f64; 2], node: u32) -> f64 {
        let ContourBvhNode { min, max, .. } = &self.nodes[node as usize];
        let gap = |k: usize| {
            let (below, above) = (min[k] - p[k], p[k] - max[k]);
            let gap = greater(below, above);
            greater(gap, 0.0)
        };
        gap(0) * gap(0) + gap(1) * gap(1)
    }

    fn square(&self, p: [f64; 2], row: u32) -> f64 {
        let [x, y] = self.edges[row as usize].offset(p).0;
        x * x + y * y
    }

    /// A bound on the rounding of distances around `p`: the dot products that give the closest point are off
    /// by 8 units of `|p − a| · |b − a|`, which moves it by 8 units of `|p − a|`; differences, the point and
    /// the length add a few.
    pub(super) fn rounding(&self, p: [f64; 2]) -> f64 {
        const UNITS: f64 = 64.0 * f64::EPSILON;
        let size = greater(p[0].abs(), p[1].abs());
        add_up(UNITS * add_up(size, self.largest), f64::MIN_POSITIVE)
    }

    /// The signed distance, the nearest edge, and whether `p` is inside.
    pub(super) fn signed(&self, p: [f64; 2], start: u32) -> (f64, u32, bool) {
        let (square, row) = self.nearest(p, start);
        let inside = self.holds(p);
        let distance = square.sqrt();
        (if inside { -distance } else { distance }, row, inside)
    }

    pub(super) fn value(&self, p: [f64; 2]) -> f64 {
        self.signed(p, 0).0
    }
}

impl ContourEdge {
    /// `p` minus its closest point on the edge, and the position of that point on the edge, from 0 to 1.
    pub fn offset(&self, p: [f64; 2]) -> ([f64; 2], f64) {
        let along = [self.b[0] - self.a[0], self.b[1] - self.a[1]];
        let from = [p[0] - self.a[0], p[1] - self.a[1]];
        let t = (from[0] * along[0] + from[1] * along[1]) / (along[0] * along[0] + along[1] * along[1]);
        if t > 0.0 && t < 1.0 {
            ([from[0] - t * along[0], from[1] - t * along[1]], t)
        } else if t >= 1.0 {
            ([p[0] - self.b[0], p[1] - self.b[1]], 1.0)
        } else {
            (from, 0.0)
        }
    }
}
