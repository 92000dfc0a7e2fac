//! The functions that return an angle: all are computed by `atan2`.

/// arctan of 1/4, 1/2, 3/4 and 1, each as a double and the remainder. Derived with 300 bits.
const STEPS: [(f64, f64); 4] = [
    (f64::from_bits(0x3fcf_5b75_f92c_80dd), f64::from_bits(0x3c68_ab6e_3cf7_afbd)),
    (f64::from_bits(0x3fdd_ac67_0561_bb4f), f64::from_bits(0x3c7a_2b7f_222f_65e2)),
    (f64::from_bits(0x3fe4_978f_a326_9ee1), f64::from_bits(0x3c72_419a_87f2_a458)),
    (f64::from_bits(0x3fe9_21fb_5444_2d18), f64::from_bits(0x3c81_a626_3314_5c07)),
];

/// The excess of π/2 over its f64; that of π is twice as much. Derived.
const HALF_PI_REST: f64 = f64::from_bits(0x3c91_a626_3314_5c07);

/// The angle of the point `(x, y)` from the first axis, in [−π, π], within 10 u of itself; signs of zeros and
/// infinities follow IEEE 754.
///
/// With a the smaller and b the larger of |x| and |y|, arctan(a/b) = arctan(c) + arctan((a − c b)/(b + c a))
/// for the c among 0, ¼, ½, ¾, 1 that is nearest to a/b. The difference is exact, or rounds by ¾ u b for c =
/// ¾; the sum and the quotient make it 2.4 u of the argument t, |t| ≤ 1/8. The series beyond its first term
/// is below 0.0053 t, and the omitted term is 2⁻⁵⁸. Relative to arctan(a/b) ≥ 0.124 (for c ≥ ¼) that and
/// three more roundings are 4.5 u, and for c = 0 they are 2.2 u. Subtracting it from π/2 adds at most 1.1 u
/// (the result is not smaller than the subtracted angle), and subtracting from π as much again: 7 u. Both
/// operands are scaled if b is too small or too large; numbers that underflow then are below the smallest
/// number.
///
/// ```
/// use chordal::math::elementary::atan2;
/// assert_eq!(atan2(1.0, 1.0), std::f64::consts::FRAC_PI_4);
/// assert_eq!(atan2(0.0, -1.0), std::f64::consts::PI);
/// ```
#[must_use]
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    let (along, across) = (x.abs(), y.abs());
    let steep = across > along;
    let (a, b) = if steep { (along, across) } else { (across, along) };
    // Only the ratio matters. 2¹²⁰ and 2⁻⁶⁰, exactly; 1 instead of two infinities.
    let small = f64::from_bits(0x0430_0000_0000_0000); // 2⁻⁹⁵⁶: products with ¼ stay exact above it.
    let large = f64::from_bits(0x7e70_0000_0000_0000); // 2¹⁰⁰⁰: sums stay finite below it.
    let scale = if b < small { f64::from_bits(0x4770_0000_0000_0000) } else { 1.0 };
    let scale = if b > large { f64::from_bits(0x3c30_0000_0000_0000) } else { scale };
    let both_infinite = a == f64::INFINITY;
    let (a, b) = (if both_infinite { 1.0 } else { a * scale }, if both_infinite { 1.0 } else { b * scale });

    // The last c that a/b has passed halfway wins. All are tried, since selections keep the loop
    // free of branches, so that callers can be vectorized.
    let (mut ca, mut cb, mut base, mut remainder) = (0.0, 0.0, 0.0, 0.0);
    for (k, step) in STEPS.into_iter().enumerate() {
        let c = 0.25 * (k as f64 + 1.0);
        let past = a > (c - 0.125) * b;
        ca = if past { c * a } else { ca };
        cb = if past { c * b } else { cb };
        base = if past { step.0 } else { base };
        remainder = if past { step.1 } else { remainder };
    }
    let t = (a - cb) / (b + ca);
    // At the origin t is 0/0, but the standard defines an angle there.
    let t = if b == 0.0 { 0.0 } else { t };
    let z = t * t;
    let mut p = 1.0 / 17.0;
    p = -1.0 / 15.0 + z * p;
    p = 1.0 / 13.0 + z * p;
    p = -1.0 / 11.0 + z * p;
    p = 1.0 / 9.0 + z * p;
    p = -1.0 / 7.0 + z * p;
    p = 1.0 / 5.0 + z * p;
    p = -1.0 / 3.0 + z * p;
    let angle = base + (t + (t * (z * p) + remainder));
    // The rest of π/2 is taken off the angle, where it still counts: π/2 + rest would round back to π/2.
    let angle = if steep { std::f64::consts::FRAC_PI_2 - (angle - HALF_PI_REST) } else { angle };
    // The bit and not a comparison, since −0 also lies on the negative axis.
    let behind = x.to_bits() >> 63 == 1;
    let angle = if behind { std::f64::consts::PI - (angle - 2.0 * HALF_PI_REST) } else { angle };
    let angle = f64::from_bits(angle.to_bits() | (y.to_bits() & (1 << 63)));
    // The selections above took NaN for a number.
    if x.is_nan() || y.is_nan() { f64::NAN } else { angle }
}

/// The angle whose tangent is `x`, in [−π/2, π/2], within 10 u of itself.
#[must_use]
#[inline(always)]
pub fn atan(x: f64) -> f64 {
    atan2(x, 1.0)
}

/// √(1 − x²) within 2.5 u: two roundings, of which half of each counts, and that of the root itself.
#[inline(always)]
fn pythagorean_complement(x: f64) -> f64 {
    ((1.0 - x) * (1.0 + x)).sqrt()
}

/// The angle whose sine is `x`, in [−π/2, π/2], within 10 u of itself; NaN outside [−1, 1].
///
/// The error of the cosine is 2.5 u; it turns the angle by sin · cos times that, which is at most as much of
/// the angle.
#[must_use]
#[inline(always)]
pub fn asin(x: f64) -> f64 {
    atan2(x, pythagorean_complement(x))
}

/// The angle whose cosine is `x`, in [0, π], within 10 u of itself; NaN outside [−1, 1].
#[must_use]
#[inline(always)]
pub fn acos(x: f64) -> f64 {
    atan2(pythagorean_complement(x), x)
}
