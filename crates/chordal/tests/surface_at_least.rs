//! The lower bound on a distance, against squared distances in whole fractions without any rounding.
use chordal::Mesh;
use chordal::check::surface_at_least;
use chordal_testkit::Random;
use dashu_float::FBig;

/// A vector of numbers without rounding.
type Exact = [FBig; 3];

/// A squared length as numerator and positive denominator.
type Square = (FBig, FBig);

fn exact(x: f64) -> FBig {
    FBig::try_from(x).expect("finite").with_precision(0).value()
}

fn minus(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|k| &a[k] - &b[k])
}

fn dot(a: &Exact, b: &Exact) -> FBig {
    &(&a[0] * &b[0]) + &(&(&a[1] * &b[1]) + &(&a[2] * &b[2]))
}

fn cross(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &(&a[i] * &b[j]) - &(&a[j] * &b[i])
    })
}

fn smaller(a: Square, b: Square) -> Square {
    if &a.0 * &b.1 <= &b.0 * &a.1 { a } else { b }
}

/// From a point to the segment from `a` to `b`.
fn to_segment(p: &Exact, a: &Exact, b: &Exact) -> Square {
    let (w, e) = (minus(p, a), minus(b, a));
    let (foot, length_sq) = (dot(&w, &e), dot(&e, &e));
    if foot <= exact(0.0) {
        (dot(&w, &w), exact(1.0))
    } else if foot >= length_sq {
        let w = minus(p, b);
        (dot(&w, &w), exact(1.0))
    } else {
        (&(&dot(&w, &w) * &length_sq) - &(&foot * &foot), length_sq)
    }
}

/// From a point to a triangle, exactly: the nearest of the three sides and, where the foot on the plane is
/// inside all three sides, the plane.
fn to_triangle(p: [f64; 3], corners: [[f64; 3]; 3]) -> Square {
    let p = p.map(exact);
    let [a, b, c] = corners.map(|v| v.map(exact));
    let sides = [(&a, &b), (&b, &c), (&c, &a)];
    let [ab, bc, ca] = sides.map(|(from, to)| to_segment(&p, from, to));
    let nearest = smaller(smaller(ab, bc), ca);
    let n = cross(&minus(&b, &a), &minus(&c, &a));
    let area_sq = dot(&n, &n);
    let is_inside =
        |(from, to): (&Exact, &Exact)| dot(&cross(&minus(to, from), &minus(&p, from)), &n) >= exact(0.0);
    if area_sq == exact(0.0) || !sides.into_iter().all(is_inside) {
        return nearest;
    }
    let height = dot(&minus(&p, &a), &n);
    smaller(nearest, (&height * &height, area_sq))
}

/// Whether `length² ≤ square`.
fn is_at_most(length: f64, square: &Square) -> bool {
    let length = exact(length);
    &(&length * &length) * &square.1 <= square.0
}

/// `a + s·(b − a)`.
fn toward(a: [f64; 3], b: [f64; 3], s: f64) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + s * (b[k] - a[k]))
}

fn moved(a: [f64; 3], by: [f64; 3], s: f64) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + s * by[k])
}

/// Sound triangles, needles, caps, and those without area.
fn random_triangle(random: &mut Random) -> [[f64; 3]; 3] {
    let [a, b, c] = std::array::from_fn(|_| random.point());
    let thin = random.power(-17.0, -1.0);
    match (random.unit() * 6.0) as u32 {
        0 => [a, b, moved(a, c, thin)],
        1 => [a, b, moved(toward(a, b, random.unit()), c, thin)],
        2 => [a, b, toward(a, b, 0.5)],
        3 => [a, b, b],
        _ => [a, b, c],
    }
}

