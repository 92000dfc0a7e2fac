//! Tests of the CSG tree of a field: which terms are expanded, which are one primitive, and that no value
//! changes.
use super::*;
use crate::budget::Job;
use crate::implicit::{Expr, Field, shapes};
use crate::math::Box3;
use chordal_testkit::Random;

/// The tree has the sign of the expression at random points.
fn agrees(field: &Field, half: f64) {
    let csg = Csg::from_expr(field.sign());
    let tape = Tape::new(field.sign());
    let domain = Box3 { min: [-half; 3], max: [half; 3] };
    let job = Job::default();
    let mut evaluator = PrimitiveEvaluator::new(&csg, &domain, &job);
    let mut random = Random::new(7);
    let points: Vec<[f64; 3]> = (0..500).map(|_| random.point_within(half)).collect();
    let mut expected = vec![0.0; points.len()];
    tape.at(&points, &mut expected).unwrap();
    let n = csg.primitives().len();
    let questions: Vec<_> = points.iter().flat_map(|p| (0..n as u32).map(|i| (i, *p))).collect();
    let values = evaluator.values(&questions).unwrap();
    for (k, expected) in expected.iter().enumerate() {
        let value = csg.tree().value(|p| values[k * n + p as usize]);
        assert_eq!(value < 0.0, *expected < 0.0, "{:?}", points[k]);
    }
}

#[test]
fn opens_boxes_and_cylinders_into_planes_and_sides() {
    let block = shapes::cuboid([2.0, 2.0, 1.0]).unwrap();
    let hole = shapes::cylinder(0.4, 2.0).unwrap();
    let drilled = block.difference(&hole);
    assert_eq!(Csg::from_expr(drilled.sign()).primitives().len(), 9);
    agrees(&drilled, 1.5);
}

#[test]
fn a_plane_from_both_sides_is_one_primitive() {
    let below = shapes::cuboid([2.0, 2.0, 2.0]).unwrap();
    let above = below.moved([0.0, 0.0, 2.0]).unwrap();
    let csg = Csg::from_expr(below.union(&above).sign());
    // The four sides are shared, the common face is one plane seen from both sides, and there are a floor and
    // a roof.
    assert_eq!(csg.primitives().len(), 7);
    let primitives = csg.primitives();
    let parallel = |a: usize, b: usize| primitives[a].is_parallel_to(&primitives[b]);
    assert!((0..7).any(|a| (0..7).any(|b| parallel(a, b))));
    assert!((0..7).all(|a| !parallel(a, a)));
}

#[test]
fn keeps_signs_through_scales_shells_and_differences() {
    let [x, y, z] = Expr::axes();
    let wave = Field::new(((&x * 3.0).sin() + (&y * 3.0).cos() - z * 2.0) * -0.25);
    let ball = shapes::sphere(1.0).unwrap();
    let shell = ball.shell(0.1).unwrap();
    agrees(&shell.union(&wave.intersection(&ball)), 1.3);
    agrees(&ball.scaled([-2.0, 1.0, 0.5]).unwrap().complement().xor(&shell), 2.0);
}

#[test]
fn the_two_sides_of_a_shell_are_parallel() {
    let csg = Csg::from_expr(shapes::sphere(1.0).unwrap().shell(0.125).unwrap().sign());
    let [a, b] = csg.primitives() else { panic!("two primitives") };
    assert!(a.is_parallel_to(b));
}

#[test]
fn levels_that_were_rounded_are_parallel_where_they_are_clearly_apart() {
    let parallel = |thickness: f64| {
        let csg = Csg::from_expr(shapes::sphere(1.0).unwrap().shell(thickness).unwrap().sign());
        let [a, b] = csg.primitives() else { panic!("two primitives") };
        a.is_parallel_to(b)
    };
    // 1 + 0.00025 is rounded.
    assert!(parallel(0.0005) && parallel(1e-9) && !parallel(1e-13));
}

