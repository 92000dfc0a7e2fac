//! Attacks on what is called proved: `check::deviation`, the bounds of `mend`, and
//! `check::self_intersections`. Each test is named after what once went wrong, or after the weak place that
//! it leans on.
use chordal_testkit::Random;
use chordal_testkit::cases;
use chordal_testkit::sampler::{Triangles, on};

use chordal::check::{Deviation, Goal, deviation, self_intersections};
use chordal::explicit::Topology;
use chordal::{Job, Mesh, Tolerance, budget::Metric, mend};

type P = [f64; 3];

fn mesh(positions: &[P], faces: &[[u32; 3]]) -> Mesh {
    Mesh::new(positions.to_vec(), faces.to_vec()).expect("finite")
}

fn soup(triangles: &[[P; 3]]) -> Mesh {
    let faces: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    mesh(triangles.as_flattened(), &faces)
}

fn triangles(mesh: &Mesh) -> Triangles {
    Triangles::new(mesh.positions(), mesh.faces())
}

/// The unit square in n × n cells, at the height that `z` says.
fn plate(n: u32, z: impl Fn(f64, f64) -> f64) -> Mesh {
    let at = |i: u32| f64::from(i) / f64::from(n);
    let rows = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
    let positions: Vec<P> = rows.map(|(i, j)| [at(i), at(j), z(at(i), at(j))]).collect();
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| i * (n + 1) + j));
    let faces: Vec<[u32; 3]> =
        cells.flat_map(|k| [[k, k + n + 1, k + n + 2], [k, k + n + 2, k + 1]]).collect();
    mesh(&positions, &faces)
}

fn measured(a: &Mesh, b: &Mesh, goal: &Goal) -> Deviation {
    deviation(a, b, goal, &Job::default()).expect("two surfaces")
}

fn ends(found: &Deviation) -> [f64; 2] {
    [found.bound.at_least(), found.bound.at_most().expect("proved")]
}

fn tolerance(length: f64) -> Option<Tolerance> {
    Some(Tolerance::new(length).expect("positive"))
}

fn weighted(t: [P; 3], w: [f64; 3]) -> P {
    on(t, w.map(|x| x / (w[0] + w[1] + w[2])))
}

/// The largest distance that samples and climbing find.
fn farthest(from: &Triangles, to: &Triangles, random: &mut Random) -> f64 {
    let mut best = (0.0, from.corners[0], [1.0, 0.0, 0.0]);
    for t in &from.corners {
        for _ in 0..40 {
            let w = random.weights();
            let far = to.distance(weighted(*t, w));
            best = if far > best.0 { (far, *t, w) } else { best };
        }
        for p in t {
            let far = to.distance(*p);
            best =
                if far > best.0 { (far, *t, std::array::from_fn(|k| f64::from(t[k] == *p))) } else { best };
        }
    }
    let mut step = 0.3;
    for _ in 0..80 {
        let w: P = std::array::from_fn(|k| (best.2[k] + step * (random.unit() - 0.5)).max(0.0));
        let far = if w == [0.0; 3] { 0.0 } else { to.distance(weighted(best.1, w)) };
        if far > best.0 {
            best = (far, best.1, w);
        } else {
            step *= 0.93;
        }
    }
    best.0
}

/// What the sampler's own rounding may be, on shapes of extent 1.
const SLACK: f64 = 1e-12;

fn holds(what: &str, a: &Mesh, b: &Mesh, found: &Deviation, random: &mut Random) {
    let (s, t) = (triangles(a), triangles(b));
    let there = farthest(&s, &t, random);
    let back = farthest(&t, &s, random);
    assert!(there <= found.forward.at_most + SLACK, "{what}: {there:e} there, {:?}", found.forward);
    assert!(back <= found.backward.at_most + SLACK, "{what}: {back:e} back, {:?}", found.backward);
    let seen = there.max(back);
    assert!(seen <= ends(found)[1] + SLACK, "{what}: {seen:e}, {:?}", found.bound);
    for (side, own, other) in [(&found.forward, &s, &t), (&found.backward, &t, &s)] {
        assert!(own.distance(side.from) <= SLACK, "{what}: the farthest point is on no face");
        assert!(other.distance(side.from) >= side.at_least - SLACK, "{what}: {side:?}");
    }
}

