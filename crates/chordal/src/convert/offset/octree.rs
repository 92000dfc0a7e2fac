//! The cells through which an offset surface may pass: an octree whose leaves are so small that the surface in each is
//! nearly one to three planes.
//!
//! *Decided cells.* The distance changes by at most the length of a way. A cell whose middle's value is larger than half
//! of its diagonal does not meet the surface.
//!
//! *Simple cells.* Each of nine samples predicts a point of the surface and the plane there. A cell is a leaf if all
//! planes that matter to it are nearly the same, or if they are two or three groups of planes that meet as the surface of
//! an offset does: outward it lies on the lower of them (valleys are sharp, ridges are round), inward on the higher.
//! This is a guess: what it overlooks is found when the triangles are measured and proved, and then the cell is cut.
use super::distance::{Hint, OffsetDistance, OffsetSample, narrowness};
use super::vertex::meeting_point;
use crate::budget::{Job, par_map};
use crate::math::IntegerMap;
use crate::math::{Box3, difference, dot, greater, lesser};

/// A cell: its low corner and its size in steps. The finest cells have two steps, so that middles are on the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct OffsetCell {
    pub low: [u32; 3],
    pub size: u32,
}

/// The smallest size.
pub(super) const FINEST: u32 = 2;

impl OffsetCell {
    pub fn corner(self, c: usize) -> [u32; 3] {
        std::array::from_fn(|k| self.low[k] + self.size * (c >> k & 1) as u32)
    }

    fn middle(self) -> [u32; 3] {
        self.low.map(|x| x + self.size / 2)
    }

    fn parts(self) -> [Self; 8] {
        let size = self.size / 2;
        std::array::from_fn(|c| Self {
            low: std::array::from_fn(|k| self.low[k] + size * (c >> k & 1) as u32),
            size,
        })
    }
}

/// The most levels: three coordinates of the lattice fit in one key.
const MOST_LEVELS: u32 = 19;
/// Bits of a coordinate in a key.
const KEY_BITS: u32 = 21;
/// The least cosine between normals of one smooth part and their mean. Chosen: what is 45 degrees apart is a crease, or
/// curved so much that the cell is too large.
const SMOOTH: f64 = 0.7;
/// The least cosine between planes of one group. Chosen: larger angles need vertices on the crease.
const GROUP: f64 = 0.8;
/// The largest half diagonal of a cell with a corner of the input near it, as a share of the offset. Derived: within it,
/// directions to one point differ by less than a right angle.
const ROUND: f64 = 0.95;
/// The most faces that are looked at in a larger cell.
const FEW: usize = 48;
/// The distance from the groups' planes at which they count as the surface, as a share of the cell's size. Chosen.
const FIT: f64 = 0.05;
/// The same as a share of the tolerance.
const FIT_TOLERANCE: f64 = 0.5;
/// Samples of a smooth part may be this many tolerances off the middle's plane. Derived: over half of the diagonal of a cell
/// of side h a sphere of radius r leaves its plane by 3·h²/8r, and its triangles, of side h, are off by h²/8r.
const BENT: f64 = 3.0;
/// Half of the region of a cell's own predictions, as a share of its size: a little more than the cell.
const OWN: f64 = 0.65;
/// Samples of a task: at a microsecond each, enough to repay its start.
const TASK: usize = 256;

/// An entry of the tree: a node, or with the highest bit a leaf.
const LEAF: u32 = 1 << 31;
const DECIDED: u32 = u32::MAX;

pub(super) struct Octree {
    distance: OffsetDistance,
    tolerance: f64,
    origin: [f64; 3],
    pub step: f64,
    root: OffsetCell,
    /// The parts of each node.
    nodes: Vec<[u32; 8]>,
    /// In Morton order.
    pub leaves: Vec<OffsetCell>,
    samples: IntegerMap<u64, OffsetSample>,
}

fn key(at: [u32; 3]) -> u64 {
    u64::from(at[0]) | u64::from(at[1]) << KEY_BITS | u64::from(at[2]) << (2 * KEY_BITS)
}

fn unpacked(key: u64) -> [u32; 3] {
    let mask = (1 << KEY_BITS) - 1;
    [0, 1, 2].map(|k| (key >> (k * KEY_BITS) & mask) as u32)
}

