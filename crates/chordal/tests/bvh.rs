//! Laws of `explicit::query::Bvh`: what it returns is what a plain loop over all triangles finds, its bounds
//! hold in exact arithmetic, and rays find no gap in a closed mesh.
use chordal::explicit::query::{Bvh, Hit, MeshClosestPoint, Ray};
use chordal::{Job, Mesh};
use chordal_testkit::Random;
use dashu_float::FBig;

fn mix(points: [[f64; 3]; 3], w: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| w[0] * points[0][k] + w[1] * points[1][k] + w[2] * points[2][k])
}

fn tree(mesh: &Mesh) -> Bvh {
    Bvh::build(mesh, &Job::default()).expect("small enough")
}

/// The plain loop: every triangle in a tree of its own, which has nothing to leave out.
struct Loop(Vec<Bvh>);

impl Loop {
    fn over(mesh: &Mesh) -> Self {
        let single = |f: usize| Mesh::new(mesh.corners(f).to_vec(), vec![[0, 1, 2]]).expect("finite");
        Self((0..mesh.faces().len()).map(|f| tree(&single(f))).collect())
    }

    fn closest(&self, p: [f64; 3]) -> Option<MeshClosestPoint> {
        let all = self.0.iter().enumerate();
        let found =
            all.map(|(face, t)| MeshClosestPoint { face: face as u32, ..t.closest_point(p).expect("one") });
        found.reduce(|a, b| if b.distance_sq < a.distance_sq { b } else { a })
    }

    fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let all = self.0.iter().enumerate();
        let hits = all.filter_map(|(face, t)| Some(Hit { face: face as u32, ..t.first_hit(ray)? }));
        hits.reduce(|a, b| if b.t < a.t { b } else { a })
    }
}

/// Triangles of every bad kind, around the origin, about 1 in size.
fn soup(random: &mut Random, n: usize) -> Vec<[[f64; 3]; 3]> {
    (0..n)
        .map(|_| {
            let size = [1.0, 0.3, 0.05, 1e-3][random.below(4)];
            let at = random.point_within::<3>(1.0);
            let near = |random: &mut Random| {
                let off = random.point_within::<3>(size);
                std::array::from_fn(|k| at[k] + off[k])
            };
            let (a, b, c): ([f64; 3], [f64; 3], [f64; 3]) = (near(random), near(random), near(random));
            let t = random.unit();
            let on: [f64; 3] = std::array::from_fn(|k| a[k] + t * (b[k] - a[k]));
            let thin = [1e-3, 1e-6, 1e-9, 1e-13][random.below(4)];
            let off: [f64; 3] = std::array::from_fn(|k| on[k] + thin * c[k]);
            match random.below(10) {
                0 => [a, a, a],
                1 => [a, b, b],
                2 => [a, a, b],
                3 => [a, b, on],
                4 => [off, a, b],
                5 => [a, off, b],
                6 => [a, b, off],
                _ => [a, b, c],
            }
        })
        .collect()
}

fn mesh_of(triangles: &[[[f64; 3]; 3]]) -> Mesh {
    let faces = (0..triangles.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    Mesh::new(triangles.concat(), faces).expect("finite")
}

/// Scales and offsets at which everything must work alike.
const PLACES: [(f64, f64); 8] =
    [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 5e6), (1e-3, 1e3), (1e-100, 0.0), (1e100, 0.0), (1e-3, -1e9)];

fn placed(triangles: &[[[f64; 3]; 3]], (scale, offset): (f64, f64)) -> Vec<[[f64; 3]; 3]> {
    triangles.iter().map(|t| t.map(|p| p.map(|x| x * scale + offset))).collect()
}

