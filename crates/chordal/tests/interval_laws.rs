//! Laws of `Interval`: containment against exact arithmetic, inclusion isotonicity, the flag, and no NaN.
use crate::exact;
use chordal::math::Interval;
use dashu_float::FBig;
use exact::{at_least, at_most, cases, exact, number};
use proptest::prelude::*;

/// Intervals of every sort, open ends included, never empty.
fn interval() -> impl Strategy<Value = Interval> {
    (number(), number(), 0..12).prop_map(|(a, b, kind)| {
        let (lo, hi) = if a < b { (a, b) } else { (b, a) };
        match kind {
            0 => Interval::point(a),
            1 => Interval::new(a, f64::INFINITY).unwrap(),
            2 => Interval::new(f64::NEG_INFINITY, a).unwrap(),
            3 => Interval::ENTIRE,
            _ => Interval::new(lo, hi).unwrap(),
        }
    })
}

/// An interval, one inside it, and points inside that.
fn nested() -> impl Strategy<Value = (Interval, Interval, Vec<f64>)> {
    (interval(), 0.0..=1.0, 0.0..=1.0).prop_map(|(outer, s, t)| {
        let between = |t: f64| {
            let (lo, hi) = (outer.lo().max(f64::MIN), outer.hi().min(f64::MAX));
            ((1.0 - t) * lo + t * hi).clamp(lo, hi)
        };
        let (a, b) = (between(s), between(t));
        let inner = Interval::new(a.min(b), a.max(b)).unwrap();
        let mut points = vec![inner.lo(), inner.hi(), inner.midpoint().unwrap()];
        points.extend([0.0, -0.0, 5e-324, -5e-324, 1.0].into_iter().filter(|x| inner.contains(*x)));
        (outer, inner, points)
    })
}

fn holds(range: Interval, value: &FBig) -> bool {
    at_least(value, range.lo()) && at_most(value, range.hi())
}

/// Whether `range` holds `over/under`, exactly.
fn holds_quotient(range: Interval, over: &FBig, under: &FBig) -> bool {
    let sign = if *under < exact(0.0) { exact(-1.0) } else { exact(1.0) };
    let (over, under) = (over * &sign, under * &sign);
    (range.lo() == f64::NEG_INFINITY || exact(range.lo()) * &under <= over)
        && (range.hi() == f64::INFINITY || over <= exact(range.hi()) * &under)
}

/// The form of every result, and the law that a smaller operand gives a smaller range and loses no claim.
fn isotone(inner: Interval, outer: Interval) -> Result<(), TestCaseError> {
    for range in [inner, outer] {
        let empty = range.lo() == f64::INFINITY && range.hi() == f64::NEG_INFINITY;
        let real = range.lo() <= range.hi() && range.lo() < f64::INFINITY && range.hi() > f64::NEG_INFINITY;
        prop_assert!(empty || real, "{range:?}");
    }
    prop_assert!(inner.is_subset_of(outer), "{inner} {outer}");
    prop_assert!(inner.is_defined() || !outer.is_defined(), "{inner} {outer}");
    Ok(())
}

fn power(x: f64, n: u32) -> FBig {
    (0..n).fold(exact(1.0), |product, _| product * exact(x))
}

