//! Inputs that broke the bound, the count or the patience of the flattener, and must not again.
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment, Polyline};
use chordal::{Bezier, Bounded, Budget, Failure, Job, Tolerance, convert};

type Made<const D: usize> = Result<Bounded<Polyline<D>>, Failure<Polyline<D>>>;

fn length(tolerance: f64) -> Budget {
    Budget::length(Tolerance::new(tolerance).expect("a positive length"))
}

fn fewest<const D: usize>(curve: &Curve<D>, budget: &Budget) -> Made<D> {
    convert::curve_to_polyline(curve, budget, &Job::default().with_threads(1))
}

fn even<const D: usize>(curve: &Curve<D>, budget: &Budget) -> Made<D> {
    convert::curve_to_polyline_evenly(curve, budget, &Job::default().with_threads(1))
}

/// The bound of a result, or that there is none because it was refused.
fn at_most<const D: usize>(made: Made<D>) -> Option<f64> {
    match made {
        Ok(made) => made.bound.at_most(),
        Err(Failure::Unmet(best)) => best.bound.at_most(),
        Err(_) => None,
    }
}

fn arch(scale: f64) -> Curve<2> {
    Bezier { control: [[0.0, 0.0], [0.0, scale], [scale, scale], [scale, 0.0]] }.into()
}

fn circle(radius: f64) -> Curve<2> {
    let arc = Arc::new([0.0; 2], [[radius, 0.0], [0.0, radius]], 0.0, 3.0).expect("an arc");
    Curve::new(vec![CurveSegment::Arc(arc)], CurveEnds::Open).expect("a path")
}

#[test]
fn squares_that_vanish_hide_no_distance() {
    // One segment for the arch is off by 0.75 of its scale, for the arc of 3 rad by 1 − cos 1.5 = 0.929 of
    // its radius.
    for exponent in [-140, -150, -154, -158, -160, -161, -162, -165, -200, -300, -310, -320] {
        let scale: f64 = format!("1e{exponent}").parse().expect("a number");
        for make in [fewest, even] {
            let made = make(&arch(scale), &Budget::segments(1));
            assert!(at_most(made).is_none_or(|most| most >= 0.7499 * scale), "arch of 1e{exponent}");
            let made = make(&circle(scale), &Budget::segments(1));
            assert!(at_most(made).is_none_or(|most| most >= 0.9 * scale), "circle of 1e{exponent}");
            let made = make(&arch(scale), &length(0.5 * scale));
            let enough = made.is_ok_and(|made| made.shape.n_segments() == 1);
            assert!(!enough, "1e{exponent}: one segment is no arch to half of its scale");
        }
    }
}

#[test]
fn a_bound_is_never_over_its_budget_by_a_unit_in_the_last_place() {
    // Tolerances right at what n equal steps lose.
    for (k, height) in (1..200).map(|k| (k, 1.0 + f64::from(k) / 7.0)) {
        for far in [0.0, 1.0, 1e3, 1e9, 1e12] {
            let bow = Bezier {
                control: [[far, far], [far + 1.0, far + height], [far + 2.0, far + height], [far + 3.0, far]],
            };
            let curve = Curve::from(bow);
            for n in [1, 2, 3, 5] {
                let Some(most) = at_most(even(&curve, &Budget::segments(n))) else { continue };
                let mut tolerance = most;
                for _ in 0..6 {
                    tolerance = tolerance.next_down();
                }
                for _ in 0..12 {
                    tolerance = tolerance.next_up();
                    for make in [fewest, even] {
                        if let Ok(made) = make(&curve, &length(tolerance)) {
                            let most = made.bound.at_most().expect("proved");
                            assert!(most <= tolerance, "{k} {far} {n}: {most:e} > {tolerance:e}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn numbers_near_the_end_of_the_range_are_bounded_or_refused() {
    for scale in [1e140, 1e149, 9e149, 1.1e150, 1e160, 1e200, 1e300] {
        for budget in [Budget::segments(1), Budget::segments(7), length(0.01 * scale), length(1e-3 * scale)] {
            for make in [fewest, even] {
                let made = make(&arch(scale), &budget);
                assert!(at_most(made).is_none_or(|most| most.is_finite()));
                let made = make(&circle(scale), &budget);
                assert!(at_most(made).is_none_or(|most| most.is_finite()));
                // A short arc about a far centre: its points are near, its axes are not.
                for sweep in [1e-3, 1e-9, 1e-17] {
                    let arc =
                        Arc::new([-scale, 0.0], [[scale, 0.0], [0.0, scale]], 0.0, sweep).expect("an arc");
                    let curve = Curve::new(vec![CurveSegment::Arc(arc)], CurveEnds::Open).expect("a path");
                    let _ = at_most(make(&curve, &budget));
                    let _ = at_most(make(&curve, &Budget { segments: Some(9), ..length(1.0) }));
                }
            }
        }
    }
}

#[test]
fn a_point_is_a_point_under_every_budget() {
    for p in [[0.0, 0.0], [-0.0, 0.0], [1.0, -2.0], [1e-310, 0.0], [1e149, 1e149]] {
        let curve = Curve::from(Bezier { control: [p; 4] });
        for make in [fewest, even] {
            for budget in
                [Budget::segments(1), Budget::segments(1000), length(1e-3_f64.max(1e-9 * p[0].abs()))]
            {
                let made = make(&curve, &budget);
                let made = made.unwrap_or_else(|failure| panic!("{p:?} {budget:?}: {failure}"));
                assert!(made.shape.points == [p], "{p:?} {budget:?}: {} points", made.shape.points.len());
            }
        }
    }
}

#[test]
fn a_large_count_lifts_no_limit_of_the_job() {
    // The length needs about 1e9 steps or more: refused, or the best of what the job allows, soon.
    let mut job = Job::default().with_threads(1);
    (job.triangle_limit, job.memory_limit) = (1000, 1 << 20);
    for most in [2000, 1_000_000, u64::MAX - 1, u64::MAX] {
        let budget = Budget { segments: Some(most), ..length(1e-9) };
        match convert::curve_to_polyline(&arch(1.0), &budget, &job) {
            Ok(made) => panic!("{} segments where the job allows 1000", made.shape.n_segments()),
            Err(Failure::Unmet(best)) => assert!(best.shape.n_segments() <= 1000),
            Err(_) => {}
        }
        let alone =
            convert::curve_to_polyline(&arch(1.0), &Budget::segments(most), &job).expect("any polyline");
        assert!(alone.shape.n_segments() <= 1000);
        let alone = convert::curve_to_polyline_evenly(&arch(1.0), &Budget::segments(most), &job)
            .expect("any polyline");
        assert!(alone.shape.n_segments() <= 1000);
    }
}
