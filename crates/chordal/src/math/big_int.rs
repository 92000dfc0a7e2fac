//! `BigInt`: an integer of any size, for predicates on coordinates outside the range of expansions.
use std::cmp::Ordering;
use std::ops::{Mul, Neg, Sub};

/// An integer: a sign and 32-bit limbs, lowest first, with no leading 0 limb.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct BigInt {
    negative: bool,
    limbs: Vec<u32>,
}

impl BigInt {
    /// The finite `x` in units of 2⁻¹⁰⁷⁴; every finite f64 is an integer multiple of that.
    pub(super) fn from_f64(x: f64) -> Self {
        let exponent = (x.to_bits() >> 52) & 0x7ff;
        let fraction = x.to_bits() & ((1 << 52) - 1);
        // A subnormal has no hidden bit, but the unit of the smallest normal numbers (exponent 1):
        // neither is shifted.
        let (mantissa, shift) =
            if exponent == 0 { (fraction, 0) } else { (fraction | 1 << 52, exponent as usize - 1) };
        // Whole limbs first, so that the rest, 53 bits shifted by at most 31, fits in a u128.
        let mut limbs = vec![0; shift / 32];
        let mut remaining = u128::from(mantissa) << (shift % 32);
        while remaining > 0 {
            limbs.push(remaining as u32);
            remaining >>= 32;
        }
        if mantissa == 0 {
            limbs.clear();
        }
        Self { negative: x < 0.0, limbs }
    }

    /// The sign, as an ordering against 0.
    pub(super) fn sign(&self) -> Ordering {
        match (self.limbs.is_empty(), self.negative) {
            (true, _) => Ordering::Equal,
            (false, true) => Ordering::Less,
            (false, false) => Ordering::Greater,
        }
    }
}

impl Neg for BigInt {
    type Output = Self;

    fn neg(self) -> Self {
        Self { negative: !self.negative, ..self }
    }
}

impl Sub for &BigInt {
    type Output = BigInt;

    fn sub(self, other: Self) -> BigInt {
        if self.negative != other.negative {
            return BigInt { negative: self.negative, limbs: sum(&self.limbs, &other.limbs) };
        }
        match compare(&self.limbs, &other.limbs) {
            Ordering::Less => {
                BigInt { negative: !self.negative, limbs: difference(&other.limbs, &self.limbs) }
            }
            _ => BigInt { negative: self.negative, limbs: difference(&self.limbs, &other.limbs) },
        }
    }
}

impl Mul for &BigInt {
    type Output = BigInt;

    fn mul(self, other: Self) -> BigInt {
        let mut limbs = vec![0; self.limbs.len() + other.limbs.len()];
        for (i, &a) in self.limbs.iter().enumerate() {
            let mut carry = 0;
            for (j, &b) in other.limbs.iter().enumerate() {
                // At most (2³²−1)² + 2·(2³²−1) = 2⁶⁴ − 1.
                let t = u64::from(a) * u64::from(b) + u64::from(limbs[i + j]) + carry;
                limbs[i + j] = t as u32;
                carry = t >> 32;
            }
            // Not added: no earlier row has reached this limb.
            limbs[i + other.limbs.len()] = carry as u32;
        }
        BigInt { negative: self.negative != other.negative, limbs: trimmed(limbs) }
    }
}

fn trimmed(mut limbs: Vec<u32>) -> Vec<u32> {
    while limbs.last() == Some(&0) {
        limbs.pop();
    }
    limbs
}

fn compare(a: &[u32], b: &[u32]) -> Ordering {
    a.len().cmp(&b.len()).then_with(|| a.iter().rev().cmp(b.iter().rev()))
}

fn sum(a: &[u32], b: &[u32]) -> Vec<u32> {
    let mut carry = 0;
    let mut limbs: Vec<u32> = (0..a.len().max(b.len()))
        .map(|i| {
            let limb = |part: &[u32]| u64::from(part.get(i).copied().unwrap_or(0));
            let t = limb(a) + limb(b) + carry;
            carry = t >> 32;
            t as u32
        })
        .collect();
    limbs.push(carry as u32);
    trimmed(limbs)
}

/// `a − b` for `a ≥ b`.
fn difference(a: &[u32], b: &[u32]) -> Vec<u32> {
    let mut borrow = false;
    let limbs = a.iter().enumerate().map(|(i, &limb)| {
        // At most one of the two underflows: after the first, `once` is at least 1.
        let (once, under) = limb.overflowing_sub(b.get(i).copied().unwrap_or(0));
        let (twice, under_again) = once.overflowing_sub(u32::from(borrow));
        borrow = under || under_again;
        twice
    });
    trimmed(limbs.collect())
}
