//! Numbers without rounding, and hard f64s to try: what the laws of `math` are judged by.
#![allow(dead_code)] // Each test file compiles this module for itself and uses a part of it.
use dashu_float::FBig;
use proptest::prelude::*;

/// So many cases, or ten times as many in the long sweep; a failing one is printed, shrunk, and nothing is
/// written beside the tests.
pub fn cases(n: u32) -> ProptestConfig {
    let cases = chordal_testkit::cases(n as usize) as u32;
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

/// The finite `x`, to be added, subtracted and multiplied without rounding.
pub fn exact(x: f64) -> FBig {
    FBig::try_from(x).expect("finite").with_precision(0).value()
}

/// Whether `low ≤ value`, where −∞ is below everything.
pub fn at_least(value: &FBig, low: f64) -> bool {
    low == f64::NEG_INFINITY || (low.is_finite() && exact(low) <= *value)
}

/// Whether `value ≤ high`, where ∞ is above everything.
pub fn at_most(value: &FBig, high: f64) -> bool {
    high == f64::INFINITY || (high.is_finite() && *value <= exact(high))
}

/// Finite numbers: everyday ones, any bits, and those where arithmetic breaks first.
pub fn number() -> impl Strategy<Value = f64> {
    let special = [
        0.0,
        5e-324,
        f64::MIN_POSITIVE.next_down(),
        f64::MIN_POSITIVE,
        1e-308,
        1e-162,
        1e-154,
        0.1,
        1.0,
        1.0 + f64::EPSILON,
        3.0,
        1e154,
        1.340_780_792_994_26e154,
        1e308,
        f64::MAX,
    ];
    let special = prop::sample::select(special.to_vec());
    prop_oneof![
        3 => -10.0..10.0,
        1 => (-9_i32..9).prop_map(f64::from),
        3 => any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite()),
        3 => (special, any::<bool>()).prop_map(|(x, negative)| if negative { -x } else { x }),
    ]
}
