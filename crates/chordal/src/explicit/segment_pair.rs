//! The nearest points of two straight segments.
use crate::math::{difference, dot, lesser};

/// Below this share of the product of squared lengths two segments count as parallel: then any point does.
/// Chosen: what the points are used for holds for any of them.
const PARALLEL: f64 = 1e-14;

#[inline]
fn clamp(x: f64, least: f64) -> f64 {
    if x > least { lesser(x, 1.0) } else { least }
}

/// The parameters of the nearest points of two segments, between 0 and 1 and rounded, of which the first is not before
/// `least`.
#[inline]
pub(crate) fn closest_on_segments([u, v]: [[f64; 3]; 2], [a, b]: [[f64; 3]; 2], least: f64) -> [f64; 2] {
    let (along, across, from) = (difference(v, u), difference(b, a), difference(u, a));
    let (uu, ab, aa) = (dot(along, along), dot(along, across), dot(across, across));
    let (c, f) = (dot(along, from), dot(across, from));
    let whole = uu * aa - ab * ab;
    let mut t = if uu <= 0.0 {
        least
    } else if aa <= 0.0 {
        clamp(-c / uu, least)
    } else if whole > PARALLEL * uu * aa {
        clamp((ab * f - c * aa) / whole, least)
    } else {
        0.5 * (least + 1.0)
    };
    let mut s = if aa > 0.0 { (ab * t + f) / aa } else { 0.0 };
    if !(0.0..=1.0).contains(&s) && uu > 0.0 {
        // The end of the other segment is nearer.
        s = clamp(s, 0.0);
        t = clamp((ab * s - c) / uu, least);
    }
    s = if aa > 0.0 { clamp((ab * t + f) / aa, 0.0) } else { 0.0 };
    [t, s]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance_sq([p, q]: [[f64; 3]; 2], [a, b]: [[f64; 3]; 2], [t, s]: [f64; 2]) -> f64 {
        let off: [f64; 3] = std::array::from_fn(|k| p[k] + t * (q[k] - p[k]) - a[k] - s * (b[k] - a[k]));
        dot(off, off)
    }

    #[test]
    fn no_pair_of_points_on_a_lattice_is_nearer() {
        let mut rng = chordal_testkit::Random::new(7);
        for _ in 0..2000 {
            let mut segment = || [(); 2].map(|()| rng.point());
            let (x, y) = (segment(), segment());
            let found = distance_sq(x, y, closest_on_segments(x, y, 0.0));
            let steps = 0..=20;
            let pairs = steps.clone().flat_map(|i| steps.clone().map(move |j| [i, j]));
            let least = pairs
                .map(|pair| distance_sq(x, y, pair.map(|i| f64::from(i) / 20.0)))
                .fold(f64::INFINITY, lesser);
            assert!(found <= least + 1e-12, "{x:?} {y:?}: {found} {least}");
        }
    }

    #[test]
    fn parallel_and_vanishing_segments_have_parameters() {
        let (x, y) = ([[0.0; 3], [1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
        for [one, other] in [[x, y], [x, [y[0]; 2]], [[x[0]; 2], y], [[x[0]; 2], [y[0]; 2]]] {
            let found = closest_on_segments(one, other, 0.0);
            assert!((distance_sq(one, other, found) - 1.0).abs() < 1e-12, "{found:?}");
        }
    }
}
