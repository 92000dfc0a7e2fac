//! `UnknownFormat`: the error for an unknown name of a format; it lists the known ones.
use std::fmt;

/// A name that is not a format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownFormat {
    name: String,
    formats: Vec<&'static str>,
}

impl UnknownFormat {
    /// The error for `name`, with the names of all formats.
    pub(crate) fn new(name: &str, formats: impl Iterator<Item = &'static str>) -> Self {
        Self { name: name.to_owned(), formats: formats.collect() }
    }
}

impl fmt::Display for UnknownFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "'{}' is no format; they are ", self.name.escape_default())?;
        match self.formats.split_last() {
            Some((last, others)) => write!(f, "{} and {last}", others.join(", ")),
            None => Ok(()),
        }
    }
}

impl std::error::Error for UnknownFormat {}
