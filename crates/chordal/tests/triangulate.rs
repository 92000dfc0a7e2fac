//! The laws of polygon triangulation: a disc with the polygon's border, nothing face down unless it must be.
use chordal::explicit::triangulate::{Triangulation, polygon};
use chordal_testkit::Random;
use chordal_testkit::corpus;
use std::collections::HashMap;

/// n − 2 triangles, the polygon's edges once each and forwards, every other edge once each way.
fn expect_disc(n: usize, cut: &Triangulation) {
    assert_eq!(cut.triangles.len(), n.saturating_sub(2));
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    for t in &cut.triangles {
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    for (&(a, b), &count) in &edges {
        assert_eq!(count, 1, "edge {a} {b} is used twice in one direction");
        let is_border = b == (a + 1) % n as u32;
        assert_eq!(edges.contains_key(&(b, a)), !is_border, "edge {a} {b}");
    }
}

/// Twice the area of a triangle of points in the plane z = 0; exact for small integers.
fn area2(points: &[[f64; 3]], t: [u32; 3]) -> f64 {
    let [a, b, c] = t.map(|i| points[i as usize]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn shoelace2(points: &[[f64; 3]]) -> f64 {
    (0..points.len())
        .map(|i| (points[i], points[(i + 1) % points.len()]))
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
        .sum()
}

fn plane(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
    points.iter().map(|p| [p[0], p[1], 0.0]).collect()
}

/// A polygon around the origin with random radii: simple, and mostly concave.
fn star(random: &mut Random, n: usize) -> Vec<[f64; 3]> {
    (0..n)
        .map(|i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * i as f64 / n as f64);
            let radius = 0.1 + random.unit();
            [radius * cos, radius * sin, 0.0]
        })
        .collect()
}

fn comb(teeth: usize) -> Vec<[f64; 3]> {
    let mut points = vec![[0.0, -1.0, 0.0], [2.0 * teeth as f64, -1.0, 0.0]];
    for i in (0..teeth).rev() {
        points.extend([[2.0 * i as f64 + 1.0, 1000.0, 0.0], [2.0 * i as f64, 0.0, 0.0]]);
    }
    points
}

/// A corridor that winds `turns` times around the origin.
fn spiral(turns: usize, corners_a_turn: usize) -> Vec<[f64; 3]> {
    let n = turns * corners_a_turn;
    let arm = |width: f64| {
        move |i: usize| {
            let turn = i as f64 / corners_a_turn as f64;
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
            [(1.0 + width + turn) * cos, (1.0 + width + turn) * sin, 0.0]
        }
    };
    (0..n).map(arm(0.5)).chain((0..n).rev().map(arm(0.0))).collect()
}

#[test]
fn fewer_than_three_corners_give_nothing() {
    for n in 0..3 {
        assert_eq!(polygon(&vec![[1.0, 2.0, 3.0]; n]), Triangulation::default());
    }
}

#[test]
fn random_simple_polygons_are_cut_exactly_at_every_scale_and_tilt() {
    let seed = 0x9E37_79B9_7F4A_7C15;
    println!("seed {seed:#x}");
    let mut random = Random::new(seed);
    for round in 0..2000 {
        let n = 3 + (random.unit() * 60.0) as usize;
        let flat = star(&mut random, n);
        let scale = [1.0, 1e-6, 1e6, 1e-160, 1e150, 1e-300, 1e300][round % 7];
        // Axes that keep the view along the largest one exact: a permutation and a shear.
        let shift = round % 3;
        let points: Vec<[f64; 3]> = flat
            .iter()
            .map(|p| {
                let lifted = [p[0] * scale, p[1] * scale, (0.5 * p[0] - 0.25 * p[1]) * scale];
                std::array::from_fn(|k| lifted[(k + shift) % 3])
            })
            .collect();
        let cut = polygon(&points);
        expect_disc(n, &cut);
        assert!(cut.is_exact(), "round {round}, {n} corners, scale {scale:e}");
        let reversed: Vec<_> = points.iter().rev().copied().collect();
        assert!(polygon(&reversed).is_exact(), "round {round} backwards");
    }
}

#[test]
fn areas_add_up_on_an_integer_lattice() {
    // On integers both sides are exact, so that this judges `folded` with arithmetic of its own.
    let seed = 77;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let (mut exact, mut folded) = (0, 0);
    for _ in 0..20_000 {
        let n = 4 + (random.unit() * 7.0) as usize;
        let points: Vec<[f64; 3]> =
            (0..n).map(|_| [(random.unit() * 6.0).floor(), (random.unit() * 6.0).floor(), 0.0]).collect();
        let cut = polygon(&points);
        expect_disc(n, &cut);
        let sum: f64 = cut.triangles.iter().map(|t| area2(&points, *t).abs()).sum();
        assert_eq!(sum == shoelace2(&points).abs(), cut.is_exact(), "{points:?}");
        *if cut.is_exact() { &mut exact } else { &mut folded } += 1;
    }
    assert!(exact > 1000 && folded > 1000, "{exact} exact, {folded} folded: too few to judge");
}

#[test]
fn corners_on_a_straight_side_are_kept_without_flat_triangles() {
    for (per_side, sides) in [(1, 4), (2, 4), (7, 4), (1, 3), (50, 3), (3, 8)] {
        let corner = |i: usize| {
            let square = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]];
            let triangle = [[0.0, 0.0], [51.0, 0.0], [0.0, 51.0]];
            let cross = [
                [0.0, 0.0],
                [8.0, 0.0],
                [8.0, 4.0],
                [16.0, 4.0],
                [16.0, 8.0],
                [8.0, 8.0],
                [8.0, 12.0],
                [0.0, 12.0],
            ];
            match sides {
                3 => triangle[i % 3],
                4 => square[i % 4],
                _ => cross[i % 8],
            }
        };
        let mut points = Vec::new();
        for side in 0..sides {
            let (a, b) = (corner(side), corner(side + 1));
            for k in 0..=per_side {
                let t = k as f64 / (per_side + 1) as f64;
                points.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 0.0]);
            }
        }
        let cut = polygon(&points);
        expect_disc(points.len(), &cut);
        assert!(
            cut.triangles.iter().all(|t| area2(&points, *t) > 0.0),
            "{per_side} on each of {sides} sides"
        );
    }
}

