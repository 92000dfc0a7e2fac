//! What fonts a file holds, by their names, and letters to show one by.
use super::font_file::{COLLECTION, FontFile};
use super::glyph_pen::GlyphPen;
use super::typesetter::Typesetter;
use crate::text::grouped;
use crate::{Limits, ReadError};
use read_fonts::types::NameId;

/// The fonts that are listed, at most.
const MOST_LISTED: u64 = 100;

/// The fonts of a file as people call them, each with the number of its glyphs and the range of its axes.
///
/// # Errors
/// When the first of them cannot be read; those after it are called so.
pub fn fonts_in(bytes: &[u8], limits: &Limits) -> Result<Vec<String>, ReadError> {
    let count = bytes.get(8..12).filter(|_| bytes.starts_with(COLLECTION));
    let count = count.and_then(|count| count.try_into().ok()).map_or(1, u32::from_be_bytes);
    let one =
        |index: u64| FontFile::read(bytes, &Limits { index: Some(index), ..*limits }).map(|font| line(&font));
    let mut all = vec![one(0)?];
    for index in 1..u64::from(count).min(MOST_LISTED) {
        all.push(one(index).unwrap_or_else(|error| format!("a font that cannot be read: {}", error.message)));
    }
    Ok(all)
}

/// Characters that are looked at for letters to show a font by, and those that are tried. Chosen: in any script
/// there are enough among them.
const MOST_LOOKED_AT: usize = 2000;
const MOST_TRIED: usize = 64;
/// Letters that a font is shown by. Chosen: a word.
const MOST_SHOWN: usize = 8;

/// A few characters that a font can set and draw, letters before others; an empty text where it has none. For fonts
/// that lack the letters of their own name.
///
/// # Errors
/// When the font cannot be read.
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
        // Longer ones are no names.
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
