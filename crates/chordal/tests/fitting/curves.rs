//! Curves to cubics.
use super::{Sampled, distance, fitted, sharpest};
use chordal::convert::curve_to_cubics;
use chordal::explicit::nurbs::{KnotVector, NurbsCurve};
use chordal::explicit::parametric::SvgArcShape;
use chordal::explicit::{Arc, Bezier, Curve, CurveEnds, CurveSegment};
use chordal::{Bounded, Failure, Job, Tolerance};
use chordal_testkit::{Random, cases};
use std::f64::consts::PI;

fn cubics<const D: usize>(curve: &Curve<D>, length: f64) -> Result<Bounded<Curve<D>>, Failure<Curve<D>>> {
    curve_to_cubics(curve, Tolerance::new(length).expect("a length"), &Job::default())
}

/// A rational Bézier curve by the sum of its Bernstein polynomials.
fn rational<const D: usize>(control: &[[f64; D]], weights: &[f64], t: f64) -> [f64; D] {
    let n = control.len() - 1;
    let (mut above, mut below, mut binomial) = ([0.0; D], 0.0, 1.0);
    for i in 0..=n {
        let basis = binomial * weights[i] * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32);
        below += basis;
        for k in 0..D {
            above[k] += basis * control[i][k];
        }
        binomial = binomial * (n - i) as f64 / (i + 1) as f64;
    }
    above.map(|x| x / below)
}

fn piece<const D: usize>(control: &[[f64; D]], weights: &[f64]) -> Curve<D> {
    let knots = KnotVector::clamped(control.len() - 1, control.len()).expect("knots");
    NurbsCurve::new(knots, control.to_vec(), weights.to_vec()).expect("a curve").to_curve().expect("a path")
}

#[test]
fn no_rational_piece_is_farther_from_its_cubics_than_the_bound() {
    let (mut worst, mut pieces) = (0.0_f64, 0);
    for seed in 0..cases(12) {
        let mut random = Random::new(seed as u64);
        let degree = 2 + random.below(4);
        let scale = random.power(-3.0, 3.0);
        let reach = [0.0, 100.0 * scale][random.below(2)];
        let away: [f64; 2] = random.point_within(reach);
        let spread = [0.0, 0.5, 2.0, 6.0][random.below(4)];
        let mut control: Vec<[f64; 2]> = (0..=degree)
            .map(|_| random.point_within(scale))
            .map(|p: [f64; 2]| [p[0] + away[0], p[1] + away[1]])
            .collect();
        // Coincident control points: no tangent at an end, or a cusp.
        match random.below(6) {
            0 => control[1] = control[0],
            1 => control[degree - 1] = control[degree],
            2 => control[1] = control[degree],
            _ => {}
        }
        let weights: Vec<f64> = (0..=degree).map(|_| random.power(-spread, spread)).collect();
        let length = scale * random.power(-6.0, -1.0);
        let curve = piece(&control, &weights);
        let made = match cubics(&curve, length) {
            Ok(made) => made,
            // Only where weights or the distance from the origin leave no digits.
            Err(Failure::Refused(why)) => {
                assert_eq!(why.code.as_str(), "below-precision", "seed {seed}: {}", &*why.message);
                let reach = away[0].abs() + away[1].abs() + 2.0 * scale;
                let ratio = weights.iter().fold(0.0, |a: f64, b| a.max(*b))
                    / weights.iter().fold(f64::INFINITY, |a: f64, b| a.min(*b));
                assert!(length < 1e-10 * reach * ratio, "seed {seed}: {length}");
                continue;
            }
            Err(other) => panic!("seed {seed}: {other}"),
        };
        let bound = made.bound.at_most().expect("a bound");
        assert!(bound <= length);
        assert_eq!([made.shape.start(), made.shape.end()], [curve.start(), curve.end()]);
        let truth = Sampled { at: Box::new(|t| rational(&control, &weights, t)), end: 1.0 };
        let result = fitted(&made.shape);
        let n = 150 + 10 * made.shape.segments().len();
        let found = truth.farthest_from(&result, n).max(result.farthest_from(&truth, n));
        assert!(
            found <= bound * (1.0 + 1e-6),
            "seed {seed}: {found} > {bound}, degree {degree}, {weights:?}"
        );
        worst = worst.max(found / bound);
        pieces += made.shape.segments().len();
    }
    eprintln!("largest part of the bound {worst}, {pieces} pieces");
    assert!(worst > 0.8, "{worst}");
}

