//! Ranges hold every value, and ranges of gradients every gradient and every difference quotient.
use super::models::RandomFields;
use chordal::implicit::Expr;
use chordal::implicit::evaluation::{Binary, Dual, Tape, Term, Unary};
use chordal::math::{Box3, Interval};
use chordal_testkit::Random;
use dashu_float::FBig;

/// So many points are tried in each box.
const POINTS: usize = 128;

/// Operands where functions turn, jump or end, and of all sizes.
fn operand(random: &mut Random) -> (f64, f64) {
    let quarter = std::f64::consts::FRAC_PI_2 * (random.below(40) as f64 - 20.0);
    let centre = match random.below(10) {
        0 => quarter,
        1 => random.below(9) as f64 - 4.0,
        2 => random.below(9) as f64 - 4.5,
        3 | 4 => random.number(),
        5 => 1000.0 * (random.unit() - 0.5),
        6 => 3e5 * (random.unit() - 0.5),
        7 => 2.0 * random.unit() - 1.0,
        _ => 8.0 * random.unit() - 4.0,
    };
    let width = [0.0, 1e-15, 1e-9, 0.01, 0.7, 2.0, 9.0][random.below(7)] * random.unit();
    let low = centre - [0.0, 0.5, 1.0][random.below(3)] * width;
    (low, low + width)
}

/// Whether `range` says the truth of a point with this value.
fn tells(range: Interval, value: f64) -> bool {
    if value.is_nan() {
        !range.is_defined()
    } else if value.is_infinite() {
        range.lo() == value || range.hi() == value || !range.is_defined()
    } else {
        range.contains(value)
    }
}

/// Tries `n` boxes of an expression; the number of points that were tried.
fn try_boxes(random: &mut Random, expr: &Expr, n: usize, bounds: fn(&mut Random) -> Box3) -> usize {
    let tape = Tape::new(expr);
    let boxes: Vec<Box3> = (0..n).map(|_| bounds(random)).collect();
    let mut ranges = vec![Interval::UNKNOWN; n];
    tape.over(&boxes, &mut ranges).unwrap();
    let points: Vec<[f64; 3]> =
        boxes.iter().flat_map(|b| (0..POINTS).map(|_| random.within(b)).collect::<Vec<_>>()).collect();
    let mut values = vec![0.0; points.len()];
    tape.at(&points, &mut values).unwrap();
    let n_operations = tape.graph().terms().iter().filter(|term| !matches!(term, Term::Axis(_))).count();
    for (k, value) in values.iter().enumerate() {
        let range = ranges[k / POINTS];
        // Where a part has no value, min, and, not may still have one, as a choice between numbers and NaN.
        if !range.is_defined() && n_operations > 1 {
            continue;
        }
        assert!(
            tells(range, *value),
            "{value:e} at {:?} is not in {range} over {:?} of {:?}",
            points[k],
            boxes[k / POINTS],
            tape.graph()
        );
    }
    values.len()
}

fn operands(random: &mut Random) -> Box3 {
    let sides = [0, 1, 2].map(|_| operand(random));
    Box3 { min: sides.map(|side| side.0), max: sides.map(|side| side.1) }
}

#[test]
fn every_operation_s_range_holds_its_values() {
    let seed = 21;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let [x, y, _] = Expr::axes();
    let mut tried = 0;
    for (op, _) in Unary::ALL {
        tried += try_boxes(&mut random, &Expr::unary(op, &x), 2600, operands);
    }
    for (op, _) in Binary::ALL {
        tried += try_boxes(&mut random, &Expr::binary(op, &x, &y), 2600, operands);
    }
    for _ in 0..160 {
        let size = 2 + random.below(12);
        let expr = random.expression(size);
        tried += try_boxes(&mut random, &expr, 40, Random::bounds);
    }
    assert!(tried >= 10_000_000, "{tried}");
}

#[test]
fn ranges_of_functions_hold_the_true_values_of_200_bits() {
    let mut random = Random::new(22);
    type Function = (Unary, fn(&FBig) -> FBig, fn(f64) -> bool);
    let functions: [Function; 8] = [
        (Unary::Sin, FBig::sin, |_| true),
        (Unary::Cos, FBig::cos, |_| true),
        (Unary::Tan, FBig::tan, |x| x != 0.0),
        (Unary::Asin, FBig::asin, |x| x.abs() <= 1.0),
        (Unary::Acos, FBig::acos, |x| x.abs() <= 1.0),
        (Unary::Atan, FBig::atan, |_| true),
        (Unary::Exp, FBig::exp, |x| x.abs() < 700.0),
        (Unary::Ln, FBig::ln, |x| x > 0.0),
    ];
    for (op, truth, has) in functions {
        let tape = Tape::new(&Expr::unary(op, &Expr::axes()[0]));
        for _ in 0..150 {
            let (low, high) = operand(&mut random);
            let bounds = Box3 { min: [low; 3], max: [high; 3] };
            let mut range = [Interval::UNKNOWN];
            tape.over(&[bounds], &mut range).unwrap();
            for x in [low, high, random.within(&bounds)[0]].into_iter().filter(|x| has(*x)) {
                let exact = truth(&FBig::try_from(x).unwrap().with_precision(200).value());
                let bound = |x: f64| -> FBig { FBig::try_from(x).unwrap() };
                let (lo, hi) = (range[0].lo(), range[0].hi());
                let holds = (lo == f64::NEG_INFINITY || bound(lo) <= exact)
                    && (hi == f64::INFINITY || exact <= bound(hi));
                assert!(holds, "{op:?}({x:e}) = {exact} is not in {}", range[0]);
            }
        }
    }
}

