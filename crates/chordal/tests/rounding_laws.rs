//! Laws of directed rounding: the bounds hold against exact arithmetic, and are at most two steps apart from
//! it.
use crate::exact;
use chordal::math::{
    add_down, add_up, div_down, div_up, mul_down, mul_up, sqrt_down, sqrt_up, sub_down, sub_up,
};
use dashu_float::FBig;
use exact::{at_least, at_most, cases, exact, number};
use proptest::prelude::*;

/// The bounds enclose `value`, and two steps inward they no longer do.
fn encloses(down: f64, value: &FBig, up: f64) -> Result<(), TestCaseError> {
    prop_assert!(at_least(value, down) && at_most(value, up), "{down:e} {value} {up:e}");
    prop_assert!(!at_least(value, down.next_up().next_up()), "{down:e} is low for {value}");
    prop_assert!(!at_most(value, up.next_down().next_down()), "{up:e} is high for {value}");
    Ok(())
}

proptest! {
    #![proptest_config(cases(4000))]

    #[test]
    fn sums_and_differences_are_enclosed(a in number(), b in number()) {
        encloses(add_down(a, b), &(exact(a) + exact(b)), add_up(a, b))?;
        encloses(sub_down(a, b), &(exact(a) - exact(b)), sub_up(a, b))?;
    }

    #[test]
    fn products_are_enclosed(a in number(), b in number()) {
        encloses(mul_down(a, b), &(exact(a) * exact(b)), mul_up(a, b))?;
    }

    #[test]
    fn quotients_are_enclosed(a in number(), b in number()) {
        prop_assume!(b != 0.0);
        // d ≤ a/b ≤ u, multiplied by |b| > 0.
        let (times, over) = (exact(b.abs()), exact(if b < 0.0 { -a } else { a }));
        let (down, up) = (div_down(a, b), div_up(a, b));
        let holds = |down: f64, up: f64| {
            (down == f64::NEG_INFINITY || exact(down) * &times <= over)
                && (up == f64::INFINITY || over <= exact(up) * &times)
        };
        prop_assert!(down <= f64::MAX && up >= f64::MIN);
        prop_assert!(holds(down, up), "{a:e}/{b:e} in [{down:e}, {up:e}]");
        prop_assert!(up.next_down().next_down() <= down, "{down:e} {up:e}");
    }

    #[test]
    fn roots_are_enclosed(a in number()) {
        let a = a.abs();
        let (down, up) = (sqrt_down(a), sqrt_up(a));
        prop_assert!(down >= 0.0 && exact(down) * exact(down) <= exact(a), "√{a:e} ≥ {down:e}");
        prop_assert!(exact(up) * exact(up) >= exact(a), "√{a:e} ≤ {up:e}");
        prop_assert!(up.next_down().next_down() <= down, "{down:e} {up:e}");
    }
}

#[test]
fn nan_stays_nan() {
    for f in [add_up, add_down, sub_up, sub_down, mul_up, mul_down, div_up, div_down] {
        assert!(f(f64::NAN, 1.0).is_nan() && f(1.0, f64::NAN).is_nan());
    }
    assert!(sqrt_up(-1.0).is_nan() && sqrt_down(-1.0).is_nan());
}
