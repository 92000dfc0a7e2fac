//! `Format`: what a file is, by its extension or by its content.

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Bicubic Bézier patches, one block of 4 × 4 points each.
    Bpt,
    /// Newell's teaset text: patches as indices, then points.
    Teaset,
    /// Patches in JSON.
    PatchJson,
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY.
    Ply,
    /// STL, text or binary.
    Stl,
    /// Binary glTF 2.0.
    Glb,
}
