//! Lofts, Coons patches and sweeps: against their definitions, by evaluators that share no code with the library.
use super::truth::{basis, parameter, random_knots, random_weights};
use super::{OWN, Spline, largest};
use chordal::budget::{Bounded, Failure};
use chordal::convert::sweeps::{ProfilePlace, SweepPath};
use chordal::explicit::CurveEnds;
use chordal::explicit::nurbs::{InvalidNurbs, KnotVector, NurbsCurve, NurbsSurface};
use chordal::explicit::spline::{self, Knots};
use chordal::{Job, Tolerance, convert};
use chordal_testkit::sampler::distance;
use chordal_testkit::{Random, cases};
use std::f64::consts::TAU;

type Point = [f64; 3];

fn plus(a: Point, by: f64, b: Point) -> Point {
    std::array::from_fn(|k| a[k] + by * b[k])
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Point) -> Point {
    a.map(|x| x / dot(a, a).sqrt())
}

/// A point of a surface by the recursion.
fn at(surface: &NurbsSurface, u: f64, v: f64) -> Point {
    let [along_u, along_v] = surface.knots().each_ref().map(|k| (k.knots().to_vec(), k.degree()));
    let (n, m) = (basis(&along_u.0, along_u.1, u), basis(&along_v.0, along_v.1, v));
    let (mut sum, mut total) = ([0.0; 3], 0.0);
    for (j, b) in m.iter().enumerate().filter(|(_, b)| **b != 0.0) {
        for (i, a) in n.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            let w = a * b * surface.weights()[j * n.len() + i];
            sum = plus(sum, w, surface.control()[j * n.len() + i]);
            total += w;
        }
    }
    sum.map(|x| x / total)
}

fn reach(surface: &NurbsSurface) -> f64 {
    largest(surface.control())
}

fn scaled(points: Vec<Point>, by: f64) -> Vec<Point> {
    points.into_iter().map(|p| p.map(|x| x * by)).collect()
}

/// The parameters of sections with the same knots, by the definition.
fn mean_chords(sections: &[Spline], closed: bool) -> Vec<f64> {
    let (n, width) = (sections.len(), sections[0].control.len());
    let last = if closed { n } else { n - 1 };
    let mut at = vec![0.0; last + 1];
    for i in 0..width {
        let chord = |k: usize| distance(sections[k].control[i], sections[(k + 1) % n].control[i]);
        let total: f64 = (0..last).map(chord).sum();
        let mut sum = 0.0;
        for k in 0..last {
            sum += chord(k) / total;
            at[k + 1] += sum / width as f64;
        }
    }
    // Beyond 1 by rounding there is no surface.
    at[last] = 1.0;
    at
}

fn random_sections(random: &mut Random, n: usize) -> Vec<Spline> {
    let degree = 1 + random.below(4);
    let width = degree + 1 + random.below(5);
    let mut knots = random_knots(random, degree, width);
    // Clamped: lofts of others have other control points.
    let (from, to) = (knots[degree], knots[width]);
    knots[..degree].fill(from);
    knots[width..].fill(to);
    let scale = random.power(-6.0, 6.0);
    // Weights that differ little from section to section, so that none swings below 0.
    let weights = random_weights(random, width);
    (0..n)
        .map(|k| {
            let place = |i: usize| [i as f64, k as f64, 0.0];
            let control = (0..width).map(|i| plus(place(i), 0.4, random.point())).collect();
            let weights = weights.iter().map(|w| w * random.between(0.95, 1.05)).collect();
            Spline { degree, knots: knots.clone(), control: scaled(control, scale), weights }
        })
        .collect()
}

