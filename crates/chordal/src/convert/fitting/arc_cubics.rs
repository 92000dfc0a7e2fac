//! Approximates an arc of an ellipse by cubics.
//!
//! An ellipse is an affine image of the unit circle, and its cubics are images of the circle's. An arc of the circle of
//! `θ ≤ π/2` and the cubic with its ends, its end directions and handles of `4/3·tan(θ/4)` touch at the ends and in the
//! middle; elsewhere the cubic is outside, by at most `2/27·sin⁶(θ/4)/cos²(θ/4)`. Points in the same direction from the
//! centre are paired, which covers both curves, and the distance of their images is at most that times the longest
//! half-axis.
//!
//! *Rounding.* Points have errors of `16·ε·R` in each coordinate, and handles smaller ones: they are at most 0.7 of the
//! angle times `|φ||w| + |v|`, with an error of `4·ε` of that ([`super::super::curves::chord`]). The `1024·ε·R` for a
//! chord's roundings cover it.
//!
//! Source: M. Goldapp, *Approximation of circular arcs by cubic polynomials*, 1991.
use crate::explicit::{Arc, Bezier};
use crate::math::{dot, greater};

/// The largest distance of the cubic of an arc from the unit circle, rounded up.
fn unit_circle_error(turn_rad: f64) -> f64 {
    let (sin, cos) = libm::sincos(turn_rad / 4.0);
    let cube = sin * sin * sin;
    // Nine roundings of half a step, and two functions of one each.
    2.0 / 27.0 * (cube * cube) / (cos * cos) * (1.0 + 16.0 * f64::EPSILON)
}

/// An upper bound of the longest half-axis of the ellipse with these conjugate half-axes: the larger singular value.
fn longest_axis<const D: usize>(u: [f64; D], v: [f64; D]) -> f64 {
    let size = u.iter().chain(&v).fold(0.0, |size: f64, x| greater(size, x.abs()));
    if size == 0.0 {
        return 0.0;
    }
    let [u, v] = [u, v].map(|axis| axis.map(|x| x / size));
    let (a, b, c) = (dot(u, u), dot(u, v), dot(v, v));
    let half = 0.5 * (a - c);
    // Sums of squares up to 2D: less than 16 roundings.
    size * (0.5 * (a + c) + (half * half + b * b).sqrt()).sqrt() * (1.0 + 16.0 * f64::EPSILON)
}

/// The number of equal cubics that are within a length of an arc, as a float since it may be huge; and their distance,
/// without rounding.
pub(crate) fn count<const D: usize>(arc: &Arc<D>, length: f64) -> (f64, f64) {
    let turn = arc.sweep_rad().abs();
    let part = arc.part_about_middle(0.5, 0.5);
    let radius = longest_axis(part.to_middle, part.along);
    let error = |n: f64| radius * unit_circle_error(turn / n);
    let least = greater(1.0, (turn / std::f64::consts::FRAC_PI_2).ceil());
    // sin(θ/4) < θ/4 and cos²(θ/4) > 0.85.
    let enough = 0.25 * turn * libm::cbrt((2.0 / 27.0 / 0.85 * radius / length).sqrt());
    let mut n = greater(least, (enough - 1.0).floor());
    while error(n) > length && n < enough + 4.0 {
        n += 1.0;
    }
    (n, error(n))
}

/// An arc as `n` equal cubics.
pub(crate) fn cubics<const D: usize>(arc: &Arc<D>, n: usize) -> Vec<Bezier<D>> {
    // With this length the middle of each cubic is on the arc, too.
    let handle = 4.0 / 3.0 * libm::tan(arc.sweep_rad().abs() / n as f64 / 4.0);
    let joint = |i: usize| {
        let t = i as f64 / n as f64;
        (arc.at(t), arc.part_about_middle(t, t).along)
    };
    let mut from = joint(0);
    (1..=n)
        .map(|i| {
            let to = joint(i);
            let ((a, u), (b, v)) = (from, to);
            from = to;
            let start = std::array::from_fn(|k| a[k] + handle * u[k]);
            let end = std::array::from_fn(|k| b[k] - handle * v[k]);
            Bezier { control: [a, start, end, b] }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::length;

    #[test]
    fn the_formula_is_the_largest_distance() {
        for turn in [0.2, 1.0, std::f64::consts::FRAC_PI_2] {
            let arc = Arc::new([0.0; 2], [[1.0, 0.0], [0.0, 1.0]], 0.3, turn).unwrap();
            let cubic = cubics(&arc, 1)[0];
            let far = (0..=2000).map(|i| length(cubic.at(f64::from(i) / 2000.0)) - 1.0);
            let most = far.fold(0.0, |most: f64, x| greater(most, x.abs()));
            let formula = unit_circle_error(turn);
            assert!(most <= formula + 1e-15 && most > formula * 0.999 - 1e-15, "{turn}: {most} {formula}");
        }
    }

    #[test]
    fn a_circle_takes_four_at_273_millionths() {
        let circle = Arc::new([0.0; 2], [[1.0, 0.0], [0.0, 1.0]], 0.0, std::f64::consts::TAU).unwrap();
        assert_eq!(count(&circle, 2.73e-4).0, 4.0);
        assert_eq!(count(&circle, 2.72e-4).0, 5.0);
        // A sixty-fourth of the length for twice as many.
        assert_eq!((count(&circle, 4.25e-6).0, count(&circle, 4.25e-6 / 64.0).0), (8.0, 16.0));
        assert!((longest_axis([3.0, 0.0], [0.0, 2.0]) - 3.0).abs() < 1e-13);
    }
}
