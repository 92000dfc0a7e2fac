//! A tree over points that finds those in a box or near a segment.
use crate::math::{Box3, greater};

/// A tree of nested boxes, each split at the median of its longest side.
pub(crate) struct PointTree<'a> {
    points: &'a [[f64; 3]],
    /// Point indices; those of one box are contiguous.
    order: Vec<u32>,
    /// In depth-first order.
    nodes: Vec<PointTreeNode>,
}

struct PointTreeNode {
    bounds: Box3,
    /// The range of `order` that the node holds.
    start: u32,
    end: u32,
    /// The next node when this one's subtree is skipped.
    skip: u32,
}

/// Points a leaf. Measured on random points: 4 to 16 differ by less than a tenth.
const LEAF: usize = 8;

impl<'a> PointTree<'a> {
    pub fn new(points: &'a [[f64; 3]]) -> Self {
        let mut tree = Self { points, order: (0..points.len() as u32).collect(), nodes: Vec::new() };
        if !points.is_empty() {
            tree.build(0, points.len());
        }
        tree
    }

    /// The depth is the logarithm of the number of points, since every split is at the median.
    fn build(&mut self, start: usize, end: usize) {
        let (points, part) = (self.points, &mut self.order[start..end]);
        let bounds = Box3::from_points(part.iter().map(|&i| &points[i as usize]));
        let node = self.nodes.len();
        self.nodes.push(PointTreeNode { bounds, start: start as u32, end: end as u32, skip: 0 });
        if part.len() > LEAF {
            // Halved before the difference, which may exceed the range of f64.
            let side = |k: usize| 0.5 * bounds.max[k] - 0.5 * bounds.min[k];
            let axis = (1..3).fold(0, |most, k| if side(k) > side(most) { k } else { most });
            let middle = part.len() / 2;
            part.select_nth_unstable_by(middle, |&i, &j| {
                points[i as usize][axis].total_cmp(&points[j as usize][axis]).then(i.cmp(&j))
            });
            self.build(start, start + middle);
            self.build(start + middle, end);
        }
        self.nodes[node].skip = self.nodes.len() as u32;
    }

    /// Whether some point in a box, including its boundary, is wanted.
    pub fn any_in(&self, bounds: &Box3, is_wanted: impl Fn(u32) -> bool) -> bool {
        let mut next = 0;
        while let Some(node) = self.nodes.get(next) {
            let meets =
                (0..3).all(|k| node.bounds.min[k] <= bounds.max[k] && bounds.min[k] <= node.bounds.max[k]);
            // In depth-first order, only the successor of a leaf is outside its subtree.
            let is_leaf = next + 1 == node.skip as usize;
            let of_leaf = &self.order[node.start as usize..node.end as usize];
            let is_found = |i: &u32| bounds.contains(self.points[*i as usize]) && is_wanted(*i);
            if meets && is_leaf && of_leaf.iter().any(is_found) {
                return true;
            }
            next = if meets { next + 1 } else { node.skip as usize };
        }
        false
    }

    /// Calls `visit` with the index of every point within `reach` of the segment, and of some others.
    pub fn near_segment(&self, [a, b]: [[f64; 3]; 2], reach: f64, mut visit: impl FnMut(u32)) {
        // For a single leaf, the caller tests the points faster than planes test the box.
        if self.nodes.len() == 1 {
            return self.order.iter().for_each(|&i| visit(i));
        }
        let mut next = 0;
        while let Some(node) = self.nodes.get(next) {
            let is_near = may_meet([a, b], &node.bounds, reach);
            let is_leaf = next + 1 == node.skip as usize;
            if is_near && is_leaf {
                self.order[node.start as usize..node.end as usize].iter().for_each(|&i| visit(i));
            }
            next = if is_near { next + 1 } else { node.skip as usize };
        }
    }
}