#[test]
fn a_loft_is_each_of_its_sections() {
    let mut random = Random::new(1701);
    for _ in 0..cases(150) {
        let closed = random.below(3) == 0;
        let degree = if closed { [1, 3, 5][random.below(3)] } else { 1 + random.below(5) };
        let n = degree + 1 + random.below(6) + usize::from(closed);
        let sections = random_sections(&mut random, n);
        let curves: Vec<_> = sections.iter().map(Spline::curve).collect();
        let ends = CurveEnds::from(closed);
        let loft = match NurbsSurface::lofted(&curves, degree, ends) {
            Ok(loft) => loft,
            Err(InvalidNurbs::SwungWeight { .. }) => continue,
            Err(error) => panic!("{error}"),
        };
        let (size, own) = (reach(&loft), OWN * reach(&loft));
        assert!(loft.slack() < 1e-6 * size, "{degree} {n} {closed}: {:e} of {size:e}", loft.slack());
        let places = mean_chords(&sections, closed);
        for (section, v) in sections.iter().zip(&places) {
            for _ in 0..8 {
                let u = parameter(&section.knots, section.degree, random.unit());
                let off = distance(at(&loft, u, *v), section.at(u));
                assert!(off <= loft.slack() + own, "{off:e} {:e} {degree} {closed}", loft.slack());
            }
        }
        if closed {
            let u = parameter(&sections[0].knots, sections[0].degree, random.unit());
            assert_eq!(loft.at(u, 0.0), loft.at(u, 1.0));
            // Derivatives go on across the seam, as differences of the order of the continuity show.
            if degree > 1 {
                let h = 1e-5;
                let slope = |a: f64, b: f64| plus(loft.at(u, b), -1.0, loft.at(u, a)).map(|x| x / h);
                let (before, after) = (slope(1.0 - h, 1.0), slope(0.0, h));
                assert!(distance(before, after) < 2e-2 * dot(after, after).sqrt() + 1e-4 * size);
            }
        }
    }
}

#[test]
fn sections_of_other_degrees_knots_and_domains_are_met() {
    let mut random = Random::new(1702);
    for _ in 0..cases(60) {
        let n = 2 + random.below(3);
        let scale = random.power(-6.0, 6.0);
        let sections: Vec<Spline> = (0..n)
            .map(|k| {
                let degree = 1 + random.below(4);
                let width = degree + 1 + random.below(4);
                let knots = random_knots(&mut random, degree, width);
                let control =
                    (0..width).map(|i| plus([i as f64, 3.0 * k as f64, 0.0], 0.4, random.point())).collect();
                Spline { degree, knots, control: scaled(control, scale), weights: vec![1.0; width] }
            })
            .collect();
        let curves: Vec<_> = sections.iter().map(Spline::curve).collect();
        let loft = NurbsSurface::lofted(&curves, 1, CurveEnds::Open).unwrap();
        let own = OWN * reach(&loft);
        let domain = |knots: &[f64], degree: usize| [knots[degree], knots[knots.len() - 1 - degree]];
        let [from, to] = loft.knots()[0].domain();
        for (section, v) in [(&sections[0], 0.0), (&sections[n - 1], 1.0)] {
            let [a, b] = domain(&section.knots, section.degree);
            for _ in 0..12 {
                let place = random.unit();
                let off = distance(
                    at(&loft, (1.0 - place) * from + place * to, v),
                    section.at((1.0 - place) * a + place * b),
                );
                assert!(off <= loft.slack() + own, "{off:e} {:e}", loft.slack());
            }
        }
    }
}

/// A spline from one point to another.
fn boundary(random: &mut Random, from: Point, to: Point, scale: f64, is_rational: bool) -> Spline {
    let degree = 1 + random.below(4);
    let width = degree + 1 + random.below(4);
    let mut knots = random_knots(random, degree, width);
    let (start, end) = (knots[degree], knots[width]);
    knots[..degree].fill(start);
    knots[width..].fill(end);
    let share = |i: usize| i as f64 / (width - 1) as f64;
    let mut control: Vec<Point> = (0..width)
        .map(|i| plus(plus(from, share(i), plus(to, -1.0, from)), 0.3 * scale, random.point()))
        .collect();
    (control[0], control[width - 1]) = (from, to);
    let weights = if is_rational { random_weights(random, width) } else { vec![1.0; width] };
    Spline { degree, knots, control, weights }
}

