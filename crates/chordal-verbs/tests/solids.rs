//! Scripts that combine solids: cut along each other, and judged against the field. The volumes are by formulas.
use chordal::budget::RequiredEvidence;
use chordal::check::findings::measure;
use chordal::check::validity;
use chordal::explicit::Topology;
use chordal::{Job, Mesh};
use chordal_io::{Format, Limits};
use chordal_testkit::is_long;
use chordal_verbs::{BudgetSpec, FormatHint, MeshFailure, MeshOutcome, load, mesh};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

const LENGTH: &str = "0.05";
const PI: f64 = std::f64::consts::PI;

fn made_with(text: &str, length: &str, job: &Job) -> Result<MeshOutcome, MeshFailure> {
    made_by(text, (length, None), job)
}

fn made_by(
    text: &str,
    (length, require): (&str, Option<RequiredEvidence>),
    job: &Job,
) -> Result<MeshOutcome, MeshFailure> {
    let hint = FormatHint { name: Some("a.star"), ..FormatHint::default() };
    let input = load(text.as_bytes(), hint, &Limits::default()).unwrap();
    let spec = BudgetSpec { length: Some(length.parse().unwrap()), require, ..BudgetSpec::default() };
    mesh(input, &spec, Format::Ply, job)
}

fn made(text: &str) -> MeshOutcome {
    made_with(text, LENGTH, &Job::default()).unwrap_or_else(|why| panic!("{text}: {why:?}"))
}

fn only_mesh(outcome: &MeshOutcome) -> &Mesh {
    &outcome.scene().unwrap().parts[0].mesh
}

/// Closed, manifold, and of a volume that differs by no more than the length times the area.
fn check_solid(text: &str, volume: f64) -> MeshOutcome {
    let outcome = made(text);
    let mesh = only_mesh(&outcome);
    let found = validity(mesh, Topology::Positions);
    assert!(found.closed && found.manifold() && found.oriented, "{text}: {found:?}");
    let measured = measure(mesh);
    let off = (measured.signed_volume - volume).abs();
    assert!(off <= 0.05 * measured.area + 1e-9, "{text}: {} for {volume}", measured.signed_volume);
    outcome
}

#[test]
fn volumes_of_combinations_are_those_of_formulas() {
    let lens = |r: f64, d: f64| PI * (4.0 * r + d) * (2.0 * r - d) * (2.0 * r - d) / 12.0;
    let parts: [(&str, f64); 18] = [
        ("box(10, 20, 5) - cylinder(3, 9)", 1000.0 - 45.0 * PI),
        ("sphere(5) & move(sphere(5), 4, 0)", lens(5.0, 4.0)),
        ("sphere(5) | move(sphere(5), 4, 0)", 2.0 * 500.0 / 3.0 * PI - lens(5.0, 4.0)),
        ("extrude(circle(6) - circle(4), 8)", 160.0 * PI),
        ("cylinder(6, 8) - cylinder(4, 9) - move(box(12, 3, 10), 6, 0)", {
            // Half of the strip |y| < 1.5, x > 0, in the ring.
            let part = |r: f64| 1.5 * (r * r - 2.25).sqrt() + r * r * (1.5 / r).asin();
            160.0 * PI - 8.0 * (part(6.0) - part(4.0))
        }),
        ("torus(10, 2) & plane([0, 0, 1], 0)", 40.0 * PI * PI),
        ("polar(move(cylinder(1, 4), 8, 0), 6) | cylinder(5, 4)", 6.0 * 4.0 * PI + 100.0 * PI),
        ("box(10, 10, 10) - repeat(move(cylinder(1, 20), -3, 0), x=3, nx=3)", 1000.0 - 30.0 * PI),
        ("symmetric(move(box(2, 2, 2), 3, 0), 1, 0) | box(10, 1, 1)", 16.0 + 10.0 - 4.0),
        ("revolve(move(rectangle(2, 6), 5, 0)) - rotate_x(cylinder(1, 4), 90)", 2.0 * PI * 5.0 * 12.0),
        ("rounded_box(10, 10, 10, 2) & box(20, 20, 2)", 2.0 * (100.0 - (4.0 - PI) * 4.0)),
        ("extrude(offset(polygon([[0, 0], [4, 0], [0, 3]]), 1), 2)", 2.0 * (6.0 + 12.0 + PI)),
        ("extrude(offset(polygon([[0, 0], [4, 0], [0, 3]]), -0.5), 2)", 3.0),
        ("extrude(offset(rectangle(6, 4) | circle(1), -1), 2) | box(1, 1, 4)", 16.0 + 2.0),
        ("extrude(offset(rectangle(6, 4) - circle(0.8), -0.5), 2)", 2.0 * (15.0 - 1.69 * PI)),
        ("offset(box(6, 4, 2), 1)", 48.0 + 2.0 * (24.0 + 12.0 + 8.0) + 12.0 * PI + 4.0 / 3.0 * PI),
        ("taper(rectangle(4, 2), 0.5, 4) | box(1, 0.8, 6)", 4.0 / 3.0 * 14.0 + 1.6),
        ("scale(prism(6, 2, 3), 2) - box(1, 1, 20)", 6.0 * 0.5 * 16.0 * (PI / 3.0).sin() * 6.0 - 6.0),
    ];
    for (text, volume) in parts {
        let outcome = check_solid(text, volume);
        assert!(outcome.bound.at_most().is_some_and(|most| most <= 0.05), "{text}: {}", outcome.bound);
    }
}

