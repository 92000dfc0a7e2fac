//! The tree of a field's sign: what is opened, what is one primitive, and that no value changes.
use super::*;
use crate::budget::Job;
use crate::implicit::{Expr, Field, shapes};
use crate::math::Box3;

fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// The tree has the sign of the expression at random points.
fn agrees(field: &Field, half: f64) {
    let csg = Csg::of(field.sign());
    let tape = Tape::of(field.sign());
    let domain = Box3 { min: [-half; 3], max: [half; 3] };
    let job = Job::default();
    let mut evaluator = PrimitiveEvaluator::new(&csg, &domain, &job);
    let mut state = 7;
    let points: Vec<[f64; 3]> =
        (0..500).map(|_| [0; 3].map(|_| half * (2.0 * random(&mut state) - 1.0))).collect();
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
    assert_eq!(Csg::of(drilled.sign()).primitives().len(), 9);
    agrees(&drilled, 1.5);
}

#[test]
fn a_plane_from_both_sides_is_one_primitive() {
    let below = shapes::cuboid([2.0, 2.0, 2.0]).unwrap();
    let above = below.moved([0.0, 0.0, 2.0]).unwrap();
    let csg = Csg::of(below.union(&above).sign());
    // Four sides are shared, the common face is one plane seen from both sides, and there are a floor and a roof.
    assert_eq!(csg.primitives().len(), 7);
    let all = csg.primitives();
    let parallel = |a: usize, b: usize| all[a].is_parallel_to(&all[b]);
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
    let csg = Csg::of(shapes::sphere(1.0).unwrap().shell(0.125).unwrap().sign());
    let [a, b] = csg.primitives() else { panic!("two primitives") };
    assert!(a.is_parallel_to(b));
}

#[test]
fn levels_that_were_rounded_are_parallel_where_they_are_clearly_apart() {
    let parallel = |thickness: f64| {
        let csg = Csg::of(shapes::sphere(1.0).unwrap().shell(thickness).unwrap().sign());
        let [a, b] = csg.primitives() else { panic!("two primitives") };
        a.is_parallel_to(b)
    };
    // 1 + 0.00025 is rounded.
    assert!(parallel(0.0005) && parallel(1e-9) && !parallel(1e-16));
}

#[test]
fn regions_change_no_value_and_hold_every_value() {
    let mut whole = shapes::sphere(0.3).unwrap();
    for k in 0..24 {
        let at = [0.1 * f64::from(k) - 1.2, 0.3 * f64::from(k % 5) - 0.6, 0.2 * f64::from(k % 3)];
        let ball = shapes::sphere(0.2).unwrap().moved(at).unwrap();
        whole = whole.smooth_union(&ball, 0.1).unwrap();
    }
    let csg = Csg::of(whole.sign());
    let domain = Box3 { min: [-1.5; 3], max: [1.5; 3] };
    let job = Job::default();
    let mut evaluator = PrimitiveEvaluator::new(&csg, &domain, &job);
    let mut state = 3;
    let points: Vec<[f64; 3]> = (0..4000).map(|_| [0; 3].map(|_| 0.4 * random(&mut state) - 1.4)).collect();
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
    for (range, value) in evaluator.slope_ranges(&boxes).unwrap().iter().zip(&values) {
        assert!(range.value[0] <= *value && *value <= range.value[1] && range.gradient.is_some());
    }
}

#[test]
fn what_may_have_no_value_is_not_total() {
    let [x, y, _] = Expr::axes();
    let total = |e: &Expr| Csg::of(e).primitives().iter().all(Primitive::is_total);
    assert!(total(&(x.square() + y.square()).sqrt()));
    assert!(total(&Expr::unary(Unary::Round, &x)));
    assert!(!total(&x.sqrt()));
    assert!(!total(&(&x / &y)));
}

#[test]
fn a_tree_that_doubles_stays_small() {
    let [x, y, _] = Expr::axes();
    let mut whole = x.min(&y);
    for k in 0..60 {
        whole = (&whole + f64::from(k)).min(&(&whole * 2.0));
    }
    let csg = Csg::of(&whole);
    assert_eq!(csg.primitives().len(), 1);
}