impl Octree {
    /// The cells around a surface in a box; none is smaller than `finest`, unless the box is too large for that.
    pub fn new(distance: OffsetDistance, bounds: &Box3, finest: f64, tolerance: f64, job: &Job) -> Self {
        let longest = (0..3).fold(0.0, |most, k| greater(bounds.max[k] - bounds.min[k], most));
        let levels = libm::log2(longest / finest).ceil().clamp(1.0, f64::from(MOST_LEVELS)) as u32;
        // No face of a typical input lies in a plane of such a lattice.
        let side = longest * 1.000_123;
        let root = OffsetCell { low: [0; 3], size: FINEST << levels };
        let step = side / f64::from(root.size);
        let origin = std::array::from_fn(|k| 0.5 * (bounds.min[k] + bounds.max[k]) - 0.5 * side);
        let mut tree = Self {
            distance,
            tolerance,
            origin,
            step,
            root,
            nodes: vec![[DECIDED; 8]],
            leaves: Vec::new(),
            samples: IntegerMap::default(),
        };
        tree.grow(root.parts().into_iter().enumerate().map(|(c, cell)| (cell, [0, c as u32])).collect(), job);
        tree
    }

    pub fn at(&self, at: [u32; 3]) -> [f64; 3] {
        std::array::from_fn(|k| self.origin[k] + f64::from(at[k]) * self.step)
    }

    /// The sample at a corner or the middle of a leaf.
    pub fn sample(&self, at: [u32; 3]) -> &OffsetSample {
        &self.samples[&key(at)]
    }

    /// The leaf that contains the finest cell at these steps; `None` in decided cells and outside of the root.
    pub fn leaf_at(&self, at: [u32; 3]) -> Option<u32> {
        if at.iter().any(|x| *x >= self.root.size) {
            return None;
        }
        let (mut node, mut half) = (0, self.root.size / 2);
        loop {
            let c = (0..3).fold(0, |c, k| c | usize::from(at[k] & half != 0) << k);
            let entry = self.nodes[node][c];
            if entry == DECIDED {
                return None;
            }
            if entry & LEAF != 0 {
                return Some(entry & !LEAF);
            }
            node = entry as usize;
            half /= 2;
        }
    }

    /// The leaf around a point, if it is in one.
    pub fn leaf_near(&self, p: [f64; 3]) -> Option<u32> {
        let steps = [0, 1, 2].map(|k| ((p[k] - self.origin[k]) / self.step).floor());
        // Points outside saturate, and are no cells.
        if steps.iter().any(|x| *x < 0.0) { None } else { self.leaf_at(steps.map(|x| x as u32)) }
    }

    /// Cuts leaves, at least once each.
    pub fn cut(&mut self, leaves: &[u32], job: &Job) {
        let mut open = Vec::new();
        for leaf in leaves {
            let cell = self.leaves[*leaf as usize];
            if cell.size <= FINEST {
                continue;
            }
            let [node, c] = self.slot_of(cell);
            self.nodes[node as usize][c as usize] = self.new_node(cell, &mut open);
        }
        self.grow(open, job);
    }

    fn new_node(&mut self, cell: OffsetCell, open: &mut Vec<(OffsetCell, [u32; 2])>) -> u32 {
        let node = self.nodes.len() as u32;
        self.nodes.push([DECIDED; 8]);
        open.extend(cell.parts().into_iter().enumerate().map(|(c, part)| (part, [node, c as u32])));
        node
    }

    fn slot_of(&self, cell: OffsetCell) -> [u32; 2] {
        let (mut node, mut half) = (0_u32, self.root.size / 2);
        loop {
            let c = (0..3).fold(0, |c, k| c | usize::from(cell.low[k] & half != 0) << k);
            if half == cell.size {
                return [node, c as u32];
            }
            node = self.nodes[node as usize][c];
            half /= 2;
        }
    }

    /// Decides cells, level by level, and cuts those that are not simple.
    fn grow(&mut self, mut open: Vec<(OffsetCell, [u32; 2])>, job: &Job) {
        while !open.is_empty() {
            self.look(open.iter().map(|(cell, _)| key(cell.middle())).collect(), job);
            let near: Vec<(OffsetCell, [u32; 2])> = open
                .into_iter()
                .filter(|(cell, _)| self.sample(cell.middle()).value.abs() <= self.half_diagonal(*cell))
                .collect();
            self.look(near.iter().flat_map(|(cell, _)| (0..8).map(|c| key(cell.corner(c)))).collect(), job);
            let simple = par_map(job, &near, |_, (cell, _)| cell.size <= FINEST || self.is_simple(*cell));
            open = Vec::new();
            for ((cell, [node, c]), simple) in near.into_iter().zip(simple) {
                self.nodes[node as usize][c as usize] =
                    if simple { LEAF } else { self.new_node(cell, &mut open) };
            }
            if job.is_cancelled() {
                return;
            }
        }
        self.number_leaves();
    }

