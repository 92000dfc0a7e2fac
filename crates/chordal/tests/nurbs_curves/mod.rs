//! Splines of any degree: what leaves the curve as it is does, up to the rounding that is stated, at every scale.
mod double;

use crate::nurbs_referee::truth::{parameter, random_knots, random_points, random_weights};
use chordal::explicit::laws::CubicCurve;
use chordal::explicit::nurbs::{InvalidNurbs, KnotVector, NurbsCurve, compatible};
use chordal::explicit::parametric::AffineMap;
use chordal::explicit::spline::{self, Knots};
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment};
use chordal::{Tolerance, curve_laws};
use chordal_testkit::{Random, cases};
use double::{Dd, apart, apart_at};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

curve_laws!(spline_in_the_plane, CubicNurbs<2>, 2);
curve_laws!(spline_in_space, CubicNurbs<3>, 3);

/// A cubic Bézier curve as a spline.
struct CubicNurbs<const D: usize>(NurbsCurve<D>);

impl<const D: usize> CubicCurve<D> for CubicNurbs<D> {
    fn from_control(control: [[f64; D]; 4]) -> Self {
        Self(NurbsCurve::bezier(control.to_vec()).unwrap())
    }
    fn control(&self) -> [[f64; D]; 4] {
        self.0.control().try_into().unwrap()
    }
    fn at(&self, t: f64) -> [f64; D] {
        self.0.at(t)
    }
    fn by_de_casteljau(&self, t: f64) -> [f64; D] {
        if t > 0.0 && t < 1.0 { self.0.split(t).unwrap()[1].control()[0] } else { self.0.at(t) }
    }
    fn tangent(&self, t: f64) -> [f64; D] {
        self.0.derivatives(t, 1)[1]
    }
    fn split(&self, t: f64) -> [Self; 2] {
        let point = |i: usize| Self::from_control([self.control()[i]; 4]);
        match t {
            0.0 => [point(0), Self(self.0.clone())],
            1.0 => [Self(self.0.clone()), point(3)],
            _ => self.0.split(t).unwrap().map(|part| Self(part.with_domain(0.0, 1.0).unwrap())),
        }
    }
    fn blossom(&self, a: f64, b: f64, c: f64) -> [f64; D] {
        let mut arguments = [a, b, c];
        arguments.sort_by(f64::total_cmp);
        let inner: Vec<f64> = arguments.into_iter().filter(|t| *t > 0.0 && *t < 1.0).collect();
        let finer = self.0.with_knots(&inner).unwrap();
        let at = finer.knots().knots()[1..].windows(3).position(|knots| knots == arguments).unwrap();
        finer.control()[at]
    }
}

fn random_curve<const D: usize>(random: &mut Random) -> NurbsCurve<D> {
    let degree = 1 + random.below(6);
    let n = degree + 1 + random.below(8);
    let knots = KnotVector::new(degree, random_knots(random, degree, n)).unwrap();
    NurbsCurve::new(knots, random_points(random, n), random_weights(random, n)).unwrap()
}

/// A parameter inside of the domain that is no knot, as almost all are.
fn inside<const D: usize>(random: &mut Random, curve: &NurbsCurve<D>) -> f64 {
    let [from, to] = curve.knots().domain();
    loop {
        let t = parameter(curve.knots().knots(), curve.knots().degree(), random.unit());
        if from < t && t < to && curve.knots().multiplicity(t) == 0 {
            return t;
        }
    }
}

/// The largest distance at some parameters, in ε times the largest coordinate.
fn farthest<const D: usize>(random: &mut Random, a: &NurbsCurve<D>, b: &NurbsCurve<D>) -> f64 {
    (0..20).map(|_| apart(a, b, inside(random, b))).fold(0.0, f64::max)
}

