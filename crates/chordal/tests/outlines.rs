//! The arrow `outlines_to_mesh`: closed form, the promise about sides, and odd outlines. The referee samples
//! curves and counts winding by itself.
use chordal::check::findings::measure;
use chordal::check::t_junctions;
use chordal::explicit::{Arc, Bezier, Curve, CurveEnds, CurveSegment, FillRule, Outline, Topology};
use chordal::{Bounded, Budget, Failure, Job, Mesh, Tolerance, convert};
use chordal_testkit::Random;
use std::f64::consts::PI;

fn made(outlines: &[Outline], tolerance: f64) -> Bounded<Mesh> {
    let budget = Budget::length(Tolerance::new(tolerance).unwrap());
    convert::outlines_to_mesh(outlines, &budget, &Job::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn circle([x, y]: [f64; 2], r: f64) -> Curve<2> {
    let turn = Arc::new([x, y], [[r, 0.0], [0.0, r]], 0.0, 2.0 * PI).unwrap();
    Curve::new(vec![CurveSegment::Arc(turn.with_ends([[x + r, y]; 2]))], CurveEnds::Closed).unwrap()
}

fn polygon(points: &[[f64; 2]]) -> Curve<2> {
    let next = points.iter().cycle().skip(1);
    Curve::new(
        points.iter().zip(next).map(|(a, b)| CurveSegment::Line([*a, *b])).collect(),
        CurveEnds::Closed,
    )
    .unwrap()
}

fn twice_area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[track_caller]
fn is_sound(mesh: &Mesh) {
    for face in 0..mesh.faces().len() {
        assert!(twice_area(mesh.corners(face)) > 0.0, "face {face} has no area or lies face down");
    }
    assert_eq!(t_junctions(mesh, Topology::Indices, None).count, 0);
}

#[test]
fn a_circle_of_n_sides_has_the_error_and_the_area_of_the_regular_polygon() {
    for scale in [1e-6, 1.0, 1e6] {
        let outline =
            Outline { contours: vec![circle([3.0 * scale, -scale], scale)], rule: FillRule::NonZero };
        for tolerance in [1e-1, 1e-3, 1e-5] {
            let Bounded { shape, bound } = made(std::slice::from_ref(&outline), tolerance * scale);
            is_sound(&shape);
            let n = shape.positions().len();
            assert_eq!(shape.faces().len(), n - 2);
            // Nearly regular: n is the fewest, up to one.
            let fewest = (PI / (1.0 - tolerance).acos()).ceil() as usize;
            assert!(n == fewest || n == fewest + 1, "{n} {fewest}");
            let at_most = bound.at_most().unwrap();
            assert!(at_most <= tolerance * scale && at_most > 0.5 * tolerance * scale);
            let missing = PI - measure(&shape).area / (scale * scale);
            assert!(missing > 0.0 && missing < 2.0 * PI * tolerance, "{missing}");
        }
    }
}

#[test]
fn holes_nested_contours_and_overlaps_follow_their_rule() {
    let square = |x: f64, size: f64| polygon(&[[x, x], [x + size, x], [x + size, x + size], [x, x + size]]);
    for (contours, nonzero, evenodd) in [
        (vec![square(0.0, 10.0), square(2.0, 4.0).reversed()], 84.0, 84.0),
        (vec![square(0.0, 10.0), square(2.0, 4.0)], 100.0, 84.0),
        (vec![square(0.0, 10.0), square(5.0, 10.0)], 175.0, 150.0),
        (vec![square(0.0, 10.0), square(0.0, 10.0)], 100.0, 0.0),
        (vec![square(0.0, 10.0), square(0.0, 10.0).reversed()], 0.0, 0.0),
        (vec![square(0.0, 9.0), square(1.0, 7.0), square(2.0, 5.0), square(3.0, 3.0)], 81.0, 48.0),
        (vec![polygon(&[[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]])], 50.0, 50.0),
    ] {
        for (rule, area) in [(FillRule::NonZero, nonzero), (FillRule::EvenOdd, evenodd)] {
            let made = made(&[Outline { contours: contours.clone(), rule }], 1e-3);
            is_sound(&made.shape);
            let found = measure(&made.shape).area;
            assert!((found - area).abs() < 1e-7, "{rule:?} {contours:?}: {found}");
        }
    }
}

#[test]
fn open_contours_are_closed_and_thin_or_empty_ones_vanish() {
    let open = Curve::new(
        vec![CurveSegment::Line([[0.0, 0.0], [2.0, 0.0]]), CurveSegment::Line([[2.0, 0.0], [2.0, 2.0]])],
        CurveEnds::Open,
    );
    let outline = |contours| Outline { contours, rule: FillRule::NonZero };
    assert!((measure(&made(&[outline(vec![open.unwrap()])], 0.1).shape).area - 2.0).abs() < 1e-9);
    let line = Curve::new(vec![CurveSegment::Line([[0.0, 0.0], [2.0, 1.0]])], CurveEnds::Open).unwrap();
    let all = [outline(vec![line]), outline(vec![Curve::point([1.0, 1.0]).unwrap()]), outline(vec![])];
    assert!(made(&all, 0.1).shape.faces().is_empty());
    assert!(made(&[], 0.1).shape.faces().is_empty());
}

#[test]
fn budgets_are_met_or_refused_with_a_code() {
    let ring =
        [Outline { contours: vec![circle([0.0; 2], 2.0), circle([0.0; 2], 1.0)], rule: FillRule::EvenOdd }];
    let with = |budget: Budget| convert::outlines_to_mesh(&ring, &budget, &Job::default());
    let mut before = f64::INFINITY;
    for most in [8, 20, 64, 300, 5000] {
        let made = with(Budget::triangles(most)).unwrap_or_else(|error| panic!("{most}: {error}"));
        let n = made.shape.faces().len() as u64;
        // The lengths that are tried are steps of two percent, and segments go with their root.
        assert!(n <= most && n + 8 + most / 100 >= most, "{n} of {most}");
        let at_most = made.bound.at_most().unwrap();
        assert!(at_most < before);
        before = at_most;
    }
    // What is left of a ring for one triangle is as far from it as the ring is large.
    match with(Budget::triangles(1)) {
        Ok(made) => assert!(made.shape.faces().len() <= 1 && made.bound.at_most().unwrap() >= 1.0),
        Err(failure) => assert!(matches!(failure, Failure::Unmet(_))),
    }
    let both = Budget { triangles: Some(10), ..Budget::length(Tolerance::new(1e-4).unwrap()) };
    assert!(matches!(with(both), Err(Failure::Unmet(_))));
    assert_eq!(with(Budget::segments(5)).unwrap_err().code(), "budget");
    assert_eq!(with(Budget::length(Tolerance::new(1e-11).unwrap())).unwrap_err().code(), "below-precision");
    let job = Job::default();
    job.cancel();
    assert_eq!(
        convert::outlines_to_mesh(&ring, &Budget::triangles(9), &job).unwrap_err().code(),
        "cancelled"
    );
}

/// A closed path of cubics with loops and crossings.
fn path(random: &mut Random, n: usize) -> Curve<2> {
    let corners: Vec<_> = (0..n).map(|_| random.point_within(5.0)).collect();
    let piece =
        |i: usize, b, c| CurveSegment::Cubic(Bezier { control: [corners[i], b, c, corners[(i + 1) % n]] });
    let pieces = (0..n).map(|i| piece(i, random.point_within(5.0), random.point_within(5.0))).collect();
    Curve::new(pieces, CurveEnds::Closed).unwrap()
}

/// Samples of a contour, so close that chords between them are 1e-5 off at most.
fn sampled(curve: &Curve<2>) -> Vec<[f64; 2]> {
    let n = 2000 * curve.segments().len();
    (0..n).map(|i| curve.at(i as f64 / 2000.0)).collect()
}

fn winding(contour: &[[f64; 2]], p: [f64; 2]) -> i32 {
    contour.iter().zip(contour.iter().cycle().skip(1)).fold(0, |sum, (a, b)| {
        if (a[1] <= p[1]) == (b[1] <= p[1]) {
            return sum;
        }
        let left = (b[0] - a[0]) * (p[1] - a[1]) > (b[1] - a[1]) * (p[0] - a[0]);
        sum + i32::from(left && b[1] > p[1]) - i32::from(!left && b[1] <= p[1])
    })
}

#[test]
fn a_point_on_the_wrong_side_is_within_the_bound_of_a_contour() {
    let seed = 20_261_120;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let (mut asked, mut wrong) = (0, 0);
    for round in 0..60 {
        let n = 1 + round % 3;
        let contours: Vec<_> = (0..n).map(|i| path(&mut random, 2 + (round + i) % 4)).collect();
        let samples: Vec<_> = contours.iter().map(sampled).collect();
        for rule in [FillRule::NonZero, FillRule::EvenOdd] {
            let made = made(&[Outline { contours: contours.clone(), rule }], [0.3, 0.03, 0.003][round % 3]);
            is_sound(&made.shape);
            let at_most = made.bound.at_most().unwrap();
            for _ in 0..60 {
                let p = random.point_within::<2>(5.0);
                let inside = rule.holds(samples.iter().map(|contour| winding(contour, p)).sum());
                let covers = |face: &usize| {
                    let [a, b, c] = made.shape.corners(*face);
                    let p = [p[0], p[1], 0.0];
                    twice_area([a, b, p]) > 0.0 && twice_area([b, c, p]) > 0.0 && twice_area([c, a, p]) > 0.0
                };
                let times = (0..made.shape.faces().len()).filter(covers).count();
                assert!(times <= 1, "triangles lie on each other");
                asked += 1;
                if inside != (times == 1) {
                    wrong += 1;
                    let far = |q: &[f64; 2]| ((q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2)).sqrt();
                    let nearest = samples.iter().flatten().map(far).fold(f64::INFINITY, f64::min);
                    // Samples are up to 0.01 apart on the longest pieces, and half of that from any point
                    // between.
                    assert!(nearest <= at_most + 0.01, "{p:?}: {nearest} > {at_most}");
                }
            }
        }
    }
    println!("{wrong} of {asked} points on the wrong side, all near a contour");
    assert!(wrong > 0 && wrong < asked / 20);
}
