//! Contours that cross, touch or overlap as fields of the plane, judged by counting crossings and by all edges.
use chordal::budget::Evidence;
use chordal::check::{findings::measure, validity};
use chordal::convert::{contours_to_field, field_to_mesh};
use chordal::explicit::{FillRule, Topology};
use chordal::implicit::{Distance, Field};
use chordal::{Budget, Job, Tolerance};
use chordal_testkit::Random;

type Contour = Vec<[f64; 2]>;

fn made(contours: &[Contour], rule: FillRule) -> (Field, f64) {
    let made = contours_to_field(contours, rule, &Job::default()).expect("they enclose something");
    (made.shape, made.bound.at_most().unwrap())
}

fn edges(contours: &[Contour]) -> Vec<[[f64; 2]; 2]> {
    let of = |contour: &Contour| {
        let n = contour.len();
        (0..n).map(|k| [contour[k], contour[(k + 1) % n]]).collect::<Vec<_>>()
    };
    contours.iter().flat_map(of).collect()
}

/// How often contours wind around a point.
fn winding(contours: &[Contour], p: [f64; 2]) -> i32 {
    let mut sum = 0;
    for [a, b] in edges(contours) {
        if (a[1] <= p[1]) != (b[1] <= p[1]) {
            let x = a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            if x > p[0] {
                sum += if b[1] > a[1] { 1 } else { -1 };
            }
        }
    }
    sum
}

fn to_edges(contours: &[Contour], p: [f64; 2]) -> f64 {
    let to = |[a, b]: [[f64; 2]; 2]| {
        let d = [b[0] - a[0], b[1] - a[1]];
        let t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
        let t = t.clamp(0.0, 1.0);
        (p[0] - a[0] - t * d[0]).hypot(p[1] - a[1] - t * d[1])
    };
    edges(contours).into_iter().map(to).fold(f64::INFINITY, f64::min)
}

#[test]
fn random_polygons_have_the_side_and_the_distance_of_their_edges() {
    let mut random = Random::new(66);
    let mut number = move || random.below(1_000_003) as f64 / 1e5;
    let mut n_crossing = 0;
    for n in 4..24 {
        let contours: Vec<Contour> =
            (0..1 + n % 3).map(|_| (0..n).map(|_| [number(), number()]).collect()).collect();
        for rule in [FillRule::EvenOdd, FillRule::NonZero] {
            let (field, moved) = made(&contours, rule);
            // By chance none of its sides cross.
            if moved == 0.0 {
                continue;
            }
            n_crossing += 1;
            assert!(moved < 1e-8, "{moved}");
            assert!(matches!(field.evidence(), Evidence::ProvedIf(_)));
            for _ in 0..100 {
                let p = [number() * 1.2 - 1.0, number() * 1.2 - 1.0];
                let value = field.expr().at([p[0], p[1], 0.0]).unwrap();
                let (turns, near) = (winding(&contours, p), to_edges(&contours, p));
                let inside = if rule == FillRule::EvenOdd { turns % 2 != 0 } else { turns != 0 };
                if near > 2.0 * moved {
                    assert_eq!(value < 0.0, inside, "{n} {p:?} {value}");
                }
                // Every edge has the outside on one side by the even-odd rule, and is border.
                if rule == FillRule::EvenOdd {
                    assert!((value.abs() - near).abs() < 4.0 * moved + 1e-12, "{n} {p:?} {value} {near}");
                }
            }
        }
    }
    assert!(n_crossing > 30, "{n_crossing}");
}

#[test]
fn bars_that_overlap_are_meshed_as_the_cross_that_they_fill() {
    let bar = |x: f64, y: f64, w: f64, h: f64| vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
    let bars = [bar(0.0, 15.0, 40.0, 10.0), bar(15.0, 0.0, 10.0, 40.0)];
    let (cross, _) = made(&bars, FillRule::NonZero);
    assert_eq!(cross.distance(), Distance::EXACT);
    let solid = cross.extruded(3.0).unwrap();
    let budget = Budget::length(Tolerance::new(0.1).unwrap());
    let mesh = field_to_mesh(&solid, &budget, &Job::default()).expect("it is within a tenth");
    let found = validity(&mesh.shape, Topology::Indices);
    assert!(found.closed && found.non_manifold_edges.count == 0);
    // Two bars of 400 less the square of 100 that both have.
    assert!((measure(&mesh.shape).signed_volume - 700.0 * 3.0).abs() < 1e-6);
    assert!(mesh.shape.faces().len() <= 60, "{}", mesh.shape.faces().len());
    // By the other rule the square in the middle is a hole, whose corners all touch what is around it.
    let (ring, _) = made(&bars, FillRule::EvenOdd);
    let at = |p: [f64; 3]| ring.expr().at(p).unwrap();
    assert_eq!((at([20.0, 20.0, 0.0]), at([7.0, 20.0, 0.0])), (5.0, -5.0));
}

#[test]
fn contours_that_meet_nowhere_stay_as_they_are() {
    let square = |r: f64| vec![[-r, -r], [r, -r], [r, r], [-r, r]];
    let (ring, moved) = made(&[square(0.3), square(0.7)], FillRule::EvenOdd);
    assert_eq!((moved, ring.evidence()), (0.0, Evidence::Proved));
    assert_eq!(ring.expr().at([0.0; 3]).unwrap(), 0.3);
}
