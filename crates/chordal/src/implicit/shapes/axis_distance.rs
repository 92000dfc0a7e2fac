//! The distance from the z axis, with intervals of its slope that hold on the axis too.
use crate::budget::Evidence;
use crate::implicit::{Expr, Leaf, LeafAnswer, LeafError, Lipschitz};
use crate::math::{Box3, Interval, sqrt_down, sqrt_up};
use std::sync::Arc;

/// `√(x² + y²)`. In interval arithmetic the root has no slope on the axis, where a surface may well be; this
/// leaf has one.
pub(in crate::implicit) fn axis_distance() -> Expr {
    let [x, y, _] = Expr::axes();
    Expr::leaf(Arc::new(AxisDistance), [x, y, Expr::constant(0.0)])
}

#[derive(Clone, Copy, Debug)]
struct AxisDistance;

impl Leaf for AxisDistance {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        points.iter().zip(out).for_each(|([x, y, _], value)| *value = (x * x + y * y).sqrt());
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        for ([x, y, _], gradient) in points.iter().zip(out) {
            let r = (x * x + y * y).sqrt();
            *gradient = if r > 0.0 { [x / r, y / r, 0.0] } else { [0.0; 3] };
        }
        Ok(LeafAnswer::Given)
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        for (bounds, range) in boxes.iter().zip(out) {
            let [x, y] = sides(bounds);
            let square = x.square() + y.square();
            let low = if square.lo() > 0.0 { sqrt_down(square.lo()) } else { 0.0 };
            *range = Interval::new(low, sqrt_up(square.hi())).unwrap_or(Interval::ENTIRE);
        }
        Ok(LeafAnswer::Given)
    }

    fn gradient_over(&self, boxes: &[Box3], out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        for (bounds, gradient) in boxes.iter().zip(out) {
            let [x, y] = sides(bounds);
            *gradient = [cosine(x, y), cosine(y, x), Interval::point(0.0)];
        }
        Ok(LeafAnswer::Given)
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        None
    }

    fn evidence(&self) -> Evidence {
        Evidence::Proved
    }

    fn as_any(&self) -> Option<&dyn std::any::Any> {
        Some(self)
    }
}

/// The same as a root of squares, for programs that know only expressions.
pub(super) fn axis_distance_as_root() -> Expr {
    let [x, y, _] = Expr::axes();
    (x.square() + y.square()).sqrt()
}

/// Whether a leaf is the distance from the z axis.
pub(in crate::implicit) fn is_axis_distance(leaf: &dyn Leaf) -> bool {
    leaf.as_any().is_some_and(|leaf| leaf.is::<AxisDistance>())
}

/// The interval of `x / √(x² + y²)`; on the axis, of all generalized gradients. Off the axis it grows with
/// `x`, and goes towards 0 as `|y|` grows, so each end is the value at one corner.
fn cosine(x: Interval, y: Interval) -> Interval {
    let unit = Interval::new(-1.0, 1.0).unwrap_or(Interval::ENTIRE);
    if x.contains(0.0) && y.contains(0.0) {
        return unit;
    }
    let beside = y.abs();
    let at = |x: f64, outer: bool| {
        // Towards 0 with the largest |y|, away from it with the smallest.
        let y = if outer { beside.lo() } else { beside.hi() };
        let (x, y) = (Interval::point(x), Interval::point(y));
        let length = (x.square() + y.square()).sqrt();
        if length.lo() > 0.0 { (x / length).intersection(unit) } else { unit }
    };
    let (low, high) = (at(x.lo(), x.lo() < 0.0), at(x.hi(), x.hi() > 0.0));
    low.hull(high)
}

fn sides(bounds: &Box3) -> [Interval; 2] {
    [0, 1].map(|k| Interval::new(bounds.min[k], bounds.max[k]).unwrap_or(Interval::ENTIRE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_beside_the_axis_are_as_tight_as_their_corners() {
        let range = |x: [f64; 2], y: [f64; 2]| {
            let [x, y] = [x, y].map(|[low, high]| Interval::new(low, high).expect("a side"));
            let range = cosine(x, y);
            [range.lo(), range.hi()]
        };
        let near = |range: [f64; 2], truth: [f64; 2]| {
            // A few roundings; and never inside the true interval.
            assert!(range[0] <= truth[0] && range[0] >= truth[0] - 1e-14, "{range:?} {truth:?}");
            assert!(range[1] >= truth[1] && range[1] <= truth[1] + 1e-14, "{range:?} {truth:?}");
        };
        near(range([3.0, 4.0], [3.0, 4.0]), [0.6, 0.8]);
        near(range([-4.0, -3.0], [3.0, 4.0]), [-0.8, -0.6]);
        near(range([-3.0, 4.0], [-4.0, -3.0]), [-0.5_f64.sqrt(), 0.8]);
        near(range([3.0, 4.0], [-3.0, 4.0]), [0.6, 1.0]);
        near(range([-1.0, 1.0], [-1.0, 1.0]), [-1.0, 1.0]);
        near(range([0.0, 0.0], [-1.0, 1.0]), [-1.0, 1.0]);
        near(range([0.0, 1.0], [1.0, 2.0]), [0.0, 0.5_f64.sqrt()]);
        assert_eq!(range([0.0, f64::INFINITY], [f64::NEG_INFINITY, f64::INFINITY]), [-1.0, 1.0]);
    }
}
