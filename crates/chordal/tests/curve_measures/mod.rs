//! Lengths, closest points, curvature and torsion of paths and splines against closed forms and samples.
use crate::nurbs_referee::truth::{random_knots, random_points, random_weights};
use chordal::check::curves::CurveLength;
use chordal::explicit::nurbs::{KnotVector, NurbsCurve};
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment};
use chordal::math::Interval;
use chordal::{Bezier, Tolerance};
use chordal_testkit::{Random, cases, is_long};
use std::f64::consts::{PI, TAU};

/// Whether an interval contains a value that was computed with some roundings.
fn holds(interval: Interval, value: f64) -> bool {
    let spare = 4.0 * f64::EPSILON * value.abs();
    interval.lo() <= value + spare && value - spare <= interval.hi()
}

fn distance<const D: usize>(p: [f64; D], q: [f64; D]) -> f64 {
    let most = (0..D).map(|k| (p[k] - q[k]).abs()).fold(0.0, f64::max);
    if most == 0.0 {
        return 0.0;
    }
    most * (0..D).map(|k| ((p[k] - q[k]) / most).powi(2)).sum::<f64>().sqrt()
}

/// The Pythagorean cubic with the derivative `(u² − v², 2uv)`, `u` and `v` linear with these ends, and its length: the
/// integral of `u² + v²`.
fn pythagorean([u, v]: [[f64; 2]; 2], start: [f64; 2]) -> (Bezier<2>, f64) {
    // The derivative in Bernstein form, thirds of which are the steps of the control points.
    let product = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0], 0.5 * (a[0] * b[1] + a[1] * b[0]), a[1] * b[1]];
    let ([uu, vv], uv) = ([product(u, u), product(v, v)], product(u, v));
    let mut control = [start; 4];
    for i in 0..3 {
        control[i + 1] = [control[i][0] + (uu[i] - vv[i]) / 3.0, control[i][1] + 2.0 * uv[i] / 3.0];
    }
    (Bezier { control }, (uu.iter().sum::<f64>() + vv.iter().sum::<f64>()) / 3.0)
}

#[test]
fn lengths_with_a_closed_form_are_within_narrow_intervals() {
    let mut random = Random::new(801);
    for _ in 0..cases(200) {
        // Multiples of 3 at a power of two: nothing is rounded.
        let whole = |random: &mut Random| 3.0 * (random.below(19) as f64 - 9.0);
        let scale = [2.0_f64.powi(-40), 1.0, 2.0_f64.powi(20)][random.below(3)];
        let ends = [0; 2].map(|_| [0; 2].map(|_| whole(&mut random)));
        let (cubic, length) = pythagorean(ends, [0.0; 2]);
        let cubic = Bezier { control: cubic.control.map(|p| p.map(|x| x * scale)) };
        let total = CurveLength::from_curve(&Curve::from(cubic), None).total();
        let truth = length * scale;
        assert!(total.lo() <= truth && truth <= total.hi(), "{total} {truth} {ends:?}");
        assert!(total.width() <= 1e-12 * truth, "{total} {ends:?}");
        let spline = NurbsCurve::bezier(cubic.control.to_vec()).unwrap();
        let total = CurveLength::from_nurbs(&spline, None).total();
        assert!(total.lo() <= truth && truth <= total.hi() && total.width() <= 1e-12 * truth, "{total}");
    }
    for scale in [1e-12, 1e-6, 1.0, 1e6, 1e100] {
        let circle = NurbsCurve::circle([scale, -scale], [[scale, 0.0], [0.0, scale]]).unwrap();
        let total = CurveLength::from_nurbs(&circle, None).total();
        // Its weights are the root of ½ up to rounding, and so it is a circle up to rounding.
        assert!(holds(total, TAU * scale) && total.width() < 1e-12 * scale, "{total}");
        let sweep = random.between(-6.0, 6.0);
        let arc = Arc::new([5.0 * scale; 3], [[scale, 0.0, 0.0], [0.0, 0.0, scale]], 1.0, sweep).unwrap();
        let path = Curve::new(vec![CurveSegment::Arc(arc)], CurveEnds::Open).unwrap();
        let total = CurveLength::from_curve(&path, None).total();
        assert!(holds(total, sweep.abs() * scale) && total.width() < 1e-12 * scale, "{total}");
        // (t, t²) from 0 to 1: (2√5 + asinh 2)/4, half of it by parameter halves below.
        let parabola = Curve::new(
            vec![CurveSegment::quadratic([[0.0; 2], [0.5, 0.0], [1.0, 1.0]].map(|p| p.map(|x| x * scale)))],
            CurveEnds::Open,
        )
        .unwrap();
        let truth = scale * (2.0 * 5.0_f64.sqrt() + 2.0_f64.asinh()) / 4.0;
        let length = CurveLength::from_curve(&parabola, None);
        // Thirds are rounded in the cubic.
        let total = length.total();
        assert!(
            (total.midpoint().unwrap() - truth).abs() < 4e-15 * scale && total.width() < 1e-12 * scale,
            "{total}"
        );
        let half = scale * (0.5 * 2.0_f64.sqrt() + 0.5 * 1.0_f64.asinh()) / 2.0;
        assert!((length.up_to(0.5).midpoint().unwrap() - half).abs() < 4e-15 * scale);
    }
    // An ellipse with axes 2 and 1, whose circumference is 8·E(√3/2).
    let ellipse = Arc::new([0.0; 2], [[2.0, 0.0], [0.0, 1.0]], 0.0, TAU).unwrap();
    let path = Curve::new(vec![CurveSegment::Arc(ellipse)], CurveEnds::Open).unwrap();
    assert!(holds(CurveLength::from_curve(&path, None).total(), 9.688_448_220_547_675));
}

