//! A lower bound on the distance of one point from the surface of a field: boxes around it, nearest first.
//!
//! A cube around the point c is split into boxes; those over which the range of the field has one sign are
//! dropped. A point of the surface inside of the cube lies in a remaining box: if all the boxes that hold it
//! had one sign, they would all have the same one, since they share the point, and they cover a neighbourhood
//! of it. So the surface is no nearer to c than the nearest remaining box, or the sides of the cube. The
//! nearest box is split again and again, until it is small compared to its distance.
use super::slope::step;
use super::sub_boxes;
use crate::implicit::{LeafError, Tape};
use crate::math::{Box3, Interval, add_down, greater, lesser, mul_down, sqrt_down};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The lower bound for a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct DistanceProbe {
    /// The surface is no nearer.
    pub at_least: f64,
    /// The centre of the box in which it may be nearest.
    pub towards: [f64; 3],
    /// The number of boxes that were evaluated.
    pub n_boxes: u64,
}

/// How close the lower bound should be.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProbeSharpness {
    /// The most boxes split into 64 for one point.
    pub most_cuts: usize,
    /// A lower bound that is this share of the distance suffices.
    pub enough: f64,
    /// Boxes whose diagonal is below this share of the distance are not split.
    pub small: f64,
}

impl ProbeSharpness {
    /// For many points, the farthest of which is wanted. Chosen: bounds within 3 % select it.
    pub const ROUGH: Self = Self { most_cuts: 64, enough: 0.97, small: 0.03 };
    /// For a single point whose distance is wanted. Chosen: it takes a tenth of a second.
    pub const CLOSE: Self = Self { most_cuts: 1 << 11, enough: 1.0, small: 1e-4 };
}

/// A box that may hold a part of the surface, ordered by distance: the nearest is the greatest.
struct ProbeBox {
    far: f64,
    number: usize,
    bounds: Box3,
}

impl PartialEq for ProbeBox {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for ProbeBox {}
impl PartialOrd for ProbeBox {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for ProbeBox {
    fn cmp(&self, other: &Self) -> Ordering {
        other.far.total_cmp(&self.far).then(other.number.cmp(&self.number))
    }
}

struct ProbeSearch {
    from: [f64; 3],
    /// An upper bound on the distance of interest.
    most: f64,
    /// No part of the surface outside the cube is nearer than this.
    side: f64,
    open: BinaryHeap<ProbeBox>,
    cut: usize,
    done: bool,
    sharpness: ProbeSharpness,
}

impl ProbeSearch {
    fn new(from: [f64; 3], most: f64, sharpness: ProbeSharpness) -> Self {
        let half = 1.01 * most;
        let cube =
            Box3 { min: from.map(|x| (x - half).next_down()), max: from.map(|x| (x + half).next_up()) };
        let open = BinaryHeap::from([ProbeBox { far: 0.0, number: 0, bounds: cube }]);
        Self { from, most, side: most, open, cut: 0, done: !half.is_finite(), sharpness }
    }

    /// The next box to be split.
    fn next(&mut self) -> Option<Box3> {
        let ProbeSharpness { most_cuts, enough, small } = self.sharpness;
        let small = |near: &ProbeBox| near.bounds.diagonal() < small * greater(near.far, 0.1 * self.most);
        let enough = |near: &ProbeBox| near.far >= enough * self.most || small(near);
        if self.done || self.cut >= most_cuts || self.open.peek().is_none_or(enough) {
            self.done = true;
            return None;
        }
        self.cut += 1;
        self.open.pop().map(|near| near.bounds)
    }

    fn keep(&mut self, part: Box3) {
        let far = self.distance_down(&part);
        if far < self.most {
            self.open.push(ProbeBox { far, number: self.cut * 64 + self.open.len(), bounds: part });
        }
    }

    /// A lower bound on the distance of a box.
    fn distance_down(&self, bounds: &Box3) -> f64 {
        let (low, high) = (step(bounds.min, self.from), step(self.from, bounds.max));
        let beside = |k: usize| greater(greater(low[k].lo(), high[k].lo()), 0.0);
        let sum = (0..3).fold(0.0, |sum, k| add_down(sum, mul_down(beside(k), beside(k))));
        greater(sqrt_down(greater(sum, 0.0)), 0.0)
    }

    fn result(&self) -> DistanceProbe {
        let n_boxes = 64 * self.cut as u64;
        match self.open.peek() {
            Some(near) => DistanceProbe {
                at_least: lesser(near.far, self.side),
                towards: near.bounds.centre(),
                n_boxes,
            },
            None => DistanceProbe { at_least: self.side, towards: self.from, n_boxes },
        }
    }
}

/// For each point, whose distance to the surface is at most `most`, a lower bound on that distance.
pub(super) fn probe_distances(
    tape: &Tape,
    points: &[[f64; 3]],
    most: &[f64],
    sharpness: ProbeSharpness,
) -> Result<Vec<DistanceProbe>, LeafError> {
    let mut walks: Vec<ProbeSearch> =
        points.iter().zip(most).map(|(p, most)| ProbeSearch::new(*p, *most, sharpness)).collect();
    loop {
        let cut: Vec<(usize, Box3)> =
            walks.iter_mut().enumerate().filter_map(|(k, walk)| walk.next().map(|b| (k, b))).collect();
        if cut.is_empty() {
            break;
        }
        let parts: Vec<Box3> = cut.iter().flat_map(|(_, b)| sub_boxes(b)).collect();
        let mut ranges = vec![Interval::UNKNOWN; parts.len()];
        tape.over(&parts, &mut ranges)?;
        for (n, (part, range)) in parts.iter().zip(&ranges).enumerate() {
            // A range that touches 0 from above is outside: ties are outside.
            let one_sign = range.is_defined() && (range.lo() >= 0.0 || range.hi() < 0.0);
            if !one_sign {
                // Each box has 64 parts, in the order of the boxes.
                walks[cut[n / 64].0].keep(*part);
            }
        }
    }
    Ok(walks.iter().map(ProbeSearch::result).collect())
}