#[test]
fn a_coons_patch_is_its_formula_and_has_its_boundary() {
    let mut random = Random::new(1703);
    let mut n_rational = 0;
    for _ in 0..cases(150) {
        let scale = random.power(-6.0, 6.0);
        let away: Point = random.point_within(3.0 * scale);
        let corner = |i: usize, j: usize, random: &mut Random| {
            plus(plus(away, scale, [i as f64, j as f64, 0.0]), 0.2 * scale, random.point())
        };
        let k = [0, 1].map(|j| [0, 1].map(|i| corner(i, j, &mut random)));
        let is_rational = random.below(2) == 0;
        n_rational += usize::from(is_rational);
        let c = [0, 1].map(|j| boundary(&mut random, k[j][0], k[j][1], scale, is_rational));
        let d = [0, 1].map(|i| boundary(&mut random, k[0][i], k[1][i], scale, is_rational));
        let (cu, dv) = (c.each_ref().map(Spline::curve), d.each_ref().map(Spline::curve));
        let patch = NurbsSurface::coons([&cu[0], &cu[1]], [&dv[0], &dv[1]]).unwrap();
        let own = OWN * reach(&patch);
        assert!(patch.slack() < 1e-9 * reach(&patch), "{:e}", patch.slack());
        let domain = |k: usize| patch.knots()[k].domain();
        for round in 0..24 {
            let place = |random: &mut Random| match random.below(4) {
                0 => 0.0,
                1 => 1.0,
                _ => random.unit(),
            };
            // Boundary, corners and inside.
            let (s, t) = if round < 4 {
                (f64::from(round & 1), f64::from(round >> 1))
            } else {
                (place(&mut random), place(&mut random))
            };
            let on = |spline: &Spline, s: f64| {
                let (a, b) = (spline.knots[spline.degree], spline.knots[spline.control.len()]);
                spline.at(if s == 1.0 { b } else { (1.0 - s) * a + s * b })
            };
            let mut truth = [0.0; 3];
            for (by, p) in
                [(1.0 - t, on(&c[0], s)), (t, on(&c[1], s)), (1.0 - s, on(&d[0], t)), (s, on(&d[1], t))]
            {
                truth = plus(truth, by, p);
            }
            for (j, row) in k.iter().enumerate() {
                for (i, corner) in row.iter().enumerate() {
                    let by = [1.0 - s, s][i] * [1.0 - t, t][j];
                    truth = plus(truth, -by, *corner);
                }
            }
            let ([a, b], [e, f]) = (domain(0), domain(1));
            let end = |s: f64, a: f64, b: f64| if s == 1.0 { b } else { (1.0 - s) * a + s * b };
            let off = distance(at(&patch, end(s, a, b), end(t, e, f)), truth);
            assert!(off <= patch.slack() + own, "{off:e} {:e} at {s} {t}, {is_rational}", patch.slack());
        }
    }
    assert!(n_rational > 10);
}

#[test]
fn corners_that_do_not_meet_are_refused_with_the_gap() {
    let line = |a: Point, b: Point| NurbsCurve::line(a, b).unwrap();
    let c = [line([0.0; 3], [1.0, 0.0, 0.0]), line([0.0, 1.0, 0.0], [1.0, 1.0, 0.0])];
    for (corner, [from, to]) in [(0, [[0.0, 0.25, 0.0], [0.0, 1.0, 0.0]]), (2, [[0.0; 3], [0.0, 1.0, 0.25]])]
    {
        let d = [line(from, to), line([1.0, 0.0, 0.0], [1.0, 1.0, 0.0])];
        let error = NurbsSurface::coons([&c[0], &c[1]], [&d[0], &d[1]]).unwrap_err();
        assert_eq!(error, InvalidNurbs::Corner { corner, gap: 0.25, limit: 1e-9 });
    }
}

fn swept(profile: &NurbsCurve<3>, sweep: &SweepPath, length: f64) -> Bounded<NurbsSurface> {
    let length = Tolerance::new(length).unwrap();
    convert::curve_to_swept_surface(profile, sweep, length, &Job::default()).unwrap()
}

fn on_path(path: NurbsCurve<3>, up: Option<Point>) -> SweepPath {
    SweepPath { path, up, place: ProfilePlace::OnPath }
}

