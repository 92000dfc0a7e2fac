//! Self-intersections: every pair against exact fractions, on lattices full of ties; then shapes whose answer
//! is known.
use chordal::check::findings::MeshLocation;
use chordal::check::{self_intersections, validity};
use chordal::explicit::Topology;
use chordal::{Job, Mesh};
use chordal_testkit::{Random, cases, is_long};

type Lattice = [i128; 3];
type Triangle = [Lattice; 3];
/// x, y, z over w > 0.
type Fraction = [i128; 4];

fn minus(a: Lattice, b: Lattice) -> Lattice {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Lattice, b: Lattice) -> Lattice {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Lattice, b: Lattice) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn normal([a, b, c]: Triangle) -> Lattice {
    cross(minus(b, a), minus(c, a))
}

/// From a corner to a fraction, times its denominator.
fn to(p: Fraction, a: Lattice) -> Lattice {
    [p[0] - a[0] * p[3], p[1] - a[1] * p[3], p[2] - a[2] * p[3]]
}

fn holds(triangle: Triangle, p: Fraction) -> bool {
    let n = normal(triangle);
    dot(n, to(p, triangle[0])) == 0
        && (0..3).all(|k| {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            dot(n, cross(minus(b, a), to(p, a))) >= 0
        })
}

/// `p + (q − p) · above / below`.
fn between(p: Lattice, q: Lattice, above: i128, below: i128) -> Fraction {
    let sign = below.signum();
    let at = |k: usize| sign * (p[k] * below + (q[k] - p[k]) * above);
    [at(0), at(1), at(2), sign * below]
}

/// Every point that can be extreme in what two triangles have in common.
fn candidates(a: Triangle, b: Triangle) -> Vec<Fraction> {
    let mut found: Vec<Fraction> = a.iter().chain(&b).map(|p| [p[0], p[1], p[2], 1]).collect();
    let edges = |t: Triangle| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    for (one, other) in [(a, b), (b, a)] {
        let n = normal(other);
        for (p, q) in edges(one) {
            let below = dot(n, minus(q, p));
            if below != 0 {
                found.push(between(p, q, dot(n, minus(other[0], p)), below));
            }
            for (r, s) in edges(other) {
                let below = dot(n, cross(minus(q, p), minus(s, r)));
                if below != 0 {
                    found.push(between(p, q, dot(n, cross(minus(r, p), minus(s, r))), below));
                }
            }
        }
    }
    found
}

/// Whether the triangles have an extreme common point that is not on their common corner or edge.
fn meet(a: Triangle, b: Triangle) -> bool {
    if normal(a) == [0; 3] || normal(b) == [0; 3] {
        return false;
    }
    let shared: Vec<Lattice> = a.into_iter().filter(|p| b.contains(p)).collect();
    let is_shared = |p: Fraction| match shared[..] {
        [] => false,
        [u] => to(p, u) == [0; 3],
        [u, v] => {
            let along = dot(to(p, u), minus(v, u));
            cross(to(p, u), minus(v, u)) == [0; 3]
                && 0 <= along
                && along <= p[3] * dot(minus(v, u), minus(v, u))
        }
        _ => true,
    };
    candidates(a, b).into_iter().any(|p| holds(a, p) && holds(b, p) && !is_shared(p))
}

fn brute_force(points: &[Lattice], faces: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let corners = |f: usize| faces[f].map(|i| points[i as usize]);
    let mut found = Vec::new();
    for f in 0..faces.len() {
        for g in f + 1..faces.len() {
            if meet(corners(f), corners(g)) {
                found.push([f as u32, g as u32]);
            }
        }
    }
    found
}

fn mesh(points: &[Lattice], faces: &[[u32; 3]], place: impl Fn(f64) -> f64) -> Mesh {
    let positions = points.iter().map(|p| p.map(|x| place(x as f64))).collect();
    Mesh::new(positions, faces.to_vec()).unwrap()
}

fn pairs(mesh: &Mesh) -> (u64, Vec<[u32; 2]>) {
    let found = self_intersections(mesh, &Job::default()).unwrap();
    let faces = found.witnesses.iter().map(|witness| match witness.place {
        MeshLocation::Faces(faces) => faces,
        _ => panic!("{witness:?}"),
    });
    (found.count, faces.collect())
}

#[track_caller]
fn agrees(points: &[Lattice], faces: &[[u32; 3]], place: impl Fn(f64) -> f64, what: &str) -> usize {
    let expected = brute_force(points, faces);
    let (count, first) = pairs(&mesh(points, faces, place));
    assert_eq!(count, expected.len() as u64, "{what}: {points:?} {faces:?} {expected:?} {first:?}");
    assert_eq!(first, expected[..expected.len().min(10)], "{what}: {points:?} {faces:?}");
    expected.len()
}

