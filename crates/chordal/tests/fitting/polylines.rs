//! Polylines to splines.
use super::{Sampled, fitted, sharpest};
use chordal::convert::curve_to_polyline;
use chordal::convert::splines::{Corners, SplineFit, polyline_to_spline};
use chordal::explicit::{Arc, Bezier, Curve, CurveEnds, CurveSegment, Polyline};
use chordal::{Bounded, Budget, Job, Tolerance};
use chordal_testkit::{Random, cases};
use std::f64::consts::PI;

fn spline<const D: usize>(line: &Polyline<D>, fit: &SplineFit) -> Bounded<Curve<D>> {
    polyline_to_spline(line, fit, &Job::default()).expect("a spline")
}

fn within(length: f64) -> SplineFit {
    SplineFit::within(Tolerance::new(length).expect("a length"))
}

/// The polyline as a function, by its segments.
fn sampled<const D: usize>(line: &Polyline<D>) -> Sampled<'_, D> {
    let segments: Vec<_> = line.segments().collect();
    let end = segments.len() as f64;
    let at = move |s: f64| {
        let i = (s.floor() as usize).min(segments.len() - 1);
        let ([a, b], t) = (segments[i], s - i as f64);
        std::array::from_fn(|k| a[k] + t * (b[k] - a[k]))
    };
    Sampled { at: Box::new(at), end }
}

fn distance<const D: usize>(line: &Polyline<D>, curve: &Curve<D>) -> f64 {
    let (line, path) = (sampled(line), fitted(curve));
    let n = (4.0 * line.end) as usize + 40 * curve.segments().len() + 100;
    line.farthest_from(&path, n).max(path.farthest_from(&line, n))
}

#[test]
fn no_polyline_is_farther_from_its_spline_than_the_bound_in_both_directions() {
    let mut worst = 0.0_f64;
    for seed in 0..cases(6) {
        let mut random = Random::new(seed as u64);
        let scale = random.power(-6.0, 6.0);
        let n = 2 + random.below(120);
        let kind = random.below(3);
        let (turns, mut at) = (random.between(0.1, 3.0), [0.0; 2]);
        let points: Vec<[f64; 2]> = (0..n)
            .map(|i| {
                let t = i as f64 / n as f64;
                let (s, c) = (2.0 * PI * turns * t).sin_cos();
                let step: [f64; 2] = random.point();
                at = [at[0] + step[0] * 0.1, at[1] + step[1] * 0.1];
                match kind {
                    0 => [t * c, t * s],
                    1 => at,
                    _ => [t * c + 1e-3 * step[0], t * s + 1e-3 * step[1]],
                }
                .map(|x| scale * x)
            })
            .collect();
        let line = Polyline { points, places: Vec::new(), closed: n > 2 && random.below(3) == 0 };
        let length = scale * random.power(-5.0, -0.7);
        let corners = [Corners::Sharper { deg: 30.0 }, Corners::Sharper { deg: 90.0 }, Corners::At(vec![])];
        let fit = SplineFit { corners: corners[random.below(3)].clone(), ..within(length) };
        let made = spline(&line, &fit);
        let bound = made.bound.at_most().expect("a bound");
        let found = distance(&line, &made.shape);
        assert!(
            bound <= length && found <= bound * (1.0 + 1e-6),
            "seed {seed}: {found} > {bound}, kind {kind}, {n} points, closed {}, {fit:?}, {} pieces, size {scale}",
            line.closed,
            made.shape.segments().len()
        );
        worst = worst.max(found / bound);
    }
    eprintln!("largest part of the bound: {worst}");
    assert!(worst > 0.7, "{worst}");
}

#[test]
fn a_fine_polyline_of_a_curve_gives_about_the_cubics_that_the_curve_needs() {
    let turn = Arc::new([0.0; 2], [[1.0, 0.0], [0.0, 1.0]], 0.0, 2.0 * PI).expect("a circle");
    let start = turn.at(0.0);
    let circle = Curve::new(vec![CurveSegment::Arc(turn.with_ends([start, start]))], CurveEnds::Closed)
        .expect("a path");
    let fine = |length: f64| {
        let budget = Budget::length(Tolerance::new(length / 20.0).expect("a length"));
        curve_to_polyline(&circle, &budget, &Job::default()).expect("a polyline").shape
    };
    let counts = [1e-2, 1e-3, 1e-4, 1e-6].map(|length| {
        let made = spline(&fine(length), &within(length));
        assert!(made.shape.is_closed() && sharpest(&made.shape) < 1e-6);
        made.shape.segments().len()
    });
    eprintln!("{counts:?}");
    // Four at 2e-4, by the sixth root of the length.
    assert!(counts[0] <= 4 && counts[1] <= 5 && counts[2] <= 7 && counts[3] <= 14, "{counts:?}");
    // A cubic, cut and put together again: its own handles, nearly.
    let arch = Bezier { control: [[0.0, 0.0], [1.0, 3.0], [4.0, 3.0], [5.0, 1.0]] };
    let line = curve_to_polyline(
        &arch.into(),
        &Budget::length(Tolerance::new(1e-5).expect("a length")),
        &Job::default(),
    );
    let made = spline(&line.expect("a polyline").shape, &within(1e-3));
    assert_eq!(made.shape.segments().len(), 1);
}

#[test]
fn corners_of_polygons_stay_and_lines_do() {
    let square = Polyline {
        points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        places: Vec::new(),
        closed: true,
    };
    let made = spline(&square, &within(0.01));
    let lines: Vec<_> = square.segments().map(CurveSegment::Line).collect();
    assert_eq!(made.shape.segments(), lines);
    // Without corners it is smooth, and near all the same.
    let fit = SplineFit { corners: Corners::At(vec![]), ..within(0.01) };
    let round = spline(&square, &fit);
    assert!(sharpest(&round.shape) < 1e-6 && distance(&square, &round.shape) <= 0.01);
}

#[test]
fn far_and_tiny_polylines_keep_their_bound() {
    for (away, scale, length) in [(1e9, 1.0, 1e-3), (0.0, 1e-120, 1e-123), (0.0, 1e120, 1e117)] {
        let points: Vec<[f64; 2]> = (0..100)
            .map(|i| (f64::from(i) * 0.06).sin_cos())
            .map(|(s, c)| [away + scale * c, scale * s])
            .collect();
        let line = Polyline { points, places: Vec::new(), closed: false };
        let made = spline(&line, &within(length));
        let found = distance(&line, &made.shape);
        assert!(found <= made.bound.at_most().expect("a bound"), "{away} {scale}: {found}");
        assert!(made.shape.segments().len() < 12);
    }
}