#[test]
fn levels_that_differ_by_rounding_alone_are_one() {
    let n_primitives = |below: f64, above: f64| {
        let part = |height: f64| shapes::cuboid([1.0, 1.0, height]).unwrap();
        let lid = part(2.0 * above).moved([0.0, 0.0, below + above]).unwrap();
        Csg::from_expr(part(2.0 * below).union(&lid).sign()).primitives().len()
    };
    // In floating point 0.3 + 0.1 − 0.1 is more than 0.3; the common face is one plane, of seven in all.
    assert_eq!(n_primitives(0.3, 0.1), 7);
    // In decimal numbers all of them meet.
    let heights = || (1..40).map(|k| f64::from(k) / 10.0);
    let meets = |below: f64| heights().all(|above| n_primitives(below, above) == 7);
    assert!(heights().all(meets));
    let weld = |above: f64| {
        let lid = shapes::cuboid([1.0, 1.0, 0.2]).unwrap().moved([0.0, 0.0, above]).unwrap();
        Csg::from_expr(shapes::cuboid([1.0, 1.0, 0.6]).unwrap().union(&lid).sign()).weld()
    };
    assert!(weld(0.4) > 0.0 && weld(0.4) < 1e-11 && weld(0.75) == 0.0);
    // The zero sets of x² - 1 + 1 and x² - 1e-15 are 3e-8 apart.
    let square = Expr::axes()[0].square();
    let near = (&(&square - 1.0) + 1.0).max(&(&square - 1e-15));
    assert_eq!(Csg::from_expr(&near).primitives().len(), 2);
    // A millionth of a millionth is a gap.
    let gap = shapes::cuboid([1.0, 1.0, 0.2]).unwrap().moved([0.0, 0.0, 0.4 + 1e-12]).unwrap();
    assert_eq!(
        Csg::from_expr(shapes::cuboid([1.0, 1.0, 0.6]).unwrap().union(&gap).sign()).primitives().len(),
        8
    );
}

#[test]
fn planes_that_were_turned_are_one_up_to_rounding() {
    let axis = [1.0, 2.0, 2.0];
    let turned = |field: &Field| field.rotated_deg(axis, 30.0).unwrap();
    let below = turned(&shapes::cuboid([1.0, 1.0, 0.6]).unwrap());
    let lid = |height: f64| shapes::cuboid([1.0, 1.0, 0.2]).unwrap().moved([0.0, 0.0, height]).unwrap();
    let csg = |lid: &Field| Csg::from_expr(below.union(lid).sign());
    // Four sides, and three planes across.
    for height in (2..40).map(|k| f64::from(k) / 10.0) {
        let below = turned(&shapes::cuboid([1.0, 1.0, 2.0 * height - 0.2]).unwrap());
        let both = Csg::from_expr(below.union(&turned(&lid(height))).sign());
        assert_eq!(both.primitives().len(), 7, "{height}");
        assert!(both.weld() < 1e-10, "{height}: {:e}", both.weld());
    }
    // Moved after it was turned, along the normal that was z.
    let normal = normal_of_z(axis, 30.0);
    let beside = turned(&shapes::cuboid([1.0, 1.0, 0.2]).unwrap()).moved(normal.map(|x| 0.4 * x)).unwrap();
    assert_eq!(csg(&beside).primitives().len(), 7);
    assert!(csg(&beside).weld() > 0.0 && csg(&beside).weld() < 1e-10);
    // A millionth of a millionth is a gap.
    assert_eq!(csg(&turned(&lid(0.4 + 1e-12))).primitives().len(), 8);
    // Planes across other directions are others.
    let other = shapes::cuboid([1.0, 1.0, 0.2]).unwrap().rotated_deg(axis, 30.1).unwrap();
    assert_eq!(csg(&other).primitives().len(), 12);
}

/// Where a rotation takes the z axis (Rodrigues).
fn normal_of_z(axis: [f64; 3], angle_deg: f64) -> [f64; 3] {
    let size = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let n = axis.map(|x| x / size);
    let (sin, cos) = (libm::sin(angle_deg.to_radians()), libm::cos(angle_deg.to_radians()));
    let across = [n[1], -n[0], 0.0];
    std::array::from_fn(|k| {
        let z = if k == 2 { 1.0 } else { 0.0 };
        cos * z + sin * across[k] + (1.0 - cos) * n[2] * n[k]
    })
}