#[test]
fn a_line_is_as_long_as_its_ends_are_apart_whatever_its_weights() {
    let mut random = Random::new(802);
    for _ in 0..cases(60) {
        let degree = 1 + random.below(5);
        let most = [1.0, 3.0, 6.0][random.below(3)];
        let away = [0.0, 1e8][random.below(2)];
        // Whole numbers along (3, 4).
        let control: Vec<[f64; 2]> =
            (0..=degree).map(|k| [away + 3.0 * (k * k) as f64, 4.0 * (k * k) as f64 - away]).collect();
        let weights = (0..=degree).map(|_| random.power(-most, most)).collect();
        let knots = KnotVector::clamped(degree, degree + 1).unwrap();
        let line = NurbsCurve::new(knots, control, weights).unwrap();
        let total = CurveLength::from_nurbs(&line, None).total();
        let truth = 5.0 * (degree * degree) as f64;
        assert!(total.lo() <= truth && truth <= total.hi(), "{total} {truth} {:?}", line.weights());
        assert!(total.width() <= 1e-9 * truth, "{total} {:?}", line.weights());
    }
}

/// Lower and upper bounds of the length of a Bézier curve with weights: chords, and control polygons after halvings.
fn sandwich<const D: usize>(control: &[[f64; D]], weights: &[f64], depth: u32) -> [f64; 2] {
    let n = control.len();
    if depth == 0 {
        let polygon = control.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
        return [distance(control[0], control[n - 1]), polygon];
    }
    let (mut row, mut heavy) = (control.to_vec(), weights.to_vec());
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for last in (0..n).rev() {
        left.push((row[0], heavy[0]));
        right.push((row[last], heavy[last]));
        for i in 0..last {
            let whole = heavy[i] + heavy[i + 1];
            row[i] =
                std::array::from_fn(|k| heavy[i] / whole * row[i][k] + heavy[i + 1] / whole * row[i + 1][k]);
            heavy[i] = 0.5 * whole;
        }
    }
    right.reverse();
    let [a, b] = [left, right].map(|half| {
        let (control, weights): (Vec<_>, Vec<_>) = half.into_iter().unzip();
        sandwich(&control, &weights, depth - 1)
    });
    [a[0] + b[0], a[1] + b[1]]
}