#[test]
fn knots_change_nothing_beyond_16_roundings_each() {
    let mut random = Random::new(701);
    let mut worst: f64 = 0.0;
    for _ in 0..cases(300) {
        let curve = random_curve::<3>(&mut random);
        let (degree, t) = (curve.knots().degree(), inside(&mut random, &curve));
        let times = 1 + random.below(degree);
        let finer = curve.with_knot(t, times).unwrap();
        assert_eq!(finer.control().len(), curve.control().len() + times);
        assert_eq!(finer.knots().multiplicity(t), times);
        worst = worst.max(farthest(&mut random, &curve, &finer) / times as f64);
        // Many at once, and a few that are there already.
        let mut many: Vec<f64> = (0..10).map(|_| inside(&mut random, &curve)).collect();
        let [from, to] = curve.knots().domain();
        let again = curve.knots().knots().iter().filter(|t| from < **t && **t < to);
        many.extend(again.filter(|t| curve.knots().multiplicity(**t) < degree).take(1));
        let finer = curve.with_knots(&many).unwrap();
        worst = worst.max(farthest(&mut random, &curve, &finer) / many.len() as f64);
        let clamped = curve.clamped().unwrap();
        assert_eq!(clamped.knots().domain(), curve.knots().domain());
        let (knots, n) = (clamped.knots().knots(), clamped.control().len());
        assert!(knots[0] == knots[degree] && knots[n] == knots[n + degree]);
        let path = clamped.to_curve().unwrap();
        assert!(
            path.start() == clamped.control()[0] && path.end() == clamped.control()[n - 1]
                || path.is_closed()
        );
        worst = worst.max(farthest(&mut random, &curve, &clamped) / (2 * degree) as f64);
        assert_eq!(clamped.clamped().unwrap(), clamped);
    }
    // Measured: 1.2.
    assert!(worst < 16.0 && worst > 0.1, "{worst}");
}

#[test]
fn a_higher_degree_changes_nothing_beyond_its_roundings_and_keeps_the_smoothness() {
    let mut random = Random::new(702);
    let mut worst: f64 = 0.0;
    for _ in 0..cases(200) {
        let curve = random_curve::<2>(&mut random);
        let by = 1 + random.below(3);
        let higher = curve.elevated(by).unwrap();
        let (old, new) = (curve.clamped().unwrap(), higher.knots());
        assert_eq!((new.degree(), new.domain()), (curve.knots().degree() + by, curve.knots().domain()));
        assert!(
            old.knots().knots().iter().all(|t| new.multiplicity(*t) == old.knots().multiplicity(*t) + by)
        );
        let stated: usize = (0..by).map(|k| 20 * (curve.knots().degree() + k + 2)).sum();
        worst = worst.max(farthest(&mut random, &curve, &higher) / stated as f64);
    }
    // Measured: 0.02.
    assert!(worst < 1.0 && worst > 1e-3, "{worst}");
    let most = NurbsCurve::bezier(vec![[0.0, 0.0], [1.0, 3.0]]).unwrap().elevated(29).unwrap();
    assert!(most.control().iter().all(|[x, y]| (y - 3.0 * x).abs() < 1e-13));
    assert!(most.elevated(1).is_err() && most.elevated(usize::MAX).is_err());
}

#[test]
fn parts_meet_to_the_bit_and_are_parts() {
    let mut random = Random::new(703);
    let mut worst: f64 = 0.0;
    for _ in 0..cases(300) {
        let curve = random_curve::<3>(&mut random);
        let p = curve.knots().degree();
        let [from, to] = curve.knots().domain();
        // At a knot, too.
        let inner = curve.knots().knots().iter().copied().find(|t| from < *t && *t < to);
        for t in [Some(inside(&mut random, &curve)), inner].into_iter().flatten() {
            let parts = curve.split(t).unwrap();
            let [left, right] = &parts;
            assert_eq!([left.knots().domain(), right.knots().domain()], [[from, t], [t, to]]);
            assert_eq!(left.control().last(), right.control().first());
            assert_eq!(left.at(t).map(f64::to_bits), right.at(t).map(f64::to_bits));
            for part in &parts {
                worst = worst.max(farthest(&mut random, &curve, part) / p as f64);
            }
        }
        let mut ends = [inside(&mut random, &curve), inside(&mut random, &curve)];
        ends.sort_by(f64::total_cmp);
        if ends[0] < ends[1] {
            let part = curve.trimmed(ends[0], ends[1]).unwrap();
            assert_eq!(part.knots().domain(), ends);
            worst = worst.max(farthest(&mut random, &curve, &part) / (2 * p) as f64);
        }
        assert_eq!(curve.trimmed(from, to).unwrap(), curve);
        let back = curve.reversed();
        assert_eq!(back.reversed(), curve);
        let t = inside(&mut random, &curve);
        assert!(apart_at([&curve, &back], [Dd::new(t), Dd::new(-t)]) < 1e-10);
    }
    assert!(worst < 16.0, "{worst}");
}