#[test]
fn levels_that_underflow_are_not_one() {
    let t = &Expr::axes()[0] * &(&Expr::axes()[1] * 0.0).cos();
    let primitives = |scale: f64| {
        let moved = &(&t + 1e-300) * scale;
        Csg::from_expr(&t.max(&-&moved)).primitives().len()
    };
    // 2 to the power of −20, and of −1000.
    assert_eq!([2.0_f64.powi(-20), 2.0_f64.powi(-1000)].map(primitives), [2, 2]);
    let same = |scale: f64| Csg::from_expr(&t.max(&(&t * -scale))).primitives().len();
    assert_eq!(same(2.0_f64.powi(-1000)), 1);
}

#[test]
fn regions_change_no_value_and_hold_every_value() {
    let mut chain = shapes::sphere(0.3).unwrap();
    for k in 0..24 {
        let at = [0.1 * f64::from(k) - 1.2, 0.3 * f64::from(k % 5) - 0.6, 0.2 * f64::from(k % 3)];
        let ball = shapes::sphere(0.2).unwrap().moved(at).unwrap();
        chain = chain.smooth_union(&ball, 0.1).unwrap();
    }
    let csg = Csg::from_expr(chain.sign());
    let domain = Box3 { min: [-1.5; 3], max: [1.5; 3] };
    let job = Job::default();
    let mut evaluator = PrimitiveEvaluator::new(&csg, &domain, &job);
    let mut random = Random::new(3);
    let points: Vec<[f64; 3]> = (0..4000).map(|_| [0; 3].map(|_| 0.4 * random.unit() - 1.4)).collect();
    let number = csg.primitives().iter().position(|p| p.tape().len() >= 100).expect("the chain of blends");
    let questions: Vec<(u32, [f64; 3])> = points.iter().map(|p| (number as u32, *p)).collect();
    let values = evaluator.values(&questions).unwrap();
    assert!(evaluator.regions[number].len() > 8, "regions were made");
    let shortest = evaluator.regions[number].iter().map(|region| region.tape.len()).min().unwrap();
    assert!(2 * shortest < evaluator.regions[number][0].tape.len(), "and they are shorter");
    let mut expected = vec![0.0; points.len()];
    csg.primitives()[number].tape().at(&points, &mut expected).unwrap();
    assert_eq!(values, expected);
    let boxes: Vec<(u32, Box3)> = points
        .iter()
        .map(|p| (number as u32, Box3 { min: p.map(|x| x - 0.01), max: p.map(|x| x + 0.01) }))
        .collect();
    for (range, value) in evaluator.dual_ranges(&boxes).unwrap().iter().zip(&values) {
        assert!(range.value[0] <= *value && *value <= range.value[1] && range.gradient.is_some());
    }
}

#[test]
fn a_term_that_may_be_undefined_is_not_total() {
    let [x, y, _] = Expr::axes();
    let total = |e: &Expr| Csg::from_expr(e).primitives().iter().all(Primitive::is_total);
    assert!(total(&(x.square() + y.square()).sqrt()));
    assert!(total(&Expr::unary(Unary::Round, &x)));
    assert!(!total(&x.sqrt()));
    assert!(!total(&(&x / &y)));
}

