//! Integer lattice points: exact predicates in some nanoseconds if coordinates have few digits.
use crate::math::{Orientation, greater, lesser};

/// A point with integer coordinates below 2⁶⁰.
pub(super) type LatticePoint = [i64; 3];

/// Bits that coordinates may span: differences then have 61, their products 122 and sums of two 123.
const SPAN: i32 = 60;

/// The points as integer multiples of one power of two; `None` if they span more than [`SPAN`] bits. A
/// common factor does not change orientations.
#[inline]
pub(super) fn on_lattice<const N: usize>(points: [[f64; 3]; N]) -> Option<[LatticePoint; N]> {
    let (mut low, mut high) = (i32::MAX, i32::MIN);
    for x in points.as_flattened().iter().filter(|x| **x != 0.0) {
        let (mantissa, exponent) = decompose(*x);
        let lowest = exponent + mantissa.trailing_zeros() as i32;
        let highest = exponent + 64 - mantissa.leading_zeros() as i32;
        low = lesser(lowest, low);
        high = greater(highest, high);
    }
    // If all coordinates are 0, `low` is still the largest integer.
    if high > low.saturating_add(SPAN) {
        return None;
    }
    // A loop, because `map` of nested arrays is not always inlined.
    let mut on = [[0; 3]; N];
    for (x, on) in points.as_flattened().iter().zip(on.as_flattened_mut()) {
        if *x != 0.0 {
            let (mantissa, exponent) = decompose(*x);
            let shift = exponent - low;
            // To the right only zeros are lost: `low` is the lowest bit that is set in any
            // coordinate.
            let size = if shift >= 0 { mantissa << shift } else { mantissa >> -shift } as i64;
            *on = if *x < 0.0 { -size } else { size };
        }
    }
    Some(on)
}

/// The absolute value of a finite number as an integer times a power of two.
#[inline]
fn decompose(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let (fraction, exponent) = (bits & ((1 << 52) - 1), (bits >> 52 & 0x7ff) as i32);
    if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
}

/// The side of the plane through three points on which the last one lies, as [`crate::math::orient3d`].
#[inline]
pub(super) fn lattice_orient3d([a, b, c]: [LatticePoint; 3], d: LatticePoint) -> Orientation {
    let from_a = |p: LatticePoint| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (u, v, w) = (from_a(b), from_a(c), from_a(d));
    let product = |x: i64, y: i64| i128::from(x) * i128::from(y);
    // The normal has 123 bits and w 61: their products are summed in two parts of 64 bits and more.
    let (mut upper, mut lower) = (0_i128, 0_i128);
    for (i, j, k) in [(1, 2, 0), (2, 0, 1), (0, 1, 2)] {
        let normal = product(u[i], v[j]) - product(u[j], v[i]);
        upper += (normal >> 64) * i128::from(w[k]);
        lower += i128::from(normal as u64) * i128::from(w[k]);
    }
    upper += lower >> 64;
    sign(if upper == 0 { i128::from(lower as u64) } else { upper })
}

/// The side of the line through two points on which the last one lies, projected along an axis, as
/// [`crate::math::orient2d`].
#[inline]
pub(super) fn lattice_orient2d([a, b, c]: [LatticePoint; 3], (x, y): (usize, usize)) -> Orientation {
    let product = |p: i64, q: i64| i128::from(p) * i128::from(q);
    sign(product(b[x] - a[x], c[y] - a[y]) - product(b[y] - a[y], c[x] - a[x]))
}

#[inline]
fn sign(x: i128) -> Orientation {
    match x.signum() {
        1 => Orientation::Front,
        -1 => Orientation::Back,
        _ => Orientation::Flat,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{orient2d, orient3d};
    use chordal_testkit::Random;

    #[test]
    fn sides_are_those_of_the_exact_predicates() {
        let mut random = Random::new(11);
        let (mut flat, mut fits) = (0, 0);
        for round in 0..60_000 {
            let bits = [2, 10, 30, 44][round % 4];
            let scale = libm::ldexp(1.0, [-1074, -500, -3, 0, 40, 900][round % 6]);
            let whole: [[i64; 3]; 4] =
                std::array::from_fn(|_| [0; 3].map(|_| random.below(2 << bits) as i64 - (1 << bits)));
            let mut points = whole.map(|p| p.map(|x| x as f64 * scale));
            if round % 3 == 0 {
                // Nearly or exactly in the plane of the others.
                points[3] = std::array::from_fn(|k| points[1][k] + points[2][k] - points[0][k]);
            }
            let Some(on) = on_lattice(points) else { continue };
            fits += 1;
            let [a, b, c, d] = points;
            let expected = orient3d(a, b, c, d);
            assert_eq!(lattice_orient3d([on[0], on[1], on[2]], on[3]), expected, "{points:?}");
            flat += i32::from(expected == Orientation::Flat);
            for (x, y) in [(0, 1), (1, 2), (2, 0)] {
                let seen = |p: [f64; 3]| [p[x], p[y]];
                assert_eq!(
                    lattice_orient2d([on[0], on[1], on[2]], (x, y)),
                    orient2d(seen(a), seen(b), seen(c))
                );
            }
        }
        assert!(flat > 10_000 && fits > 50_000, "{flat} flat, {fits} on a lattice");
    }

    #[test]
    fn the_widest_lattice_holds_and_one_bit_more_is_refused() {
        let most = libm::ldexp(1.0, 60) - libm::ldexp(1.0, 7);
        let corners = [[most, most, -most], [-most, most, most], [most, -most, most], [-most, -most, -most]];
        let points = [corners[0], corners[1], corners[2], corners[3], [1.0, 0.0, 0.0]];
        let on = on_lattice(points).expect("60 bits");
        let expected = orient3d(corners[0], corners[1], corners[2], corners[3]);
        assert_eq!(lattice_orient3d([on[0], on[1], on[2]], on[3]), expected);
        assert_eq!(lattice_orient3d([on[0], on[2], on[1]], on[3]), expected.flipped());
        assert_eq!(on_lattice([[most, 0.5, 0.0]]), None);
        assert_eq!(on_lattice([[0.0; 3]]), Some([[0; 3]]));
    }
}