#[test]
fn closest_point_is_that_of_the_plain_loop() {
    let seed = 0x5eed_0001;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    for (scale, offset) in PLACES {
        for n in [1, 2, 5, 17, 150] {
            let mut triangles = placed(&soup(&mut random, n), (scale, offset));
            // Twins tie exactly: the lower face wins.
            triangles.extend_from_within(..n / 2);
            let mesh = mesh_of(&triangles);
            let (bvh, plain) = (tree(&mesh), Loop::over(&mesh));
            for reach in [0.0, 1e-9, 0.1, 1.0, 3.0, 100.0, 1e5, 1e9, 1e14] {
                for _ in 0..40 {
                    let w = [random.unit(), random.unit(), random.unit()];
                    let on =
                        mix(triangles[random.below(triangles.len())], w.map(|x| x / (w[0] + w[1] + w[2])));
                    let off = random.point_within::<3>(reach * scale);
                    let p = std::array::from_fn(|k| on[k] + off[k]);
                    let (found, expected) = (bvh.closest_point(p).unwrap(), plain.closest(p).unwrap());
                    assert_eq!(found.distance_sq, expected.distance_sq, "{scale} {offset} {n} {reach} {p:?}");
                    assert_eq!(found.face, expected.face, "{scale} {offset} {n} {reach} {p:?}");
                }
            }
        }
    }
}

type Big = FBig<dashu_float::round::mode::HalfEven, 2>;

/// Enough bits that nothing here is rounded in a way that shows: inputs span fewer than 200.
fn big(x: f64) -> Big {
    Big::try_from(x).expect("finite").with_precision(1200).value()
}

type BigPoint = [Big; 3];

fn sub(a: &BigPoint, b: &BigPoint) -> BigPoint {
    std::array::from_fn(|k| a[k].clone() - b[k].clone())
}

fn dot(a: &BigPoint, b: &BigPoint) -> Big {
    (0..3).fold(big(0.0), |sum, k| sum + a[k].clone() * b[k].clone())
}

/// The squared distance between a point and a triangle by definition: the least over the corners, the edges
/// and, where the point projects inside, the face.
fn true_square(p: [f64; 3], triangle: [[f64; 3]; 3]) -> Big {
    let p = p.map(big);
    let corners = triangle.map(|c| c.map(big));
    let mut squares: Vec<Big> = corners.iter().map(|c| sub(&p, c)).map(|d| dot(&d, &d)).collect();
    for k in 0..3 {
        let (from, to) = (&corners[k], &corners[(k + 1) % 3]);
        let (edge, off) = (sub(to, from), sub(&p, from));
        let (along, whole) = (dot(&off, &edge), dot(&edge, &edge));
        if along > big(0.0) && along < whole {
            squares.push(dot(&off, &off) - along.clone() * along / whole);
        }
    }
    let (e, f, off) = (sub(&corners[1], &corners[0]), sub(&corners[2], &corners[0]), sub(&p, &corners[0]));
    let (ee, ef, ff) = (dot(&e, &e), dot(&e, &f), dot(&f, &f));
    let (oe, of) = (dot(&off, &e), dot(&off, &f));
    let whole = ee.clone() * ff.clone() - ef.clone() * ef.clone();
    let v = ff * oe.clone() - ef.clone() * of.clone();
    let w = ee * of.clone() - ef * oe.clone();
    if whole > big(0.0) && v > big(0.0) && w > big(0.0) && v.clone() + w.clone() < whole {
        squares.push(dot(&off, &off) - (v * oe + w * of) / whole);
    }
    squares.into_iter().reduce(|a, b| if b < a { b } else { a }).expect("three corners")
}

/// `√x`, to f64 precision or better.
fn root(x: Big) -> f64 {
    if x <= big(0.0) { 0.0 } else { x.sqrt().to_f64().value() }
}