#[test]
fn round_solids_are_convex_however_they_are_written() {
    let [x, y, z] = Expr::axes();
    let norm = (x.square() + &y * &y + z.square()).sqrt();
    let convex = [
        &norm - 1.0,
        (&norm - 1.0) / 3.0,
        (&x.abs() - 1.0).max(&Expr::constant(0.0)).square() + y.square() - 0.25,
        ((x.abs() - 1.0).max(&Expr::constant(0.0)).square() + (z.square() * 2.0 + 1.0)).sqrt(),
        (x.square() + y.square()).sqrt() * 0.8 + &z * 0.6 - 2.0,
        Expr::unary(Unary::Exp, &(&x - &y)),
    ];
    let curvature = |e: &Expr| Curvature::from_terms(Tape::new(e).graph().terms());
    for expr in &convex {
        assert_eq!((curvature(expr), curvature(&-expr)), (Curvature::Convex, Curvature::Concave));
        assert_eq!(curvature(&(expr * -2.0)), Curvature::Concave);
        assert_eq!(curvature(&(expr - expr)), Curvature::Unknown);
    }
    assert_eq!(curvature(&(&x * 2.0 - &y / 3.0 + 1.0)), Curvature::Linear);
    // A ring, a saddle, the square of a term that is negative somewhere, and terms that are undefined
    // somewhere.
    let ring = (((x.square() + y.square()).sqrt() - 2.0).square() + z.square()).sqrt() - 1.0;
    let others = [ring, &x * &y, (&norm - 1.0).square(), x.sqrt(), x.min(&y).max(&z), x.sqrt().abs()];
    for expr in &others {
        assert_eq!(curvature(expr), Curvature::Unknown);
    }
    let solids = [
        shapes::sphere(1.0),
        shapes::cylinder(1.0, 2.0),
        shapes::capped_cone(2.0, 1.0, 3.0),
        shapes::capped_cone(0.0, 1.0, 3.0),
        shapes::capsule([0.0, 1.0, 2.0], [3.0, -1.0, 0.5], 0.5),
        shapes::capsule([0.0, 1.0, 2.0], [3.0, 1.0, 2.0], 0.5),
        shapes::capsule([1.0; 3], [1.0; 3], 0.5),
        shapes::rounded_cuboid([4.0, 5.0, 6.0], 0.5),
        shapes::rounded_rectangle([4.0, 5.0], 0.5),
        shapes::segment([1.0, 2.0], [5.0, 3.0], 0.5),
    ]
    .map(Result::unwrap);
    for solid in &solids {
        for primitive in Csg::from_expr(solid.sign()).primitives() {
            assert!(primitive.curvature().is_convex(), "{:?}", primitive.tape().graph());
        }
    }
}

/// Chosen: above the roundings of eighth powers that cancel.
const NEAR: f64 = 1e-6;

#[test]
fn curvature_holds_between_any_two_points() {
    let mut random = Random::new(11);
    let mut n_known = 0;
    for _ in 0..2000 {
        let expr = composed(&mut random, 3);
        let tape = Tape::new(&expr);
        let curvature = Curvature::from_terms(tape.graph().terms());
        if curvature == Curvature::Unknown {
            continue;
        }
        n_known += 1;
        for _ in 0..8 {
            let (a, b) = (random.point_within(3.0), random.point_within(3.0));
            let middle = std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k]);
            let mut values = [0.0; 3];
            tape.at(&[a, b, middle], &mut values).unwrap();
            let size = values.iter().fold(1.0, |most: f64, x| greater(x.abs(), most));
            let above = (values[2] - (0.5 * values[0] + 0.5 * values[1])) / size;
            assert!(!curvature.is_convex() || above <= NEAR, "{above}: {:?}", tape.graph());
            assert!(!curvature.is_concave() || above >= -NEAR, "{above}: {:?}", tape.graph());
        }
    }
    assert!(n_known > 500, "{n_known}");
}

/// A random expression of some depth.
fn composed(random: &mut Random, depth: u32) -> Expr {
    let pick = random.below(if depth == 0 { 4 } else { 14 });
    if pick < 3 {
        return Expr::axes()[pick].clone();
    }
    if pick == 3 {
        return Expr::constant(random.between(-2.0, 2.0));
    }
    let a = composed(random, depth - 1);
    match pick {
        4 => -a,
        5 => a.abs(),
        6 | 7 => a.square(),
        8 => a.sqrt(),
        9 => a * random.between(-2.0, 2.0),
        10 => a / 0.5,
        _ => {
            let b = composed(random, depth - 1);
            match pick {
                11 => a + b,
                12 => a.max(&b),
                _ => a.min(&(b - 0.5)),
            }
        }
    }
}

#[test]
fn a_tree_that_doubles_stays_small() {
    let [x, y, _] = Expr::axes();
    let mut expr = x.min(&y);
    for k in 0..60 {
        expr = (&expr + f64::from(k)).min(&(&expr * 2.0));
    }
    let csg = Csg::from_expr(&expr);
    assert_eq!(csg.primitives().len(), 1);
}

