//! `PlacedGlyph`: a glyph of a font at a place.

/// A glyph at a place, in units of the font.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlacedGlyph {
    pub id: u32,
    pub at: [f64; 2],
    /// The first character that it stands for.
    pub of: char,
}

/// A character in a message, with its number.
pub(super) fn character(c: char) -> String {
    let number = u32::from(c);
    if c.is_control() || c.is_whitespace() {
        format!("U+{number:04X}")
    } else {
        format!("'{c}' (U+{number:04X})")
    }
}