#[test]
fn bounds_on_the_distance_hold_in_exact_arithmetic_and_are_sharp() {
    let seed = 0x5eed_0002;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    let (mut widest, mut worst) = (0.0_f64, 0.0_f64);
    for (scale, offset) in PLACES {
        for triangle in placed(&soup(&mut random, 60), (scale, offset)) {
            let bvh = tree(&mesh_of(&[triangle]));
            for reach in [0.0, 1e-12, 1e-6, 0.1, 10.0, 1e6, 1e12] {
                let w = [random.unit(), random.unit(), random.unit()];
                let on = mix(triangle, w.map(|x| x / (w[0] + w[1] + w[2])));
                let off = random.point_within::<3>(reach * scale);
                let p: [f64; 3] = std::array::from_fn(|k| on[k] + off[k]);
                let square = true_square(p, triangle);
                let down = bvh.closest_distance_down(p).unwrap();
                let up = bvh.closest_distance_up(p).unwrap();
                assert!(big(down) * big(down) <= square, "down {down} of {triangle:?} from {p:?}");
                assert!(big(up) * big(up) >= square, "up {up} of {triangle:?} from {p:?}");
                // Sharp relative to the farthest corner: what rounding differences to it costs.
                let far = triangle.map(|c| (0..3).map(|k| (c[k] - p[k]).abs()).fold(0.0, f64::max));
                let far = far.into_iter().fold(0.0, f64::max).max(1e-100 * scale);
                let distance = root(square);
                widest = widest.max((up - down) / far / f64::EPSILON);
                if distance > 1e-150 || distance == 0.0 {
                    let computed = bvh.closest_point(p).unwrap().distance_sq.sqrt();
                    worst = worst.max((computed - distance).abs() / far / f64::EPSILON);
                }
            }
        }
    }
    println!("bounds at most {widest} ulp apart, distances at most {worst} ulp off");
    assert!(widest <= 64.0, "bounds are {widest} units in the last place apart");
    assert!(worst <= 16.0, "distances are {worst} units in the last place off");
}

#[test]
fn bounds_over_a_mesh_enclose_the_least_over_its_triangles() {
    let seed = 0x5eed_0003;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    for place in PLACES {
        let triangles = placed(&soup(&mut random, 60), place);
        let bvh = tree(&mesh_of(&triangles));
        for reach in [1e-9, 0.1, 3.0, 1e4, 1e10] {
            for _ in 0..6 {
                let off = random.point_within::<3>(reach * place.0);
                let p: [f64; 3] = std::array::from_fn(|k| triangles[0][0][k] + off[k]);
                let all = triangles.iter().map(|t| true_square(p, *t));
                let least = all.reduce(|a, b| if b < a { b } else { a }).unwrap();
                let (down, up) = (bvh.closest_distance_down(p).unwrap(), bvh.closest_distance_up(p).unwrap());
                assert!(big(down) * big(down) <= least && big(up) * big(up) >= least, "{place:?} {p:?}");
                assert!(up - down <= 1e-12 * (up + 3.0 * place.0), "{down} {up} {place:?} {p:?}");
            }
        }
    }
}

/// A sphere of integer coordinates: closed, star-shaped about the origin, every coordinate exact.
fn integer_sphere(n: usize, radius: f64) -> Mesh {
    // The faces of a cube in n × n squares, pushed out and rounded; rows are shared by cube coordinates.
    let mut rows = std::collections::BTreeMap::new();
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let mut row = |cube: [i64; 3]| {
        *rows.entry(cube).or_insert_with(|| {
            let v = cube.map(|x| x as f64);
            let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            positions.push(v.map(|x| (x * radius / length).round()));
            positions.len() as u32 - 1
        })
    };
    let half = n as i64;
    for axis in 0..3 {
        for side in [-half, half] {
            for i in (-half..half).step_by(2) {
                for j in (-half..half).step_by(2) {
                    let mut at = |i: i64, j: i64| {
                        let mut cube = [0; 3];
                        (cube[axis], cube[(axis + 1) % 3], cube[(axis + 2) % 3]) = (side, i, j);
                        row(cube)
                    };
                    let [a, b, c, d] = [at(i, j), at(i + 2, j), at(i + 2, j + 2), at(i, j + 2)];
                    let two = if side > 0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                    faces.extend(two);
                }
            }
        }
    }
    // Each face starts at another corner, so that edges meet in every combination of their places.
    let turned = faces.iter().enumerate().map(|(i, f): (usize, &[u32; 3])| {
        let turn = i * 7 % 11 % 3;
        std::array::from_fn(|k| f[(k + turn) % 3])
    });
    Mesh::new(positions, turned.collect()).expect("finite")
}