#[test]
fn a_hole_joined_by_a_slit_is_cut_exactly() {
    let points = plane(&[
        [0.0, 0.0],
        [10.0, 0.0],
        [10.0, 10.0],
        [0.0, 10.0],
        [0.0, 0.0],
        [2.0, 2.0],
        [2.0, 8.0],
        [8.0, 8.0],
        [8.0, 2.0],
        [2.0, 2.0],
    ]);
    let cut = polygon(&points);
    expect_disc(points.len(), &cut);
    assert!(cut.is_exact());
    assert_eq!(shoelace2(&points), 2.0 * (100.0 - 36.0));
}

#[test]
fn polygons_without_area_give_flat_triangles_and_no_fold() {
    let line: Vec<[f64; 3]> = (0..9).map(|i| [f64::from(i), 2.0 * f64::from(i), -f64::from(i)]).collect();
    for points in [
        vec![[3.0, -1.0, 2.0]; 6],
        line,
        plane(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 0.0]]),
    ] {
        let cut = polygon(&points);
        expect_disc(points.len(), &cut);
        assert!(cut.is_exact(), "{points:?}");
    }
}

#[test]
fn a_quad_is_cut_where_no_triangle_folds() {
    for start in 0..4 {
        let dart = [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]];
        let points = plane(&std::array::from_fn::<_, 4, _>(|i| dart[(i + start) % 4]));
        let cut = polygon(&points);
        expect_disc(4, &cut);
        assert!(cut.triangles.iter().all(|t| area2(&points, *t) > 0.0), "start {start}: {cut:?}");
    }
    assert_eq!(
        polygon(&plane(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])).triangles,
        [[0, 1, 2], [0, 2, 3]]
    );
    assert_eq!(polygon(&plane(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])).folded, 1);
}

#[test]
fn a_bent_quad_is_seen_along_its_normal_where_the_axis_view_folds() {
    // From a model of a guitar: along its largest axis this quad crosses itself, along its normal it does
    // not.
    let bent =
        [[-4.787, 47.02, 6.016], [-4.848, 47.089, 5.989], [-4.811, 47.011, 6.023], [-4.801, 46.982, 5.785]];
    assert_eq!(polygon(&bent).folded, 0);
    expect_disc(4, &polygon(&bent));
}

