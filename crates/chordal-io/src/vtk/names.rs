//! The names of arrays in files of this library, by which the reader recognises them.

/// Normals of points.
pub(super) const NORMALS: &str = "Normals";
/// Tangents of points, with the sign of the bitangent.
pub(super) const TANGENTS: &str = "Tangents";
/// Texture coordinates of points; those of set 1 are `TCoords_1`.
pub(super) const TEXCOORDS: &str = "TCoords";
/// Colours; those of set 1 are `color_1`.
pub(super) const COLOR: &str = "color";
/// The array that links vertices at one position; only this library writes it.
pub(super) const POSITION_ID: &str = "position_id";
/// The array of text with the certificate.
pub(super) const CERTIFICATE: &str = "chordal_certificate";

/// The name of a set.
pub(super) fn of_set(name: &str, set: u32) -> String {
    if set == 0 { name.to_owned() } else { format!("{name}_{set}") }
}

/// Whether a name is that of a set.
pub(super) fn is_of_set(name: &str, of: &str) -> bool {
    match name.strip_prefix(of) {
        Some("") => true,
        Some(rest) => rest
            .strip_prefix('_')
            .is_some_and(|set| !set.is_empty() && set.bytes().all(|b| b.is_ascii_digit())),
        None => false,
    }
}