// Sheets full of what a cover must not step over.

/// Takes faces out, turns, doubles, opens and raises some; heights stay multiples of 1/64, so that there are
/// walls and ties.
fn spoiled(sheet: &Mesh, random: &mut Random) -> Mesh {
    let mut positions = sheet.positions().to_vec();
    let mut faces = sheet.faces().to_vec();
    for _ in 0..1 + random.below(6) {
        let face = random.below(faces.len());
        let corner = random.below(3);
        let row = faces[face][corner] as usize;
        match random.below(9) {
            0 | 1 if faces.len() > 1 => drop(faces.swap_remove(face)),
            2 => faces[face].swap(0, 1),
            3 => faces.push(faces[face]),
            4 => faces.push([faces[face][1], faces[face][0], faces[face][2]]),
            // A vertex of its own for one corner, a little off or with another zero.
            5 => {
                faces[face][corner] = positions.len() as u32;
                let off = [0.0, 1e-15, 1e-9, 1e-3][random.below(4)];
                positions.push(positions[row].map(|x| if x == 0.0 { -0.0 } else { x + off }));
            }
            // A flap over its neighbours.
            6 => {
                let [a, b, _] = faces[face];
                faces.push([b, a, random.below(positions.len()) as u32]);
            }
            7 => positions[row][2] += random.below(16) as f64 / 64.0,
            // A vertex over another: faces on edge.
            _ => {
                let over = positions[random.below(positions.len())];
                positions[row] = [over[0], over[1], over[2] + 0.25];
            }
        }
    }
    mesh(&positions, &faces)
}

#[test]
fn what_a_cover_steps_over_is_seen_by_samples() {
    for seed in 0..160 {
        let mut random = Random::new(seed);
        let n = 2 + random.below(4) as u32;
        let steps = [0.0, 0.125, 0.01][random.below(3)];
        let b = spoiled(&plate(n, |x, y| steps * ((3.0 * x).floor() + (2.0 * y).floor())), &mut random);
        let a = match random.below(3) {
            0 => plate(1, |_, _| 0.0),
            1 => spoiled(&plate(3, |x, _| 0.125 * x), &mut random),
            _ => soup(&[[[0; 3]; 3].map(|t| t.map(|_| random.unit()))]),
        };
        let goal = Goal { absolute: tolerance(1e-3), ..Goal::default() };
        let found = measured(&a, &b, &goal);
        holds(&format!("seed {seed}"), &a, &b, &found, &mut random);
    }
}

#[test]
fn a_sheet_that_goes_round_an_axis_twice_and_has_a_gap_is_no_cover() {
    for (turns, missing) in [(1, 3), (2, 5), (3, 0), (3, 17)] {
        let n = 8 * turns;
        let angle = |i: usize| i as f64 * std::f64::consts::TAU / 8.0 + 0.1;
        let at = |i: usize, r: f64| [r * angle(i).cos(), r * angle(i).sin(), 0.001 * i as f64];
        let mut all: Vec<[P; 3]> = Vec::new();
        for i in (0..n).filter(|i| *i != missing) {
            all.push([at(i, 0.01), at(i, 1.0), at(i + 1, 1.0)]);
            all.push([at(i, 0.01), at(i + 1, 1.0), at(i + 1, 0.01)]);
        }
        let b = soup(&all);
        let a = soup(&[[[-0.6, -0.5, 0.002], [0.7, -0.4, 0.002], [0.0, 0.6, 0.002]]]);
        let found = measured(&a, &b, &Goal { relative: 0.01, ..Goal::default() });
        holds(&format!("{turns} turns"), &a, &b, &found, &mut Random::new(7));
    }
}

// Frames.

#[test]
fn what_a_frame_loses_below_the_normal_numbers_is_in_the_bound() {
    let (big, small) = (1e300, 1e-25);
    let floor = [[0.0; 3], [big, 0.0, 0.0], [0.0, big, 0.0]];
    let raised = [[0.0, 0.0, small], [small, 0.0, small], [0.0, small, small]];
    let found = measured(&soup(&[floor, raised]), &soup(&[floor]), &Goal::default());
    assert!(ends(&found)[1] >= small, "{:?}", found.bound);
    assert!(ends(&found)[1] <= 1e-10 * big);
}

