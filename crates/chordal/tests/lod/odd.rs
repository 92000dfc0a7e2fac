//! Odd input: an honest result or a refusal, never a panic or a wait.
use super::sampler::triangles;
use super::{bounds, length, made, n_faces, shapes};
use chordal::budget::RefusalCode;
use chordal::explicit::Topology;
use chordal::lod::{SimplifiedMesh, simplify};
use chordal::{Bounded, Budget, Failure, Job, Mesh};
use chordal_testkit::Random;
use std::time::Duration;

fn mesh(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Mesh {
    Mesh::new(positions.to_vec(), faces.to_vec()).expect("valid")
}

fn tried(mesh: &Mesh, budget: &Budget) -> Result<Bounded<SimplifiedMesh>, Failure<SimplifiedMesh>> {
    simplify(mesh, budget, Topology::Positions, &Job::default().with_threads(1))
}

fn code(mesh: &Mesh, budget: &Budget) -> RefusalCode {
    match tried(mesh, budget) {
        Err(Failure::Refused(refusal)) => refusal.code,
        other => panic!("{other:?}"),
    }
}

fn tetrahedron() -> Mesh {
    mesh(
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    )
}

fn budgets() -> Vec<Budget> {
    let lengths = [1e-300, 1e-12, 1e-3, 0.1, 10.0, 1e300].map(length);
    let counts = [0, 1, 2, 3, 4, 5, 100].map(Budget::triangles);
    lengths.into_iter().chain(counts).collect()
}

/// Every budget gives something within its own bound.
fn survives(name: &str, mesh: &Mesh) {
    for budget in budgets() {
        let made = match tried(mesh, &budget) {
            Ok(made) => made,
            Err(Failure::Unmet(best)) => *best,
            Err(other) => panic!("{name}, {budget:?}: {other}"),
        };
        assert!(n_faces(&made) >= 1, "{name}, {budget:?}: nothing is left");
        if let Some(asked) = budget.length {
            assert!(made.bound.at_most().expect("proved") <= asked.get(), "{name}, {budget:?}");
        }
        let most = made.bound.at_most().expect("proved");
        let [forward, backward] = [(mesh, &made.shape.mesh), (&made.shape.mesh, mesh)].map(|(a, b)| {
            let tree = triangles(b);
            let corners = a.faces().as_flattened().iter().map(|row| a.positions()[*row as usize]);
            corners.map(|p| tree.distance(p)).fold(0.0, f64::max)
        });
        let reach = mesh.positions().as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert!(
            forward.max(backward) <= most + 1e-13 * reach,
            "{name}, {budget:?}: {forward:e} {backward:e} {most:e}"
        );
    }
}

#[test]
fn what_has_no_triangle_is_refused() {
    assert_eq!(code(&mesh(&[], &[]), &length(1.0)), RefusalCode::Empty);
    assert_eq!(code(&mesh(&[[0.0; 3]], &[]), &Budget::triangles(1)), RefusalCode::Empty);
    assert_eq!(code(&tetrahedron(), &Budget { angle_deg: Some(1.0), ..length(1.0) }), RefusalCode::Budget);
}

#[test]
fn a_tetrahedron_stays_for_any_count() {
    for most in [0, 1, 2, 3] {
        let Err(Failure::Unmet(best)) = tried(&tetrahedron(), &Budget::triangles(most)) else {
            panic!("a tetrahedron of {most}")
        };
        assert_eq!((n_faces(&best), best.bound.at_most()), (4, Some(0.0)));
    }
    assert_eq!(n_faces(&made(&tetrahedron(), &Budget::triangles(4))), 4);
}

#[test]
fn one_triangle_and_what_is_flat_survive() {
    survives("one", &mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]));
    survives("tetrahedron", &tetrahedron());
    let row = |n: u32| (0..=n).map(|i| [f64::from(i), 0.0, 0.0]).collect::<Vec<_>>();
    survives("collinear", &mesh(&row(8), &[[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 5, 6], [6, 7, 8]]));
    let fan: Vec<[u32; 3]> = (1..8).map(|i| [0, i, i + 1]).collect();
    survives("a fan on a line", &mesh(&row(8), &fan));
    survives("one point", &mesh(&[[3.0; 3]; 6], &[[0, 1, 2], [3, 4, 5], [0, 2, 4]]));
    survives("one row", &mesh(&[[3.0; 3]], &[[0, 0, 0]]));
    survives("a segment", &mesh(&[[0.0; 3], [1.0; 3]], &[[0, 1, 1], [1, 0, 0]]));
    let flat = shapes::heights([8, 8], 0.0);
    let flat =
        flat.with_positions(flat.positions().iter().map(|p| [p[0], p[1], 0.0]).collect()).expect("finite");
    survives("a plane", &flat);
    // Both sides of a plane: closed, without a volume.
    let both: Vec<[u32; 3]> =
        flat.faces().iter().flat_map(|[a, b, c]| [[*a, *b, *c], [*a, *c, *b]]).collect();
    survives("both sides", &mesh(flat.positions(), &both));
}

