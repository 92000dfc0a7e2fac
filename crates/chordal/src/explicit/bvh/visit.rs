//! Queries for the triangles above a point, near a point, and for those that meet a box.
use super::frame::{down, up};
use super::{Bvh, BvhNode, LAST, LEAF, NONE, STACK, WIDTH};
use crate::math::{Box3, add_up, mul_up, sub_down, sub_up};

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

    /// Calls `visit` with the rows of all triangles with a point within `radius` of `p` along each axis, and
    /// of some others, in the order of the tree.
    pub(crate) fn rows_near(&self, p: [f64; 3], radius: f64, mut visit: impl FnMut(u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let [low, high] = self.frame.local(self.frame.scaled(p));
        // Scaled by a power of two; the error of underflow is less than the smallest normal number.
        let reach = add_up(mul_up(radius, self.frame.scale), f64::MIN_POSITIVE);
        let low = low.map(|x| down(sub_down(x, reach)));
        let high = high.map(|x| up(sub_up(x, -reach)));
        let mut stack = [0_u32; STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = &self.nodes[stack[waiting] as usize];
            for lane in 0..WIDTH {
                let meets =
                    (0..3).all(|k| node.bounds[k][0][lane] <= high[k] && node.bounds[k][1][lane] >= low[k]);
                let child = node.child[lane];
                if !meets || child == NONE {
                    continue;
                }
                if child & LEAF == 0 {
                    stack[waiting] = child;
                    waiting += 1;
                } else {
                    super::winding::leaf_rows(self, child).for_each(&mut visit);
                }
            }
        }
    }
}
