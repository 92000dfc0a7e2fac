//! `Shortest`: a number with the fewest digits that read back to the last bit.
use std::fmt;

/// A finite number, shown as JSON and SVG both read it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shortest(pub f64);

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        // Beyond these, zeros before or after the digits make an exponent shorter.
        if size != 0.0 && !(1e-5..1e16).contains(&size) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_reads_back() {
        for (value, text) in [(1.0, "1"), (-0.0, "-0"), (0.1, "0.1"), (1e-7, "1e-7"), (1.5e300, "1.5e300")] {
            assert_eq!(Shortest(value).to_string(), text);
        }
        let mut bits = 88_172_645_463_325_252_u64;
        for _ in 0..10_000 {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            let value = f64::from_bits(bits);
            if value.is_finite() {
                let text = Shortest(value).to_string();
                assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
                assert_eq!(serde_json::from_str::<f64>(&text).unwrap().to_bits(), value.to_bits());
            }
        }
    }
}