#[test]
fn lattice_soups_agree_with_exact_fractions() {
    let (mut met, mut free) = (0, 0);
    let n = cases(6000);
    for seed in 0..n as u64 {
        let mut random = Random::new(seed);
        let side = [2, 3, 4, 7, 40][random.below(5)];
        // Half of them in a plane or nearly, where everything is a tie.
        let height = [1, 2, side, side][random.below(4)];
        let n_points = 3 + random.below(9);
        let points: Vec<Lattice> =
            (0..n_points).map(|_| [side, side, height].map(|n| random.below(n) as i128)).collect();
        let faces: Vec<[u32; 3]> =
            (0..2 + random.below(5)).map(|_| [0, 1, 2].map(|_| random.below(n_points) as u32)).collect();
        let found = agrees(&points, &faces, |x| x, &format!("seed {seed}"));
        met += usize::from(found > 0);
        free += usize::from(found == 0);
    }
    assert!(met > n / 6 && free > n / 6, "the soups are too much alike: {met}, {free}");
}

#[test]
fn two_triangles_with_each_kind_of_common_corner_agree_with_exact_fractions() {
    let mut met = [[0; 2]; 3];
    let n = if is_long() { 120_000 } else { 4_000 };
    for seed in 0..n as u64 {
        let mut random = Random::new(!seed);
        let side = [3, 4, 6][random.below(3)];
        let height = [1, side][random.below(2)];
        let n_shared = random.below(3);
        let points: Vec<Lattice> =
            (0..6 - n_shared).map(|_| [side, side, height].map(|n| random.below(n) as i128)).collect();
        let second = [[3, 4, 5], [0, 3, 4], [1, 0, 3]][n_shared];
        let mut faces = [[0, 1, 2], second];
        faces.iter_mut().for_each(|face| {
            face.rotate_left(random.below(3));
            if random.below(2) == 0 {
                face.swap(0, 1);
            }
        });
        let found = agrees(&points, &faces, |x| x, &format!("seed {seed}"));
        met[n_shared][found] += 1;
    }
    assert!(met.iter().flatten().all(|each| *each > n / 60), "too much alike: {met:?}");
}

#[test]
fn scale_by_powers_of_two_and_a_far_place_change_no_verdict() {
    for seed in 0..cases(300) as u64 {
        let mut random = Random::new(seed ^ 0x5555);
        let points: Vec<Lattice> = (0..9).map(|_| [0, 1, 2].map(|_| random.below(5) as i128)).collect();
        let faces: Vec<[u32; 3]> = (0..5).map(|_| [0, 1, 2].map(|_| random.below(9) as u32)).collect();
        for exponent in [-1060, -300, -20, 20, 300, 1000] {
            agrees(&points, &faces, |x| libm::ldexp(x, exponent), &format!("seed {seed}, 2^{exponent}"));
        }
        agrees(&points, &faces, |x| x + 1e6, &format!("seed {seed}, far"));
        agrees(&points, &faces, |x| x * 0.125 - 1e6, &format!("seed {seed}, far"));
    }
}

#[test]
fn coordinates_that_span_many_digits_have_the_same_verdicts() {
    for seed in 0..cases(1600) as u64 {
        let mut random = Random::new(seed ^ 0x1234);
        let side = [2, 3, 6][random.below(3)];
        let points: Vec<Lattice> = (0..7).map(|_| [0, 1, 2].map(|_| random.below(side) as i128)).collect();
        let faces: Vec<[u32; 3]> = (0..3).map(|_| [0, 1, 2].map(|_| random.below(7) as u32)).collect();
        let expected = brute_force(&points, &faces).len() as u64;
        // Stretched along the axes, each by another power of two: no common lattice of 60 bits holds them,
        // and no incidence changes.
        let stretched = |p: &Lattice| {
            let [x, y, z] = p.map(|x| x as f64 + 1.0);
            [x, libm::ldexp(y, 45), libm::ldexp(z, -40)]
        };
        let mesh = Mesh::new(points.iter().map(stretched).collect(), faces.clone()).unwrap();
        assert_eq!(pairs(&mesh).0, expected, "seed {seed}: {points:?} {faces:?}");
    }
}

