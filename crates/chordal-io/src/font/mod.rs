//! TrueType and OpenType fonts: sets a text, and reads its glyphs as curves in the plane.
//!
//! The baseline of the first line is y = 0, and it starts at x = 0 unless it is aligned; y grows upwards.
mod font_file;
mod font_list;
mod glyph_pen;
mod placed_glyph;
mod typesetter;

use crate::drawing::{Drawing, DrawingElement};
use crate::text::{grouped, show};
use crate::warnings::Warnings;
use crate::{Axis, Content, FileLocation, Frame, Limits, ReadError, ReadOutcome};
use chordal::budget::advice::{Message, Setting};
use chordal::explicit::FillRule;
use font_file::FontFile;
pub use font_list::{fonts_in, letters_in};
use glyph_pen::GlyphPen;
use typesetter::Typesetter;

/// The most characters of a text. Chosen: three pages of a book, which take less than a second.
const MOST_CHARACTERS: usize = 10_000;
/// The most curves of a text. Chosen: 400 per letter, ten times the usual number.
const MOST_PIECES: usize = 4_000_000;

/// A text, and how to set it.
#[derive(Clone, Debug, PartialEq)]
pub struct Letters {
    /// The text; a line break starts a new line.
    pub text: String,
    /// The length of the font's em: letters are about 0.7 of it high.
    pub em: f64,
    /// The positions on the axes of a variable font, by tag; other axes are at the font's default.
    pub axes: Vec<(String, f64)>,
    /// The share of each line's advance width that lies left of x = 0: 0 for lines that start there, 0.5 for
    /// centred ones, 1 for lines that end there. The advance is the sum in the font's tables, including
    /// spaces at the end; the outlines may reach over it or fall short of it.
    pub align: f64,
}

impl Letters {
    /// A text with an em of length 1.
    ///
    /// ```
    /// assert_eq!(chordal_io::font::Letters::new("Ab").em, 1.0);
    /// ```
    #[must_use]
    pub fn new(text: &str) -> Self {
        Self { text: text.to_owned(), em: 1.0, axes: Vec::new(), align: 0.0 }
    }
}

/// Refuses a font, which has no shape without a text: see [`read_letters`].
///
/// # Errors
/// Always.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    FontFile::read(bytes, limits)?;
    let message = Message::from("a font has a shape once it sets a text: ").setting(Setting::Text);
    Err(ReadError::new("no-text", FileLocation::File, message.words(" says which")))
}

/// Reads the glyphs of a text as one drawn element with the nonzero fill rule: overlapping letters are one
/// region, and so are overlapping strokes of one letter.
///
/// Glyphs are chosen and placed by HarfBuzz's rules: ligatures, marks, and kerning as in the font's tables.
/// Each line has one direction. The distance between lines is that of the font.
///
/// The curves are those of the font in its own units, with the numbers that `read-fonts` computes: exact if
/// the font stores the point itself, single precision if a variation moves it. [`Curve::slack`] counts the
/// rounding after that.
///
/// [`Curve::slack`]: chordal::explicit::Curve::slack
///
/// **Cost.** Time and memory are linear in the number of letters, plus the size of the file once.
///
/// # Errors
/// If the font cannot be read, a collection is given without an index, the text is empty or too long, a
/// character is missing in the font (the message names it), the letters draw nothing, an axis is missing in
/// the font or its value is out of range, or a line has two directions.
pub fn read_letters(bytes: &[u8], letters: &Letters, limits: &Limits) -> Result<ReadOutcome, ReadError> {
    check(letters)?;
    let font = FontFile::read(bytes, limits)?.at(&letters.axes)?;
    let placed = Typesetter::new(&font).set(&letters.text, letters.align)?;
    let mut pen = GlyphPen::new(letters.em, font.units_per_em());
    for glyph in &placed {
        pen.place(glyph.at);
        font.draw(glyph, &mut pen)?;
        if pen.n_pieces() > MOST_PIECES {
            let message = format!("the letters have more than {} curves", grouped(MOST_PIECES as u64));
            return Err(ReadError::new("too-large", FileLocation::File, message));
        }
    }
    let curves = pen.finish().map_err(|error| {
        let message = format!("the letters have points that are no finite numbers: {error}");
        ReadError::new("not-finite", FileLocation::File, message)
    })?;
    if curves.is_empty() {
        let message = format!("the text {} draws nothing: it is blank", show(letters.text.as_bytes()));
        return Err(ReadError::new("nothing-drawn", FileLocation::File, message));
    }
    let element = DrawingElement {
        kind: "text",
        name: letters.text.as_str().into(),
        source: 0,
        rule: FillRule::NonZero,
        filled: true,
    };
    let drawing = Drawing {
        owners: vec![0; curves.len()],
        lines: curves,
        elements: vec![element],
        frame: Frame { up: Some(Axis::Y), ..Frame::default() },
        ..Drawing::default()
    };
    Ok(ReadOutcome { content: Content::Drawing(drawing), warnings: Warnings::default().into_list() })
}

/// Refuses texts that no font could set.
fn check(letters: &Letters) -> Result<(), ReadError> {
    let refuse = |code, message: String| Err(ReadError::new(code, FileLocation::File, message));
    if letters.text.trim().is_empty() {
        return refuse("no-text", "the text is blank: it has no letter".to_owned());
    }
    // Counting stops soon after the limit.
    if letters.text.chars().nth(MOST_CHARACTERS).is_some() {
        let most = grouped(MOST_CHARACTERS as u64);
        return refuse("too-large", format!("the text has more than {most} characters, which is the limit"));
    }
    // Outside this range, squares of lengths overflow or underflow.
    if !(letters.em >= 1e-100 && letters.em <= 1e100) {
        return refuse("em", format!("the em of letters is from 1e-100 to 1e100 long, not {}", letters.em));
    }
    Ok(())
}

/// Whether a file starts like a font: with a version number, or a tag.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    [&b"\0\x01\0\0"[..], b"true", b"OTTO", font_file::COLLECTION].iter().any(|start| bytes.starts_with(start))
        && bytes.get(4..6).is_some_and(|count| count.starts_with(&[0]) && (bytes[0] == b't' || count[1] > 0))
}
