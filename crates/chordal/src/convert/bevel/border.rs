//! `BorderTree`: the edges of a region in the plane, and the distance of points from them.
use crate::math::{distance, greater, length, lesser};

/// Edges in a leaf. Chosen: boxes of fewer cost more than they save.
const IN_LEAF: usize = 4;

/// A box over a run of edges, and the index of its second child; 0 for a leaf. The first child follows the box.
#[derive(Debug)]
struct BorderNode {
    low: [f64; 2],
    high: [f64; 2],
    run: [u32; 2],
    second: u32,
}

/// Edges with a tree of boxes over them.
#[derive(Debug)]
pub(super) struct BorderTree {
    edges: Vec<[[f64; 2]; 2]>,
    nodes: Vec<BorderNode>,
}

/// The point of an edge nearest to another point, as computed: on the edge up to rounding.
pub(super) fn nearest([a, b]: [[f64; 2]; 2], p: [f64; 2]) -> [f64; 2] {
    let d = [b[0] - a[0], b[1] - a[1]];
    let t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
    if t >= 1.0 {
        return b;
    }
    // NaN, for an edge without length, is not above 0 either.
    if t > 0.0 { [a[0] + t * d[0], a[1] + t * d[1]] } else { a }
}

impl BorderTree {
    pub fn new(mut edges: Vec<[[f64; 2]; 2]>) -> Self {
        let mut nodes = Vec::new();
        let n = edges.len();
        if n > 0 {
            build(&mut edges, 0, &mut nodes);
        }
        Self { edges, nodes }
    }

    /// Calls for every edge whose box is within `reach` of a box.
    pub fn each_near(&self, [low, high]: [[f64; 2]; 2], reach: f64, mut call: impl FnMut([[f64; 2]; 2])) {
        let is_far = |node: &BorderNode| {
            (0..2).any(|k| node.low[k] > high[k] + reach || node.high[k] < low[k] - reach)
        };
        let mut stack = vec![0];
        while let Some(i) = stack.pop() {
            let Some(node) = self.nodes.get(i).filter(|node| !is_far(node)) else { continue };
            if node.second == 0 {
                self.edges[node.run[0] as usize..node.run[1] as usize].iter().for_each(|edge| call(*edge));
            } else {
                stack.extend([i + 1, node.second as usize]);
            }
        }
    }

    /// The distance to the nearest edge, and that edge.
    pub fn nearest(&self, p: [f64; 2]) -> (f64, [[f64; 2]; 2]) {
        let outside = |node: &BorderNode| {
            let gap = |k: usize| greater(greater(node.low[k] - p[k], p[k] - node.high[k]), 0.0);
            length([gap(0), gap(1)])
        };
        let mut best = (f64::INFINITY, [[0.0; 2]; 2]);
        let mut stack = vec![(0.0, 0)];
        while let Some((gap, i)) = stack.pop() {
            let Some(node) = self.nodes.get(i).filter(|_| gap < best.0) else { continue };
            if node.second == 0 {
                for edge in &self.edges[node.run[0] as usize..node.run[1] as usize] {
                    let gap = distance(nearest(*edge, p), p);
                    if gap < best.0 {
                        best = (gap, *edge);
                    }
                }
                continue;
            }
            let mut children =
                [i + 1, node.second as usize].map(|child| (outside(&self.nodes[child]), child));
            // The nearer child comes on top of the stack, and is searched first.
            if children[0].0 < children[1].0 {
                children.reverse();
            }
            stack.extend(children);
        }
        best
    }
}

fn build(edges: &mut [[[f64; 2]; 2]], first: usize, nodes: &mut Vec<BorderNode>) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in edges.iter().flatten() {
        low = [lesser(low[0], p[0]), lesser(low[1], p[1])];
        high = [greater(high[0], p[0]), greater(high[1], p[1])];
    }
    let at = nodes.len();
    let run = [first as u32, (first + edges.len()) as u32];
    nodes.push(BorderNode { low, high, run, second: 0 });
    if edges.len() <= IN_LEAF {
        return;
    }
    let k = usize::from(high[1] - low[1] > high[0] - low[0]);
    let middle = edges.len() / 2;
    edges.select_nth_unstable_by(middle, |a, b| (a[0][k] + a[1][k]).total_cmp(&(b[0][k] + b[1][k])));
    let (left, right) = edges.split_at_mut(middle);
    build(left, first, nodes);
    // The first child follows its parent.
    nodes[at].second = nodes.len() as u32;
    build(right, first + middle, nodes);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_what_a_scan_finds() {
        let seed = 9;
        println!("seed {seed}");
        let mut random = chordal_testkit::Random::new(seed);
        let mut point = || [random.below(1000) as f64 / 100.0, random.below(1000) as f64 / 100.0];
        let edges: Vec<_> = (0..200).map(|_| [point(), point()]).collect();
        let tree = BorderTree::new(edges.clone());
        for _ in 0..200 {
            let p = point();
            let scan =
                edges.iter().fold(f64::INFINITY, |least, edge| lesser(least, distance(nearest(*edge, p), p)));
            assert_eq!(tree.nearest(p).0, scan);
            let mut n = 0;
            tree.each_near([p, p], 1.0, |_| n += 1);
            let within = edges.iter().filter(|edge| distance(nearest(**edge, p), p) <= 1.0).count();
            assert!(n >= within, "{n} {within}");
        }
    }
}