#[test]
fn lengths_lie_between_chords_and_control_polygons_for_nasty_curves() {
    let mut random = Random::new(803);
    for case in 0..if is_long() { 1600 } else { 50 } {
        let degree = 1 + random.below(6);
        let scale = [1e-12, 1e-6, 1.0, 1e6][random.below(4)];
        let away = scale * [0.0, 1.0, 1e8][random.below(3)];
        let mut control: Vec<[f64; 3]> =
            (0..=degree).map(|_| random.point_within::<3>(scale).map(|x| x + away)).collect();
        match case % 5 {
            0 => control[degree] = control[0],
            1 => control[1] = control[0],
            2 if degree == 3 => {
                // A cusp.
                let [a, b, c] = [control[0], control[1], control[2]];
                control[3] = std::array::from_fn(|k| b[k] + c[k] - a[k] + (c[k] - b[k]) * 0.0);
                control = vec![control[0], control[3], control[1], control[2]];
            }
            3 => control = vec![control[0]; degree + 1],
            _ => {}
        }
        let most = [0.0, 1.0, 6.0][random.below(3)];
        let weights: Vec<f64> = (0..=degree).map(|_| random.power(-most, most)).collect();
        let knots = KnotVector::clamped(degree, degree + 1).unwrap();
        let curve = NurbsCurve::new(knots, control.clone(), weights.clone()).unwrap();
        let total = CurveLength::from_nurbs(&curve, None).total();
        let [low, high] = sandwich(&control, &weights, 11);
        // What rounding costs the chords of points far from the origin.
        let spare = 1e-12 * high + 4096.0 * 4.0 * f64::EPSILON * (away + scale);
        assert!(total.hi() >= low - spare && total.lo() <= high + spare, "{case}: {total} {low} {high}");
        assert!(total.width() <= 1e-6 * high + spare, "{case}: {total} {control:?} {weights:?}");
        // The path of rounded pieces is a curve of its own, with nearly the same length.
        let path = curve.to_curve().unwrap();
        let other = CurveLength::from_curve(&path, None).total();
        assert!(other.hi() >= low - spare && other.lo() <= high + spare, "{case}: {other} {low} {high}");
        // A tolerance is kept, with less work.
        let tolerance = 1e-3 * scale;
        let coarse = CurveLength::from_nurbs(&curve, Some(Tolerance::new(tolerance).unwrap())).total();
        assert!(coarse.lo() <= total.hi() && total.lo() <= coarse.hi(), "{coarse} {total}");
        assert!(coarse.width() <= tolerance, "{case}: {coarse} {weights:?}");
    }
}