#[test]
fn a_circle_along_an_arc_is_a_torus_and_along_a_line_a_cylinder() {
    let mut random = Random::new(1704);
    for _ in 0..cases(60) {
        let scale = random.power(-6.0, 6.0);
        let [ring, tube] = [random.between(1.5, 4.0), random.between(0.1, 1.0)].map(|r| r * scale);
        let centre: Point = random.point_within(5.0 * scale);
        let axis: Point = random.direction();
        let a = unit(cross(axis, random.direction()));
        let b = cross(axis, a);
        let circle = NurbsCurve::circle([0.0; 3], [[tube, 0.0, 0.0], [0.0, tube, 0.0]]).unwrap();
        let axes = [a, b].map(|v| v.map(|x| x * ring));
        let sweep_rad = [TAU, random.between(0.3, 6.0), -random.between(0.3, 6.0)][random.below(3)];
        let path = NurbsCurve::arc(centre, axes, random.between(0.0, 6.0), sweep_rad).unwrap();
        let up: Point = random.direction();
        let torus = swept(&circle, &on_path(path.clone(), Some(up)), 1e-3 * scale);
        let size = 10.0 * scale;
        let at_most = torus.bound.at_most().unwrap();
        assert!(at_most < 1e-11 * size && torus.shape.slack() == at_most, "{at_most:e} {scale:e}");
        // Rational, with the knots of the path.
        assert_eq!(torus.shape.knots()[1], *path.knots());
        for _ in 0..40 {
            let [from, to] = path.knots().domain();
            let p = at(&torus.shape, random.unit(), random.between(from, to));
            let away = plus(p, -1.0, centre);
            let high = dot(away, axis);
            let out = plus(away, -high, axis);
            let off = ((dot(out, out).sqrt() - ring).hypot(high) - tube).abs();
            assert!(off <= at_most + 1e-14 * size, "{off:e} {at_most:e}");
        }
        let to = plus(centre, 3.0 * scale, random.direction());
        let along = unit(plus(to, -1.0, centre));
        let pipe = swept(&circle, &on_path(NurbsCurve::line(centre, to).unwrap(), None), 1e-3 * scale);
        let at_most = pipe.bound.at_most().unwrap();
        assert!(at_most < 1e-11 * size && pipe.shape.control().len() == 18);
        for _ in 0..20 {
            let away = plus(at(&pipe.shape, random.unit(), random.unit()), -1.0, centre);
            let out = plus(away, -dot(away, along), along);
            assert!((dot(out, out).sqrt() - tube).abs() <= at_most + 1e-14 * size);
        }
    }
}

/// First and second derivative of a polynomial or rational spline, by the splines of differences.
fn derivatives(spline: &Spline, t: f64) -> [Point; 3] {
    let weighted: Vec<[f64; 4]> =
        spline.control.iter().zip(&spline.weights).map(|(p, w)| [p[0] * w, p[1] * w, p[2] * w, *w]).collect();
    let (mut row, mut knots, mut degree) = (weighted, spline.knots.clone(), spline.degree);
    let mut found = Vec::new();
    for _ in 0..3 {
        let values = basis(&knots, degree, t);
        let mut sum = [0.0; 4];
        values.iter().zip(&row).for_each(|(b, x)| (0..4).for_each(|k| sum[k] += b * x[k]));
        found.push(sum);
        if degree == 0 {
            found.resize(3, [0.0; 4]);
            break;
        }
        row = (0..row.len() - 1)
            .map(|i| {
                let width = knots[i + degree + 1] - knots[i + 1];
                let by = if width > 0.0 { degree as f64 / width } else { 0.0 };
                std::array::from_fn(|k| by * (row[i + 1][k] - row[i][k]))
            })
            .collect();
        knots = knots[1..knots.len() - 1].to_vec();
        degree -= 1;
    }
    let [x, dx, ddx] = [found[0], found[1], found[2]];
    let point = |x: [f64; 4]| [x[0], x[1], x[2]];
    let p = point(x).map(|c| c / x[3]);
    let d = plus(point(dx), -dx[3], p).map(|c| c / x[3]);
    let dd = plus(plus(point(ddx), -2.0 * dx[3], d), -ddx[3], p).map(|c| c / x[3]);
    [p, d, dd]
}

/// The frame that does not rotate, densely: at so many equal steps of each piece of the path, with the length before.
fn dense_frames(spline: &Spline, up: Point, steps: usize) -> Vec<(f64, [Point; 3], f64)> {
    let mut ends = spline.knots[spline.degree..=spline.control.len()].to_vec();
    ends.dedup();
    let (mut r, mut length) = (up, 0.0);
    let mut made = Vec::new();
    for pair in ends.windows(2) {
        // Within a piece: both ends belong to it.
        let inside = |t: f64| t.clamp(pair[0], pair[1].next_down());
        let tangent = |t: f64| {
            let [_, d, dd] = derivatives(spline, inside(t));
            let speed = dot(d, d).sqrt();
            let along = unit(d);
            (along, plus(dd, -dot(dd, along), along).map(|x| x / speed), speed)
        };
        let slope = |t: f64, r: Point| {
            let (along, turn, speed) = tangent(t);
            (along.map(|x| -dot(r, turn) * x), speed)
        };
        let h = (pair[1] - pair[0]) / steps as f64;
        for k in 0..=steps {
            let t = pair[0] + h * k as f64;
            let along = tangent(t).0;
            r = unit(plus(r, -dot(r, along), along));
            made.push((inside(t), [cross(r, along), r, along], length));
            if k == steps {
                break;
            }
            let (k1, s1) = slope(t, r);
            let (k2, s2) = slope(t + 0.5 * h, plus(r, 0.5 * h, k1));
            let (k3, _) = slope(t + 0.5 * h, plus(r, 0.5 * h, k2));
            let (k4, s4) = slope(t + h, plus(r, h, k3));
            let sum = plus(plus(plus(k1, 2.0, k2), 2.0, k3), 1.0, k4);
            r = plus(r, h / 6.0, sum);
            length += h / 6.0 * (s1 + 4.0 * s2 + s4);
        }
    }
    made
}

