//! `Length`: a length as a person writes it: `0.1`, `0.1mm`, `0.05%`.
use super::{Message, Setting, Spell, Spelling, Tolerance, digits};
use std::fmt;
use std::str::FromStr;

/// A unit of length that a file or a user can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// 1e-6 m
    Micrometre,
    /// 1e-3 m
    Millimetre,
    /// 1e-2 m
    Centimetre,
    /// The metre itself.
    Metre,
    /// 1e3 m
    Kilometre,
    /// 0.0254 m, exactly (international yard and pound agreement, 1959)
    Inch,
    /// 0.3048 m, exactly (the same)
    Foot,
}

// Exact by definition of the units.
const UNITS: [(Unit, &str, f64); 7] = [
    (Unit::Micrometre, "um", 1e-6),
    (Unit::Millimetre, "mm", 1e-3),
    (Unit::Centimetre, "cm", 1e-2),
    (Unit::Metre, "m", 1.0),
    (Unit::Kilometre, "km", 1e3),
    (Unit::Inch, "in", 0.0254),
    (Unit::Foot, "ft", 0.3048),
];

impl Unit {
    fn row(self) -> (Unit, &'static str, f64) {
        UNITS[self as usize]
    }

    /// Metres in one such unit.
    #[must_use]
    pub fn metres(self) -> f64 {
        self.row().2
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().1)
    }
}

impl FromStr for Unit {
    type Err = InvalidLength;
    fn from_str(text: &str) -> Result<Self, InvalidLength> {
        let row = UNITS.iter().find(|row| row.1 == text);
        row.map(|row| row.0).ok_or_else(|| InvalidLength {
            text: text.to_owned(),
            why: "units are um, mm, cm, m, km, in and ft".into(),
        })
    }
}

/// A length as written: in the shape's units, in a named unit, or in percent of the shape's diagonal.
///
/// ```
/// use chordal::budget::{Length, Unit};
/// assert_eq!("0.05%".parse::<Length>()?.to_string(), "0.05%");
/// assert_eq!("0.1mm".parse::<Length>()?, Length::In(0.1, Unit::Millimetre));
/// // 0.05 % of a diagonal of 20 is 0.01:
/// assert_eq!("0.05%".parse::<Length>()?.resolve(20.0, None)?.get(), 0.01);
/// # Ok::<(), chordal::budget::InvalidLength>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// In the units of the shape.
    Plain(f64),
    /// In a named unit; the shape's unit must be known.
    In(f64, Unit),
    /// In percent of the diagonal of the shape's bounding box.
    Percent(f64),
}

impl Length {
    /// The length in the units of a shape. `diagonal` is the diagonal of its bounding box, `metres_per_unit`
    /// its unit in metres, if known.
    ///
    /// # Errors
    /// A named unit needs `metres_per_unit`; a percentage needs a diagonal greater than zero.
    pub fn resolve(self, diagonal: f64, metres_per_unit: Option<f64>) -> Result<Tolerance, InvalidLength> {
        let invalid = |why: Message| InvalidLength { text: self.to_string(), why };
        let length = match self {
            Self::Plain(length) => length,
            Self::In(length, unit) => {
                let per_unit = metres_per_unit.ok_or_else(|| {
                    let unknown =
                        Message::from("the input's unit is not known: give ").setting(Setting::Unit);
                    invalid(unknown.words(", or a length without a unit"))
                })?;
                length * unit.metres() / per_unit
            }
            Self::Percent(percent) => percent / 100.0 * diagonal,
        };
        Tolerance::new(length)
            .map_err(|_| invalid("it is not a finite length greater than 0 for this shape".into()))
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plain(length) => f.write_str(&digits(*length)),
            Self::In(length, unit) => write!(f, "{}{unit}", digits(*length)),
            Self::Percent(percent) => write!(f, "{percent}%"),
        }
    }
}

impl FromStr for Length {
    type Err = InvalidLength;
    fn from_str(text: &str) -> Result<Self, InvalidLength> {
        let text = text.trim();
        let invalid = |why: Message| InvalidLength { text: text.to_owned(), why };
        // An `e` belongs to the number, as in 1e-3; no unit starts with it.
        let split = text
            .find(|c: char| c.is_ascii_alphabetic() && c != 'e' && c != 'E' || c == '%')
            .unwrap_or(text.len());
        let (number, unit) = text.split_at(split);
        // `nan` and `inf` start with letters, so they end up in `unit` and the number is empty.
        let number: f64 = number
            .trim()
            .parse()
            .map_err(|_| invalid("a length is a number greater than 0, as in 0.1, 0.1mm or 0.05%".into()))?;
        if !(number.is_finite() && number > 0.0) {
            return Err(invalid("a length must be finite and greater than 0".into()));
        }
        match unit.trim() {
            "" => Ok(Self::Plain(number)),
            "%" => Ok(Self::Percent(number)),
            unit => Ok(Self::In(number, unit.parse().map_err(|e: InvalidLength| invalid(e.why))?)),
        }
    }
}

/// The error for a text that is not a length, with the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidLength {
    text: String,
    why: Message,
}

impl Spell for InvalidLength {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.why.spell(spelling);
    }
}

impl InvalidLength {
    /// The full sentence.
    #[must_use]
    pub fn message(&self) -> Message {
        Message::from(format!("'{}': ", self.text)).message(&self.why)
    }
}

impl fmt::Display for InvalidLength {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "'{}': {}", self.text, self.why)
    }
}

impl std::error::Error for InvalidLength {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_back_what_it_shows() {
        for text in ["0.1", "0.1mm", "0.05%", "3ft", "1e-6", "2.5e3km", "12in"] {
            let length: Length = text.parse().unwrap();
            assert_eq!(length.to_string().parse::<Length>().unwrap(), length, "{text}");
        }
    }

    #[test]
    fn refuses_what_is_no_length() {
        for text in
            ["", "0", "-1", "nan", "inf", "1e400", "0.1parsec", "mm", "%", "1,5", "0x1", "1mm2", "-0.0%"]
        {
            assert!(text.parse::<Length>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_unit_needs_a_shape_with_a_unit() {
        let length: Length = "1mm".parse().unwrap();
        assert!(length.resolve(1.0, None).is_err());
        assert_eq!(length.resolve(1.0, Some(1e-3)).unwrap().get(), 1.0);
        assert!("5%".parse::<Length>().unwrap().resolve(0.0, None).is_err());
    }
}
