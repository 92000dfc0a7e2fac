//! The nearest points of two straight segments.
use crate::math::{difference, dot, lesser};

/// Below this share of the product of squared lengths two segments count as parallel: then any point serves.
/// Chosen: callers need only one pair of nearest points, and any of them will do.
const PARALLEL: f64 = 1e-14;

#[inline]
fn clamp(x: f64, low: f64) -> f64 {
    if x > low { lesser(x, 1.0) } else { low }
}

/// The parameters of the nearest points of two segments, between 0 and 1 and rounded. The first parameter is
/// at least `lowest`.
#[inline]
pub(crate) fn closest_on_segments([u, v]: [[f64; 3]; 2], [a, b]: [[f64; 3]; 2], lowest: f64) -> [f64; 2] {
    let (along, across, from) = (difference(v, u), difference(b, a), difference(u, a));
    let (uu, ab, aa) = (dot(along, along), dot(along, across), dot(across, across));
    let (c, f) = (dot(along, from), dot(across, from));
    let determinant = uu * aa - ab * ab;
    let mut t = if uu <= 0.0 {
        lowest
    } else if aa <= 0.0 {
        clamp(-c / uu, lowest)
    } else if determinant > PARALLEL * uu * aa {
        clamp((ab * f - c * aa) / determinant, lowest)
    } else {
        0.5 * (lowest + 1.0)
    };
    let mut s = if aa > 0.0 { (ab * t + f) / aa } else { 0.0 };
    if !(0.0..=1.0).contains(&s) && uu > 0.0 {
        // The nearest point of the other line is beyond its segment: clamp to its end, and solve for the
        // first again.
        s = clamp(s, 0.0);
        t = clamp((ab * s - c) / uu, lowest);
    }
    s = if aa > 0.0 { clamp((ab * t + f) / aa, 0.0) } else { 0.0 };
    [t, s]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance_sq([p, q]: [[f64; 3]; 2], [a, b]: [[f64; 3]; 2], [t, s]: [f64; 2]) -> f64 {
        let offset: [f64; 3] = std::array::from_fn(|k| p[k] + t * (q[k] - p[k]) - a[k] - s * (b[k] - a[k]));
        dot(offset, offset)
    }

    #[test]
    fn no_pair_of_points_on_a_lattice_is_nearer() {
        let mut rng = chordal_testkit::Random::new(7);
        for _ in 0..2000 {
            let mut segment = || [(); 2].map(|()| rng.point());
            let (x, y) = (segment(), segment());
            let distance = distance_sq(x, y, closest_on_segments(x, y, 0.0));
            let steps = 0..=20;
            let pairs = steps.clone().flat_map(|i| steps.clone().map(move |j| [i, j]));
            let nearest = pairs
                .map(|pair| distance_sq(x, y, pair.map(|i| f64::from(i) / 20.0)))
                .fold(f64::INFINITY, lesser);
            assert!(distance <= nearest + 1e-12, "{x:?} {y:?}: {distance} {nearest}");
        }
    }

    #[test]
    fn parallel_and_vanishing_segments_have_parameters() {
        let (x, y) = ([[0.0; 3], [1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
        for [first, second] in [[x, y], [x, [y[0]; 2]], [[x[0]; 2], y], [[x[0]; 2], [y[0]; 2]]] {
            let parameters = closest_on_segments(first, second, 0.0);
            assert!((distance_sq(first, second, parameters) - 1.0).abs() < 1e-12, "{parameters:?}");
        }
    }
}