#[test]
fn a_place_at_a_length_is_there() {
    let mut random = Random::new(804);
    for _ in 0..cases(40) {
        let degree = 1 + random.below(5);
        let n = degree + 1 + random.below(6);
        let knots = KnotVector::new(degree, random_knots(&mut random, degree, n)).unwrap();
        let curve: NurbsCurve<2> =
            NurbsCurve::new(knots, random_points(&mut random, n), random_weights(&mut random, n)).unwrap();
        let length = CurveLength::from_nurbs(&curve, None);
        let total = length.total();
        let [from, to] = curve.knots().domain();
        for _ in 0..5 {
            let t = random.between(from, to);
            let up_to = length.up_to(t);
            // Every length that it may have up to there leads back.
            for l in [up_to.lo(), up_to.hi(), up_to.midpoint().unwrap()] {
                let there = length.place_at(l).unwrap();
                assert!(there.lo() <= t && t <= there.hi() || l != up_to.midpoint().unwrap(), "{there} {t}");
                assert!(there.width() <= 1e-6 * (to - from), "{there} {t}");
                assert!(length.up_to(there.lo()).lo() <= l && l <= length.up_to(there.hi()).hi());
            }
        }
        assert!(
            length.place_at(0.0).unwrap().contains(from) && length.place_at(total.hi()).unwrap().contains(to)
        );
        assert_eq!((length.up_to(from).hi(), length.up_to(from - 1.0).hi()), (0.0, 0.0));
        assert_eq!((length.up_to(to), length.up_to(to + 1.0)), (total, total));
        assert!(length.place_at(total.hi().next_up()).is_none() && length.place_at(-1.0).is_none());
        assert!(length.place_at(f64::NAN).is_none() && length.place_at(f64::INFINITY).is_none());
    }
    // Where a path stands still, a length has many places.
    let (a, b) = ([0.0, 0.0], [3.0, 4.0]);
    let pieces = [[a, b], [b, b], [b, a]].map(CurveSegment::Line).to_vec();
    let path = Curve::new(pieces, CurveEnds::Closed).unwrap();
    let length = CurveLength::from_curve(&path, None);
    assert!(holds(length.total(), 10.0));
    let there = length.place_at(5.0).unwrap();
    assert!(there.lo() <= 1.0 && there.hi() >= 2.0 && there.width() < 1.0 + 1e-12, "{there}");
    let there = length.place_at(7.5).unwrap();
    assert!(there.contains(2.5) && there.width() < 1e-12, "{there}");
    let dot = CurveLength::from_curve(&Curve::point([1.0, 2.0]).unwrap(), None);
    assert_eq!((dot.total(), dot.place_at(0.0)), (Interval::point(0.0), None));
}

#[test]
fn no_sample_is_nearer_than_the_closest_point() {
    let mut random = Random::new(805);
    for case in 0..cases(150) {
        let degree = 1 + random.below(5);
        let n = degree + 1 + random.below(5);
        let knots = KnotVector::new(degree, random_knots(&mut random, degree, n)).unwrap();
        let scale = [1e-12, 1e-6, 1.0, 1e6][random.below(4)];
        let away = scale * [0.0, 0.0, 1e8][random.below(3)];
        let mut control: Vec<[f64; 3]> =
            (0..n).map(|_| random.point_within::<3>(scale).map(|x| x + away)).collect();
        if case % 4 == 0 {
            control[1] = control[0];
        }
        let most = [0.0, 1.0, 6.0][random.below(3)];
        let weights: Vec<f64> = (0..n).map(|_| random.power(-most, most)).collect();
        let curve = NurbsCurve::new(knots, control, weights).unwrap();
        let path = curve.to_curve().unwrap();
        let rounding = 1e-13 * (away + scale);
        let [from, to] = curve.knots().domain();
        for query in 0..4 {
            let p: [f64; 3] = match query {
                // On the curve up to rounding, near, and far.
                0 => curve.at(random.between(from, to)),
                1 => random.point_within::<3>(2.0 * scale).map(|x| x + away),
                2 => random.point_within::<3>(0.5 * scale).map(|x| x + away),
                _ => random.point_within(1e6 * scale),
            };
            let size = scale + away + p.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let spare = rounding + 1e-15 * size;
            let closest = curve.closest_point(p, None).unwrap();
            let (low, high) = (closest.at_least, closest.at_most);
            // With weights of twelve orders of magnitude a curve may be elsewhere at the next parameter.
            let narrow = if most < 6.0 { 120.0 * (degree + 1) as f64 * f64::EPSILON } else { 1e-6 };
            assert!(
                low <= high && high - low <= narrow * size,
                "{case} {query}: {low} {high} {p:?} {curve:?}"
            );
            let sampled = (0..=600)
                .map(|k| distance(curve.at(from + (to - from) * f64::from(k) / 600.0), p))
                .fold(f64::INFINITY, f64::min);
            assert!(low <= sampled + spare, "{case} {query}: {low} {sampled}");
            let there = distance(closest.point, p);
            let spare = if most < 6.0 { spare } else { 1e-6 * size };
            assert!((there - high).abs() <= 4.0 * spare + (high - low), "{case} {query}: {there} {high}");
            assert!(distance(curve.at(closest.place), closest.point) <= spare);
            let of_path = path.closest_point(p, None).unwrap();
            assert!(of_path.at_least <= high && low <= of_path.at_most, "{case} {query}");
            let coarse = Tolerance::new(0.01 * scale).unwrap();
            let near = curve.closest_point(p, Some(coarse)).unwrap();
            assert!(near.at_least <= high && low <= near.at_most);
            assert!(near.at_most - near.at_least <= 0.01 * scale + spare);
        }
    }
}

