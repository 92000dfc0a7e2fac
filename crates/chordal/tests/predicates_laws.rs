//! Laws of the predicates: the sign of exact arithmetic, always.
use crate::exact;
use chordal::math::exact::{Orientation, PointInTriangle, orient2d, orient3d, triangle_contains};
use dashu_float::FBig;
use exact::{cases, exact, number};
use proptest::prelude::*;

fn side(determinant: &FBig) -> Orientation {
    match determinant.partial_cmp(&exact(0.0)) {
        Some(std::cmp::Ordering::Greater) => Orientation::Front,
        Some(std::cmp::Ordering::Less) => Orientation::Back,
        _ => Orientation::Flat,
    }
}

fn exact2d([a, b, c]: [[f64; 2]; 3]) -> Orientation {
    let from_a = |p: [f64; 2], k: usize| exact(p[k]) - exact(a[k]);
    side(&(from_a(b, 0) * from_a(c, 1) - from_a(b, 1) * from_a(c, 0)))
}

fn exact3d([a, b, c, d]: [[f64; 3]; 4]) -> Orientation {
    let row = |p: [f64; 3]| -> [FBig; 3] { std::array::from_fn(|k| exact(p[k]) - exact(a[k])) };
    let (u, v, w) = (row(b), row(c), row(d));
    let minor = |i: usize, j: usize| &u[i] * &v[j] - &u[j] * &v[i];
    side(&(minor(1, 2) * &w[0] + minor(2, 0) * &w[1] + minor(0, 1) * &w[2]))
}

/// One number up or down by a few steps.
fn nudged(x: f64, steps: i8) -> f64 {
    (0..steps.unsigned_abs()).fold(x, |x, _| if steps < 0 { x.next_down() } else { x.next_up() })
}

/// Points of a line, moved by a few steps in the last place: rounding alone decides where.
fn nearly_in_line() -> impl Strategy<Value = [[f64; 2]; 3]> {
    let steps = prop::array::uniform6(-2..3_i8);
    ([-1.0..1.0, -1.0..1.0], [-1.0..1.0, -1.0..1.0], -4.0..4.0, steps, -220..220_i32).prop_map(
        |(a, b, t, steps, exponent)| {
            let scale = 2_f64.powi(exponent);
            let c: [f64; 2] = std::array::from_fn(|k| a[k] + t * (b[k] - a[k]));
            let mut steps = steps.into_iter();
            [a, b, c].map(|p| p.map(|x| scale * nudged(x, steps.next().unwrap_or(0))))
        },
    )
}

/// Points of a plane, moved likewise.
fn nearly_in_plane() -> impl Strategy<Value = [[f64; 3]; 4]> {
    let point = || [-1.0..1.0, -1.0..1.0, -1.0..1.0];
    let steps = prop::collection::vec(-2..3_i8, 12);
    (point(), point(), point(), [-3.0..3.0, -3.0..3.0], steps, -220..220_i32).prop_map(
        |(a, b, c, [s, t], steps, exponent)| {
            let scale = 2_f64.powi(exponent);
            let d: [f64; 3] = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
            let mut steps = steps.into_iter();
            [a, b, c, d].map(|p| p.map(|x| scale * nudged(x, steps.next().unwrap_or(0))))
        },
    )
}

/// Points of a coarse lattice, of which many are exactly in line or plane.
fn lattice<const D: usize, const N: usize>() -> impl Strategy<Value = [[f64; D]; N]> {
    let numbers = prop::collection::vec(-3..4_i32, D * N);
    (numbers, prop::sample::select(vec![1.0, 0.1, 5e-324, 1e-300, 1e300])).prop_map(|(n, scale)| {
        std::array::from_fn(|i| std::array::from_fn(|k| f64::from(n[D * i + k]) * scale))
    })
}

fn any_points<const D: usize, const N: usize>() -> impl Strategy<Value = [[f64; D]; N]> {
    prop::collection::vec(number(), D * N)
        .prop_map(|n| std::array::from_fn(|i| std::array::from_fn(|k| n[D * i + k])))
}

