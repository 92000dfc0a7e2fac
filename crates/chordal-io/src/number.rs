//! `ShortestDecimal`: a number with the fewest digits that read back to the same bits.
use std::fmt;

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

#[cfg(test)]
mod tests {
    use super::*;

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
