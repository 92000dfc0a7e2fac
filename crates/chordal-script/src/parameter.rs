//! `Parameter`: a number that a script can be given.

/// A number that a script can be given.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// What it is when nobody sets it.
    pub default: f64,
    /// What it was set to, else the default.
    pub value: f64,
}