#[test]
fn no_arc_is_farther_from_its_cubics_than_the_bound() {
    for seed in 0..cases(12) {
        let mut random = Random::new(seed as u64);
        let scale = random.power(-3.0, 3.0);
        let centre: [f64; 3] = random.point_within(scale);
        let axes: [[f64; 3]; 2] = [0; 2].map(|_| random.point_within(scale));
        let (start, sweep) = (random.between(-3.0, 3.0), random.between(-2.0 * PI, 2.0 * PI));
        let curve = Curve::new(
            vec![CurveSegment::Arc(Arc::new(centre, axes, start, sweep).expect("an arc"))],
            CurveEnds::Open,
        )
        .expect("a path");
        let length = scale * random.power(-9.0, -1.0);
        let made = cubics(&curve, length).expect("cubics");
        let bound = made.bound.at_most().expect("a bound");
        let at = |t: f64| {
            let (sin, cos) = (start + sweep * t).sin_cos();
            std::array::from_fn(|k| centre[k] + cos * axes[0][k] + sin * axes[1][k])
        };
        let (truth, result) = (Sampled { at: Box::new(at), end: 1.0 }, fitted(&made.shape));
        let n = 100 + 10 * made.shape.segments().len();
        let found = truth.farthest_from(&result, n).max(result.farthest_from(&truth, n));
        assert!(bound <= length && found <= bound * (1.0 + 1e-6), "seed {seed}: {found} > {bound}");
        assert!(sharpest(&made.shape) < 1e-7);
    }
}

/// Arcs by their ends, short ones of long radii too: their points are on them, which the referee of arcs has seen.
#[test]
fn arcs_by_their_ends_become_cubics_within_a_ten_millionth_of_their_chords() {
    for seed in 0..cases(12) {
        let mut random = Random::new(seed as u64);
        let size = random.power(-1.0, 2.0);
        let from: [f64; 2] = random.point_within(100.0);
        let step: [f64; 2] = random.direction::<2>().map(|x| x * size);
        let radius = size * random.power(-0.3, 6.0);
        let radii = [radius, radius * random.power(-0.5, 0.5)];
        let shape = SvgArcShape {
            radii,
            rotation_rad: random.between(0.0, 3.0),
            large: false,
            positive: seed % 2 == 0,
        };
        let arc = Arc::through_step(from, step, &shape).expect("an arc");
        let curve = Curve::new(vec![CurveSegment::Arc(arc)], CurveEnds::Open).expect("a path");
        let made = cubics(&curve, 1e-7).expect("cubics");
        let bound = made.bound.at_most().expect("a bound");
        let (truth, result) = (Sampled { at: Box::new(|t| arc.at(t)), end: 1.0 }, fitted(&made.shape));
        let n = 100 + 10 * made.shape.segments().len();
        let found = truth.farthest_from(&result, n).max(result.farthest_from(&truth, n));
        assert!(bound <= 1e-7 && found <= bound * (1.0 + 1e-6) + 1e-13, "seed {seed}: {found} > {bound}");
    }
}