#[test]
fn closest_points_of_arcs_and_circles_have_their_closed_form() {
    let mut random = Random::new(806);
    for _ in 0..cases(200) {
        let radius = random.power(-6.0, 6.0);
        let (start, sweep) = (random.between(-PI, PI), random.between(-TAU, TAU));
        let arc = Arc::new([0.0; 2], [[radius, 0.0], [0.0, radius]], start, sweep).unwrap();
        let path = Curve::new(vec![CurveSegment::Arc(arc)], CurveEnds::Open).unwrap();
        let p: [f64; 2] = random.point_within(3.0 * radius);
        let closest = path.closest_point(p, None).unwrap();
        // The angle from the start, in the direction of the sweep.
        let along = (sweep.signum() * (p[1].atan2(p[0]) - start)).rem_euclid(TAU);
        let ends = [arc.at(0.0), arc.at(1.0)].map(|end| distance(end, p));
        let within = along < sweep.abs();
        let truth = if within { (p[0].hypot(p[1]) - radius).abs() } else { ends[0].min(ends[1]) };
        let spare = 1e-15 * 8.0 * radius;
        assert!(closest.at_least <= truth + spare && truth - spare <= closest.at_most, "{closest:?} {truth}");
        assert!(closest.at_most - closest.at_least <= 2e-13 * radius, "{closest:?}");
        let there = distance(path.at(closest.place), p);
        assert!((there - truth).abs() <= spare + 4e-13 * radius, "{closest:?} {there} {truth}");
        if within && truth < 0.9 * radius {
            assert!((closest.place - along / sweep.abs()).abs() < 1e-5, "{closest:?} {along} {sweep}");
        }
    }
    // All points of a circle are equally close to its centre.
    let circle = NurbsCurve::circle([1.0, 2.0], [[1.0, 0.0], [0.0, 1.0]]).unwrap();
    let closest = circle.closest_point([1.0, 2.0], None).unwrap();
    assert!(closest.at_least <= 1.0 && 1.0 <= closest.at_most && closest.at_most - closest.at_least < 1e-13);
    assert!(circle.closest_point([f64::NAN, 0.0], None).is_none());
    let dot = Curve::point([3.0, 4.0]).unwrap().closest_point([0.0, 0.0], None).unwrap();
    assert!(dot.at_least <= 5.0 && 5.0 <= dot.at_most && dot.place == 0.0 && dot.point == [3.0, 4.0]);
    let slack = Curve::point([3.0, 4.0]).unwrap().with_slack(1.0).closest_point([0.0, 0.0], None).unwrap();
    assert!(slack.at_least <= 4.0 && slack.at_most >= 6.0);
}

