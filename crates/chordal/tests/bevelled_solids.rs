//! The arrow `outlines_to_bevelled_solid`: volumes in closed form, the height of every triangle against a distance of its
//! own, and what is refused.
use chordal::budget::Evidence;
use chordal::check::findings::measure;
use chordal::check::validity;
use chordal::convert::{self, bevels::Bevel};
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment, FillRule, Outline, Topology};
use chordal::{Bounded, Budget, Failure, Job, Mesh, Tolerance};
use chordal_testkit::Random;
use std::f64::consts::PI;

fn length(tolerance: f64) -> Budget {
    Budget::length(Tolerance::new(tolerance).unwrap())
}

fn circle([x, y]: [f64; 2], r: f64) -> Curve<2> {
    let turn = Arc::new([x, y], [[r, 0.0], [0.0, r]], 0.0, 2.0 * PI).unwrap();
    Curve::new(vec![CurveSegment::Arc(turn.with_ends([[x + r, y]; 2]))], CurveEnds::Closed).unwrap()
}

fn polygon(points: &[[f64; 2]]) -> Curve<2> {
    let next = points.iter().cycle().skip(1);
    let sides = points.iter().zip(next).map(|(a, b)| CurveSegment::Line([*a, *b])).collect();
    Curve::new(sides, CurveEnds::Closed).unwrap()
}

fn outline(contours: Vec<Curve<2>>) -> [Outline; 1] {
    [Outline { contours, rule: FillRule::NonZero }]
}

/// A bevelled solid that must be one: closed, a manifold with its front outside, and within the budget.
#[track_caller]
fn solid(outlines: &[Outline], bevel: Bevel, tolerance: f64) -> Bounded<Mesh> {
    let made = convert::outlines_to_bevelled_solid(outlines, bevel, &length(tolerance), &Job::default())
        .unwrap_or_else(|error| panic!("{error}"));
    let found = validity(&made.shape, Topology::Indices);
    assert!(found.closed && found.edge_manifold && found.vertex_manifold && found.oriented, "{found:?}");
    assert!(made.bound.at_most().unwrap() <= tolerance, "{}", made.bound);
    assert!(matches!(made.bound.evidence(), Evidence::ProvedIf(_)));
    made
}

const L: [[f64; 2]; 6] = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.5], [1.5, 1.5], [1.5, 4.0], [0.0, 4.0]];

#[test]
fn volumes_are_those_of_the_sections() {
    let bevel = Bevel { height: 2.0, width: 0.5 };
    let (h, w) = (bevel.height, bevel.width);
    // A section that is t inside: of the L, five corners take t² back and the inner one π/4 t², of a ring π of both.
    let (area, around) = (9.75, 16.0);
    let of_l =
        area * (h - 2.0 * w) + 2.0 * (area * w - around * w * w / 2.0 + (5.0 - PI / 4.0) * w.powi(3) / 3.0);
    let of_ring = PI * ((4.0 - 1.0) * (h - 2.0 * w) + 2.0 * (3.0 * w - (4.0 + 2.0) * w * w / 2.0));
    // A bar that is narrower than two bevels has a ridge: sections end where it is 0 wide.
    let wide = Bevel { height: 2.0, width: 0.8 };
    let of_bar = 10.0 * 0.4 + 2.0 * (10.0 * 0.5 - 22.0 * 0.125 + 4.0 * 0.125 / 3.0);
    let ring = vec![circle([0.0; 2], 2.0), circle([0.0; 2], 1.0).reversed()];
    let bar = [[0.0, 0.0], [10.0, 0.0], [10.0, 1.0], [0.0, 1.0]];
    for tolerance in [0.05, 1e-3] {
        for (contours, bevel, truth) in [
            (vec![polygon(&L)], bevel, of_l),
            (ring.clone(), bevel, of_ring),
            (vec![polygon(&bar)], wide, of_bar),
        ] {
            let made = solid(&outline(contours), bevel, tolerance);
            let found = measure(&made.shape);
            // What two solids within the bound differ by is a shell around one.
            let most = 1.5 * made.bound.at_most().unwrap() * found.area;
            assert!(
                (found.signed_volume - truth).abs() <= most,
                "{} not {truth}, {most}",
                found.signed_volume
            );
        }
    }
}

/// The distance to the border of a polygon, by a scan of its sides.
fn border_distance(points: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let sides = points.iter().zip(points.iter().cycle().skip(1));
    sides.fold(f64::INFINITY, |least, (a, b)| {
        let d = [b[0] - a[0], b[1] - a[1]];
        let along = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
        let t = along.clamp(0.0, 1.0);
        least.min((p[0] - a[0] - t * d[0]).hypot(p[1] - a[1] - t * d[1]))
    })
}

