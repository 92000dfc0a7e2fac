//! Queries for the triangles above a point and for those that meet a box.
use super::frame::{down, up};
use super::{Bvh, BvhNode, LAST, LEAF, NONE, STACK, WIDTH};
use crate::math::Box3;

impl Bvh {
    /// Calls `visit` with every face that the half-line from `p` along +z may meet, and some others, in the
    /// order of the tree.
    pub(crate) fn faces_above(&self, p: [f64; 3], visit: impl FnMut(u32)) {
        let [low, high] = self.frame.local(self.frame.scaled(p));
        let (low, high) = (low.map(down), high.map(up));
        let meets = |node: &BvhNode, lane: usize| {
            let [x, y, z] = &node.bounds;
            x[0][lane] <= high[0]
                && x[1][lane] >= low[0]
                && y[0][lane] <= high[1]
                && y[1][lane] >= low[1]
                && z[1][lane] >= low[2]
        };
        self.visit_faces(meets, visit);
    }

    /// Calls `visit` with every face that may share a point with `bounds`, and some others, in the order of
    /// the tree.
    pub(crate) fn faces_in_box(&self, bounds: &Box3, visit: impl FnMut(u32)) {
        let low = self.frame.local(self.frame.scaled(bounds.min))[0].map(down);
        let high = self.frame.local(self.frame.scaled(bounds.max))[1].map(up);
        let meets = |node: &BvhNode, lane: usize| {
            (0..3).all(|k| node.bounds[k][0][lane] <= high[k] && node.bounds[k][1][lane] >= low[k])
        };
        self.visit_faces(meets, visit);
    }

    /// Calls `visit` with the faces in every box that `meets` accepts.
    fn visit_faces(&self, meets: impl Fn(&BvhNode, usize) -> bool, mut visit: impl FnMut(u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = [0_u32; STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = &self.nodes[stack[waiting] as usize];
            for lane in 0..WIDTH {
                let child = node.child[lane];
                if child == NONE || !meets(node, lane) {
                    continue;
                }
                if child & LEAF == 0 {
                    stack[waiting] = child;
                    waiting += 1;
                    continue;
                }
                let run = &self.triangles[(child & !LEAF) as usize..];
                for triangle in run {
                    visit(triangle.face & !LAST);
                    if triangle.face & LAST != 0 {
                        break;
                    }
                }
            }
        }
    }
}