#[test]
fn a_slanted_lattice_has_the_same_verdicts_though_nothing_is_exact_in_floating_point() {
    let mut met = [0; 2];
    let n = if is_long() { 40_000 } else { 1_400 };
    for seed in 0..n as u64 {
        let mut random = Random::new(seed ^ 0x9999);
        let points: Vec<Lattice> = (0..7).map(|_| [4, 4, 2].map(|n| random.below(n) as i128)).collect();
        let faces: Vec<[u32; 3]> = (0..3).map(|_| [0, 1, 2].map(|_| random.below(7) as u32)).collect();
        // A linear map keeps every incidence; with large entries, sides that are 0 are sums of products far
        // beyond 53 bits, of which floating point keeps the rounding.
        let bits = [6, 16, 26, 36][random.below(4)];
        let axes: [Lattice; 3] =
            [0; 3].map(|_| [0; 3].map(|_| random.below(2 << bits) as i128 - (1 << bits)));
        if dot(axes[0], cross(axes[1], axes[2])) == 0 {
            continue;
        }
        let slanted = |p: &Lattice| -> Lattice { axes.map(|axis| dot(axis, *p)) };
        let slanted: Vec<Lattice> = points.iter().map(slanted).collect();
        let expected = brute_force(&points, &faces).len() as u64;
        // On a lattice of few bits, and stretched along one axis so that none holds it.
        for stretch in [0, 70] {
            let place = |p: &Lattice| [p[0] as f64, p[1] as f64, libm::ldexp(p[2] as f64, stretch)];
            let mesh = Mesh::new(slanted.iter().map(place).collect(), faces.clone()).unwrap();
            assert_eq!(
                pairs(&mesh).0,
                expected,
                "seed {seed}, stretched by 2^{stretch}: {slanted:?} {faces:?}"
            );
        }
        met[usize::from(expected > 0)] += 1;
    }
    assert!(met.iter().all(|each| *each > 3 * n / 20), "too much alike: {met:?}");
}

#[test]
fn numbering_and_threads_change_nothing() {
    for seed in 0..40 {
        let mut random = Random::new(seed ^ 0xabc);
        let points: Vec<Lattice> = (0..400).map(|_| [0, 1, 2].map(|_| random.below(60) as i128)).collect();
        let mut faces: Vec<[u32; 3]> =
            (0..300).map(|_| [0, 1, 2].map(|_| random.below(400) as u32)).collect();
        let on = |faces: &[[u32; 3]], threads: usize| {
            self_intersections(&mesh(&points, faces, |x| x), &Job::default().with_threads(threads)).unwrap()
        };
        let one = on(&faces, 1);
        assert!(one.count > 100);
        assert_eq!(one, on(&faces, 2));
        assert_eq!(one, on(&faces, 5));
        faces.reverse();
        assert_eq!(one.count, on(&faces, 2).count);
    }
}

#[test]
fn a_witness_lies_on_both_faces() {
    let mut met = 0;
    for seed in 0..3000 {
        let mut random = Random::new(seed ^ 0x77);
        let height = [1, 9][random.below(2)];
        let points: Vec<Lattice> = (0..6).map(|_| [9, 9, height].map(|n| random.below(n) as i128)).collect();
        let mesh = mesh(&points, &[[0, 1, 2], [3, 4, 5]], |x| x);
        for witness in self_intersections(&mesh, &Job::default()).unwrap().witnesses {
            met += 1;
            for face in 0..2 {
                let [a, b, c] = mesh.corners(face).map(glam::DVec3::from);
                let p = glam::DVec3::from(witness.at);
                let n = (b - a).cross(c - a);
                let off = n.dot(p - a).abs() / n.length();
                let beside =
                    [(a, b), (b, c), (c, a)].map(|(u, v)| n.dot((v - u).cross(p - u)) / n.length_squared());
                assert!(
                    off < 1e-12 && beside.iter().all(|w| *w > -1e-12),
                    "seed {seed}: {witness:?} {off} {beside:?}"
                );
            }
        }
    }
    assert!(met > 300, "{met}");
}

/// `nu` × `nv` squares of a surface over [0, 1)², closed along both sides; along the second half turned if
/// `twisted`.
fn closed_grid(nu: usize, nv: usize, twisted: bool, point: impl Fn(f64, f64) -> [f64; 3]) -> Mesh {
    let positions =
        (0..nu * nv).map(|v| point((v / nv) as f64 / nu as f64, (v % nv) as f64 / nv as f64)).collect();
    let at = |i: usize, j: usize| {
        let j = if twisted && i == nu { nv - j % nv } else { j };
        ((i % nu) * nv + j % nv) as u32
    };
    let square =
        |i, j| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    Mesh::new(positions, (0..nu * nv).flat_map(|q| square(q / nv, q % nv)).collect()).unwrap()
}

