//! Splines keep what they promise: through the points or not, how smooth, and how far a moved point is felt.
use chordal::check::curves::{join, joins};
use chordal::explicit::parametric::Polynomial;
use chordal::explicit::spline::{self, InvalidSpline, Knots, SplineEnds};
use chordal::explicit::{Curve, CurveEnds, CurveSegment};
use chordal_testkit::Random;

fn points<const D: usize>(random: &mut Random, n: usize) -> Vec<[f64; D]> {
    (0..n).map(|_| random.point_within(5.0)).collect()
}

fn bits(piece: &CurveSegment<3>) -> Vec<u64> {
    let CurveSegment::Cubic(cubic) = piece else { panic!("splines are cubics") };
    cubic.control.as_flattened().iter().map(|x| x.to_bits()).collect()
}

fn changed(before: &Curve<3>, after: &Curve<3>) -> Vec<usize> {
    let pairs = before.segments().iter().zip(after.segments()).enumerate();
    pairs.filter(|(_, (a, b))| bits(a) != bits(b)).map(|(i, _)| i).collect()
}

#[test]
fn a_moved_control_point_of_a_b_spline_changes_four_spans_and_no_bit_of_the_others() {
    let mut random = Random::new(1);
    for closed in [false, true] {
        for moved in 0..20 {
            let control = points::<3>(&mut random, 20);
            let mut other = control.clone();
            other[moved][1] += 0.125;
            let [before, after] = [&control, &other].map(|c| spline::b_spline(c, closed.into()).unwrap());
            let changed = changed(&before, &after);
            let all = if closed { 20 } else { 17 };
            let expected: Vec<usize> = (0..all).filter(|i| (0..4).any(|k| (i + k) % 20 == moved)).collect();
            assert_eq!(changed, expected, "closed {closed}, moved {moved}");
            assert!(changed.len() <= 4);
        }
    }
}

#[test]
fn a_moved_point_is_felt_by_four_pieces_of_catmull_rom_and_by_all_of_a_natural_spline() {
    let points = points::<3>(&mut Random::new(2), 12);
    let mut other = points.clone();
    other[6][0] += 0.5;
    for knots in [Knots::Uniform, Knots::Centripetal] {
        let [before, after] =
            [&points, &other].map(|p| spline::catmull_rom(p, knots, CurveEnds::Open).unwrap());
        assert_eq!(changed(&before, &after), [4, 5, 6, 7]);
    }
    let [before, after] = [&points, &other].map(|p| spline::natural(p).unwrap());
    assert_eq!(changed(&before, &after).len(), 11);
    // By about 2 + √3 less with each piece.
    let felt = |i: usize| (before.at(i as f64 + 0.5)[0] - after.at(i as f64 + 0.5)[0]).abs();
    assert!((7..9).all(|i| (3.0..4.5).contains(&(felt(i) / felt(i + 1)))), "{:?}", [7, 8, 9, 10].map(felt));
}

#[test]
fn the_polynomial_through_many_points_changes_everywhere() {
    let nodes: Vec<f64> = (0..11).map(|i| f64::from(i) / 5.0 - 1.0).collect();
    let points: Vec<[f64; 1]> = nodes.iter().map(|x| [1.0 / (1.0 + 25.0 * x * x)]).collect();
    let mut other = points.clone();
    other[5][0] += 1e-3;
    let [before, after] = [&points, &other].map(|p| Polynomial::through(&nodes, p).unwrap());
    for node in &nodes[..10] {
        let x = node + 0.1;
        let felt = (after.at(x)[0] - before.at(x)[0]).abs();
        assert!(felt > 3e-4, "at {x} by {felt}");
    }
    // Nine times more near the end than beside it: six times as much as was moved.
    assert!((after.at(0.95)[0] - before.at(0.95)[0]).abs() > 5e-3);
}

#[test]
fn runge_s_function_swings_in_a_polynomial_and_not_in_a_spline() {
    let runge = |x: f64| 1.0 / (1.0 + 25.0 * x * x);
    let nodes: Vec<f64> = (0..11).map(|i| f64::from(i) / 5.0 - 1.0).collect();
    let points: Vec<[f64; 2]> = nodes.iter().map(|x| [*x, runge(*x)]).collect();
    let polynomial = Polynomial::through(&nodes, &points).unwrap();
    let path = spline::natural(&points).unwrap();
    let (mut swing, mut off): (f64, f64) = (0.0, 0.0);
    for i in 0..=2000 {
        let x = f64::from(i) / 1000.0 - 1.0;
        swing = swing.max((polynomial.at(x)[1] - runge(x)).abs());
        let [at, y] = path.at((x + 1.0) * 5.0);
        assert!((at - x).abs() < 1e-14, "equal steps of x keep x equal to the parameter");
        off = off.max((y - runge(x)).abs());
    }
    // Known values: 1.915643 for the polynomial (at x = 0.9603…) and 0.02196 for the spline.
    assert!((swing - 1.9156).abs() < 1e-3, "{swing}");
    assert!((off - 0.02196).abs() < 2e-4, "{off}");
}

