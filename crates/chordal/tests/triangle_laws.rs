//! The laws of triangles and quads: sides, weights, areas, shapes, bends.
use chordal::Mesh;
use chordal::explicit::polygons::{Diagonal, Quad};
use chordal::explicit::{Attribute, Domain, Semantic, Triangle, corner_rows, interpolate};
use chordal::math::exact::PointInTriangle;
use chordal_testkit::Random;

fn triangle<const D: usize>(random: &mut Random) -> Triangle<D> {
    Triangle { corners: std::array::from_fn(|_| random.point_within(0.5)) }
}

fn mean<const D: usize>(corners: [[f64; D]; 3], w: [f64; 3]) -> [f64; D] {
    std::array::from_fn(|k| (0..3).map(|i| w[i] * corners[i][k]).sum())
}

fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| (a[k] - b[k]).abs()).sum()
}

#[test]
fn the_half_square_faces_up_and_two_swapped_corners_turn_it_over() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    assert_eq!(Triangle { corners }.normal(), Some([0.0, 0.0, 1.0]));
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let mut swapped = corners;
        swapped.swap(i, j);
        assert_eq!(Triangle { corners: swapped }.normal(), Some([0.0, 0.0, -1.0]));
    }
    let seed = 11;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for _ in 0..1000 {
        let triangle = triangle::<3>(&mut random);
        let [a, b, c] = triangle.corners;
        let other = Triangle { corners: [a, c, b] };
        assert_eq!(triangle.normal().map(|n| n.map(|x| -x)), other.normal());
        assert_eq!(triangle.area(), other.area());
        let flat = |p: [f64; 3]| [p[0], p[1]];
        let plane = Triangle { corners: [a, b, c].map(flat) };
        assert_eq!(plane.signed_area(), -Triangle { corners: [a, c, b].map(flat) }.signed_area());
    }
}

#[test]
fn a_segment_between_two_inside_points_stays_inside() {
    let seed = 12;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    // On a lattice the points of a segment are exact, and often on edges.
    let lattice = |random: &mut Random| [0, 1].map(|_| (random.unit() * 9.0).floor() * 8.0);
    let (mut pairs, mut on_edges) = (0, 0);
    for _ in 0..20_000 {
        let triangle = Triangle { corners: std::array::from_fn(|_| lattice(&mut random)) };
        let (p, q) = (lattice(&mut random), lattice(&mut random));
        if triangle.position(p) == PointInTriangle::Outside
            || triangle.position(q) == PointInTriangle::Outside
        {
            continue;
        }
        pairs += 1;
        for step in 0..=8 {
            let t = f64::from(step) / 8.0;
            let between = [0, 1].map(|k| p[k] + t * (q[k] - p[k]));
            let position = triangle.position(between);
            assert_ne!(position, PointInTriangle::Outside, "{triangle:?} {p:?} {q:?} {t}");
            on_edges += usize::from(position == PointInTriangle::Boundary);
            let edges = triangle.edge_functions(between);
            let agree = edges.iter().all(|e| *e >= 0.0) || edges.iter().all(|e| *e <= 0.0);
            assert!(agree, "{edges:?}");
            assert_eq!(edges.contains(&0.0), position == PointInTriangle::Boundary, "{edges:?}");
            assert_eq!(edges.iter().sum::<f64>(), 2.0 * triangle.signed_area());
        }
    }
    assert!(pairs > 300 && on_edges > 500, "{pairs} pairs, {on_edges} on edges: too few to judge");
}

#[test]
fn edge_functions_have_exact_signs_where_rounding_would_lose_them() {
    let triangle = Triangle { corners: [[0.1, 0.1], [0.3, 0.3], [0.0, 1.0]] };
    assert_eq!(triangle.edge_functions([0.2, 0.2])[2], 0.0);
    assert!(triangle.edge_functions([0.2, 0.2_f64.next_up()])[2] > 0.0);
    assert!(triangle.edge_functions([0.2, 0.2_f64.next_down()])[2] < 0.0);
    let tiny = Triangle { corners: [[0.0, 0.0], [1e-300, 0.0], [0.0, 1e-300]] };
    assert!(tiny.edge_functions([1e-301, 1e-301]).iter().all(|e| *e > 0.0));
    assert!(tiny.signed_area() > 0.0);
}

