//! `ScriptPath`: a path as a value of the language.
use chordal::explicit::Curve;

/// A path of the language.
#[derive(Clone, Debug, PartialEq)]
pub enum ScriptPath {
    /// A 2D path.
    Plane(Curve<2>),
    /// A 3D path.
    Space(Curve<3>),
}

impl ScriptPath {
    /// The number of its pieces.
    #[must_use]
    pub fn n_pieces(&self) -> usize {
        match self {
            Self::Plane(curve) => curve.segments().len(),
            Self::Space(curve) => curve.segments().len(),
        }
    }
}

impl From<Curve<2>> for ScriptPath {
    fn from(curve: Curve<2>) -> Self {
        Self::Plane(curve)
    }
}

impl From<Curve<3>> for ScriptPath {
    fn from(curve: Curve<3>) -> Self {
        Self::Space(curve)
    }
}