/// Chosen: some tens of roundings of values about 1.
const ROOM: f64 = 64.0 * f64::EPSILON;

/// Checks pairs of points in random boxes, many with a coordinate 0: values differ by what the interval of
/// gradients allows.
fn obeys_mean_value_theorem(expr: &Expr, random: &mut Random) {
    let tape = Tape::new(expr);
    for _ in 0..400 {
        let mut pick = || {
            let at = random.signed();
            if random.unit() < 0.3 { 0.0 } else { at }
        };
        let (from, size): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|_| pick()), std::array::from_fn(|_| pick().abs()));
        let bounds = Box3 { min: from, max: std::array::from_fn(|k| from[k] + size[k]) };
        let unknown = crate::math::Interval::UNKNOWN;
        let mut range = [crate::implicit::Dual { value: unknown, gradient: [unknown; 3] }];
        tape.gradient_over(&[bounds], &mut range).unwrap();
        assert!(range[0].value.is_defined());
        let points: Vec<[f64; 3]> = (0..16)
            .map(|_| {
                std::array::from_fn(|k| from[k] + size[k] * (random.unit() * 1.5 - 0.25).clamp(0.0, 1.0))
            })
            .collect();
        let mut values = vec![0.0; points.len()];
        tape.at(&points, &mut values).unwrap();
        for (p, f) in points.iter().zip(&values) {
            assert!(range[0].value.contains(*f));
            for (q, g) in points.iter().zip(&values) {
                let ends = (0..3).fold([0.0, 0.0], |[low, high], k| {
                    let [a, b] = [
                        range[0].gradient[k].lo() * (q[k] - p[k]),
                        range[0].gradient[k].hi() * (q[k] - p[k]),
                    ];
                    [low + a.min(b), high + a.max(b)]
                });
                let slack = ROOM;
                assert!(ends[0] - slack <= g - f && g - f <= ends[1] + slack, "{p:?} {q:?} in {bounds:?}");
            }
        }
    }
}

fn box_distance(sides: &[Expr]) -> Expr {
    let zero = Expr::constant(0.0);
    let outside = sides.iter().map(|side| side.max(&zero).square()).reduce(|a, b| a + b).unwrap();
    let inside = sides.iter().cloned().reduce(|a, b| a.max(&b)).unwrap();
    outside.sqrt() + inside.min(&zero)
}

#[test]
fn lengths_and_distances_from_boxes_have_ranges_of_slopes_at_their_tips() {
    let [x, y, z] = Expr::axes();
    let length = |parts: &[&Expr]| parts.iter().map(|p| p.square()).reduce(|a, b| a + b).unwrap().sqrt();
    let mut random = Random::new(5);
    let skew = &x * 0.5 + &y * 2.0 - &z;
    for expr in [
        length(&[&x, &y]),
        length(&[&x, &y, &z]),
        length(&[&skew, &z, &skew]),
        length(&[&x.max(&y), &z.abs()]),
        box_distance(&[x.abs() - 0.5, y.abs() - 0.25]),
        box_distance(&[x.abs() - 0.5, y.abs() - 0.25, z.abs()]),
        box_distance(&[&skew - 0.25, y.clone(), &x * &z]),
        box_distance(&[x.clone(), x.clone() * -1.0]),
    ] {
        obeys_mean_value_theorem(&expr, &mut random);
    }
}