proptest! {
    #![proptest_config(cases(8000))]

    #[test]
    fn orient2d_is_exact(points in prop_oneof![nearly_in_line(), lattice(), any_points()]) {
        let [a, b, c] = points;
        let side = orient2d(a, b, c);
        prop_assert_eq!(side, exact2d(points));
        prop_assert_eq!(orient2d(b, c, a), side);
        prop_assert_eq!(orient2d(b, a, c), side.flipped());
    }

    #[test]
    fn orient3d_is_exact(points in prop_oneof![nearly_in_plane(), lattice(), any_points()]) {
        let [a, b, c, d] = points;
        let side = orient3d(a, b, c, d);
        prop_assert_eq!(side, exact3d(points));
        prop_assert_eq!(orient3d(b, c, a, d), side);
        prop_assert_eq!(orient3d(b, a, c, d), side.flipped());
        prop_assert_eq!(orient3d(a, b, d, c), side.flipped());
    }

    #[test]
    fn a_point_is_in_a_triangle_as_in_all_its_permutations(
        points in prop_oneof![nearly_in_line(), lattice(), any_points()],
        weights in prop::array::uniform3(0..4_u8),
        stray in [number(), number()],
    ) {
        let [a, b, c] = points;
        let blend = |k: usize| {
            let sum = f64::from(weights.iter().sum::<u8>()).max(1.0);
            (0..3).map(|i| f64::from(weights[i]) / sum * points[i][k]).sum::<f64>()
        };
        for point in [a, b, c, stray, [blend(0), blend(1)]] {
            let position = triangle_contains(points, point);
            for other in [[b, c, a], [c, a, b], [b, a, c], [a, c, b], [c, b, a]] {
                prop_assert_eq!(triangle_contains(other, point), position);
            }
            prop_assert!(position == PointInTriangle::Outside || inside_box(points, point));
        }
        prop_assert_eq!(triangle_contains(points, a), PointInTriangle::Boundary);
    }
}

fn inside_box(points: [[f64; 2]; 3], p: [f64; 2]) -> bool {
    (0..2).all(|k| points.iter().any(|q| q[k] <= p[k]) && points.iter().any(|q| q[k] >= p[k]))
}

#[test]
fn a_lattice_is_sorted_into_inside_boundary_and_outside() {
    let triangle = [[0.0, 0.0], [6.0, 0.0], [0.0, 6.0]];
    let mut count = [0; 3];
    for (x, y) in (-1..8).flat_map(|x| (-1..8).map(move |y| (x, y))) {
        let expected = if x < 0 || y < 0 || x + y > 6 {
            PointInTriangle::Outside
        } else if x == 0 || y == 0 || x + y == 6 {
            PointInTriangle::Boundary
        } else {
            PointInTriangle::Inside
        };
        assert_eq!(triangle_contains(triangle, [f64::from(x), f64::from(y)]), expected, "{x} {y}");
        count[expected as usize] += 1;
    }
    assert_eq!(count, [10, 18, 53]);
}

#[test]
fn a_triangle_without_area_is_its_own_boundary() {
    let flat = [[0.0, 0.0], [4.0, 2.0], [2.0, 1.0]];
    assert_eq!(triangle_contains(flat, [3.0, 1.5]), PointInTriangle::Boundary);
    assert_eq!(triangle_contains(flat, [6.0, 3.0]), PointInTriangle::Outside);
    assert_eq!(triangle_contains(flat, [3.0, 1.4]), PointInTriangle::Outside);
    assert_eq!(triangle_contains([[1.0, 1.0]; 3], [1.0, 1.0]), PointInTriangle::Boundary);
    assert_eq!(triangle_contains([[1.0, 1.0]; 3], [1.0, 2.0]), PointInTriangle::Outside);
}

#[test]
fn both_ends_of_the_range_of_expansions_are_exact() {
    for exponent in [-401, -400, -399, 498, 499, 500, 501] {
        let s = 2_f64.powi(exponent);
        let points = [[s, s], [s * 1.5, s * (1.5 + f64::EPSILON)], [s * 1.75, s * (1.75 + f64::EPSILON)]];
        assert_eq!(orient2d(points[0], points[1], points[2]), exact2d(points), "{exponent}");
    }
    for exponent in [-251, -250, -249, 298, 299, 300, 301] {
        let s = 2_f64.powi(exponent);
        let e = f64::EPSILON;
        let points = [[s, s, s], [s * 1.5, s, s], [s, s * 1.5, s], [s * 1.25, s * 1.25, s * (1.0 + e)]];
        assert_eq!(orient3d(points[0], points[1], points[2], points[3]), exact3d(points), "{exponent}");
    }
}

#[test]
fn what_is_not_finite_has_no_side() {
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(orient2d([0.0, 0.0], [1.0, 0.0], [0.0, bad]), Orientation::Flat);
        assert_eq!(orient3d([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, bad]), Orientation::Flat);
    }
}