#[test]
fn a_domain_is_moved_by_its_rounding_alone() {
    let mut random = Random::new(704);
    for _ in 0..cases(100) {
        let curve = random_curve::<2>(&mut random);
        let [a, b] = curve.knots().domain();
        let [from, to] = [-3.0, 7.0];
        let moved = curve.with_domain(from, to).unwrap();
        assert_eq!(moved.knots().domain(), [from, to]);
        assert_eq!((moved.control(), moved.weights()), (curve.control(), curve.weights()));
        let t = inside(&mut random, &curve);
        let there = from + (t - a) / (b - a) * (to - from);
        // The parameter is rounded here, too.
        let size = curve.control().as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let (p, q) = (curve.at(t), moved.at(there));
        assert!((0..2).all(|k| (p[k] - q[k]).abs() < 1e-11 * size), "{p:?} {q:?}");
    }
}

#[test]
fn maps_of_points_are_maps_of_the_curve() {
    let mut random = Random::new(705);
    for scale in [1e-6, 1.0, 1e6] {
        for _ in 0..cases(40) {
            let curve = random_curve::<3>(&mut random);
            let columns = [0, 1, 2].map(|_| random.point_within(scale));
            let map = AffineMap { columns, offset: random.point_within(scale) };
            let image = curve.transformed(&map).unwrap();
            let size = image.control().as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let reach = curve.control().as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let t = inside(&mut random, &curve);
            let (there, here) = (image.at(t), map.point(curve.at(t)));
            let limit = 1e-14 * (size + 3.0 * scale * reach + scale);
            assert!((0..3).all(|k| (there[k] - here[k]).abs() <= limit), "{there:?} {here:?}");
        }
    }
}

#[test]
fn what_was_inserted_goes_again_and_what_matters_stays() {
    let mut random = Random::new(706);
    for _ in 0..cases(150) {
        let curve = random_curve::<3>(&mut random).clamped().unwrap();
        let size = curve.control().as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let t = inside(&mut random, &curve);
        let finer = curve.with_knot(t, 1 + random.below(curve.knots().degree())).unwrap();
        let (again, moved) = finer.without_knot(t, Tolerance::new(1e-9 * size).unwrap()).unwrap();
        assert_eq!(again.knots().multiplicity(t) + 1, finer.knots().multiplicity(t));
        // Divisions by small shares lose digits; the bound says how many.
        for _ in 0..20 {
            let t = inside(&mut random, &finer);
            let off = apart(&finer, &again, t) * f64::EPSILON * size;
            assert!(off <= moved, "{off} {moved}");
        }
        // Any knot, with any loss: the bound holds.
        let (simpler, moved) = finer.without_spare_knots(Tolerance::new(0.3 * size).unwrap());
        assert!(moved <= 0.3 * size);
        for _ in 0..20 {
            let t = inside(&mut random, &finer);
            let off = apart(&finer, &simpler, t) * f64::EPSILON * size;
            assert!(off <= moved, "{off} {moved}");
        }
    }
    let corner = NurbsCurve::new(
        KnotVector::new(1, vec![0.0, 0.0, 1.0, 2.0, 2.0]).unwrap(),
        vec![[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]],
        vec![1.0; 3],
    )
    .unwrap();
    let refused = corner.without_knot(1.0, Tolerance::new(0.5).unwrap()).unwrap_err();
    let InvalidNurbs::Moved { by, limit } = refused else { panic!("{refused}") };
    assert!(limit == 0.5 && (1.0..1.0 + 1e-12).contains(&by));
    let (line, moved) = corner.without_knot(1.0, Tolerance::new(1.5).unwrap()).unwrap();
    assert_eq!((line.control(), moved == by), (&[[0.0, 0.0], [2.0, 0.0]][..], true));
    assert_eq!(corner.without_knot(0.5, Tolerance::new(1.0).unwrap()), Err(InvalidNurbs::NoKnot(0.5)));
}

#[test]
fn curves_made_compatible_are_the_same_curves() {
    let mut random = Random::new(707);
    for _ in 0..cases(60) {
        let curves: Vec<NurbsCurve<2>> = (0..3).map(|_| random_curve(&mut random)).collect();
        let fitted = compatible(&curves).unwrap();
        assert!(fitted.iter().all(|curve| curve.knots() == fitted[0].knots()));
        let [from, to] = curves[0].knots().domain();
        for (old, new) in curves.iter().zip(&fitted) {
            let [a, b] = old.knots().domain();
            let size = old.control().as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            for _ in 0..10 {
                let place = random.unit();
                let (p, q) = (old.at(a + place * (b - a)), new.at(from + place * (to - from)));
                assert!((0..2).all(|k| (p[k] - q[k]).abs() < 1e-11 * size), "{p:?} {q:?}");
            }
        }
    }
    assert!(compatible::<2>(&[]).unwrap().is_empty());
}