proptest! {
    #![proptest_config(cases(4000))]

    #[test]
    fn sums_differences_and_products_hold((x_outer, x, xs) in nested(), (y_outer, y, ys) in nested()) {
        let (sum, difference, product) = (x + y, x - y, x * y);
        for (&a, &b) in xs.iter().flat_map(|a| ys.iter().map(move |b| (a, b))) {
            prop_assert!(holds(sum, &(exact(a) + exact(b))), "{a:e} + {b:e} in {x} + {y} = {sum}");
            prop_assert!(holds(difference, &(exact(a) - exact(b))), "{a:e} - {b:e} in {x} - {y} = {difference}");
            prop_assert!(holds(product, &(exact(a) * exact(b))), "{a:e} * {b:e} in {x} * {y} = {product}");
        }
        isotone(sum, x_outer + y_outer)?;
        isotone(difference, x_outer - y_outer)?;
        isotone(product, x_outer * y_outer)?;
        prop_assert!(sum.is_defined() && difference.is_defined() && product.is_defined());
    }

    #[test]
    fn quotients_hold_where_they_are_claimed((x_outer, x, xs) in nested(), (y_outer, y, ys) in nested()) {
        let quotient = x / y;
        isotone(quotient, x_outer / y_outer)?;
        prop_assert_eq!(quotient.is_defined(), !y.contains(0.0));
        prop_assert!(quotient.is_defined() || quotient.is_entire());
        for (&a, &b) in xs.iter().flat_map(|a| ys.iter().map(move |b| (a, b))).filter(|(_, b)| **b != 0.0) {
            prop_assert!(holds_quotient(quotient, &exact(a), &exact(b)), "{a:e} / {b:e} in {quotient}");
        }
    }

    #[test]
    fn roots_hold_and_tell_of_negative_parts((outer, x, xs) in nested()) {
        let root = x.sqrt();
        isotone(root, outer.sqrt())?;
        prop_assert_eq!(root.is_defined(), x.lo() >= 0.0);
        prop_assert_eq!(root.is_empty(), x.hi() < 0.0);
        prop_assert!(root.lo() >= 0.0);
        for &a in xs.iter().filter(|a| **a >= 0.0) {
            let (lo, hi) = (exact(root.lo()), root.hi());
            prop_assert!(&lo * &lo <= exact(a), "√{a:e} in {root}");
            prop_assert!(hi == f64::INFINITY || exact(hi) * exact(hi) >= exact(a), "√{a:e} in {root}");
        }
    }

    #[test]
    fn powers_hold((outer, x, xs) in nested(), n in -9..14_i32) {
        let raised = x.powi(n);
        isotone(raised, outer.powi(n))?;
        if n >= 0 {
            prop_assert!(raised.is_defined());
        } else if x.contains(0.0) {
            prop_assert!(raised.is_entire() && !raised.is_defined());
        }
        for &a in &xs {
            let value = power(a, n.unsigned_abs());
            if n >= 0 {
                prop_assert!(holds(raised, &value), "{a:e}^{n} in {raised}");
            } else if a != 0.0 {
                prop_assert!(holds_quotient(raised, &exact(1.0), &value), "{a:e}^{n} in {raised}");
            }
        }
    }

    #[test]
    fn squares_are_second_powers_and_not_negative((outer, x, xs) in nested()) {
        let square = x.square();
        isotone(square, outer.square())?;
        prop_assert_eq!(square, x.powi(2));
        prop_assert!(square.lo() >= 0.0 && square.sqrt().is_defined());
        for &a in &xs {
            prop_assert!(holds(square, &power(a, 2)), "{a:e}² in {square}");
        }
    }

    #[test]
    fn what_only_picks_ends_is_exact((x_outer, x, xs) in nested(), (y_outer, y, ys) in nested()) {
        prop_assert_eq!(-(-x), x);
        prop_assert_eq!(((-x).lo(), (-x).hi()), (-x.hi(), -x.lo()));
        prop_assert_eq!(x.abs(), x.max(-x).max(Interval::point(0.0)).intersection(x.abs()));
        prop_assert_eq!(x.abs().hi(), x.magnitude());
        prop_assert_eq!(-((-x).min(-y)), x.max(y));
        isotone(x.abs(), x_outer.abs())?;
        isotone(x.min(y), x_outer.min(y_outer))?;
        isotone(x.max(y), x_outer.max(y_outer))?;
        isotone(x.hull(y), x_outer.hull(y_outer))?;
        for &a in &xs {
            prop_assert!(x.abs().contains(a.abs()) && (-x).contains(-a) && x.hull(y).contains(a));
            prop_assert_eq!(x.intersection(y).contains(a), y.contains(a));
            for &b in &ys {
                let (smaller, larger) = if a < b { (a, b) } else { (b, a) };
                prop_assert!(x.min(y).contains(smaller) && x.max(y).contains(larger));
            }
        }
    }

    #[test]
    fn width_is_an_upper_bound_and_the_midpoint_is_in_the_middle((_, x, xs) in nested()) {
        let width = x.width();
        prop_assert!(at_most(&(exact(x.hi()) - exact(x.lo())), width));
        prop_assert_eq!(width == 0.0, x.lo() == x.hi());
        let middle = x.midpoint().unwrap();
        prop_assert!(x.contains(middle) && xs.iter().all(|a| x.contains(*a)));
        let off = exact(2.0) * exact(middle) - (exact(x.lo()) + exact(x.hi()));
        let rounding = exact(2.0 * f64::EPSILON) * exact(x.magnitude()) + exact(1e-323);
        prop_assert!(off <= rounding && -off <= rounding, "{middle:e} in {x}");
    }

    #[test]
    fn long_expressions_never_show_nan(seeds in prop::collection::vec((interval(), 0..9_u8), 1..12)) {
        let mut value = Interval::point(1.0);
        for (x, op) in seeds {
            value = match op {
                0 => value + x,
                1 => value - x,
                2 => value * x,
                3 => value / x,
                4 => value.sqrt(),
                5 => value.powi(-3),
                6 => value.square(),
                7 => value.intersection(x),
                _ => x / value,
            };
            isotone(value, value)?;
            prop_assert!(!value.width().is_nan() && !value.magnitude().is_nan());
            prop_assert!(value.midpoint().is_none_or(f64::is_finite));
            prop_assert_eq!(value.is_empty(), value.midpoint().is_none());
        }
    }
}

