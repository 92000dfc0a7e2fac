//! `UsdShapeKind`: the types of prims that are curves or surfaces.

/// The kind of shape that a prim defines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UsdShapeKind {
    BasisCurves,
    NurbsCurves,
    NurbsPatch,
}

impl UsdShapeKind {
    pub(super) fn from_type(name: &str) -> Option<Self> {
        match name {
            "BasisCurves" => Some(Self::BasisCurves),
            "NurbsCurves" => Some(Self::NurbsCurves),
            "NurbsPatch" => Some(Self::NurbsPatch),
            _ => None,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::BasisCurves => "BasisCurves",
            Self::NurbsCurves => "NurbsCurves",
            Self::NurbsPatch => "NurbsPatch",
        }
    }
}
