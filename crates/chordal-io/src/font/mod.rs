//! Fonts of TrueType and OpenType: sets a text, and reads its letters as curves in the plane.
//!
//! The baseline of the first line is y = 0, and x = 0 is where it starts unless it is aligned; y grows upwards.
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
/// The most curves of a text. Chosen: 400 for each letter, ten times what letters have.
const MOST_PIECES: usize = 4_000_000;

/// What a font is to set.
#[derive(Clone, Debug, PartialEq)]
pub struct Letters {
    /// The text; a line break starts a new line.
    pub text: String,
    /// The length of the font's em: letters are about 0.7 of it high.
    pub em: f64,
    /// Where the axes of a variable font are, by their tags; the others are where the font says.
    pub axes: Vec<(String, f64)>,
    /// The share of each line's advance width that stands left of x = 0: 0 for lines that start there, 0.5 for centred
    /// ones, 1 for those that end there. The advance is what the font's tables give the line, spaces at its end
    /// included: letters reach as far over or short of it as they are drawn.
    pub align: f64,
}

impl Letters {
    /// A text in the em that is 1 long.
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

/// Reads the letters of a text as one drawn element, filled where its contours wind around a point (nonzero):
/// letters that overlap are one region, and so are the strokes of a letter that do.
///
/// Letters are chosen and placed by HarfBuzz's rules: ligatures, marks, and pairs moved together as the font's
/// tables say. Each line runs in one direction. Line follows line in the distance that the font gives.
///
/// The curves are those of the font at its own units, each number as `read-fonts` computes it: exact where the
/// font holds the point itself, single precision where a variation moves it. [`Curve::slack`] counts the
/// rounding from there.
///
/// [`Curve::slack`]: chordal::explicit::Curve::slack
///
/// **Cost.** Time and memory go with the letters, and the size of the file once.
///
/// # Errors
/// A font that cannot be read, a collection without an index, a text that is empty or too long, a character that
/// the font lacks, by its name; letters that draw nothing; an axis that the font lacks, or a place beyond its ends;
/// a line of two directions.
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

/// Refuses what no font could set.
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
    // Beyond these, squares of lengths leave the range of numbers.
    if !(letters.em >= 1e-100 && letters.em <= 1e100) {
        return refuse("em", format!("the em of letters is from 1e-100 to 1e100 long, not {}", letters.em));
    }
    Ok(())
}

/// Whether a file starts like a font: with the number of its version, or its tag.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    [&b"\0\x01\0\0"[..], b"true", b"OTTO", font_file::COLLECTION].iter().any(|start| bytes.starts_with(start))
        && bytes.get(4..6).is_some_and(|count| count.starts_with(&[0]) && (bytes[0] == b't' || count[1] > 0))
}
