//! `UnknownFormat`: a name that is no format, and those that are.
use crate::format::Format;
use std::fmt;

/// A name that is no format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownFormat(String);

impl fmt::Display for UnknownFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "'{}' is no format; they are", self.0.escape_default())?;
        for (i, format) in Format::all().enumerate() {
            let before = if i == 0 {
                ""
            } else if i + 1 == Format::all().count() {
                " and"
            } else {
                ","
            };
            write!(f, "{before} {format}")?;
        }
        Ok(())
    }
}

impl UnknownFormat {
    /// That name.
    pub(crate) fn new(name: &str) -> Self {
        Self(name.to_owned())
    }
}

impl std::error::Error for UnknownFormat {}
