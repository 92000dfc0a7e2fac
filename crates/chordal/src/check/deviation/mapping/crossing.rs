//! `Crossing`: the point at which the image of an edge of the source leaves a face of the result.
use super::super::distance::{UNDERFLOW, apart_up};
use crate::explicit::closest_on_segments;
use crate::math::greater;

/// A point of an edge of the source and the corresponding point of an edge of the result.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// The parameter on the edge of the source, between 0 and 1. As a number of type f64 it is exact, and so
    /// is the point that it defines.
    pub t: f64,
    /// The same on the edge of the result.
    pub s: f64,
    /// An upper bound on the distance of the two points.
    pub up: f64,
}

impl Crossing {
    /// The nearest points of the edge `source` and the edge `result`, the first of them with a parameter of
    /// at least `least`.
    pub fn nearest(source: [[f64; 3]; 2], result: [[f64; 3]; 2], least: f64) -> Self {
        let [t, s] = closest_on_segments(source, result, least);
        Self { t, s, up: apart_at_most(source, t, result, s) }
    }
}

/// An upper bound on the distance of `u + t (v − u)` and `a + s (b − a)`, for exact `t` and `s` in [0, 1].
///
/// A component is a sum of three terms with at most four roundings on the way to each (a difference, a product,
/// two sums), so that it is off by less than `2.01 ε` times the sum of their sizes, which itself is low by at most
/// that. `3 ε S` and `8 ε` cover this, the length and second orders with a margin, as in
/// [`super::super::distance::distance_up`].
fn apart_at_most([u, v]: [[f64; 3]; 2], t: f64, [a, b]: [[f64; 3]; 2], s: f64) -> f64 {
    // Measured from the nearer end if the point is an end: the distance between two ends loses nothing.
    let (p, t) = if t == 1.0 { (v, 0.0) } else { (u, t) };
    let (q, s) = if s == 1.0 { (b, 0.0) } else { (a, s) };
    if t == 0.0 && s == 0.0 {
        return if p == q { 0.0 } else { apart_up(p, q) };
    }
    let (mut square, mut size) = (0.0, 0.0);
    for k in 0..3 {
        let [x, y, z] = [p[k] - q[k], t * (v[k] - u[k]), s * (b[k] - a[k])];
        let sum = x + y - z;
        square += sum * sum;
        size += x.abs() + y.abs() + z.abs();
    }
    let rounding = 3.0 * f64::EPSILON * size; // derived above
    greater((square.sqrt() + rounding) * (1.0 + 8.0 * f64::EPSILON) + UNDERFLOW, 0.0) // derived above
}
