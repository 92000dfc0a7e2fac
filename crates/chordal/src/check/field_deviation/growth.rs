//! A direction along which several functions grow, from ranges of their gradients.
//!
//! The hull of the boxes of gradients, each scaled to about length 1, has a point nearest to 0; if that is
//! not 0 itself, every point of the hull has a positive component along it. Gilbert's steps approach it; the
//! proof is the check that follows, with endpoints rounded outward.
//!
//! Source: E. Gilbert, *An iterative procedure for computing the minimum of a quadratic form on a convex
//! set*, 1966.
use crate::math::{Interval, add_down, dot, length, lesser, mul_down};

/// The most steps: measured, hulls of gradients in small cells take 2 to 10.
const STEPS: usize = 60;

/// A direction along which all functions grow, if one is found.
pub(super) fn direction(gradients: &[[Interval; 3]]) -> Option<[f64; 3]> {
    let middle = |g: &[Interval; 3]| g.map(|d| 0.5 * d.lo() + 0.5 * d.hi());
    let scales: Vec<f64> = gradients.iter().map(|g| 1.0 / length(middle(g))).collect();
    if gradients.is_empty() || scales.iter().any(|scale| !scale.is_finite()) {
        return None;
    }
    // The mean of the middles is in the hull, and usually a direction already.
    let mut at = [0.0; 3];
    for (g, scale) in gradients.iter().zip(&scales) {
        let m = middle(g);
        (0..3).for_each(|k| at[k] += scale * m[k] / gradients.len() as f64);
    }
    for _ in 0..STEPS {
        let norm = dot(at, at);
        // Half of the digits: nearer to 0, rounding decides.
        if norm < f64::EPSILON {
            return None;
        }
        if grows(gradients, at) {
            return Some(at);
        }
        // The corner of each box that is lowest along the direction: the hull's point that is most
        // against it.
        let farthest = gradients.iter().zip(&scales).map(|(g, scale)| lowest(g, at).map(|x| x * scale));
        let towards = farthest.fold(None, |best: Option<(f64, [f64; 3])>, p| {
            let far = dot(at, p);
            if best.is_some_and(|(least, _)| least <= far) { best } else { Some((far, p)) }
        });
        let (_, p) = towards?;
        let step: [f64; 3] = std::array::from_fn(|k| p[k] - at[k]);
        // Gilbert's step: the point nearest to 0 on the segment to that corner, which is in the
        // hull as well.
        let share = -dot(at, step) / dot(step, step);
        let share = lesser(1.0, share);
        if share.is_nan() || share <= f64::EPSILON {
            return None;
        }
        (0..3).for_each(|k| at[k] += share * step[k]);
    }
    None
}

/// The corner of a box of gradients that is the lowest along a direction.
fn lowest(gradient: &[Interval; 3], n: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| if n[k] > 0.0 { gradient[k].lo() } else { gradient[k].hi() })
}

/// Whether all gradients in the boxes have a positive component along a direction.
fn grows(gradients: &[[Interval; 3]], n: [f64; 3]) -> bool {
    gradients.iter().all(|gradient| {
        let p = lowest(gradient, n);
        (0..3).fold(0.0, |sum, k| add_down(sum, mul_down(n[k], p[k]))) > 0.0
    })
}