fn of_curve(curve: &NurbsCurve<3>) -> Spline {
    Spline {
        degree: curve.knots().degree(),
        knots: curve.knots().knots().to_vec(),
        control: curve.control().to_vec(),
        weights: curve.weights().to_vec(),
    }
}

fn helix(scale: f64, turns: f64) -> NurbsCurve<3> {
    let point = |k: u32| {
        let angle = TAU * turns * f64::from(k) / 32.0;
        [2.0 * angle.cos(), 2.0 * angle.sin(), 0.3 * angle].map(|x| x * scale)
    };
    NurbsCurve::through(&(0..=32).map(point).collect::<Vec<_>>(), 4, Knots::Uniform).unwrap()
}

/// The surface against a profile in dense frames: the largest distance at equal parameters.
fn farthest(
    surface: &NurbsSurface,
    path: &Spline,
    profile: &Spline,
    frames: &[(f64, [Point; 3], f64)],
) -> f64 {
    let mut worst = 0.0;
    for (t, [side, up, ahead], _) in frames {
        for k in 0..=6 {
            let u = parameter(&profile.knots, profile.degree, f64::from(k) / 6.0);
            let [x, y, z] = profile.at(u);
            let truth = plus(plus(plus(path.at(*t), x, side.to_owned()), y, *up), z, *ahead);
            worst = f64::max(worst, distance(at(surface, u, *t), truth));
        }
    }
    worst
}

#[test]
fn a_sweep_along_a_space_curve_has_the_frame_that_does_not_rotate() {
    let mut random = Random::new(1705);
    let mut closest: f64 = 0.0;
    for round in 0..cases(8) {
        let scale = random.power(-6.0, 6.0);
        let path = if round % 2 == 0 {
            helix(scale, random.between(0.5, 2.0))
        } else {
            // Rational, and bent in space.
            let control =
                [[0.0, 0.0, 0.0], [2.0, 0.0, 0.5], [3.0, 2.0, 0.0], [2.0, 3.0, 2.0], [0.0, 4.0, 3.0]];
            let control = control.iter().map(|p| plus(*p, 0.3, random.point())).collect();
            let weights = (0..5).map(|_| random.between(0.7, 1.5)).collect();
            NurbsCurve::new(KnotVector::clamped(3, 5).unwrap(), scaled(control, scale), weights).unwrap()
        };
        let profile = Spline {
            degree: 2,
            knots: vec![0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0],
            control: scaled((0..4).map(|_| random.point()).collect(), 0.5 * scale),
            weights: random_weights(&mut random, 4),
        };
        let spline = of_curve(&path);
        let start = derivatives(&spline, path.knots().domain()[0])[1];
        let along = unit(start);
        let up: Point = random.direction();
        let across = unit(plus(up, -dot(up, along), along));
        // A helix has 29 pieces, the other path two.
        let steps = if round % 2 == 0 { 32 } else { 300 };
        let frames = dense_frames(&spline, across, steps);
        for tol in [1e-2, 1e-5, 1e-8] {
            let made = swept(&profile.curve(), &on_path(path.clone(), Some(up)), tol * scale);
            let at_most = made.bound.at_most().unwrap();
            assert!(at_most <= tol * scale && made.bound.evidence().as_str() == "proved");
            let off = farthest(&made.shape, &spline, &profile, &frames);
            // The dense frames are known to ten digits.
            assert!(off <= at_most + 2e-10 * scale, "{off:e} {at_most:e} {tol:e} {scale:e}");
            closest = closest.max(off / at_most);
        }
    }
    assert!(closest > 0.02, "a bound that is never near: {closest}");
}

