//! The tape has the plain evaluator's values bit for bit, on whatever instruction set it runs; gradients are
//! those of differences; a shortened tape has the same values in its region.
use super::models::RandomFields;
use chordal::implicit::evaluation::{Dual, ExprGraph, Tape};
use chordal::implicit::reference;
use chordal::math::{Box3, Interval};
use chordal_testkit::Random;

/// The bits of a number; NaN is NaN.
fn bits(x: f64) -> u64 {
    if x.is_nan() { u64::MAX } else { x.to_bits() }
}

fn parts(x: Interval) -> (u64, u64, bool) {
    (bits(x.lo()), bits(x.hi()), x.is_defined())
}

const NOWHERE: Dual<f64> = Dual { value: 0.0, gradient: [0.0; 3] };
const UNKNOWN: Dual<Interval> = Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] };

/// All five kinds of evaluation of an expression, against the plain ones. `CHORDAL_ISA` asks for an
/// instruction set.
fn compare(random: &mut Random, size: usize, rows: usize) {
    let expr = random.expression(size);
    let (graph, tape) = (ExprGraph::from_expr(&expr), Tape::new(&expr));
    let points: Vec<[f64; 3]> = (0..rows)
        .map(|k| if k % 7 == 0 { [0, 1, 2].map(|_| random.number()) } else { random.point_within(4.0) })
        .collect();
    let mut values = vec![0.0; rows];
    tape.at(&points, &mut values).unwrap();
    let expected = reference::at(&graph, &points).unwrap();
    assert!(values.iter().zip(&expected).all(|(a, b)| bits(*a) == bits(*b)), "{graph:?}");
    let columns = [0, 1, 2].map(|k| points.iter().map(|p| p[k]).collect::<Vec<f64>>());
    tape.at_columns(columns.each_ref().map(Vec::as_slice), &mut values).unwrap();
    assert!(values.iter().zip(&expected).all(|(a, b)| bits(*a) == bits(*b)), "{graph:?}");

    let short: Vec<[f32; 3]> = points.iter().map(|p| p.map(|c| c as f32)).collect();
    let mut values = vec![0.0; rows];
    tape.at_f32(&short, &mut values).unwrap();
    let expected = reference::at_f32(&graph, &short).unwrap();
    let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    assert!(values.iter().zip(&expected).all(|(a, b)| same(*a, *b)), "{graph:?}");

    let mut slopes = vec![NOWHERE; rows];
    tape.gradient_at(&points, &mut slopes).unwrap();
    let expected = reference::gradient_at(&graph, &points).unwrap();
    let same = |a: &Dual<f64>, b: &Dual<f64>| {
        bits(a.value) == bits(b.value) && a.gradient.map(bits) == b.gradient.map(bits)
    };
    assert!(slopes.iter().zip(&expected).all(|(a, b)| same(a, b)), "{graph:?}");

    let boxes: Vec<Box3> = points
        .iter()
        .map(|p| match random.below(9) {
            0 => Box3 { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] },
            1 => Box3::EMPTY,
            2 => Box3 { min: *p, max: *p },
            _ => random.bounds(),
        })
        .collect();
    let mut ranges = vec![Interval::UNKNOWN; rows];
    tape.over(&boxes, &mut ranges).unwrap();
    let expected = reference::over(&graph, &boxes).unwrap();
    for (k, (a, b)) in ranges.iter().zip(&expected).enumerate() {
        assert_eq!(parts(*a), parts(*b), "{a} {b} over {:?} of {graph:?}", boxes[k]);
    }

    let mut slopes = vec![UNKNOWN; rows];
    tape.gradient_over(&boxes, &mut slopes).unwrap();
    let expected = reference::gradient_over(&graph, &boxes).unwrap();
    for (k, (a, b)) in slopes.iter().zip(&expected).enumerate() {
        let same = parts(a.value) == parts(b.value) && a.gradient.map(parts) == b.gradient.map(parts);
        assert!(same, "{a:?} {b:?} over {:?} of {graph:?}", boxes[k]);
    }
}

#[test]
fn the_tape_is_the_plain_evaluator_bit_for_bit() {
    let seed = 11;
    let mut random = Random::new(seed);
    for case in 0..250 {
        let (size, rows) = (1 + random.below(40), 1 + random.below(300));
        println!("seed {seed}, case {case}: {size} operations, {rows} rows");
        compare(&mut random, size, rows);
    }
    compare(&mut random, 30, 1500);
}

/// The same test in a process for each instruction set: the choice is made once in each.
#[test]
fn every_instruction_set_gives_the_same_bits() {
    let this = std::env::current_exe().expect("the test itself");
    for isa in ["plain", "avx2", "avx512"] {
        let done = std::process::Command::new(&this)
            .args(["--exact", "fields::tape_laws::the_tape_is_the_plain_evaluator_bit_for_bit"])
            .env("CHORDAL_ISA", isa)
            .output()
            .expect("the test runs");
        let text = String::from_utf8_lossy(&done.stdout);
        assert!(done.status.success() && text.contains("1 passed"), "{isa}: {text}");
    }
}

