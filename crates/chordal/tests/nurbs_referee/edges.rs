//! How smooth surfaces are across knots and shared sides, where that is known in closed form.
use super::truth::{random_points, random_weights};
use chordal::check::surfaces::nurbs_edges;
use chordal::explicit::nurbs::{KnotVector, NurbsCurve, NurbsSurface, TrimmedSurface};
use chordal_testkit::{Random, cases};
use std::f64::consts::FRAC_PI_2;

#[test]
fn a_knot_leaves_as_many_derivatives_as_its_multiplicity_says() {
    let mut random = Random::new(1801);
    for _ in 0..cases(60) {
        let degrees = [1 + random.below(4), 1 + random.below(4)];
        let times = degrees.map(|p| 1 + random.below(p));
        let knots = [0, 1].map(|k| {
            let (p, inner) = (degrees[k], random.between(0.3, 0.7));
            let mut all = vec![0.0; p + 1];
            all.extend(vec![inner; times[k]]);
            all.extend(vec![1.0; p + 1]);
            KnotVector::new(p, all).unwrap()
        });
        let n = knots[0].n_control() * knots[1].n_control();
        let surface = NurbsSurface::new(knots, random_points(&mut random, n), random_weights(&mut random, n));
        let found = nurbs_edges(&[surface.unwrap().into()]);
        assert_eq!((found.knot_lines.len(), found.boundary.len(), found.joins.len()), (2, 4, 0));
        for (join, (p, m)) in found.knot_lines.iter().zip(degrees.into_iter().zip(times)) {
            let class = Some((p - m).min(2) as u8);
            assert_eq!((join.parametric, join.geometric), (class, class), "degree {p}, {m} times: {join:?}");
            assert_eq!(join.position_gap.value, 0.0);
            let angle = join.angle_rad.unwrap().value;
            assert_eq!(angle > 0.0, class == Some(0));
        }
    }
}

/// A square beside the z axis, turned about it; `v` along the axis, by other parameters.
fn leaf(angle_rad: f64, weight: f64, height: f64, scale: f64) -> NurbsSurface {
    let (sin, cos) = angle_rad.sin_cos();
    let knots = [KnotVector::clamped(1, 2).unwrap(), KnotVector::clamped(2, 3).unwrap()];
    let row = |z: f64| [[0.0, 0.0, z], [cos, sin, z]].map(|p| p.map(|x| x * scale));
    let control = [row(0.0), row(0.5 * height), row(height)].concat();
    NurbsSurface::new(knots, control, vec![1.0, 1.0, weight, weight, 1.0, 1.0]).unwrap()
}

#[test]
fn leaves_meet_at_the_angle_between_them_whatever_their_parameters() {
    let mut random = Random::new(1802);
    for _ in 0..cases(40) {
        let scale = random.power(-6.0, 6.0);
        let turn = random.between(0.2, 2.9);
        let [v, w] = [1.0, random.power(-0.5, 0.5)];
        let leaves = [leaf(0.0, v, 1.0, scale), leaf(turn, w, 1.0, scale)];
        let faces = leaves.map(TrimmedSurface::from);
        let found = nurbs_edges(&faces);
        assert_eq!((found.joins.len(), found.boundary.len()), (1, 6), "{w} {scale:e}");
        let join = found.joins[0];
        // Both have the axis on the left, so that they are fronts of one surface seen from both sides.
        assert!(!join.fronts_agree);
        let angle = join.angle_rad.unwrap().value;
        assert!((angle - (std::f64::consts::PI - turn)).abs() < 1e-9, "{angle} {turn}");
        assert_eq!((join.geometric, join.parametric), (Some(0), Some(0)));
        // Flipped, the second one has its front where the first has it.
        let flipped = [faces[0].clone(), faces[1].clone().flipped()];
        assert!(nurbs_edges(&flipped).joins[0].fronts_agree);
        // A side that is longer is no neighbour.
        let longer = [leaf(0.0, 1.0, 1.0, scale), leaf(turn, 1.0, 1.5, scale)].map(TrimmedSurface::from);
        assert_eq!(nurbs_edges(&longer).joins.len(), 0);
    }
}

#[test]
fn curvature_jumps_by_one_over_the_radius_where_a_pipe_goes_straight_on() {
    for radius in [1e-6, 0.25, 1.0, 1e6] {
        let r = radius;
        let axes = [[r, 0.0, 0.0], [0.0, r, 0.0]];
        let arc = NurbsCurve::arc([0.0, r, 0.0], axes, -2.0 * FRAC_PI_2, FRAC_PI_2).unwrap();
        let line = NurbsCurve::line([0.0; 3], [3.0 * r, 0.0, 0.0]).unwrap();
        let up = [0.0, 0.0, 2.0 * r];
        let faces = [arc, line].map(|c| TrimmedSurface::from(NurbsSurface::extruded(&c, up).unwrap()));
        let found = nurbs_edges(&faces);
        let [join] = found.joins[..] else { panic!("{found:?}") };
        assert_eq!((join.geometric, join.fronts_agree), (Some(1), true), "{r}");
        assert!((join.curvature_gap.unwrap().value * r - 1.0).abs() < 1e-9);
        assert_eq!(join.angle_rad.unwrap().value, 0.0);
    }
}

#[test]
fn poles_are_points_and_seams_are_smooth() {
    let ball = nurbs_edges(&[NurbsSurface::sphere(2.0).unwrap().into()]);
    assert_eq!((ball.collapsed.len(), ball.joins.len(), ball.boundary.len()), (2, 1, 0));
    assert!(ball.joins.iter().chain(&ball.knot_lines).all(|join| join.geometric == Some(2)), "{ball:?}");
    // A gap between two sides that are nearly one.
    let [a, mut b] = [leaf(0.0, 1.0, 1.0, 1.0), leaf(2.0, 1.0, 1.0, 1.0)];
    let moved = b.control().iter().map(|[x, y, z]| [*x, y + 1e-4, *z]).collect();
    b = NurbsSurface::new(b.knots().clone(), moved, b.weights().to_vec()).unwrap();
    let found = nurbs_edges(&[a.into(), b.into()]);
    assert_eq!((found.joins.len(), found.joins[0].geometric), (1, None));
    assert!((found.joins[0].position_gap.value - 1e-4).abs() < 1e-9);
}