#[test]
fn flush_solids_are_one_whatever_they_were_turned_by() {
    let parts = [
        ("box(10, 10, 10) | move(box(6, 4, 12), 0, 7)", 1000.0 + 6.0 * 4.0 * 12.0),
        ("box(10, 10, 10) | move(box(10, 10, 0.2), 0, 0, 5.1)", 1020.0),
        ("box(4, 4, 0.6) | move(box(4, 4, 0.2), 0, 0, 0.4)", 16.0 * 0.8),
        ("union([move(box(3, 3, 1), 0, 0, k * 0.1 * 10) for k in range(9)])", 81.0),
        ("box(20, 20, 3) | move(rotate_z(box(20, 20, 3), 45), 0, 0, 3)", 2400.0),
        ("cylinder(3, 4) | move(cylinder(3, 4), 0, 0, 4)", 72.0 * PI),
        ("box(10, 10, 10) - move(box(4, 4, 4), 3, 3, 3)", 1000.0 - 64.0),
        ("box(6, 6, 6) - move(cylinder(3, 6), 3, 3)", 216.0 - 6.0 * 9.0 * PI / 4.0),
    ];
    for (number, (text, volume)) in parts.into_iter().enumerate() {
        let all = [0, 30].into_iter().flat_map(|turn| {
            let slanted =
                format!("rotate([1, 2, 3], {turn})").replace("rotate(", &format!("rotate({text}, "));
            [format!("rotate_z({text}, {turn})"), slanted]
        });
        // By default each part in one way, and each way twice.
        for (_, turned) in all.enumerate().filter(|(way, _)| is_long() || *way == number % 4) {
            check_solid(&turned, volume);
        }
    }
    // Each turned by itself.
    let turned = "rotate_z(box(10, 10, 10), 30) | rotate_z(move(box(6, 4, 12), 0, 7), 30)";
    check_solid(turned, 1000.0 + 6.0 * 4.0 * 12.0);
}

#[test]
fn a_combination_that_leaves_nothing_says_so() {
    for text in ["box(1, 1, 1) - box(2, 2, 2)", "sphere(1) & move(sphere(1), 5, 0)"] {
        let Err(MeshFailure::Refused(refusal)) = made_with(text, LENGTH, &Job::default()) else {
            panic!("{text} has a mesh")
        };
        assert_eq!(refusal.code, chordal::budget::RefusalCode::Empty, "{text}");
    }
}

#[test]
fn a_part_that_cuts_lose_is_not_forgotten() {
    // A sliver of a cylinder that its polygon does not reach, beside a box that nothing cuts.
    let lens = "rotate_z(cylinder(40, 10), 2.3) & move(box(10, 30, 10), 44.99, 0, 0)";
    let outcome = made(&format!("({lens}) | move(box(5, 5, 5), 100, 0)"));
    let has_lens = only_mesh(&outcome).positions().iter().any(|p| p[0] < 41.0);
    assert!(has_lens || outcome.bound.at_most().is_none(), "{}", outcome.bound);
}

#[test]
fn a_thousand_boxes_are_one_solid() {
    // An eighth of them by default.
    let n = if is_long() { 10 } else { 5 };
    let stack = format!("union([move(box(2, 2, 1), 0, 0, k) for k in range({})])", n * n * n);
    check_solid(&stack, 4.0 * f64::from(n * n * n));
    let each = format!("for i in range({n}) for j in range({n}) for k in range({n})");
    let grid = format!("union([move(box(1.25, 1.25, 1.25), i, j, k) {each}])");
    check_solid(&grid, (f64::from(n) + 0.25).powi(3));
}

#[test]
fn many_solids_are_there_if_coarse_where_time_ends_in_their_cuts() {
    let n = 5;
    let balls = format!(
        "union([move(sphere(0.6), i, j, k) for i in range({n}) for j in range({n}) for k in range({n})])"
    );
    let combined = Arc::new(AtomicU64::new(0));
    let counting = |ends_at: u64| {
        let (counted, ending) = (Arc::clone(&combined), Arc::new(OnceLock::<Job>::new()));
        let own = Arc::clone(&ending);
        let job = Job::default().with_progress(move |progress| {
            if progress.stage == "combine" && counted.fetch_add(1, Ordering::Relaxed) + 1 == ends_at {
                own.get().expect("it has begun").finish();
            }
        });
        ending.set(job.clone()).expect("once");
        job
    };
    // Cuts of coarse balls, and as many of fine ones.
    let goal = (LENGTH, Some(RequiredEvidence::Measured));
    let made = made_by(&balls, goal, &counting(u64::MAX)).expect("met");
    let whole = measure(only_mesh(&made)).signed_volume;
    let n_cuts = combined.swap(0, Ordering::Relaxed) / 2;
    let Err(MeshFailure::Unmet(best)) = made_by(&balls, goal, &counting(n_cuts + n_cuts / 2)) else {
        panic!("it was not ended")
    };
    let coarse = measure(only_mesh(&best)).signed_volume;
    assert!(only_mesh(&best).faces().len() < only_mesh(&made).faces().len() / 2);
    // The length is longer than the radius: each ball is an octahedron.
    assert!((coarse / whole - 1.0).abs() < 0.5, "{coarse} of {whole}");
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let text = "rotate_x(polar(move(cylinder(1, 4), 5, 0), 7) | cylinder(5.5, 4), 20) - move(sphere(3), 0, 0, 2) - \
        plane([0, 1, 1], -4)";
    let bytes = |threads: usize| {
        let mut out = Vec::new();
        let job = Job::default().with_threads(threads);
        made_with(text, LENGTH, &job).unwrap().write(&mut out).unwrap();
        out
    };
    let one = bytes(1);
    assert!(one.len() > 1000);
    assert_eq!(one, bytes(4));
}