#[test]
fn ranges_of_slopes_are_tight_where_coordinates_have_one_sign() {
    let [x, y, z] = Expr::axes();
    let over = |expr: &Expr, bounds: Box3| {
        let unknown = crate::math::Interval::UNKNOWN;
        let mut range = [crate::implicit::Dual { value: unknown, gradient: [unknown; 3] }];
        Tape::new(expr).gradient_over(&[bounds], &mut range).unwrap();
        range[0].gradient
    };
    // Beside a face of a box only its plane counts, also where that is 0.
    let sides = box_distance(&[x.abs() - 4.0, y.abs() - 4.0, z.clone()]);
    let across = over(&sides, Box3 { min: [-1.0, -1.0, -0.1], max: [1.0, 1.0, 0.1] });
    assert!(across[0].magnitude() == 0.0 && across[1].magnitude() == 0.0, "{across:?}");
    assert!(across[2].lo() > 1.0 - ROOM && across[2].hi() < 1.0 + ROOM, "{across:?}");
    // A quarter of a circle around the axis, far from it: sines and cosines of the angles; at the axis, all
    // values of them.
    let ring = (x.square() + y.square()).sqrt();
    let far = over(&ring, Box3 { min: [3.0, 4.0, 0.0], max: [3.0, 4.0, 1.0] });
    assert!((far[0].lo() - 0.6).abs() < ROOM && (far[1].hi() - 0.8).abs() < ROOM, "{far:?}");
    let tip = over(&ring, Box3 { min: [0.0, -1.0, 0.0], max: [1.0, 1.0, 1.0] });
    let is_near = |a: f64, b: f64| (a - b).abs() < ROOM;
    assert!(is_near(tip[0].lo(), 0.0) && is_near(tip[0].hi(), 1.0), "{tip:?}");
    assert!(is_near(tip[1].lo(), -1.0) && is_near(tip[1].hi(), 1.0), "{tip:?}");
}

#[test]
fn steps_are_looked_at_one_by_one() {
    let balls = shapes::sphere(0.25).unwrap().repeated([crate::implicit::Repeat::Every(1.0); 3]).unwrap();
    let [x, y, z] = Expr::axes();
    let cut = |v: &Expr, how: Unary| v - Expr::unary(how, v);
    let remainder = |v: &Expr| Expr::binary(Binary::Mod, v, &Expr::constant(0.3)) - 0.125;
    let sum = |parts: [Expr; 3]| parts[0].square() + parts[1].square() + parts[2].square() - 0.01;
    for sign in [
        balls.sign().clone(),
        sum([cut(&x, Unary::Floor), cut(&y, Unary::Ceil), cut(&z, Unary::Round)]),
        sum([remainder(&x), remainder(&y), z.clone()]),
    ] {
        let csg = Csg::from_expr(&sign);
        let domain = Box3 { min: [-2.0; 3], max: [2.0; 3] };
        let job = Job::default();
        let mut evaluator = PrimitiveEvaluator::new(&csg, &domain, &job);
        let mut random = Random::new(11);
        let mut tight = 0;
        for _ in 0..400 {
            let from: [f64; 3] = std::array::from_fn(|_| 2.0 * random.signed());
            let size = 0.2 * random.unit();
            let bounds = Box3 { min: from, max: from.map(|x| x + size) };
            let questions: Vec<(u32, Box3)> =
                (0..csg.primitives().len() as u32).map(|p| (p, bounds)).collect();
            let ranges = evaluator.dual_ranges(&questions).unwrap();
            let values = evaluator.ranges(&questions).unwrap();
            for ((p, _), (slopes, range)) in questions.iter().zip(ranges.iter().zip(&values)) {
                assert_eq!(slopes.value, *range);
                tight += usize::from(range[1] - range[0] < 3.0 * size);
                for _ in 0..8 {
                    let at: [f64; 3] = std::array::from_fn(|k| from[k] + size * random.unit());
                    let value = evaluator.values(&[(*p, at)]).unwrap()[0];
                    assert!(range[0] <= value && value <= range[1], "{at:?} in {bounds:?}");
                }
            }
        }
        assert!(tight > 0);
    }
    // A box without steps in it has a gradient; in a box with steps, the value is far from 0 on either side
    // of them.
    let csg = Csg::from_expr(balls.sign());
    let job = Job::default();
    let mut evaluator = PrimitiveEvaluator::new(&csg, &Box3 { min: [-2.0; 3], max: [2.0; 3] }, &job);
    let query = |from: [f64; 3]| vec![(0, Box3 { min: from, max: from.map(|x| x + 0.02) })];
    assert!(evaluator.dual_ranges(&query([0.2, 0.1, 0.0])).unwrap()[0].gradient.is_some());
    let on_step = evaluator.dual_ranges(&query([0.49, 0.1, 0.0])).unwrap()[0];
    assert!(on_step.gradient.is_none() && on_step.value[0] > 0.2);
}

