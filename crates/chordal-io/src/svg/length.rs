//! `SvgLength`: lengths with units or percentages, in user units.
use super::cursor::{SvgSyntaxError, TextCursor};

/// A length as written in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SvgLength {
    pub value: f64,
    pub unit: SvgUnit,
}

/// The unit of a length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SvgUnit {
    /// User units, written without a unit; `px` is the same length.
    User,
    Px,
    In,
    Cm,
    Mm,
    Q,
    Pt,
    Pc,
    Percent,
}

/// Why a length cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum LengthError {
    /// Its spelling is wrong, or it is not finite.
    Wrong(SvgSyntaxError),
    /// Its unit depends on fonts or the viewport.
    Unit(String),
}

impl SvgUnit {
    /// User units per unit, as a numerator and a denominator, so that each can be exact.
    fn scale(self) -> [f64; 2] {
        // CSS Values and Units 3, 6.2: an inch is 96 pixels and 2.54 cm, 72 points, 6 picas.
        match self {
            Self::User | Self::Px | Self::Percent => [1.0, 1.0],
            Self::In => [96.0, 1.0],
            Self::Cm => [96.0, 2.54],
            Self::Mm => [96.0, 25.4],
            Self::Q => [96.0, 101.6],
            Self::Pt => [4.0, 3.0],
            Self::Pc => [16.0, 1.0],
        }
    }

    /// Metres per unit, for physical units; `None` for a pixel.
    pub fn metres(self) -> Option<f64> {
        match self {
            Self::In => Some(0.0254),
            Self::Cm => Some(0.01),
            Self::Mm => Some(0.001),
            Self::Q => Some(0.000_25),
            Self::Pt => Some(0.0254 / 72.0),
            Self::Pc => Some(0.0254 / 6.0),
            Self::User | Self::Px | Self::Percent => None,
        }
    }
}

impl SvgLength {
    /// Parses a length.
    ///
    /// # Errors
    /// If the text is not a length, or its unit is not supported.
    pub fn read(text: &str) -> Result<Self, LengthError> {
        let mut cursor = TextCursor::new(text);
        cursor.skip_space();
        let value = cursor.number().map_err(LengthError::Wrong)?;
        let unit = if cursor.take(b'%') {
            SvgUnit::Percent
        } else {
            let word = String::from_utf8_lossy(cursor.word()).to_ascii_lowercase();
            match word.as_str() {
                "" => SvgUnit::User,
                "px" => SvgUnit::Px,
                "in" => SvgUnit::In,
                "cm" => SvgUnit::Cm,
                "mm" => SvgUnit::Mm,
                "q" => SvgUnit::Q,
                "pt" => SvgUnit::Pt,
                "pc" => SvgUnit::Pc,
                _ => return Err(LengthError::Unit(word)),
            }
        };
        cursor.skip_space();
        if cursor.is_at_end() {
            Ok(Self { value, unit })
        } else {
            Err(LengthError::Wrong(cursor.trouble("the end")))
        }
    }

    /// Converts to user units; a percentage is relative to `whole`. `None` if `whole` is needed but unknown.
    pub fn resolve(self, reference: Option<f64>) -> Option<f64> {
        match self.unit {
            SvgUnit::Percent => reference.map(|reference| self.value * reference / 100.0),
            unit => {
                let [times, over] = unit.scale();
                Some(self.value * times / over)
            }
        }
    }

    /// Whether the conversion to user units is exact.
    pub fn is_exact(self) -> bool {
        self.unit.scale() == [1.0, 1.0] && self.unit != SvgUnit::Percent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_those_of_css() {
        let user = |text: &str| SvgLength::read(text).unwrap().resolve(Some(200.0)).unwrap();
        for (text, expected) in [
            ("1in", 96.0),
            ("2.54cm", 96.0),
            (" 25.4mm ", 96.0),
            ("72pt", 96.0),
            ("6pc", 96.0),
            ("5px", 5.0),
            ("25%", 50.0),
            ("1e1", 10.0),
        ] {
            assert!((user(text) - expected).abs() < 1e-13, "{text}");
        }
        assert_eq!(SvgLength::read("1em"), Err(LengthError::Unit("em".into())));
        assert!(matches!(SvgLength::read("1 mm"), Err(LengthError::Wrong(_))));
        assert!(matches!(
            SvgLength::read("1e999"),
            Err(LengthError::Wrong(SvgSyntaxError { not_finite: true, .. }))
        ));
    }
}
