//! The fonts in a file by name, and sample characters for each.
use super::font_file::{COLLECTION, FontFile};
use super::glyph_pen::GlyphPen;
use super::typesetter::Typesetter;
use crate::text::grouped;
use crate::{Limits, ReadError};
use read_fonts::types::NameId;

/// The most fonts that are listed. Chosen: larger values make the list long.
const MOST_LISTED: u64 = 100;

/// The names of the fonts in a file, each with the number of its glyphs and the range of its axes.
///
/// # Errors
/// If the first one cannot be read; for later ones the list says so.
pub fn fonts_in(bytes: &[u8], limits: &Limits) -> Result<Vec<String>, ReadError> {
    let count = bytes.get(8..12).filter(|_| bytes.starts_with(COLLECTION));
    let count = count.and_then(|count| count.try_into().ok()).map_or(1, u32::from_be_bytes);
    let one =
        |index: u64| FontFile::read(bytes, &Limits { index: Some(index), ..*limits }).map(|font| line(&font));
    let mut lines = vec![one(0)?];
    for index in 1..u64::from(count).min(MOST_LISTED) {
        lines.push(
            one(index).unwrap_or_else(|error| format!("a font that cannot be read: {}", error.message)),
        );
    }
    Ok(lines)
}

/// The most characters that are inspected, or tried, to find samples for a font. Chosen: any script has
/// enough letters among them.
const MOST_LOOKED_AT: usize = 2000;
const MOST_TRIED: usize = 64;
/// The most sample characters. Chosen: a word.
const MOST_SHOWN: usize = 8;

/// A few characters that a font can set and draw, letters first; empty if it has none. For fonts that lack
/// the letters of their own name.
///
/// # Errors
/// If the font cannot be read.
pub fn letters_in(bytes: &[u8], limits: &Limits) -> Result<String, ReadError> {
    let file = FontFile::read(bytes, limits)?;
    let characters = file.font().charmap().unicodes().filter_map(|(code, _)| char::from_u32(code));
    let seen = characters.filter(|c| !c.is_whitespace() && !c.is_control()).take(MOST_LOOKED_AT);
    let (letters, others): (Vec<char>, Vec<char>) = seen.partition(|c| c.is_alphabetic());
    let is_drawn = |text: &str| {
        let placed = Typesetter::new(&file).set(text, 0.0);
        placed.is_ok_and(|placed| {
            placed.iter().all(|glyph| {
                let mut pen = GlyphPen::new(1.0, file.units_per_em());
                file.draw(glyph, &mut pen).is_ok() && pen.n_pieces() > 0
            })
        })
    };
    let (mut text, mut n_letters) = (String::new(), 0);
    for c in letters.into_iter().chain(others).take(MOST_TRIED) {
        // Each with those before it: alone a letter may be drawn, and together they may need two
        // directions.
        text.push(c);
        if is_drawn(&text) {
            n_letters += 1;
        } else {
            text.pop();
        }
        if n_letters == MOST_SHOWN {
            break;
        }
    }
    Ok(text)
}

/// `DejaVu Sans Bold, 5,343 glyphs`
fn line(file: &FontFile) -> String {
    let font = file.font();
    let named = |id: NameId| {
        let name = font.names().get(id).and_then(|name| name.english_or_first());
        // Longer texts are not names.
        name.map(|name| name.name().chars().filter(|c| !c.is_control()).take(100).collect::<String>())
    };
    let name = named(NameId::FULL_NAME)
        .or_else(|| named(NameId::FAMILY_NAME))
        .filter(|name| !name.trim().is_empty());
    let name = name.unwrap_or_else(|| "a font without a name".to_owned());
    let mut line = format!("{}, {} glyphs", name.trim(), grouped(u64::from(font.num_glyphs())));
    for axis in font.axes().iter() {
        line += &format!(", {} {} to {}", axis.tag(), axis.min_value(), axis.max_value());
    }
    line
}