#[test]
fn crossing_polygons_are_reported_as_folded() {
    let bow = plane(&[[0.0, 0.0], [2.0, 2.0], [4.0, 0.0], [4.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
    let cut = polygon(&bow);
    expect_disc(6, &cut);
    assert!(!cut.is_exact());
}

#[test]
fn twenty_thousand_corners_are_cut_exactly() {
    let seed = 5;
    println!("seed {seed}");
    let circle = |n: usize| -> Vec<[f64; 3]> {
        (0..n)
            .map(|i| libm::sincos(std::f64::consts::TAU * i as f64 / n as f64))
            .map(|(sin, cos)| [cos, 0.0, sin])
            .collect()
    };
    for (name, points) in [
        ("star", star(&mut Random::new(seed), 20_000)),
        ("comb", comb(10_000)),
        ("spiral", spiral(40, 250)),
        ("circle", circle(20_000)),
    ] {
        let cut = polygon(&points);
        expect_disc(points.len(), &cut);
        assert!(cut.is_exact(), "{name}: {} folded", cut.folded);
    }
}

#[test]
fn hostile_polygons_end() {
    // Each of these takes a cubic clipper hours: chords of a circle, a random scribble, few points many
    // times.
    let seed = 6;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let n = 20_001;
    let chord = |i: usize| libm::sincos(std::f64::consts::TAU * ((i * 9001) % n) as f64 / n as f64);
    let chords: Vec<[f64; 3]> = (0..n).map(chord).map(|(sin, cos)| [cos, sin, 0.0]).collect();
    let scribble: Vec<[f64; 3]> = (0..n).map(|_| [random.unit(), random.unit(), 0.0]).collect();
    let few: Vec<[f64; 3]> = (0..n).map(|i| scribble[(i * i) % 7]).collect();
    for points in [chords, scribble, few] {
        expect_disc(n, &polygon(&points));
    }
}

#[test]
fn outlines_from_the_field_that_do_not_cross_are_cut_wherever_earcut_can_cut_them() {
    let Some(folder) = corpus::find("polygon/earcut/test/fixtures") else { return };
    let mut rings = 0;
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .expect("the fixtures are there")
        .map(|entry| entry.expect("readable").path())
        .collect();
    files.sort();
    for file in files {
        for ring in rings_of(&std::fs::read_to_string(&file).expect("readable")) {
            let points = plane(&ring);
            let cut = polygon(&points);
            expect_disc(points.len(), &cut);
            let mut theirs: Vec<u32> = Vec::new();
            earcut::Earcut::new().earcut(ring.iter().copied(), &[], &mut theirs);
            let area = shoelace2(&points).abs();
            let their_area: f64 =
                theirs.chunks_exact(3).map(|t| area2(&points, [t[0], t[1], t[2]]).abs()).sum();
            // Rounding of the two sums; the rings have integers up to some thousands and few broken numbers.
            let they_can = (their_area - area).abs() <= 4.0 * f64::EPSILON * ring.len() as f64 * area;
            assert!(
                cut.is_exact() || !they_can || crosses_itself(&ring),
                "{}: {} of {} folded",
                file.display(),
                cut.folded,
                ring.len()
            );
            rings += 1;
        }
    }
    assert!(rings > 100, "only {rings} rings");
}

/// Whether two sides cross in one inner point of both; every side against every other one.
fn crosses_itself(ring: &[[f64; 2]]) -> bool {
    let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        let coord = |[x, y]: [f64; 2]| robust::Coord { x, y };
        robust::orient2d(coord(a), coord(b), coord(c))
    };
    let n = ring.len();
    (0..n).any(|i| {
        let (a, b) = (ring[i], ring[(i + 1) % n]);
        (i + 1..n).any(|j| {
            let (c, d) = (ring[j], ring[(j + 1) % n]);
            turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
        })
    })
}

/// Every list of pairs in a JSON text of nested lists of numbers: brackets, commas and numbers only.
fn rings_of(text: &str) -> Vec<Vec<[f64; 2]>> {
    let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    text.split("]],")
        .map(|ring| {
            ring.split("],[")
                .filter_map(|pair| {
                    let (x, y) = pair.trim_matches(['[', ']']).split_once(',')?;
                    Some([x.parse().ok()?, y.parse().ok()?])
                })
                .collect()
        })
        .filter(|ring: &Vec<[f64; 2]>| ring.len() >= 3)
        .collect()
}

#[test]
fn a_quad_that_is_not_flat_is_cut_where_it_bends_least_wherever_it_starts() {
    // Corner 2 is lifted: across 0–2 the fold is sharper than across 1–3.
    let tent = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]];
    for start in 0..4 {
        let points: Vec<_> = (0..4).map(|i| tent[(i + start) % 4]).collect();
        let cut = polygon(&points);
        expect_disc(4, &cut);
        let edge = [1, 3].map(|i| ((i + 4 - start) % 4) as u32);
        assert!(cut.triangles.iter().all(|t| t.contains(&edge[0]) && t.contains(&edge[1])), "start {start}");
    }
}