#[test]
fn steps_beyond_what_integers_hold_are_one_range() {
    let [x, y, z] = Expr::axes();
    let sign = Expr::unary(Unary::Floor, &(x * 1e20)) - 1e19 + y.square() + z.square();
    let (csg, job) = (Csg::from_expr(&sign), Job::default());
    let bounds = Box3 { min: [0.5, 0.0, 0.0], max: [0.6, 0.1, 0.1] };
    let mut evaluator = PrimitiveEvaluator::new(&csg, &bounds, &job);
    let [low, high] = evaluator.ranges(&[(0, bounds)]).unwrap()[0];
    for at in [bounds.min, bounds.max, bounds.centre()] {
        let value = evaluator.values(&[(0, at)]).unwrap()[0];
        assert!(low <= value && value <= high, "{value} in {low} to {high}");
    }
}

#[test]
fn copies_without_end_are_listed_where_they_are_cut_off() {
    use crate::implicit::Repeat::{Every, Once};
    let bars = shapes::cuboid([0.1, 0.2, 3.0]).unwrap().repeated([Every(0.35), Every(0.35), Once]).unwrap();
    let ball = shapes::sphere(0.8).unwrap();
    for (field, half) in [
        (ball.difference(&bars), 1.0),
        (bars.intersection(&ball), 1.0),
        (ball.moved([7.0, -3.0, 0.0]).unwrap().difference(&bars), 9.0),
        (ball.difference(&bars.rotated_deg([1.0, 2.0, 3.0], 37.0).unwrap()), 1.0),
        (bars.scaled([1.5, -0.8, 1.0]).unwrap().moved([0.1, 0.2, 0.3]).unwrap().intersection(&ball), 1.0),
    ] {
        let has_steps = |term: &Term| matches!(term, Term::Unary(Unary::Round, _));
        assert!(!Tape::new(field.sign()).graph().terms().iter().any(has_steps));
        let (value, sign) = (Tape::new(field.expr()), Tape::new(field.sign()));
        let mut random = Random::new(3);
        let at: Vec<[f64; 3]> = (0..2000).map(|_| random.point_within(half)).collect();
        let (mut values, mut signs) = (vec![0.0; at.len()], vec![0.0; at.len()]);
        value.at(&at, &mut values).unwrap();
        sign.at(&at, &mut signs).unwrap();
        assert!(values.iter().zip(&signs).all(|(v, s)| (*v < 0.0) == (*s < 0.0)));
        assert!(half > 1.0 || values.iter().any(|v| *v < 0.0));
    }
}

#[test]
fn terms_that_differ_only_by_their_sign_are_one_primitive() {
    let [x, y, _] = Expr::axes();
    // Scales that are not powers of 2, so that levels are rounded.
    let rises = x.clone() * 8.13 - 0.7;
    let falls = Expr::constant(0.7) - x.clone() * 8.13;
    let scaled = (Expr::constant(0.7) - x.clone() * 8.13) * -0.3;
    let csg = Csg::from_expr(&rises.min(&falls.max(&y)));
    assert_eq!(csg.primitives().len(), 2);
    assert!(csg.tree().nodes().contains(&CsgNode::Complement(0)));
    assert_eq!(Csg::from_expr(&(rises.clone() * 0.3).min(&scaled)).primitives().len(), 1);
    // Another constant is another primitive.
    assert_eq!(Csg::from_expr(&rises.min(&(Expr::constant(0.8) - x.clone() * 8.13))).primitives().len(), 2);
    // Differences of two terms, in either order, below other operations.
    let [a, b] = [x.square() * 0.3, y.square() * 0.7];
    assert_eq!(Csg::from_expr(&(a.clone() - b.clone()).max(&(b.clone() - a.clone()))).primitives().len(), 1);
    let union = ((a.clone() - b.clone()) + 0.1).min(&(((b - a) - 0.1) * 0.6));
    assert_eq!(Csg::from_expr(&union).primitives().len(), 2);
    agrees(&Field::new(union), 1.0);
}