#[test]
fn weights_reproduce_the_point_and_add_up_to_one() {
    let seed = 13;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for round in 0..5000 {
        let scale = libm::ldexp(1.0, [0, -600, 600, 20, -20][round % 5]);
        let corners = triangle::<3>(&mut random).corners.map(|p| p.map(|x| x * scale));
        let triangle = Triangle { corners };
        let w = random.weights();
        let point = mean(corners, w);
        let found = triangle.barycentric(point).expect("random corners span an area");
        assert!((found[0] + found[1] + found[2] - 1.0).abs() <= 2.0 * f64::EPSILON);
        assert!(distance(mean(corners, found), point) <= 8.0 * f64::EPSILON * scale, "{triangle:?}");
        // The same above the plane.
        let normal = triangle.normal().expect("it has an area");
        let above = std::array::from_fn(|k| point[k] + scale * normal[k]);
        let over = triangle.barycentric(above).expect("it has an area");
        let height = triangle.height_of(above).expect("it has an area");
        assert!((height / scale - 1.0).abs() < 1e-14, "{height:e}");
        let thin = triangle.slenderness();
        assert!(distance(over, found) <= 1e-14 / (thin * thin), "{over:?} {found:?}");
        // In the plane.
        let flat = Triangle { corners: corners.map(|[x, y, _]| [x, y]) };
        let found = flat.barycentric([point[0], point[1]]).expect("it has an area");
        let back = mean(flat.corners, found);
        assert!(distance(back, [point[0], point[1]]) <= 8.0 * f64::EPSILON * scale);
    }
}

#[test]
fn weights_are_affine_also_outside() {
    let seed = 14;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for _ in 0..5000 {
        let triangle = triangle::<2>(&mut random);
        let (p, q) = (random.point_within::<2>(0.5), random.point_within::<2>(0.5));
        let t = random.unit();
        let between = [0, 1].map(|k| p[k] + t * (q[k] - p[k]));
        let [of_p, of_q, of_between] =
            [p, q, between].map(|x| triangle.barycentric(x).expect("random corners span an area"));
        let most = of_p.iter().chain(&of_q).fold(1.0_f64, |m, w| m.max(w.abs()));
        let reach = 1.0 / triangle.signed_area().abs();
        for k in 0..3 {
            let expected = of_p[k] + t * (of_q[k] - of_p[k]);
            assert!((of_between[k] - expected).abs() <= 4.0 * f64::EPSILON * (most + reach));
        }
    }
}

#[test]
fn weights_of_a_sliver_far_away_keep_their_digits() {
    // 1 : 2^26, at 2^20: plain arithmetic has no digit left of the third weight.
    let high = libm::ldexp(1.0, -26);
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.5, high]].map(|p: [f64; 2]| p.map(|x| x + 1_048_576.0));
    let point = [1_048_576.5, 1_048_576.0 + 0.25 * high];
    assert_eq!(Triangle { corners }.barycentric(point), Some([0.375, 0.375, 0.25]));
    let lifted = Triangle { corners: corners.map(|[x, y]| [x, y, x]) };
    assert_eq!(lifted.barycentric([point[0], point[1], point[0]]), Some([0.375, 0.375, 0.25]));
}

#[test]
fn corners_and_constants_are_interpolated_exactly() {
    let seed = 15;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for _ in 0..2000 {
        let triangle = triangle::<3>(&mut random);
        let rows: [[f64; 4]; 3] = std::array::from_fn(|_| random.point_within(0.5));
        let mut out = [0.0; 4];
        for k in 0..3 {
            let weights = triangle.barycentric(triangle.corners[k]).expect("it has an area");
            assert_eq!(weights, [0, 1, 2].map(|i| f64::from(u8::from(i == k))));
            interpolate([&rows[0], &rows[1], &rows[2]], weights, &mut out);
            assert_eq!(out, rows[k]);
        }
        let w = random.weights();
        interpolate([&rows[0]; 3], w, &mut out);
        assert_eq!(out, rows[0]);
        interpolate([&rows[0], &rows[1], &rows[2]], w, &mut out);
        assert!(distance(out, mean(rows, w)) <= 4.0 * f64::EPSILON);
    }
}

#[test]
fn rows_of_an_attribute_are_found_for_every_domain() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [2, 1, 3]]).expect("valid");
    let attribute = |domain, n: u32| Attribute {
        semantic: Semantic::Custom("x".to_owned()),
        domain,
        width: 1,
        values: (0..n).map(f64::from).collect(),
    };
    let rows = |domain, n| corner_rows(&mesh, &attribute(domain, n), 1).map(|row| row[0]);
    assert_eq!(rows(Domain::Vertex, 4), [2.0, 1.0, 3.0]);
    assert_eq!(rows(Domain::Corner, 6), [3.0, 4.0, 5.0]);
    assert_eq!(rows(Domain::Face, 2), [1.0; 3]);
}

