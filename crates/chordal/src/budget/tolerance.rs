//! `Tolerance`: a length that is finite and greater than zero.
use std::fmt;
use std::str::FromStr;

/// A length, finite and > 0 by construction, in the units of the shape.
///
/// ```
/// use chordal::Tolerance;
/// assert_eq!("0.1".parse::<Tolerance>().unwrap().get(), 0.1);
/// assert!(Tolerance::new(0.0).is_err());
/// assert!(Tolerance::new(f64::NAN).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Tolerance(f64);

impl Tolerance {
    /// The tolerance `length`.
    ///
    /// # Errors
    /// [`InvalidTolerance`] when `length` is NaN, infinite, zero or negative.
    pub fn new(length: f64) -> Result<Self, InvalidTolerance> {
        if length.is_finite() && length > 0.0 {
            Ok(Self(length))
        } else {
            Err(InvalidTolerance(length.to_string()))
        }
    }

    /// The length in the units of the shape.
    #[must_use]
    pub fn get(self) -> f64 {
        self.0
    }
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        digits(self.0).fmt(f)
    }
}

/// A number with all its digits: as a decimal, or with an exponent if the decimal would have many zeros.
#[must_use]
pub fn digits(x: f64) -> String {
    // Chosen: decimals that people still read at a glance; beyond, zeros would have to be counted.
    let is_plain = x == 0.0 || (x.abs() >= 1e-7 && x.abs() < 1e16);
    if is_plain { x.to_string() } else { format!("{x:e}") }
}

impl FromStr for Tolerance {
    type Err = InvalidTolerance;
    fn from_str(text: &str) -> Result<Self, InvalidTolerance> {
        let length = text.trim().parse().map_err(|_| InvalidTolerance(text.to_owned()))?;
        Self::new(length).map_err(|_| InvalidTolerance(text.to_owned()))
    }
}

/// The error for a text or number that is not a tolerance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidTolerance(pub(super) String);

impl fmt::Display for InvalidTolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a tolerance is a finite number greater than 0, not '{}'", self.0)
    }
}

impl std::error::Error for InvalidTolerance {}
