//! The triangles above a point.
use super::frame::{down, up};
use super::{Bvh, LAST, LEAF, NONE, STACK, WIDTH};

impl Bvh {
    /// Calls `visit` with every face that the half-line from `p` along +z may meet, and some others, in the order of
    /// the tree.
    pub(crate) fn above(&self, p: [f64; 3], mut visit: impl FnMut(u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let [low, high] = self.frame.local(self.frame.scaled(p));
        let (low, high) = (low.map(down), high.map(up));
        let mut stack = [0_u32; STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = &self.nodes[stack[waiting] as usize];
            for lane in 0..WIDTH {
                let [x, y, z] = &node.bounds;
                let meets = x[0][lane] <= high[0]
                    && x[1][lane] >= low[0]
                    && y[0][lane] <= high[1]
                    && y[1][lane] >= low[1]
                    && z[1][lane] >= low[2];
                let child = node.child[lane];
                if !meets || child == NONE {
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
