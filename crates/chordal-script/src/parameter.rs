//! `Parameter`: a numeric input of a script.

/// A numeric input of a script.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its default value.
    pub default: f64,
    /// Its value: the one set by the caller, else the default.
    pub value: f64,
}
