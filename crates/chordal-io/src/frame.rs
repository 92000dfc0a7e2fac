//! `Frame`: the space that a shape is in.

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The second axis, as in glTF.
    Y,
    /// The third axis, as in most CAD.
    Z,
}

impl Axis {
    /// Its letter, as in "z".
    #[must_use]
    pub fn letter(self) -> &'static str {
        match self {
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

/// What is known of the coordinate space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Which axis is up, if the format or the user says.
    pub up: Option<Axis>,
    /// The length of one unit, if the format or the user says.
    pub metres_per_unit: Option<f64>,
}
