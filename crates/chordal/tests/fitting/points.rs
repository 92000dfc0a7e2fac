//! Points to splines.
use super::{distance, fitted, sharpest};
use chordal::convert::splines::{Corners, SplineFit, points_to_spline};
use chordal::explicit::{Curve, CurveEnds, CurveSegment};
use chordal::{Bounded, Failure, Job, Tolerance};
use chordal_testkit::{Random, cases};
use std::f64::consts::PI;

fn fit(length: f64, corners: Option<Vec<usize>>) -> SplineFit {
    let plain = SplineFit::within(Tolerance::new(length).expect("a length"));
    match corners {
        Some(at) => SplineFit { corners: Corners::At(at), ..plain },
        None => plain,
    }
}

fn near<const D: usize>(points: &[[f64; D]], ends: CurveEnds, fit: &SplineFit) -> Bounded<Curve<D>> {
    points_to_spline(points, ends, fit, &Job::default()).expect("a spline")
}

/// The largest distance of a point from the path.
fn farthest<const D: usize>(points: &[[f64; D]], curve: &Curve<D>) -> f64 {
    let path = fitted(curve);
    let grid = path.grid(60 * curve.segments().len().max(1));
    points.iter().map(|p| path.distance(*p, &grid)).fold(0.0, f64::max)
}

fn circle(n: usize, radius: f64) -> Vec<[f64; 2]> {
    (0..n)
        .map(|i| (2.0 * PI * i as f64 / n as f64).sin_cos())
        .map(|(s, c)| [radius * c, radius * s])
        .collect()
}

#[test]
fn no_point_is_farther_from_its_spline_than_the_bound() {
    for seed in 0..cases(60) {
        let mut random = Random::new(seed as u64);
        let scale = random.power(-6.0, 6.0);
        let n = 2 + random.below(200);
        let noise = [0.0, 1e-3, 0.1][random.below(3)];
        let turns = random.between(0.1, 4.0);
        let points: Vec<[f64; 3]> = (0..n)
            .map(|i| {
                let t = i as f64 / n as f64;
                let (s, c) = (2.0 * PI * turns * t).sin_cos();
                let shake: [f64; 3] = random.point_within(noise);
                [t * c + shake[0], t * s + shake[1], t + shake[2]].map(|x| scale * x)
            })
            .collect();
        let length = scale * random.power(-6.0, -0.5);
        let corners = [None, Some(vec![]), Some(vec![n / 2])][random.below(3)].clone();
        let ends = CurveEnds::from(random.below(3) == 0);
        let made = near(&points, ends, &fit(length, corners));
        let bound = made.bound.at_most().expect("a bound");
        let found = farthest(&points, &made.shape);
        assert!(bound <= length && found <= bound, "seed {seed}: {found} > {bound}");
        assert_eq!(made.shape.is_closed(), ends == CurveEnds::Closed);
        assert_eq!(made.bound.metric.as_str(), "one-sided");
    }
}

#[test]
fn a_noisy_circle_takes_few_pieces_and_is_smooth() {
    let mut random = Random::new(5);
    let points: Vec<[f64; 2]> = circle(2000, 1.0)
        .iter()
        .map(|p| {
            let off: [f64; 2] = random.point_within(0.005);
            [p[0] + off[0], p[1] + off[1]]
        })
        .collect();
    let made = near(&points, CurveEnds::Closed, &fit(0.01, Some(vec![])));
    let n = made.shape.segments().len();
    eprintln!("{n} pieces, {}", made.bound);
    assert!(n <= 8, "{n}");
    assert!(sharpest(&made.shape) < 1e-6);
    // Where there are no points: near the circle all the same.
    let grid = fitted(&made.shape).grid(1000);
    let off = grid.iter().map(|(_, p)| (p[0].hypot(p[1]) - 1.0).abs()).fold(0.0, f64::max);
    assert!(off < 0.03, "{off}");
}

