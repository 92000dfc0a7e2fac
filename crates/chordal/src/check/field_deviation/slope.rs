//! Boxes and the ranges of a field over them: its sign, its largest slope, and its growth along a direction.
use crate::implicit::Dual;
use crate::math::{Box3, Interval, div_up, greater, length, length_up};

/// `v · w`, enclosed.
pub(super) fn dot(v: [Interval; 3], w: [Interval; 3]) -> Interval {
    (v[0] * w[0] + v[1] * w[1]) + v[2] * w[2]
}

/// A point as intervals without width.
pub(super) fn exactly(p: [f64; 3]) -> [Interval; 3] {
    p.map(Interval::point)
}

/// `p − q`, enclosed.
pub(super) fn step(p: [f64; 3], q: [f64; 3]) -> [Interval; 3] {
    std::array::from_fn(|k| Interval::point(p[k]) - Interval::point(q[k]))
}

/// `|p − q|`, rounded up.
pub(super) fn distance_up(p: [f64; 3], q: [f64; 3]) -> f64 {
    length_up(step(p, q).map(Interval::magnitude))
}

/// The box extended by a margin on every side, rounded outward.
pub(super) fn inflated(bounds: &Box3, margin: f64) -> Box3 {
    Box3 {
        min: bounds.min.map(|x| (x - margin).next_down()),
        max: bounds.max.map(|x| (x + margin).next_up()),
    }
}

/// Ranges are taken over boxes that exceed their cells by this share of the largest coordinate.
const PAD: f64 = 8.0 * f64::EPSILON;

/// The box extended by a little more than rounding moves its corners.
pub(super) fn padded(bounds: &Box3) -> Box3 {
    let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |a: f64, b| greater(b.abs(), a));
    let pad = PAD * reach;
    Box3 { min: bounds.min.map(|x| (x - pad).next_down()), max: bounds.max.map(|x| (x + pad).next_up()) }
}

/// The growth of a field along a direction within a box.
pub(super) struct GrowthRate {
    /// The length of the direction, rounded up.
    pub length: f64,
    /// Over a step of `s` times the direction the field grows by at least `s · rate`; > 0.
    pub rate: f64,
}

impl GrowthRate {
    /// Growth along the middle of the gradient's range; `None` if the field may be stationary along it, or
    /// jumps.
    ///
    /// For a function that is Lipschitz in the box (defined, with bounded generalized gradients) the mean
    /// value theorem holds with them: G. Lebourg, *Valeur moyenne pour gradient généralisé*, 1975.
    pub fn along_gradient(slope: &Dual<Interval>) -> Option<Self> {
        if !is_lipschitz(slope) {
            return None;
        }
        let middle = slope.gradient.map(|d| d.midpoint().unwrap_or(0.0));
        let size = middle.iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
        if size <= 0.0 {
            return None;
        }
        let scaled = middle.map(|x| x / size);
        let norm = length(scaled);
        Self::along_direction(slope, scaled.map(|x| x / norm))
    }

    /// Growth along a direction of length 1 up to rounding.
    pub fn along_direction(slope: &Dual<Interval>, along: [f64; 3]) -> Option<Self> {
        let rate = dot(slope.gradient, exactly(along)).lo();
        (rate > 0.0).then(|| Self { length: length_up(along.map(f64::abs)), rate })
    }

    /// An upper bound on the number of steps along the direction that change the field by `change`.
    pub fn steps_for(&self, change: f64) -> f64 {
        div_up(change, self.rate)
    }
}

/// Whether the field is defined, continuous, and of bounded slope all over the box.
pub(super) fn is_lipschitz(slope: &Dual<Interval>) -> bool {
    let bounded = |d: &Interval| d.is_defined() && d.lo() > f64::NEG_INFINITY && d.hi() < f64::INFINITY;
    slope.value.is_defined() && slope.gradient.iter().all(bounded)
}

/// Whether all values are inside. A range that is not defined may contain undefined values, which are
/// outside.
pub(super) fn is_inside(range: Interval) -> bool {
    range.is_defined() && range.hi() < 0.0
}

pub(super) fn is_outside(range: Interval) -> bool {
    range.is_defined() && range.lo() >= 0.0
}

/// The largest slope in the box, rounded up.
pub(super) fn steepest(slope: &Dual<Interval>) -> f64 {
    length_up(slope.gradient.map(Interval::magnitude))
}