#[test]
fn a_closed_path_gets_a_closed_surface_whose_twist_is_spread_over_its_length() {
    let knot: Vec<Point> = (0..24)
        .map(|k| TAU * f64::from(k) / 24.0)
        .map(|a| [a.sin() + 2.0 * (2.0 * a).sin(), a.cos() - 2.0 * (2.0 * a).cos(), -(3.0 * a).sin()])
        .collect();
    let path = NurbsCurve::from_path(&spline::periodic(&knot).unwrap()).unwrap();
    let profile = NurbsCurve::circle([0.0; 3], [[0.4, 0.0, 0.0], [0.0, 0.2, 0.0]]).unwrap();
    let spline = of_curve(&path);
    let along = unit(derivatives(&spline, 0.0)[1]);
    let across = unit(plus([0.0, 0.0, 1.0], -along[2], along));
    let mut frames = dense_frames(&spline, across, 60);
    let (last, total) = (frames[frames.len() - 1].1, frames[frames.len() - 1].2);
    let missing = f64::atan2(dot(cross(last[1], across), along), dot(last[1], across));
    assert!(missing.abs() > 0.1, "{missing}");
    for (_, [side, up, ahead], length) in &mut frames {
        let (sin, cos) = (missing * *length / total).sin_cos();
        let turned = plus(up.map(|x| cos * x), sin, cross(*ahead, *up));
        (*side, *up) = (cross(turned, *ahead), turned);
    }
    for tol in [1e-2, 1e-4, 1e-7] {
        let made = swept(&profile, &on_path(path.clone(), None), tol);
        let [from, to] = made.shape.knots()[1].domain();
        assert_eq!(made.shape.at(0.3, from), made.shape.at(0.3, to));
        let at_most = made.bound.at_most().unwrap();
        let off = farthest(&made.shape, &spline, &of_curve(&profile), &frames);
        assert!(off <= at_most + 1e-9, "{off:e} {at_most:e}");
    }
}

#[test]
fn a_profile_in_space_stays_where_it_is_at_the_start() {
    let path = helix(1.0, 1.0);
    let profile =
        NurbsCurve::bezier(vec![[2.5, 0.1, 0.0], [2.2, 0.0, 0.6], [1.5, -0.1, 0.2], [1.4, 0.3, -0.3]])
            .unwrap();
    let sweep = SweepPath { path: path.clone(), up: None, place: ProfilePlace::InSpace };
    let made = swept(&profile, &sweep, 1e-6);
    for k in 0..=8 {
        let u = f64::from(k) / 8.0;
        assert!(distance(made.shape.at(u, 0.0), profile.at(u)) < 1e-14);
    }
}

#[test]
fn paths_that_cannot_be_swept_along_are_one_sentence() {
    let profile = NurbsCurve::circle([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    let refused = |sweep: &SweepPath| {
        let length = Tolerance::new(1e-3).unwrap();
        match convert::curve_to_swept_surface(&profile, sweep, length, &Job::default()) {
            Err(Failure::Refused(refusal)) => refusal.message.to_string(),
            other => panic!("{other:?}"),
        }
    };
    let corner = vec![[0.0; 3], [3.0, 0.0, 0.0], [3.0, 3.0, 0.0]];
    let corner = NurbsCurve::new(KnotVector::clamped(1, 3).unwrap(), corner, vec![1.0; 3]).unwrap();
    assert_eq!(
        refused(&on_path(corner, None)),
        "the path has a kink of 90.000° at its parameter 1: split it there, or round it"
    );
    let line = NurbsCurve::line([0.0; 3], [0.0, 0.0, 5.0]).unwrap();
    assert_eq!(
        refused(&on_path(line, Some([0.0, 0.0, 2.0]))),
        "the up vector [0.0, 0.0, 2.0] is along the path where it starts, and must lie across it"
    );
    let cusp = NurbsCurve::bezier(vec![[0.0; 3], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]]).unwrap();
    let says = refused(&on_path(cusp, None));
    assert!(says.starts_with("the path stops, or turns at once, in the piece that starts"), "{says}");
    let point = NurbsCurve::line([1.0; 3], [1.0; 3]).unwrap();
    assert!(refused(&on_path(point, None)).starts_with("the path has no length"));
}