/// Twice the signed area of the origin and two points of the plane, exactly.
fn area(p: [f64; 3], q: [f64; 3]) -> Big {
    big(p[0]) * big(q[1]) - big(p[1]) * big(q[0])
}

#[test]
fn rays_hit_triangles_thinner_than_rounding() {
    let seed = 0x5eed_0008;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    let zero = big(0.0);
    let mut inside = 0;
    for _ in 0..20_000 {
        // Three points of a line through the origin, each rounded off it.
        let slope = random.signed();
        let on_line = |x: f64| [x, x * slope, 1.0];
        let corners = [on_line(random.signed()), on_line(random.signed()), on_line(random.signed())];
        let [a, b, c] = corners;
        let areas = [area(b, c), area(c, a), area(a, b)];
        let within = areas.iter().all(|x| *x > zero) || areas.iter().all(|x| *x < zero);
        let outside = areas.iter().any(|x| *x > zero) && areas.iter().any(|x| *x < zero);
        let hit = tree(&mesh_of(&[corners])).first_hit(&Ray::new([0.0; 3], [0.0, 0.0, 1.0]));
        assert!(!within || hit.is_some_and(|h| (h.t - 1.0).abs() < 1e-12), "missed {corners:?}");
        assert!(!outside || hit.is_none(), "met {corners:?}, which is elsewhere");
        inside += u32::from(within);
    }
    assert!(inside > 100, "only {inside} triangles around the ray");
}

#[test]
fn rays_exactly_through_edges_and_corners_of_a_closed_mesh_hit() {
    let mesh = integer_sphere(16, 1000.0);
    let bvh = tree(&mesh);
    // From integer points well inside to corners and the halves and quarters of edges: all exact, as is the
    // direction, so the ray meets the edge itself.
    for origin in [[0.0; 3], [100.0, -30.0, 7.0], [-1.0, 400.0, 0.0]] {
        for face in 0..mesh.faces().len() {
            let corners = mesh.corners(face);
            for (k, share) in (0..3).flat_map(|k| [0.0, 0.25, 0.5, 0.75].map(|share| (k, share))) {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                let on: [f64; 3] = std::array::from_fn(|x| a[x] + share * (b[x] - a[x]));
                let direction = std::array::from_fn(|x| on[x] - origin[x]);
                let hit = bvh.first_hit(&Ray::new(origin, direction));
                let hit = hit.unwrap_or_else(|| panic!("leak at {on:?} from {origin:?}"));
                assert!((hit.t - 1.0).abs() < 1e-12 && !hit.front, "{hit:?}");
                assert!(bvh.any_hit(&Ray::new(origin, direction)));
            }
        }
    }
}

