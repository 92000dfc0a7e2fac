//! Arcs of circles and ellipses, whose truth is known in closed form, and of every hard shape.
use super::lengths::{check, judge};
use super::truth::{Path, Round};
use super::{cases, flatten, for_all, quantile};
use chordal::Budget;
use chordal::convert::Spacing;
use chordal_testkit::Random;
use std::f64::consts::{PI, TAU};

fn circle(radius: f64, sweep: f64) -> Round<2> {
    Round { centre: [0.0; 2], axes: [[radius, 0.0], [0.0, radius]], start: 0.0, sweep, ends: None }
}

#[test]
fn an_arc_of_a_circle_loses_its_sagitta_and_no_more() {
    for sweep in [0.1, 1.0, PI / 2.0, 3.0, PI, 5.0, TAU, -2.0] {
        for n in [4_u64, 5, 7, 16, 100, 1000, 30_000] {
            let made = flatten(&Path::arc(circle(3.0, sweep)), &Budget::segments(n), Spacing::Even)
                .expect("n segments");
            let made_of = made.shape.n_segments() as u64;
            assert_eq!(made_of, n, "{n} equal steps of {sweep}");
            // r(1 − cos(θ/2N)) without cancellation.
            let sagitta = 3.0 * 2.0 * (sweep / (4.0 * n as f64)).sin().powi(2);
            let at_most = made.bound.at_most().expect("proved");
            // 1024 ε of centre and axes, 6 in all, is the allowance for rounding.
            let rounding = 1100.0 * f64::EPSILON * 12.0;
            assert!(at_most >= sagitta * (1.0 - 1e-15), "{sweep} in {n}: {at_most:e} < {sagitta:e}");
            assert!(
                at_most <= sagitta * (1.0 + 1e-9) + rounding,
                "{sweep} in {n}: {at_most:e} > {sagitta:e}"
            );
            let at_least = made.bound.at_least();
            assert!(
                at_least >= sagitta * (1.0 - 1e-9) - 3.0 * rounding,
                "{sweep} in {n}: {at_least:e} < {sagitta:e}"
            );
        }
    }
}

/// A random arc: round, long, sheared, short, nearly full.
fn round<const D: usize>(seed: usize) -> Round<D> {
    let r = &mut Random::new(seed as u64 + 77);
    let (u, v): ([f64; D], [f64; D]) = (r.direction(), r.direction());
    let ratio = match r.below(4) {
        0 => 1.0,
        1 => r.power(-12.0, 12.0),
        _ => r.power(-6.0, 6.0),
    };
    let scale = if r.below(3) == 0 { r.power(-6.0, 6.0) } else { 1.0 };
    let axes = match r.below(4) {
        // Axes at right angles, axes that are nearly one line, any axes.
        0 => [
            std::array::from_fn(|k| if k == 0 { scale } else { 0.0 }),
            std::array::from_fn(|k| if k == 1 { scale * ratio } else { 0.0 }),
        ],
        1 => {
            let by = r.power(-12.0, 0.0);
            [u.map(|x| scale * x), std::array::from_fn(|k| scale * ratio.min(1.0) * (u[k] + by * v[k]))]
        }
        _ => [u.map(|x| scale * x), v.map(|x| scale * ratio * x)],
    };
    let sweep = match r.below(6) {
        0 => TAU,
        1 => -TAU,
        2 => TAU * (1.0 - r.power(-15.0, -1.0)),
        3 => r.power(-9.0, 0.0),
        _ => r.between(-TAU, TAU),
    };
    let far = if r.below(3) == 0 { scale * r.power(0.0, 4.0) } else { 0.0 };
    Round {
        centre: r.point().map(|x| far * x),
        axes,
        start: r.between(-4.0 * PI, 4.0 * PI),
        sweep,
        ends: None,
    }
}

#[test]
fn no_polyline_is_further_from_its_arc_than_its_bound() {
    let all = for_all(cases(1200), |seed| {
        let mut found = Vec::new();
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
            let spacing = if seed % 3 == 0 { Spacing::Even } else { Spacing::Fewest };
            let case = if seed % 2 == 0 {
                let round = round::<2>(seed);
                judge(format!("arc (seed {seed}), {round:?}"), &Path::arc(round), tolerance, spacing)
            } else {
                let round = round::<3>(seed);
                judge(format!("arc (seed {seed}), {round:?}"), &Path::arc(round), tolerance, spacing)
            };
            found.extend(case);
        }
        found
    });
    let mut ratios = Vec::new();
    for mut case in all.into_iter().flatten() {
        // Sine and cosine have no more digits than the slack allows for.
        case.measured = (case.measured - case.slack).max(0.0);
        check(&case);
        if case.is_lossy() {
            ratios.push(case.at_most / case.measured);
        }
    }
    let n = ratios.len();
    let [median, high, most] = [0.5, 0.9, 1.0].map(|q| quantile(&mut ratios, q));
    eprintln!("{n} arcs: at_most/measured median {median:.4}, 90 % {high:.3}, most {most:.2}");
    assert!(median <= 1.3, "half of the bounds are more than {median} times the distance");
}