#[test]
fn a_circle_takes_four_cubics_and_the_sixth_root_of_more() {
    let turn = Arc::new([1.0, 2.0], [[1.0, 0.0], [0.0, 1.0]], 0.0, 2.0 * PI).expect("a circle");
    let start = turn.at(0.0);
    let circle = Curve::new(vec![CurveSegment::Arc(turn.with_ends([start, start]))], CurveEnds::Closed)
        .expect("a path");
    let nurbs = NurbsCurve::circle([1.0, 2.0], [[1.0, 0.0], [0.0, 1.0]])
        .expect("a circle")
        .to_curve()
        .expect("a path");
    let n = |curve: &Curve<2>, length: f64| cubics(curve, length).expect("cubics").shape.segments().len();
    // By the usual handles 2.725e-4 for four, and a sixty-fourth of it, nearly, for eight.
    let arcs = [2.73e-4, 2.73e-4 / 64.0, 1e-6, 1e-9, 1e-11].map(|length| n(&circle, length));
    assert_eq!(arcs, [4, 8, 11, 33, 71]);
    // By the nearest cubics of quarters, each for itself.
    let rational = [2.6e-4, 1e-6, 1e-9].map(|length| n(&nurbs, length));
    eprintln!("{arcs:?} {rational:?}");
    assert!(rational[0] == 4 && rational[1] <= 12 && rational[2] <= 36, "{rational:?}");
    for curve in [&circle, &nurbs] {
        let made = cubics(curve, 1e-6).expect("cubics");
        assert!(made.shape.is_closed() && sharpest(&made.shape) < 1e-7, "{}", sharpest(&made.shape));
    }
}

#[test]
fn lines_and_cubics_stay_and_corners_do() {
    let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
    let arc = Arc::new([2.0, 0.0], [[1.0, 0.0], [0.0, 1.0]], PI, -PI)
        .expect("an arc")
        .with_ends([[1.0, 0.0], [3.0, 0.0]]);
    let pieces =
        vec![CurveSegment::Cubic(arch), CurveSegment::Arc(arc), CurveSegment::Line([[3.0, 0.0], [0.0, 0.0]])];
    let curve = Curve::new(pieces, CurveEnds::Closed).expect("a path");
    let made = cubics(&curve, 1e-3).expect("cubics");
    assert_eq!(made.shape.segments().first(), Some(&CurveSegment::Cubic(arch)));
    assert_eq!(made.shape.segments().last(), Some(&CurveSegment::Line([[3.0, 0.0], [0.0, 0.0]])));
    assert!((sharpest(&made.shape) - PI).abs() < 1e-7);
    let only = Curve::from(arch);
    let same = cubics(&only, 1e-300).expect("the same");
    assert_eq!((&same.shape, same.bound.at_most()), (&only, Some(0.0)));
    let point = Curve::point([1.0, 2.0]).expect("a point");
    assert_eq!(cubics(&point, 1.0).expect("a point").shape, point);
}

#[test]
fn refusals_are_sentences() {
    let circle = NurbsCurve::circle([1e6, 0.0], [[1.0, 0.0], [0.0, 1.0]])
        .expect("a circle")
        .to_curve()
        .expect("a path");
    let code = |made: Result<_, Failure<Curve<2>>>| match made {
        Err(Failure::Refused(why)) => (why.code.as_str(), why.message.to_string()),
        other => panic!("{other:?}"),
    };
    let (name, message) = code(cubics(&circle, 1e-12));
    assert_eq!(name, "below-precision", "{message}");
    let mut job = Job::default();
    job.triangle_limit = 10;
    let tight = Tolerance::new(1e-6).expect("a length");
    assert_eq!(code(curve_to_cubics(&circle, tight, &job)).0, "too-many-triangles");
    job.cancel();
    assert_eq!(curve_to_cubics(&circle, tight, &job), Err(Failure::Cancelled));
    let wild = Curve::from(Bezier { control: [[f64::NAN; 2]; 4] });
    assert_eq!(code(cubics(&wild, 1.0)).0, "not-finite");
    let slack = circle.with_slack(0.5);
    assert_eq!(code(cubics(&slack, 0.25)).0, "below-precision");
    assert!(distance([0.0, 3.0], [4.0, 0.0]) == 5.0);
}