#[test]
fn lengths_below_the_normal_numbers_are_rounded_outwards() {
    let u = f64::from_bits(1);
    let a = soup(&[[[0.0; 3], [1000.0 * u, 0.0, 0.0], [0.0, 1000.0 * u, 0.0]]]);
    // Each corner is moved by √2 u, and the corner at the right angle is that far from the other triangle.
    let b = soup(&[[[-u, -u, 0.0], [999.0 * u, -u, 0.0], [-u, 999.0 * u, 0.0]]]);
    let [least, most] = ends(&measured(&a, &b, &Goal::default()));
    assert!(least <= u && most >= 2.0 * u, "[{} u, {} u]", least / u, most / u);
}

#[test]
fn an_upper_end_past_the_largest_number_is_no_panic() {
    for share in [1.2e-15, 1e-14, 1e-13] {
        let half = 0.5 * (f64::MAX * (1.0 - share));
        let ends = [-half, half].map(|x| soup(&[[[x, 0.0, 0.0]; 3]]));
        if let Ok(found) = deviation(&ends[0], &ends[1], &Goal::default(), &Job::default()) {
            assert!(found.bound.at_most().is_some_and(|most| most >= half));
        }
    }
}

// The search.

#[test]
fn a_limit_near_the_distance_is_decided() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let mut some =
            || soup(&(0..5).map(|_| [[0; 3]; 3].map(|t| t.map(|_| random.unit()))).collect::<Vec<_>>());
        let (a, b) = (some(), some());
        let [least, most] = ends(&measured(&a, &b, &Goal { relative: 1e-6, ..Goal::default() }));
        for (max, within) in
            [(0.95 * least, false), (0.9999 * least, false), (1.0001 * most, true), (1.05 * most, true)]
        {
            let found = measured(&a, &b, &Goal { max: tolerance(max), ..Goal::default() });
            let [at_least, at_most] = ends(&found);
            assert!(found.reached, "seed {seed}");
            assert!(
                if within { at_most <= max } else { at_least > max },
                "seed {seed}: {max:e} [{at_least:e}, {at_most:e}]"
            );
        }
    }
}

#[test]
fn pieces_too_small_to_be_halved_end_the_search() {
    let mut random = Random::new(77);
    for _ in 0..30 {
        let mut there = || [0; 3].map(|_| 3.0 + random.unit());
        let a = soup(&[[there(), there(), there()]]);
        let four: Vec<[P; 3]> = (0..4).map(|_| there()).map(|c| [c, c.map(|x| x + 1e-9), c]).collect();
        let [least, most] = ends(&measured(&a, &soup(&four), &Goal { relative: 0.0, ..Goal::default() }));
        assert!(most - least <= 1e-13, "[{least:e}, {most:e}]");
    }
}

#[test]
fn where_no_cover_is_the_upper_end_still_comes_down() {
    // A sheet wound at random against its own plane: 0 apart, and no face has a neighbour that is wound alike
    // for certain.
    let sheet = plate(3, |_, _| 0.0);
    let mut random = Random::new(3);
    let wound = |[a, b, c]: [u32; 3], turned: bool| if turned { [a, c, b] } else { [a, b, c] };
    let faces: Vec<[u32; 3]> = sheet.faces().iter().map(|face| wound(*face, random.below(2) == 0)).collect();
    let found = measured(&plate(1, |_, _| 0.0), &mesh(sheet.positions(), &faces), &Goal::default());
    let [least, most] = ends(&found);
    assert!(least == 0.0 && most <= 2e-4, "[{least:e}, {most:e}]");
}

// Cures, measured by `deviation`, which shares no code with them.

fn keeps_its_bound(what: &str, mesh: &Mesh, mended: &mend::MendedMesh) {
    let Some(bound) = mended.bound.at_most().filter(|_| !mended.mesh.faces().is_empty()) else { return };
    let found = measured(mesh, &mended.mesh, &Goal::default());
    assert!(found.forward.at_least <= bound, "{what}: {:e} > {bound:e}", found.forward.at_least);
    if mended.bound.metric == Metric::Hausdorff {
        assert!(found.backward.at_least <= bound, "{what}: {:e} > {bound:e}", found.backward.at_least);
    }
}