#[test]
fn no_ray_leaves_a_closed_mesh_anywhere_in_space() {
    let seed = 0x5eed_0004;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    let sphere = integer_sphere(24, 1.0e5);
    for (scale, offset) in PLACES {
        let place = |p: [f64; 3]| p.map(|x| x * (1e-5 * scale) + offset);
        let mesh = sphere.with_positions(sphere.positions().iter().map(|p| place(*p)).collect()).unwrap();
        let bvh = tree(&mesh);
        let rounding = 1e-16 * offset.abs() / scale;
        for n in 0..30_000 {
            let origin = place(random.point_within::<3>(4e4));
            let corners = mesh.corners(random.below(mesh.faces().len()));
            let t = random.unit();
            // At an edge, at a corner, along an axis, anywhere: each as exactly as floats can.
            let target = std::array::from_fn(|k| corners[0][k] + t * (corners[1][k] - corners[0][k]));
            let towards = |target: [f64; 3]| std::array::from_fn(|k| target[k] - origin[k]);
            let direction = match n % 4 {
                0 => towards(target),
                1 => towards(corners[2]),
                2 => [[1.0, 0.0, 0.0], [0.0, -1e-30, 0.0], [0.0, -0.0, 1e30]][random.below(3)],
                _ => random.point_within::<3>(1.0),
            };
            let ray = Ray::new(origin, direction);
            let hit = bvh.first_hit(&ray);
            let hit = hit.unwrap_or_else(|| panic!("leak: {ray:?} scale {scale} offset {offset}"));
            let off = bvh.closest_point(ray.at(hit.t)).unwrap().distance_sq.sqrt() / scale;
            assert!(off <= 1e-13 + 16.0 * rounding, "{off} {scale} {offset}");
        }
    }
}

#[test]
fn first_hit_is_that_of_the_plain_loop() {
    let seed = 0x5eed_0005;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    let mut hits = 0;
    for (scale, offset) in PLACES {
        let mut triangles = placed(&soup(&mut random, 120), (scale, offset));
        triangles.extend_from_within(..30);
        let mesh = mesh_of(&triangles);
        let (bvh, plain) = (tree(&mesh), Loop::over(&mesh));
        for reach in [0.5, 3.0, 1e3, 1e8] {
            for _ in 0..400 {
                let place = |p: [f64; 3]| p.map(|x| x * scale + offset);
                let (origin, target) =
                    (place(random.point_within::<3>(reach)), place(random.point_within::<3>(0.8)));
                let direction = std::array::from_fn(|k| target[k] - origin[k]);
                let (t_min, t_max) = [(0.0, f64::INFINITY), (0.9, 1.1), (0.0, 1.0)][random.below(3)];
                let ray = Ray { origin, direction, t_min, t_max };
                let (found, expected) = (bvh.first_hit(&ray), plain.first_hit(&ray));
                assert_eq!(found, expected, "{ray:?}");
                assert_eq!(bvh.any_hit(&ray), expected.is_some());
                hits += u32::from(expected.is_some());
            }
        }
    }
    assert!(hits > 1000, "only {hits} rays met anything");
}

#[test]
fn hits_agree_with_the_textbook_formula() {
    let seed = 0x5eed_0006;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    let (mut met, mut missed) = (0, 0);
    for _ in 0..20_000 {
        let [a, b, c] =
            [random.point_within::<3>(1.0), random.point_within::<3>(1.0), random.point_within::<3>(1.0)];
        let (origin, target) = (random.point_within::<3>(3.0), random.point_within::<3>(0.3));
        let direction = std::array::from_fn(|k| target[k] - origin[k]);
        // Solve origin + t·direction = a + v·(b − a) + w·(c − a) by Cramer's rule.
        let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let det = |p: [f64; 3], q: [f64; 3], r: [f64; 3]| {
            p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0])
                + p[2] * (q[0] * r[1] - q[1] * r[0])
        };
        let (e, f, o) = (minus(b, a), minus(c, a), minus(origin, a));
        let back = direction.map(|x| -x);
        let whole = det(back, e, f);
        let (t, v, w) = (det(o, e, f) / whole, det(back, o, f) / whole, det(back, e, o) / whole);
        let margin = [t, v, w, 1.0 - v - w].into_iter().fold(f64::INFINITY, f64::min);
        if margin.abs() < 1e-6 || whole.abs() < 1e-3 {
            continue;
        }
        let hit = tree(&mesh_of(&[[a, b, c]])).first_hit(&Ray::new(origin, direction));
        assert_eq!(hit.is_some(), margin > 0.0);
        let Some(hit) = hit else {
            missed += 1;
            continue;
        };
        met += 1;
        assert!((hit.t - t).abs() < 1e-9 * (1.0 + t), "{} {t}", hit.t);
        assert!((hit.barycentric[1] - v).abs() < 1e-9 && (hit.barycentric[2] - w).abs() < 1e-9);
        // The front is where the normal e × f points: there the determinant is positive.
        assert_eq!(hit.front, whole > 0.0);
    }
    assert!(met > 300 && missed > 3000, "{met} {missed}");
}

