//! The arrow `outlines_to_solid`: volumes in closed form, solids that are closed and manifold whatever their
//! outline, and what is refused.
use chordal::budget::{PixelBudget, View};
use chordal::check::findings::measure;
use chordal::check::validity;
use chordal::explicit::{Arc, Bezier, Curve, CurveEnds, CurveSegment, FillRule, Outline, Topology};
use chordal::{Bounded, Budget, Failure, Job, Mesh, Tolerance, convert};
use chordal_testkit::{Random, cases};
use std::f64::consts::PI;

fn length(tolerance: f64) -> Budget {
    Budget::length(Tolerance::new(tolerance).unwrap())
}

fn solid(outlines: &[Outline], height: f64, tolerance: f64) -> Bounded<Mesh> {
    convert::outlines_to_solid(outlines, height, &length(tolerance), &Job::default())
        .unwrap_or_else(|error| panic!("{error}"))
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

fn nonzero(contours: Vec<Curve<2>>) -> [Outline; 1] {
    [Outline { contours, rule: FillRule::NonZero }]
}

/// Closed, and a manifold with its front outside.
#[track_caller]
fn is_solid(mesh: &Mesh) {
    let found = validity(mesh, Topology::Indices);
    assert!(found.closed && found.edge_manifold && found.vertex_manifold && found.oriented, "{found:?}");
    assert!(measure(mesh).signed_volume > 0.0);
}

#[test]
fn a_solid_has_the_volume_of_its_flat_mesh_times_its_height() {
    for scale in [1e-6, 1.0, 1e6] {
        let ring = nonzero(vec![circle([scale, 0.0], 2.0 * scale), circle([scale, 0.0], scale).reversed()]);
        for (height, tolerance) in [(3.0, 1e-2), (1e-3, 1e-4), (1e3, 0.3)] {
            let made = solid(&ring, height * scale, tolerance * scale);
            is_solid(&made.shape);
            let flat = convert::outlines_to_mesh(&ring, &length(tolerance * scale), &Job::default()).unwrap();
            assert_eq!(made.bound, flat.bound);
            let n = flat.shape.positions().len();
            assert_eq!(
                (made.shape.positions().len(), made.shape.faces().len()),
                (2 * n, 2 * flat.shape.faces().len() + 2 * n)
            );
            let volume = measure(&made.shape).signed_volume;
            let truth = measure(&flat.shape).area * height * scale;
            assert!((volume / truth - 1.0).abs() < 1e-9, "{volume}, not {truth}");
            // Walls between the planes 0 and the height, to the last bit.
            let z = |mesh: &Mesh| (mesh.bounds().min[2], mesh.bounds().max[2]);
            assert_eq!(z(&made.shape), (0.0, height * scale));
        }
    }
}

#[test]
fn caps_are_the_triangles_of_the_plane() {
    let outline = nonzero(vec![circle([0.0; 2], 1.0)]);
    let flat = convert::outlines_to_mesh(&outline, &length(0.05), &Job::default()).unwrap().shape;
    let made = solid(&outline, 2.0, 0.05).shape;
    let corners = |mesh: &Mesh, z: f64| {
        let faces = (0..mesh.faces().len()).map(|face| mesh.corners(face));
        let mut at: Vec<_> = faces
            .filter(|corners| corners.iter().all(|p| p[2] == z))
            .map(|corners| {
                let mut all = corners.map(|[x, y, _]| [x.to_bits(), y.to_bits()]);
                all.sort_unstable();
                all
            })
            .collect();
        at.sort_unstable();
        at
    };
    assert_eq!(corners(&made, 0.0), corners(&flat, 0.0));
    assert_eq!(corners(&made, 2.0), corners(&flat, 0.0));
}

#[test]
fn regions_that_touch_in_a_point_have_vertices_of_their_own_there() {
    let square = |x: f64| polygon(&[[x, x], [x + 1.0, x], [x + 1.0, x + 1.0], [x, x + 1.0]]);
    let made = solid(&nonzero(vec![square(0.0), square(1.0)]), 1.0, 1e-3).shape;
    is_solid(&made);
    assert_eq!((made.positions().len(), made.faces().len()), (16, 24));
    // By position four walls meet along a line there: that cannot be helped.
    let by_position = validity(&made, Topology::Positions);
    assert!(by_position.closed && !by_position.edge_manifold);
}

#[test]
fn outlines_that_overlap_are_solids_of_their_own_and_contours_that_do_are_one() {
    let squares = [0.0, 0.5].map(|x| polygon(&[[x, x], [x + 1.0, x], [x + 1.0, x + 1.0], [x, x + 1.0]]));
    let apart = squares.clone().map(|contour| Outline { contours: vec![contour], rule: FillRule::NonZero });
    let made = solid(&apart, 1.0, 1e-3).shape;
    is_solid(&made);
    assert!((measure(&made).signed_volume - 2.0).abs() < 1e-9);
    let made = solid(&nonzero(squares.to_vec()), 1.0, 1e-3).shape;
    is_solid(&made);
    assert!((measure(&made).signed_volume - 1.75).abs() < 1e-9);
}

#[test]
fn random_paths_with_loops_become_solids() {
    let seed = 17;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for _ in 0..cases(60) {
        let n = 3 + random.below(4);
        let corners: Vec<[f64; 2]> = (0..n).map(|_| random.point_within(5.0)).collect();
        let piece = |i: usize, b, c| {
            CurveSegment::Cubic(Bezier { control: [corners[i], b, c, corners[(i + 1) % n]] })
        };
        let pieces = (0..n).map(|i| piece(i, random.point_within(5.0), random.point_within(5.0))).collect();
        let contour = Curve::new(pieces, CurveEnds::Closed).unwrap();
        for rule in [FillRule::NonZero, FillRule::EvenOdd] {
            let made = solid(&[Outline { contours: vec![contour.clone()], rule }], 0.7, 1e-2);
            is_solid(&made.shape);
            assert!(made.bound.at_most().unwrap() <= 1e-2);
        }
    }
}

#[test]
fn a_number_of_triangles_counts_caps_and_walls() {
    let ring = nonzero(vec![circle([0.0; 2], 2.0), circle([0.0; 2], 1.0).reversed()]);
    for most in [64, 300, 5000] {
        let made = convert::outlines_to_solid(&ring, 1.0, &Budget::triangles(most), &Job::default()).unwrap();
        let n = made.shape.faces().len() as u64;
        assert!(n <= most && n + 32 + most / 50 >= most, "{n} of {most}");
        is_solid(&made.shape);
    }
    let few = convert::outlines_to_solid(&ring, 1.0, &Budget::triangles(3), &Job::default());
    assert!(matches!(few, Err(Failure::Unmet(_))));
}

#[test]
fn pixels_count_where_the_solid_comes_nearest() {
    let disc = nonzero(vec![circle([0.0; 2], 1.0)]);
    // The eye is 10 above the plane, and 2 above the upper cap.
    let view: View = "1000x1000 fov=90 eye=0,0,10 target=0,0,0".parse().unwrap();
    let budget =
        Budget { pixels: Some(PixelBudget { pixels: "1px".parse().unwrap(), view }), ..Budget::default() };
    let flat = convert::outlines_to_mesh(&disc, &budget, &Job::default()).unwrap();
    let made = convert::outlines_to_solid(&disc, 8.0, &budget, &Job::default()).unwrap();
    assert!(made.bound.pixels.unwrap() <= 1.0);
    // Four to five times as near at the top: as much less may be lost.
    let (near, far) = (made.bound.at_most().unwrap(), flat.bound.at_most().unwrap());
    assert!(near < far / 3.0 && near > far / 10.0, "{near} {far}");
    let through = convert::outlines_to_solid(&disc, 10.0, &budget, &Job::default());
    assert_eq!(through.unwrap_err().code(), "too-close");
}

#[test]
fn heights_that_are_none_are_refused() {
    let disc = nonzero(vec![circle([0.0; 2], 1.0)]);
    for height in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e200] {
        let refused = convert::outlines_to_solid(&disc, height, &length(0.1), &Job::default()).unwrap_err();
        assert_eq!(refused.code(), "budget");
    }
    let none = convert::outlines_to_solid(&nonzero(vec![]), 1.0, &length(0.1), &Job::default()).unwrap();
    assert!(none.shape.faces().is_empty());
}