#[test]
fn splines_are_as_smooth_as_they_say_and_no_smoother() {
    let mut random = Random::new(3);
    for scale in [1e-6, 1.0, 1e6] {
        let points: Vec<[f64; 2]> =
            points::<2>(&mut random, 40).iter().map(|p| p.map(|x| scale * x)).collect();
        let all = |path: &Curve<2>, class| joins(path).iter().all(|join| join.parametric == Some(class));
        assert!(all(&spline::natural(&points).unwrap(), 2));
        assert!(all(&spline::b_spline(&points, CurveEnds::Open).unwrap(), 2));
        assert!(all(&spline::b_spline(&points, CurveEnds::Closed).unwrap(), 2));
        assert_eq!(joins(&spline::b_spline(&points, CurveEnds::Closed).unwrap()).len(), 40);
        assert!(all(&spline::catmull_rom(&points, Knots::Uniform, CurveEnds::Closed).unwrap(), 1));
        let centripetal = spline::catmull_rom(&points, Knots::Centripetal, CurveEnds::Closed).unwrap();
        assert!(
            joins(&centripetal).iter().all(|join| join.parametric == Some(0) && join.geometric == Some(1))
        );
        let widths = spline::widths(&points, Knots::Centripetal, 40).unwrap();
        for (i, pair) in centripetal.segments().windows(2).enumerate() {
            assert_eq!(join([&pair[0], &pair[1]], [widths[i], widths[i + 1]], i + 1).parametric, Some(1));
        }
    }
}

#[test]
fn splines_go_through_their_points_and_the_b_spline_stays_in_its_hull() {
    let points = points::<3>(&mut Random::new(4), 30);
    for path in [
        spline::natural(&points).unwrap(),
        spline::catmull_rom(&points, Knots::Uniform, CurveEnds::Open).unwrap(),
        spline::catmull_rom(&points, Knots::Centripetal, CurveEnds::Open).unwrap(),
    ] {
        assert!(points.iter().enumerate().all(|(i, p)| path.at(i as f64) == *p));
    }
    let path = spline::b_spline(&points, CurveEnds::Open).unwrap();
    for (i, piece) in path.segments().iter().enumerate() {
        let [low, high] = piece.bounds();
        for k in 0..3 {
            let near = points[i..i + 4].iter().map(|p| p[k]);
            let (least, most) =
                (near.clone().fold(f64::INFINITY, f64::min), near.fold(-f64::INFINITY, f64::max));
            assert!(low[k] >= least - 1e-14 && high[k] <= most + 1e-14);
        }
    }
}

const KNOTS: [Knots; 3] = [Knots::Uniform, Knots::Centripetal, Knots::Chordal];

