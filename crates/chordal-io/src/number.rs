//! `ShortestDecimal`: a number with the fewest digits that read back to the same bits; and functions that
//! append it to a line, for writers of long texts.
use std::fmt;
use std::io::Write;

/// A finite number, formatted as both JSON and SVG accept it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShortestDecimal(pub f64);

impl fmt::Display for ShortestDecimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        // Outside this range an exponent is shorter than leading or trailing zeros.
        if size != 0.0 && !(1e-5..1e16).contains(&size) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

/// Appends a number as [`ShortestDecimal`] shows it.
#[inline]
pub(crate) fn put_shortest(line: &mut Vec<u8>, number: f64) {
    if is_usual(number.abs()) {
        return put_usual(line, zmij::Buffer::new().format_finite(number));
    }
    // Writing to a list does not fail.
    let _ = write!(line, "{}", ShortestDecimal(number));
}

/// Appends a double-precision number as `{:?}` shows it, but whole numbers without a point.
#[inline]
pub(crate) fn put_double(line: &mut Vec<u8>, number: f64) {
    match is_usual(number.abs()) {
        true => put_usual(line, zmij::Buffer::new().format_finite(number)),
        false => put_usual(line, &format!("{number:?}")),
    }
}

/// The same for single precision.
#[inline]
pub(crate) fn put_single(line: &mut Vec<u8>, number: f32) {
    match is_usual(f64::from(number.abs())) {
        true => put_usual(line, zmij::Buffer::new().format_finite(number)),
        false => put_usual(line, &format!("{number:?}")),
    }
}

/// Whether std and zmij show the same decimal: one without an exponent, and only one of the fewest digits is
/// nearest. If two are equally near, they choose different ones. Such a number has one binary digit more
/// after the point than decimals, and so many that its steps are no finer than the last decimal: at sizes of
/// 1e-4 and more these are at most 20 decimals.
#[inline]
fn is_usual(size: f64) -> bool {
    const TWENTY_ONE_BITS: f64 = (1 << 21) as f64; // derived above
    // Whole numbers in single precision are exact up to 2²⁴, which is over 1e7.
    let is_clear = |size: f64| size.fract() == 0.0 || (size * TWENTY_ONE_BITS).fract() != 0.0;
    size == 0.0 || (1e-4..1e7).contains(&size) && is_clear(size)
}

#[inline]
fn put_usual(line: &mut Vec<u8>, text: &str) {
    line.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
}

/// Appends a whole number.
#[inline]
pub(crate) fn put_count(line: &mut Vec<u8>, count: u64) {
    // The digits of 2⁶⁴.
    let mut digits = [0; 20];
    let (mut at, mut left) = (digits.len(), count);
    loop {
        at -= 1;
        digits[at] = b'0' + (left % 10) as u8;
        left /= 10;
        if left == 0 {
            return line.extend_from_slice(&digits[at..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    /// The former way to show a number: by std alone.
    fn shown(number: impl fmt::Debug) -> String {
        let text = format!("{number:?}");
        text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
    }

    fn put(write: impl FnOnce(&mut Vec<u8>)) -> String {
        let mut line = Vec::new();
        write(&mut line);
        String::from_utf8(line).expect("ASCII")
    }

    #[test]
    fn numbers_are_put_as_std_shows_them() {
        let mut random = Random::new(3);
        for i in 0..100_000_u64 {
            // Random bits, sizes of coordinates, few digits, and the neighbours of the sizes at which the
            // notation changes.
            let edges = [1e-5, 1e-4, 1e12, 1e13, 1e15, 1e16, 1.0, 0.0, -0.0];
            let edge: f64 = edges[(random.bits() % edges.len() as u64) as usize];
            let number = match i % 5 {
                // Few binary digits, so that two decimals may be equally near.
                4 => random.below(1 << 30) as f64 / (1_u64 << random.below(40)) as f64,
                0 => f64::from_bits(random.bits()),
                1 => random.signed() * 10.0,
                2 => (random.signed() * 1e6).round() / 1000.0,
                _ => [edge, edge.next_up(), edge.next_down(), f64::from(edge as f32)][(i / 4 % 4) as usize],
            };
            if number.is_finite() {
                assert_eq!(put(|line| put_shortest(line, number)), ShortestDecimal(number).to_string());
                assert_eq!(put(|line| put_double(line, number)), shown(number));
            }
            for single in [number as f32, f32::from_bits(random.bits() as u32)] {
                if single.is_finite() {
                    assert_eq!(put(|line| put_single(line, single)), shown(single));
                }
            }
            assert_eq!(put(|line| put_count(line, i * i)), (i * i).to_string());
        }
        assert_eq!(put(|line| put_count(line, u64::MAX)), u64::MAX.to_string());
    }

    #[test]
    fn every_number_reads_back() {
        for (value, text) in [(1.0, "1"), (-0.0, "-0"), (0.1, "0.1"), (1e-7, "1e-7"), (1.5e300, "1.5e300")] {
            assert_eq!(ShortestDecimal(value).to_string(), text);
        }
        let mut bits = 88_172_645_463_325_252_u64;
        for _ in 0..10_000 {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            let value = f64::from_bits(bits);
            if value.is_finite() {
                let text = ShortestDecimal(value).to_string();
                assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
                assert_eq!(serde_json::from_str::<f64>(&text).unwrap().to_bits(), value.to_bits());
            }
        }
    }
}