#[test]
fn h58_a_klein_bottle_must_cross_itself_and_a_torus_need_not() {
    use std::f64::consts::TAU;
    let tube = |u: f64, v: f64, twist: f64| {
        let (a, b, half) = (u * TAU, v * TAU, twist * u * TAU / 2.0);
        let (x, y) = (b.sin(), (2.0 * b).sin());
        let r = 3.0 + half.cos() * x - half.sin() * y;
        [r * a.cos(), r * a.sin(), half.sin() * x + half.cos() * y]
    };
    // The figure-eight immersion: the eight crosses itself all along.
    let klein = closed_grid(40, 30, true, |u, v| tube(u, v, 1.0));
    let v = validity(&klein, Topology::Indices);
    assert!(v.closed && v.manifold() && !v.orientable && v.genus.is_none());
    assert_eq!((v.euler, v.components), (0, 1));
    assert!(pairs(&klein).0 > 40, "{:?}", pairs(&klein));
    let round = |u: f64, v: f64| {
        let (a, b) = (u * TAU, v * TAU);
        [(3.0 + b.cos()) * a.cos(), (3.0 + b.cos()) * a.sin(), b.sin()]
    };
    assert_eq!(pairs(&closed_grid(60, 40, false, round)), (0, vec![]));
}

#[test]
fn faces_that_only_touch_count_and_those_with_equal_corners_do_not() {
    let count = |points: &[Lattice], faces: &[[u32; 3]]| pairs(&mesh(points, faces, |x| x)).0;
    let base: [Lattice; 3] = [[0, 0, 0], [4, 0, 0], [0, 4, 0]];
    let with = |more: &[Lattice]| [&base[..], more].concat();
    // A corner on the inside, on a side, on a corner of another index: the last is no more than a seam.
    assert_eq!(count(&with(&[[1, 1, 0], [1, 1, 4], [2, 1, 4]]), &[[0, 1, 2], [3, 4, 5]]), 1);
    assert_eq!(count(&with(&[[2, 0, 0], [1, -1, 4], [2, -1, 4]]), &[[0, 1, 2], [3, 4, 5]]), 1);
    assert_eq!(count(&with(&[[0, 0, 0], [-1, -1, 4], [-2, -1, 4]]), &[[0, 1, 2], [3, 4, 5]]), 0);
    // The same three corners, either way round, by other indices.
    assert_eq!(count(&with(&base), &[[0, 1, 2], [3, 5, 4]]), 0);
    // Folded onto the neighbour, and flat beside it.
    assert_eq!(count(&with(&[[3, 3, 0]]), &[[0, 1, 2], [2, 1, 3]]), 0);
    assert_eq!(count(&with(&[[1, 1, 0]]), &[[0, 1, 2], [2, 1, 3]]), 1);
    // A face without area lies across, and does not count.
    assert_eq!(count(&with(&[[1, 1, -1], [1, 1, 1], [1, 1, 3]]), &[[0, 1, 2], [3, 4, 5]]), 0);
}

#[test]
fn h60_overlapping_solids_are_told_by_the_pairs_that_cross() {
    let cube =
        |at: i128| -> Vec<Lattice> { (0..8).map(|i| [0, 1, 2].map(|k| at + 4 * (i >> k & 1))).collect() };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[u32; 3]> = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    for (offset, meets) in [(0, false), (1, true), (2, true), (4, false), (5, false)] {
        let points = [cube(0), cube(offset)].concat();
        let other = faces.iter().map(|face| face.map(|i| i + 8));
        let all: Vec<[u32; 3]> = faces.iter().copied().chain(other).collect();
        // At 0 all faces are duplicates, and their neighbours overlap nothing else; at 4 the cubes share one
        // corner.
        assert_eq!(agrees(&points, &all, |x| x, &format!("offset {offset}")) > 0, meets, "offset {offset}");
    }
}

#[test]
fn a_cancelled_job_stops_and_a_small_limit_is_refused() {
    use chordal::budget::JobError;
    let mesh = closed_grid(20, 20, false, |u, v| [u, v, u * v]);
    let job = Job::default();
    job.cancel();
    assert_eq!(self_intersections(&mesh, &job), Err(JobError::Cancelled));
    let mut job = Job::default();
    job.memory_limit = 1000;
    assert!(matches!(self_intersections(&mesh, &job), Err(JobError::Refused(_))));
}
