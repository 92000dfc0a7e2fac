//! `Frame`: the space that a shape is in.

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The second axis, as in glTF.
    Y,
    /// The third axis, as in most CAD.
    Z,
}

/// The corner of a picture where texture coordinates are 0, 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureOrigin {
    /// The lower left corner: v runs up, as in OBJ.
    LowerLeft,
    /// The upper left corner: v runs down, as in glTF.
    UpperLeft,
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

/// The known properties of the coordinate space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Which axis is up, if the format or the user specifies it.
    pub up: Option<Axis>,
    /// The length of one unit, if the format or the user specifies it.
    pub metres_per_unit: Option<f64>,
    /// The origin of texture coordinates, if the format specifies it. A writer whose format has the other
    /// origin flips v: it writes (1 - v); if the origin is unknown it writes v unchanged.
    pub texture_origin: Option<TextureOrigin>,
}

impl Frame {
    /// Whether texture coordinates must be flipped for a format whose origin is `origin`.
    pub(crate) fn turns_v(&self, origin: TextureOrigin) -> bool {
        self.texture_origin.is_some_and(|own| own != origin)
    }
}
