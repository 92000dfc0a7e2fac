//! Exponents of numbers, and powers of two with these exponents: scaling by a power of two is exact.

/// The exponent `e` with `2^(e−1) ≤ |x| < 2^e`; for 0 and subnormals that of the smallest normal number.
pub(crate) fn exponent(x: f64) -> i32 {
    let bits = (x.to_bits() >> 52 & 0x7ff) as i32;
    if bits == 0 { -1021 } else { bits - 1022 }
}

/// `2^e` for `−1022 ≤ e ≤ 1023`; `e` is clamped to that range.
pub(crate) fn power_of_two(e: i32) -> f64 {
    f64::from_bits(((e.clamp(-1022, 1023) + 1023) as u64) << 52)
}
