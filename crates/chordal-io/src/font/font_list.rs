//! What fonts a file holds, by their names.
use super::font_file::{COLLECTION, FontFile};
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
