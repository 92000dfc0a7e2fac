//! Payne–Hanek reduction: angles of any size, reduced with integers.
//!
//! Source: M. H. Payne and R. N. Hanek, *Radian Reduction for Trigonometric Functions*, 1983.
use super::super::DoubleDouble;

/// An angle as `turns` · π/2 + `hi` + `lo`, where |hi| exceeds π/4 at most slightly, and |lo| is below 2.1 u
/// |hi|.
#[derive(Clone, Copy)]
pub(super) struct ReducedAngle {
    pub(super) hi: f64,
    pub(super) lo: f64,
    /// Only the last two bits are significant.
    pub(super) turns: u64,
}

/// The binary digits of 2/π after the binary point, preceded by 64 zeros for the integer part. Derived with
/// 2600 bits.
const TWO_OVER_PI: [u64; 23] = [
    0,
    0xa2f9_836e_4e44_1529,
    0xfc27_57d1_f534_ddc0,
    0xdb62_9599_3c43_9041,
    0xfe51_63ab_debb_c561,
    0xb724_6e3a_424d_d2e0,
    0x0649_2eea_09d1_921c,
    0xfe1d_eb1c_b129_a73e,
    0xe882_35f5_2ebb_4484,
    0xe99c_7026_b45f_7e41,
    0x3991_d639_8353_39f4,
    0x9c84_5f8b_bdf9_283b,
    0x1ff8_97ff_de05_980f,
    0xef2f_118b_5a0a_6d1f,
    0x6d36_7ecf_27cb_09b7,
    0x4f46_3f66_9e5f_ea2d,
    0x7527_bac7_ebe5_f17b,
    0x3d07_39f7_8a52_92ea,
    0x6bfb_5fb1_1f8d_5d08,
    0x5603_3046_fc7b_6bab,
    0xf0cf_bc20_9af4_361d,
    0xa9e3_9161_5ee6_1b08,
    0x6599_855f_14a0_6840,
];

/// Reduces a finite |x| ≥ 2¹⁶.
///
/// x = m·2ᵉ with an integer m of 53 bits. Digits of 2/π worth 4 or more turns drop out; the 256 following
/// digits times m give x·2/π modulo 4 with 254 binary places and an error below 2⁻²⁰⁰. No f64 is nearer than
/// 2⁻⁶² to a multiple of π/2 (Kahan), so the fraction keeps more than 130 bits; 106 of them are returned.
pub(super) fn reduce(x: f64) -> ReducedAngle {
    let bits = x.abs().to_bits();
    let m = (bits & ((1 << 52) - 1)) | (1 << 52);
    let e = (bits >> 52) as usize; // x = m · 2^(e − 1075)
    // The first digit needed is worth 2^-j with j = (e − 1075) − 1: then m·digit is worth 2 · m.
    let product = times(window(e + 64 - 1077), m);
    // Two bits of quarter turns, 254 bits of fraction. A fraction above a half counts from the next quarter turn,
    // and is negative, so that the angle is at most π/4, where the series are short.
    let above_half = product[0] >> 61 & 1 == 1;
    let turns = (product[0] >> 62) + u64::from(above_half);
    let fraction = [product[0] & (u64::MAX >> 2), product[1], product[2], product[3]];
    let size = if above_half { complement(fraction) } else { fraction };
    let (hi, lo) = leading_bits(size);
    // The next digits of π/2, derived.
    let half_pi = DoubleDouble { hi: std::f64::consts::FRAC_PI_2, lo: 6.123_233_995_736_766e-17 };
    let angle = DoubleDouble::two_sum(hi, lo).times(half_pi);
    // A fraction above a half was replaced by its negative; for a negative x the two signs cancel.
    let sign = if above_half == (x < 0.0) { 1.0 } else { -1.0 };
    let turns = if x < 0.0 { turns.wrapping_neg() } else { turns };
    ReducedAngle { hi: sign * angle.hi, lo: sign * angle.lo, turns }
}

/// 256 bits of the table from bit `start` on, the highest word first.
fn window(start: usize) -> [u64; 4] {
    let (word, shift) = (start / 64, start % 64);
    std::array::from_fn(|k| {
        let at = |k: usize| TWO_OVER_PI.get(k).copied().unwrap_or(0);
        if shift == 0 { at(word + k) } else { at(word + k) << shift | at(word + k + 1) >> (64 - shift) }
    })
}

/// The low 256 bits of `digits · m`.
fn times(digits: [u64; 4], m: u64) -> [u64; 4] {
    let mut product = [0; 4];
    let mut carry = 0_u128;
    for k in (0..4).rev() {
        let part = u128::from(digits[k]) * u128::from(m) + carry;
        product[k] = part as u64;
        carry = part >> 64;
    }
    product
}

/// 2²⁵⁴ − `fraction`.
fn complement(fraction: [u64; 4]) -> [u64; 4] {
    let mut result = [0; 4];
    let mut borrow = false;
    for k in (0..4).rev() {
        let (part, first) = 0_u64.overflowing_sub(fraction[k]);
        let (part, second) = part.overflowing_sub(u64::from(borrow));
        result[k] = part;
        borrow = first || second;
    }
    result[0] &= u64::MAX >> 2;
    result
}

/// The leading 106 bits of `fraction` / 2²⁵⁴, as two numbers of 53 bits.
fn leading_bits(fraction: [u64; 4]) -> (f64, f64) {
    let high = u128::from(fraction[0]) << 64 | u128::from(fraction[1]);
    let low = u128::from(fraction[2]) << 64 | u128::from(fraction[3]);
    let zeros = high.leading_zeros();
    let top = if zeros == 0 { high } else { high << zeros | low.checked_shr(128 - zeros).unwrap_or(0) };
    // Bit 127 of `top` is worth 2^(127 + 128 − zeros − 254).
    let first = (top >> 75) as u64;
    let second = (top >> 22) as u64 & ((1 << 53) - 1);
    let unit = |exponent: i64| f64::from_bits(((exponent + 1023) as u64) << 52);
    let worth = 1 - i64::from(zeros);
    (first as f64 * unit(worth - 52), second as f64 * unit(worth - 105))
}