#[test]
fn a_moved_control_point_changes_four_spans_of_a_cubic_and_no_bit_of_the_others() {
    let mut random = Random::new(708);
    for moved in 0..15 {
        let knots = KnotVector::uniform(3, 15).unwrap();
        let control: Vec<[f64; 3]> = (0..15).map(|_| random.point()).collect();
        let weights: Vec<f64> = (0..15).map(|_| random.between(0.5, 2.0)).collect();
        let mut other = control.clone();
        other[moved][1] += 0.125;
        let [before, after] = [&control, &other]
            .map(|control| NurbsCurve::new(knots.clone(), control.clone(), weights.clone()).unwrap());
        let is_changed = |span: i32| {
            (0..=20).any(|k| {
                let t = f64::from(span) + f64::from(k) / 20.0;
                // The end of a span belongs to the next one.
                k < 20 && before.at(t).map(f64::to_bits) != after.at(t).map(f64::to_bits)
            })
        };
        let changed: Vec<i32> = (0..12).filter(|span| is_changed(*span)).collect();
        let expected: Vec<i32> =
            (0..12).filter(|span| (span - moved as i32).abs() <= 3 && *span <= moved as i32).collect();
        assert_eq!(changed, expected);
        assert!(changed.len() <= 4);
    }
}

#[test]
fn arcs_and_conics_lie_on_their_equations_at_any_scale() {
    let mut random = Random::new(709);
    for scale in [1e-6, 1.0, 1e6] {
        for _ in 0..cases(60) {
            let (start, sweep) = (random.between(-PI, PI), random.between(-TAU, TAU));
            let axes = [[2.0 * scale, 0.0], [0.0, scale]];
            let arc = NurbsCurve::arc([0.0; 2], axes, start, sweep).unwrap();
            assert_eq!(arc.knots().n_pieces(), (sweep.abs() / FRAC_PI_2).ceil() as usize);
            assert!(arc.weights().iter().all(|w| (0.7..=1.0).contains(w)));
            let [from, to] = arc.knots().domain();
            for k in 0..=50 {
                let [x, y] = arc.at(from + (to - from) * f64::from(k) / 50.0).map(|x| x / scale);
                assert!((0.25 * x * x + y * y - 1.0).abs() < 4e-15, "{x} {y}");
            }
            let end = start + sweep;
            for (t, angle) in [(from, start), (to, end)] {
                let [x, y] = arc.at(t).map(|x| x / scale);
                assert!((x - 2.0 * angle.cos()).abs() < 4e-15 && (y - angle.sin()).abs() < 4e-15);
            }
        }
        for (weight, equation) in [
            // Tangents at (1, 0) and (0, 1) that meet in (1, 1) and (0, 0).
            (1.0, [0.0, 0.0]),
            (3.0, [0.0, 0.0]),
            (0.2, [1.0, 1.0]),
        ] {
            let middle = equation.map(|x| x * scale);
            let points = [[scale, 0.0], middle, [0.0, scale]];
            let conic = NurbsCurve::conic(points, weight).unwrap();
            for k in 0..=20 {
                let [x, y] = conic.at(f64::from(k) / 20.0).map(|x| x / scale);
                // In barycentric coordinates of the three points: b² = 4w²·a·c.
                let whole = 1.0 - equation[0] - equation[1];
                let b = (1.0 - x - y) / whole;
                let [a, c] = [x - b * equation[0], y - b * equation[1]];
                assert!((b * b - 4.0 * weight * weight * a * c).abs() < 1e-14, "{a} {b} {c}");
            }
        }
    }
    for sweep in [TAU, -TAU] {
        let whole = NurbsCurve::arc([3.0, 1.0], [[0.3, 0.4], [-0.4, 0.3]], 1.234, sweep).unwrap();
        assert_eq!(whole.control().first(), whole.control().last());
        assert!(whole.to_curve().unwrap().is_closed());
    }
    let quarter = NurbsCurve::arc([0.0; 2], [[1.0, 0.0], [0.0, 1.0]], FRAC_PI_2, FRAC_PI_2).unwrap();
    assert_eq!((quarter.at(0.0), quarter.at(1.0)), ([0.0, 1.0], [-1.0, 0.0]));
}

