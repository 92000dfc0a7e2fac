//! `SmoothingWidth`: the width of a Gaussian over a mask.
use chordal::budget::{InvalidLength, Length};
use std::fmt;
use std::str::FromStr;

/// The standard deviation of a Gaussian over a mask.
///
/// ```
/// use chordal_verbs::SmoothingWidth;
/// assert_eq!("0.8vox".parse::<SmoothingWidth>()?, SmoothingWidth::Samples(0.8));
/// assert_eq!("1.5mm".parse::<SmoothingWidth>()?.to_string(), "1.5mm");
/// # Ok::<(), chordal::budget::InvalidLength>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SmoothingWidth {
    /// A length, the same in all directions of a lattice at right angles.
    Length(Length),
    /// A number of samples along each index.
    Samples(f64),
}

impl fmt::Display for SmoothingWidth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(length) => length.fmt(f),
            Self::Samples(samples) => write!(f, "{samples}vox"),
        }
    }
}

impl FromStr for SmoothingWidth {
    type Err = InvalidLength;

    /// A length, or a number of samples as in `0.8vox`.
    fn from_str(text: &str) -> Result<Self, InvalidLength> {
        match text.trim().strip_suffix("vox").map(str::parse) {
            Some(Ok(Length::Plain(samples))) => Ok(Self::Samples(samples)),
            Some(Err(invalid)) => Err(invalid),
            _ => text.parse().map(Self::Length),
        }
    }
}

impl SmoothingWidth {
    /// The width times a factor.
    pub(crate) fn times(self, factor: f64) -> Self {
        match self {
            Self::Samples(samples) => Self::Samples(factor * samples),
            Self::Length(Length::Plain(length)) => Self::Length(Length::Plain(factor * length)),
            Self::Length(Length::In(length, unit)) => Self::Length(Length::In(factor * length, unit)),
            Self::Length(Length::Percent(share)) => Self::Length(Length::Percent(factor * share)),
        }
    }
}
