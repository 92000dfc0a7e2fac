//! Rows 68 and 69 of the hostile inputs: expressions of any depth and sharing, and operations without a
//! value.
use chordal::implicit::Expr;
use chordal::implicit::evaluation::{Binary, Dual, ExprGraph, Tape, Unary};
use chordal::math::{Box3, Interval};
use chordal_testkit::is_long;

fn unit() -> Box3 {
    Box3 { min: [0.25; 3], max: [0.5; 3] }
}

fn over(expr: &Expr, bounds: Box3) -> Interval {
    let mut range = [Interval::EMPTY];
    Tape::new(expr).over(&[bounds], &mut range).expect("no leaf");
    range[0]
}

fn at(expr: &Expr, p: [f64; 3]) -> f64 {
    let mut value = [0.0];
    Tape::new(expr).at(&[p], &mut value).expect("no leaf");
    value[0]
}

#[test]
fn h68_a_chain_of_a_million_parts_is_evaluated_and_dropped_without_a_deep_stack() {
    let [x, ..] = Expr::axes();
    let mut chain = x.clone();
    // A tenth of them would overflow the stack of a test, too, if anything recursed.
    let n: u32 = if is_long() { 1_000_000 } else { 100_000 };
    for k in 0..n {
        chain = if k % 2 == 0 { chain.min(&(&x + f64::from(k))) } else { -chain };
    }
    let tape = Tape::new(&chain);
    assert!(tape.len() > n as usize);
    let mut values = [0.0; 2];
    tape.at(&[[0.25, 0.0, 0.0], [-3.0, 0.0, 0.0]], &mut values).unwrap();
    assert!(values.iter().all(|value| value.is_finite()));
    let mut slopes = [Dual { value: 0.0, gradient: [0.0; 3] }];
    tape.gradient_at(&[[0.25, 0.0, 0.0]], &mut slopes).unwrap();
    assert_eq!((slopes[0].value, slopes[0].gradient[0].abs()), (values[0], 1.0));
    let (range, shorter) = tape.prune(&unit()).unwrap();
    assert!(range.contains(values[0]));
    assert!(shorter.is_some_and(|shorter| shorter.len() * 2 < tape.len()));
    drop(chain);
}

#[test]
fn h68_a_union_of_a_million_parts_and_a_tree_of_shared_halves() {
    let [x, y, z] = Expr::axes();
    let n: u32 = if is_long() { 1_000_000 } else { 100_000 };
    let mut row: Vec<Expr> = (0..n).map(|k| &x - f64::from(k)).collect();
    while row.len() > 1 {
        row = row
            .chunks(2)
            .map(|two| if two.len() == 2 { two[0].min(&two[1]) } else { two[0].clone() })
            .collect();
    }
    assert_eq!(at(&row[0], [0.5, 0.0, 0.0]), 0.5 - f64::from(n - 1));

    // 2⁴⁰ copies of three coordinates, in 40 parts.
    let mut shared = &x * 0.5 + y * 0.25 + z * 0.125;
    for _ in 0..40 {
        shared = &shared + &shared;
    }
    assert!(ExprGraph::from_expr(&shared).terms().len() < 60);
    assert_eq!(at(&shared, [1.0, 1.0, 1.0]), 0.875 * 2.0_f64.powi(40));
    let mut copies = x;
    for _ in 0..40 {
        let [a, b, c] = Expr::axes();
        copies = copies.with_axes([a.clone() + 1.0, b, c]).max(&copies);
    }
    assert!(ExprGraph::from_expr(&copies).terms().len() < 4000);
    assert_eq!(at(&copies, [2.0, 0.0, 0.0]), 42.0);
}

#[test]
fn h69_what_has_no_value_is_nan_or_infinite_and_its_range_says_so() {
    let [x, y, _] = Expr::axes();
    let zero = &x * 0.0;
    let unknown = [
        Expr::unary(Unary::Recip, &zero),
        Expr::unary(Unary::Ln, &(&zero - 1.0)),
        Expr::unary(Unary::Ln, &zero),
        Expr::unary(Unary::Sqrt, &(&zero - 1.0)),
        Expr::unary(Unary::Asin, &(&zero + 2.0)),
        Expr::unary(Unary::Acos, &(&zero - 2.0)),
        Expr::binary(Binary::Atan2, &zero, &(&y * 0.0)),
        Expr::binary(Binary::Mod, &y, &zero),
        Expr::binary(Binary::Div, &y, &zero),
        Expr::binary(Binary::Div, &zero, &(&y * 0.0)),
        Expr::constant(f64::NAN),
        Expr::constant(f64::INFINITY),
        Expr::constant(f64::NAN).min(&x),
        x.max(&Expr::constant(f64::NAN)),
    ];
    for expr in &unknown {
        let range = over(expr, unit());
        assert!(!range.is_defined(), "{expr:?} {range}");
        let value = at(expr, [0.375; 3]);
        assert!(!value.is_finite() || range.contains(value), "{expr:?}: {value} in {range}");
        // What is made of it makes no claim either.
        for next in [expr.abs() + 1.0, expr.min(&x), expr.square().sqrt(), expr.sin()] {
            assert!(!over(&next, unit()).is_defined(), "{next:?} of {expr:?}");
        }
    }
}

#[test]
fn h69_a_range_across_a_pole_or_a_jump_holds_all_values_without_the_claim() {
    let [x, y, _] = Expr::axes();
    let across = Box3 { min: [-1.0, -1.0, -1.0], max: [2.0, 1.0, 1.0] };
    let jumps = [
        Expr::unary(Unary::Recip, &x),
        Expr::unary(Unary::Tan, &(&x + 1.0)),
        Expr::unary(Unary::Floor, &x),
        Expr::unary(Unary::Ceil, &x),
        Expr::unary(Unary::Round, &x),
        Expr::unary(Unary::Not, &x),
        Expr::unary(Unary::Ln, &x),
        Expr::binary(Binary::Atan2, &y, &x),
        Expr::binary(Binary::Mod, &x, &y),
        Expr::binary(Binary::Mod, &x, &Expr::constant(0.75)),
        Expr::binary(Binary::Compare, &x, &y),
        Expr::binary(Binary::And, &x, &y),
        Expr::binary(Binary::Or, &x, &y),
    ];
    for expr in &jumps {
        let range = over(expr, across);
        assert!(!range.is_defined(), "{expr:?}");
        for k in 0..60 {
            let t = f64::from(k) / 59.0;
            let value = at(expr, [3.0 * t - 1.0, (7.0 * t) % 2.0 - 1.0, 0.0]);
            assert!(!value.is_finite() || range.contains(value), "{expr:?}: {value} in {range}");
        }
    }
    // Away from the jump the claim is kept.
    let beside = Box3 { min: [1.1, 0.6, 0.0], max: [1.3, 0.9, 0.0] };
    for expr in jumps.iter().filter(|expr| !format!("{:?}", ExprGraph::from_expr(expr)).contains("Mod")) {
        assert!(over(expr, beside).is_defined(), "{expr:?}");
    }
}

#[test]
fn h69_an_empty_box_has_no_claim() {
    let [x, ..] = Expr::axes();
    let range = over(&x.sin(), Box3::EMPTY);
    assert!(!range.is_defined());
}
