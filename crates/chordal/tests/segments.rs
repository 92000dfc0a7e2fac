//! The tables of `docs/segments.md` are what the library makes today, and the formulas beside them are right.
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment};
use chordal::{Budget, Job, Tolerance, convert};
use std::f64::consts::PI;

#[path = "../examples/segments.rs"]
#[allow(dead_code)]
mod example;

const PAGE: &str = include_str!("../../../docs/segments.md");

#[test]
fn the_page_shows_what_the_library_makes() {
    let renewed = example::renewed(PAGE).unwrap();
    assert!(renewed == PAGE, "run `cargo run -p chordal --example segments -- docs/segments.md`");
    // A page with another number is seen.
    let other = PAGE.replacen("| 10 ", "| 11 ", 1);
    assert!(other != PAGE && example::renewed(&other).unwrap() == PAGE);
    assert!(example::renewed("no marks").is_err());
}

#[test]
fn a_circle_takes_as_many_segments_as_its_formula_says() {
    for radius in [0.5, 5.0, 500.0, 5000.0] {
        for error in [1.0, 0.5, 0.25, 1e-3] {
            let arc = Arc::new([0.0; 2], [[radius, 0.0], [0.0, radius]], 0.0, 2.0 * PI).unwrap();
            let start = arc.ends()[0];
            let circle =
                Curve::new(vec![CurveSegment::Arc(arc.with_ends([start, start]))], CurveEnds::Closed)
                    .unwrap();
            let budget = Budget::length(Tolerance::new(error).unwrap());
            let made =
                convert::curve_to_polyline(&circle, &budget, &Job::default()).unwrap().shape.n_segments();
            // No chord of more than half a turn; beyond the radius any polygon will do.
            let formula = if error < radius { (PI / (1.0 - error / radius).acos()).ceil() } else { 2.0 };
            assert!(
                (formula..=formula.max(2.0) + 1.0).contains(&(made as f64)),
                "{radius}, {error}: {made} for {formula}"
            );
        }
    }
}