#[test]
fn a_face_without_area_whose_end_is_nearer_than_rounding_tells_is_in_the_bound() {
    for tiny in [1e-16, 1e-20, 1e-200] {
        // The first face is a segment from 0 to 1; the second has its part from `tiny` to 1.
        let corners = [[0.0; 3], [tiny, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0]];
        for face in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
            let sick = mesh(&corners, &[face, [2, 1, 3]]);
            let mended = mend::drop_degenerate(&sick, Topology::Indices, &Job::default()).expect("mended");
            assert_eq!(mended.count("dropped_faces"), 1);
            assert!(mended.bound.at_most().is_none_or(|most| most >= tiny), "{tiny:e}: {:?}", mended.bound);
        }
    }
}

#[test]
fn no_cure_moves_a_surface_further_than_it_says() {
    for seed in 0..cases(40) as u64 {
        let mut random = Random::new(seed);
        let scale = [1.0, 2_f64.powi(-600), 2_f64.powi(600)][random.below(3)];
        let noise = scale * [0.0, 1e-16, 1e-9, 0.03][random.below(4)];
        let n = 4 + random.below(9);
        let mut place = |_| -> P {
            std::array::from_fn(|_| scale * random.below(4) as f64 / 3.0 + noise * random.unit())
        };
        let positions: Vec<P> = (0..n).map(&mut place).collect();
        let faces: Vec<[u32; 3]> =
            (0..2 + random.below(9)).map(|_| std::array::from_fn(|_| random.below(n) as u32)).collect();
        let sick = mesh(&positions, &faces);
        let within = tolerance(scale * [1e-12, 0.02, 0.2, 0.7][random.below(4)]).expect("some");
        let job = Job::default();
        for topology in [Topology::Indices, Topology::Positions] {
            let made = [
                mend::weld(&sick, mend::Weld::Exact, &job),
                mend::weld(&sick, mend::Weld::Within(within), &job),
                mend::resolve_t_junctions(&sick, topology, None, &job),
                mend::resolve_t_junctions(&sick, topology, Some(within), &job),
                mend::drop_degenerate(&sick, topology, &job),
                mend::drop_duplicates(&sick, topology, mend::Duplicates::EitherWay, &job),
                mend::split_non_manifold(&sick, topology, &job),
                mend::orient(&sick, topology, mend::nesting::NestedShells::Keep, &job),
                mend::fill_holes(&sick, topology, mend::HoleSelection::All, &job),
            ];
            for (k, mended) in made.into_iter().enumerate() {
                keeps_its_bound(&format!("seed {seed}, cure {k}"), &sick, &mended.expect("mended"));
            }
        }
    }
}

// Self-intersections.

#[test]
fn another_power_of_two_along_each_axis_changes_no_pair() {
    let mut met = 0;
    for seed in 0..cases(100) as u64 {
        let mut random = Random::new(seed);
        let n = 6 + random.below(9);
        let positions: Vec<P> =
            (0..n).map(|_| std::array::from_fn(|_| random.below(5) as f64 - 2.0)).collect();
        let faces: Vec<[u32; 3]> = (0..10).map(|_| std::array::from_fn(|_| random.below(n) as u32)).collect();
        let count = |mesh: &Mesh| self_intersections(mesh, &Job::default()).expect("counted").count;
        let plain = count(&mesh(&positions, &faces));
        met += plain;
        for _ in 0..4 {
            let powers: [i32; 3] =
                std::array::from_fn(|_| [-1074, -1000, -300, -40, 0, 40, 300, 1000, 1022][random.below(9)]);
            let stretched: Vec<P> =
                positions.iter().map(|p| std::array::from_fn(|k| libm::ldexp(p[k], powers[k]))).collect();
            assert_eq!(count(&mesh(&stretched, &faces)), plain, "seed {seed}, {powers:?}");
        }
    }
    assert!(met > 3 * cases(100) as u64, "{met} pairs");
}