/// Whether a segment may come within `reach` of a box: `false` only if one of six planes separates them with
/// certainty.
fn may_meet([a, b]: [[f64; 3]; 2], bounds: &Box3, reach: f64) -> bool {
    let largest =
        [a, b, bounds.min, bounds.max].as_flattened().iter().fold(0.0, |most, x| greater(x.abs(), most));
    // Centres and half sides below are off by at most two roundings of the largest coordinate each.
    let reach = reach + 8.0 * f64::EPSILON * largest + f64::MIN_POSITIVE;
    let half = |k: usize| 0.5 * b[k] - 0.5 * a[k];
    let offset = |k: usize| (0.5 * a[k] + 0.5 * b[k]) - (0.5 * bounds.min[k] + 0.5 * bounds.max[k]);
    let extent = |k: usize| (0.5 * bounds.max[k] - 0.5 * bounds.min[k]) + reach;
    let (half, offset, extent): ([f64; 3], [f64; 3], [f64; 3]) =
        (std::array::from_fn(half), std::array::from_fn(offset), std::array::from_fn(extent));
    if (0..3).any(|k| offset[k].abs() > half[k].abs() + extent[k]) {
        return false;
    }
    // Only its direction matters from here; with length about one, no product leaves the range of f64.
    let longest = half.iter().fold(0.0, |most, x| greater(x.abs(), most));
    let along = half.map(|x| x / longest);
    !(0..3).any(|k| is_separating_axis(along, offset, extent, (k + 1) % 3, (k + 2) % 3))
}

/// Whether a line along the segment separates the segment from the box in the projection on the axes `i` and
/// `j`. Five roundings a product and sum, of at most the sizes on the right; the NaN of a zero direction
/// makes it false.
fn is_separating_axis(along: [f64; 3], offset: [f64; 3], extent: [f64; 3], i: usize, j: usize) -> bool {
    let (left, right) = (along[i] * offset[j], along[j] * offset[i]);
    let reach = extent[i] * along[j].abs() + extent[j] * along[i].abs();
    let slack = 8.0 * f64::EPSILON * (left.abs() + right.abs() + reach) + f64::MIN_POSITIVE;
    (left - right).abs() > reach + slack
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn no_point_within_reach_is_missed_and_few_others_are_visited() {
        let mut random = Random::new(3);
        for scale in [1e-300, 1e-6, 1.0, 1e6, 1e300] {
            let mut point = || std::array::from_fn(|_| scale * random.unit());
            let points: Vec<[f64; 3]> = (0..2000).map(|_| point()).collect();
            let tree = PointTree::new(&points);
            let mut visits = 0;
            for _ in 0..200 {
                let [a, b] = [glam::DVec3::from(point()), glam::DVec3::from(point())];
                let reach = 0.02 * scale;
                let mut visited = vec![false; points.len()];
                tree.near_segment([a.into(), b.into()], reach, |i| {
                    visited[i as usize] = true;
                    visits += 1;
                });
                for (p, visited) in points.iter().zip(visited) {
                    let (p, d) = ((glam::DVec3::from(*p) - a) / scale, (b - a) / scale);
                    let t = (p.dot(d) / d.dot(d)).clamp(0.0, 1.0);
                    let distance = (p - d * t).length() * scale;
                    assert!(visited || distance > reach, "scale {scale}: missed at {distance}");
                }
            }
            assert!(visits < 200 * points.len() / 10, "scale {scale}: {visits} visits");
        }
        PointTree::new(&[]).near_segment([[0.0; 3]; 2], 1.0, |_| unreachable!());
    }

    #[test]
    fn the_points_in_a_box_are_found() {
        let points: Vec<[f64; 3]> =
            (0..1000_u32).map(|i| [i % 10, i / 10 % 10, i / 100].map(f64::from)).collect();
        let tree = PointTree::new(&points);
        for (i, p) in points.iter().enumerate() {
            let around = |half: f64| Box3 { min: p.map(|x| x - half), max: p.map(|x| x + half) };
            assert!(tree.any_in(&around(0.0), |j| j as usize == i));
            assert!(!tree.any_in(&around(0.9), |j| j as usize != i));
            assert!(tree.any_in(&around(1.0), |j| j as usize != i));
            assert!(!tree.any_in(&Box3 { min: p.map(|x| x + 0.1), max: p.map(|x| x + 0.9) }, |_| true));
        }
        assert!(!PointTree::new(&[]).any_in(&Box3 { min: [0.0; 3], max: [1.0; 3] }, |_| true));
    }
}
