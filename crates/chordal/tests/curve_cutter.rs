//! The ways to cut many curves give the same points as the one for a single path, on every set of
//! instructions.
use chordal::convert::batch::BezierCutter;
use chordal::convert::{self, Spacing};
use chordal::explicit::{Bezier, Curve};
use chordal::math::simd::{Isa, isa};
use chordal::{Budget, Failure, Job, Tolerance};
use chordal_testkit::Fingerprint;
use chordal_testkit::Random;

fn curves<const D: usize>(n: usize) -> Vec<Bezier<D>> {
    let mut random = Random::new(11);
    (0..n).map(|_| Bezier { control: [0; 4].map(|_| [0; D].map(|_| random.unit())) }).collect()
}

fn same_points<const D: usize>() {
    let curves = curves::<D>(600);
    for (tolerance, spacing) in [(1e-2, Spacing::Fewest), (1e-4, Spacing::Fewest), (1e-3, Spacing::Even)] {
        let tolerance = Tolerance::new(tolerance).unwrap();
        let batch =
            convert::batch::beziers_to_polylines(&curves, tolerance, &Job::default(), spacing).unwrap();
        let alone = Job::default().with_threads(1);
        assert_eq!(convert::batch::beziers_to_polylines(&curves, tolerance, &alone, spacing).unwrap(), batch);
        let mut cutter = BezierCutter::new(tolerance, spacing).unwrap();
        for (i, curve) in curves.iter().enumerate() {
            let path: Curve<D> = (*curve).into();
            let budget = Budget::length(tolerance);
            let single = match spacing {
                Spacing::Fewest => convert::curve_to_polyline(&path, &budget, &Job::default()).unwrap(),
                Spacing::Even => convert::curve_to_polyline_evenly(&path, &budget, &Job::default()).unwrap(),
            };
            assert_eq!(batch.shape.polyline(i), single.shape.points, "curve {i}");
            let mut points = vec![curve.control[0]];
            let bound = cutter.append(curve, &mut points).unwrap();
            assert_eq!(points, single.shape.points);
            assert!(bound >= single.bound.at_least() && bound <= tolerance.get());
            assert!(batch.bound.at_most().unwrap() >= bound);
        }
    }
}

#[test]
fn one_curve_alone_is_cut_as_it_is_among_many_in_the_plane() {
    same_points::<2>();
}

#[test]
fn one_curve_alone_is_cut_as_it_is_among_many_in_space() {
    same_points::<3>();
}

/// Runs itself again under each set of instructions, since the choice is made once in a process.
#[test]
fn every_set_of_instructions_gives_the_same_points() {
    let made = || {
        let mut all = String::new();
        for (tolerance, spacing) in [(1e-1, Spacing::Fewest), (1e-4, Spacing::Fewest), (1e-3, Spacing::Even)]
        {
            let tolerance = Tolerance::new(tolerance).unwrap();
            let made =
                convert::batch::beziers_to_polylines(&curves::<2>(400), tolerance, &Job::default(), spacing)
                    .unwrap();
            let mut sum = Fingerprint::default();
            sum.add_bits(made.shape.points.as_flattened());
            let bound = made.bound.at_most().unwrap().to_bits();
            all += &format!("{} {:x} {bound:x};", made.shape.points.len(), sum.0);
        }
        all
    };
    const MARK: &str = "points of this set of instructions: ";
    if std::env::var("CHORDAL_ISA").is_ok_and(|name| name != "parent") {
        println!("{MARK}{}", made());
        return;
    }
    let expected = made();
    for set in Isa::ALL {
        if !set.is_available() {
            eprintln!("SKIPPED: {set:?} is not in this processor (which uses {:?})", isa());
            continue;
        }
        let output = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["curve_cutter::every_set_of_instructions_gives_the_same_points", "--exact", "--nocapture"])
            .env("CHORDAL_ISA", set.as_str())
            .output()
            .unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        let found = text.split(MARK).nth(1).and_then(|rest| rest.lines().next());
        assert_eq!(found, Some(expected.as_str()), "{set:?}");
    }
}

#[test]
fn what_cannot_be_cut_is_refused() {
    let mut cutter = BezierCutter::new(Tolerance::new(1e-10).unwrap(), Spacing::Fewest).unwrap();
    let mut code = |x: f64| {
        let curve = Bezier { control: [[0.0, 0.0], [x, 0.0], [0.0, x], [x, x]] };
        match cutter.append(&curve, &mut Vec::new()) {
            Err(Failure::Refused(refusal)) => refusal.code.as_str(),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(code(f64::NAN), "not-finite");
    assert_eq!(code(f64::INFINITY), "not-finite");
    assert_eq!(code(1e200), "not-finite");
    assert_eq!(code(1e6), "below-precision");
}