#[test]
fn shape_measures_know_their_ends_and_no_scale() {
    let equilateral = Triangle { corners: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };
    assert!((equilateral.quality() - 1.0).abs() <= f64::EPSILON);
    assert!((equilateral.slenderness() - 0.75_f64.sqrt()).abs() <= f64::EPSILON);
    for corners in [[[2.0; 3]; 3], [[0.1; 3], [0.2; 3], [0.3; 3]]] {
        let line = Triangle { corners };
        assert_eq!((line.quality(), line.slenderness(), line.area()), (0.0, 0.0, 0.0));
        assert!(line.is_degenerate() && line.barycentric([0.0; 3]).is_none() && line.normal().is_none());
    }
    let needle = Triangle { corners: [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [100.0, 1.0, 0.0]] };
    assert!((needle.slenderness() - 100.0 / 10_001.0).abs() < 1e-16);
    let seed = 16;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for _ in 0..1000 {
        let triangle = triangle::<3>(&mut random);
        for exponent in [-700, -20, 20, 700] {
            let scale = libm::ldexp(1.0, exponent);
            let scaled = Triangle { corners: triangle.corners.map(|p| p.map(|x| x * scale)) };
            assert_eq!(scaled.quality(), triangle.quality());
            assert_eq!(scaled.slenderness(), triangle.slenderness());
        }
        let [a, b, c] = triangle.corners;
        assert!((Triangle { corners: [b, c, a] }.quality() - triangle.quality()).abs() < 1e-15);
        assert!((0.0..=1.0).contains(&triangle.quality()));
    }
}

#[test]
fn areas_of_thin_triangles_keep_their_digits() {
    // The third corner is one unit in the last place off the diagonal of the first two.
    let up = 1.5_f64.next_up();
    let thin = Triangle { corners: [[1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [1.5, up, 0.0]] };
    assert_eq!(thin.area(), 0.5 * (up - 1.5));
    assert!(!thin.is_degenerate());
}

#[test]
fn a_quad_bulges_by_the_height_of_its_fourth_corner() {
    let quad = |z: f64| Quad { corners: [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, z]] };
    assert_eq!(quad(0.0).bulge(), Some(0.0));
    assert_eq!(quad(0.25).bulge(), Some(0.25));
    assert_eq!(quad(-0.25).bulge(), Some(-0.25));
    assert_eq!(quad(0.0).warp(), Some(0.0));
    // The saddle: all corners half as far from the middle plane as the diagonals are apart.
    let saddle = Quad { corners: [[0.0, 0.0, 1.0], [1.0, 0.0, -1.0], [1.0, 1.0, 1.0], [0.0, 1.0, -1.0]] };
    assert!((saddle.warp().expect("it spans a plane") - 1.0).abs() <= f64::EPSILON);
    for turned in 1..4 {
        let mut corners = saddle.corners;
        corners.rotate_left(turned);
        let turned = Quad { corners };
        assert!((turned.warp().expect("it spans a plane") - 1.0).abs() <= f64::EPSILON);
        assert_eq!(turned.flattest(), Diagonal::First, "both bend alike");
    }
    assert_eq!(Quad { corners: [[1.0; 3]; 4] }.warp(), None);
}

#[test]
fn the_flattest_diagonal_bends_less_and_lies_inside_a_dart() {
    let seed = 17;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let mut seconds = 0;
    for _ in 0..5000 {
        let quad = Quad { corners: std::array::from_fn(|_| random.point_within(0.5)) };
        let [first, second] = quad.bends_rad().map(|bend| bend.expect("random corners span areas"));
        let expected = if second < first { Diagonal::Second } else { Diagonal::First };
        seconds += usize::from(expected == Diagonal::Second);
        assert_eq!(quad.flattest(), expected);
        // Another first corner turns the names around and nothing else.
        let [a, b, c, d] = quad.corners;
        let turned = Quad { corners: [b, c, d, a] };
        assert_ne!(turned.flattest(), expected);
    }
    assert!((1000..4000).contains(&seconds));
    let dart = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]];
    for start in 0..4 {
        let corners = std::array::from_fn(|k| dart[(k + start) % 4]);
        let expected = if start % 2 == 0 { Diagonal::First } else { Diagonal::Second };
        assert_eq!(Quad { corners }.flattest(), expected, "start {start}");
    }
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(Quad { corners: square }.flattest(), Diagonal::First);
}
