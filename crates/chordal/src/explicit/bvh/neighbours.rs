//! Queries for all triangles near a point.
use super::frame::{down, up};
use super::{Bvh, LEAF, NONE, STACK, WIDTH};
use crate::math::{add_up, mul_up, sub_down, sub_up};

impl Bvh {
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
