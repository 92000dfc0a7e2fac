//! Exponents of numbers, and powers of two with these exponents: scaling by a power of two is exact.
use super::greater;

/// The exponent `e` with `2^(e−1) ≤ |x| < 2^e`; for 0 and subnormals that of the smallest normal number.
pub(crate) fn exponent(x: f64) -> i32 {
    let bits = (x.to_bits() >> 52 & 0x7ff) as i32;
    if bits == 0 { -1021 } else { bits - 1022 }
}

/// `2^e` for `−1022 ≤ e ≤ 1023`; `e` is clamped to that range.
pub(crate) fn power_of_two(e: i32) -> f64 {
    f64::from_bits(((e.clamp(-1022, 1023) + 1023) as u64) << 52)
}

/// A power of two that scales the largest coordinate to near 1.
pub(crate) fn unit_scale<const D: usize>(points: &[[f64; D]]) -> f64 {
    let largest = points.iter().flatten().fold(0.0_f64, |largest, x| greater(x.abs(), largest));
    let exponent = ((largest.to_bits() >> 52) & 0x7ff) as i64 - 1023;
    if largest == 0.0 {
        return 1.0;
    }
    // Clamped to the exponents of normal numbers, −1022 to 1023. The reciprocal of 2^1023 is subnormal, but exact
    // as well.
    f64::from_bits(((1023 - exponent).clamp(1, 2046) as u64) << 52)
}
