//! The same numbers on one thread and on two, and with whatever instructions the machine has.
use super::chains::chain;
use super::families::shape;
use super::truth::Path;
use chordal::convert::{Spacing, curves_to_polylines};
use chordal::{Budget, Job, Tolerance};
use chordal_testkit::Fingerprint;
use std::process::Command;

/// In the environment of the tests that this one starts: the digest that they must come to.
const EXPECTED: &str = "CHORDAL_REFEREE_DIGEST";

/// All bits of the polylines of many paths under some budgets, folded into a number.
fn digest(threads: usize) -> u64 {
    let mut sum = Fingerprint::default();
    let cubics = (0..900).map(|seed| Path::cubic(shape::<2>(seed).control));
    let curves: Vec<_> = cubics.chain((0..60).map(chain)).map(|path| path.library()).collect();
    let length = |l: f64| Budget::length(Tolerance::new(l).expect("positive"));
    for spacing in [Spacing::Fewest, Spacing::Even] {
        // Sizes run up to 1e6 and more.
        for budget in [length(10.0), length(3.0), Budget::segments(20_000)] {
            let job = Job::default().with_threads(threads);
            let made = curves_to_polylines(&curves, &budget, &job, spacing).expect("within reach");
            for polyline in &made.shape {
                sum.add_number(polyline.points.len() as u64);
                sum.add_bits(polyline.points.as_flattened().iter().chain(&polyline.places));
            }
            sum.add_bits(&[made.bound.at_least(), made.bound.at_most().expect("proved")]);
        }
    }
    sum.0
}

#[test]
fn the_same_on_every_number_of_threads() {
    let one = digest(1);
    for threads in [2, 3] {
        assert_eq!(one, digest(threads), "on {threads} threads");
    }
    if let Ok(expected) = std::env::var(EXPECTED) {
        assert_eq!(expected, one.to_string(), "with CHORDAL_ISA={:?}", std::env::var("CHORDAL_ISA"));
    }
}

#[test]
fn the_same_with_all_instructions() {
    let expected = digest(1).to_string();
    for isa in ["plain", "avx2", "avx512"] {
        // The choice is made once in a process, so each has its own.
        let run = |expected: &str| {
            Command::new(std::env::current_exe().expect("a test has a file"))
                .args(["--exact", "curve_referee::same::the_same_on_every_number_of_threads"])
                .env("CHORDAL_ISA", isa)
                .env(EXPECTED, expected)
                .output()
                .expect("the test runs")
        };
        let done = run(&expected);
        assert!(done.status.success(), "{isa}: {}", String::from_utf8_lossy(&done.stdout));
        assert!(String::from_utf8_lossy(&done.stdout).contains("1 passed"), "{isa}: no test ran");
        assert!(!run("1").status.success(), "a wrong digest passes with {isa}");
    }
}