#[test]
fn gradients_are_those_of_differences() {
    let mut random = Random::new(12);
    let mut n_checked = 0;
    for _ in 0..400 {
        let expr = random.expression(6);
        let tape = Tape::new(&expr);
        let points: Vec<[f64; 3]> = (0..20).map(|_| random.point_within(4.0)).collect();
        let mut slopes = vec![NOWHERE; points.len()];
        tape.gradient_at(&points, &mut slopes).unwrap();
        for (p, slope) in points.iter().zip(&slopes) {
            for k in 0..3 {
                let at = |step: f64| {
                    let mut q = *p;
                    q[k] += step;
                    let mut value = [0.0];
                    tape.at(&[q], &mut value).unwrap();
                    value[0]
                };
                // Where steps of two sizes and sides agree there is no kink and no jump between.
                let (h, v) = (2.0_f64.powi(-18), slope.value);
                let (left, right) = ((v - at(-h)) / h, (at(h) - v) / h);
                let (wide_left, wide_right) = ((v - at(-2.0 * h)) / (2.0 * h), (at(2.0 * h) - v) / (2.0 * h));
                let middle = 0.5 * (left + right);
                let spread = [left, right, wide_left, wide_right]
                    .iter()
                    .map(|d| (d - middle).abs())
                    .fold(0.0, f64::max);
                // A slope through infinite steps, as of 1/ln 0, is none.
                if slope.gradient[k].is_finite()
                    && spread.is_finite()
                    && v.abs() < 1e3
                    && spread <= 1e-3 * (1.0 + middle.abs())
                {
                    let off = (slope.gradient[k] - middle).abs();
                    assert!(
                        off <= 2e-3 * (1.0 + middle.abs()),
                        "{slope:?} {middle} at {p:?} of {:?}",
                        tape.graph()
                    );
                    n_checked += 1;
                }
            }
        }
    }
    assert!(n_checked > 5000, "{n_checked}");
}

#[test]
fn a_shortened_tape_has_the_same_values_in_its_region() {
    let mut random = Random::new(13);
    let mut n_shorter = 0;
    for case in 0..400 {
        let expr = if case % 2 == 0 { random.solids(12) } else { random.expression(40) };
        let tape = Tape::new(&expr);
        let bounds = random.bounds();
        let (range, shorter) = tape.prune(&bounds).unwrap();
        let mut expected = [Interval::UNKNOWN];
        tape.over(&[bounds], &mut expected).unwrap();
        assert_eq!(parts(range), parts(expected[0]));
        let Some(shorter) = shorter else { continue };
        assert!(shorter.len() < tape.len());
        n_shorter += 1;
        let points: Vec<[f64; 3]> = (0..50).map(|_| random.within(&bounds)).collect();
        let (mut whole, mut part) = (vec![NOWHERE; 50], vec![NOWHERE; 50]);
        tape.gradient_at(&points, &mut whole).unwrap();
        shorter.gradient_at(&points, &mut part).unwrap();
        for (a, b) in whole.iter().zip(&part) {
            assert_eq!((bits(a.value), a.gradient.map(bits)), (bits(b.value), b.gradient.map(bits)));
        }
        let (again, _) = shorter.prune(&bounds).unwrap();
        assert!(again.is_subset_of(range), "{again} {range}");
    }
    assert!(n_shorter > 100, "{n_shorter}");
}

#[test]
fn many_points_have_the_values_of_each() {
    let mut random = Random::new(15);
    for case in 0..40 {
        let expr = if case % 2 == 0 { random.solids(40) } else { random.expression(80) };
        let (tape, bounds) = (Tape::new(&expr), random.bounds());
        // So many that boxes around them are halved.
        let points: Vec<[f64; 3]> = (0..3000).map(|_| random.within(&bounds)).collect();
        let (mut each, mut all) = (vec![0.0; points.len()], vec![1.0; points.len()]);
        tape.at(&points, &mut each).unwrap();
        tape.at_many(&points, &mut all).unwrap();
        assert!(each.iter().zip(&all).all(|(a, b)| bits(*a) == bits(*b)), "case {case}");
    }
}

#[test]
fn a_region_of_one_solid_needs_that_one_alone() {
    let mut random = Random::new(14);
    let tape = Tape::new(&random.solids(60));
    let bounds = Box3 { min: [1.0; 3], max: [1.01; 3] };
    let (_, shorter) = tape.prune(&bounds).unwrap();
    let shorter = shorter.expect("most solids are far away");
    assert!(shorter.len() * 4 < tape.len(), "{} of {}", shorter.len(), tape.len());
}

#[test]
fn nan_comes_through_to_the_value_and_is_no_range() {
    use chordal::implicit::Expr;
    use chordal::implicit::evaluation::Unary;
    let [x, ..] = Expr::axes();
    let expr = Expr::unary(Unary::Ln, &x);
    let tape = Tape::new(&expr);
    let mut values = [0.0; 4];
    tape.at(&[[-1.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0]], &mut values).unwrap();
    assert!(values[0].is_nan() && values[1].is_nan() && values[2] == f64::NEG_INFINITY && values[3] == 0.0);
    let mut ranges = [Interval::UNKNOWN; 2];
    let nan = Box3 { min: [f64::NAN; 3], max: [f64::NAN; 3] };
    tape.over(&[Box3 { min: [-2.0; 3], max: [-1.0; 3] }, nan], &mut ranges).unwrap();
    assert!(ranges[0].is_empty() && !ranges[0].is_defined() && !ranges[1].is_defined());
}