#[test]
fn exact_points_of_a_circle_take_as_many_as_the_sixth_order_says() {
    let points = circle(4000, 3.0);
    let n = |length: f64| near(&points, CurveEnds::Closed, &fit(length, None)).shape.segments().len();
    let counts = [3.0 * 2.6e-4, 3e-6, 3e-8].map(n);
    eprintln!("{counts:?}");
    assert!(counts[0] <= 5 && counts[1] <= 12 && counts[2] <= 25, "{counts:?}");
}

#[test]
fn corners_are_kept_where_they_are_found_and_where_they_are_given() {
    // A square with many points on each side.
    let side = |a: [f64; 2], b: [f64; 2]| {
        (0..50).map(move |i| f64::from(i) / 50.0).map(move |t| [0, 1].map(|k| a[k] + t * (b[k] - a[k])))
    };
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let points: Vec<[f64; 2]> = (0..4).flat_map(|i| side(corners[i], corners[(i + 1) % 4])).collect();
    for fit in [fit(1e-3, None), fit(1e-3, Some(vec![0, 50, 100, 150]))] {
        let made = near(&points, CurveEnds::Closed, &fit);
        let lines: Vec<_> = made.shape.segments().to_vec();
        let expected: Vec<_> =
            (0..4).map(|i| CurveSegment::Line([corners[i], corners[(i + 1) % 4]])).collect();
        assert_eq!(lines, expected);
    }
    // Points in between, and the first corner later.
    let turned: Vec<[f64; 2]> = points[20..].iter().chain(&points[..20]).copied().collect();
    assert_eq!(near(&turned, CurveEnds::Closed, &fit(1e-3, None)).shape.segments().len(), 4);
}

#[test]
fn few_points_and_equal_ones_are_points_and_lines() {
    let one = [[1.0, 2.0]];
    assert_eq!(
        near(&one, CurveEnds::Open, &fit(0.1, None)).shape,
        Curve::point([1.0, 2.0]).expect("a point")
    );
    assert_eq!(near(&[one[0]; 5], CurveEnds::Closed, &fit(0.1, None)).bound.at_most(), Some(0.0));
    let two = [[0.0, 0.0], [0.0, 0.0], [3.0, 4.0], [3.0, 4.0]];
    let line = near(&two, CurveEnds::Open, &fit(0.1, None)).shape;
    assert_eq!(line.segments(), [CurveSegment::Line([[0.0, 0.0], [3.0, 4.0]])]);
    let back = near(&two, CurveEnds::Closed, &fit(0.1, None)).shape;
    assert!(back.is_closed() && farthest(&two, &back) < 0.1);
    let smooth = near(&two, CurveEnds::Closed, &fit(0.1, Some(vec![]))).shape;
    assert!(farthest(&two, &smooth) < 0.1);
}

#[test]
fn refusals_are_sentences_with_the_place() {
    let refused = |points: &[[f64; 2]], fit: &SplineFit| match points_to_spline(
        points,
        CurveEnds::Open,
        fit,
        &Job::default(),
    ) {
        Err(Failure::Refused(why)) => why.message.to_string(),
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&[], &fit(1.0, None)), "a path needs a point");
    assert!(refused(&[[0.0, 0.0], [f64::NAN, 1.0]], &fit(1.0, None)).starts_with("point 1 "));
    assert!(refused(&[[0.0, 0.0], [1e200, 1.0]], &fit(1.0, None)).starts_with("point 1 "));
    assert!(refused(&[[0.0, 0.0]], &fit(1.0, Some(vec![7]))).contains("corner 7"));
    let far = [[1e9, 0.0], [1e9 + 1.0, 1.0], [1e9, 2.0]];
    assert!(refused(&far, &fit(1e-9, None)).contains("rounding"));
    let wide = SplineFit { corners: Corners::Sharper { deg: 200.0 }, ..fit(1.0, None) };
    assert!(refused(&far, &wide).contains("200"));
    assert!(distance([0.0; 2], [0.0; 2]) == 0.0);
}