#[test]
fn interpolating_splines_are_c2_by_their_knots_at_any_scale() {
    let mut random = Random::new(5);
    for scale in [1e-6, 1.0, 1e6] {
        for n in [2, 3, 4, 17] {
            let points: Vec<[f64; 3]> =
                points::<3>(&mut random, n).iter().map(|p| p.map(|x| scale * x)).collect();
            let tangents: [[f64; 3]; 2] = [random.point_within(scale), random.point_within(scale)];
            for (knots, ends) in KNOTS.into_iter().flat_map(|knots| {
                let all = [SplineEnds::Natural, SplineEnds::Clamped(tangents), SplineEnds::Periodic];
                all.map(|ends| (knots, ends))
            }) {
                let is_periodic = ends == SplineEnds::Periodic;
                if is_periodic && n < 3 {
                    assert_eq!(spline::interpolating(&points, knots, ends), Err(InvalidSpline::TooFew(3)));
                    continue;
                }
                let path = spline::interpolating(&points, knots, ends).unwrap();
                assert_eq!(path.is_closed(), is_periodic);
                assert!(points.iter().enumerate().all(|(i, p)| path.at(i as f64) == *p));
                let pieces = path.segments();
                let widths = spline::widths(&points, knots, pieces.len()).unwrap();
                let is_smooth = |before: usize, after: usize| {
                    let join =
                        join([&pieces[before], &pieces[after]], [widths[before], widths[after]], after);
                    join.parametric == Some(2) && join.geometric == Some(2)
                };
                assert!((1..pieces.len()).all(|i| is_smooth(i - 1, i)), "{knots:?} {ends:?} {scale}");
                let last = pieces.len() - 1;
                let near =
                    |p: [f64; 3], q: [f64; 3], spare: f64| (0..3).all(|k| (p[k] - q[k]).abs() <= spare);
                match ends {
                    SplineEnds::Periodic => assert!(is_smooth(last, 0)),
                    SplineEnds::Clamped([start, end]) => {
                        let by_knots = |m: [f64; 3], width: f64| m.map(|x| x / width);
                        // Points are as large as tangents times widths.
                        let spare = |width: f64| 1e-13 * scale / width + 1e-14 * scale;
                        assert!(near(by_knots(pieces[0].tangent(0.0), widths[0]), start, spare(widths[0])));
                        assert!(near(
                            by_knots(pieces[last].tangent(1.0), widths[last]),
                            end,
                            spare(widths[last])
                        ));
                    }
                    SplineEnds::Natural => {
                        let bent = [pieces[0].second_derivative(0.0), pieces[last].second_derivative(1.0)];
                        assert!(bent.iter().all(|x| near(*x, [0.0; 3], 1e-12 * scale)), "{bent:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_cubic_comes_back_from_its_points_and_end_tangents() {
    let at = |t: f64| [t, t * t * t - 2.0 * t * t];
    let slope = |t: f64| [1.0, 3.0 * t * t - 4.0 * t];
    let points: Vec<[f64; 2]> = (0..6).map(|i| at(f64::from(i))).collect();
    let path = spline::clamped(&points, [slope(0.0), slope(5.0)]).unwrap();
    for i in 0..=50 {
        let t = f64::from(i) / 10.0;
        let ([x, y], [u, v]) = (path.at(t), at(t));
        assert!((x - u).abs() < 1e-13 && (y - v).abs() < 1e-12, "{t}: {x} {y}");
    }
}

#[test]
fn periodic_splines_do_not_care_where_they_start() {
    let points = points::<2>(&mut Random::new(6), 9);
    for knots in KNOTS {
        let path = spline::interpolating(&points, knots, SplineEnds::Periodic).unwrap();
        let mut turned = points.clone();
        turned.rotate_left(4);
        let other = spline::interpolating(&turned, knots, SplineEnds::Periodic).unwrap();
        for i in 0..90 {
            let s = f64::from(i) / 10.0;
            let (p, q) = (other.at(s), path.at((s + 4.0) % 9.0));
            assert!((0..2).all(|k| (p[k] - q[k]).abs() < 1e-13), "{s}: {p:?} {q:?}");
        }
    }
}

#[test]
fn chordal_catmull_rom_is_local_and_c1_by_its_knots() {
    let points = points::<3>(&mut Random::new(7), 20);
    let mut other = points.clone();
    other[9][0] += 0.5;
    let [before, after] =
        [&points, &other].map(|p| spline::catmull_rom(p, Knots::Chordal, CurveEnds::Closed).unwrap());
    assert_eq!(changed(&before, &after), [7, 8, 9, 10]);
    let widths = spline::widths(&points, Knots::Chordal, 20).unwrap();
    for (i, pair) in before.segments().windows(2).enumerate() {
        assert_eq!(join([&pair[0], &pair[1]], [widths[i], widths[i + 1]], i + 1).parametric, Some(1));
    }
    // Distances whose squares vanish or overflow are distances.
    for size in [1e-200, 1e200] {
        let corner = [[0.0, 0.0], [3.0 * size, 4.0 * size]];
        let widths = spline::widths(&corner, Knots::Chordal, 1).unwrap();
        assert!((widths[0] / size - 5.0).abs() < 1e-14);
    }
}

#[test]
fn what_makes_no_spline_is_refused() {
    let p = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]];
    assert_eq!(spline::natural(&p[..1]), Err(InvalidSpline::TooFew(2)));
    assert_eq!(spline::b_spline(&p, CurveEnds::Open), Err(InvalidSpline::TooFew(4)));
    assert_eq!(spline::hermite(&p, &p[..2]), Err(InvalidSpline::Tangents));
    assert_eq!(spline::catmull_rom(&p, Knots::Centripetal, CurveEnds::Open), Err(InvalidSpline::Repeated(1)));
    assert_eq!(spline::catmull_rom(&p, Knots::Chordal, CurveEnds::Open), Err(InvalidSpline::Repeated(1)));
    assert!(spline::catmull_rom(&p, Knots::Uniform, CurveEnds::Open).is_ok());
    let chordal = |p: &[[f64; 2]]| spline::interpolating(p, Knots::Chordal, SplineEnds::Natural);
    assert_eq!(chordal(&p), Err(InvalidSpline::Repeated(1)));
    assert_eq!(spline::periodic(&p[..2]), Err(InvalidSpline::TooFew(3)));
    assert_eq!(spline::clamped(&p, [[f64::NAN, 0.0]; 2]), Err(InvalidSpline::NotFinite));
    assert_eq!(chordal(&[[f64::NAN, 0.0], [1.0, 0.0]]), Err(InvalidSpline::NotFinite));
    assert_eq!(chordal(&[[1e308, 0.0], [-1e308, 0.0]]), Err(InvalidSpline::NotFinite));
    assert_eq!(spline::natural(&[[f64::NAN], [1.0]]), Err(InvalidSpline::NotFinite));
    assert_eq!(spline::natural(&[[1e308], [-1e308], [1e308]]), Err(InvalidSpline::NotFinite));
    assert_eq!(Polynomial::through(&[0.0, 0.0], &[[1.0], [2.0]]), Err(InvalidSpline::Repeated(0)));
}