#[test]
fn paths_become_splines_with_the_same_places() {
    let mut random = Random::new(710);
    for _ in 0..cases(60) {
        let size = random.power(-6.0, 6.0);
        let point = |random: &mut Random| -> [f64; 2] { random.point_within(size) };
        let mut at = point(&mut random);
        let pieces = (0..5).map(|_| {
            let start = at;
            let piece = match random.below(4) {
                0 => CurveSegment::Line([start, point(&mut random)]),
                1 => CurveSegment::quadratic([start, point(&mut random), point(&mut random)]),
                2 => {
                    let [u, v] = [point(&mut random), point(&mut random)];
                    let centre = [start[0] - u[0], start[1] - u[1]];
                    let sweep = random.between(-6.0, 6.0);
                    let arc = Arc::new(centre, [u, v], 0.0, sweep).unwrap();
                    let end = arc.ends()[1];
                    CurveSegment::Arc(arc.with_ends([start, end]))
                }
                _ => {
                    let control = vec![start, point(&mut random), point(&mut random), point(&mut random)];
                    let weights = vec![1.0, 3.0, 0.2, 5.0];
                    let knots = KnotVector::clamped(3, 4).unwrap();
                    let path = NurbsCurve::new(knots, control, weights).unwrap().to_curve().unwrap();
                    path.segments()[0].clone()
                }
            };
            at = piece.end();
            piece
        });
        let path = Curve::new(pieces.collect(), CurveEnds::Open).unwrap();
        let curve = NurbsCurve::from_path(&path).unwrap();
        assert_eq!(curve.knots().domain(), [0.0, 5.0]);
        let reach = curve.control().as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for k in 0..=50 {
            let s = f64::from(k) / 10.0;
            let is_arc = path.locate(s).is_some_and(|(piece, t)| {
                matches!(path.segments()[piece], CurveSegment::Arc(_)) && t > 0.0 && t < 1.0
            });
            let (p, q) = (path.at(s), curve.at(s));
            let off = (p[0] - q[0]).hypot(p[1] - q[1]);
            if is_arc {
                // At another place of the same arc.
                let near = path.closest_point(q, None).unwrap();
                assert!(near.at_least <= 1e-14 * reach, "{} {}", near.at_least, reach);
            } else {
                assert!(off <= 1e-14 * reach, "{off} {reach} at {s}");
            }
        }
    }
    // A C2 path needs its knots once only.
    let points: Vec<[f64; 2]> = (0..12).map(|_| random.point()).collect();
    let curve = NurbsCurve::from_path(&spline::natural(&points).unwrap()).unwrap();
    let (smooth, moved) = curve.without_spare_knots(Tolerance::new(1e-12).unwrap());
    assert!(smooth.control().len() == 14 && moved < 1e-12, "{} {moved}", smooth.control().len());
    let dot = Curve::point([1.0, 2.0]).unwrap();
    assert_eq!(NurbsCurve::try_from(&dot), Err(InvalidNurbs::SinglePoint));
}

#[test]
fn splines_through_points_go_through_them_with_any_degree() {
    let mut random = Random::new(711);
    for scale in [1e-6, 1.0, 1e6] {
        for knots in [Knots::Uniform, Knots::Centripetal, Knots::Chordal] {
            for degree in 1..=7 {
                let n = degree + 1 + random.below(30);
                let points: Vec<[f64; 3]> = (0..n).map(|_| random.point_within(scale)).collect();
                let curve = NurbsCurve::through(&points, degree, knots).unwrap();
                let reach = curve.control().as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                let widths = spline::widths(&points, knots, n - 1).unwrap();
                let mut t = 0.0;
                for (i, p) in points.iter().enumerate() {
                    let q = curve.at(t);
                    let off = (0..3).map(|k| (p[k] - q[k]).abs()).fold(0.0, f64::max);
                    assert!(off <= 1e-13 * reach, "{off} of {reach}: point {i} of {n}, degree {degree}");
                    t += widths.get(i).unwrap_or(&0.0);
                }
                assert!(curve.control()[0] == points[0] && curve.control()[n - 1] == points[n - 1]);
            }
        }
    }
    // A polynomial of the degree comes back.
    let cubic = |t: f64| [t, t * t * t - 3.0 * t];
    let points: Vec<[f64; 2]> = (0..9).map(|k| cubic(f64::from(k))).collect();
    let curve = NurbsCurve::through(&points, 3, Knots::Uniform).unwrap();
    for k in 0..=80 {
        let t = f64::from(k) / 10.0;
        let ([x, y], [u, v]) = (curve.at(t), cubic(t));
        assert!((x - u).abs() < 1e-12 && (y - v).abs() < 1e-10);
    }
}

