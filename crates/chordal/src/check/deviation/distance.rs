//! The distance from a point to one triangle, bounded from above: the innermost step of the search.
use crate::explicit::closest_on_triangle;
use crate::math::{difference, length};

/// Twice the unit roundoff: `|x ∘ y rounded − x ∘ y| ≤ ε/2 · |x ∘ y|`.
const EPS: f64 = f64::EPSILON;

/// The loss of squares and products to underflow, as a length, is less than `√(6 · 2⁻¹⁰⁷⁴)`; this is `2⁻⁵⁰⁸`.
pub(super) const UNDERFLOW: f64 = f64::from_bits((1023 - 508) << 52);

/// An upper bound on the distance from `q` to the triangle; 0 if `q` is one of its corners.
///
/// The weights `w ≥ 0` of the nearest point decide how sharp it is; its validity does not depend on them,
/// since `Σ wᵢ cᵢ / W` with `W = Σ wᵢ` is some point of the triangle. Its distance is `|v|/W` with
/// `v = Σ wᵢ (q − cᵢ)`. A component of `v` is a sum of three terms with at most four roundings each
/// (difference, product, two sums), so it is off by less than `2.01 ε Σ wᵢ |q − cᵢ|` along that axis; `S`
/// below is the sum of those sizes over the axes, itself low by at most `4.01 ε S`. The length, the quotient
/// and `W` together have less than 8 roundings of a relative `ε/2`. `3 ε S` and `8 ε` cover this with a
/// margin for second orders.
#[inline]
pub(crate) fn distance_up(q: [f64; 3], corners: &[[f64; 3]; 3]) -> f64 {
    if corners.contains(&q) {
        return 0.0;
    }
    let w = closest_on_triangle(q, *corners);
    let weight_sum = w[0] + w[1] + w[2];
    let (mut square, mut size) = (0.0, 0.0);
    for k in 0..3 {
        let [a, b, c] = [0, 1, 2].map(|i| w[i] * (q[k] - corners[i][k]));
        let sum = a + b + c;
        square += sum * sum;
        size += a.abs() + b.abs() + c.abs();
    }
    (square.sqrt() + 3.0 * EPS * size) / weight_sum * (1.0 + 8.0 * EPS) + UNDERFLOW
}

/// The distance between two points, bounded from above: seven roundings, of which the first is of a
/// difference.
#[inline]
pub(super) fn apart_up(a: [f64; 3], b: [f64; 3]) -> f64 {
    length_up(difference(a, b))
}

/// The length of a vector whose components are rounded at most once, bounded from above.
#[inline]
pub(super) fn length_up(v: [f64; 3]) -> f64 {
    length(v) * (1.0 + 4.0 * EPS) + UNDERFLOW
}