#[test]
fn doubles_zero_areas_and_unused_rows_survive() {
    let ball = shapes::sphere(2);
    let twice = [ball.faces(), ball.faces()].concat();
    survives("every face twice", &mesh(ball.positions(), &twice));
    let mut faces = ball.faces().to_vec();
    faces.extend([[0, 0, 1], [2, 3, 3], faces[7], faces[9]]);
    let mut positions = ball.positions().to_vec();
    positions.extend([[100.0; 3], [-100.0; 3], [0.0, -0.0, 1e300]]);
    survives("some of all", &mesh(&positions, &faces));
    // The middle of a side as a vertex of a face without area.
    survives(
        "a flat face in a side",
        &mesh(
            &[[0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1.0, -2.0, 0.0]],
            &[[0, 2, 1], [0, 1, 3], [2, 0, 4], [1, 2, 4]],
        ),
    );
}

#[test]
fn a_face_without_area_is_measured_and_stops_nothing() {
    let ball = shapes::sphere(3);
    let budget = length(0.02);
    let plain = n_faces(&made(&ball, &budget));
    assert!(plain < ball.faces().len() / 2);
    let [a, b, _] = ball.faces()[0];
    let opposite = |p: [f64; 3]| {
        let sum = |q: &[f64; 3]| (0..3).map(|k| (p[k] + q[k]).powi(2)).sum::<f64>();
        (0..ball.positions().len())
            .min_by(|i, j| sum(&ball.positions()[*i]).total_cmp(&sum(&ball.positions()[*j])))
    };
    let far = opposite(ball.positions()[a as usize]).expect("vertices") as u32;
    // An edge of the ball, a line through its middle, and a point of it.
    for (face, back) in [([a, b, a], 0), ([a, far, a], 1), ([a, a, a], 0)] {
        let mesh = mesh(ball.positions(), &[ball.faces(), &[face]].concat());
        let found = made(&mesh, &budget);
        assert_eq!(n_faces(&found), plain + back, "{face:?}");
        let stats = found.shape.stats;
        assert_eq!((stats.degenerate_faces, stats.kept_degenerate_faces), (1 - back as u64, back as u64));
        assert!(found.bound.at_most().expect("proved") <= 0.02);
        // Points of the line have one of the result.
        let tree = triangles(&found.shape.mesh);
        for i in 0..=64 {
            let t = f64::from(i) / 64.0;
            let [p, q] = [face[0], face[1]].map(|row| ball.positions()[row as usize]);
            let at = std::array::from_fn(|k| p[k] + t * (q[k] - p[k]));
            assert!(tree.distance(at) <= 0.02, "{face:?} at {t}");
        }
        let counted = made(&mesh, &Budget::triangles(200));
        assert!(n_faces(&counted) <= 200 && n_faces(&counted) >= 196, "{face:?}: {}", n_faces(&counted));
        assert!(counted.bound.at_most().expect("proved") < 0.1, "{face:?}: {:?}", counted.bound);
        survives("a line", &mesh);
    }
}

#[test]
fn a_line_on_a_flat_side_costs_nothing() {
    let ticks = [0.0, 0.25, 0.5, 0.75, 1.0];
    let block = shapes::blocks([&ticks; 3], |_| true);
    let row = |at: [f64; 3]| {
        block.positions().iter().position(|p| *p == at).expect("a vertex of the lattice") as u32
    };
    let on_top = [0.25, 0.5, 0.75].map(|x| row([x, 0.5, 1.0]));
    let across = [[0.0, 0.0, 1.0], [0.25, 0.25, 1.0], [0.5, 0.5, 1.0]].map(row);
    for line in [on_top, across] {
        let mesh = mesh(block.positions(), &[block.faces(), &[line]].concat());
        let found = made(&mesh, &length(0.01));
        assert_eq!((n_faces(&found), found.shape.stats.degenerate_faces), (12, 1));
        assert!(found.bound.at_most().expect("proved") < 1e-12, "{:?}", found.bound);
    }
}