    fn number_leaves(&mut self) {
        self.leaves.clear();
        let mut stack = vec![(0_u32, self.root)];
        while let Some((node, cell)) = stack.pop() {
            for (c, part) in cell.parts().into_iter().enumerate() {
                let entry = &mut self.nodes[node as usize][c];
                if *entry == DECIDED {
                    continue;
                }
                if *entry & LEAF != 0 {
                    *entry = LEAF | self.leaves.len() as u32;
                    self.leaves.push(part);
                } else {
                    stack.push((*entry, part));
                }
            }
        }
    }

    /// Samples what is not known yet.
    fn look(&mut self, mut keys: Vec<u64>, job: &Job) {
        keys.retain(|key| !self.samples.contains_key(key));
        keys.sort_unstable();
        keys.dedup();
        let tasks: Vec<&[u64]> = keys.chunks(TASK).collect();
        let found = par_map(job, &tasks, |_, keys| {
            let mut hint = Hint::default();
            keys.iter()
                .map(|key| self.distance.at(self.at(unpacked(*key)), &mut hint))
                .collect::<Vec<OffsetSample>>()
        });
        for (key, sample) in keys.iter().zip(found.into_iter().flatten()) {
            self.samples.insert(*key, sample);
        }
    }

    fn half_diagonal(&self, cell: OffsetCell) -> f64 {
        // The margin is far above the rounding of corners.
        0.5 * 3_f64.sqrt() * self.step * f64::from(cell.size) * (1.0 + 1e-9)
    }

    fn is_simple(&self, cell: OffsetCell) -> bool {
        let half = self.half_diagonal(cell);
        let middle = self.sample(cell.middle());
        if half > ROUND * self.distance.by.abs() {
            let normals = self.distance.normals_near(middle, half, FEW);
            return normals.is_some_and(|normals| narrowness(normals.into_iter()) > SMOOTH);
        }
        let size = self.step * f64::from(cell.size);
        let is_own = |p: [f64; 3]| (0..3).all(|k| (p[k] - middle.at[k]).abs() <= OWN * size);
        let corners = (0..8).map(|c| self.sample(cell.corner(c)));
        let mut own: Vec<&OffsetSample> =
            corners.chain([middle]).filter(|sample| is_own(sample.foot())).collect();
        if own.is_empty() {
            return true;
        }
        if narrowness(own.iter().map(|sample| sample.normal)) > SMOOTH {
            let plane = middle.plane();
            let off = |sample: &&OffsetSample| dot(plane.normal, difference(sample.foot(), plane.at)).abs();
            return own.iter().all(|sample| off(sample) <= BENT * self.tolerance);
        }
        // The samples nearest to the surface first: they know it best.
        own.sort_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
        let mut groups: Vec<&OffsetSample> = Vec::new();
        for sample in &own {
            if groups.iter().all(|group| dot(group.normal, sample.normal) < GROUP) {
                groups.push(sample);
            }
        }
        if groups.len() > 3 || groups.is_empty() {
            return false;
        }
        let fit = greater(FIT * size, FIT_TOLERANCE * self.tolerance);
        let predicted = |p: [f64; 3]| {
            let mut values = groups.iter().map(|group| dot(group.normal, difference(p, group.foot())));
            let first = values.next().unwrap_or(f64::INFINITY);
            if self.distance.by > 0.0 { values.fold(first, lesser) } else { values.fold(first, greater) }
        };
        // Near the input a point may be on the other side of a crease than its foot; far from the surface, curved parts differ
        // from their planes.
        let is_explained = |sample: &&OffsetSample| {
            predicted(sample.foot()).abs() <= fit || (predicted(sample.at) - sample.value).abs() <= fit
        };
        if !own.iter().all(is_explained) {
            return false;
        }
        let planes: Vec<_> = groups.iter().map(|group| group.plane()).collect();
        let meeting = meeting_point(&planes, middle.at);
        !is_own(meeting) || self.distance.at(meeting, &mut Hint::default()).value.abs() <= fit
    }

    pub fn cell_box(&self, cell: OffsetCell) -> [[f64; 3]; 2] {
        [self.at(cell.low), self.at(cell.corner(7))]
    }

    /// A point moved along a line of the lattice.
    pub fn on_edge(&self, axis: usize, low: [u32; 3], size: u32) -> [&OffsetSample; 2] {
        let mut high = low;
        high[axis] += size;
        [self.sample(low), self.sample(high)]
    }

    pub fn distance(&self) -> &OffsetDistance {
        &self.distance
    }
}
