//! The laws of points in polygons and of convex polygons, on lattices where the judge's own arithmetic is
//! exact.
use chordal::explicit::FillRule;
use chordal::explicit::polygons::{fan, is_convex, polygon_contains, winding_number};
use chordal::math::exact::PointInTriangle;
use chordal_testkit::Random;

fn cross(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn float(p: [i64; 2]) -> [f64; 2] {
    p.map(|x| x as f64)
}

/// By the sum of angles, in eighths of a turn: shares no idea with crossings of a ray.
fn winding_by_octants(ring: &[[i64; 2]], p: [i64; 2]) -> Option<i32> {
    let octant = |d: [i64; 2]| -> i32 {
        let (x, y) = (d[0], d[1]);
        match (x.signum(), y.signum()) {
            (1, 0) => 0,
            (1, 1) => 1,
            (0, 1) => 2,
            (-1, 1) => 3,
            (-1, 0) => 4,
            (-1, -1) => 5,
            (0, -1) => 6,
            _ => 7,
        }
    };
    let mut sum = 0;
    for i in 0..ring.len() {
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        let (da, db) = ([a[0] - p[0], a[1] - p[1]], [b[0] - p[0], b[1] - p[1]]);
        if da == [0, 0] || db == [0, 0] {
            return None;
        }
        let side = cross(p, a, b);
        if side == 0 && da[0] * db[0] + da[1] * db[1] < 0 {
            return None;
        }
        let mut step = (octant(db) - octant(da)).rem_euclid(8);
        // The shorter way round, which the side tells.
        if side < 0 && step > 0 {
            step -= 8;
        }
        sum += step;
    }
    Some(sum / 8)
}

#[test]
fn winding_numbers_are_those_of_the_angles_and_sides_are_the_boundary() {
    let seed = 3;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let (mut on, mut wound) = (0, 0);
    for _ in 0..60_000 {
        let n = 1 + random.below(8);
        let ring: Vec<[i64; 2]> = (0..n).map(|_| [0; 2].map(|_| random.below(7) as i64)).collect();
        let p = [0; 2].map(|_| random.below(7) as i64);
        let floats: Vec<[f64; 2]> = ring.iter().map(|q| float(*q)).collect();
        let expected = winding_by_octants(&ring, p);
        assert_eq!(winding_number(&floats, float(p)), expected, "{ring:?} {p:?}");
        let [nonzero, odd] =
            [FillRule::NonZero, FillRule::EvenOdd].map(|rule| polygon_contains(&[&floats], rule, float(p)));
        match expected {
            None => assert_eq!([nonzero, odd], [PointInTriangle::Boundary; 2]),
            Some(w) => {
                let position =
                    |inside| if inside { PointInTriangle::Inside } else { PointInTriangle::Outside };
                assert_eq!([nonzero, odd], [position(w != 0), position(w % 2 != 0)]);
            }
        }
        on += usize::from(expected.is_none());
        wound += usize::from(expected.is_some_and(|w| w.abs() > 1));
    }
    assert!(on > 1000 && wound > 50, "{on} on a side, {wound} wound around twice");
    assert_eq!(winding_number(&[], [0.0; 2]), None);
    assert_eq!(polygon_contains(&[[[0.0; 2]; 0]; 0], FillRule::NonZero, [0.0; 2]), PointInTriangle::Outside);
}

#[test]
fn sides_are_told_where_rounding_would_not() {
    let ring = [[0.1, 0.1], [0.3, 0.3], [0.0, 1.0]];
    assert_eq!(winding_number(&ring, [0.2, 0.2]), None);
    assert_eq!(winding_number(&ring, [0.2, 0.2_f64.next_up()]), Some(1));
    assert_eq!(winding_number(&ring, [0.2, 0.2_f64.next_down()]), Some(0));
}

#[test]
fn convex_means_that_every_corner_is_on_the_same_side_of_every_side() {
    let seed = 4;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let (mut convex, mut straight) = (0, 0);
    for round in 0..200_000 {
        let n = 3 + random.below(4);
        let size = [3, 4, 9][round % 3];
        let ring: Vec<[i64; 2]> = (0..n).map(|_| [0; 2].map(|_| random.below(size) as i64)).collect();
        // Once around: all corners weakly left of all sides, no corner twice, corners of one line in order.
        let holds = |ring: &[[i64; 2]]| {
            let side = |i: usize| [ring[i], ring[(i + 1) % n]];
            let all = (0..n).all(|i| ring.iter().all(|p| cross(side(i)[0], side(i)[1], *p) >= 0));
            let differ = (0..n).all(|i| (0..i).all(|j| ring[i] != ring[j]));
            let area: i64 = (0..n).map(|i| cross([0, 0], ring[i], ring[(i + 1) % n])).sum();
            let onwards = (0..n).all(|i| {
                let (a, b, c) = (ring[i], ring[(i + 1) % n], ring[(i + 2) % n]);
                cross(a, b, c) != 0 || (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) > 0
            });
            all && differ && area > 0 && onwards
        };
        let backwards: Vec<[i64; 2]> = ring.iter().rev().copied().collect();
        let expected = holds(&ring) || holds(&backwards);
        let floats: Vec<[f64; 2]> = ring.iter().map(|q| float(*q)).collect();
        assert_eq!(is_convex(&floats), expected, "{ring:?}");
        convex += usize::from(expected);
        straight += usize::from(
            expected && (0..n).any(|i| cross(ring[i], ring[(i + 1) % n], ring[(i + 2) % n]) == 0),
        );
    }
    assert!(convex > 1000 && straight > 100, "{convex} convex, {straight} with a straight corner");
    // Twice around a pentagon as a star: every turn to the left, and not convex.
    let star: Vec<[f64; 2]> = (0..5)
        .map(|i| libm::sincos(std::f64::consts::TAU * f64::from(2 * i) / 5.0))
        .map(|(sin, cos)| [cos, sin])
        .collect();
    assert!(!is_convex(&star));
    assert!((0..3).all(|n| !is_convex(&star[..n])));
}

#[test]
fn a_fan_of_a_convex_polygon_has_its_area() {
    let ring: Vec<[f64; 2]> = (0..40).map(|i| [f64::from(i), f64::from(i * i)]).collect();
    assert!(is_convex(&ring));
    let area2 = |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let triangles = fan(40);
    assert_eq!(triangles.len(), 38);
    let doubled: Vec<f64> = triangles.iter().map(|t| area2(t.map(|i| ring[i as usize]))).collect();
    assert!(doubled.iter().all(|a| *a > 0.0));
    let shoelace: f64 =
        (0..40).map(|i| (ring[i], ring[(i + 1) % 40])).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
    assert_eq!(doubled.iter().sum::<f64>(), shoelace);
    assert!(fan(2).is_empty() && fan(0).is_empty());
}