#[test]
fn every_roof_is_as_far_up_as_its_distance_to_the_border() {
    let seed = 44;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let mut part = |n: usize| random.below(n + 1) as f64 / n as f64;
    for round in 0..30 {
        // A star of random radii: spikes, notches, and places thinner than the bevel.
        let n = 5 + round % 9;
        let star: Vec<[f64; 2]> = (0..n)
            .map(|i| {
                let (sin, cos) = (2.0 * PI * i as f64 / n as f64).sin_cos();
                let r = 0.4 + 3.0 * part(100);
                [r * cos, r * sin]
            })
            .collect();
        let (bevel, tolerance) = (Bevel { height: 3.0, width: 0.2 + 1.2 * part(50) }, 0.01);
        let made = solid(&outline(vec![polygon(&star)]), bevel, tolerance);
        let bound = made.bound.at_most().unwrap();
        let mut worst: f64 = 0.0;
        for face in made.shape.faces() {
            let at = face.map(|i| made.shape.positions()[i as usize]);
            let [a, b] = [part(64), part(64)];
            let [a, b] = if a + b > 1.0 { [1.0 - a, 1.0 - b] } else { [a, b] };
            let p: [f64; 3] =
                std::array::from_fn(|k| at[0][k] + a * (at[1][k] - at[0][k]) + b * (at[2][k] - at[0][k]));
            let d = border_distance(&star, [p[0], p[1]]).min(bevel.width);
            let [low, high] = [bevel.width - d, bevel.height - bevel.width + d];
            // On the roof, the floor or a wall, which is where the border is.
            let off = (p[2] - low).abs().min((p[2] - high).abs());
            let off = if p[2] > low && p[2] < high { off.min(d) } else { off };
            worst = worst.max(off);
        }
        assert!(worst <= bound, "{worst} beyond {bound}: {star:?}, {bevel:?}");
        assert!(worst > 0.0);
        // And the mesh has a point above each of the region: both roofs have its area.
        let twice: f64 =
            star.iter().zip(star.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
        let upward = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|i| made.shape.positions()[i as usize]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).max(0.0)
        };
        let found: f64 = made.shape.faces().iter().map(upward).sum();
        assert!((found - twice).abs() < 1e-6, "{found} {twice}");
    }
}

#[test]
fn regions_that_touch_in_a_point_stay_apart_and_outlines_too() {
    let bevel = Bevel { height: 1.0, width: 0.25 };
    let squares =
        [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]];
    let both = outline(squares.iter().map(|square| polygon(square)).collect());
    let apart = squares.map(|square| outline(vec![polygon(&square)])[0].clone());
    let [one, two] =
        [&both[..], &apart[..]].map(|outlines| measure(&solid(outlines, bevel, 0.01).shape).signed_volume);
    assert!((one - two).abs() < 1e-6, "{one} {two}");
    let nothing = convert::outlines_to_bevelled_solid(&[], bevel, &length(0.01), &Job::default()).unwrap();
    assert!(nothing.shape.faces().is_empty());
}

#[test]
fn what_makes_no_bevel_is_refused() {
    let square = outline(vec![polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])]);
    let refuse = |height: f64, width: f64, budget: Budget| match convert::outlines_to_bevelled_solid(
        &square,
        Bevel { height, width },
        &budget,
        &Job::default(),
    ) {
        Err(failure @ Failure::Refused(_)) => failure.to_string(),
        other => panic!("{other:?}"),
    };
    let narrower = "narrower than half of the height 2, not";
    for width in [0.0, -1.0, 1.0, 1.5, f64::NAN] {
        assert!(refuse(2.0, width, length(0.1)).contains(narrower), "{width}");
    }
    assert!(refuse(0.0, 0.1, length(0.1)).contains("a height above 0"));
    assert!(refuse(2.0, 0.1, Budget::triangles(100)).contains("not a number of triangles"));
    assert!(refuse(2.0, 0.1, Budget::default()).contains("needs a length or pixels"));
    assert!(refuse(2.0, 0.1, length(1e-14)).contains("of rounding outlines of this size"));
    assert!(refuse(1e7, 0.1, length(1e-9)).contains("less than the possible rounding error of solids"));
    let mut job = Job::default();
    job.triangle_limit = 100;
    let round = outline(vec![circle([0.0; 2], 1.0)]);
    let made =
        convert::outlines_to_bevelled_solid(&round, Bevel { height: 2.0, width: 0.5 }, &length(1e-6), &job);
    assert!(matches!(made, Err(Failure::Refused(_))));
    let job = Job::default();
    job.cancel();
    let made =
        convert::outlines_to_bevelled_solid(&round, Bevel { height: 2.0, width: 0.5 }, &length(1e-3), &job);
    assert!(matches!(made, Err(Failure::Cancelled)));
}