#[test]
fn the_tree_is_the_same_on_any_number_of_threads() {
    let seed = 0x5eed_0007;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    // Large enough for several tasks.
    let mesh = mesh_of(&soup(&mut random, 60_000));
    let built = [1, 2, 5].map(|threads| {
        let bvh = Bvh::build(&mesh, &Job::default().with_threads(threads)).unwrap();
        format!("{bvh:?}")
    });
    assert!(built[0] == built[1] && built[0] == built[2]);
}

#[test]
fn meshes_without_extent_and_without_faces_answer() {
    let empty = tree(&Mesh::new(vec![[1.0; 3]], vec![]).unwrap());
    assert_eq!(empty.closest_point([0.0; 3]), None);
    assert_eq!(empty.closest_distance_down([0.0; 3]), None);
    assert_eq!(empty.first_hit(&Ray::new([0.0; 3], [1.0; 3])), None);
    assert!(empty.bounds().is_empty());
    for at in [[0.0; 3], [1.0, 2.0, 3.0], [1e300, 0.0, -1e300], [5e-324, 0.0, 0.0]] {
        let point = tree(&Mesh::new(vec![at], vec![[0, 0, 0]; 50]).unwrap());
        let closest = point.closest_point(at).unwrap();
        assert_eq!((closest.point, closest.face, closest.distance_sq), (at, 0, 0.0));
        assert_eq!(point.first_hit(&Ray::new([0.5; 3], at)), None);
        assert!(point.closest_distance_down([1.0, 2.0, 4.0]).unwrap() <= 2e300);
    }
    let one = tree(&mesh_of(&[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]));
    assert_eq!(one.closest_point([f64::NAN, 0.0, 0.0]), None);
    assert_eq!(one.first_hit(&Ray::new([0.1, 0.1, 1.0], [0.0; 3])), None);
    assert_eq!(one.first_hit(&Ray::new([0.1, 0.1, 1.0], [0.0, 0.0, f64::NAN])), None);
    assert_eq!(one.first_hit(&Ray::new([f64::NAN; 3], [0.0, 0.0, -1.0])), None);
}

#[test]
fn many_equal_triangles_make_no_deep_tree() {
    let triangle = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bvh = tree(&mesh_of(&vec![triangle; 20_000]));
    assert_eq!(bvh.closest_point([0.2, 0.2, 1.0]).unwrap().face, 0);
    assert_eq!(bvh.first_hit(&Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0])).unwrap().face, 0);
    // Sizes that shrink by half each: cost alone would peel them off one by one.
    let shrinking: Vec<_> =
        (0..500).map(|i| triangle.map(|p| p.map(|x| (x + 1.0) * libm::ldexp(1.0, -i)))).collect();
    let bvh = tree(&mesh_of(&shrinking));
    assert_eq!(bvh.closest_point([2.0, 1.0, 1.0]).unwrap().face, 0);
    assert_eq!(bvh.closest_point([0.0; 3]).unwrap().face, 499);
}

#[test]
fn refuses_and_stops() {
    let mesh = integer_sphere(16, 1.0);
    let mut small = Job::default();
    small.memory_limit = 1000;
    let refusal = Bvh::build(&mesh, &small).unwrap_err().to_string();
    assert!(refusal.contains("3072 faces") && refusal.contains("1000"), "{refusal}");
    let job = Job::default();
    job.cancel();
    assert_eq!(Bvh::build(&mesh, &job).unwrap_err(), chordal::budget::JobError::Cancelled);
}