#[test]
fn zeros_of_either_sign_are_one_position() {
    let ball = shapes::sphere(2);
    // Every face with rows of its own, every other face with the other zero.
    let corner = |(i, row): (usize, &u32)| {
        ball.positions()[*row as usize].map(|x| if x == 0.0 && i / 3 % 2 == 1 { -x } else { x })
    };
    let positions: Vec<[f64; 3]> = ball.faces().as_flattened().iter().enumerate().map(corner).collect();
    let faces: Vec<[u32; 3]> =
        (0..ball.faces().len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let soup = mesh(&positions, &faces);
    survives("signed zeros", &soup);
    assert_eq!(n_faces(&made(&soup, &Budget::triangles(20))), 20);
}

#[test]
fn huge_and_tiny_coordinates_survive() {
    let ball = shapes::lobes(3);
    let plain = n_faces(&made(&ball, &length(0.02)));
    assert!(plain < ball.faces().len());
    for scale in [1e150, 1e-150, 1e-300, 1e300] {
        let scaled =
            mesh(&ball.positions().iter().map(|p| p.map(|x| x * scale)).collect::<Vec<_>>(), ball.faces());
        let made = made(&scaled, &length(0.02 * scale));
        assert!(n_faces(&made).abs_diff(plain) <= plain / 20, "{scale:e}: {} triangles", n_faces(&made));
        assert!(made.bound.at_most().expect("proved") <= 0.02 * scale);
        let small = self::made(&scaled, &Budget::triangles(50));
        assert_eq!(n_faces(&small), 50);
    }
    // From the one to the other in one mesh.
    survives(
        "wide",
        &mesh(&[[0.0; 3], [1e150, 0.0, 0.0], [0.0, 1e-150, 0.0], [1.0, 1.0, 1.0]], &[[0, 1, 2], [1, 3, 2]]),
    );
    let far = mesh(&[[-1.7e308, 0.0, 0.0], [1.7e308, 0.0, 0.0], [0.0, 1e308, 0.0]], &[[0, 1, 2]]);
    assert_eq!(code(&far, &Budget::triangles(1)), RefusalCode::NotFinite);
    // What stays as it is needs no distance.
    assert_eq!(made(&far, &length(1.0)).bound.at_most(), Some(0.0));
}

#[test]
fn a_length_larger_than_the_mesh_leaves_the_least() {
    for (mesh, least) in [(shapes::torus([40, 20], 0.0), 14), (shapes::mobius([60, 8]), 5)] {
        let made = made(&mesh, &length(1000.0));
        assert!((least..least + 30).contains(&n_faces(&made)), "{}", n_faces(&made));
        bounds::holds("least", &mesh, &length(1000.0), &made, &mut Random::new(1));
    }
}

#[test]
fn a_length_of_almost_nothing_is_kept() {
    let plane = shapes::blocks([&[0.0, 1.0, 2.0, 3.0], &[0.0, 1.0, 2.0, 3.0], &[0.0, 1.0]], |_| true);
    let made = made(&plane, &length(1e-300));
    assert!(made.bound.at_most().expect("proved") <= 1e-300);
}

#[test]
fn a_cancelled_job_stops() {
    let mesh = shapes::torus([1000, 500], 0.1);
    let job = Job::default().with_threads(1);
    let flag = job.clone();
    let (tell, told) = std::sync::mpsc::channel();
    let worker = std::thread::spawn(move || {
        tell.send(None).expect("somebody listens");
        let result = simplify(&mesh, &length(1e-3), Topology::Indices, &job);
        tell.send(Some(matches!(result, Err(Failure::Cancelled)))).expect("somebody listens");
    });
    assert_eq!(told.recv(), Ok(None), "it started");
    // Into the work, which takes seconds on any machine; how soon it stops is for a bench to say.
    std::thread::sleep(Duration::from_millis(700));
    flag.cancel();
    // Only a hang takes a minute.
    let cancelled = told.recv_timeout(Duration::from_secs(60)).expect("it stops");
    assert_eq!(cancelled, Some(true), "it was done before");
    worker.join().expect("no panic");
}
