//! Numbers for people: few digits, rounded so that a bound stays a bound.

/// The direction in which digits are rounded away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoundingDirection {
    /// Not below the number: for an upper bound.
    Up,
    /// Not above the number: for a lower bound.
    Down,
    /// To the nearest.
    Nearest,
}

/// Three significant digits; an exponent only for very large and very small numbers.
pub fn short(number: f64, toward: RoundingDirection) -> String {
    with_digits(number, 3, toward)
}

/// A point with six significant digits each.
pub fn point(at: [f64; 3]) -> String {
    let [x, y, z] = at.map(|x| with_digits(x, 6, RoundingDirection::Nearest));
    format!("({x}, {y}, {z})")
}

fn with_digits(number: f64, digits: usize, toward: RoundingDirection) -> String {
    let rounded = |number: f64| format!("{number:.*e}", digits - 1);
    let value = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    // The printed text decides, and not arithmetic: what has to be a bound is the number that people
    // read.
    let near = rounded(number);
    let wrong_side = match toward {
        RoundingDirection::Up => value(&near) < number,
        RoundingDirection::Down => value(&near) > number,
        RoundingDirection::Nearest => false,
    };
    let text = if wrong_side {
        // One unit of the last digit moves it to the right side.
        let exponent = near.rsplit_once('e').map_or("0", |(_, exponent)| exponent);
        let step = value(&format!("1e{exponent}")) / value(&format!("1e{}", digits - 1));
        rounded(if toward == RoundingDirection::Up { number + step } else { number - step })
    } else {
        near
    };
    let shown = value(&text);
    let plain = shown == 0.0 || (1e-3..1e6).contains(&shown.abs());
    // Hides the sign of −0.
    if shown == 0.0 {
        "0".to_owned()
    } else if plain {
        format!("{shown}")
    } else {
        format!("{shown:e}")
    }
}

/// `12,345,678`.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// `57.2 kB`: powers of 1000, as file managers show.
pub fn size(bytes: u64) -> String {
    let mut left = bytes as f64;
    for unit in ["B", "kB", "MB", "GB"] {
        if left < 1000.0 {
            return if unit == "B" { format!("{bytes} B") } else { format!("{left:.1} {unit}") };
        }
        left /= 1000.0;
    }
    format!("{left:.1} TB")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_digits_by_three() {
        let shown = [0, 999, 1000, 1_234_567].map(grouped);
        assert_eq!(shown, ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn shows_few_digits() {
        assert_eq!([0, 999, 57_249, 3_000_000_000].map(size), ["0 B", "999 B", "57.2 kB", "3.0 GB"]);
        let shown = [0.0, 0.5, 1.25, 0.001, 0.00098, -2.0, 1e9].map(|x| short(x, RoundingDirection::Nearest));
        assert_eq!(shown, ["0", "0.5", "1.25", "0.001", "9.8e-4", "-2", "1e9"]);
        assert_eq!(point([1.0, -0.5, 123_456.7]), "(1, -0.5, 123457)");
    }

    #[test]
    fn never_shows_a_bound_on_the_wrong_side() {
        let mut number = 1.000_000_1e-9;
        while number < 1e9 {
            let up: f64 = short(number, RoundingDirection::Up).parse().unwrap();
            let down: f64 = short(number, RoundingDirection::Down).parse().unwrap();
            assert!(down <= number && number <= up, "{down} {number} {up}");
            assert!(up < number * 1.02 && down > number * 0.98, "{down} {number} {up}");
            number *= 1.037;
        }
        assert_eq!(short(0.0, RoundingDirection::Up), "0");
    }
}