/// A point off a corner, a side or the inside of a triangle, near or far.
fn random_point(random: &mut Random, [a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let foot = match (random.unit() * 4.0) as u32 {
        0 => b,
        1 => toward(a, b, random.unit()),
        _ => toward(toward(a, b, random.unit()), c, random.unit()),
    };
    let away = random.point();
    moved(foot, away, random.power(-18.0, 1.0))
}

fn bound(p: [f64; 3], corners: [[f64; 3]; 3]) -> f64 {
    let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    surface_at_least(&[p], &mesh).unwrap().0
}

#[test]
fn is_never_above_the_distance_whatever_the_triangle_scale_and_place() {
    let mut positive = 0;
    for seed in 0..30_000 {
        let mut random = Random::new(seed);
        let triangle = random_triangle(&mut random);
        let point = random_point(&mut random, triangle);
        let exponent = [0, -6, 6, -300, 290, -155, 153][seed as usize % 7];
        let scale = 10_f64.powi(exponent);
        let shift = if seed % 5 == 0 { random.power(0.0, 9.0) } else { 0.0 };
        let place = |p: [f64; 3]| p.map(|x| (x + shift) * scale);
        let (point, triangle) = (place(point), triangle.map(place));
        let least = bound(point, triangle);
        let square = to_triangle(point, triangle);
        assert!(least >= 0.0 && is_at_most(least, &square), "seed {seed}: {least} at {point:?} {triangle:?}");
        positive += u32::from(least > 0.0);
    }
    assert!(positive > 20_000, "only {positive} bounds above zero say something");
}

#[test]
fn the_check_itself_notices_a_bound_too_high_by_one_part_in_ten_thousand_billion() {
    let (triangle, point) = ([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [0.25, 0.25, 0.5]);
    let square = to_triangle(point, triangle);
    assert!(is_at_most(0.5, &square) && !is_at_most(0.5 * (1.0 + 1e-13), &square));
}

#[test]
fn is_tight_to_twelve_digits_for_triangles_and_distances_of_one_size() {
    for seed in 0..20_000 {
        let mut random = Random::new(seed);
        let triangle: [[f64; 3]; 3] = std::array::from_fn(|_| random.point());
        let sides =
            [0, 1, 2].map(|k| glam::DVec3::from(triangle[(k + 1) % 3]) - glam::DVec3::from(triangle[k]));
        let longest = sides.iter().map(|s| s.length()).fold(0.0, f64::max);
        if sides[0].cross(sides[1]).length() < 0.02 * longest * longest {
            continue;
        }
        let foot = toward(toward(triangle[0], triangle[1], random.unit()), triangle[2], random.unit());
        let away = random.point();
        let point = moved(foot, away, random.power(-2.0, 1.0));
        let square = to_triangle(point, triangle);
        if is_at_most(0.005, &square) {
            let scale = 10_f64.powi([0, -6, 6][seed as usize % 3]);
            let (point, triangle) = (point.map(|x| x * scale), triangle.map(|p| p.map(|x| x * scale)));
            let (least, square) = (bound(point, triangle), to_triangle(point, triangle));
            assert!(!is_at_most(least * (1.0 + 1e-12), &square), "seed {seed}: {least} is loose");
        }
    }
}

#[test]
fn over_a_mesh_it_is_the_farthest_point_from_its_nearest_triangle() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        // Several chunks of triangles, in an order with and without neighbourhood.
        let n = 40 + (random.unit() * 300.0) as usize;
        let spread = if seed % 2 == 0 { 0.1 } else { 1.0 };
        let mut corners = Vec::new();
        for i in 0..n {
            let centre = [i as f64 / n as f64, random.unit(), random.unit()];
            corners.extend(
                (0..3).map(|_| moved(centre, random.point(), 0.1)).map(|p| [p[0] * spread, p[1], p[2]]),
            );
        }
        let faces: Vec<[u32; 3]> = (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = Mesh::new(corners, faces).unwrap();
        let points: Vec<[f64; 3]> = (0..5).map(|_| random.point()).collect();
        let nearest = |p: [f64; 3]| (0..n).map(|f| to_triangle(p, mesh.corners(f))).reduce(smaller).unwrap();
        let squares: Vec<Square> = points.iter().map(|&p| nearest(p)).collect();
        let (least, number) = surface_at_least(&points, &mesh).unwrap();
        assert!(is_at_most(least, &squares[number]), "seed {seed}: above the distance of its own point");
        for square in &squares {
            assert!(
                !is_at_most(least * (1.0 + 1e-11) + 1e-300, square),
                "seed {seed}: another point is farther"
            );
        }
    }
}

#[test]
fn nothing_to_measure_gives_nothing_and_a_bad_point_no_claim() {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = Mesh::new(corners.clone(), vec![[0, 1, 2]]).unwrap();
    assert_eq!(surface_at_least(&[], &mesh), None);
    assert_eq!(surface_at_least(&[[1.0; 3]], &Mesh::new(corners, Vec::new()).unwrap()), None);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(surface_at_least(&[[bad, 0.0, 0.0], [0.0, bad, bad]], &mesh), Some((0.0, 0)));
    }
    assert_eq!(surface_at_least(&[[0.25, 0.25, 0.0]], &mesh), Some((0.0, 0)));
    // Differences beyond the range of f64: no claim.
    let huge = Mesh::new(vec![[f64::MAX; 3], [-f64::MAX; 3], [1.0; 3]], vec![[0, 1, 2]]).unwrap();
    assert_eq!(surface_at_least(&[[-f64::MAX, f64::MAX, 0.0]], &huge), Some((0.0, 0)));
}

#[cfg(feature = "threads")]
#[test]
fn one_thread_and_many_bound_the_same() {
    let mut random = Random::new(5);
    let corners: Vec<[f64; 3]> = (0..90_000).map(|_| random.point()).collect();
    let mesh = Mesh::new(corners, (0..30_000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap();
    let points: Vec<[f64; 3]> = (0..16).map(|_| random.point()).collect();
    let on = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| surface_at_least(&points, &mesh))
    };
    assert_eq!(on(1), on(3));
}