#[test]
fn what_makes_no_spline_is_refused_in_a_sentence() {
    let arch = NurbsCurve::bezier(vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]).unwrap();
    let outside = |t: f64| InvalidNurbs::Outside { t, domain: [0.0, 1.0] };
    for t in [-0.5, 0.0, 1.0, 2.0, f64::INFINITY] {
        assert_eq!(arch.with_knot(t, 1), Err(outside(t)));
        assert_eq!(arch.split(t), Err(outside(t)));
    }
    assert!(arch.with_knot(f64::NAN, 1).is_err() && arch.split(f64::NAN).is_err());
    assert!(arch.trimmed(f64::NAN, 1.0).is_err() && arch.with_domain(f64::NAN, 1.0).is_err());
    assert_eq!(arch.with_knot(0.5, 4), Err(InvalidNurbs::Repeated { index: 4, degree: 3 }));
    assert!(arch.with_knot(0.5, usize::MAX).is_err() && arch.with_knot(0.5, 3).is_ok());
    assert_eq!(arch.trimmed(0.5, 0.5), Err(InvalidNurbs::Backwards { from: 0.5, to: 0.5 }));
    assert_eq!(arch.trimmed(0.5, 1.5), Err(outside(1.5)));
    assert_eq!(NurbsCurve::bezier(vec![[1.0, 2.0]]), Err(InvalidNurbs::TooFew { degree: 1, points: 1 }));
    assert_eq!(NurbsCurve::<2>::bezier(vec![]), Err(InvalidNurbs::TooFew { degree: 1, points: 0 }));
    assert_eq!(NurbsCurve::bezier(vec![[0.0]; 32]), Err(InvalidNurbs::Degree(31)));
    let nan = vec![[0.0, f64::NAN], [1.0, 0.0]];
    let not_finite = |what| InvalidNurbs::NotFinite { what, index: 0 };
    assert_eq!(NurbsCurve::bezier(nan.clone()), Err(not_finite("control point")));
    assert_eq!(NurbsCurve::through(&nan, 1, Knots::Chordal), Err(not_finite("point")));
    let twice = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
    assert_eq!(NurbsCurve::through(&twice, 3, Knots::Chordal), Err(InvalidNurbs::Coincident(1)));
    assert!(NurbsCurve::through(&twice, 3, Knots::Uniform).is_ok());
    assert_eq!(
        NurbsCurve::through(&twice, 4, Knots::Uniform),
        Err(InvalidNurbs::TooFew { degree: 4, points: 4 })
    );
    let axes = [[1.0, 0.0], [0.0, 1.0]];
    assert_eq!(NurbsCurve::arc([0.0; 2], axes, 0.0, 0.0), Err(InvalidNurbs::Sweep(0.0)));
    assert_eq!(NurbsCurve::arc([0.0; 2], axes, 0.0, 6.5), Err(InvalidNurbs::Sweep(6.5)));
    assert!(NurbsCurve::arc([0.0; 2], axes, f64::NAN, 1.0).is_err());
    assert_eq!(NurbsCurve::conic([[0.0], [1.0], [2.0]], -1.0), Err(InvalidNurbs::Weight(1)));
    assert!(KnotVector::uniform(0, 4).is_err() && KnotVector::uniform(3, 3).is_err());
    assert!(KnotVector::uniform(usize::MAX, 4).is_err());
    for error in [
        outside(2.0),
        InvalidNurbs::Backwards { from: 1.0, to: 0.0 },
        InvalidNurbs::NoKnot(0.5),
        InvalidNurbs::Moved { by: 1.0, limit: 0.5 },
        InvalidNurbs::Coincident(3),
        InvalidNurbs::SinglePoint,
        InvalidNurbs::Sweep(7.0),
        InvalidNurbs::Uneven(2),
    ] {
        let text = error.to_string();
        assert!(text.len() > 20 && !text.contains('\n') && !text.ends_with('.'), "{text}");
    }
}
