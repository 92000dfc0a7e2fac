//! `PlacedGlyph`: a glyph of a font at a position.

/// A glyph at a position, in font units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlacedGlyph {
    pub id: u32,
    pub at: [f64; 2],
    /// The first character that it represents.
    pub first_char: char,
}

/// A character with its code point, for messages.
pub(super) fn character(c: char) -> String {
    let number = u32::from(c);
    if c.is_control() || c.is_whitespace() {
        format!("U+{number:04X}")
    } else {
        format!("'{c}' (U+{number:04X})")
    }
}