#[test]
fn ranges_are_tight_where_the_truth_is_known() {
    let pi = std::f64::consts::PI;
    let [x, y, _] = Expr::axes();
    let over = |expr: &Expr, x: [f64; 2], y: [f64; 2]| {
        let mut range = [Interval::UNKNOWN];
        Tape::new(expr).over(&[Box3 { min: [x[0], y[0], 0.0], max: [x[1], y[1], 0.0] }], &mut range).unwrap();
        range[0]
    };
    let unary = |op, x0: f64, x1: f64| over(&Expr::unary(op, &x), [x0, x1], [0.0; 2]);
    let near = |range: Interval, lo: f64, hi: f64| {
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-14 * (1.0 + b.abs());
        assert!(close(range.lo(), lo) && close(range.hi(), hi) && range.is_defined(), "{range} {lo} {hi}");
    };
    near(unary(Unary::Sin, 0.5, 1.0), 0.5_f64.sin(), 1.0_f64.sin());
    near(unary(Unary::Sin, 1.0, 2.0), 1.0_f64.sin(), 1.0);
    near(unary(Unary::Sin, 1.0, 5.0), -1.0, 1.0);
    near(unary(Unary::Cos, 3.0, 3.5), -1.0, 3.5_f64.cos());
    let (low, high) = (1e5 * pi + 0.3, 1e5 * pi + 0.4);
    near(unary(Unary::Cos, low, high), high.cos(), low.cos());
    near(unary(Unary::Sin, 0.0, 0.0), 0.0, 0.0);
    near(unary(Unary::Tan, -1.0, 1.5), -(1.0_f64.tan()), 1.5_f64.tan());
    near(unary(Unary::Exp, -1.0, 2.0), (-1.0_f64).exp(), 2.0_f64.exp());
    near(unary(Unary::Acos, -1.0, 1.0), 0.0, pi);
    near(unary(Unary::Floor, 2.0, 2.9), 2.0, 2.0);
    near(over(&Expr::binary(Binary::Atan2, &y, &x), [-1.0, 1.0], [1.0, 2.0]), pi / 4.0, 0.75 * pi);
    near(over(&Expr::binary(Binary::Mod, &x, &y), [7.25, 7.5], [2.0, 2.0]), 1.25, 1.5);
    near(over(&Expr::binary(Binary::Mod, &x, &y), [-0.75, -0.5], [2.0, 2.0]), 1.25, 1.5);
    near(over(&Expr::binary(Binary::Mod, &x, &y), [7.25, 7.5], [-2.0, -2.0]), 1.25, 1.5);
}

/// The claims that gradients have to keep, on boxes of one expression; how many quotients were tried.
fn try_gradients(random: &mut Random, expr: &Expr) -> usize {
    let tape = Tape::new(expr);
    let boxes: Vec<Box3> = (0..30).map(|_| random.bounds()).collect();
    let mut slopes = vec![Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] }; boxes.len()];
    tape.gradient_over(&boxes, &mut slopes).unwrap();
    let mut tried = 0;
    for (bounds, range) in boxes.iter().zip(&slopes).filter(|(_, range)| range.value.is_defined()) {
        let points: Vec<[f64; 3]> = (0..12).map(|_| random.within(bounds)).collect();
        let mut found = vec![Dual { value: 0.0, gradient: [0.0; 3] }; points.len()];
        tape.gradient_at(&points, &mut found).unwrap();
        for (p, slope) in points.iter().zip(&found) {
            assert!(tells(range.value, slope.value));
            for k in 0..3 {
                // The f64 gradient is rounded at every step, so it may leave a range of a few last places.
                let (d, g) = (slope.gradient[k], range.gradient[k]);
                let slack = 1e-9 * (1.0 + g.magnitude());
                let inside = !d.is_finite() || (g.lo() - slack <= d && d <= g.hi() + slack);
                assert!(
                    inside,
                    "{d:e} along {k} at {p:?} is not in {g} over {bounds:?} of {:?}",
                    tape.graph()
                );
            }
        }
        // The mean value theorem: f(q) − f(p) is a product of the range with q − p.
        for pair in points.windows(2).zip(found.windows(2)) {
            let ([p, q], [at_p, at_q]) = (pair.0, pair.1) else { unreachable!("windows of two") };
            let mut change = Interval::point(0.0);
            for k in 0..3 {
                change = change + range.gradient[k] * (Interval::point(q[k]) - Interval::point(p[k]));
            }
            let difference = at_q.value - at_p.value;
            let slack = 1e-9 * (1.0 + at_q.value.abs() + at_p.value.abs());
            let inside = !difference.is_finite()
                || (change.lo() - slack <= difference && difference <= change.hi() + slack);
            assert!(inside, "{difference:e} is not in {change} from {p:?} to {q:?} of {:?}", tape.graph());
            tried += 1;
        }
    }
    tried
}

#[test]
fn ranges_of_gradients_hold_gradients_and_difference_quotients() {
    let seed = 23;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let [x, y, _] = Expr::axes();
    let mut tried = 0;
    for (op, _) in Unary::ALL {
        tried += try_gradients(&mut random, &Expr::unary(op, &(&x * &y)));
    }
    for (op, _) in Binary::ALL {
        for _ in 0..4 {
            tried += try_gradients(&mut random, &Expr::binary(op, &(&x + &y), &(&x - &y * 2.0)));
        }
    }
    for case in 0..500 {
        let expr = if case % 3 == 0 { random.solids(8) } else { random.expression(5) };
        tried += try_gradients(&mut random, &expr);
    }
    assert!(tried > 20_000, "{tried}");
}