#[test]
fn curvature_and_torsion_are_those_of_circles_and_helices() {
    for scale in [1e-12, 1e-6, 1.0, 1e6, 1e100] {
        for (turn, sign) in [(scale, 1.0), (-scale, -1.0)] {
            let circle = NurbsCurve::circle([0.0; 2], [[scale, 0.0], [0.0, turn]]).unwrap();
            let path = circle.to_curve().unwrap();
            for k in 0..=40 {
                let t = f64::from(k) / 40.0;
                let both = [circle.curvature(t), path.curvature(4.0 * t)];
                assert!(both.iter().all(|c| (c.unwrap() * scale - sign).abs() < 1e-12), "{both:?} {t}");
            }
        }
        // (t, t²/2, t³/6) in a unit: curvature and torsion 1 at 0.
        let control = [[0.0; 3], [1.0 / 3.0, 0.0, 0.0], [2.0 / 3.0, 1.0 / 6.0, 0.0], [1.0, 0.5, 1.0 / 6.0]];
        let control = control.map(|p| p.map(|x| x * scale));
        let (path, spline) = (Curve::from(Bezier { control }), NurbsCurve::bezier(control.to_vec()).unwrap());
        for value in [path.curvature(0.0), path.torsion(0.0), spline.curvature(0.0), spline.torsion(0.0)] {
            assert!((value.unwrap() * scale - 1.0).abs() < 1e-13, "{value:?}");
        }
        // At t: first (1, t, t²/2), second (0, 1, t), third (0, 0, 1).
        let t = 0.7;
        let torsion = 1.0 / (1.0 + t * t + 0.25 * (t * t) * (t * t));
        assert!((path.torsion(t).unwrap() * scale - torsion).abs() < 1e-12);
        let mirrored = Curve::from(Bezier { control: control.map(|[x, y, z]| [x, y, -z]) });
        assert!((mirrored.torsion(t).unwrap() * scale + torsion).abs() < 1e-12);
    }
    let line = Curve::new(vec![CurveSegment::Line([[0.0; 3], [1.0, 2.0, 3.0]])], CurveEnds::Open).unwrap();
    assert_eq!((line.curvature(0.5), line.torsion(0.5)), (Some(0.0), None));
    let still = Curve::from(Bezier { control: [[1.0, 2.0]; 4] });
    assert_eq!((still.curvature(0.5), Curve::point([1.0, 2.0]).unwrap().curvature(0.0)), (None, None));
    let arc = Arc::new([0.0; 3], [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]], 0.3, 2.0).unwrap();
    let arc = Curve::new(vec![CurveSegment::Arc(arc)], CurveEnds::Open).unwrap();
    assert!((arc.curvature(0.4).unwrap() - 0.5).abs() < 1e-15 && arc.torsion(0.4).unwrap().abs() < 1e-15);
}

#[test]
fn the_ends_of_the_range_of_numbers_do_not_break_an_enclosure() {
    for scale in [1e-323, 1e-310, 1e-160, 1e160, 1e300, 3e307] {
        let ends = [[0.0, 0.0], [3.0 * scale, 4.0 * scale]];
        let path = Curve::new(vec![CurveSegment::Line(ends)], CurveEnds::Open).unwrap();
        let total = CurveLength::from_curve(&path, None).total();
        let truth = distance(ends[0], ends[1]);
        assert!(total.lo() <= truth && truth <= total.hi(), "{scale}: {total} {truth}");
        let closest = path.closest_point([-ends[1][0], -ends[1][1]], None).unwrap();
        assert!(closest.at_least <= truth && truth <= closest.at_most, "{scale}: {closest:?} {truth}");
        let knots = KnotVector::clamped(2, 3).unwrap();
        for weights in [[1e-300, 1.0, 1e-300], [1.0, 1e-300, 1e300], [1e-150; 3], [1e300, 1.0, 1e300]] {
            // A line, however it is run along.
            let control = vec![ends[0], [1.5 * scale, 2.0 * scale], ends[1]];
            let line = NurbsCurve::new(knots.clone(), control, weights.to_vec()).unwrap();
            let total = CurveLength::from_nurbs(&line, Tolerance::new(0.1 * scale).ok()).total();
            let spare = 8.0 * f64::EPSILON * truth + 1e-322;
            assert!(
                total.lo() <= truth + spare && truth - spare <= total.hi(),
                "{weights:?}: {total} {truth}"
            );
            let closest = line.closest_point([-ends[1][0], -ends[1][1]], None).unwrap();
            let (low, high) = (closest.at_least, closest.at_most);
            assert!(low <= truth + spare && truth - spare <= high, "{weights:?}: {closest:?} {truth}");
        }
    }
}
