//! Decimals of few digits, read with one rounding.

/// Powers of ten that f64 holds exactly: 5²² < 2⁵³.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// The most digits that always fit in a u64. Derived: 10¹⁹ < 2⁶⁴.
const MOST_DIGITS: usize = 19;

/// A decimal of few digits that is a quotient or a product of two numbers that f64 holds exactly, so that one
/// rounding makes the nearest number: W. Clinger, *How to Read Floating Point Numbers Accurately*, 1990.
/// Returned with its number of bytes; the bytes after it are not checked.
#[inline]
pub(crate) fn short_decimal(text: &[u8]) -> Option<(f64, usize)> {
    let negative = text.first() == Some(&b'-');
    let start = usize::from(negative);
    let (mut value, mut at) = (0_u64, start);
    while let Some(digit) = digit(text, at) {
        // May wrap: too many digits are refused below, and up to that number nothing wraps.
        value = value.wrapping_mul(10).wrapping_add(digit);
        at += 1;
    }
    let (mut n_digits, mut n_decimals) = (at - start, 0);
    if text.get(at) == Some(&b'.') {
        at += 1;
        let point = at;
        while let Some(digit) = digit(text, at) {
            value = value.wrapping_mul(10).wrapping_add(digit);
            at += 1;
        }
        n_digits += at - point;
        n_decimals = at - point;
    }
    // Zeros before the number count as digits, which only leaves more to the slower method.
    if n_digits == 0 || n_digits > MOST_DIGITS || value > 1 << f64::MANTISSA_DIGITS {
        return None;
    }
    let mut scale = -(n_decimals as i32);
    if let Some(b'e' | b'E') = text.get(at) {
        let sign = text.get(at + 1);
        let minus = sign == Some(&b'-');
        let first = at + 1 + usize::from(minus || sign == Some(&b'+'));
        at = first;
        let mut exponent = 0_i32;
        while let Some(digit) = digit(text, at) {
            exponent = exponent.wrapping_mul(10).wrapping_add(digit as i32);
            at += 1;
        }
        // More than three digits exceed POWERS, and an exponent of many digits does not fit.
        if at == first || at - first > 3 {
            return None;
        }
        scale += if minus { -exponent } else { exponent };
    }
    let power = *POWERS.get(scale.unsigned_abs() as usize)?;
    let size = if scale < 0 { value as f64 / power } else { value as f64 * power };
    Some((if negative { -size } else { size }, at))
}

#[inline]
pub(crate) fn digit(text: &[u8], at: usize) -> Option<u64> {
    let digit = text.get(at)?.wrapping_sub(b'0');
    (digit < 10).then_some(u64::from(digit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    #[test]
    fn short_decimals_are_the_numbers_that_std_reads() {
        let mut random = Random::new(7);
        let mut n_short = 0;
        for i in 0..200_000_u64 {
            let bits = random.bits();
            let text = match i % 5 {
                0 => (f32::from_bits(bits as u32)).to_string(),
                1 => format!("{:e}", f32::from_bits(bits as u32)),
                2 => format!("{:.*}", (bits % 12) as usize, (bits >> 40) as f64 / 977.0),
                3 => format!("{}{}", if bits & 1 == 0 { "-" } else { "" }, (bits >> 1) >> (bits % 60)),
                _ => format!("{}.{}e{}", bits % 1000, bits >> (bits % 64), (bits % 60) as i64 - 30),
            };
            if let Some((value, n)) = short_decimal(text.as_bytes()) {
                assert_eq!(n, text.len(), "{text}");
                assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(value.to_bits()), "{text}");
                n_short += 1;
            }
        }
        assert!(n_short > 80_000, "{n_short}");
        for text in ["", "-", ".", "-.", "+1", "x", "nan", "inf", "1e", "1e+", "e5", "1e9999"] {
            assert_eq!(short_decimal(text.as_bytes()), None, "{text}");
        }
        assert_eq!(short_decimal(b"-0").map(|(x, n)| (x.to_bits(), n)), Some(((-0.0_f64).to_bits(), 2)));
        assert_eq!(short_decimal(b"2.5,1"), Some((2.5, 3)));
    }
}