#[test]
fn an_exact_zero_stays_zero() {
    let zero = Interval::point(0.0);
    let x = Interval::new(-3.0, f64::INFINITY).unwrap();
    for product in [zero * x, x * zero, zero * Interval::ENTIRE, zero / Interval::new(1.0, 2.0).unwrap()] {
        assert_eq!((product.lo(), product.hi(), product.is_defined()), (0.0, 0.0, true));
    }
    let tiny = Interval::new(1e-200, 1.0).unwrap();
    assert_eq!((tiny * tiny).lo(), 0.0);
    assert_eq!((tiny * -tiny).hi(), 0.0);
    assert_eq!(zero.sqrt(), zero);
    assert_eq!(Interval::point(0.1) - Interval::point(0.1), zero);
}

#[test]
fn an_open_end_stays_open_and_reaches_no_further() {
    let above_one = Interval::new(1.0, f64::INFINITY).unwrap();
    assert_eq!(Interval::point(1.0) / above_one, Interval::new(0.0, 1.0_f64.next_up()).unwrap());
    assert!((above_one - above_one).is_entire());
    assert_eq!((above_one * above_one).hi(), f64::INFINITY);
    assert_eq!((Interval::point(f64::MAX) + Interval::point(f64::MAX)).lo(), f64::MAX);
    assert_eq!(Interval::new(f64::NEG_INFINITY, -1.0).unwrap().midpoint(), Some(f64::MIN));
}

#[test]
fn what_is_not_everywhere_defined_says_so_ever_after() {
    let x = Interval::new(-1.0, 4.0).unwrap();
    let root = x.sqrt();
    assert!(!root.is_defined() && root.contains(2.0) && root.lo() == 0.0 && root.hi() < 2.0 + 1e-15);
    let one = Interval::point(1.0);
    for later in [root + one, one - root, root * root, one / (root + one), root.min(one), root.powi(0), -root]
    {
        assert!(!later.is_defined(), "{later:?}");
    }
    assert!(!one.undefined().square().is_defined());
}

#[test]
fn the_empty_interval_swallows_everything() {
    let (empty, x) = (Interval::EMPTY, Interval::new(1.0, 2.0).unwrap());
    assert_eq!(Interval::new(-2.0, -1.0).unwrap().sqrt(), empty);
    assert_eq!(x.intersection(Interval::point(3.0)), empty);
    let results = [empty + x, x - empty, empty * x, x / empty, empty / x, empty.min(x), x.max(empty), -empty];
    assert!(results.into_iter().all(|range| range == empty));
    let results = [empty.abs(), empty.square(), empty.sqrt(), empty.powi(3), empty.powi(0), empty.powi(-1)];
    assert!(results.into_iter().all(|range| range == empty));
    assert!(!empty.contains(0.0) && empty.is_subset_of(x) && empty.midpoint().is_none());
    assert_eq!((empty.width(), empty.magnitude()), (0.0, 0.0));
    assert_eq!((empty.hull(x).lo(), empty.hull(x).hi()), (1.0, 2.0));
}

#[test]
fn refuses_what_is_no_interval() {
    let bad = [(f64::NAN, 1.0), (1.0, f64::NAN), (2.0, 1.0), (f64::INFINITY, f64::INFINITY)];
    for (lo, hi) in bad {
        assert!(Interval::new(lo, hi).is_err(), "{lo} {hi}");
    }
    assert!(Interval::new(f64::NEG_INFINITY, f64::NEG_INFINITY).is_err());
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(Interval::point(x).is_entire() && !Interval::point(x).is_defined());
        assert!(!Interval::ENTIRE.contains(x));
    }
}

#[test]
fn shows_its_ends_and_its_flag() {
    let x = Interval::new(-1.5, 0.1).unwrap();
    assert_eq!(x.to_string(), "[-1.5, 0.1]");
    assert_eq!(x.undefined().to_string(), "[-1.5, 0.1]?");
    assert_eq!(Interval::ENTIRE.to_string(), "[-inf, inf]");
    assert_eq!(Interval::EMPTY.to_string(), "empty");
}
